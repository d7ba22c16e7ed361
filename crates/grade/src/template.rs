//! The program's command line, with places for what differs from test to test.

use std::path::Path;

use crate::error::GradeError;

/// Words as a shell would split them, without a shell.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Template {
    words: Vec<String>,
}

/// What is put in the places.
#[derive(Clone, Debug)]
pub struct Values<'a> {
    /// `{scene}`
    pub scene: &'a Path,
    /// `{output}`
    pub output: &'a Path,
    /// `{width}`
    pub width: u32,
    /// `{height}`
    pub height: u32,
    /// `{recursion}`
    pub recursion: u32,
    /// `{cutoff}`
    pub cutoff: f64,
    /// `{arguments}`: several words, or none.
    pub arguments: &'a [String],
}

const PLACES: [&str; 7] =
    ["{scene}", "{output}", "{width}", "{height}", "{recursion}", "{cutoff}", "{arguments}"];

impl Template {
    /// Splits a command line and finds its places.
    ///
    /// # Errors
    /// [`GradeError::Program`] for an open quote, no word, an unknown place, or without `{scene}` and `{output}`.
    pub fn parse(text: &str) -> Result<Self, GradeError> {
        let fault = |message: String| Err(GradeError::Program(message));
        let Some(words) = shlex::split(text) else {
            return fault(format!("--program `{text}`: a quote is not closed"));
        };
        if words.first().is_none_or(String::is_empty) {
            return fault("--program is empty, expected a command with {scene} and {output}".to_owned());
        }
        for word in &words {
            if let Some(place) = unknown_place(word) {
                return fault(format!("--program has `{place}`; known places are {}", PLACES.join(" ")));
            }
        }
        for needed in ["{scene}", "{output}"] {
            if !words.iter().skip(1).any(|word| word.contains(needed)) {
                return fault(format!("--program needs {needed} among its words"));
            }
        }
        Ok(Self { words })
    }

    /// The same command for another working folder: words that name existing files below `folder` become whole paths.
    /// The first word does so only where it holds a slash; else the system looks it up.
    #[must_use]
    pub fn rooted(&self, folder: &Path) -> Self {
        let root = |(place, word): (usize, &String)| {
            let path = folder.join(word);
            let named = place > 0 || word.contains('/') || word.contains(std::path::MAIN_SEPARATOR);
            match !word.is_empty() && !word.starts_with('-') && named && path.exists() {
                true => path.to_string_lossy().into_owned(),
                false => word.clone(),
            }
        };
        Self { words: self.words.iter().enumerate().map(root).collect() }
    }

    /// The program: the first word.
    pub fn program(&self) -> &str {
        self.words.first().map_or("", String::as_str)
    }

    /// The words of one run.
    pub fn fill(&self, values: &Values) -> Vec<String> {
        let texts = [
            values.scene.to_string_lossy().into_owned(),
            values.output.to_string_lossy().into_owned(),
            values.width.to_string(),
            values.height.to_string(),
            values.recursion.to_string(),
            values.cutoff.to_string(),
        ];
        let mut words = Vec::new();
        let mut given = false;
        for word in &self.words {
            if word == "{arguments}" {
                words.extend(values.arguments.iter().cloned());
                given = true;
            } else {
                words.push(filled(word, &texts));
            }
        }
        if !given {
            words.extend(values.arguments.iter().cloned());
        }
        words
    }
}

/// Puts the texts in their places, from left to right: what was put in is not looked at again.
fn filled(word: &str, texts: &[String]) -> String {
    let mut filled = String::new();
    let mut rest = word;
    while let Some(at) = rest.find('{') {
        let (before, from) = rest.split_at(at);
        filled.push_str(before);
        let found = PLACES.iter().zip(texts).find(|(place, _)| from.starts_with(**place));
        let (text, length) = found.map_or(("{", 1), |(place, text)| (text.as_str(), place.len()));
        filled.push_str(text);
        rest = from.split_at(length).1;
    }
    filled + rest
}

/// What looks like a place (a word in braces) and is none.
fn unknown_place(word: &str) -> Option<&str> {
    let mut rest = word;
    while let Some(at) = rest.find('{') {
        let from = rest.split_at(at).1;
        let end = from.find('}')? + 1;
        let (place, after) = from.split_at(end);
        let name = place.trim_matches(['{', '}']);
        let is_name = !name.is_empty() && name.chars().all(|c| c.is_ascii_lowercase() || c == '_');
        let misplaced = place == "{arguments}" && word != place;
        if is_name && (!PLACES.contains(&place) || misplaced) {
            return Some(place);
        }
        rest = after;
    }
    None
}

#[cfg(test)]
mod tests {
    use super::*;

    fn fill(text: &str, arguments: &[&str]) -> Vec<String> {
        let arguments: Vec<String> = arguments.iter().map(|word| (*word).to_owned()).collect();
        Template::parse(text).unwrap().fill(&Values {
            scene: Path::new("a b/{width}.ray"),
            output: Path::new("out.bmp"),
            width: 40,
            height: 30,
            recursion: 5,
            cutoff: 0.002,
            arguments: &arguments,
        })
    }

    #[test]
    fn places_are_filled_after_splitting() {
        let words =
            fill("'./my tracer' --in={scene} {output} {width}x{height} {recursion} {cutoff} a{b", &[]);
        assert_eq!(words, ["./my tracer", "--in=a b/{width}.ray", "out.bmp", "40x30", "5", "0.002", "a{b"]);
        assert_eq!(fill("t {arguments} {scene} {output}", &["-a", "b"])[1..3], ["-a", "b"]);
        assert_eq!(fill("t {scene} {output}", &["-a"])[3], "-a");
        assert_eq!(fill("t {arguments} {scene} {output}", &[]).len(), 3);
    }

    #[test]
    fn wrong_commands_are_refused() {
        for (text, part) in [
            ("", "is empty"),
            ("t 'x", "quote"),
            ("t {scene}", "{output}"),
            ("{scene} {output}", "{scene}"),
            ("t {scene} {output} {widht}", "`{widht}`"),
            ("t {scene} {output} -{arguments}", "`{arguments}`"),
        ] {
            let message = Template::parse(text).unwrap_err().to_string();
            assert!(message.contains(part), "{text}: {message}");
        }
    }

    #[test]
    fn relative_files_are_found_from_elsewhere() {
        let folder = tempfile::tempdir().unwrap();
        std::fs::write(folder.path().join("ray.py"), "").unwrap();
        let template = Template::parse("ray.py ray.py none.py -ray.py {scene} {output}").unwrap();
        let rooted = template.rooted(folder.path());
        assert_eq!(rooted.program(), "ray.py");
        assert_eq!(rooted.words[1], folder.path().join("ray.py").to_string_lossy());
        assert_eq!(rooted.words[2..4], ["none.py", "-ray.py"]);
        let slash = Template::parse("./ray.py {scene} {output}").unwrap().rooted(folder.path());
        assert!(Path::new(slash.program()).is_absolute());
    }
}
