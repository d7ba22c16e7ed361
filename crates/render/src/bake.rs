//! Laying shapes down: flat typed arrays in the accelerator's order, each shape in its cheapest exact form.
//!
//! A *position* is a place in the accelerator's order, so that a leaf is one block of memory; a *number* is the
//! shape's place in the scene's file order, which decides ties.

mod forms;

use crate::cull::Culls;
use crate::form::Form;
use crate::form::Slot;
use crate::own::OwnCuboid;
use crate::own::OwnRound;
use crate::own::OwnSphere;
use crate::own::Spill;
use crate::spheres::Spheres;
use crate::spheres::are_narrow;
use crate::stretch::Stretch;
use crate::stretch::Stretches;
use dotray_accel::Accelerator;
use dotray_accel::ahead;
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
use dotray_geometry::shape::corner_bounds;
use dotray_scene::model::SceneFile;
use dotray_scene::model::ShapeKind;
use dotray_scene::resolved::Run;
use rayon::prelude::*;

/// The scene's own lists.
#[derive(Debug, Default)]
pub(crate) struct Lists {
    /// The runs. Of those whose shapes are not alone in their groups, the transforms are numbered as in `frames` once
    /// shapes have been laid down.
    pub stretches: Stretches,
    /// The matrices of all groups while shapes are laid down, as the scene numbers them.
    pub matrices: Vec<Affine>,
    /// The transforms of groups of more than one shape, and of shapes that have no form for one of their own.
    pub frames: Vec<Transform>,
    /// The numbers that these transforms had in the scene; empty where they have kept them.
    pub frame_numbers: Vec<u32>,
    pub files: Vec<SceneFile>,
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
    /// The stretch of each position; empty where there is only one.
    pub stretches: Vec<u32>,
    pub spheres: Spheres,
    pub cuboids: Vec<Cuboid>,
    pub cylinders: Vec<OrientedCylinder>,
    pub cones: Vec<OrientedCone>,
    pub triangles: Vec<[Vec3; 3]>,
    pub framed_spheres: Vec<Sphere>,
    pub framed_cuboids: Vec<Cuboid>,
    pub framed_cylinders: Vec<Cylinder>,
    pub framed_cones: Vec<Cone>,
    pub framed_others: Vec<Shape>,
    pub own_spheres: Vec<OwnSphere>,
    pub own_cuboids: Vec<OwnCuboid>,
    pub own_cylinders: Vec<OwnRound>,
    pub own_cones: Vec<OwnRound>,
    /// What some of the own forms do not hold.
    pub spills: Vec<Spill>,
    pub culls: Culls,
}

/// Shape `entry` of the list of a run, in object coordinates.
fn written_shape(run: &Run, files: &[SceneFile], entry: usize) -> Shape {
    // Resolving has checked that every entry of a run is a shape.
    files[run.file.0 as usize].shape(run.kind, entry).expect("a resolved run names shapes only")
}

/// The corners of triangle `entry` of the list of a run: of a triangle that has normals, a quarter of what was written.
#[inline]
fn written_corners(run: &Run, files: &[SceneFile], entry: usize) -> [Vec3; 3] {
    files[run.file.0 as usize].corners(run.kind, entry).expect("a resolved run names shapes only")
}

/// The box in the world of shape `number`, which stands in this stretch.
pub fn world_bounds(stretch: &Stretch, frames: &[Affine], files: &[SceneFile], number: u32) -> Aabb {
    let (run, entry) = (&stretch.run, stretch.entry(number));
    let file = &files[run.file.0 as usize];
    // Spheres in no group come by the million: no look at a transform for them.
    if run.kind == ShapeKind::Sphere && run.frame == 0 {
        return file.spheres.shapes[entry].bounds();
    }
    let world_from_object = &frames[stretch.frame(number)];
    match run.kind {
        // Others of which there may be many: none is made a shape of any kind first.
        ShapeKind::Cuboid => file.cuboids.shapes[entry].world_bounds(world_from_object),
        ShapeKind::Cylinder => file.cylinders.shapes[entry].world_bounds(world_from_object),
        ShapeKind::Cone => file.cones.shapes[entry].world_bounds(world_from_object),
        ShapeKind::Triangle | ShapeKind::IndexedTriangle => {
            corner_bounds(&written_corners(run, files, entry), world_from_object)
        }
        ShapeKind::Sphere | ShapeKind::Torus | ShapeKind::Open => {
            written_shape(run, files, entry).world_bounds(world_from_object)
        }
    }
}

/// How many shapes one thread bakes at a time: what they are laid down in stays in a cache.
const PIECE: usize = 1 << 12;

/// So many pieces there are for each thread before they are put together.
const PIECES: usize = 4;

/// How many of them are read before any is baked: what is read stays in the nearest cache.
const BLOCK: usize = 1 << 7;

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
        // A few pieces at a time, lest everything is there twice, and always the same ones, lest fresh memory is asked
        // for again and again. Tried and dropped: one thread alone lays down at the end at once (0 to 4 % of building).
        let mut pieces: Vec<_> =
            (0..PIECES * rayon::current_num_threads()).map(|_| Self::default()).collect();
        for numbers in numbers.chunks(PIECE * pieces.len()) {
            numbers.par_chunks(PIECE).zip(pieces.par_iter_mut()).for_each(|(numbers, piece)| {
                numbers.chunks(BLOCK).for_each(|block| piece.push_block(lists, block, &material));
            });
            pieces.iter_mut().for_each(|piece| all.append(piece));
        }
        all.finish(accelerator);
        all
    }

    /// Makes room for `count` shapes.
    fn reserve(&mut self, lists: &Lists, count: usize) {
        self.slots.reserve_exact(count);
        self.numbers.reserve_exact(count);
        self.materials.reserve_exact(count);
        if lists.stretches.list().len() > 1 {
            self.stretches.reserve_exact(count);
        }
    }

    /// Makes room in the lists of forms for the shapes that stand in no group or alone in one, which are the most where
    /// there are many: lists that grow by doubling would need twice the memory.
    fn reserve_forms(&mut self, lists: &Lists) {
        let count = |alone: bool, wanted: &[ShapeKind]| -> usize {
            let of_these = |stretch: &&Stretch| {
                stretch.alone == alone
                    && (alone || stretch.run.frame == 0)
                    && wanted.contains(&stretch.run.kind)
            };
            lists.stretches.list().iter().filter(of_these).map(|stretch| stretch.run.count as usize).sum()
        };
        let (spheres, cuboids) = (count(false, &[ShapeKind::Sphere]), count(false, &[ShapeKind::Cuboid]));
        let (cylinders, cones) = (count(false, &[ShapeKind::Cylinder]), count(false, &[ShapeKind::Cone]));
        let triangles = count(false, &[ShapeKind::Triangle, ShapeKind::IndexedTriangle]);
        // The first that needs double precision is found soon, as a rule.
        let narrow = lists.files.iter().all(|file| are_narrow(&file.spheres.shapes));
        self.spheres = Spheres::with_capacity(spheres, narrow);
        self.cuboids.reserve_exact(cuboids);
        self.cylinders.reserve_exact(cylinders);
        self.cones.reserve_exact(cones);
        self.triangles.reserve_exact(triangles);
        let [own_spheres, own_cuboids, own_cylinders, own_cones] =
            [ShapeKind::Sphere, ShapeKind::Cuboid, ShapeKind::Cylinder, ShapeKind::Cone]
                .map(|kind| count(true, &[kind]));
        self.own_spheres.reserve_exact(own_spheres);
        self.own_cuboids.reserve_exact(own_cuboids);
        self.own_cylinders.reserve_exact(own_cylinders);
        self.own_cones.reserve_exact(own_cones);
        if lists.cull_frame.is_some() {
            // A bar lies in a ball.
            let bars = cylinders + own_cylinders + cones + own_cones;
            let balls = spheres + own_spheres + bars;
            self.culls.reserve([balls, bars, cuboids + own_cuboids, triangles]);
        }
    }

    /// Appends the shapes of these numbers at the next positions, as many at a time as follow each other in one
    /// stretch.
    fn push_block(&mut self, lists: &Lists, numbers: &[u32], material: &impl Fn(&Run, i32) -> u32) {
        let mut rest = numbers;
        while let Some(&number) = rest.first() {
            let found = lists.stretches.find(number);
            let stretch = &lists.stretches.list()[found];
            let (start, end) = (stretch.run.first_shape, stretch.run.first_shape + stretch.run.count);
            let count = rest.iter().take_while(|number| (start..end).contains(number)).count().max(1);
            let (these, others) = rest.split_at(count);
            if lists.stretches.list().len() > 1 {
                self.stretches.extend(std::iter::repeat_n(found as u32, count));
            }
            let run = &stretch.run;
            let materials = lists.files[run.file.0 as usize].shape_materials(run.kind);
            let material = |number: &u32| material(run, materials[stretch.entry(*number)]);
            self.materials.extend(these.iter().map(material));
            self.numbers.extend_from_slice(these);
            self.push_forms(lists, stretch, these);
            rest = others;
        }
    }

    /// Moves the shapes of the positions that follow here.
    fn append(&mut self, piece: &mut Self) {
        let first = self.numbers.len();
        let lengths = Form::ALL.map(|form| self.len_of(form));
        let moved = |slot: Slot| Slot::new(slot.form(), slot.index() + lengths[slot.form() as usize]);
        self.slots.extend(piece.slots.drain(..).map(moved));
        self.numbers.append(&mut piece.numbers);
        self.materials.append(&mut piece.materials);
        self.stretches.append(&mut piece.stretches);
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
        let spilled = self.spills.len();
        self.own_spheres.extend(piece.own_spheres.drain(..).map(|own| own.moved(spilled)));
        self.own_cuboids.extend(piece.own_cuboids.drain(..).map(|own| own.moved(spilled)));
        self.own_cylinders.extend(piece.own_cylinders.drain(..).map(|own| own.moved(spilled)));
        self.own_cones.extend(piece.own_cones.drain(..).map(|own| own.moved(spilled)));
        self.spills.append(&mut piece.spills);
        self.culls.append(first, &mut piece.culls);
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
            Form::OwnSphere => self.own_spheres.len(),
            Form::OwnCuboid => self.own_cuboids.len(),
            Form::OwnCylinder => self.own_cylinders.len(),
            Form::OwnCone => self.own_cones.len(),
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
        self.spills.shrink_to_fit();
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

    /// Asks for what the tests of a leaf's shapes in double precision read.
    #[inline(always)]
    pub fn expect(&self, first: u32, count: u32) {
        let (first, count) = (first as usize, count as usize);
        match self.only {
            Some(Form::Sphere) => self.spheres.expect(first, count),
            Some(Form::Triangle) => ahead::fetch_some(&self.triangles, first, count),
            Some(Form::Cylinder) => ahead::fetch_some(&self.cylinders, first, count),
            Some(Form::Cone) => ahead::fetch_some(&self.cones, first, count),
            Some(Form::Cuboid) => ahead::fetch_some(&self.cuboids, first, count),
            Some(Form::OwnSphere) => ahead::fetch_some(&self.own_spheres, first, count),
            Some(Form::OwnCuboid) => ahead::fetch_some(&self.own_cuboids, first, count),
            Some(Form::OwnCylinder) => ahead::fetch_some(&self.own_cylinders, first, count),
            Some(Form::OwnCone) => ahead::fetch_some(&self.own_cones, first, count),
            Some(
                Form::FramedSphere
                | Form::FramedCuboid
                | Form::FramedCylinder
                | Form::FramedCone
                | Form::FramedOther,
            )
            | None => ahead::fetch_some(&self.slots, first, count),
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
            + bytes(&self.stretches)
            + self.spheres.memory()
            + bytes(&self.cuboids)
            + bytes(&self.cylinders)
            + bytes(&self.cones)
            + bytes(&self.triangles)
            + bytes(&self.framed_spheres)
            + bytes(&self.framed_cuboids)
            + bytes(&self.framed_cylinders)
            + bytes(&self.framed_cones)
            + bytes(&self.framed_others)
            + bytes(&self.own_spheres)
            + bytes(&self.own_cuboids)
            + bytes(&self.own_cylinders)
            + bytes(&self.own_cones)
            + bytes(&self.spills)
            + self.culls.memory()
    }
}

impl Lists {
    /// Lets go of what nobody asks for any more, once every shape has been laid down: all materials, the lists of kinds
    /// of shapes whose baked form says the same (spheres and boxes that stand in no group, all that are alone in
    /// theirs, triangles in no group that are dressed alike), and the transforms of shapes that are alone.
    pub fn let_go(&mut self) {
        self.stretches.forget_shapes();
        let mut asked_for = vec![[false; ShapeKind::ALL.len()]; self.files.len()];
        for Stretch { run, alone } in self.stretches.list() {
            let baked_as_written = run.frame == 0
                && matches!(run.kind, ShapeKind::Sphere | ShapeKind::Cuboid | ShapeKind::Triangle);
            asked_for[run.file.0 as usize][run.kind as usize] |= !(*alone || baked_as_written);
        }
        for (file, asked_for) in self.files.iter_mut().zip(asked_for) {
            let asked_for = |kind: ShapeKind| asked_for[kind as usize];
            if !asked_for(ShapeKind::Sphere) {
                file.spheres.shapes = Vec::new();
            }
            if !asked_for(ShapeKind::Cuboid) {
                file.cuboids.shapes = Vec::new();
            }
            if !asked_for(ShapeKind::Cylinder) {
                file.cylinders.shapes = Vec::new();
            }
            if !asked_for(ShapeKind::Cone) {
                file.cones.shapes = Vec::new();
            }
            let triangles = &file.triangles.shapes;
            let pattern = triangles.first().copied().filter(|first| {
                !asked_for(ShapeKind::Triangle)
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
        self.let_go_of_frames();
    }

    /// Keeps the transforms of groups in which no shape is alone, and numbers them anew.
    fn let_go_of_frames(&mut self) {
        let matrices = std::mem::take(&mut self.matrices);
        // The world itself is number 0.
        let transform = |(number, matrix)| match number {
            0 => Transform::IDENTITY,
            _ => Transform::again(matrix),
        };
        if self.stretches.list().iter().all(|stretch| !stretch.alone) {
            self.frames = matrices.into_par_iter().enumerate().map(transform).collect();
            return;
        }
        let mut shared = vec![true; matrices.len()];
        for stretch in self.stretches.list().iter().filter(|stretch| stretch.alone) {
            let first = stretch.run.frame as usize;
            shared[first..first + stretch.run.count as usize].fill(false);
        }
        self.frame_numbers =
            (0_u32..).zip(&shared).filter(|(_, shared)| **shared).map(|(number, _)| number).collect();
        let numbers = self.frame_numbers.iter().map(|&number| number as usize);
        self.frames = numbers.map(|number| transform((number, matrices[number]))).collect();
        for stretch in self.stretches.list_mut().iter_mut().filter(|stretch| !stretch.alone) {
            let kept = self.frame_numbers.binary_search(&stretch.run.frame);
            stretch.run.frame = kept.expect("a transform that is in use") as u32;
        }
    }
}
