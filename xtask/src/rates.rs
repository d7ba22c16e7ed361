//! `ray_rates`: dotray's rates for the rays of a file, in the form that the Embree program uses, too.

use crate::clock::process_cpu;
use crate::clock::thread_cpu;
use crate::ray_sets;
use crate::rays;
use crate::rays::Batch;
use crate::rays::RawRay;
use dotray_accel::simd::level;
use dotray_accel::simd::level_name;
use dotray_geometry::Vec3;
use dotray_render::Caster;
use dotray_render::PrepareOptions;
use dotray_scene::Resolved;
use dotray_scene::files::Disk;
use dotray_scene::load::LoadOptions;
use dotray_scene::load::load;
use dotray_scene::model::Light;
use dotray_scene::resolve::resolve;
use std::path::Path;
use std::time::Instant;

/// How many rays travel together.
const CHUNK: usize = 1024;

const USAGE: &str = "usage: ray_rates make SCENE.ray PREFIX | ray_rates trace SCENE.ray ROUNDS THREADS RAYS…";

fn open(path: &str) -> Result<Resolved, String> {
    let loaded = load(Path::new(path), &Disk, &LoadOptions::default());
    let scene = loaded.scene.ok_or_else(|| format!("{path}: {}", fault(&loaded.diagnostics)))?;
    resolve(scene).resolved.ok_or_else(|| format!("{path}: cannot be resolved"))
}

fn fault(diagnostics: &[dotray_scene::Diagnostic]) -> &str {
    diagnostics.first().map_or("has errors", |diagnostic| &diagnostic.message)
}

/// Builds on so many threads: the caster, CPU seconds, wall seconds. The tree is what is timed, and the baking of the
/// shapes, which peers have done when they are handed their arrays.
fn build(resolved: Resolved, threads: usize) -> (Caster, f64, f64) {
    let options = PrepareOptions { threads: Some(threads), ..PrepareOptions::default() };
    let (cpu, wall) = (process_cpu(), Instant::now());
    let caster = Caster::build(resolved, &options);
    (caster, process_cpu() - cpu, wall.elapsed().as_secs_f64())
}

/// Traces once: seconds, hits, sum of t.
fn trace(caster: &Caster, rays: &[RawRay], set: &str, batch: &mut Batch) -> (f64, u64, f64) {
    let start = thread_cpu();
    let (mut hits, mut sum) = (0, 0.0);
    let together = rays::is_coherent(set);
    for chunk in rays.chunks(CHUNK) {
        batch.set(chunk);
        if rays::is_occlusion(set) {
            let found = caster.occluded(&batch.queries(), together);
            hits += found.iter().filter(|&&found| found).count() as u64;
        } else {
            for found in caster.nearest(&batch.queries(), together).iter().flatten() {
                hits += 1;
                sum += found.hit.t;
            }
        }
    }
    (thread_cpu() - start, hits, sum)
}

fn make(scene: &str, prefix: &str) -> Result<(), String> {
    let resolved = open(scene)?;
    let camera = resolved.camera;
    let light = resolved.lights.iter().find_map(|light| match light {
        Light::Point { position, .. } | Light::Spot { position, .. } | Light::Area { position, .. } => {
            Some(*position)
        }
        Light::Directional { .. } => None,
    });
    let (caster, _, _) = build(resolved, std::thread::available_parallelism().map_or(1, usize::from));
    let sets = ray_sets::make(&caster, &camera, light.unwrap_or(Vec3::new(3.0, 5.0, 4.0)));
    for (name, set) in rays::SETS.into_iter().zip(&sets.0) {
        rays::write(Path::new(&format!("{prefix}.{name}.rays")), set)?;
    }
    Ok(())
}

fn rates(scene: &str, rounds: usize, threads: usize, files: &[String]) -> Result<(), String> {
    let resolved = open(scene)?;
    let (caster, cpu, wall) = build(resolved, threads);
    let simd = level_name(level());
    println!("BUILD,dotray ({simd}),{},{cpu:.4},{wall:.4},{}", caster.shape_count(), caster.memory());
    let mut batch = Batch::default();
    for file in files {
        let set = file.rsplit('.').nth(1).unwrap_or("rays");
        let rays = rays::read(Path::new(file))?;
        let mut seconds = Vec::new();
        let (mut hits, mut sum) = (0, 0.0);
        for _ in 0..rounds.max(1) {
            let (time, round_hits, round_sum) = trace(&caster, &rays, set, &mut batch);
            seconds.push(time);
            (hits, sum) = (round_hits, round_sum);
        }
        let median = crate::figures::median(&seconds).unwrap_or(f64::INFINITY);
        let rate = rays.len() as f64 / median * 1e-6;
        let mean = if hits > 0 { sum / hits as f64 } else { 0.0 };
        println!("TRACE,{set},batch,{},{rate:.4},{hits},{mean:.7}", rays.len());
    }
    Ok(())
}

/// What the program does with its arguments.
///
/// # Errors
/// How it is used, or what is wrong with a file.
pub fn ray_rates(arguments: &[String]) -> Result<(), String> {
    match arguments {
        [word, scene, prefix] if word == "make" => make(scene, prefix),
        [word, scene, rounds, threads, files @ ..] if word == "trace" => {
            let number = |text: &str| text.parse().map_err(|_| USAGE.to_owned());
            rates(scene, number(rounds)?, number(threads)?, files)
        }
        _ => Err(USAGE.to_owned()),
    }
}

/// `parse_rate`: reads a scene so many times, as a library call; CPU and wall seconds of each.
///
/// # Errors
/// How it is used, or what is wrong with the file.
pub fn parse_rate(arguments: &[String]) -> Result<(), String> {
    let [scene, rounds] = arguments else { return Err("usage: parse_rate SCENE.ray ROUNDS".to_owned()) };
    let rounds: usize = rounds.parse().map_err(|_| "ROUNDS is a number".to_owned())?;
    let bytes = std::fs::metadata(scene).map_err(|fault| format!("{scene}: {fault}"))?.len();
    for _ in 0..rounds {
        let (cpu, wall) = (process_cpu(), Instant::now());
        let loaded = load(Path::new(scene), &Disk, &LoadOptions::default());
        let (cpu, wall) = (process_cpu() - cpu, wall.elapsed().as_secs_f64());
        if loaded.scene.is_none() {
            return Err(format!("{scene}: {}", fault(&loaded.diagnostics)));
        }
        println!("PARSE,{bytes},{cpu:.4},{wall:.4}");
    }
    Ok(())
}
