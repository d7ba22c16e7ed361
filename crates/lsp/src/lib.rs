//! A language server for `.ray` scenes: faults while one types, names and meanings of arguments, places, outline,
//! layout. It reads scenes and never renders them.
//!
//! The order of the `mod` lines is the floor order: a module uses only modules listed above it.

#![deny(clippy::indexing_slicing, clippy::unwrap_used, clippy::expect_used)]

pub mod text;

pub mod statement;

pub mod spot;

pub mod paths;

pub mod documents;

pub mod refer;

pub mod repair;

pub mod check;

pub mod words;

pub mod complete;

pub mod hover;

pub mod symbols;

pub mod layout;

pub mod server;

pub use server::ServeError;
pub use server::serve;
