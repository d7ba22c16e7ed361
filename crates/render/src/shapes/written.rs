//! Back from baked shapes to the lists as they were written: whoever wants to leave shapes out of a scene need not keep
//! it a second time.

use super::Shapes;
use crate::bake::Lists;
use crate::form::Form;
use dotray_geometry::Shape;
use dotray_geometry::Transform;
use dotray_scene::model::SceneFile;
use dotray_scene::model::ShapeKind;
use dotray_scene::resolved::Run;

/// What was let go when shapes were baked, put back where it was; else nothing changes.
fn put<T: Clone>(list: &mut Vec<T>, length: usize, entry: usize, value: T) {
    if list.len() < length {
        list.reserve_exact(length - list.len());
        list.resize(length, value.clone());
    }
    if let Some(place) = list.get_mut(entry) {
        *place = value;
    }
}

/// How long each list was: by file and kind, as far as runs reach.
fn lengths(runs: &[Run], files: usize) -> Vec<[usize; ShapeKind::ALL.len()]> {
    let mut lengths = vec![[0; ShapeKind::ALL.len()]; files];
    for run in runs {
        let length = &mut lengths[run.file.0 as usize][run.kind as usize];
        *length = (*length).max((run.first + run.count) as usize);
    }
    lengths
}

impl Shapes {
    /// The runs, the transforms and the files with their lists of shapes, numbered as they were; the files' own trees
    /// are gone. `default_material` is the number that shapes of material -1 were given.
    pub(crate) fn into_written(
        mut self,
        default_material: u32,
    ) -> (Vec<Run>, Vec<Transform>, Vec<SceneFile>) {
        // What has no part in this makes room first.
        self.baked.culls = Default::default();
        let mut files = std::mem::take(&mut self.lists.files);
        let lengths = lengths(&self.lists.runs, files.len());
        for position in 0..self.len() as u32 {
            let run = *self.run(position);
            let entry = (run.first + (self.number(position) - run.first_shape)) as usize;
            let file = &mut files[run.file.0 as usize];
            let length = lengths[run.file.0 as usize][run.kind as usize];
            let material = self.material(position);
            let is_default = material == default_material;
            let written = if is_default { -1 } else { (material - run.material_base) as i32 };
            put(materials_mut(file, run.kind), length, entry, written);
            let (form, _) = self.baked.slot(position);
            let was_let_go = match form {
                Form::Sphere | Form::Cuboid => run.frame == 0,
                Form::Triangle => {
                    run.kind == ShapeKind::Triangle && self.lists.patterns[run.file.0 as usize].is_some()
                }
                Form::Cylinder
                | Form::Cone
                | Form::FramedSphere
                | Form::FramedCuboid
                | Form::FramedCylinder
                | Form::FramedCone
                | Form::FramedOther => false,
            };
            if !was_let_go {
                continue;
            }
            match self.in_object(position, &run) {
                Shape::Sphere(sphere) => put(&mut file.spheres.shapes, length, entry, sphere),
                Shape::Cuboid(cuboid) => put(&mut file.cuboids.shapes, length, entry, cuboid),
                Shape::Triangle(triangle) => put(&mut file.triangles.shapes, length, entry, triangle),
                // Their lists stay.
                Shape::Cylinder(_) | Shape::Cone(_) | Shape::Torus(_) | Shape::Open(_) => {}
            }
        }
        let Lists { runs, frames, .. } = self.lists;
        (runs, frames, files)
    }
}

fn materials_mut(file: &mut SceneFile, kind: ShapeKind) -> &mut Vec<i32> {
    match kind {
        ShapeKind::Sphere => &mut file.spheres.materials,
        ShapeKind::Cuboid => &mut file.cuboids.materials,
        ShapeKind::Cylinder => &mut file.cylinders.materials,
        ShapeKind::Cone => &mut file.cones.materials,
        ShapeKind::Triangle => &mut file.triangles.materials,
        ShapeKind::IndexedTriangle => &mut file.indexed_triangles.materials,
        ShapeKind::Torus => &mut file.tori.materials,
        ShapeKind::Open => &mut file.open_sides.materials,
    }
}
