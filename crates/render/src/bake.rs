//! Laying shapes down: flat typed arrays in the accelerator's order, each shape in its cheapest exact form.
//!
//! A *position* is a place in the accelerator's order, so that a leaf is one block of memory; a *number* is the
//! shape's place in the scene's file order, which decides ties.

use crate::cull::Culls;
use crate::cull::Spine;
use crate::form::Form;
use crate::form::Slot;
use crate::form::axis_aligned;
use dotray_accel::Accelerator;
use dotray_accel::narrow::Frame;
use dotray_geometry::Aabb;
use dotray_geometry::Affine;
use dotray_geometry::Cone;
use dotray_geometry::Cuboid;
use dotray_geometry::Cylinder;
use dotray_geometry::Shape;
use dotray_geometry::Sphere;
use dotray_geometry::Transform;
use dotray_geometry::Triangle;
use dotray_geometry::Vec3;
use dotray_geometry::shape::OrientedCone;
use dotray_geometry::shape::OrientedCylinder;
use dotray_scene::model::SceneFile;
use dotray_scene::model::ShapeKind;
use dotray_scene::resolved::Run;
use rayon::prelude::*;

/// The scene's own lists.
#[derive(Debug, Default)]
pub(crate) struct Lists {
    pub runs: Vec<Run>,
    pub frames: Vec<Transform>,
    pub files: Vec<SceneFile>,
    /// Finds runs while shapes are laid down.
    pub index: RunIndex,
    /// For each file whose triangles all stand in the world and have the same normals and texture coordinates, one of
    /// them: with the baked corners it says all that was written.
    pub patterns: Vec<Option<Triangle>>,
    /// Where single precision rules shapes out, for accelerators that ask for it.
    pub cull_frame: Option<Frame>,
}

/// Baked shapes, position by position, and each form's list.
#[derive(Debug, Default)]
pub(crate) struct Baked {
    /// The only form there is: then the list of slots is empty, and a position is an index into that form's list.
    only: Option<Form>,
    slots: Vec<Slot>,
    pub numbers: Vec<u32>,
    pub materials: Vec<u32>,
    /// The run of each position; empty where there is only one run.
    pub runs_of: Vec<u32>,
    pub spheres: Vec<Sphere>,
    pub cuboids: Vec<Cuboid>,
    pub cylinders: Vec<OrientedCylinder>,
    pub cones: Vec<OrientedCone>,
    pub triangles: Vec<[Vec3; 3]>,
    pub framed_spheres: Vec<Sphere>,
    pub framed_cuboids: Vec<Cuboid>,
    pub framed_cylinders: Vec<Cylinder>,
    pub framed_cones: Vec<Cone>,
    pub framed_others: Vec<Shape>,
    pub culls: Culls,
}

/// Shape `number` of the scene, which stands in this run, in object coordinates.
fn written_shape(run: &Run, files: &[SceneFile], number: u32) -> Shape {
    let entry = (run.first + (number - run.first_shape)) as usize;
    // Resolving has checked that every entry of a run is a shape.
    files[run.file.0 as usize].shape(run.kind, entry).expect("a resolved run names shapes only")
}

/// The box in the world of shape `number`, which stands in this run.
pub fn world_bounds(run: &Run, frames: &[Transform], files: &[SceneFile], number: u32) -> Aabb {
    // Spheres in no group come by the million: no look at a transform for them.
    if run.kind == ShapeKind::Sphere && run.frame == 0 {
        let entry = (run.first + (number - run.first_shape)) as usize;
        return files[run.file.0 as usize].spheres.shapes[entry].bounds();
    }
    let shape = written_shape(run, files, number);
    shape.world_bounds(&frames[run.frame as usize].world_from_object)
}

/// Finds the runs of shapes: where every shape stands in a group of its own, there are as many runs as shapes.
#[derive(Debug, Default)]
pub struct RunIndex {
    /// The run of every so many-th shape, and the last run.
    marks: Vec<u32>,
}

impl RunIndex {
    /// The shapes from mark to mark.
    const STEP: u32 = 16;

    /// Over these runs of `count` shapes.
    pub fn new(runs: &[Run], count: u32) -> Self {
        let mut run = 0;
        let mut holder = |number: u32| {
            while runs.get(run + 1).is_some_and(|next| next.first_shape <= number) {
                run += 1;
            }
            run as u32
        };
        let mut marks: Vec<_> = (0..count).step_by(Self::STEP as usize).map(&mut holder).collect();
        marks.push(runs.len().saturating_sub(1) as u32);
        Self { marks }
    }

    /// Which of the runs holds shape `number`.
    #[inline]
    pub fn find(&self, runs: &[Run], number: u32) -> usize {
        if runs.len() == 1 {
            return 0;
        }
        let mark = (number / Self::STEP) as usize;
        let (first, last) = (self.marks[mark] as usize, self.marks[mark + 1] as usize);
        // Where every shape is a run of its own, the search would wait for memory several times over.
        let guess = (first + (number % Self::STEP) as usize).min(last);
        if runs[guess].first_shape == number && runs[guess].count > 0 {
            return guess;
        }
        first + runs[first..=last].partition_point(|run| run.first_shape <= number) - 1
    }
}

/// Puts a shape into the list of its form.
fn put<T>(list: &mut Vec<T>, form: Form, value: T) -> Slot {
    list.push(value);
    Slot::new(form, list.len() - 1)
}

/// How many shapes one thread bakes at a time.
const PIECE: usize = 1 << 14;

impl Baked {
    /// Bakes the shapes of these numbers, one position after another. `material` turns a run and the number written
    /// there into the scene's material number. The result does not depend on the number of threads.
    pub fn lay(
        lists: &Lists,
        numbers: &[u32],
        accelerator: Option<&Accelerator>,
        material: impl Fn(&Run, i32) -> u32 + Sync,
    ) -> Self {
        let mut all = Self::default();
        all.reserve(lists, numbers.len());
        all.reserve_forms(lists);
        // A few pieces at a time, lest everything is there twice.
        for pieces in numbers.chunks(PIECE * 4 * rayon::current_num_threads()) {
            let piece = |numbers: &[u32]| {
                let mut piece = Self::default();
                piece.reserve(lists, numbers.len());
                match lists.runs.first() {
                    Some(run) if lists.runs.len() == 1 && run.kind == ShapeKind::Sphere && run.frame == 0 => {
                        piece.push_spheres(lists, run, numbers, &material);
                    }
                    _ => numbers.iter().for_each(|&number| piece.push(lists, number, &material)),
                }
                piece
            };
            let baked: Vec<Self> = pieces.par_chunks(PIECE).map(piece).collect();
            baked.into_iter().for_each(|piece| all.append(piece));
        }
        all.finish(accelerator);
        all
    }

    /// Makes room for `count` shapes.
    fn reserve(&mut self, lists: &Lists, count: usize) {
        self.slots.reserve_exact(count);
        self.numbers.reserve_exact(count);
        self.materials.reserve_exact(count);
        if lists.runs.len() > 1 {
            self.runs_of.reserve_exact(count);
        }
    }

    /// Makes room in the lists of forms for the shapes that stand in no group, which are the most where there are
    /// many: lists that grow by doubling would need twice the memory.
    fn reserve_forms(&mut self, lists: &Lists) {
        let count = |wanted: &[ShapeKind]| -> usize {
            let runs = lists.runs.iter().filter(|run| run.frame == 0 && wanted.contains(&run.kind));
            runs.map(|run| run.count as usize).sum()
        };
        let (spheres, cuboids) = (count(&[ShapeKind::Sphere]), count(&[ShapeKind::Cuboid]));
        let (cylinders, cones) = (count(&[ShapeKind::Cylinder]), count(&[ShapeKind::Cone]));
        let triangles = count(&[ShapeKind::Triangle, ShapeKind::IndexedTriangle]);
        self.spheres.reserve_exact(spheres);
        self.cuboids.reserve_exact(cuboids);
        self.cylinders.reserve_exact(cylinders);
        self.cones.reserve_exact(cones);
        self.triangles.reserve_exact(triangles);
        if lists.cull_frame.is_some() {
            self.culls.reserve(spheres, triangles);
        }
    }

    /// Appends shape `number` at the next position.
    fn push(&mut self, lists: &Lists, number: u32, material: impl Fn(&Run, i32) -> u32) {
        let run_index = lists.index.find(&lists.runs, number);
        let run = &lists.runs[run_index];
        let file = &lists.files[run.file.0 as usize];
        let entry = (run.first + (number - run.first_shape)) as usize;
        self.materials.push(material(run, file.shape_materials(run.kind)[entry]));
        self.numbers.push(number);
        if lists.runs.len() > 1 {
            self.runs_of.push(run_index as u32);
        }
        let slot = if run.kind == ShapeKind::Sphere && run.frame == 0 {
            let sphere = file.spheres.shapes[entry];
            self.cull_ball(lists.cull_frame.as_ref(), sphere.center(), sphere.radius());
            put(&mut self.spheres, Form::Sphere, sphere)
        } else {
            let shape = written_shape(run, &lists.files, number);
            self.bake(lists, &shape, run.frame as usize)
        };
        self.slots.push(slot);
    }

    /// Appends spheres of a scene that has nothing else, list by list: they are read in the order of the leaves, each
    /// from another place, and a short loop waits for many of them at once.
    fn push_spheres(
        &mut self,
        lists: &Lists,
        run: &Run,
        numbers: &[u32],
        material: impl Fn(&Run, i32) -> u32,
    ) {
        let file = &lists.files[run.file.0 as usize];
        let entry = |number: &u32| (run.first + (number - run.first_shape)) as usize;
        let (first, place) = (self.spheres.len(), self.slots.len());
        let materials = file.shape_materials(run.kind);
        self.spheres.reserve_exact(numbers.len());
        self.spheres.extend(numbers.iter().map(|number| file.spheres.shapes[entry(number)]));
        self.materials.extend(numbers.iter().map(|number| material(run, materials[entry(number)])));
        self.numbers.extend_from_slice(numbers);
        self.slots.extend((first..first + numbers.len()).map(|index| Slot::new(Form::Sphere, index)));
        if let Some(frame) = &lists.cull_frame {
            for (sphere, position) in self.spheres[first..].iter().zip(place..) {
                self.culls.put_ball(frame, position, sphere.center(), sphere.radius());
            }
        }
    }

    /// Appends the shapes of the positions that follow.
    fn append(&mut self, mut piece: Self) {
        let first = self.numbers.len();
        let lengths = Form::ALL.map(|form| self.len_of(form));
        let moved = |slot: &Slot| Slot::new(slot.form(), slot.index() + lengths[slot.form() as usize]);
        self.slots.extend(piece.slots.iter().map(moved));
        self.numbers.append(&mut piece.numbers);
        self.materials.append(&mut piece.materials);
        self.runs_of.append(&mut piece.runs_of);
        self.spheres.append(&mut piece.spheres);
        self.cuboids.append(&mut piece.cuboids);
        self.cylinders.append(&mut piece.cylinders);
        self.cones.append(&mut piece.cones);
        self.triangles.append(&mut piece.triangles);
        self.framed_spheres.append(&mut piece.framed_spheres);
        self.framed_cuboids.append(&mut piece.framed_cuboids);
        self.framed_cylinders.append(&mut piece.framed_cylinders);
        self.framed_cones.append(&mut piece.framed_cones);
        self.framed_others.append(&mut piece.framed_others);
        self.culls.append(first, piece.culls);
    }

    fn len_of(&self, form: Form) -> usize {
        match form {
            Form::Sphere => self.spheres.len(),
            Form::Cuboid => self.cuboids.len(),
            Form::Cylinder => self.cylinders.len(),
            Form::Cone => self.cones.len(),
            Form::Triangle => self.triangles.len(),
            Form::FramedSphere => self.framed_spheres.len(),
            Form::FramedCuboid => self.framed_cuboids.len(),
            Form::FramedCylinder => self.framed_cylinders.len(),
            Form::FramedCone => self.framed_cones.len(),
            Form::FramedOther => self.framed_others.len(),
        }
    }

    /// Ends the lists; slots that say nothing go.
    fn finish(&mut self, accelerator: Option<&Accelerator>) {
        let count = self.numbers.len();
        if let Some(accelerator) = accelerator {
            self.culls.finish(count, accelerator);
        }
        self.only = Form::ALL.into_iter().find(|&form| count > 0 && self.len_of(form) == count);
        if self.only.is_some() {
            self.slots = Vec::new();
        }
        self.spheres.shrink_to_fit();
        self.cuboids.shrink_to_fit();
        self.cylinders.shrink_to_fit();
        self.cones.shrink_to_fit();
        self.triangles.shrink_to_fit();
    }

    /// The form of the shape at `position` and its place in that form's list.
    #[inline(always)]
    pub fn slot(&self, position: u32) -> (Form, usize) {
        match self.only {
            Some(form) => (form, position as usize),
            None => {
                let slot = self.slots[position as usize];
                (slot.form(), slot.index())
            }
        }
    }

    fn bake(&mut self, lists: &Lists, shape: &Shape, frame: usize) -> Slot {
        let transform = lists.frames[frame];
        let culls = lists.cull_frame.as_ref();
        let world_from_object = &transform.world_from_object;
        let similarity = if frame == 0 { Some(1.0) } else { transform.similarity_scale() };
        match shape {
            Shape::Sphere(sphere) => self.bake_sphere(culls, shape, sphere, similarity, world_from_object),
            Shape::Cuboid(cuboid) => {
                self.cull_box(culls, shape, world_from_object);
                match axis_aligned(cuboid, &transform) {
                    Some(cuboid) => put(&mut self.cuboids, Form::Cuboid, cuboid),
                    None => put(&mut self.framed_cuboids, Form::FramedCuboid, *cuboid),
                }
            }
            Shape::Cylinder(cylinder) => match similarity {
                Some(scale) => {
                    let c = OrientedCylinder::from_object(cylinder, world_from_object, scale);
                    self.cull_bar(culls, &Spine::along(c.base(), c.axis(), c.radius(), c.height()));
                    put(&mut self.cylinders, Form::Cylinder, c)
                }
                None => {
                    self.cull_framed_bar(
                        culls,
                        shape,
                        world_from_object,
                        cylinder.center(),
                        cylinder.radius(),
                    );
                    put(&mut self.framed_cylinders, Form::FramedCylinder, *cylinder)
                }
            },
            Shape::Cone(cone) => match similarity {
                Some(scale) => {
                    let c = OrientedCone::from_object(cone, world_from_object, scale);
                    self.cull_bar(culls, &Spine::along(c.base(), c.axis(), c.widest(), c.height()));
                    put(&mut self.cones, Form::Cone, c)
                }
                None => {
                    self.cull_framed_bar(culls, shape, world_from_object, cone.center(), cone.widest());
                    put(&mut self.framed_cones, Form::FramedCone, *cone)
                }
            },
            Shape::Triangle(triangle) => {
                let corners = triangle.vertices().map(|v| world_from_object.transform_point3(v));
                if let Some(frame) = culls {
                    self.culls.put_triangle(frame, self.slots.len(), &corners);
                }
                put(&mut self.triangles, Form::Triangle, corners)
            }
            Shape::Torus(_) | Shape::Open(_) => {
                self.cull_box(culls, shape, world_from_object);
                put(&mut self.framed_others, Form::FramedOther, *shape)
            }
        }
    }

    /// A sphere that stays one in the world, or an ellipsoid.
    fn bake_sphere(
        &mut self,
        culls: Option<&Frame>,
        shape: &Shape,
        sphere: &Sphere,
        similarity: Option<f64>,
        world_from_object: &Affine,
    ) -> Slot {
        let in_world = similarity.and_then(|scale| {
            Sphere::new(world_from_object.transform_point3(sphere.center()), sphere.radius() * scale).ok()
        });
        match in_world {
            Some(sphere) => {
                self.cull_ball(culls, sphere.center(), sphere.radius());
                put(&mut self.spheres, Form::Sphere, sphere)
            }
            None => {
                self.cull_box(culls, shape, world_from_object);
                put(&mut self.framed_spheres, Form::FramedSphere, *sphere)
            }
        }
    }

    fn cull_ball(&mut self, frame: Option<&Frame>, center: Vec3, radius: f64) {
        if let Some(frame) = frame {
            self.culls.put_ball(frame, self.slots.len(), center, radius);
        }
    }

    fn cull_box(&mut self, frame: Option<&Frame>, shape: &Shape, world_from_object: &Affine) {
        if let Some(frame) = frame {
            self.culls.put_box(frame, self.slots.len(), &shape.world_bounds(world_from_object));
        }
    }

    fn cull_bar(&mut self, frame: Option<&Frame>, spine: &Spine) {
        if let Some(frame) = frame {
            self.culls.put_bar(frame, self.slots.len(), spine);
        }
    }

    /// A cylinder or cone that a general map has squeezed.
    fn cull_framed_bar(
        &mut self,
        frame: Option<&Frame>,
        shape: &Shape,
        world_from_object: &Affine,
        center: Vec3,
        radius: f64,
    ) {
        match Spine::new(world_from_object, &shape.world_bounds(world_from_object), center, radius) {
            Some(spine) => self.cull_bar(frame, &spine),
            None => self.cull_box(frame, shape, world_from_object),
        }
    }

    /// The bytes of all lists.
    pub fn memory(&self) -> u64 {
        fn bytes<T>(list: &[T]) -> u64 {
            size_of_val(list) as u64
        }
        bytes(&self.slots)
            + bytes(&self.numbers)
            + bytes(&self.materials)
            + bytes(&self.runs_of)
            + bytes(&self.spheres)
            + bytes(&self.cuboids)
            + bytes(&self.cylinders)
            + bytes(&self.cones)
            + bytes(&self.triangles)
            + bytes(&self.framed_spheres)
            + bytes(&self.framed_cuboids)
            + bytes(&self.framed_cylinders)
            + bytes(&self.framed_cones)
            + bytes(&self.framed_others)
            + self.culls.memory()
    }
}

impl Lists {
    /// Lets go of the lists as written that nobody asks for any more, once every shape has been laid down: all
    /// materials, the spheres and boxes that stand in no group, whose baked form is the same, and such triangles if
    /// all are dressed alike.
    pub fn let_go(&mut self) {
        self.index = RunIndex::default();
        for (index, file) in self.files.iter_mut().enumerate() {
            let in_world = |kind: ShapeKind| {
                let mut runs =
                    self.runs.iter().filter(|run| run.file.0 as usize == index && run.kind == kind);
                runs.all(|run| run.frame == 0)
            };
            if in_world(ShapeKind::Sphere) {
                file.spheres.shapes = Vec::new();
            }
            if in_world(ShapeKind::Cuboid) {
                file.cuboids.shapes = Vec::new();
            }
            let triangles = &file.triangles.shapes;
            let pattern = triangles.first().copied().filter(|first| {
                in_world(ShapeKind::Triangle)
                    && triangles.par_iter().all(|other| first.is_dressed_like(other))
            });
            if pattern.is_some() {
                file.triangles.shapes = Vec::new();
            }
            self.patterns.push(pattern);
            file.spheres.materials = Vec::new();
            file.cuboids.materials = Vec::new();
            file.cylinders.materials = Vec::new();
            file.cones.materials = Vec::new();
            file.triangles.materials = Vec::new();
            file.indexed_triangles.materials = Vec::new();
            file.tori.materials = Vec::new();
            file.open_sides.materials = Vec::new();
            // The tree has become runs and transforms.
            file.items = Vec::new();
            file.groups = Vec::new();
        }
    }
}

#[cfg(test)]
mod tests {
    use super::RunIndex;
    use dotray_scene::model::ShapeKind;
    use dotray_scene::resolved::Run;
    use dotray_scene::resolved::RunColors;
    use dotray_scene::span::FileId;

    #[test]
    fn every_shape_is_found_in_its_run() {
        let lengths = [1, 1, 40, 3, 16, 1, 1, 1, 100, 15, 17, 1];
        let mut runs: Vec<Run> = Vec::new();
        let mut count = 0;
        for length in lengths.into_iter().cycle().take(50) {
            runs.push(Run {
                file: FileId(0),
                kind: ShapeKind::Sphere,
                first: 0,
                count: length,
                frame: 0,
                material_base: 0,
                first_shape: count,
                colors: RunColors::No,
            });
            count += length;
        }
        let index = RunIndex::new(&runs, count);
        for number in 0..count {
            let run = &runs[index.find(&runs, number)];
            assert!((run.first_shape..run.first_shape + run.count).contains(&number), "{number}: {run:?}");
        }
    }
}
