//! What an argument names: a material, a texture, a vertex, a file.

use crate::spot::On;
use crate::spot::Spot;
use crate::statement::Statement;
use crate::statement::Statements;
use crate::statement::inner;
use crate::statement::slice;
use dotray_scene::Dialect;
use dotray_scene::directive::Directive;
use dotray_scene::model::Placed;
use dotray_scene::resolve::resolve_texture;
use dotray_scene::span::Span;
use std::path::Path;
use std::path::PathBuf;

/// What an argument names.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Named {
    /// The directive of this kind and number, from 0.
    Number(Directive, usize),
    /// A file, by the places where it may be.
    File(Vec<PathBuf>),
    /// A material by its name, in a dialect that gives them names.
    Material(String),
}

/// The kind of directive whose number an argument is.
pub fn numbered(directive: Directive, argument: &str) -> Option<Directive> {
    match (directive, argument) {
        (Directive::RayFileInstance, "n") => Some(Directive::RayFile),
        (Directive::Material, "tn") => Some(Directive::Texture),
        (Directive::ShapeTriangle, "i" | "j" | "k") => Some(Directive::Vertex),
        (_, "m") => Some(Directive::Material),
        _ => None,
    }
}

/// What the argument under the cursor names.
pub fn named(bytes: &[u8], path: &Path, dialect: Dialect, spot: &Spot) -> Option<Named> {
    let On::Argument(index) = spot.on else { return None };
    named_by(bytes, path, dialect, spot.statement.as_ref()?, index)
}

/// What an argument names.
pub fn named_by(
    bytes: &[u8],
    path: &Path,
    dialect: Dialect,
    statement: &Statement,
    index: usize,
) -> Option<Named> {
    let token = *statement.arguments.get(index)?;
    let before = index.checked_sub(1).and_then(|before| statement.arguments.get(before));
    if index < statement.flags(bytes) {
        let is_material = before.is_some_and(|flag| slice(bytes, *flag) == b"-m");
        return is_material.then(|| Named::Material(inner(bytes, token)));
    }
    let spec = statement.spec(bytes, dialect)?;
    let (name, _) = statement.argument(bytes, spec, index)?;
    match (spec.directive, name) {
        (Directive::Texture | Directive::RayFile | Directive::KeyFile | Directive::Shader, _) => {
            let value = inner(bytes, token);
            // Textures are looked for where other files are.
            Some(Named::File(
                resolve_texture(path, dialect, &Placed { value, span: Span::default() }).candidates,
            ))
        }
        (directive, name) => {
            let number = std::str::from_utf8(slice(bytes, token)).ok()?.parse().ok()?;
            Some(Named::Number(numbered(directive, name)?, number))
        }
    }
}

/// The directives of a kind with their numbers.
pub fn all_of(bytes: &[u8], dialect: Dialect, kind: Directive) -> impl Iterator<Item = Statement> {
    Statements::new(bytes)
        .filter(move |statement| statement.spec(bytes, dialect).is_some_and(|spec| spec.directive == kind))
}

/// The directive in the same text that is named.
pub fn target(bytes: &[u8], dialect: Dialect, named: &Named) -> Option<Statement> {
    match named {
        Named::Number(kind, number) => all_of(bytes, dialect, *kind).nth(*number),
        Named::Material(name) => all_of(bytes, dialect, Directive::Material).find(|statement| {
            let mut pairs = statement.arguments.windows(2);
            pairs.any(|pair| {
                let [flag, value] = pair else { return false };
                slice(bytes, *flag) == b"-n" && inner(bytes, *value) == *name
            })
        }),
        Named::File(_) => None,
    }
}

/// The first of the places where there is a file.
pub fn existing(candidates: &[PathBuf]) -> Option<&PathBuf> {
    candidates.iter().find(|path| path.is_file())
}

/// The number of a directive among those of its kind.
pub fn number_of(bytes: &[u8], dialect: Dialect, kind: Directive, statement: &Statement) -> usize {
    all_of(bytes, dialect, kind).take_while(|other| other.word.start < statement.word.start).count()
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;

    fn at(text: &str, dialect: Dialect) -> (String, Option<Named>) {
        let place = text.find('|').unwrap();
        let text = text.replacen('|', "", 1);
        let spot = Spot::new(text.as_bytes(), place);
        let named = named(text.as_bytes(), Path::new("/x/a.ray"), dialect, &spot);
        (text, named)
    }

    #[test]
    fn numbers_and_names_are_followed() {
        let cases = [
            ("#shape_sphere 3| 0 0 0 1", Some(Named::Number(Directive::Material, 3))),
            ("#shape_sphere -1| 0 0 0 1", None),
            ("#shape_sphere 3 0| 0 0 1", None),
            ("#shape_triangle 3 0 7| 0", Some(Named::Number(Directive::Vertex, 7))),
            ("#shape_triangle 3 0 7| 0 1", None),
            ("#material 0 0 0 0 0 0 0 0 0 0 0 0 0 0 1 |2 !!", Some(Named::Number(Directive::Texture, 2))),
            ("#ray_file_instance 1|", Some(Named::Number(Directive::RayFile, 1))),
            ("#vertex_num 1|", None),
        ];
        for (text, expected) in cases {
            assert_eq!(at(text, Dialect::Slides).1, expected, "{text}");
        }
        let Some(Named::File(places)) = at("#texture \"a b|.png\"", Dialect::Slides).1 else {
            panic!("no file")
        };
        assert_eq!(places.first().unwrap(), Path::new("/x/a b.png"));
    }

    #[test]
    fn the_target_is_found_by_number_or_name() {
        let (text, named) = at("#material 1\n#MATERIAL 2 // 3\n#shape_sphere 1| 0 0 0 1", Dialect::Slides);
        let found = target(text.as_bytes(), Dialect::Slides, &named.unwrap()).unwrap();
        assert_eq!(found.word.start, 12);
        assert_eq!(number_of(text.as_bytes(), Dialect::Slides, Directive::Material, &found), 1);
        let (text, named) =
            at("#material -n red -- 1\n#material -n blue -- 2\n#sphere -m |blue -- 0 0 0 1", Dialect::Hmc);
        assert_eq!(target(text.as_bytes(), Dialect::Hmc, &named.unwrap()).unwrap().word.start, 22);
    }
}
