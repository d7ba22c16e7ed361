//! Reads a file, or a million spheres made on the spot, a few times and tells the best rate.

use dotray_scene::files::Disk;
use dotray_scene::load::LoadOptions;
use dotray_scene::load::load_text;
use std::fmt::Write;
use std::time::Instant;

fn main() {
    let text = match std::env::args().nth(1) {
        Some(path) => std::fs::read(&path).unwrap_or_else(|fault| panic!("{path}: {fault}")),
        None => spheres(1_000_000).into_bytes(),
    };
    let mut best = f64::INFINITY;
    for _ in 0..15 {
        let copy = text.clone();
        let begin = Instant::now();
        let loaded = load_text("spheres.ray", copy, &Disk, &LoadOptions::default());
        best = best.min(begin.elapsed().as_secs_f64());
        assert!(loaded.scene.is_some(), "the file has errors");
    }
    println!(
        "{:.1} MB in {best:.3} s: {:.0} MB/s",
        text.len() as f64 * 1e-6,
        text.len() as f64 * 1e-6 / best
    );
}

fn spheres(count: u32) -> String {
    let mut text = String::new();
    let mut state = 1_u64;
    // The usual 64-bit linear congruential generator; only its upper bits are used.
    let mut random = || {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (state >> 40) as f64 / 16_777_216.0
    };
    for _ in 0..count {
        let _ = writeln!(
            text,
            "#shape_sphere -1 {:.6} {:.6} {:.6} {:.6}",
            random(),
            random(),
            random(),
            0.001 + 0.001 * random()
        );
    }
    text
}
