//! `from_memory`: raw spheres to a picture without any text, as OVITO and Cycles are asked to.

use crate::clock::process_cpu;
use crate::scenes::AMBIENT;
use crate::scenes::BACKGROUND;
use crate::scenes::DIFFUSE;
use crate::write;
use dotray_geometry::Sphere;
use dotray_geometry::Vec3;
use dotray_render::Options;
use dotray_render::PrepareOptions;
use dotray_render::Silent;
use dotray_render::World;
use dotray_scene::files::Disk;
use dotray_scene::model::Camera;
use dotray_scene::model::Item;
use dotray_scene::model::Light;
use dotray_scene::model::Material;
use dotray_scene::model::Placed;
use dotray_scene::model::Scene;
use dotray_scene::model::SceneFile;
use dotray_scene::model::ShapeKind;
use dotray_scene::resolve::resolve;
use dotray_scene::span::FileId;
use dotray_scene::span::Span;
use std::path::Path;
use std::time::Instant;

fn scene(spheres: Vec<Sphere>, camera: &[f64; 13]) -> Scene {
    fn placed<T>(value: T) -> Option<Placed<T>> {
        Some(Placed { value, span: Span::new(FileId(0), 0, 0) })
    }
    let vector = |first: usize| Vec3::new(camera[first], camera[first + 1], camera[first + 2]);
    let mut file = SceneFile {
        camera: placed(Camera {
            position: vector(0),
            direction: vector(3) - vector(0),
            up: vector(6),
            half_angle: (camera[9] * 0.5).to_radians(),
        }),
        background: placed(Vec3::from_array(BACKGROUND)),
        ambient: placed(Vec3::splat(AMBIENT)),
        lights: placed(Light::Directional { color: Vec3::ONE, direction: vector(3) - vector(10) })
            .into_iter()
            .collect(),
        items: vec![Item::Run { kind: ShapeKind::Sphere, first: 0, count: spheres.len() as u32 }],
        ..SceneFile::default()
    };
    let (color, none) = (Vec3::splat(0.8), Vec3::ZERO);
    let dull = Material {
        ambient: color,
        diffuse: color * DIFFUSE,
        specular: none,
        emissive: none,
        k_specular: 0.0,
        k_transmission: 0.0,
        index_of_refraction: 1.0,
        texture: None,
        bump: None,
        text: String::new(),
        weights: None,
    };
    file.materials = placed(dull).into_iter().collect();
    file.spheres.materials = vec![0; spheres.len()];
    file.spheres.shapes = spheres;
    Scene { files: vec![file] }
}

/// Renders the spheres of a raw file with the camera of another, and tells CPU and wall seconds of a few pictures.
///
/// # Errors
/// How it is used, or what is wrong with a file.
pub fn from_memory(arguments: &[String]) -> Result<(), String> {
    let [raw, camera, threads, rounds] = arguments else {
        return Err("usage: from_memory SPHERES.sph CAMERA.cam THREADS ROUNDS".to_owned());
    };
    let number = |text: &str| text.parse::<usize>().map_err(|_| format!("{text} is not a number"));
    let (threads, rounds) = (Some(number(threads)?), number(rounds)?);
    let camera = write::camera(Path::new(camera))?;
    let bytes = std::fs::read(raw).map_err(|fault| format!("{raw}: {fault}"))?;
    let numbers: Vec<f32> = bytes.as_chunks::<4>().0.iter().map(|&bytes| f32::from_le_bytes(bytes)).collect();
    drop(bytes);
    for _ in 0..rounds {
        let (cpu, wall) = (process_cpu(), Instant::now());
        let sphere =
            |n: &[f32; 4]| Sphere::new(Vec3::new(n[0].into(), n[1].into(), n[2].into()), n[3].into()).ok();
        let spheres = numbers.as_chunks::<4>().0.iter().filter_map(sphere).collect();
        let resolved = resolve(scene(spheres, &camera)).resolved.ok_or("the spheres make no scene")?;
        let prepare = PrepareOptions { threads, ..PrepareOptions::default() };
        let world = World::prepare(resolved, &Disk, &prepare).map_err(|_| "the scene cannot be prepared")?;
        let (width, height) = (write::WIDTH, write::HEIGHT);
        let options = Options { width, height, threads, ..Options::default() };
        dotray_render::render(&world, &options, &Silent).map_err(|fault| fault.to_string())?;
        println!("PICTURE,{:.4},{:.4}", process_cpu() - cpu, wall.elapsed().as_secs_f64());
    }
    Ok(())
}
