//! From a scene to samples in one call, whatever the step that a test wants to change.

use dotray_accel::Kind;
use dotray_image::Image;
use dotray_render::Options;
use dotray_render::PrepareOptions;
use dotray_render::Silent;
use dotray_render::World;
use dotray_scene::Diagnostic;
use dotray_scene::Files;
use dotray_scene::Resolved;
use dotray_scene::Scene;
use dotray_scene::files::Disk;
use dotray_scene::load::LoadOptions;
use dotray_scene::load::Loaded;
use dotray_scene::load::load;
use dotray_scene::load::load_text;
use dotray_scene::report::render_text;
use dotray_scene::resolve::resolve;
use std::path::Path;

/// Reads a scene file, or gives the messages.
///
/// # Errors
/// The messages as the program prints them.
pub fn scene_of_file(path: &Path, files: &dyn Files) -> Result<Scene, String> {
    scene_of(load(path, files, &LoadOptions::default()))
}

/// Reads a scene that stands in `text` as if its file were called `name`.
///
/// # Errors
/// The messages as the program prints them.
pub fn scene_of_text(name: &str, text: impl Into<Vec<u8>>) -> Result<Scene, String> {
    scene_of(load_text(name, text.into(), &Disk, &LoadOptions::default()))
}

fn scene_of(loaded: Loaded) -> Result<Scene, String> {
    let Loaded { scene, diagnostics, sources, .. } = loaded;
    scene.ok_or_else(|| render_text(&diagnostics, &sources, false))
}

fn sentences(diagnostics: &[Diagnostic]) -> String {
    diagnostics.iter().map(|diagnostic| format!("{}: {}\n", diagnostic.code, diagnostic.message)).collect()
}

/// Resolves a scene.
///
/// # Errors
/// The messages, one a line.
pub fn resolved(scene: Scene) -> Result<Resolved, String> {
    let outcome = resolve(scene);
    outcome.resolved.ok_or_else(|| sentences(&outcome.diagnostics))
}

/// Resolves a scene and makes it ready for tracing.
///
/// # Errors
/// The messages, one a line.
pub fn world(scene: Scene, kind: Kind) -> Result<World, String> {
    let options = PrepareOptions { accel: kind, ..PrepareOptions::default() };
    World::prepare(resolved(scene)?, &Disk, &options).map_err(|faults| sentences(&faults))
}

/// Makes the picture.
///
/// # Errors
/// The reason why there is none.
pub fn picture(world: &World, options: &Options) -> Result<Image, String> {
    let rendering = dotray_render::render(world, options, &Silent).map_err(|error| error.to_string())?;
    if rendering.complete { Ok(rendering.image) } else { Err("the picture is not complete".to_owned()) }
}

/// The bits of all samples: what 'the same bytes' means before any format rounds.
pub fn bits(image: &Image) -> Vec<u32> {
    image.samples().iter().map(|sample| sample.to_bits()).collect()
}

/// FNV-1a over the size and the bits of all samples.
pub fn fingerprint(image: &Image) -> u64 {
    let words = [image.width() as u32, image.height() as u32].into_iter().chain(bits(image));
    words
        .flat_map(u32::to_le_bytes)
        .fold(0xcbf2_9ce4_8422_2325, |hash, byte| (hash ^ u64::from(byte)).wrapping_mul(0x0100_0000_01b3))
}

/// Where two pictures first differ, in words; `None` where they are the same.
pub fn difference(a: &Image, b: &Image) -> Option<String> {
    if (a.width(), a.height()) != (b.width(), b.height()) {
        return Some("the sizes differ".to_owned());
    }
    let (a_bits, b_bits) = (bits(a), bits(b));
    let count = a_bits.iter().zip(&b_bits).filter(|(a, b)| a != b).count();
    let first = a_bits.iter().zip(&b_bits).position(|(a, b)| a != b)?;
    let pixel = first / a.channels().count();
    let (x, y) = (pixel % a.width(), pixel / a.width());
    Some(format!("{count} samples differ, first at {x},{y}: {:?} and {:?}", a.pixel(x, y), b.pixel(x, y)))
}
