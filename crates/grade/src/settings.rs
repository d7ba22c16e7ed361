//! What may stand in a suite's file, as typed: one table for all tests (`defaults`) and one for each.

use dotray_image::compare::profile::Allowance;
use dotray_image::compare::profile::Profile;
use dotray_render::Antialias;
use dotray_render::Options;
use dotray_render::Shadows;
use dotray_render::TextureFilter;
use serde::Deserialize;
use std::collections::BTreeMap;
use std::time::Duration;

/// The file.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct SuiteFile {
    /// What the whole is called.
    pub title: String,
    /// The pictures' file name extension [default: png].
    pub format: Option<String>,
    /// What a picture is worth that is not quite right.
    #[serde(default)]
    pub credit: Credit,
    /// Settings of all tests that do not say otherwise.
    #[serde(default)]
    pub defaults: Settings,
    /// The tests, in teaching order: [`TestHead`] and [`Settings`] in one.
    pub test: Vec<toml::Table>,
}

/// What a picture is worth that is not within its tolerance, as a share of the test's points.
#[derive(Clone, Copy, Debug, Deserialize, PartialEq)]
#[serde(deny_unknown_fields, default)]
pub struct Credit {
    /// Within the profile `lenient`.
    pub lenient: f64,
    /// At most, and in proportion, where more than half of what is seen is right.
    pub partial: f64,
}

impl Default for Credit {
    fn default() -> Self {
        Self { lenient: 0.75, partial: 0.5 }
    }
}

/// What only a test has.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct TestHead {
    /// A short name without blanks.
    pub name: String,
    /// What it is about.
    pub title: Option<String>,
    /// The scene's file, relative to the suite's.
    pub scene: String,
    /// Told to whoever fails it.
    pub advice: Option<String>,
    /// Which wrong variants are tried [default: all].
    pub hints: Option<Vec<String>>,
    /// Other words for what a variant tells.
    #[serde(default)]
    pub say: BTreeMap<String, String>,
}

/// Divides a test's table: what only a test has, and whatever differs from the defaults.
///
/// # Errors
/// What does not fit.
pub fn divided(table: toml::Table) -> Result<(TestHead, Settings), String> {
    const OF_HEAD: [&str; 6] = ["name", "title", "scene", "advice", "hints", "say"];
    let (head, settings): (toml::Table, toml::Table) =
        table.into_iter().partition(|(key, _)| OF_HEAD.contains(&key.as_str()));
    let fault = |error: toml::de::Error| error.message().to_owned();
    Ok((
        toml::Value::Table(head).try_into().map_err(fault)?,
        toml::Value::Table(settings).try_into().map_err(fault)?,
    ))
}

/// How a picture is made and judged.
#[derive(Clone, Debug, Default, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Settings {
    /// Points [default: 1].
    pub points: Option<f64>,
    /// Columns [default: 160].
    pub width: Option<u32>,
    /// Rows [default: 120].
    pub height: Option<u32>,
    /// The recursion limit [default: 5].
    pub recursion: Option<u32>,
    /// The contribution threshold [default: 0.002].
    pub cutoff: Option<f64>,
    /// Samples a pixel: `none`, `grid=N`, `adaptive` [default: none].
    pub aa: Option<String>,
    /// The colour difference above which `adaptive` divides [default: 0.1].
    pub aa_threshold: Option<f64>,
    /// How often it may [default: 3].
    pub aa_depth: Option<u32>,
    /// `filtered`, `opaque` or `off` [default: filtered].
    pub shadows: Option<String>,
    /// `bilinear` or `nearest` [default: bilinear].
    pub texture_filter: Option<String>,
    /// Point lights that stand for one area light [default: 64].
    pub light_samples: Option<u32>,
    /// What is forgiven [default: strict].
    pub tolerance: Option<Tolerance>,
    /// Words that the command gets at `{arguments}`, or at its end.
    pub arguments: Option<Vec<String>>,
    /// Seconds [default: 10].
    pub time_limit: Option<f64>,
    /// Memory of a process in MiB, 0 for no limit [default: 4096].
    pub memory_limit: Option<u64>,
    /// Size of a file that the program writes, in MiB [default: 64].
    pub file_limit: Option<u64>,
    /// Processes that the user may have, 0 for no limit [default: 0].
    pub process_limit: Option<u64>,
}

/// A profile, or one whose numbers are changed.
#[derive(Clone, Debug, Deserialize)]
#[serde(untagged)]
pub enum Tolerance {
    /// `exact`, `strict` or `lenient`.
    Profile(String),
    /// The numbers that differ from a profile's.
    Numbers(ToleranceTable),
}

/// The numbers of an [`Allowance`].
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ToleranceTable {
    profile: Option<String>,
    pixel: Option<f64>,
    share: Option<f64>,
    mean: Option<f64>,
    block: Option<f64>,
    flip: Option<f64>,
}

impl Tolerance {
    /// The numbers.
    ///
    /// # Errors
    /// A profile that does not exist, or a number below 0.
    pub fn allowance(&self) -> Result<Allowance, String> {
        let numbers = match self {
            Self::Profile(name) => return profile(name).map(Profile::allowance),
            Self::Numbers(numbers) => numbers,
        };
        let base = profile(numbers.profile.as_deref().unwrap_or("strict"))?.allowance();
        let allowance = Allowance {
            tolerance: numbers.pixel.unwrap_or(base.tolerance),
            share: numbers.share.unwrap_or(base.share),
            mean: numbers.mean.unwrap_or(base.mean),
            block: numbers.block.unwrap_or(base.block),
            flip: numbers.flip.unwrap_or(base.flip),
        };
        let Allowance { tolerance, share, mean, block, flip } = allowance;
        let fine = |value: f64| value.is_finite() && value >= 0.0;
        match [tolerance, share, mean, block, flip].into_iter().all(fine) {
            true => Ok(allowance),
            false => Err("a tolerance is a number of 0 or more".to_owned()),
        }
    }
}

fn profile(name: &str) -> Result<Profile, String> {
    let found = Profile::ALL.into_iter().find(|profile| profile.name() == name);
    found.ok_or_else(|| format!("tolerance is `{name}`, expected exact, strict or lenient"))
}

/// What a run of the program may take.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RunLimits {
    /// Seconds by the clock.
    pub time: Duration,
    /// Address space of a process in MiB; none for no limit.
    pub memory: Option<u64>,
    /// Size of a file in MiB; all files of its folder together may have four times that.
    pub file: u64,
    /// Processes of the user; none for no limit.
    pub processes: Option<u64>,
}

impl Settings {
    /// These settings, and where they say nothing, the others.
    pub fn or(self, other: &Self) -> Self {
        let other = other.clone();
        Self {
            points: self.points.or(other.points),
            width: self.width.or(other.width),
            height: self.height.or(other.height),
            recursion: self.recursion.or(other.recursion),
            cutoff: self.cutoff.or(other.cutoff),
            aa: self.aa.or(other.aa),
            aa_threshold: self.aa_threshold.or(other.aa_threshold),
            aa_depth: self.aa_depth.or(other.aa_depth),
            shadows: self.shadows.or(other.shadows),
            texture_filter: self.texture_filter.or(other.texture_filter),
            light_samples: self.light_samples.or(other.light_samples),
            tolerance: self.tolerance.or(other.tolerance),
            arguments: self.arguments.or(other.arguments),
            time_limit: self.time_limit.or(other.time_limit),
            memory_limit: self.memory_limit.or(other.memory_limit),
            file_limit: self.file_limit.or(other.file_limit),
            process_limit: self.process_limit.or(other.process_limit),
        }
    }

    /// How our own renderer makes the picture: on one thread, because tests run side by side.
    ///
    /// # Errors
    /// A sentence that names the setting, its value and what was expected.
    pub fn options(&self) -> Result<Options, String> {
        let defaults = Options::default();
        let options = Options {
            width: self.width.unwrap_or(160),
            height: self.height.unwrap_or(120),
            recursion: self.recursion.unwrap_or(defaults.recursion),
            threshold: self.cutoff.unwrap_or(defaults.threshold),
            antialias: self.antialias()?,
            shadows: self.shadows()?,
            texture_filter: self.texture_filter()?,
            light_samples: self.light_samples.unwrap_or(defaults.light_samples),
            threads: Some(1),
            ..defaults
        };
        options.validate().map_err(|error| error.to_string())?;
        // Every test's picture is held until the reports are written.
        match u64::from(options.width) * u64::from(options.height) <= MOST_PIXELS {
            true => Ok(options),
            false => Err(format!("a picture has at most {MOST_PIXELS} pixels")),
        }
    }

    fn antialias(&self) -> Result<Antialias, String> {
        match self.aa.as_deref() {
            None | Some("none") => Ok(Antialias::None),
            Some("adaptive") => Ok(Antialias::Adaptive {
                threshold: self.aa_threshold.unwrap_or(0.1),
                depth: self.aa_depth.unwrap_or(3),
            }),
            Some(other) => match other.strip_prefix("grid=").map(str::parse) {
                Some(Ok(n)) => Ok(Antialias::Grid(n)),
                Some(Err(_)) | None => {
                    Err(format!("aa is `{other}`, expected none, grid=N (such as grid=3) or adaptive"))
                }
            },
        }
    }

    fn shadows(&self) -> Result<Shadows, String> {
        match self.shadows.as_deref() {
            None | Some("filtered") => Ok(Shadows::Filtered),
            Some("opaque") => Ok(Shadows::Opaque),
            Some("off") => Ok(Shadows::Off),
            Some(other) => Err(format!("shadows is `{other}`, expected filtered, opaque or off")),
        }
    }

    fn texture_filter(&self) -> Result<TextureFilter, String> {
        match self.texture_filter.as_deref() {
            None | Some("bilinear") => Ok(TextureFilter::Bilinear),
            Some("nearest") => Ok(TextureFilter::Nearest),
            Some(other) => Err(format!("texture_filter is `{other}`, expected bilinear or nearest")),
        }
    }

    /// What the program may take.
    ///
    /// # Errors
    /// A sentence that names the setting, its value and what was expected.
    pub fn limits(&self) -> Result<RunLimits, String> {
        let seconds = self.time_limit.unwrap_or(10.0);
        if !(seconds.is_finite() && seconds > 0.0 && seconds <= 86_400.0) {
            return Err(format!("time_limit is {seconds}, expected seconds above 0, at most 86400"));
        }
        let some = |value: u64| (value > 0).then_some(value);
        // So far below the end of numbers that no unit overflows them.
        let file = self.file_limit.unwrap_or(64).clamp(1, 1 << 30);
        Ok(RunLimits {
            time: Duration::from_secs_f64(seconds),
            memory: some(self.memory_limit.unwrap_or(4096).min(1 << 40)),
            file,
            processes: some(self.process_limit.unwrap_or(0)),
        })
    }
}

const MOST_PIXELS: u64 = 1 << 24;

#[cfg(test)]
mod tests {
    use super::*;

    fn settings(text: &str) -> Settings {
        toml::from_str(text).unwrap()
    }

    #[test]
    fn a_test_says_more_than_the_defaults() {
        let all = settings("width = 200\npoints = 2\naa = 'adaptive'");
        let one = settings("width = 50\naa = 'grid=3'").or(&all);
        let options = one.options().unwrap();
        assert_eq!((options.width, options.height, one.points), (50, 120, Some(2.0)));
        assert_eq!(options.antialias, Antialias::Grid(3));
    }

    #[test]
    fn faults_are_told() {
        let fault = |text: &str| settings(text).options().unwrap_err();
        assert!(fault("width = 0").contains("width is 0"));
        assert!(fault("width = 100000\nheight = 100000").contains("pixels"));
        assert!(fault("aa = 'grid'").contains("grid=3"));
        assert!(fault("shadows = 'no'").contains("filtered"));
        assert!(settings("time_limit = 0").limits().unwrap_err().contains("above 0"));
        assert!(settings("time_limit = nan").limits().is_err());
        let tolerance = |text: &str| settings(text).tolerance.unwrap().allowance();
        assert!(tolerance("tolerance = 'loose'").unwrap_err().contains("lenient"));
        assert!(tolerance("tolerance = { pixel = -1 }").is_err());
        let changed = tolerance("tolerance = { profile = 'lenient', share = 0.5 }").unwrap();
        assert_eq!((changed.share, changed.tolerance), (0.5, 8.0 / 255.0));
        assert!(toml::from_str::<Settings>("widht = 3").unwrap_err().message().contains("widht"));
    }
}
