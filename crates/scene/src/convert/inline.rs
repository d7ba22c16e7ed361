//! All files of a scene as one.

use super::ConvertError;
use super::MOST_SHAPES;
use crate::model::BumpImage;
use crate::model::Item;
use crate::model::Material;
use crate::model::Placed;
use crate::model::SceneFile;
use crate::model::ShapeKind;
use crate::model::ShapeList;
use crate::walk::DEFAULT_STEPS;
use crate::walk::Step;
use crate::walk::Walk;

/// What a file's numbers become in the whole.
#[derive(Clone, Copy, Default)]
struct Bases {
    materials: i32,
    vertices: u32,
}

/// Walks the tree and writes every shape as often as it stands.
pub fn inline(
    files: &[SceneFile],
    texture: &dyn Fn(&SceneFile, &str) -> String,
) -> Result<SceneFile, ConvertError> {
    let mut whole = SceneFile::default();
    if let Some(main) = files.first() {
        let SceneFile { dialect, camera, background, ambient, .. } = *main;
        whole = SceneFile { dialect, camera, background, ambient, ..whole };
        (whole.lights, whole.tints) = (main.lights.clone(), main.tints.clone());
        whole.path = main.path.clone();
    }
    let bases: Vec<Bases> = files.iter().map(|file| add_lists(&mut whole, file, texture)).collect();
    let written: u64 = files
        .iter()
        .map(|file| ShapeKind::ALL.iter().map(|kind| file.shape_count(*kind) as u64).sum::<u64>())
        .sum();
    let most = MOST_SHAPES.max(written);
    let mut shapes = 0;
    for step in Walk::new(files, DEFAULT_STEPS) {
        match step? {
            Step::OpenGroup { file, group } => {
                let matrix = files.get(file.0 as usize).and_then(|file| file.groups.get(group as usize));
                let Some(matrix) = matrix else { continue };
                whole.items.push(Item::Open(whole.groups.len() as u32));
                whole.groups.push(*matrix);
            }
            Step::CloseGroup => whole.items.push(Item::Close),
            Step::OpenInstance { .. } | Step::CloseInstance => {}
            Step::Shapes { file, kind, first, count } => {
                shapes += u64::from(count);
                if shapes > most {
                    return Err(ConvertError::TooManyShapes(most));
                }
                let number = file.0 as usize;
                if let (Some(file), Some(bases)) = (files.get(number), bases.get(number)) {
                    add_run(&mut whole, file, kind, first, count, *bases);
                }
            }
        }
    }
    if !whole.vertex_colors.is_empty() {
        whole.vertex_colors.resize(whole.vertices.len(), None);
    }
    Ok(whole)
}

/// Appends what a file numbers by itself.
fn add_lists(whole: &mut SceneFile, file: &SceneFile, texture: &dyn Fn(&SceneFile, &str) -> String) -> Bases {
    let bases = Bases { materials: whole.materials.len() as i32, vertices: whole.vertices.len() as u32 };
    let first_texture = whole.textures.len() as u32;
    if !file.vertex_colors.is_empty() {
        whole.vertex_colors.resize(whole.vertices.len(), None);
        whole.vertex_colors.extend_from_slice(&file.vertex_colors);
    }
    whole.vertices.extend_from_slice(&file.vertices);
    for Placed { value, span } in &file.textures {
        whole.textures.push(Placed { value: texture(file, value), span: *span });
    }
    for Placed { value, span } in &file.materials {
        let texture = value.texture.map(|number| number + first_texture);
        let moved = |bump: BumpImage| BumpImage { texture: bump.texture + first_texture, ..bump };
        let bump = value.bump.map(moved);
        whole.materials.push(Placed { value: Material { texture, bump, ..value.clone() }, span: *span });
    }
    bases
}

fn add_run(whole: &mut SceneFile, file: &SceneFile, kind: ShapeKind, first: u32, count: u32, bases: Bases) {
    let start = whole.shape_count(kind) as u32;
    let base = bases.materials;
    match kind {
        ShapeKind::Sphere => copy(&file.spheres, &mut whole.spheres, first, count, base),
        ShapeKind::Cuboid => copy(&file.cuboids, &mut whole.cuboids, first, count, base),
        ShapeKind::Cylinder => copy(&file.cylinders, &mut whole.cylinders, first, count, base),
        ShapeKind::Cone => copy(&file.cones, &mut whole.cones, first, count, base),
        ShapeKind::Triangle => copy(&file.triangles, &mut whole.triangles, first, count, base),
        ShapeKind::Torus => copy(&file.tori, &mut whole.tori, first, count, base),
        ShapeKind::Open => copy(&file.open_sides, &mut whole.open_sides, first, count, base),
        ShapeKind::IndexedTriangle => {
            let list = &mut whole.indexed_triangles;
            copy(&file.indexed_triangles, list, first, count, base);
            let new = list.shapes.iter_mut().skip(start as usize);
            new.for_each(|corners| corners.iter_mut().for_each(|corner| *corner += bases.vertices));
        }
    }
    whole.items.push(Item::Run { kind, first: start, count: whole.shape_count(kind) as u32 - start });
}

fn copy<T: Copy>(from: &ShapeList<T>, to: &mut ShapeList<T>, first: u32, count: u32, base: i32) {
    let (first, count) = (first as usize, count as usize);
    let entries = from.shapes.iter().zip(&from.materials).skip(first).take(count);
    for (shape, material) in entries {
        to.shapes.push(*shape);
        to.materials.push(if *material < 0 { -1 } else { *material + base });
        to.starts.push(0);
    }
}
