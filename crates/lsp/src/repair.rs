//! Likely repairs that a message names, as changes of the text.

use crate::statement::Statements;
use dotray_scene::Diagnostic;
use std::path::Path;

/// A change of the text.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Repair {
    /// What it does, in one sentence.
    pub title: String,
    /// The first byte that goes.
    pub start: usize,
    /// The byte after the last that goes.
    pub end: usize,
    /// What comes in its place.
    pub text: String,
}

/// The repair of a fault of this text, where its message names one.
pub fn repair(diagnostic: &Diagnostic, bytes: &[u8]) -> Option<Repair> {
    let span = diagnostic.span?;
    let (start, end) = (usize::try_from(span.start).ok()?, usize::try_from(span.end).ok()?);
    let written = std::str::from_utf8(bytes.get(start..end)?).ok()?;
    let help = diagnostic.help.as_deref();
    let put = |text: String| {
        let title = format!("Write `{}`", shortened(&text));
        Some(Repair { title, start, end, text })
    };
    match diagnostic.code {
        "unknown-directive" => put(quoted(help?).filter(|word| word.starts_with('#'))?.to_owned()),
        "letter-case" => put(written.to_lowercase()),
        "half-angle" | "spot-angle" => {
            written.parse::<f64>().ok()?;
            let radians = help?.rsplit([' ', '`']).find(|word| !word.is_empty())?;
            radians.parse::<f64>().ok()?;
            put(radians.to_owned())
        }
        "count-hint" => {
            written.parse::<f64>().ok()?;
            put(quoted(help?)?.rsplit(' ').next()?.to_owned())
        }
        "attenuation" => (written.split_whitespace().count() == 3).then(|| put(quoted(help?)?.to_owned()))?,
        "group-matrix" => matrix(quoted(help?)?, bytes, start),
        "include-not-found" | "texture-not-found" => name(quoted(help?)?, written, start),
        _ => None,
    }
}

/// The first words in backquotes.
fn quoted(text: &str) -> Option<&str> {
    text.split('`').nth(1)
}

/// All 16 numbers of the group whose row is at byte `at`.
fn matrix(numbers: &str, bytes: &[u8], at: usize) -> Option<Repair> {
    if numbers.split_whitespace().count() != 16 {
        return None;
    }
    let around =
        Statements::new(bytes).find(|statement| (statement.word.start..statement.end).contains(&at))?;
    let first = around.arguments.len().checked_sub(16)?;
    let (first, last) = (around.arguments.get(first)?, around.arguments.last()?);
    let title = format!("Put in the matrix `{numbers}`");
    let words: Vec<&str> = numbers.split_whitespace().collect();
    let rows: Vec<String> = words.chunks(4).map(|row| row.join(" ")).collect();
    Some(Repair { title, start: first.start, end: last.end, text: rows.join("  ") })
}

/// The last part of the name in a `#texture` or `#ray_file` becomes that of a file which is there.
fn name(there: &str, written: &str, start: usize) -> Option<Repair> {
    let file = Path::new(there).file_name()?.to_str()?;
    let end = written.trim_end_matches('"').len();
    let named = written.get(..end)?;
    let is_quoted = end < written.len();
    let begin = named.rfind(['/', '\\', '"']).or_else(|| named.rfind(char::is_whitespace))? + 1;
    // A name with blanks needs its quotes, which are not there.
    if !is_quoted && file.contains(char::is_whitespace) {
        return None;
    }
    let title = format!("Name the file `{file}`");
    Some(Repair { title, start: start + begin, end: start + end, text: file.to_owned() })
}

fn shortened(text: &str) -> String {
    const MOST: usize = 60;
    let short: String = text.chars().take(MOST).collect();
    if short.len() < text.len() { short + "…" } else { short }
}

#[cfg(test)]
#[allow(clippy::unwrap_used, clippy::indexing_slicing)]
mod tests {
    use super::*;
    use dotray_scene::files::Disk;
    use dotray_scene::load::LoadOptions;
    use dotray_scene::load::load_text;

    /// The text with the repair of the first fault of this code.
    fn repaired(code: &str, text: &str) -> String {
        let loaded = load_text("a.ray", text, &Disk, &LoadOptions::default());
        let fault = loaded.diagnostics.iter().find(|found| found.code == code).unwrap();
        let repair = repair(fault, text.as_bytes()).unwrap_or_else(|| panic!("no repair: {fault:?}"));
        format!("{}{}{}", &text[..repair.start], repair.text, &text[repair.end..])
    }

    #[test]
    fn what_the_message_names_is_put_in_place() {
        let cases = [
            ("unknown-directive", "#shape_spere -1 0 0 0 1", "#shape_sphere -1 0 0 0 1"),
            ("letter-case", "#Ambient 1 1 1", "#ambient 1 1 1"),
            (
                "half-angle",
                "#camera 0 0 4 0 0 -1 0 1 0 30 // \u{e4}",
                "#camera 0 0 4 0 0 -1 0 1 0 0.5236 // \u{e4}",
            ),
            ("count-hint", "#light_num 2\n#light_dir 1 1 1 0 -1 0", "#light_num 1\n#light_dir 1 1 1 0 -1 0"),
            ("attenuation", "#light_point 1 1 1 0 0 0 0 0 0", "#light_point 1 1 1 0 0 0 1 0 0"),
            (
                "group-matrix",
                "#group_begin 1 0 0 0 0 1 0 0 0 0 1 0 1 2 3 1\n#group_end",
                "#group_begin 1 0 0 1  0 1 0 2  0 0 1 3  0 0 0 1\n#group_end",
            ),
        ];
        for (code, text, expected) in cases {
            assert_eq!(repaired(code, text), expected, "{code}");
        }
    }

    #[test]
    fn a_name_keeps_its_folder() {
        let of =
            |there, written| name(there, written, 0).map(|repair| (repair.start, repair.end, repair.text));
        assert_eq!(of("x/wood.png", "#texture x/wod.png"), Some((11, 18, "wood.png".to_owned())));
        assert_eq!(of("wood.png", "#texture \"wod.png\""), Some((10, 17, "wood.png".to_owned())));
        assert_eq!(of("w d.png", "#texture wod.png"), None);
    }
}
