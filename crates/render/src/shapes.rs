//! The baked shapes: flat typed arrays in the accelerator's order, each shape in its cheapest exact form.
//!
//! A *position* is a place in the accelerator's order, so that a leaf is one block of memory; a *number* is the
//! shape's place in the scene's file order, which decides ties.

use crate::cull::Culls;
use crate::cull::Spine;
use crate::form::Form;
use crate::form::Slot;
use crate::form::axis_aligned;
use dotray_accel::narrow::Frame;
use dotray_geometry::Affine;
use dotray_geometry::Cone;
use dotray_geometry::Crossings;
use dotray_geometry::Cuboid;
use dotray_geometry::Cylinder;
use dotray_geometry::Hit;
use dotray_geometry::Ray;
use dotray_geometry::Shape;
use dotray_geometry::Sphere;
use dotray_geometry::Surface;
use dotray_geometry::Transform;
use dotray_geometry::Triangle;
use dotray_geometry::Vec3;
use dotray_geometry::shape::OrientedCone;
use dotray_geometry::shape::OrientedCylinder;
use dotray_geometry::shape::TriangleRay;
use dotray_scene::model::SceneFile;
use dotray_scene::model::ShapeKind;
use dotray_scene::resolved::Run;

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

/// All shapes of a scene.
#[derive(Debug, Default)]
pub struct Shapes {
    slots: Vec<Slot>,
    numbers: Vec<u32>,
    materials: Vec<u32>,
    /// The run of each position; empty where there is only one run.
    runs_of: Vec<u32>,
    runs: Vec<Run>,
    frames: Vec<Transform>,
    files: Vec<SceneFile>,
    spheres: Vec<Sphere>,
    cuboids: Vec<Cuboid>,
    cylinders: Vec<OrientedCylinder>,
    cones: Vec<OrientedCone>,
    triangles: Vec<[Vec3; 3]>,
    framed_spheres: Vec<Sphere>,
    framed_cuboids: Vec<Cuboid>,
    framed_cylinders: Vec<Cylinder>,
    framed_cones: Vec<Cone>,
    /// Where single precision rules shapes out, for accelerators that ask for it.
    cull_frame: Option<Frame>,
    culls: Culls,
}

/// Shape `number` of the scene, in object coordinates, with its run.
pub fn written_shape<'a>(runs: &'a [Run], files: &[SceneFile], number: u32) -> (usize, &'a Run, Shape) {
    let index = run_of(runs, number);
    let run = &runs[index];
    let entry = (run.first + (number - run.first_shape)) as usize;
    // Resolving has checked that every entry of a run is a shape.
    let shape = files[run.file.0 as usize].shape(run.kind, entry).expect("a resolved run names shapes only");
    (index, run, shape)
}

/// The run that holds shape `number`.
pub fn run_of(runs: &[Run], number: u32) -> usize {
    runs.partition_point(|run| run.first_shape <= number) - 1
}

impl Shapes {
    /// Starts with the scene's lists, without any shape baked. With `cull_frame`, what rules shapes out in single
    /// precision is laid down as well.
    pub fn new(
        runs: Vec<Run>,
        frames: Vec<Transform>,
        files: Vec<SceneFile>,
        cull_frame: Option<Frame>,
    ) -> Self {
        Self { runs, frames, files, cull_frame, ..Self::default() }
    }

    /// Makes room for `count` shapes.
    pub fn reserve(&mut self, count: usize) {
        self.slots.reserve_exact(count);
        self.numbers.reserve_exact(count);
        self.materials.reserve_exact(count);
        if self.runs.len() > 1 {
            self.runs_of.reserve_exact(count);
        }
    }

    /// Appends shape `number` at the next position. `material` turns the run and the number written there into the
    /// scene's material number.
    pub fn push(&mut self, number: u32, material: impl Fn(&Run, i32) -> u32) {
        let (run_index, run, shape) = written_shape(&self.runs, &self.files, number);
        let entry = (run.first + (number - run.first_shape)) as usize;
        let written = self.files[run.file.0 as usize].shape_materials(run.kind)[entry];
        self.materials.push(material(run, written));
        self.numbers.push(number);
        let frame = run.frame as usize;
        if self.runs.len() > 1 {
            self.runs_of.push(run_index as u32);
        }
        let slot = self.bake(&shape, frame);
        self.slots.push(slot);
    }

    fn bake(&mut self, shape: &Shape, frame: usize) -> Slot {
        let transform = self.frames[frame];
        let world_from_object = &transform.world_from_object;
        let similarity = if frame == 0 { Some(1.0) } else { transform.similarity_scale() };
        fn put<T>(list: &mut Vec<T>, form: Form, value: T) -> Slot {
            list.push(value);
            Slot::new(form, list.len() - 1)
        }
        match shape {
            Shape::Sphere(sphere) => {
                let in_world = similarity.and_then(|scale| {
                    Sphere::new(world_from_object.transform_point3(sphere.center()), sphere.radius() * scale)
                        .ok()
                });
                match in_world {
                    Some(sphere) => {
                        self.cull_ball(sphere.center(), sphere.radius());
                        put(&mut self.spheres, Form::Sphere, sphere)
                    }
                    None => {
                        self.cull_box(shape, world_from_object);
                        put(&mut self.framed_spheres, Form::FramedSphere, *sphere)
                    }
                }
            }
            Shape::Cuboid(cuboid) => {
                self.cull_box(shape, world_from_object);
                match axis_aligned(cuboid, &transform) {
                    Some(cuboid) => put(&mut self.cuboids, Form::Cuboid, cuboid),
                    None => put(&mut self.framed_cuboids, Form::FramedCuboid, *cuboid),
                }
            }
            Shape::Cylinder(cylinder) => match similarity {
                Some(scale) => {
                    let c = OrientedCylinder::from_object(cylinder, world_from_object, scale);
                    self.cull_bar(&Spine::along(c.base(), c.axis(), c.radius(), c.height()));
                    put(&mut self.cylinders, Form::Cylinder, c)
                }
                None => {
                    self.cull_framed_bar(shape, world_from_object, cylinder.center(), cylinder.radius());
                    put(&mut self.framed_cylinders, Form::FramedCylinder, *cylinder)
                }
            },
            Shape::Cone(cone) => match similarity {
                Some(scale) => {
                    let c = OrientedCone::from_object(cone, world_from_object, scale);
                    self.cull_bar(&Spine::along(c.base(), c.axis(), c.radius(), c.height()));
                    put(&mut self.cones, Form::Cone, c)
                }
                None => {
                    self.cull_framed_bar(shape, world_from_object, cone.center(), cone.radius());
                    put(&mut self.framed_cones, Form::FramedCone, *cone)
                }
            },
            Shape::Triangle(triangle) => {
                let corners = triangle.vertices().map(|v| world_from_object.transform_point3(v));
                if let Some(frame) = &self.cull_frame {
                    self.culls.put_triangle(frame, self.slots.len(), &corners);
                }
                put(&mut self.triangles, Form::Triangle, corners)
            }
        }
    }

    fn cull_ball(&mut self, center: Vec3, radius: f64) {
        if let Some(frame) = &self.cull_frame {
            self.culls.put_ball(frame, self.slots.len(), center, radius);
        }
    }

    fn cull_box(&mut self, shape: &Shape, world_from_object: &Affine) {
        if let Some(frame) = &self.cull_frame {
            self.culls.put_box(frame, self.slots.len(), &shape.world_bounds(world_from_object));
        }
    }

    fn cull_bar(&mut self, spine: &Spine) {
        if let Some(frame) = &self.cull_frame {
            self.culls.put_bar(frame, self.slots.len(), spine);
        }
    }

    /// A cylinder or cone that a general map has squeezed.
    fn cull_framed_bar(&mut self, shape: &Shape, world_from_object: &Affine, center: Vec3, radius: f64) {
        match Spine::new(world_from_object, &shape.world_bounds(world_from_object), center, radius) {
            Some(spine) => self.cull_bar(&spine),
            None => self.cull_box(shape, world_from_object),
        }
    }

    /// What rules shapes out in single precision; `None` where the accelerator does not ask for it.
    pub(crate) fn culls(&self) -> Option<&Culls> {
        self.cull_frame.as_ref().map(|_| &self.culls)
    }

    /// How many positions there are.
    pub fn len(&self) -> usize {
        self.slots.len()
    }

    /// Whether there is no shape.
    pub fn is_empty(&self) -> bool {
        self.slots.is_empty()
    }

    /// Whether any triangle is there (then rays carry a [`TriangleRay`]).
    pub fn has_triangles(&self) -> bool {
        !self.triangles.is_empty()
    }

    /// The shape's number in file order.
    #[inline]
    pub fn number(&self, position: u32) -> u32 {
        self.numbers[position as usize]
    }

    /// The shape's material.
    #[inline]
    pub fn material(&self, position: u32) -> u32 {
        self.materials[position as usize]
    }

    /// The run that the shape stands in.
    #[inline]
    pub fn run(&self, position: u32) -> &Run {
        &self.runs[self.runs_of.get(position as usize).map_or(0, |&run| run as usize)]
    }

    /// The transform of the shape's groups.
    #[inline]
    pub fn frame(&self, position: u32) -> &Transform {
        &self.frames[self.run(position).frame as usize]
    }

    /// A unit normal of the shape's object space in the world.
    #[inline]
    pub fn world_normal(&self, position: u32, normal_in_object: Vec3) -> Vec3 {
        match self.run(position).frame {
            0 => normal_in_object,
            frame => self.frames[frame as usize].world_normal(normal_in_object),
        }
    }

    /// The files as written.
    pub fn files(&self) -> &[SceneFile] {
        &self.files
    }

    /// All crossings of the ray's line with the shape at `position`. `triangle_ray` is the ray, prepared once.
    #[inline(always)]
    pub fn crossings(&self, position: u32, ray: &Ray, triangle_ray: &TriangleRay) -> Crossings {
        let slot = self.slots[position as usize];
        let index = slot.index();
        match slot.form() {
            Form::Sphere => self.spheres[index].crossings(ray),
            Form::Triangle => match triangle_ray.intersect(&self.triangles[index]) {
                Some(t) => Crossings::one(Hit { t, face: 0 }),
                None => Crossings::NONE,
            },
            Form::Cuboid => self.cuboids[index].crossings(ray),
            Form::Cylinder => self.cylinders[index].crossings(ray),
            Form::Cone => self.cones[index].crossings(ray),
            form @ (Form::FramedSphere | Form::FramedCuboid | Form::FramedCylinder | Form::FramedCone) => {
                self.framed_crossings(form, index, position, ray)
            }
        }
    }

    #[inline(never)]
    fn framed_crossings(&self, form: Form, index: usize, position: u32, ray: &Ray) -> Crossings {
        let ray_in_object = ray.transformed(&self.frame(position).object_from_world);
        match form {
            Form::FramedSphere => self.framed_spheres[index].crossings(&ray_in_object),
            Form::FramedCuboid => self.framed_cuboids[index].crossings(&ray_in_object),
            Form::FramedCylinder => self.framed_cylinders[index].crossings(&ray_in_object),
            Form::FramedCone => self.framed_cones[index].crossings(&ray_in_object),
            Form::Sphere | Form::Cuboid | Form::Cylinder | Form::Cone | Form::Triangle => Crossings::NONE,
        }
    }

    /// The surface where `ray` met the shape at `position`.
    pub fn surface(&self, position: u32, ray: &Ray, hit: Hit) -> WorldSurface {
        let run = self.run(position);
        let shape = self.in_object(position, run);
        let frame = &self.frames[run.frame as usize];
        if let Shape::Triangle(triangle) = &shape
            && run.frame != 0
        {
            return self.triangle_surface(position, triangle, frame, ray);
        }
        if run.frame == 0 {
            let in_object = shape.surface(ray, hit);
            let (point, geometric_normal) = (in_object.point, in_object.geometric_normal);
            return WorldSurface { point, geometric_normal, in_object };
        }
        let in_object = shape.surface(&ray.transformed(&frame.object_from_world), hit);
        WorldSurface {
            point: frame.world_from_object.transform_point3(in_object.point),
            geometric_normal: frame.world_normal(in_object.geometric_normal),
            in_object,
        }
    }

    /// The shape in object coordinates: as baked where the world is its object space, else as written.
    fn in_object(&self, position: u32, run: &Run) -> Shape {
        let slot = self.slots[position as usize];
        match slot.form() {
            Form::Sphere if run.frame == 0 => Shape::Sphere(self.spheres[slot.index()]),
            Form::Cuboid if run.frame == 0 => Shape::Cuboid(self.cuboids[slot.index()]),
            Form::Sphere
            | Form::Cuboid
            | Form::Cylinder
            | Form::Cone
            | Form::Triangle
            | Form::FramedSphere
            | Form::FramedCuboid
            | Form::FramedCylinder
            | Form::FramedCone => {
                let entry = (run.first + (self.number(position) - run.first_shape)) as usize;
                let shape = self.files[run.file.0 as usize].shape(run.kind, entry);
                shape.expect("a resolved run names shapes only")
            }
        }
    }

    /// Lets go of the lists as written that nobody asks for any more, once every shape has been pushed: all
    /// materials, and the spheres and boxes that stand in no group, whose baked form is the same.
    pub fn finish(&mut self) {
        self.culls.finish(self.slots.len());
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
            file.spheres.materials = Vec::new();
            file.cuboids.materials = Vec::new();
            file.cylinders.materials = Vec::new();
            file.cones.materials = Vec::new();
            file.triangles.materials = Vec::new();
            file.indexed_triangles.materials = Vec::new();
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
        let corners = &self.triangles[self.slots[position as usize].index()];
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
        let baked = bytes(&self.slots)
            + bytes(&self.numbers)
            + bytes(&self.materials)
            + bytes(&self.runs_of)
            + bytes(&self.runs)
            + bytes(&self.frames)
            + bytes(&self.spheres)
            + bytes(&self.cuboids)
            + bytes(&self.cylinders)
            + bytes(&self.cones)
            + bytes(&self.triangles)
            + bytes(&self.framed_spheres)
            + bytes(&self.framed_cuboids)
            + bytes(&self.framed_cylinders)
            + bytes(&self.framed_cones)
            + self.culls.memory();
        let written = self
            .files
            .iter()
            .map(|file| {
                bytes(&file.spheres.shapes)
                    + bytes(&file.cuboids.shapes)
                    + bytes(&file.cylinders.shapes)
                    + bytes(&file.cones.shapes)
                    + bytes(&file.triangles.shapes)
                    + bytes(&file.indexed_triangles.shapes)
                    + bytes(&file.vertices)
            })
            .sum();
        (baked, written)
    }
}
