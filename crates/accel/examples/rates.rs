//! Ray rates over spheres on one thread, for tuning: `rates [SPHERES.sph RAYS.rays…]` reads raw single-precision
//! files (x y z r; origin tmin direction tmax; shadow rays where the name says so), `rates N…` makes N random ones
//! with N·π·r² = 2 and random rays. The leaf test is in double precision, eight spheres at a time, and gives
//! what one at
//! a time would.

use dotray_accel::simd::prelude::*;
use dotray_accel::simd::{Simd, f64x4, level, level_name};
use dotray_accel::{Accelerator, Batch, Boxes, Kind, Quality, Query, Settings};
use dotray_geometry::{Aabb, Ray, Vec3};
use std::time::Instant;

/// x, y, z and r of every sphere, side by side, and a block of spheres that nothing meets at the end.
struct Spheres([Vec<f64>; 4]);

impl Boxes for Spheres {
    fn len(&self) -> u32 {
        (self.0[0].len() - 8) as u32
    }

    fn bounds(&self, item: u32) -> Aabb {
        let [x, y, z, r] = [0, 1, 2, 3].map(|part| self.0[part][item as usize]);
        Aabb::new(Vec3::new(x, y, z) - r, Vec3::new(x, y, z) + r)
    }
}

impl Spheres {
    fn new(spheres: impl Iterator<Item = [f64; 4]>) -> Self {
        let mut parts = [const { Vec::new() }; 4];
        for sphere in spheres.chain([[0.0, 0.0, 0.0, 0.0]; 8]) {
            for (part, number) in parts.iter_mut().zip(sphere) {
                part.push(number);
            }
        }
        Self(parts)
    }

    fn ordered(&self, order: &[u32]) -> Self {
        Self::new(order.iter().map(|&item| [0, 1, 2, 3].map(|part| self.0[part][item as usize])))
    }
}

/// Rays of one sort, as the callbacks see them.
struct Rays<'a> {
    spheres: &'a Spheres,
    queries: &'a [Query],
    any: bool,
    hits: u64,
    sum: f64,
    nearest: [f64; 256],
    boxes: u64,
}

/// Four spheres against a ray, the same operations in each lane as for one: NaN where it misses.
#[inline(always)]
fn four<S: Simd>(simd: S, spheres: &Spheres, first: usize, query: &Query, t_max: f64) -> f64 {
    let [x, y, z, r] = [0, 1, 2, 3].map(|part| f64x4::from_slice(simd, &spheres.0[part][first..first + 4]));
    let spread = |number| f64x4::splat(simd, number);
    let (origin, direction) = (query.ray.origin, query.ray.direction);
    let (lx, ly, lz) = (x - spread(origin.x), y - spread(origin.y), z - spread(origin.z));
    let (dx, dy, dz) = (spread(direction.x), spread(direction.y), spread(direction.z));
    let middle = lx * dx + ly * dy + lz * dz;
    let (px, py, pz) = (lx - dx * middle, ly - dy * middle, lz - dz * middle);
    let square = r * r - (px * px + py * py + pz * pz);
    let some = square.simd_gt(spread(0.0));
    if some.to_bitmask() == 0 {
        return t_max;
    }
    let half = square.max(spread(0.0)).sqrt();
    let (near, far) = (middle - half, middle + half);
    let first = near.simd_gt(spread(query.t_min)).select(near, far);
    let good = some & first.simd_gt(spread(query.t_min)) & first.simd_le(spread(t_max));
    if good.to_bitmask() == 0 {
        return t_max;
    }
    good.select(first, spread(t_max)).to_array().into_iter().fold(t_max, f64::min)
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
    fn leaf_range<S: Simd>(&mut self, simd: S, i: usize, first: u32, count: u32, t_max: f64) -> f64 {
        let query = &self.queries[i];
        let first = first as usize;
        // Spheres behind the leaf's own are other leaves': testing them as well does no harm.
        let mut t = t_max;
        for first in (first..first + count as usize).step_by(4) {
            t = four(simd, self.spheres, first, query, t);
        }
        if t < t_max {
            self.nearest[i] = t;
            if self.any {
                return f64::NEG_INFINITY;
            }
        }
        t
    }

    #[inline(always)]
    fn leaf_list<S: Simd>(&mut self, simd: S, i: usize, positions: &[u32], t_max: f64) -> f64 {
        let mut t_max = t_max;
        for &position in positions {
            t_max = self.leaf_range(simd, i, position, 1, t_max);
        }
        t_max
    }

    #[inline(always)]
    fn finished(&mut self, i: usize, box_tests: u64) {
        self.boxes += box_tests;
        if self.nearest[i] < self.queries[i].t_max {
            self.hits += 1;
            self.sum += if self.any { 0.0 } else { self.nearest[i] };
        }
    }
}

/// Seconds that this thread has computed, where the system tells; else the clock's.
fn seconds(start: Instant) -> f64 {
    std::fs::read_to_string("/proc/thread-self/schedstat")
        .ok()
        .and_then(|text| text.split(' ').next()?.parse::<f64>().ok())
        .map_or_else(|| start.elapsed().as_secs_f64(), |nanoseconds| nanoseconds * 1e-9)
}

fn rate(accelerator: &Accelerator, spheres: &Spheres, queries: &[Query], any: bool, rounds: usize) -> String {
    let start = Instant::now();
    let mut best = f64::INFINITY;
    let mut told = String::new();
    for _ in 0..rounds {
        let before = seconds(start);
        let (mut hits, mut sum, mut boxes) = (0, 0.0, 0);
        for queries in queries.chunks(256) {
            let mut rays =
                Rays { spheres, queries, any, hits: 0, sum: 0.0, nearest: [f64::INFINITY; 256], boxes: 0 };
            accelerator.walk(level(), &mut rays);
            (hits, sum, boxes) = (hits + rays.hits, sum + rays.sum, boxes + rays.boxes);
        }
        best = best.min(seconds(start) - before);
        told = format!(
            "{hits} hits, mean {:.6}, {:.1} nodes",
            sum / hits as f64,
            boxes as f64 / 8.0 / queries.len() as f64
        );
    }
    format!("{:6.3} Mrays/s  ({told})", queries.len() as f64 / best * 1e-6)
}

fn singles(path: &str) -> Vec<f64> {
    let bytes = std::fs::read(path).unwrap_or_else(|fault| panic!("{path}: {fault}"));
    bytes.chunks_exact(4).map(|b| f64::from(f32::from_le_bytes([b[0], b[1], b[2], b[3]]))).collect()
}

fn random(state: &mut u64) -> f64 {
    *state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
    (*state >> 11) as f64 / (1_u64 << 53) as f64
}

fn random_point(state: &mut u64) -> Vec3 {
    Vec3::new(random(state), random(state), random(state))
}

fn main() {
    let arguments: Vec<_> = std::env::args().skip(1).collect();
    let option = |name: &str| std::env::var(name).ok();
    let quality = match option("QUALITY").as_deref() {
        Some("fast") => Quality::Fast,
        Some("best") => Quality::Best,
        _ => Quality::Balanced,
    };
    let rounds = option("ROUNDS").and_then(|rounds| rounds.parse().ok()).unwrap_or(3);
    let wanted = option("KINDS").unwrap_or_else(|| "bvh".into());
    let kinds = Kind::ALL.into_iter().filter(|kind| wanted.split(',').any(|name| name == kind.name()));
    let mut state = 1;
    let mut sets = Vec::new();
    let spheres = if let Some(count) = arguments.first().and_then(|word| word.parse::<usize>().ok()) {
        let radius = (2.0 / (std::f64::consts::PI * count as f64)).sqrt();
        let point = |state: &mut u64| random_point(state).to_array();
        let queries: Vec<_> = (0..100_000)
            .map(|_| {
                let (from, to) = (random_point(&mut state), random_point(&mut state));
                Query { ray: Ray::new(from, (to - from).normalize()), t_min: 1e-5, t_max: f64::INFINITY }
            })
            .collect();
        sets.push(("random".to_owned(), queries));
        Spheres::new((0..count).map(|_| {
            let [x, y, z] = point(&mut state);
            [x, y, z, radius * (0.75 + 0.5 * random(&mut state))]
        }))
    } else {
        for path in arguments.get(1..).unwrap_or_default() {
            let numbers = singles(path);
            let queries = numbers.chunks_exact(8).map(|n| {
                let direction = Vec3::new(n[4], n[5], n[6]).normalize();
                Query { ray: Ray::new(Vec3::new(n[0], n[1], n[2]), direction), t_min: n[3], t_max: n[7] }
            });
            sets.push((path.split('.').rev().nth(1).unwrap_or("rays").to_owned(), queries.collect()));
        }
        let path = arguments.first().map_or("", String::as_str);
        Spheres::new(singles(path).chunks_exact(4).map(|n| [n[0], n[1], n[2], n[3]]))
    };
    for kind in kinds {
        let start = Instant::now();
        let built = Accelerator::build(kind, &spheres, &[], &Settings { quality });
        let seconds = start.elapsed().as_secs_f64();
        let stats = built.accelerator.stats();
        println!(
            "{} ({}): built in {seconds:.3} s; {stats}; {:.1} bytes an item; {:?}",
            kind.name(),
            level_name(level()),
            stats.bytes as f64 / f64::from(stats.items.max(1)),
            &stats.leaf_sizes[1..9]
        );
        let ordered = built.order.map_or_else(
            || spheres.ordered(&(0..spheres.len()).collect::<Vec<_>>()),
            |order| spheres.ordered(&order),
        );
        for (name, queries) in &sets {
            println!("  {name:8} {}", rate(&built.accelerator, &ordered, queries, name == "shadow", rounds));
        }
    }
}
