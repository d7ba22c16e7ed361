//! The two questions that rays ask of the accelerator: what is nearest, and what lies between.

use crate::shapes::Shapes;
use dotray_accel::Batch;
use dotray_accel::Query;
use dotray_accel::simd::Simd;
use dotray_geometry::Hit;
use dotray_geometry::Ray;
use dotray_geometry::shape::TriangleRay;

/// What a ray met first.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Nearest {
    /// The shape's position.
    pub position: u32,
    /// Its number in file order, which decides ties.
    pub number: u32,
    /// Where.
    pub hit: Hit,
}

/// Tests that rays cost.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Tests {
    /// Boxes or cells.
    pub boxes: u64,
    /// Shapes.
    pub shapes: u64,
}

/// The nearest hits of many rays.
pub struct NearestBatch<'a> {
    shapes: &'a Shapes,
    rays: &'a [Ray],
    triangle_rays: Vec<TriangleRay>,
    t_min: f64,
    /// The answers.
    pub found: Vec<Option<Nearest>>,
    /// What each ray cost.
    pub tests: Vec<Tests>,
}

/// One prepared ray for each ray where there are triangles, else one that nobody looks at.
fn prepare<'a>(shapes: &Shapes, rays: impl Iterator<Item = &'a Ray>) -> Vec<TriangleRay> {
    let needed = if shapes.has_triangles() { usize::MAX } else { 1 };
    rays.take(needed).map(TriangleRay::new).collect()
}

impl<'a> NearestBatch<'a> {
    /// The question for `rays`, from `t_min` on.
    pub fn new(shapes: &'a Shapes, rays: &'a [Ray], t_min: f64) -> Self {
        Self {
            shapes,
            rays,
            triangle_rays: prepare(shapes, rays.iter()),
            t_min,
            found: vec![None; rays.len()],
            tests: vec![Tests::default(); rays.len()],
        }
    }

    #[inline(always)]
    fn test(&mut self, i: usize, positions: impl Iterator<Item = u32>, mut t_max: f64) -> f64 {
        let ray = &self.rays[i];
        let triangle_ray = &self.triangle_rays[if self.triangle_rays.len() == 1 { 0 } else { i }];
        for position in positions {
            self.tests[i].shapes += 1;
            let crossings = self.shapes.crossings(position, ray, triangle_ray);
            let Some(hit) = crossings.first_within(self.t_min, t_max) else { continue };
            let number = self.shapes.number(position);
            // An exact tie goes to the shape that stands first in the file.
            if self.found[i].is_none_or(|best| hit.t < best.hit.t || number < best.number) {
                self.found[i] = Some(Nearest { position, number, hit });
                t_max = hit.t;
            }
        }
        t_max
    }
}

impl Batch for NearestBatch<'_> {
    fn len(&self) -> usize {
        self.rays.len()
    }

    fn query(&self, i: usize) -> Query {
        Query { ray: self.rays[i], t_min: self.t_min, t_max: f64::INFINITY }
    }

    #[inline(always)]
    fn leaf_range<S: Simd>(&mut self, _simd: S, i: usize, first: u32, count: u32, t_max: f64) -> f64 {
        self.test(i, first..first + count, t_max)
    }

    #[inline(always)]
    fn leaf_list<S: Simd>(&mut self, _simd: S, i: usize, positions: &[u32], t_max: f64) -> f64 {
        self.test(i, positions.iter().copied(), t_max)
    }

    fn finished(&mut self, i: usize, box_tests: u64) {
        self.tests[i].boxes += box_tests;
    }
}

/// A ray to a light, and how far it reaches.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ShadowRay {
    /// From the surface towards the light.
    pub ray: Ray,
    /// Hits count below this t.
    pub t_end: f64,
}

/// A see-through surface that a shadow ray crosses.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Crossing {
    /// Where.
    pub hit: Hit,
    /// The shape's number in file order.
    pub number: u32,
    /// The shape's position.
    pub position: u32,
}

/// What lies between points and a light.
#[derive(Clone, Debug, PartialEq)]
pub enum Between {
    /// An opaque surface: the position of one of those (which one depends on the accelerator).
    Blocked(u32),
    /// Only see-through surfaces: each crossing once, nearest first.
    Crossed(Vec<Crossing>),
}

/// The occlusion of many shadow rays.
pub struct ShadowBatch<'a, F> {
    shapes: &'a Shapes,
    rays: &'a [ShadowRay],
    triangle_rays: Vec<TriangleRay>,
    t_min: f64,
    see_through: F,
    /// The answers; complete after [`ShadowBatch::finish`].
    pub found: Vec<Between>,
    /// What each ray cost.
    pub tests: Vec<Tests>,
}

impl<'a, F: Fn(u32) -> bool> ShadowBatch<'a, F> {
    /// The question for `rays`, from `t_min` on; `see_through` says of a material whether light passes.
    pub fn new(shapes: &'a Shapes, rays: &'a [ShadowRay], t_min: f64, see_through: F) -> Self {
        Self {
            shapes,
            rays,
            triangle_rays: prepare(shapes, rays.iter().map(|shadow| &shadow.ray)),
            t_min,
            see_through,
            found: vec![Between::Crossed(Vec::new()); rays.len()],
            tests: vec![Tests::default(); rays.len()],
        }
    }

    /// Brings the crossings into an order that does not depend on the accelerator, each once: octree and BSP show
    /// a shape as often as they cut it.
    pub fn finish(&mut self) {
        for found in &mut self.found {
            if let Between::Crossed(crossings) = found {
                crossings.sort_by(|a, b| {
                    a.hit.t.total_cmp(&b.hit.t).then(a.number.cmp(&b.number)).then(a.hit.face.cmp(&b.hit.face))
                });
                crossings.dedup();
            }
        }
    }

    #[inline(always)]
    fn test(&mut self, i: usize, positions: impl Iterator<Item = u32>, t_max: f64) -> f64 {
        let shadow = &self.rays[i];
        let triangle_ray = &self.triangle_rays[if self.triangle_rays.len() == 1 { 0 } else { i }];
        for position in positions {
            self.tests[i].shapes += 1;
            let crossings = self.shapes.crossings(position, &shadow.ray, triangle_ray);
            for &hit in crossings.as_slice() {
                if !(self.t_min < hit.t && hit.t < shadow.t_end) {
                    continue;
                }
                if !(self.see_through)(self.shapes.material(position)) {
                    self.found[i] = Between::Blocked(position);
                    return f64::NEG_INFINITY;
                }
                if let Between::Crossed(list) = &mut self.found[i] {
                    list.push(Crossing { hit, number: self.shapes.number(position), position });
                }
            }
        }
        t_max
    }
}

impl<F: Fn(u32) -> bool> Batch for ShadowBatch<'_, F> {
    fn len(&self) -> usize {
        self.rays.len()
    }

    fn query(&self, i: usize) -> Query {
        Query { ray: self.rays[i].ray, t_min: self.t_min, t_max: self.rays[i].t_end }
    }

    #[inline(always)]
    fn leaf_range<S: Simd>(&mut self, _simd: S, i: usize, first: u32, count: u32, t_max: f64) -> f64 {
        self.test(i, first..first + count, t_max)
    }

    #[inline(always)]
    fn leaf_list<S: Simd>(&mut self, _simd: S, i: usize, positions: &[u32], t_max: f64) -> f64 {
        self.test(i, positions.iter().copied(), t_max)
    }

    fn finished(&mut self, i: usize, box_tests: u64) {
        self.tests[i].boxes += box_tests;
    }
}
