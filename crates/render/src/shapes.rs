//! The baked shapes, and what can be asked of them: crossings, surfaces, materials, numbers.
//!
//! A *position* is a place in the accelerator's order, so that a leaf is one block of memory; a *number* is the
//! shape's place in the scene's file order, which decides ties.

mod written;

use crate::bake::Baked;
use crate::bake::Lists;
use crate::cull::Culls;
use crate::estimate::written;
use crate::form::Form;
use crate::leaving::Leaving;
use crate::own::Ready;
use crate::stretch::Stretch;
use crate::stretch::Stretches;
use dotray_accel::Accelerator;
use dotray_accel::narrow::Frame;
use dotray_geometry::Affine;
use dotray_geometry::Crossings;
use dotray_geometry::Hit;
use dotray_geometry::Ray;
use dotray_geometry::Shape;
use dotray_geometry::Surface;
use dotray_geometry::Transform;
use dotray_geometry::Triangle;
use dotray_geometry::Vec3;
use dotray_geometry::shape::TriangleRay;
use dotray_scene::model::SceneFile;
use dotray_scene::model::ShapeKind;
use dotray_scene::resolved::Run;
use dotray_scene::resolved::RunColors;

/// The shape at a point hit, as shading wants it: in world coordinates.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct WorldSurface {
    /// The point in the world.
    pub point: Vec3,
    /// The outward unit normal of the shape itself, in the world.
    pub geometric_normal: Vec3,
    /// The same point in the shape's coordinates, before its groups; its shading normal there, of length 1.
    pub in_object: Surface,
}

/// What a shape's own colour does to its material's ambient and diffuse colour.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum OwnColor {
    /// There is none.
    No,
    /// It multiplies them.
    Times(Vec3),
    /// It stands in their place.
    Instead(Vec3),
}

/// All shapes of a scene.
#[derive(Debug, Default)]
pub struct Shapes {
    lists: Lists,
    baked: Baked,
    /// Whether walks wait for memory ([`Accelerator::is_far`]).
    is_far: bool,
}

impl Shapes {
    /// Lays down the shapes of these numbers, position by position, as the accelerator's leaves want them: where
    /// there is one that shows blocks, what rules shapes out in single precision is laid down as well. `material` turns
    /// a run and the number written there into the scene's material number.
    pub fn bake(
        runs: &[Run],
        matrices: Vec<Affine>,
        files: Vec<SceneFile>,
        numbers: &[u32],
        accelerator: Option<&Accelerator>,
        material: impl Fn(&Run, i32) -> u32 + Sync,
    ) -> Self {
        let stretches = Stretches::new(runs, matrices.len(), numbers.len() as u32);
        Self::bake_stretches(stretches, matrices, files, numbers, accelerator, material)
    }

    /// The same, where the stretches of the runs are known.
    pub(crate) fn bake_stretches(
        stretches: Stretches,
        matrices: Vec<Affine>,
        files: Vec<SceneFile>,
        numbers: &[u32],
        accelerator: Option<&Accelerator>,
        material: impl Fn(&Run, i32) -> u32 + Sync,
    ) -> Self {
        let accelerator = accelerator.filter(|accelerator| accelerator.shows_blocks());
        let cull_frame = accelerator.map(|accelerator| Frame::around(accelerator.bounds()));
        let mut lists = Lists { stretches, matrices, files, cull_frame, ..Lists::default() };
        let baked = Baked::lay(&lists, numbers, accelerator, material);
        lists.let_go();
        Self { lists, baked, is_far: accelerator.is_some_and(Accelerator::is_far) }
    }

    /// What rules shapes out in single precision; `None` where the accelerator does not ask for it.
    pub(crate) fn culls(&self) -> Option<&Culls> {
        self.lists.cull_frame.as_ref().map(|_| &self.baked.culls)
    }

    /// Asks for what a leaf's block of shapes reads.
    #[inline(always)]
    pub(crate) fn expect(&self, first: u32, count: u32) {
        self.baked.culls.expect(first as usize, count as usize);
        self.baked.expect(first, count);
    }

    /// Asks for what the tests of a leaf's shapes in double precision read, where memory is far. (Tried and dropped:
    /// not for shadow rays. In meshes they took 12 % longer.)
    #[inline(always)]
    pub(crate) fn expect_tests(&self, first: u32, count: u32) {
        if self.is_far {
            self.baked.expect(first, count);
        }
    }

    /// How many positions there are.
    pub fn len(&self) -> usize {
        self.baked.numbers.len()
    }

    /// The shape number at each position, all else let go.
    pub(crate) fn into_numbers(self) -> Vec<u32> {
        self.baked.numbers
    }

    /// Whether there is no shape.
    pub fn is_empty(&self) -> bool {
        self.baked.numbers.is_empty()
    }

    /// Whether any triangle is there (then rays carry a [`TriangleRay`]).
    pub fn has_triangles(&self) -> bool {
        !self.baked.triangles.is_empty()
    }

    /// The shape's number in file order.
    #[inline]
    pub fn number(&self, position: u32) -> u32 {
        self.baked.numbers[position as usize]
    }

    /// The shape's material.
    #[inline]
    pub fn material(&self, position: u32) -> u32 {
        self.baked.materials[position as usize]
    }

    /// The colour of the shape itself, where `ray` meets it.
    #[inline]
    pub fn own_color(&self, position: u32, ray: &Ray) -> OwnColor {
        let run = self.run(position);
        match run.colors {
            RunColors::No => OwnColor::No,
            RunColors::Shapes { list, first } => {
                let index = first + (self.number(position) - run.first_shape);
                let colors = &self.lists.files[run.file.0 as usize].colors[list as usize].colors;
                OwnColor::Times(Vec3::from_array(colors[index as usize].map(f64::from)))
            }
            RunColors::Vertices => self.interpolated_color(position, ray),
        }
    }

    #[cold]
    fn interpolated_color(&self, position: u32, ray: &Ray) -> OwnColor {
        let run = self.run(position);
        let entry = run.first + (self.number(position) - run.first_shape);
        let Some(colors) = self.lists.files[run.file.0 as usize].corner_colors(entry as usize) else {
            return OwnColor::No;
        };
        let corners = &self.baked.triangles[self.baked.slot(position).1];
        let weights = TriangleRay::new(ray).barycentric(corners);
        OwnColor::Instead(colors[0] * weights[0] + colors[1] * weights[1] + colors[2] * weights[2])
    }

    /// The unit vectors of object space along which the shape's texture coordinates grow fastest.
    pub fn texture_axes(&self, position: u32, surface: &Surface) -> Option<[Vec3; 2]> {
        self.in_object(position, &self.run(position)).texture_axes(surface)
    }

    /// The run that the shape stands in. The number of its transform is the scene's only where no other shape has it.
    #[inline]
    pub(crate) fn run(&self, position: u32) -> Run {
        self.stretch(position).run(self.number(position))
    }

    #[inline]
    fn stretch(&self, position: u32) -> &Stretch {
        let stretch = self.baked.stretches.get(position as usize).map_or(0, |&stretch| stretch as usize);
        &self.lists.stretches.list()[stretch]
    }

    /// The transform of the shape's groups.
    pub fn frame(&self, position: u32) -> Transform {
        let (baked, spills) = (&self.baked, &self.baked.spills);
        let (form, index) = baked.slot(position);
        match form {
            Form::OwnSphere => baked.own_spheres[index].transform(spills),
            Form::OwnCuboid => baked.own_cuboids[index].transform(spills),
            Form::OwnCylinder => baked.own_cylinders[index].transform(spills),
            Form::OwnCone => baked.own_cones[index].transform(spills),
            Form::Sphere
            | Form::Cuboid
            | Form::Cylinder
            | Form::Cone
            | Form::Triangle
            | Form::FramedSphere
            | Form::FramedCuboid
            | Form::FramedCylinder
            | Form::FramedCone
            | Form::FramedOther => *self.shared_frame(position),
        }
    }

    /// The transform of the shape's groups, where it is not kept with the shape.
    #[inline]
    fn shared_frame(&self, position: u32) -> &Transform {
        &self.lists.frames[self.stretch(position).run.frame as usize]
    }

    /// A unit normal of the shape's object space in the world.
    #[inline]
    pub fn world_normal(&self, position: u32, normal_in_object: Vec3) -> Vec3 {
        match self.stretch(position).run.frame {
            0 => normal_in_object,
            _ => self.frame(position).world_normal(normal_in_object),
        }
    }

    /// The files as written.
    pub fn files(&self) -> &[SceneFile] {
        &self.lists.files
    }

    /// All crossings of the ray's line with the shape at `position`. `triangle_ray` is the ray, prepared once.
    #[inline(always)]
    pub fn crossings(&self, position: u32, ray: &Ray, triangle_ray: &TriangleRay) -> Crossings {
        let (form, index) = self.baked.slot(position);
        match form {
            Form::Sphere => self.baked.spheres.get(index).crossings(ray),
            Form::Triangle => match triangle_ray.intersect(&self.baked.triangles[index]) {
                Some(t) => Crossings::one(Hit { t, face: 0 }),
                None => Crossings::NONE,
            },
            Form::Cuboid => self.baked.cuboids[index].crossings(ray),
            Form::Cylinder => self.baked.cylinders[index].crossings(ray),
            Form::Cone => self.baked.cones[index].crossings(ray),
            form @ (Form::FramedSphere
            | Form::FramedCuboid
            | Form::FramedCylinder
            | Form::FramedCone
            | Form::FramedOther) => self.framed_crossings(form, index, position, ray),
            Form::OwnSphere | Form::OwnCuboid | Form::OwnCylinder | Form::OwnCone => {
                self.own_crossings(position, ray)
            }
        }
    }

    /// Which rays that start on the shape cannot meet it again.
    pub(crate) fn leaving(&self, position: u32) -> Leaving {
        let (form, index) = self.baked.slot(position);
        match form {
            Form::Sphere | Form::Cuboid | Form::Cylinder => Leaving::solid(position),
            Form::Triangle => Leaving::triangle(position, &self.baked.triangles[index]),
            Form::FramedSphere | Form::FramedCuboid | Form::FramedCylinder => {
                Leaving::framed_solid(position, self.shared_frame(position))
            }
            Form::OwnSphere if self.baked.own_spheres[index].is_in_world() => Leaving::solid(position),
            Form::OwnCuboid if self.baked.own_cuboids[index].is_in_world() => Leaving::solid(position),
            Form::OwnCylinder if self.baked.own_cylinders[index].is_in_world() => Leaving::solid(position),
            Form::OwnSphere | Form::OwnCuboid | Form::OwnCylinder => {
                Leaving::framed_solid(position, &self.frame(position))
            }
            Form::Cone | Form::FramedCone | Form::OwnCone | Form::FramedOther => Leaving::NOTHING,
        }
    }

    #[inline(never)]
    fn framed_crossings(&self, form: Form, index: usize, position: u32, ray: &Ray) -> Crossings {
        let ray_in_object = ray.transformed(&self.shared_frame(position).object_from_world);
        match form {
            Form::FramedSphere => self.baked.framed_spheres[index].crossings(&ray_in_object),
            Form::FramedCuboid => self.baked.framed_cuboids[index].crossings(&ray_in_object),
            Form::FramedCylinder => self.baked.framed_cylinders[index].crossings(&ray_in_object),
            Form::FramedCone => self.baked.framed_cones[index].crossings(&ray_in_object),
            Form::FramedOther => self.baked.framed_others[index].crossings(&ray_in_object),
            Form::Sphere
            | Form::Cuboid
            | Form::Cylinder
            | Form::Cone
            | Form::Triangle
            | Form::OwnSphere
            | Form::OwnCuboid
            | Form::OwnCylinder
            | Form::OwnCone => Crossings::NONE,
        }
    }

    /// A shape that is kept with its matrix, ready for rays.
    #[inline]
    pub(crate) fn ready(&self, position: u32) -> Option<Ready> {
        let (form, index) = self.baked.slot(position);
        let (baked, spills) = (&self.baked, &self.baked.spills);
        match form {
            Form::OwnSphere => Some(baked.own_spheres[index].ready(spills)),
            Form::OwnCuboid => Some(baked.own_cuboids[index].ready(spills)),
            Form::OwnCylinder => Some(baked.own_cylinders[index].ready_cylinder(spills)),
            Form::OwnCone => Some(baked.own_cones[index].ready_cone(spills)),
            Form::Sphere
            | Form::Cuboid
            | Form::Cylinder
            | Form::Cone
            | Form::Triangle
            | Form::FramedSphere
            | Form::FramedCuboid
            | Form::FramedCylinder
            | Form::FramedCone
            | Form::FramedOther => None,
        }
    }

    #[inline(never)]
    fn own_crossings(&self, position: u32, ray: &Ray) -> Crossings {
        self.ready(position).map_or(Crossings::NONE, |ready| ready.crossings(ray))
    }

    /// The surface where `ray` met the shape at `position`.
    pub fn surface(&self, position: u32, ray: &Ray, hit: Hit) -> WorldSurface {
        let run = self.run(position);
        let shape = self.in_object(position, &run);
        if run.frame == 0 {
            let in_object = shape.surface(ray, hit);
            let (point, geometric_normal) = (in_object.point, in_object.geometric_normal);
            return WorldSurface { point, geometric_normal, in_object };
        }
        if let Shape::Triangle(triangle) = &shape {
            return self.triangle_surface(position, triangle, self.shared_frame(position), ray);
        }
        let frame = self.frame(position);
        let in_object = shape.surface(&ray.transformed(&frame.object_from_world), hit);
        WorldSurface {
            point: frame.world_from_object.transform_point3(in_object.point),
            geometric_normal: frame.world_normal(in_object.geometric_normal),
            in_object,
        }
    }

    /// The shape in object coordinates: as baked where the world is its object space, else as written.
    fn in_object(&self, position: u32, run: &Run) -> Shape {
        let (form, index) = self.baked.slot(position);
        match form {
            Form::Sphere if run.frame == 0 => Shape::Sphere(self.baked.spheres.get(index)),
            Form::Cuboid if run.frame == 0 => Shape::Cuboid(self.baked.cuboids[index]),
            Form::Triangle
                if run.kind == ShapeKind::Triangle
                    && let Some(pattern) = &self.lists.patterns[run.file.0 as usize] =>
            {
                Shape::Triangle(pattern.with_vertices(self.baked.triangles[index]))
            }
            Form::OwnSphere => Shape::Sphere(self.baked.own_spheres[index].sphere(&self.baked.spills)),
            Form::OwnCuboid => Shape::Cuboid(self.baked.own_cuboids[index].cuboid(&self.baked.spills)),
            Form::OwnCylinder => {
                Shape::Cylinder(self.baked.own_cylinders[index].cylinder(&self.baked.spills))
            }
            Form::OwnCone => Shape::Cone(self.baked.own_cones[index].cone(&self.baked.spills)),
            Form::Sphere
            | Form::Cuboid
            | Form::Cylinder
            | Form::Cone
            | Form::Triangle
            | Form::FramedSphere
            | Form::FramedCuboid
            | Form::FramedCylinder
            | Form::FramedCone
            | Form::FramedOther => {
                let entry = (run.first + (self.number(position) - run.first_shape)) as usize;
                let shape = self.lists.files[run.file.0 as usize].shape(run.kind, entry);
                shape.expect("a resolved run names shapes only")
            }
        }
    }

    /// A triangle was met in the world, so its barycentric coordinates are those of the world's corners.
    fn triangle_surface(
        &self,
        position: u32,
        triangle: &Triangle,
        frame: &Transform,
        ray: &Ray,
    ) -> WorldSurface {
        let corners = &self.baked.triangles[self.baked.slot(position).1];
        let weights = TriangleRay::new(ray).barycentric(corners);
        let in_object = triangle.surface_at(weights);
        WorldSurface {
            point: corners[0] * weights[0] + corners[1] * weights[1] + corners[2] * weights[2],
            geometric_normal: frame.world_normal(in_object.geometric_normal),
            in_object,
        }
    }

    /// The bytes of the baked arrays, and of the lists as written that are kept.
    pub fn memory(&self) -> (u64, u64) {
        fn bytes<T>(list: &[T]) -> u64 {
            size_of_val(list) as u64
        }
        let lists = &self.lists;
        let baked = self.baked.memory()
            + bytes(lists.stretches.list())
            + bytes(&lists.frames)
            + bytes(&lists.frame_numbers);
        let written = written(&self.lists.files);
        (baked, written)
    }
}
