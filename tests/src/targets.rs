//! What may be done with bytes of which nothing is known: nothing of it may crash, hang or take memory without bound.
//!
//! The fuzzer in `fuzz/` includes this file and gives it bytes for hours; `tests/program/fuzzed.rs` gives it the kept
//! corpora and some thousand changes of them in seconds.

use dotray_image::Channels;
use dotray_image::EncodeOptions;
use dotray_image::Format;
use dotray_image::Limits;
use dotray_image::decode;
use dotray_image::encode;
use dotray_scene::Dialect;
use dotray_scene::Files;
use dotray_scene::Scene;
use dotray_scene::Severity;
use dotray_scene::context::name_groups;
use dotray_scene::convert::convert;
use dotray_scene::dump::DumpOptions;
use dotray_scene::dump::dump;
use dotray_scene::format::format_text;
use dotray_scene::format::says_the_same;
use dotray_scene::lint::lint;
use dotray_scene::load::LoadOptions;
use dotray_scene::load::Loaded;
use dotray_scene::load::load_text;
use dotray_scene::model::SceneFile;
use dotray_scene::report::render_text;
use dotray_scene::resolve;
use dotray_scene::resolve::resolve_within;
use dotray_scene::summary::summarize;
use dotray_scene::write::write;
use std::io;
use std::path::Path;

/// Something to do with any bytes.
#[derive(Clone, Copy, Debug)]
pub struct Target {
    /// Its name: that of the fuzzer's program and of the folder of its corpus.
    pub name: &'static str,
    /// It panics where a promise is broken.
    pub run: fn(&[u8]),
}

/// All targets.
pub const TARGETS: [Target; 9] = [
    Target { name: "auto", run: |bytes| read(bytes, None) },
    Target { name: "slides", run: |bytes| read(bytes, Some(Dialect::Slides)) },
    Target { name: "uva", run: |bytes| read(bytes, Some(Dialect::Uva)) },
    Target { name: "jhu", run: |bytes| read(bytes, Some(Dialect::Jhu)) },
    Target { name: "hmc", run: |bytes| read(bytes, Some(Dialect::Hmc)) },
    Target { name: "unisa", run: |bytes| read(bytes, Some(Dialect::Unisa)) },
    Target { name: "image", run: image },
    Target { name: "round_trip", run: round_trip },
    Target { name: "layout", run: layout },
];

/// Does what the target of a name does.
///
/// # Panics
/// Where a promise is broken, or no target has the name.
pub fn run(name: &str, bytes: &[u8]) {
    let target = TARGETS.iter().find(|target| target.name == name).expect("a target of this name");
    (target.run)(bytes);
}

/// The only files there are beside the text.
struct Beside;

impl Files for Beside {
    fn read(&self, path: &Path) -> io::Result<Vec<u8>> {
        match path.to_str() {
            Some("a") => Ok(b"#shape_sphere -1  0 0 0  1\n".to_vec()),
            Some("b") => Ok(b"#ray_file a\n#group_begin 1 0 0 0 0 1 0 0 0 0 1 0\n#group_end\n".to_vec()),
            Some("c") => Ok(b"#ray_file b\n#ray_file c\n".to_vec()),
            Some(_) | None => Err(io::ErrorKind::NotFound.into()),
        }
    }
}

const NAME: &str = "text.ray";

fn loaded(bytes: &[u8], dialect: Option<Dialect>) -> Loaded {
    load_text(NAME, bytes, &Beside, &LoadOptions { dialect, ..LoadOptions::default() })
}

/// So few instances that each input is finished in no time.
const INSTANCES: resolve::Limits = resolve::Limits { steps: 20_000, runs: 10_000, shapes: 50_000 };

/// Text to a resolved scene with all messages, and what `check`, `dump`, `info` and `convert` do then.
fn read(bytes: &[u8], dialect: Option<Dialect>) {
    let Loaded { scene, mut diagnostics, sources, .. } = loaded(bytes, dialect);
    let errors = diagnostics.iter().any(|fault| fault.severity == Severity::Error);
    assert_eq!(errors, scene.is_none(), "there is a scene, or an error that says why not");
    if let Some(scene) = scene {
        let outcome = resolve_within(scene.clone(), &INSTANCES);
        diagnostics.extend(outcome.diagnostics);
        if let Some(resolved) = outcome.resolved {
            assert!(resolved.frames.iter().all(|frame| frame.is_finite()), "matrices are finite");
            diagnostics.extend(lint(&resolved));
            let summary = summarize(&resolved).to_string();
            assert!(!summary.is_empty());
            dump(&resolved.files, DumpOptions { world: true }, &mut io::sink()).expect("a sink takes all");
            for to in Dialect::ALL {
                // Why a scene cannot be converted is told; that is no broken promise.
                let _ = convert(&scene, to, &|_, name| name.to_owned());
            }
        }
    }
    name_groups(&mut diagnostics, &sources);
    let text = render_text(&diagnostics, &sources, false);
    assert_eq!(text.is_empty(), diagnostics.is_empty());
}

/// Bytes to a picture, in the form that they seem to have and in those that they might be said to have.
fn image(bytes: &[u8]) {
    const LIMITS: Limits = Limits { max_pixels: 1 << 18, max_bytes: 32 << 20 };
    let hints = Format::ALL.into_iter().map(Some).chain([None]);
    let mut seen = None;
    for hint in hints {
        let Ok(image) = decode(bytes, hint, &LIMITS) else { continue };
        let pixels = image.width() * image.height();
        assert!((1..=1 << 18).contains(&pixels), "a picture within the limits");
        assert_eq!(image.samples().len(), pixels * image.channels().count());
        let bits: Vec<u32> = image.samples().iter().map(|sample| sample.to_bits()).collect();
        // What the file begins with decides, not its name.
        if Format::sniff(bytes).is_some() && seen.replace(bits.clone()).is_some_and(|other| other != bits) {
            panic!("the same bytes are two pictures");
        }
        if image.channels() == Channels::Rgb {
            let again = encode(&image, Format::Pfm, &EncodeOptions::default()).expect("a float map");
            let again = decode(&again, None, &LIMITS).expect("our own file is read");
            let same = again.samples().iter().zip(image.samples()).all(|(a, b)| a.to_bits() == b.to_bits());
            assert!(same, "floats are kept");
        }
    }
}

/// What is written is read as the same scene.
fn round_trip(bytes: &[u8]) {
    let Loaded { scene: Some(scene), dialect, .. } = loaded(bytes, None) else { return };
    // Materials have no names any more when they are written, so that their order may change.
    match dialect {
        Dialect::Slides | Dialect::Uva | Dialect::Jhu | Dialect::Unisa => {}
        Dialect::Hmc => return,
    }
    let Some(file) = scene.files.first() else { return };
    let text = write(file);
    let again = loaded(text.as_bytes(), Some(dialect));
    let messages = render_text(&again.diagnostics, &again.sources, false);
    let Some(again) = again.scene else { panic!("what was written has errors:\n{text}\n{messages}") };
    let second = again.files.first().map(write).unwrap_or_default();
    assert_eq!(second, text, "what is written is read and written alike");
    // Signs that no text can hold are lost.
    let holds = |name: &str| !name.contains(['"', '!', '\n', '\r']);
    let names = file.textures.iter().map(|name| name.value.as_str());
    let names = names.chain(file.includes.iter().map(|include| include.value.name.as_str()));
    let texts = file.materials.iter().map(|material| material.value.text.as_str());
    if scene.files.len() == again.files.len() && names.chain(texts).all(holds) {
        assert!(
            without_places(&scene) == without_places(&again),
            "the same text, but not the same scene:\n{text}"
        );
    }
}

/// Layout changes no word, and nothing the second time.
fn layout(bytes: &[u8]) {
    let Ok(once) = format_text(bytes) else { return };
    assert!(says_the_same(bytes, &once), "layout changes words");
    let twice = format_text(&once).expect("what was laid out can be laid out");
    assert!(once == twice, "layout is not done at once:\n{}", String::from_utf8_lossy(&once));
}

/// The scene without places in its text.
pub fn without_places(scene: &Scene) -> Scene {
    let mut scene = scene.clone();
    scene.files = scene.files.into_iter().map(SceneFile::without_places).collect();
    scene
}
