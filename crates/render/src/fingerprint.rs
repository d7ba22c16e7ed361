//! What a picture's pixels depend on, in a few lines of text: so that stored tiles are never put into another picture.

use crate::numbers;
use crate::options::Antialias;
use crate::options::Options;
use crate::options::Shadows;
use crate::options::TextureFilter;
use crate::world::Textures;
use dotray_scene::Resolved;
use dotray_scene::model::SceneFile;
use dotray_scene::model::ShapeKind;
use dotray_scene::resolved::Run;
use dotray_scene::resolved::RunColors;
use std::fmt;
use std::fmt::Debug;
use std::fmt::Write;
use xxhash_rust::xxh3::Xxh3Default;

/// Names and values: of the scene's parts a hash, of options the value itself. Two pictures with equal fingerprints
/// have the same pixels.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Fingerprint {
    entries: Vec<(String, String)>,
}

/// Text that goes into a hash.
struct Hash(Xxh3Default);

impl Hash {
    fn new() -> Self {
        Self(Xxh3Default::new())
    }

    fn number(&mut self, number: f64) {
        self.0.update(&number.to_bits().to_le_bytes());
    }

    fn whole(&mut self, number: u64) {
        self.0.update(&number.to_le_bytes());
    }

    fn text(self) -> String {
        format!("{:032x}", self.0.digest128())
    }
}

impl Write for Hash {
    fn write_str(&mut self, text: &str) -> fmt::Result {
        self.0.update(text.as_bytes());
        Ok(())
    }
}

/// The hash of what a value's `Debug` says; floats say all of their digits.
fn said(value: &impl Debug) -> String {
    let mut hash = Hash::new();
    // A hash takes everything.
    let _ = write!(hash, "{value:?}");
    hash.text()
}

impl Fingerprint {
    /// Of a picture that `options` ask for: of the scene with all that it includes, as it is understood, of the pixels
    /// of its textures, and of every option that a pixel depends on. Comments and layout of the text do not count.
    pub fn of(resolved: &Resolved, textures: &Textures, options: &Options) -> Self {
        let backgrounds = (resolved.background, resolved.secondary_background, resolved.ambient);
        let shapes = shapes(resolved);
        let lights = (&resolved.lights, &resolved.tints);
        let mut all = Self::default()
            .with("version", env!("CARGO_PKG_VERSION"))
            .with("camera", &said(&resolved.camera))
            .with("background and ambient light", &said(&backgrounds))
            .with("lights", &said(&lights))
            .with("materials", &said(&resolved.materials))
            .with("shapes", &shapes);
        for (number, image) in textures.images().enumerate() {
            let mut hash = Hash::new();
            hash.whole(image.width() as u64);
            hash.whole(image.channels().count() as u64);
            image.samples().iter().for_each(|sample| hash.0.update(&sample.to_bits().to_le_bytes()));
            all = all.with(&format!("texture {number}"), &hash.text());
        }
        all.with_options(options)
    }

    fn with_options(self, options: &Options) -> Self {
        let antialias = match options.antialias {
            Antialias::None => "none".to_owned(),
            Antialias::Grid(n) => format!("grid={n}"),
            Antialias::Adaptive { threshold, depth } => {
                format!("adaptive, threshold {threshold}, depth {depth}")
            }
        };
        let crop = options.crop.map_or_else(
            || "none".to_owned(),
            |crop| format!("{},{},{},{}", crop.x, crop.y, crop.width, crop.height),
        );
        let shadows = match options.shadows {
            Shadows::Filtered => "filtered",
            Shadows::Opaque => "opaque",
            Shadows::Off => "off",
        };
        let filter = match options.texture_filter {
            TextureFilter::Bilinear => "bilinear",
            TextureFilter::Nearest => "nearest",
        };
        self.with("size", &format!("{}x{}", options.width, options.height))
            .with("crop", &crop)
            .with("recursion", &options.recursion.to_string())
            .with("cutoff", &options.threshold.to_string())
            .with("aa", &antialias)
            .with("shadows", shadows)
            .with("texture filter", filter)
            .with("light samples", &options.light_samples.to_string())
            .with("alpha channel", if options.transparent { "yes" } else { "no" })
            .with("tile size", &options.tile_size.to_string())
    }

    /// The same with one more thing that the pixels depend on.
    pub fn with(mut self, name: &str, value: &str) -> Self {
        // An entry is a line, and a name ends at the first sign of equality.
        let line = |text: &str| text.replace(char::is_control, " ");
        self.entries.push((line(name).replace('=', " "), line(value)));
        self
    }

    /// The same with a hash of these bytes.
    pub fn with_hash_of(self, name: &str, bytes: &[u8]) -> Self {
        let mut hash = Hash::new();
        hash.0.update(bytes);
        self.with(name, &hash.text())
    }

    /// Names and values.
    pub fn entries(&self) -> &[(String, String)] {
        &self.entries
    }

    /// The same for the text of [`Fingerprint::to_text`]; lines that say nothing are left out.
    pub fn from_text(text: &str) -> Self {
        let entries = text.lines().filter_map(|line| line.split_once('='));
        Self { entries: entries.map(|(name, value)| (name.to_owned(), value.to_owned())).collect() }
    }

    /// One line `name=value` an entry.
    pub fn to_text(&self) -> String {
        self.entries.iter().map(|(name, value)| format!("{name}={value}\n")).collect()
    }

    /// What differs, for people, `there` and `here` being the words for the two; empty where nothing does.
    pub fn differences(&self, other: &Self, there: &str, here: &str) -> Vec<String> {
        let value = |of: &Self, name: &str| {
            of.entries.iter().find(|entry| entry.0 == name).map(|entry| entry.1.clone())
        };
        let hashed = |value: &str| value.len() == 32 && value.bytes().all(|byte| byte.is_ascii_hexdigit());
        let mut names: Vec<&String> = self.entries.iter().map(|entry| &entry.0).collect();
        names.extend(other.entries.iter().map(|entry| &entry.0).filter(|name| value(self, name).is_none()));
        let difference = |name: &&String| match (value(self, name), value(other, name)) {
            (Some(a), Some(b)) if a == b => None,
            (Some(a), Some(b)) if hashed(&a) && hashed(&b) => Some(format!("{name} differ")),
            (Some(a), Some(b)) => Some(format!("{name}: {a} {there}, {b} {here}")),
            (Some(_), None) => Some(format!("{name}: only {there}")),
            (None, _) => Some(format!("{name}: only {here}")),
        };
        names.iter().filter_map(difference).collect()
    }
}

/// A hash of every shape: kind, numbers, material, frame, in file order.
fn shapes(resolved: &Resolved) -> String {
    let mut hash = Hash::new();
    hash.whole(u64::from(resolved.shape_count));
    for run in &resolved.runs {
        let Some(file) = resolved.files.get(run.file.0 as usize) else { continue };
        hash.whole(run.kind as u64);
        hash.whole(u64::from(run.count));
        if let Some(world_from_object) = resolved.frames.get(run.frame as usize) {
            world_from_object.to_cols_array().into_iter().for_each(|number| hash.number(number));
        }
        let written = file.shape_materials(run.kind);
        for entry in run.first..run.first + run.count {
            let material = written.get(entry as usize).map_or(0, |&m| resolved.material_index(run, m));
            hash.whole(u64::from(material));
            if let Some(shape) = file.shape(run.kind, entry as usize) {
                numbers::of_shape(&shape, &mut |number| hash.number(number));
            }
            own_colors(run, file, entry, &mut |part| hash.number(part));
        }
    }
    // Open sides of both kinds have one list: their numbers tell them apart.
    debug_assert_eq!(ShapeKind::ALL.len(), 8);
    hash.text()
}

/// Passes on what colours entry `entry` of a run has of its own.
fn own_colors(run: &Run, file: &SceneFile, entry: u32, take: &mut impl FnMut(f64)) {
    match run.colors {
        RunColors::No => {}
        RunColors::Shapes { list, first } => {
            let colors = file.colors.get(list as usize).map_or(&[][..], |list| &list.colors);
            let color = colors.get((first + entry - run.first) as usize);
            color.into_iter().flatten().for_each(|&part| take(part.into()));
        }
        RunColors::Vertices => {
            let colors = file.corner_colors(entry as usize);
            colors.into_iter().flatten().for_each(|color| color.to_array().into_iter().for_each(&mut *take));
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn differences_are_named() {
        let a = Fingerprint::default().with("size", "3x4").with("lights", &said(&1)).with("old", "1");
        let b = Fingerprint::default().with("size", "5x4").with("lights", &said(&2)).with("n=ew", "=\n");
        let named = ["size: 3x4 there, 5x4 here", "lights differ", "old: only there", "n ew: only here"];
        assert_eq!(a.differences(&b, "there", "here"), named);
        assert_eq!(a.differences(&a, "", ""), [""; 0]);
        assert_eq!(Fingerprint::from_text(&b.to_text()), b);
    }
}
