//! Accelerators, threads and tiles change the time, never the bytes.

use crate::random;
use dotray_accel::Kind;
use dotray_image::Image;
use dotray_render::Options;
use dotray_scene::Scene;
use dotray_scene::files::Disk;
use dotray_tests::corpus;
use dotray_tests::pictures;
use proptest::prelude::*;

const THREADS: [usize; 4] = [1, 2, 3, 7];
const TILES: [u32; 4] = [8, 17, 32, 64];

/// The conformance scenes with small pictures.
pub fn small_corpus() -> Vec<(String, Scene, Options)> {
    let cases = corpus::conformance().into_iter();
    cases
        .map(|case| {
            let scene =
                pictures::scene_of_file(&case.scene, &Disk).unwrap_or_else(|e| panic!("{}: {e}", case.name));
            let options = Options {
                width: case.options.width.div_ceil(4),
                height: case.options.height.div_ceil(4),
                light_samples: 16,
                ..case.options
            };
            (case.name, scene, options)
        })
        .collect()
}

/// The picture of brute force on one thread.
fn plain(scene: &Scene, options: &Options) -> Image {
    let options = Options { threads: Some(1), tile_size: 32, ..options.clone() };
    let world = pictures::world(scene.clone(), Kind::Brute).unwrap_or_else(|error| panic!("{error}"));
    pictures::picture(&world, &options).unwrap_or_else(|error| panic!("{error}"))
}

/// Renders with one accelerator in every way and names the ways that give other bytes.
fn other_bytes(scene: &Scene, options: &Options, kind: Kind, expected: &Image) -> Vec<String> {
    let world = pictures::world(scene.clone(), kind).unwrap_or_else(|error| panic!("{error}"));
    let mut faults = Vec::new();
    for threads in THREADS {
        for tile_size in TILES {
            let options = Options { threads: Some(threads), tile_size, ..options.clone() };
            let actual = pictures::picture(&world, &options).unwrap_or_else(|error| panic!("{error}"));
            if let Some(difference) = pictures::difference(expected, &actual) {
                faults
                    .push(format!("{}, {threads} threads, tiles of {tile_size}: {difference}", kind.name()));
            }
        }
    }
    faults
}

fn corpus_is_same(kind: Kind) {
    let mut faults = Vec::new();
    for (name, scene, options) in small_corpus() {
        let expected = plain(&scene, &options);
        let found = other_bytes(&scene, &options, kind, &expected);
        faults.extend(found.into_iter().map(|fault| format!("{name}: {fault}")));
    }
    assert!(faults.is_empty(), "{} ways differ\n{}", faults.len(), faults.join("\n"));
}

#[test]
fn brute_force_in_every_way() {
    corpus_is_same(Kind::Brute);
}

#[test]
fn boxes_in_every_way() {
    corpus_is_same(Kind::Boxes);
}

#[test]
fn octree_in_every_way() {
    corpus_is_same(Kind::Octree);
}

#[test]
fn bsp_in_every_way() {
    corpus_is_same(Kind::Bsp);
}

#[test]
fn bvh_in_every_way() {
    corpus_is_same(Kind::Bvh);
}

#[test]
fn a_difference_of_one_bit_is_seen() {
    let (_, scene, options) = small_corpus().swap_remove(0);
    let expected = plain(&scene, &options);
    let mut changed = expected.clone();
    let sample = &mut changed.samples_mut()[100];
    *sample = f32::from_bits(sample.to_bits() ^ 1);
    assert!(pictures::difference(&expected, &changed).is_some());
    assert_ne!(pictures::fingerprint(&expected), pictures::fingerprint(&changed));
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 150, max_shrink_iters: 400, ..ProptestConfig::default() })]

    #[test]
    fn random_scenes_are_the_same_with_every_accelerator(text in random::scene(), adaptive in any::<bool>()) {
        let antialias = if adaptive { dotray_render::Antialias::ADAPTIVE } else { dotray_render::Antialias::None };
        let options = Options { width: 40, height: 31, antialias, ..Options::default() };
        let scene = pictures::scene_of_text("random.ray", text.as_str()).map_err(TestCaseError::fail)?;
        let expected = plain(&scene, &options);
        for (i, kind) in Kind::ALL.into_iter().enumerate() {
            let world = pictures::world(scene.clone(), kind).map_err(TestCaseError::fail)?;
            let options = Options { threads: Some(THREADS[i % 4]), tile_size: TILES[(i + 1) % 4], ..options.clone() };
            let actual = pictures::picture(&world, &options).map_err(TestCaseError::fail)?;
            let difference = pictures::difference(&expected, &actual);
            prop_assert!(difference.is_none(), "{}: {}\n{text}", kind.name(), difference.unwrap_or_default());
        }
    }
}
