//! Names of files with a number in them: `out.####.png`.

use std::path::Path;
use std::path::PathBuf;

use crate::exit::Failure;

/// The name of a frame's file: the last run of `#` in the name stands for its number, filled up with zeros.
pub fn numbered(pattern: &Path, frame: u32) -> Result<PathBuf, Failure> {
    let name = pattern.file_name().unwrap_or_default().to_string_lossy().into_owned();
    let Some(last) = name.rfind('#') else {
        return Err(Failure::Usage(format!(
            "`{}` needs a place for the number of the frame, such as out.####.png",
            pattern.display()
        )));
    };
    let first = name[..last]
        .rfind(|c| c != '#')
        .map_or(0, |before| before + name[before..].chars().next().map_or(1, char::len_utf8));
    let width = last + 1 - first;
    Ok(pattern.with_file_name(format!("{}{frame:0width$}{}", &name[..first], &name[last + 1..])))
}

/// Numbers as people write them: `3, 7-9`.
pub fn ranges(numbers: &[u32]) -> String {
    let mut shown: Vec<String> = Vec::new();
    let mut rest = numbers;
    while let Some(&first) = rest.first() {
        let length = rest.iter().zip(first..).take_while(|(a, b)| **a == *b).count();
        let last = first + length as u32 - 1;
        shown.push(if first == last { first.to_string() } else { format!("{first}-{last}") });
        rest = &rest[length..];
    }
    shown.join(", ")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_stand_in_the_place_of_signs() {
        let name =
            |pattern: &str, frame| numbered(pattern.as_ref(), frame).ok().map(|p| p.display().to_string());
        assert_eq!(name("a/out.####.png", 7).as_deref(), Some("a/out.0007.png"));
        assert_eq!(name("##-#.png", 12345).as_deref(), Some("##-12345.png"));
        assert_eq!(name("é##.png", 1).as_deref(), Some("é01.png"));
        assert_eq!(name("#/out.png", 1), None);
        assert_eq!(ranges(&[3, 7, 8, 9, 11]), "3, 7-9, 11");
        assert_eq!(ranges(&[]), "");
    }
}
