//! Rays against a scene: the one place where the bench meets dotray's tracing.
//!
//! This stands on [`dotray_accel::Accelerator`] and the shapes of `dotray-geometry`, each in its cheapest form, as the
//! renderer bakes them.

use dotray_accel::Accelerator;
use dotray_accel::Batch;
use dotray_accel::Boxes;
use dotray_accel::Kind;
use dotray_accel::Query;
use dotray_accel::Settings;
use dotray_accel::simd::Simd;
use dotray_accel::simd::level;
use dotray_accel::simd::level_name;
use dotray_geometry::Aabb;
use dotray_geometry::Crossings;
use dotray_geometry::Hit;
use dotray_geometry::OrientedCone;
use dotray_geometry::OrientedCylinder;
use dotray_geometry::Ray;
use dotray_geometry::Shape;
use dotray_geometry::Sphere;
use dotray_geometry::Transform;
use dotray_geometry::TriangleRay;
use dotray_geometry::Vec3;
use dotray_scene::Resolved;

/// A shape as rays meet it.
#[derive(Clone, Copy)]
enum Baked {
    Sphere(Sphere),
    Cylinder(OrientedCylinder),
    Cone(OrientedCone),
    Triangle([Vec3; 3]),
    /// Anything else, by its number in a list of its own.
    Framed(u32),
}

/// A shape in its own coordinates.
#[derive(Clone, Copy)]
struct Framed {
    shape: Shape,
    transform: Transform,
}

/// A scene that answers rays.
pub struct Caster {
    accelerator: Accelerator,
    baked: Vec<Baked>,
    framed: Vec<Framed>,
    triangles: bool,
}

/// A hit: where, and on which shape.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Found {
    hit: Hit,
    position: u32,
}

impl Found {
    /// The ray's parameter.
    pub fn t(&self) -> f64 {
        self.hit.t
    }
}

struct Items<'a>(&'a [Baked], &'a [Framed]);

impl Boxes for Items<'_> {
    fn len(&self) -> u32 {
        self.0.len() as u32
    }

    fn bounds(&self, item: u32) -> Aabb {
        // Rods are padded by their radius all around: looser than need be, which the renderer's own boxes are not.
        let rod = |base: Vec3, top: Vec3, radius: f64| {
            let radius = Vec3::splat(radius * (1.0 + 1e-12));
            Aabb::new(base.min(top) - radius, base.max(top) + radius)
        };
        match &self.0[item as usize] {
            Baked::Sphere(sphere) => sphere.bounds(),
            Baked::Cylinder(c) => rod(c.base(), c.base() + c.axis() * c.height(), c.radius()),
            Baked::Cone(c) => rod(c.base(), c.base() + c.axis() * c.height(), c.radius()),
            Baked::Triangle(corners) => Aabb::around(*corners),
            Baked::Framed(number) => {
                let Framed { shape, transform } = &self.1[*number as usize];
                shape.world_bounds(&transform.world_from_object)
            }
        }
    }
}

fn bake(shape: &Shape, frame: u32, transform: &Transform) -> Option<Baked> {
    let world_from_object = &transform.world_from_object;
    let scale = if frame == 0 { Some(1.0) } else { transform.similarity_scale() };
    match (shape, scale) {
        (Shape::Sphere(sphere), Some(scale)) => {
            let center = world_from_object.transform_point3(sphere.center());
            Sphere::new(center, sphere.radius() * scale).ok().map(Baked::Sphere)
        }
        (Shape::Cylinder(cylinder), Some(scale)) => {
            Some(Baked::Cylinder(OrientedCylinder::from_object(cylinder, world_from_object, scale)))
        }
        (Shape::Cone(cone), Some(scale)) => {
            Some(Baked::Cone(OrientedCone::from_object(cone, world_from_object, scale)))
        }
        (Shape::Triangle(triangle), _) => {
            Some(Baked::Triangle(triangle.vertices().map(|v| world_from_object.transform_point3(v))))
        }
        (Shape::Sphere(_) | Shape::Cylinder(_) | Shape::Cone(_) | Shape::Cuboid(_), _) => None,
    }
}

impl Caster {
    /// Everything before the tree: the scene's shapes as rays meet them.
    pub fn bake(resolved: &Resolved) -> Unbuilt {
        let mut baked = Vec::with_capacity(resolved.shape_count as usize);
        let mut framed = Vec::new();
        for run in &resolved.runs {
            let transform = &resolved.frames[run.frame as usize];
            for shape in resolved.files[run.file.0 as usize].shapes(run.kind, run.first, run.count) {
                let in_world = bake(&shape, run.frame, transform);
                baked.push(in_world.unwrap_or_else(|| {
                    framed.push(Framed { shape, transform: *transform });
                    Baked::Framed(framed.len() as u32 - 1)
                }));
            }
        }
        Unbuilt { baked, framed }
    }

    /// The instructions that the kernels use.
    pub fn simd() -> &'static str {
        level_name(level())
    }

    /// How many shapes there are.
    pub fn shapes(&self) -> usize {
        self.baked.len()
    }

    /// The bytes of tree and shapes.
    pub fn memory(&self) -> usize {
        self.accelerator.memory() + size_of_val(&self.baked[..]) + size_of_val(&self.framed[..])
    }

    /// Finds the nearest hit of each ray.
    pub fn nearest(&self, queries: &[Query], found: &mut Vec<Option<Found>>) {
        found.clear();
        found.resize(queries.len(), None);
        self.walk(queries, false, found);
    }

    /// Finds any hit of each ray.
    pub fn occluded(&self, queries: &[Query], found: &mut Vec<Option<Found>>) {
        found.clear();
        found.resize(queries.len(), None);
        self.walk(queries, true, found);
    }

    fn walk(&self, queries: &[Query], any: bool, found: &mut [Option<Found>]) {
        let needed = if self.triangles { usize::MAX } else { 1 };
        let triangle_rays = queries.iter().take(needed).map(|query| TriangleRay::new(&query.ray)).collect();
        self.accelerator.walk(level(), &mut Rays { caster: self, queries, triangle_rays, any, found });
    }

    #[inline(always)]
    fn crossings(&self, position: u32, ray: &Ray, triangle_ray: &TriangleRay) -> Crossings {
        match &self.baked[position as usize] {
            Baked::Sphere(sphere) => sphere.crossings(ray),
            Baked::Cylinder(cylinder) => cylinder.crossings(ray),
            Baked::Cone(cone) => cone.crossings(ray),
            Baked::Triangle(corners) => triangle_ray
                .intersect(corners)
                .map_or(Crossings::NONE, |t| Crossings::one(Hit { t, face: 0 })),
            Baked::Framed(number) => {
                let Framed { shape, transform } = &self.framed[*number as usize];
                shape.crossings(&ray.transformed(&transform.object_from_world))
            }
        }
    }

    /// The outward unit normal where a ray was found to hit.
    pub fn normal(&self, ray: &Ray, found: &Found) -> Vec3 {
        match &self.baked[found.position as usize] {
            Baked::Sphere(sphere) => sphere.surface(ray, found.hit).geometric_normal,
            Baked::Cylinder(cylinder) => cylinder.normal(ray, found.hit),
            Baked::Cone(cone) => cone.normal(ray, found.hit),
            Baked::Triangle([a, b, c]) => (*b - *a).cross(*c - *a).normalize_or(Vec3::Y),
            Baked::Framed(number) => {
                let Framed { shape, transform } = &self.framed[*number as usize];
                let in_object = shape.surface(&ray.transformed(&transform.object_from_world), found.hit);
                transform.world_normal(in_object.geometric_normal)
            }
        }
    }
}

/// Shapes without a tree.
pub struct Unbuilt {
    baked: Vec<Baked>,
    framed: Vec<Framed>,
}

impl Unbuilt {
    /// Builds the tree and puts the shapes in its order, on the threads of the pool it is called in.
    pub fn build(self) -> Caster {
        let Self { baked, framed } = self;
        let built = Accelerator::build(Kind::Bvh, &Items(&baked, &framed), &[], &Settings::default());
        let baked = match &built.order {
            Some(order) => order.iter().map(|&item| baked[item as usize]).collect(),
            None => baked,
        };
        let triangles = baked.iter().any(|shape| matches!(shape, Baked::Triangle(_)));
        Caster { accelerator: built.accelerator, baked, framed, triangles }
    }
}

/// The rays of one call, as the tree sees them.
struct Rays<'a> {
    caster: &'a Caster,
    queries: &'a [Query],
    triangle_rays: Vec<TriangleRay>,
    any: bool,
    found: &'a mut [Option<Found>],
}

impl Rays<'_> {
    #[inline(always)]
    fn test(&mut self, i: usize, positions: impl Iterator<Item = u32>, mut t_max: f64) -> f64 {
        let query = &self.queries[i];
        let triangle_ray = &self.triangle_rays[if self.triangle_rays.len() == 1 { 0 } else { i }];
        for position in positions {
            let crossings = self.caster.crossings(position, &query.ray, triangle_ray);
            if let Some(hit) = crossings.first_within(query.t_min, t_max) {
                self.found[i] = Some(Found { hit, position });
                if self.any {
                    return f64::NEG_INFINITY;
                }
                t_max = hit.t;
            }
        }
        t_max
    }
}

impl Batch for Rays<'_> {
    fn len(&self) -> usize {
        self.queries.len()
    }

    #[inline(always)]
    fn query(&self, i: usize) -> Query {
        self.queries[i]
    }

    #[inline(always)]
    fn leaf_range<S: Simd>(&mut self, _simd: S, i: usize, first: u32, count: u32, t_max: f64) -> f64 {
        self.test(i, first..first + count, t_max)
    }

    #[inline(always)]
    fn leaf_list<S: Simd>(&mut self, _simd: S, i: usize, positions: &[u32], t_max: f64) -> f64 {
        self.test(i, positions.iter().copied(), t_max)
    }

    fn finished(&mut self, _i: usize, _box_tests: u64) {}
}
