//! What was probably meant by a name that names nothing.

use crate::directive;
use crate::files::Files;
use std::path::Path;

/// Longer names are compared with none: the work grows with the product of the lengths.
const LONGEST: usize = 64;

/// A file in the same folder whose name is nearly that of `path`, or differs in upper and lower case alone.
pub fn similar_file(files: &dyn Files, path: &Path) -> Option<String> {
    let folder = path.parent().unwrap_or(Path::new(""));
    let wanted = path.file_name()?.to_str()?;
    let names = files.names_in(folder);
    let name = nearest(wanted, names.iter().map(String::as_str))?;
    Some(folder.join(name).display().to_string())
}

/// The name nearest to `wanted`, if one is near; letter case does not count.
pub fn nearest<'a>(wanted: &str, names: impl Iterator<Item = &'a str>) -> Option<&'a str> {
    let (distance, name) = ranked(wanted, names).min()?;
    (distance <= near(wanted)).then_some(name)
}

/// All names near to `wanted`, and those that hold it, the nearest first.
pub fn near_names<'a>(wanted: &str, names: impl Iterator<Item = &'a str>) -> Vec<&'a str> {
    let lower = wanted.to_ascii_lowercase();
    let holds = |name: &str| lower.len() > 2 && (name.contains(&lower) || lower.contains(name));
    let mut found: Vec<(usize, &str)> =
        ranked(wanted, names).filter(|(distance, name)| *distance <= near(wanted) || holds(name)).collect();
    found.sort_unstable();
    found.into_iter().map(|(_, name)| name).collect()
}

fn near(wanted: &str) -> usize {
    (wanted.len() / 4).clamp(1, 4)
}

fn ranked<'a>(wanted: &str, names: impl Iterator<Item = &'a str>) -> impl Iterator<Item = (usize, &'a str)> {
    let wanted = wanted.to_ascii_lowercase();
    let short = names.filter(move |name| name.len() <= LONGEST);
    let is_short = wanted.len() <= LONGEST;
    short.filter(move |_| is_short).map(move |name| {
        (directive::edit_distance(name.to_ascii_lowercase().as_bytes(), wanted.as_bytes()), name)
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn near_names_are_found_and_far_ones_are_not() {
        let names = ["half-angle", "unknown-material", "unknown-texture", "no-light"];
        let of = |wanted| nearest(wanted, names.into_iter());
        assert_eq!(of("half-angel"), Some("half-angle"));
        assert_eq!(of("Unknown_Texture"), Some("unknown-texture"));
        assert_eq!(of("camera"), None);
        assert_eq!(of(&"x".repeat(1000)), None);
        assert_eq!(near_names("unknown", names.into_iter()), ["unknown-texture", "unknown-material"]);
        assert_eq!(near_names("no-ligth", names.into_iter()), ["no-light"]);
    }
}
