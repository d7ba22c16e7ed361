//! The canonical layout, as the smallest change of lines.

use crate::documents::Document;
use crate::text::Text;
use dotray_scene::Files;
use dotray_scene::Severity;
use dotray_scene::format::format_text;
use dotray_scene::format::is_structural;
use dotray_scene::format::says_the_same;
use dotray_scene::load::LoadOptions;
use dotray_scene::load::load_text;
use lsp_types::TextEdit;
use std::io;
use std::path::Path;

/// The change that lays a text out; none where it is laid out already.
///
/// # Errors
/// Why it cannot be, in one sentence: it has faults that leave its layout open.
pub fn layout(document: &Document) -> Result<Vec<TextEdit>, String> {
    if document.is_too_large() {
        return Err("the text is too large to be laid out here".to_owned());
    }
    let old = &document.bytes;
    let loaded = load_text("text", old.clone(), &Nothing, &LoadOptions::default());
    let mut errors = loaded.diagnostics.iter().filter(|fault| fault.severity == Severity::Error);
    if let Some(fault) = errors.find(|fault| is_structural(fault.code) && fault.code != "cannot-read") {
        return Err(format!("the text is not laid out before this is repaired: {}", fault.message));
    }
    let new = format_text(old).map_err(|error| format!("the text cannot be laid out: {error}"))?;
    if !says_the_same(old, &new) {
        return Err("the layout would change words, which is a fault of this program".to_owned());
    }
    let new = String::from_utf8(new).map_err(|_| "the text is not UTF-8".to_owned())?;
    Ok(change(old, &new).into_iter().collect())
}

/// The change of whole lines that makes `new` of `old`.
fn change(old: &[u8], new: &str) -> Option<TextEdit> {
    if old == new.as_bytes() {
        return None;
    }
    let (old_lines, new_lines) = (lines(old), lines(new.as_bytes()));
    let start = alike(old_lines.iter().zip(&new_lines));
    let (rest_old, rest_new) = (lines(old.get(start..)?), lines(new.as_bytes().get(start..)?));
    let back = alike(rest_old.iter().rev().zip(rest_new.iter().rev()));
    let end = old.len() - back;
    let text = new.get(start..new.len() - back)?.to_owned();
    Some(TextEdit::new(Text::new(old).range(start, end), text))
}

/// How many bytes the pairs of lines have that begin the list and are equal.
fn alike<'a>(pairs: impl Iterator<Item = (&'a &'a [u8], &'a &'a [u8])>) -> usize {
    pairs.take_while(|(one, other)| one == other).map(|(one, _)| one.len()).sum()
}

/// Lines with their ends.
fn lines(bytes: &[u8]) -> Vec<&[u8]> {
    bytes.split_inclusive(|&byte| byte == b'\n').collect()
}

/// Included files have no say in a file's layout.
struct Nothing;

impl Files for Nothing {
    fn read(&self, _: &Path) -> io::Result<Vec<u8>> {
        Err(io::ErrorKind::NotFound.into())
    }
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;
    use crate::text::replace;

    #[test]
    fn only_lines_that_differ_change() {
        let cases = [
            ("a\nb  \nc\n", "a\nb\nc\n"),
            ("a\nb", "a\nb\n"),
            ("\n\na\n", "a\n"),
            ("a\na\na\n", "a\na\n"),
            ("", "a\n"),
            ("a\n", ""),
            ("\u{e4}\u{1d11e} \n#b", "\u{e4}\u{1d11e}\n#b"),
        ];
        for (old, new) in cases {
            let edit = change(old.as_bytes(), new).unwrap();
            let mut bytes = old.as_bytes().to_vec();
            replace(&mut bytes, edit.range, &edit.new_text);
            assert_eq!(bytes, new.as_bytes(), "{old:?}");
        }
        let edit = change(b"a\nb  \nc\n", "a\nb\nc\n").unwrap();
        assert_eq!((edit.range.start.line, edit.range.end.line, edit.new_text.as_str()), (1, 2, "b\n"));
        assert_eq!(change(b"a\n", "a\n"), None);
    }
}
