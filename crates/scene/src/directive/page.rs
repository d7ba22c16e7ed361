//! The format page, made from the table.

use super::Arguments;
use super::DIRECTIVES;
use super::Form;
use super::Origin;
use super::Spec;
use crate::diagnostic::READER_CODES;
use crate::diagnostic::Severity;
use std::fmt::Write;

const INTRODUCTION: &str = "\
# The `.ray` format

<!-- Made from crates/scene/src/directive/table.rs;
`UPDATE=1 cargo test -p dotray-scene --test format_page` rewrites it. -->

A `.ray` file describes a scene for a ray tracer: a camera, lights, materials, and shapes in nested groups.

## Text

- A file is a row of words with white space between them. A word that starts with `#` is a directive; what follows
  up to the next directive are its arguments, on as many lines as one likes. Indentation and empty lines mean nothing.
- Numbers are decimal: `3`, `-1`, `.523`, `+2.`, `1e-3`. Hexadecimal numbers, `nan`, `inf` and numbers too large
  for double precision are errors.
- A name with blanks stands in `\"quotes\"`. A text stands between exclamation marks: `!like this!`. Both run to their
  closing sign, which must come before a line that begins with a directive.
- Comments run from `//` to the end of the line, or from `/*` to `*/`. They may stand wherever a word may begin.
- Directives are written in lower case; other letters are accepted with a warning. A UTF-8 byte order mark and
  Windows line ends are accepted.
- A file may be compressed with gzip or Zstandard, which its first bytes tell, whatever its name.
- Lengths are in the scene's own units, angles in radians, colours from 0 to 1 (more is allowed).

## Rules

- Lights, textures, materials, vertices and included files are numbered from 0 in the order in which they stand in
  their file. They may stand after the shapes that use them. A number that names nothing is an error.
- `#light_num` and its kin are hints: where they do not agree with the file, a warning says so and the file counts.
- Material -1 is the default material: ambient .2, diffuse and specular .8, specular coefficient 1, nothing else.
- Of several `#camera`, `#background` or `#ambient` the first one counts; the others are warned of.
- Without a camera, one is made that looks down -z and frames the scene. Without `#background` or `#ambient` they are
  black.
- A group's matrix stands row by row and acts on column vectors, so the shift stands at the end of the first three rows.
  Its last row is `0 0 0 1`; a singular matrix is an error. Groups may be nested a million deep; a shape is moved by all
  groups around it, the innermost first. Shapes outside of groups are not moved.
- A shape of no extent (radius or height not above 0, an edge below 0 or two of 0, a triangle of no area) is left out
  with a warning. A direction of length 0 is an error.
- An included file brings its shapes, with its own materials, textures and vertices. Its camera, lights and colours of
  background and ambient light do not count. A file must not include itself, be it by way of others.

";

/// The page docs/format.md: the rules of the text, then all directives, then all messages, in Markdown.
pub fn format_page() -> String {
    let mut page = String::from(INTRODUCTION);
    page.push_str("## Directives\n\n| directive | arguments | meaning |\n| --- | --- | --- |\n");
    for spec in &DIRECTIVES {
        for form in spec.forms {
            line(&mut page, format_args!("| `{}` | {} | {} |", spec.word, code(&form.usage()), spec.meaning));
        }
    }
    for spec in &DIRECTIVES {
        directive(&mut page, spec);
    }
    page.push_str("\n## Messages of the reader\n\n| code | | meaning |\n| --- | --- | --- |\n");
    for (name, severity, meaning) in READER_CODES {
        let severity = match severity {
            Severity::Warning => "warning",
            Severity::Error => "error",
        };
        line(&mut page, format_args!("| `{name}` | {severity} | {meaning} |"));
    }
    page
}

fn directive(page: &mut String, spec: &Spec) {
    line(page, format_args!("\n### `{}`\n\n{}{}", spec.word, spec.meaning, origin(spec.origin)));
    for form in spec.forms {
        arguments(page, form);
        line(page, format_args!("\n    {}", form.example));
    }
}

fn arguments(page: &mut String, form: &Form) {
    if form.arguments.is_empty() {
        return;
    }
    page.push_str("\n| arguments | unit | meaning |\n| --- | --- | --- |\n");
    for Arguments { names, unit, meaning, .. } in form.arguments {
        line(page, format_args!("| {} | {unit} | {meaning} |", code(&names.join(" "))));
    }
}

fn origin(origin: Origin) -> &'static str {
    match origin {
        Origin::Slides => "",
        Origin::LaterCourses => " (An extension of later courses.)",
        Origin::Dotray => " (An extension of this program.)",
    }
}

fn code(words: &str) -> String {
    if words.is_empty() { String::new() } else { format!("`{words}`") }
}

fn line(page: &mut String, text: std::fmt::Arguments<'_>) {
    // Writing to a string cannot fail.
    let _ = writeln!(page, "{text}");
}
