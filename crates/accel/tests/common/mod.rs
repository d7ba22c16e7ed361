//! Spheres, rays and a batch that tests them in double precision, for the tests of this crate.
#![allow(dead_code, reason = "each test file uses its own part")]

use dotray_accel::{Accelerator, Batch, Boxes, Built, GroupEvent, Kind, Level, Queries, Query, Settings};
use dotray_geometry::{Aabb, Ray, Vec3};

/// Numbers that are the same on every machine.
pub struct Random(u64);

impl Random {
    pub fn new(seed: u64) -> Self {
        Self(seed.wrapping_mul(0x9E37_79B9_7F4A_7C15) | 1)
    }

    pub fn bits(&mut self) -> u64 {
        self.0 ^= self.0 << 13;
        self.0 ^= self.0 >> 7;
        self.0 ^= self.0 << 17;
        self.0.wrapping_mul(0x2545_F491_4F6C_DD1D)
    }

    /// From 0 to below 1.
    pub fn unit(&mut self) -> f64 {
        (self.bits() >> 11) as f64 / (1_u64 << 53) as f64
    }

    pub fn between(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * self.unit()
    }

    pub fn below(&mut self, count: u64) -> u64 {
        self.bits() % count
    }

    pub fn point(&mut self) -> Vec3 {
        Vec3::new(self.unit(), self.unit(), self.unit())
    }

    pub fn direction(&mut self) -> Vec3 {
        loop {
            let point = self.point() * 2.0 - 1.0;
            if (0.01..1.0).contains(&point.length_squared()) {
                return point.normalize();
            }
        }
    }
}

/// Something with a box that a ray may hit.
pub trait Item: Sync + Copy {
    fn bounds(&self) -> Aabb;
    fn hit(&self, ray: &Ray, t_min: f64, t_max: f64) -> Option<f64>;
}

#[derive(Clone, Copy, Debug)]
pub struct Sphere {
    pub center: Vec3,
    pub radius: f64,
}

impl Item for Sphere {
    fn bounds(&self) -> Aabb {
        Aabb::new(self.center - self.radius, self.center + self.radius)
    }

    fn hit(&self, ray: &Ray, t_min: f64, t_max: f64) -> Option<f64> {
        // From the foot of the perpendicular, so that a far origin does not cancel the radius out.
        let to_center = self.center - ray.origin;
        let middle = to_center.dot(ray.direction);
        let across = to_center - ray.direction * middle;
        let square = self.radius * self.radius - across.length_squared();
        if square < 0.0 {
            return None;
        }
        let half = square.sqrt();
        [middle - half, middle + half].into_iter().find(|&t| t >= t_min && t <= t_max)
    }
}

/// A box as an item; the slab test of a double-precision ray.
impl Item for Aabb {
    fn bounds(&self) -> Aabb {
        *self
    }

    fn hit(&self, ray: &Ray, t_min: f64, t_max: f64) -> Option<f64> {
        let (mut enter, mut leave) = (t_min, t_max);
        for axis in 0..3 {
            let (origin, direction) = (ray.origin[axis], ray.direction[axis]);
            if direction == 0.0 {
                if origin < self.min[axis] || origin > self.max[axis] {
                    return None;
                }
            } else {
                let (a, b) = ((self.min[axis] - origin) / direction, (self.max[axis] - origin) / direction);
                enter = enter.max(a.min(b));
                leave = leave.min(a.max(b));
            }
        }
        (enter <= leave).then_some(enter)
    }
}

/// A scene of items.
pub struct Scene<I>(pub Vec<I>);

impl<I: Item> Boxes for Scene<I> {
    fn len(&self) -> u32 {
        self.0.len() as u32
    }

    fn bounds(&self, item: u32) -> Aabb {
        self.0[item as usize].bounds()
    }
}

/// The nearest hit: its t, bit by bit, and the item; ties go to the lower number.
pub type Hit = Option<(u64, u32)>;

/// What rays meet, and how often the walk called back.
pub struct Rays<'a, I> {
    pub scene: &'a Scene<I>,
    pub order: Option<&'a [u32]>,
    pub queries: &'a [Query],
    pub any: bool,
    pub best: Vec<(f64, u32)>,
    pub item_tests: u64,
    pub box_tests: u64,
    pub finished: usize,
}

impl<'a, I: Item> Rays<'a, I> {
    pub fn new(scene: &'a Scene<I>, order: Option<&'a [u32]>, queries: &'a [Query], any: bool) -> Self {
        let best = vec![(f64::INFINITY, u32::MAX); queries.len()];
        Self { scene, order, queries, any, best, item_tests: 0, box_tests: 0, finished: 0 }
    }

    #[inline(always)]
    fn test(&mut self, i: usize, position: u32, t_max: f64) -> f64 {
        let item = self.order.map_or(position, |order| order[position as usize]);
        let query = &self.queries[i];
        self.item_tests += 1;
        if let Some(t) = self.scene.0[item as usize].hit(&query.ray, query.t_min, query.t_max) {
            let best = &mut self.best[i];
            if t < best.0 || (t == best.0 && item < best.1) {
                *best = (t, item);
            }
            return if self.any { f64::NEG_INFINITY } else { t_max.min(best.0) };
        }
        t_max
    }

    pub fn hits(&self) -> Vec<Hit> {
        self.best.iter().map(|&(t, item)| (item != u32::MAX).then_some((t.to_bits(), item))).collect()
    }
}

impl<I: Item> Batch for Rays<'_, I> {
    fn leaf_range(&mut self, i: usize, first: u32, count: u32, mut t_max: f64) -> f64 {
        for position in first..first + count {
            t_max = self.test(i, position, t_max);
            if t_max == f64::NEG_INFINITY {
                break;
            }
        }
        t_max
    }

    fn leaf_list(&mut self, i: usize, positions: &[u32], mut t_max: f64) -> f64 {
        for &position in positions {
            t_max = self.test(i, position, t_max);
            if t_max == f64::NEG_INFINITY {
                break;
            }
        }
        t_max
    }

    fn finished(&mut self, i: usize, box_tests: u64) {
        assert!(i < self.queries.len());
        self.finished += 1;
        self.box_tests += box_tests;
    }
}

pub fn query(origin: Vec3, direction: Vec3) -> Query {
    Query { ray: Ray::new(origin, direction.normalize()), t_min: 0.0, t_max: f64::INFINITY }
}

pub fn build<I: Item>(kind: Kind, scene: &Scene<I>, groups: &[GroupEvent]) -> Built {
    let built = Accelerator::build(kind, scene, groups, &Settings::default());
    if let Err(defect) = built.accelerator.validate(scene, built.order.as_deref()) {
        panic!("{}: {defect}", kind.name());
    }
    built
}

/// Walks the rays of a batch, one by one or together.
pub fn walk<I: Item>(built: &Built, level: Level, rays: &mut Rays<'_, I>, together: bool) {
    let lines: Vec<_> = rays.queries.iter().map(|query| query.ray).collect();
    let t_min: Vec<_> = rays.queries.iter().map(|query| query.t_min).collect();
    let t_max: Vec<_> = rays.queries.iter().map(|query| query.t_max).collect();
    let queries = Queries { rays: &lines, t_min: &t_min, t_max: &t_max };
    built.accelerator.walk_rays(level, &queries, rays, together);
}

pub fn trace<I: Item>(
    built: &Built,
    level: Level,
    scene: &Scene<I>,
    queries: &[Query],
    any: bool,
) -> Vec<Hit> {
    let mut rays = Rays::new(scene, built.order.as_deref(), queries, any);
    walk(built, level, &mut rays, false);
    assert_eq!(rays.finished, queries.len());
    let mut packets = Rays::new(scene, built.order.as_deref(), queries, any);
    walk(built, level, &mut packets, true);
    assert_eq!(packets.finished, queries.len());
    // Which blocker an occlusion ray names depends on the order in which it is shown them.
    let agree = |(one, other): (&(f64, u32), &(f64, u32))| {
        if any { (one.1 == u32::MAX) == (other.1 == u32::MAX) } else { one == other }
    };
    assert!(rays.best.iter().zip(&packets.best).all(agree), "single rays and packets differ");
    rays.hits()
}

/// The truth, without any accelerator.
pub fn nearest<I: Item>(scene: &Scene<I>, queries: &[Query]) -> Vec<Hit> {
    let mut rays = Rays::new(scene, None, queries, false);
    for (i, query) in queries.iter().enumerate() {
        let mut t_max = query.t_max;
        for item in 0..scene.0.len() as u32 {
            t_max = rays.test(i, item, t_max);
        }
    }
    rays.hits()
}
