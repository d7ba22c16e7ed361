//! The two questions that rays ask of the accelerator: what is nearest, and what lies between.

use crate::shapes::Shapes;
use dotray_accel::Batch;
use dotray_accel::Query;
use dotray_accel::packet::Packet;
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

    /// Tests one shape; answers with the new upper bound of t. Not inlined: a copy in every kernel of every SIMD
    /// level would double the time that this crate takes to build.
    #[inline(never)]
    fn test(&mut self, i: usize, position: u32, t_max: f64) -> f64 {
        self.tests[i].shapes += 1;
        let triangle_ray = &self.triangle_rays[if self.triangle_rays.len() == 1 { 0 } else { i }];
        let crossings = self.shapes.crossings(position, &self.rays[i], triangle_ray);
        let Some(hit) = crossings.first_within(self.t_min, t_max) else { return t_max };
        let number = self.shapes.number(position);
        // An exact tie goes to the shape that stands first in the file.
        if self.found[i].is_none_or(|best| hit.t < best.hit.t || number < best.number) {
            self.found[i] = Some(Nearest { position, number, hit });
            return hit.t;
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
        (first..first + count).fold(t_max, |t_max, position| self.test(i, position, t_max))
    }

    #[inline(always)]
    fn leaf_list<S: Simd>(&mut self, _simd: S, i: usize, positions: &[u32], t_max: f64) -> f64 {
        positions.iter().fold(t_max, |t_max, &position| self.test(i, position, t_max))
    }

    #[inline(always)]
    fn leaf_packet<S: Simd>(
        &mut self,
        simd: S,
        packet: &mut Packet,
        active: u32,
        first: u32,
        count: u32,
    ) -> bool {
        let shapes = self.shapes;
        let mut changed = false;
        for position in first..first + count {
            shapes.sweep(simd, position, packet, active, |packet, group, lane| {
                let (ray, t_max) = (packet.group(group).rays[lane], packet.group(group).t_max[lane]);
                let answer = self.test(ray as usize, position, t_max);
                if answer < t_max {
                    packet.set_t_max(group, lane, answer);
                    changed = true;
                }
            });
        }
        changed
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
                    a.hit
                        .t
                        .total_cmp(&b.hit.t)
                        .then(a.number.cmp(&b.number))
                        .then(a.hit.face.cmp(&b.hit.face))
                });
                crossings.dedup();
            }
        }
    }

    /// Tests one shape; answers whether it blocks the ray.
    #[inline(never)]
    fn blocks(&mut self, i: usize, position: u32) -> bool {
        self.tests[i].shapes += 1;
        let shadow = &self.rays[i];
        let triangle_ray = &self.triangle_rays[if self.triangle_rays.len() == 1 { 0 } else { i }];
        let crossings = self.shapes.crossings(position, &shadow.ray, triangle_ray);
        for &hit in crossings.as_slice() {
            if !(self.t_min < hit.t && hit.t < shadow.t_end) {
                continue;
            }
            if !(self.see_through)(self.shapes.material(position)) {
                self.found[i] = Between::Blocked(position);
                return true;
            }
            if let Between::Crossed(list) = &mut self.found[i] {
                list.push(Crossing { hit, number: self.shapes.number(position), position });
            }
        }
        false
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
        let blocked = (first..first + count).any(|position| self.blocks(i, position));
        if blocked { f64::NEG_INFINITY } else { t_max }
    }

    #[inline(always)]
    fn leaf_list<S: Simd>(&mut self, _simd: S, i: usize, positions: &[u32], t_max: f64) -> f64 {
        let blocked = positions.iter().any(|&position| self.blocks(i, position));
        if blocked { f64::NEG_INFINITY } else { t_max }
    }

    #[inline(always)]
    fn leaf_packet<S: Simd>(
        &mut self,
        simd: S,
        packet: &mut Packet,
        active: u32,
        first: u32,
        count: u32,
    ) -> bool {
        let shapes = self.shapes;
        let mut changed = false;
        for position in first..first + count {
            shapes.sweep(simd, position, packet, active, |packet, group, lane| {
                if self.blocks(packet.group(group).rays[lane] as usize, position) {
                    packet.set_t_max(group, lane, f64::NEG_INFINITY);
                    changed = true;
                }
            });
        }
        changed
    }

    fn finished(&mut self, i: usize, box_tests: u64) {
        self.tests[i].boxes += box_tests;
    }
}
