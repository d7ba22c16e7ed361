//! A suite: what is rendered, what it is worth, what is forgiven.

use dotray_image::Format;
use dotray_image::compare::profile::Allowance;
use dotray_image::compare::profile::Profile;
use dotray_render::Options;
use std::collections::BTreeMap;
use std::path::Component;
use std::path::Path;
use std::path::PathBuf;

use crate::error::GradeError;
use crate::settings::Credit;
use crate::settings::RunLimits;
use crate::settings::Settings;
use crate::settings::SuiteFile;
use crate::settings::Tolerance;
use crate::settings::divided;
use crate::variants::VARIANTS;

/// Tests in order, ready to be run.
#[derive(Clone, Debug)]
pub struct Suite {
    /// What the whole is called.
    pub title: String,
    /// Where its scenes are.
    pub folder: PathBuf,
    /// The format in which pictures are asked for.
    pub format: Format,
    /// What a picture is worth that is not quite right.
    pub credit: Credit,
    /// The tests.
    pub tests: Vec<Test>,
}

/// One scene and what is wanted of its picture.
#[derive(Clone, Debug)]
pub struct Test {
    /// A short name without blanks.
    pub name: String,
    /// What it is about.
    pub title: String,
    /// The scene's file, relative to the suite's folder.
    pub scene: PathBuf,
    /// What it is worth.
    pub points: f64,
    /// How our own renderer makes the picture.
    pub options: Options,
    /// What is forgiven.
    pub allowance: Allowance,
    /// Words for the command.
    pub arguments: Vec<String>,
    /// What the program may take.
    pub limits: RunLimits,
    /// Told to whoever fails it.
    pub advice: Option<String>,
    /// Names of the wrong variants that are tried; none for all.
    pub hints: Option<Vec<String>>,
    /// Other words for what a variant tells.
    pub say: BTreeMap<String, String>,
}

const MOST_BYTES: u64 = 16 << 20;

impl Suite {
    /// Reads a suite's file, or `suite.toml` of a folder.
    ///
    /// # Errors
    /// [`GradeError::Read`] or [`GradeError::Suite`], which says where and what.
    pub fn read(path: &Path) -> Result<Self, GradeError> {
        let path = if path.is_dir() { path.join("suite.toml") } else { path.to_owned() };
        let read = |message: String| GradeError::Read { path: path.clone(), message };
        let size = std::fs::metadata(&path).map_err(|error| read(error.to_string()))?.len();
        if size > MOST_BYTES {
            return Err(read(format!("it has {size} bytes, at most {MOST_BYTES} are read")));
        }
        let text = std::fs::read_to_string(&path).map_err(|error| read(error.to_string()))?;
        let folder = path.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."));
        Self::parse(&text, folder).map_err(|message| GradeError::Suite { path: path.clone(), message })
    }

    /// Understands the text of a suite whose scenes are in `folder`.
    ///
    /// # Errors
    /// A sentence that names the test, the setting, its value and what was expected.
    pub fn parse(text: &str, folder: &Path) -> Result<Self, String> {
        let file: SuiteFile =
            toml::from_str(text).map_err(|error| error.to_string().trim_end().to_owned())?;
        let format = match &file.format {
            None => Format::Png,
            Some(extension) => {
                Format::from_path(Path::new(&format!("picture.{extension}"))).map_err(|_| {
                    format!("format is `{extension}`, expected an extension such as png, bmp or ppm")
                })?
            }
        };
        for share in [file.credit.lenient, file.credit.partial] {
            if !(0.0..=1.0).contains(&share) {
                return Err(format!("a credit is {share}, expected 0 to 1"));
            }
        }
        let mut tests: Vec<Test> = Vec::new();
        for table in file.test {
            let name = table.get("name").and_then(toml::Value::as_str).unwrap_or("without a name").to_owned();
            let test = test(table, &file.defaults).map_err(|message| format!("test `{name}`: {message}"))?;
            if tests.iter().any(|other| other.name == name) {
                return Err(format!("two tests are called `{name}`"));
            }
            tests.push(test);
        }
        if tests.is_empty() {
            return Err("there is no test".to_owned());
        }
        Ok(Self { title: file.title, folder: folder.to_owned(), format, credit: file.credit, tests })
    }

    /// Keeps the tests of these names, in the suite's order; all of them if there is no name.
    ///
    /// # Errors
    /// The first name that no test has.
    pub fn keep_if_any(&mut self, names: &[String]) -> Result<(), String> {
        if names.is_empty() {
            return Ok(());
        }
        if let Some(unknown) = names.iter().find(|name| self.tests.iter().all(|test| test.name != **name)) {
            return Err(format!("no test is called `{unknown}`"));
        }
        self.tests.retain(|test| names.contains(&test.name));
        Ok(())
    }

    /// The points that can be had.
    pub fn points(&self) -> f64 {
        self.tests.iter().map(|test| test.points).sum()
    }
}

fn test(table: toml::Table, defaults: &Settings) -> Result<Test, String> {
    let (table, settings) = divided(table)?;
    let good = |c: char| c.is_ascii_alphanumeric() || "-_.".contains(c);
    if table.name.is_empty() || !table.name.chars().all(good) {
        return Err("a name consists of letters, digits, `-`, `_` and `.`".to_owned());
    }
    let scene = PathBuf::from(&table.scene);
    if scene.components().any(|part| !matches!(part, Component::Normal(_) | Component::CurDir)) {
        return Err(format!("scene is `{}`, expected a file in the suite's folder", table.scene));
    }
    let known = |name: &String| VARIANTS.iter().any(|variant| variant.name == *name);
    if let Some(unknown) = table.hints.iter().flatten().chain(table.say.keys()).find(|name| !known(name)) {
        let names: Vec<&str> = VARIANTS.iter().map(|variant| variant.name).collect();
        return Err(format!("no variant is called `{unknown}`; there are {}", names.join(", ")));
    }
    let settings = settings.or(defaults);
    let points = settings.points.unwrap_or(1.0);
    if !(points.is_finite() && points >= 0.0) {
        return Err(format!("points is {points}, expected 0 or more"));
    }
    let strict = Ok(Profile::Strict.allowance());
    Ok(Test {
        title: table.title.unwrap_or_else(|| table.name.clone()),
        name: table.name,
        scene,
        points,
        options: settings.options()?,
        allowance: settings.tolerance.as_ref().map_or(strict, Tolerance::allowance)?,
        limits: settings.limits()?,
        arguments: settings.arguments.unwrap_or_default(),
        advice: table.advice,
        hints: table.hints,
        say: table.say,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    const GOOD: &str = "title = 'T'\nformat = 'bmp'\n[defaults]\nwidth = 40\n\
        [[test]]\nname = 'a'\nscene = 'a.ray'\npoints = 2\n[[test]]\nname = 'b'\nscene = 'deep/b.ray'\nwidth = 20\n";

    #[test]
    fn a_suite_is_read() {
        let mut suite = Suite::parse(GOOD, Path::new("folder")).unwrap();
        assert_eq!((suite.title.as_str(), suite.format, suite.points()), ("T", Format::Bmp, 3.0));
        let widths: Vec<u32> = suite.tests.iter().map(|test| test.options.width).collect();
        assert_eq!(widths, [40, 20]);
        assert!(suite.keep_if_any(&["c".to_owned()]).unwrap_err().contains("`c`"));
        suite.keep_if_any(&["b".to_owned()]).unwrap();
        assert_eq!(suite.tests.len(), 1);
    }

    #[test]
    fn faults_name_the_test_and_the_setting() {
        let fault = |from: &str, to: &str| {
            assert!(GOOD.contains(from));
            Suite::parse(&GOOD.replace(from, to), Path::new("")).unwrap_err()
        };
        for (from, to, part) in [
            ("width = 20", "widht = 20", "widht"),
            ("width = 20", "width = 0", "test `b`: width is 0"),
            ("width = 20", "hints = ['x']", "no variant is called `x`"),
            ("width = 20", "say = { x = 'y' }", "no variant is called `x`"),
            ("'b'\n", "'a'\n", "two tests"),
            ("'b'\n", "'b c'\n", "letters"),
            ("deep/b.ray", "../b.ray", "in the suite's folder"),
            ("deep/b.ray", "/b.ray", "in the suite's folder"),
            ("points = 2", "points = -2", "0 or more"),
            ("'bmp'", "'gif'", "format is `gif`"),
            ("title = 'T'", "", "title"),
            ("title = 'T'", "title = 3", "line 1"),
            ("[defaults]", "[credit]\nlenient = 2\n[defaults]", "0 to 1"),
        ] {
            let message = fault(from, to);
            assert!(message.contains(part), "{to}: {message}");
        }
    }
}
