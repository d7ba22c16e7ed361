//! What the table of directives says, in the forms that editors show.

use dotray_scene::directive::ArgumentKind;
use dotray_scene::directive::Arguments;
use dotray_scene::directive::Form;
use dotray_scene::directive::Spec;
use std::fmt::Write;

/// A clause of a material's `!…!` text.
#[derive(Clone, Copy, Debug)]
pub struct Clause {
    /// Its name.
    pub name: &'static str,
    /// What it does.
    pub meaning: &'static str,
    /// The keys that it knows, each with a value as one may write it.
    pub keys: &'static [Key],
}

/// A key of a clause.
#[derive(Clone, Copy, Debug)]
pub struct Key {
    /// The word before `=`.
    pub name: &'static str,
    /// The value where the key is not given.
    pub default: &'static str,
    /// What it means.
    pub meaning: &'static str,
}

const fn key(name: &'static str, default: &'static str, meaning: &'static str) -> Key {
    Key { name, default, meaning }
}

const SCALE: Key = key("scale", "1", "cells a unit of the shape's own coordinates");
const OCTAVES: Key = key("octaves", "4", "how many octaves of noise, 1 to 30");
const COLOR: Key = key("color", "1,1,1", "the colour where the pattern is full: r,g,b without blanks");
const COLOR2: Key = key("color2", "0,0,0", "the colour where the pattern is empty: r,g,b without blanks");
const HEIGHT: Key = key("height", "0.1", "how far the bumps rise");
const SOLID: &[Key] = &[SCALE, OCTAVES, COLOR, COLOR2];

/// The clauses of a material's text.
pub const CLAUSES: [Clause; 5] = [
    Clause { name: "noise", meaning: "A 3-D texture: clouds.", keys: SOLID },
    Clause { name: "marble", meaning: "A 3-D texture: veins across x.", keys: SOLID },
    Clause { name: "wood", meaning: "A 3-D texture: rings around y.", keys: SOLID },
    Clause {
        name: "checker",
        meaning: "A 3-D texture: cells of two colours.",
        keys: &[SCALE, COLOR, COLOR2],
    },
    Clause {
        name: "bump",
        meaning: "Leans the normals by the slopes of noise.",
        keys: &[SCALE, OCTAVES, HEIGHT],
    },
];

/// The names of a form's arguments, groups two blanks apart.
pub fn usage(spec: &Spec, form: &Form) -> String {
    written(spec, form, |_, name, _| name.to_owned())
}

/// A form as a snippet: each argument is a place to go to, with its name in it.
pub fn snippet(spec: &Spec, form: &Form) -> String {
    written(spec, form, |place, name, _| format!("${{{}:{name}}}", place + 1))
}

/// A form in its layout, with each argument as `one` writes it.
fn written(spec: &Spec, form: &Form, one: impl Fn(usize, &str, &Arguments) -> String) -> String {
    let starts = form.group_starts();
    let mut text = spec.word.to_owned();
    for (place, (name, group)) in form.each().enumerate() {
        let gap = if place > 0 && starts.contains(&place) { "  " } else { " " };
        text.push_str(gap);
        let word = one(place, name, group);
        match group.kind {
            ArgumentKind::Text => {
                let _ = write!(text, "!{word}!");
            }
            ArgumentKind::Number | ArgumentKind::Integer | ArgumentKind::Name => text.push_str(&word),
        }
    }
    text
}

/// What an argument means, with its unit.
pub fn meaning(name: &str, group: &Arguments) -> String {
    let unit = if group.unit.is_empty() { String::new() } else { format!(" ({})", group.unit) };
    let kind = match group.kind {
        ArgumentKind::Number => "number",
        ArgumentKind::Integer => "whole number",
        ArgumentKind::Name => "name",
        ArgumentKind::Text => "text between exclamation marks",
    };
    match group.names.len() {
        1 => format!("**`{name}`**, a {kind}: {}{unit}", group.meaning),
        _ => format!("**`{name}`** of `{}`, a {kind}: {}{unit}", group.names.join(" "), group.meaning),
    }
}

/// All that the table says of a directive, in Markdown.
pub fn about(spec: &Spec) -> String {
    let mut text = format!("{}\n", spec.meaning);
    for form in spec.forms {
        let _ = write!(text, "\n```ray\n{}\n```\n", usage(spec, form));
        for group in form.arguments {
            let unit = if group.unit.is_empty() { String::new() } else { format!(" ({})", group.unit) };
            let _ = writeln!(text, "- `{}`: {}{unit}", group.names.join(" "), group.meaning);
        }
    }
    if let Some(form) = spec.forms.first() {
        let _ = write!(text, "\nExample:\n```ray\n{}\n```\n", form.example);
    }
    text
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;
    use dotray_scene::Dialect;
    use dotray_scene::directive::find_in;
    use dotray_scene::procedural::parse_clauses;

    fn of(word: &str) -> &'static Spec {
        find_in(Dialect::Slides, word.as_bytes()).unwrap()
    }

    #[test]
    fn forms_stand_in_groups() {
        let spec = of("#shape_sphere");
        let form = spec.forms.first().unwrap();
        assert_eq!(usage(spec, form), "#shape_sphere m  cx cy cz  r");
        assert_eq!(snippet(spec, form), "#shape_sphere ${1:m}  ${2:cx} ${3:cy} ${4:cz}  ${5:r}");
        let material = of("#material");
        assert!(snippet(material, material.forms.first().unwrap()).ends_with("${16:tn} !${17:string}!"));
    }

    #[test]
    fn the_reader_knows_every_clause_and_key() {
        for clause in CLAUSES {
            let keys: Vec<String> =
                clause.keys.iter().map(|key| format!("{}={}", key.name, key.default)).collect();
            let (bare, _) = parse_clauses(clause.name);
            let (full, warnings) = parse_clauses(&format!("{} {}", clause.name, keys.join(" ")));
            assert!(warnings.is_empty(), "{warnings:?}");
            assert_eq!(bare, full, "{} has other defaults", clause.name);
            assert_eq!(bare.solids.len() + bare.bumps.len(), 1, "{}", clause.name);
        }
    }

    #[test]
    fn meanings_name_units() {
        let (name, group) = of("#camera").forms.first().unwrap().each().last().unwrap();
        assert_eq!(
            meaning(name, group),
            "**`ha`**, a number: half of the vertical view angle, between 0 and π/2 (radians)"
        );
        assert!(about(of("#camera")).contains("#camera 0 0 4  0 0 -1  0 1 0  .523"));
    }
}
