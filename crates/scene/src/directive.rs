//! The one table of directives from which parser, writer, help and format page are made.
