//! Back from baked shapes to the lists as they were written: whoever wants to leave shapes out of a scene need not keep
//! it a second time.

use super::Shapes;
use crate::form::Form;
use crate::stretch::Stretch;
use dotray_geometry::Affine;
use dotray_geometry::Shape;
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
fn lengths(stretches: &[Stretch], files: usize) -> Vec<[usize; ShapeKind::ALL.len()]> {
    let mut lengths = vec![[0; ShapeKind::ALL.len()]; files];
    for Stretch { run, .. } in stretches {
        let length = &mut lengths[run.file.0 as usize][run.kind as usize];
        *length = (*length).max((run.first + run.count) as usize);
    }
    lengths
}

impl Shapes {
    /// The runs, the matrices and the files with their lists of shapes, numbered as they were; the files' own trees
    /// are gone. `default_material` is the number that shapes of material -1 were given.
    pub(crate) fn into_written(mut self, default_material: u32) -> (Vec<Run>, Vec<Affine>, Vec<SceneFile>) {
        // What has no part in this makes room first.
        self.baked.culls = Default::default();
        let frames = self.written_frames();
        let mut files = std::mem::take(&mut self.lists.files);
        let lengths = lengths(self.lists.stretches.list(), files.len());
        for position in 0..self.len() as u32 {
            let run = self.run(position);
            let entry = (run.first + (self.number(position) - run.first_shape)) as usize;
            let file = &mut files[run.file.0 as usize];
            let length = lengths[run.file.0 as usize][run.kind as usize];
            let material = self.material(position);
            let is_default = material == default_material;
            let written = if is_default { -1 } else { (material - run.material_base) as i32 };
            put(file.shape_materials_mut(run.kind), length, entry, written);
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
                Form::OwnSphere | Form::OwnCuboid | Form::OwnCylinder | Form::OwnCone => true,
            };
            if !was_let_go {
                continue;
            }
            match self.in_object(position, &run) {
                Shape::Sphere(sphere) => put(&mut file.spheres.shapes, length, entry, sphere),
                Shape::Cuboid(cuboid) => put(&mut file.cuboids.shapes, length, entry, cuboid),
                Shape::Triangle(triangle) => put(&mut file.triangles.shapes, length, entry, triangle),
                Shape::Cylinder(cylinder) => put(&mut file.cylinders.shapes, length, entry, cylinder),
                Shape::Cone(cone) => put(&mut file.cones.shapes, length, entry, cone),
                // Their lists stay.
                Shape::Torus(_) | Shape::Open(_) => {}
            }
        }
        (self.written_runs(), frames, files)
    }

    /// The matrices by their numbers in the scene.
    fn written_frames(&self) -> Vec<Affine> {
        let lists = &self.lists;
        let own = lists.stretches.list().iter().filter(|stretch| stretch.alone);
        let own: usize = own.map(|stretch| stretch.run.count as usize).sum();
        if own == 0 {
            return lists.frames.iter().map(|frame| frame.world_from_object).collect();
        }
        let mut frames = vec![Affine::IDENTITY; lists.frames.len() + own];
        for (&number, frame) in lists.frame_numbers.iter().zip(&lists.frames) {
            frames[number as usize] = frame.world_from_object;
        }
        for position in (0..self.len() as u32).filter(|&position| self.stretch(position).alone) {
            frames[self.run(position).frame as usize] = self.frame(position).world_from_object;
        }
        frames
    }

    /// The runs as they were, with the numbers that their transforms had in the scene.
    fn written_runs(&self) -> Vec<Run> {
        let numbers = &self.lists.frame_numbers;
        let written = |stretch: &Stretch, run: Run| {
            let kept = if stretch.alone { None } else { numbers.get(run.frame as usize) };
            Run { frame: kept.map_or(run.frame, |&number| number), ..run }
        };
        let stretches = self.lists.stretches.list().iter();
        stretches.flat_map(|stretch| stretch.runs().map(move |run| written(stretch, run))).collect()
    }
}
