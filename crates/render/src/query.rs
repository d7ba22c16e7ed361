//! The two questions that rays ask of the accelerator: what is nearest, and what lies between.

use crate::own::Ready;
use crate::shapes::Shapes;
use dotray_accel::Batch;
use dotray_accel::Queries;
use dotray_accel::narrow::NarrowRay;
use dotray_accel::packet::GROUPS;
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

/// What the nearest hits of many rays are found in; used again and again, lest every stream allocate.
#[derive(Debug, Default)]
pub struct NearestBuffers {
    triangle_rays: Vec<TriangleRay>,
    /// The answers.
    pub found: Vec<Option<Nearest>>,
    /// What each ray cost.
    pub tests: Vec<Tests>,
}

/// The nearest hits of many rays.
pub struct NearestBatch<'a> {
    shapes: &'a Shapes,
    queries: Queries<'a>,
    left: &'a [u32],
    buffers: &'a mut NearestBuffers,
}

/// Prepares each ray where there are triangles, else one that nobody looks at. (Tried and dropped: preparing it where a
/// triangle is tested. Meshes took 7 to 12 % longer.)
fn prepare(shapes: &Shapes, rays: &[Ray], prepared: &mut Vec<TriangleRay>) {
    let needed = if shapes.has_triangles() { usize::MAX } else { 1 };
    prepared.clear();
    prepared.extend(rays.iter().take(needed).map(TriangleRay::new));
}

/// Whether ray `i` has just left this shape for good.
#[inline(always)]
fn leaves(left: &[u32], i: usize, position: u32) -> bool {
    left.get(i) == Some(&position)
}

/// Fills a list anew.
fn refill<T: Clone>(list: &mut Vec<T>, len: usize, value: T) {
    list.clear();
    list.resize(len, value);
}

impl<'a> NearestBatch<'a> {
    /// The question for these rays.
    pub fn new(shapes: &'a Shapes, queries: Queries<'a>, buffers: &'a mut NearestBuffers) -> Self {
        prepare(shapes, queries.rays, &mut buffers.triangle_rays);
        refill(&mut buffers.found, queries.len(), None);
        refill(&mut buffers.tests, queries.len(), Tests::default());
        Self { shapes, queries, left: &[], buffers }
    }

    /// The same, for rays that each leave a shape which they cannot meet again (`leaving.rs`).
    pub fn leaving(self, left: &'a [u32]) -> Self {
        Self { left, ..self }
    }

    /// Tests one shape; answers with the new upper bound of t.
    #[inline(always)]
    fn test(&mut self, i: usize, position: u32, t_max: f64) -> f64 {
        self.test_ready(i, position, t_max, None)
    }

    /// The same for one that may have been made ready.
    #[inline(never)]
    fn test_ready(&mut self, i: usize, position: u32, t_max: f64, ready: Option<&Ready>) -> f64 {
        if leaves(self.left, i, position) {
            return t_max;
        }
        let buffers = &mut *self.buffers;
        buffers.tests[i].shapes += 1;
        let triangle_ray = &buffers.triangle_rays[if buffers.triangle_rays.len() == 1 { 0 } else { i }];
        let query = self.queries.query(i);
        let crossings = match ready {
            Some(ready) => ready.crossings(&query.ray),
            None => self.shapes.crossings(position, &query.ray, triangle_ray),
        };
        let Some(hit) = crossings.first_within(query.t_min, t_max) else { return t_max };
        let number = self.shapes.number(position);
        // An exact tie goes to the shape that stands first in the file.
        if buffers.found[i].is_none_or(|best| hit.t < best.hit.t || number < best.number) {
            buffers.found[i] = Some(Nearest { position, number, hit });
            return hit.t;
        }
        t_max
    }
}

impl Batch for NearestBatch<'_> {
    fn leaf_range(&mut self, i: usize, first: u32, count: u32, t_max: f64) -> f64 {
        (first..first + count).fold(t_max, |t_max, position| self.test(i, position, t_max))
    }

    fn leaf_list(&mut self, i: usize, positions: &[u32], t_max: f64) -> f64 {
        positions.iter().fold(t_max, |t_max, &position| self.test(i, position, t_max))
    }

    #[inline(always)]
    fn leaf_block<S: Simd>(
        &mut self,
        simd: S,
        narrow: &NarrowRay,
        i: usize,
        [first, count]: [u32; 2],
        t_max: f64,
    ) -> f64 {
        self.shapes.expect_tests(first, count);
        let left = block(simd, self.shapes, narrow, first, count);
        bits(left).fold(t_max, |t_max, lane| self.test(i, first + lane, t_max))
    }

    #[inline(always)]
    fn expect(&self, first: u32, count: u32) {
        self.shapes.expect(first, count);
    }

    #[inline(always)]
    fn leaf_packet<S: Simd>(
        &mut self,
        simd: S,
        packet: &mut Packet,
        active: u32,
        [first, count]: [u32; 2],
    ) -> bool {
        let mut changed = false;
        for (shape, position) in (first..first + count).enumerate() {
            let lanes = sweep(simd, self.shapes, [first, count, shape as u32], packet, active);
            let ready = ready(self.shapes, position, &lanes, active);
            for group in bits(active).map(|group| group as usize) {
                for lane in bits(u32::from(lanes[group])).map(|lane| lane as usize) {
                    let (ray, t_max) = (packet.group(group).rays[lane], packet.group(group).t_max[lane]);
                    let answer = self.test_ready(ray as usize, position, t_max, ready.as_ref());
                    if answer < t_max {
                        packet.set_t_max(group, lane, answer);
                        changed = true;
                    }
                }
            }
        }
        changed
    }

    fn finished(&mut self, i: usize, box_tests: u64) {
        self.buffers.tests[i].boxes += box_tests;
    }
}

/// The places of the bits that are set.
fn bits(mut set: u32) -> impl Iterator<Item = u32> {
    std::iter::from_fn(move || {
        let place = (set != 0).then(|| set.trailing_zeros());
        set &= set.wrapping_sub(1);
        place
    })
}

/// Which shapes of a leaf the ray may hit, bit by bit.
#[inline(always)]
fn block<S: Simd>(simd: S, shapes: &Shapes, narrow: &NarrowRay, first: u32, count: u32) -> u32 {
    match shapes.culls() {
        Some(culls) => culls.block(simd, narrow, first, count),
        None => (1 << count) - 1,
    }
}

/// Which lanes of the active groups may hit a shape of a leaf: the leaf's first position and count, and which shape of
/// it.
#[inline(always)]
fn sweep<S: Simd>(simd: S, shapes: &Shapes, shape: [u32; 3], packet: &Packet, active: u32) -> [u16; GROUPS] {
    match shapes.culls() {
        Some(culls) => culls.sweep(simd, shape, packet, active),
        None => [u16::MAX; GROUPS],
    }
}

/// The shape made ready, where any ray of a packet may hit it and that spares work.
#[inline(always)]
fn ready(shapes: &Shapes, position: u32, lanes: &[u16; GROUPS], active: u32) -> Option<Ready> {
    bits(active).any(|group| lanes[group as usize % GROUPS] != 0).then(|| shapes.ready(position)).flatten()
}

/// A see-through surface that a shadow ray crosses.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Crossing {
    /// The shadow ray's place in its stream.
    pub ray: u32,
    /// Where.
    pub hit: Hit,
    /// The shape's number in file order.
    pub number: u32,
    /// The shape's position.
    pub position: u32,
}

/// The blocker of a ray that nothing opaque blocks.
pub const UNBLOCKED: u32 = u32::MAX;

/// What lies between points and a light; used again and again, lest every stream allocate.
#[derive(Debug, Default)]
pub struct ShadowBuffers {
    triangle_rays: Vec<TriangleRay>,
    /// The position of an opaque shape that blocks each ray (which one of several depends on the accelerator), or
    /// [`UNBLOCKED`].
    pub blockers: Vec<u32>,
    /// The see-through surfaces that rays cross, each once, ray by ray and nearest first; of blocked rays perhaps
    /// not all.
    pub crossings: Vec<Crossing>,
    /// What each ray cost.
    pub tests: Vec<Tests>,
}

/// The occlusion of many shadow rays.
///
/// Tried and dropped: showing each packet first the leaf that blocked a ray last. Pictures took from 3 % less to 5 %
/// more.
pub struct ShadowBatch<'a> {
    shapes: &'a Shapes,
    queries: Queries<'a>,
    left: &'a [u32],
    see_through: &'a dyn Fn(u32) -> bool,
    buffers: &'a mut ShadowBuffers,
}

impl<'a> ShadowBatch<'a> {
    /// The question for these rays; `see_through` says of a material whether light passes.
    pub fn new(
        shapes: &'a Shapes,
        queries: Queries<'a>,
        see_through: &'a dyn Fn(u32) -> bool,
        buffers: &'a mut ShadowBuffers,
    ) -> Self {
        prepare(shapes, queries.rays, &mut buffers.triangle_rays);
        refill(&mut buffers.blockers, queries.len(), UNBLOCKED);
        buffers.crossings.clear();
        refill(&mut buffers.tests, queries.len(), Tests::default());
        Self { shapes, queries, left: &[], see_through, buffers }
    }

    /// The same, for rays that each leave a shape which they cannot meet again (`leaving.rs`).
    pub fn leaving(self, left: &'a [u32]) -> Self {
        Self { left, ..self }
    }

    /// Brings the crossings into an order that does not depend on the accelerator, each once: octree and BSP show
    /// a shape as often as they cut it.
    pub fn finish(&mut self) {
        let crossings = &mut self.buffers.crossings;
        crossings.sort_by(|a, b| {
            let by_ray = a.ray.cmp(&b.ray).then(a.hit.t.total_cmp(&b.hit.t));
            by_ray.then(a.number.cmp(&b.number)).then(a.hit.face.cmp(&b.hit.face))
        });
        crossings.dedup();
    }

    /// Tests one shape; answers whether it blocks the ray.
    #[inline(always)]
    fn blocks(&mut self, i: usize, position: u32) -> bool {
        self.blocks_ready(i, position, None)
    }

    /// The same for one that may have been made ready.
    #[inline(never)]
    fn blocks_ready(&mut self, i: usize, position: u32, ready: Option<&Ready>) -> bool {
        if leaves(self.left, i, position) {
            return false;
        }
        let buffers = &mut *self.buffers;
        buffers.tests[i].shapes += 1;
        let query = self.queries.query(i);
        let triangle_ray = &buffers.triangle_rays[if buffers.triangle_rays.len() == 1 { 0 } else { i }];
        let crossings = match ready {
            Some(ready) => ready.crossings(&query.ray),
            None => self.shapes.crossings(position, &query.ray, triangle_ray),
        };
        for &hit in crossings.as_slice() {
            if !(query.t_min < hit.t && hit.t < query.t_max) {
                continue;
            }
            if !(self.see_through)(self.shapes.material(position)) {
                buffers.blockers[i] = position;
                return true;
            }
            let number = self.shapes.number(position);
            buffers.crossings.push(Crossing { ray: i as u32, hit, number, position });
        }
        false
    }
}

impl Batch for ShadowBatch<'_> {
    fn leaf_range(&mut self, i: usize, first: u32, count: u32, t_max: f64) -> f64 {
        let blocked = (first..first + count).any(|position| self.blocks(i, position));
        if blocked { f64::NEG_INFINITY } else { t_max }
    }

    fn leaf_list(&mut self, i: usize, positions: &[u32], t_max: f64) -> f64 {
        let blocked = positions.iter().any(|&position| self.blocks(i, position));
        if blocked { f64::NEG_INFINITY } else { t_max }
    }

    #[inline(always)]
    fn leaf_block<S: Simd>(
        &mut self,
        simd: S,
        narrow: &NarrowRay,
        i: usize,
        [first, count]: [u32; 2],
        t_max: f64,
    ) -> f64 {
        self.shapes.expect_tests(first, count);
        let left = block(simd, self.shapes, narrow, first, count);
        let blocked = bits(left).any(|lane| self.blocks(i, first + lane));
        if blocked { f64::NEG_INFINITY } else { t_max }
    }

    #[inline(always)]
    fn expect(&self, first: u32, count: u32) {
        self.shapes.expect(first, count);
    }

    #[inline(always)]
    fn leaf_packet<S: Simd>(
        &mut self,
        simd: S,
        packet: &mut Packet,
        active: u32,
        [first, count]: [u32; 2],
    ) -> bool {
        let mut changed = false;
        for (shape, position) in (first..first + count).enumerate() {
            let lanes = sweep(simd, self.shapes, [first, count, shape as u32], packet, active);
            let ready = ready(self.shapes, position, &lanes, active);
            for group in bits(active).map(|group| group as usize) {
                for lane in bits(u32::from(lanes[group])).map(|lane| lane as usize) {
                    let ray = packet.group(group).rays[lane] as usize;
                    if self.blocks_ready(ray, position, ready.as_ref()) {
                        packet.set_t_max(group, lane, f64::NEG_INFINITY);
                        changed = true;
                    }
                }
            }
        }
        changed
    }

    fn finished(&mut self, i: usize, box_tests: u64) {
        self.buffers.tests[i].boxes += box_tests;
    }
}
