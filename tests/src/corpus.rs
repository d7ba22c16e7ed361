//! The scenes that tests go through, and where they lie.

use dotray_render::Antialias;
use dotray_render::Options;
use dotray_render::Shadows;
use dotray_render::TextureFilter;
use std::path::Path;
use std::path::PathBuf;

/// The repository's root.
pub fn root() -> PathBuf {
    let here = Path::new(env!("CARGO_MANIFEST_DIR"));
    here.parent().unwrap_or(here).to_owned()
}

/// A file beside the repository that only some checkouts have; says so where it is absent.
pub fn shared(path: &str) -> Option<PathBuf> {
    let found = root().join("../shared").join(path);
    if !found.exists() {
        println!("skipped, no ../shared");
    }
    found.exists().then_some(found)
}

/// The `.ray` files of a folder, by name.
pub fn scenes_in(folder: &Path) -> Vec<PathBuf> {
    let entries = std::fs::read_dir(folder).into_iter().flatten().flatten();
    let mut scenes: Vec<PathBuf> = entries
        .map(|entry| entry.path())
        .filter(|path| path.extension().is_some_and(|e| e == "ray"))
        .collect();
    scenes.sort();
    scenes
}

/// A scene with the options of its reference picture.
#[derive(Clone, Debug)]
pub struct Case {
    /// The scene's name.
    pub name: String,
    /// The scene.
    pub scene: PathBuf,
    /// Its reference picture.
    pub reference: PathBuf,
    /// How it was rendered.
    pub options: Options,
    /// Whether block means are compared instead of pixels.
    pub statistical: bool,
}

/// The conformance scenes as their manifest lists them.
///
/// # Panics
/// If the manifest is not what it should be.
pub fn conformance() -> Vec<Case> {
    let folder = root().join("tests/conformance");
    let manifest = folder.join("manifest.json");
    let text = std::fs::read_to_string(&manifest).unwrap_or_else(|error| panic!("{manifest:?}: {error}"));
    let rows: serde_json::Value = serde_json::from_str(&text).expect("the manifest is JSON");
    rows.as_array().expect("the manifest is a list").iter().map(|row| case(row, &folder)).collect()
}

fn case(row: &serde_json::Value, folder: &Path) -> Case {
    let word = |key: &str| row[key].as_str().unwrap_or_else(|| panic!("`{key}` in {row}"));
    let count = |key: &str| {
        row[key].as_u64().and_then(|n| u32::try_from(n).ok()).unwrap_or_else(|| panic!("`{key}` in {row}"))
    };
    let mut options = Options {
        width: count("width"),
        height: count("height"),
        recursion: count("reclimit"),
        threshold: row["cutoff"].as_f64().unwrap_or_else(|| panic!("`cutoff` in {row}")),
        ..Options::default()
    };
    read_options(&format!("{} {}", word("aa"), word("options")), &mut options);
    let name = word("name").to_owned();
    Case {
        scene: folder.join(format!("{name}.ray")),
        reference: folder.join(format!("{name}.exr")),
        options,
        statistical: word("class") == "statistical",
        name,
    }
}

/// Reads the command line's sampling arguments and other options.
fn read_options(line: &str, options: &mut Options) {
    let words: Vec<&str> = line.split_whitespace().collect();
    for pair in words.chunks(2) {
        let (option, value) = (pair[0], pair.get(1).copied().unwrap_or(""));
        let number = || value.parse::<f64>().unwrap_or_else(|_| panic!("{option} {value}"));
        match (option, value) {
            ("--aa", "none") => options.antialias = Antialias::None,
            ("--aa", "adaptive") => options.antialias = Antialias::ADAPTIVE,
            ("--aa", grid) => {
                let n = grid.strip_prefix("grid=").and_then(|n| n.parse().ok());
                options.antialias = Antialias::Grid(n.unwrap_or_else(|| panic!("{option} {value}")));
            }
            ("--aa-depth" | "--aa-threshold", _) => match &mut options.antialias {
                Antialias::Adaptive { depth, .. } if option == "--aa-depth" => *depth = number() as u32,
                Antialias::Adaptive { threshold, .. } => *threshold = number(),
                Antialias::None | Antialias::Grid(_) => panic!("{option} without --aa adaptive"),
            },
            ("--shadows", "opaque") => options.shadows = Shadows::Opaque,
            ("--shadows", "off") => options.shadows = Shadows::Off,
            ("--shadows", "filtered") => options.shadows = Shadows::Filtered,
            ("--texture-filter", "nearest") => options.texture_filter = TextureFilter::Nearest,
            ("--texture-filter", "bilinear") => options.texture_filter = TextureFilter::Bilinear,
            _ => panic!("`{option} {value}` is no option of the manifest"),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn options_are_read() {
        let mut options = Options::default();
        read_options("--aa adaptive --aa-depth 1 --aa-threshold 0.25 --shadows off", &mut options);
        assert_eq!(options.antialias, Antialias::Adaptive { threshold: 0.25, depth: 1 });
        assert_eq!(options.shadows, Shadows::Off);
        read_options("--aa grid=4 --texture-filter nearest", &mut options);
        assert_eq!(options.antialias, Antialias::Grid(4));
        assert_eq!(options.texture_filter, TextureFilter::Nearest);
    }

    #[test]
    #[should_panic(expected = "no option")]
    fn unknown_options_are_refused() {
        read_options("--sampling best", &mut Options::default());
    }

    #[test]
    fn the_manifest_and_the_folder_agree() {
        let cases = conformance();
        let scenes = scenes_in(&root().join("tests/conformance"));
        let mut listed: Vec<PathBuf> = cases.iter().map(|case| case.scene.clone()).collect();
        listed.sort();
        assert_eq!(listed, scenes);
        assert!(cases.iter().all(|case| case.reference.exists()));
        assert_eq!(cases.len(), 47);
    }
}
