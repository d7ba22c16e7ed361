//! Trace(): streams of rays, a bounce at a time (Turner Whitted, "An improved illumination model for shaded
//! display", CACM 1980).
//!
//! The rays of a tile travel together: first all look for what they meet, then all points ask for each light, then
//! all secondary rays go on together. Sums are taken in the order of the formula, so the result does not depend on
//! which rays share a stream.

use crate::options::Options;
use crate::options::Shadows;
use crate::query::Between;
use crate::query::NearestBatch;
use crate::query::ShadowBatch;
use crate::query::Tests;
use crate::shade::ShadePoint;
use crate::stats::Stats;
use crate::world::World;
use dotray_accel::ENDLESS;
use dotray_accel::Level;
use dotray_accel::Queries;
use dotray_geometry::Ray;
use dotray_geometry::Vec3;

/// The rays of one stream: enough to keep SIMD lanes and caches busy, few enough that a deep recursion, which holds
/// one stream a level, stays small.
const STREAM: usize = 256;

/// A ray on its way and what it can still add to the picture.
#[derive(Clone, Copy, Debug)]
struct PathRay {
    ray: Ray,
    /// The product of the weights along the path.
    contribution: Vec3,
    /// Which ray of the stream above sent it.
    parent: usize,
    /// What its colour is multiplied by there.
    weight: Vec3,
}

/// Traces rays through a world.
pub struct Tracer<'a> {
    world: &'a World,
    options: &'a Options,
    level: Level,
    /// What has been traced so far.
    pub stats: Stats,
}

/// A point of the stream that met something, and the ray's place in the stream.
struct Met<'a> {
    index: usize,
    point: ShadePoint<'a>,
}

impl<'a> Tracer<'a> {
    /// A tracer that has traced nothing yet.
    pub fn new(world: &'a World, options: &'a Options, level: Level) -> Self {
        Self { world, options, level, stats: Stats::default() }
    }

    /// The colours that the eye rays see.
    pub fn colors(&mut self, eye_rays: &[Ray]) -> Vec<Vec3> {
        self.stats.eye_rays += eye_rays.len() as u64;
        let mut colors = Vec::with_capacity(eye_rays.len());
        for stream in eye_rays.chunks(STREAM) {
            let contributions = vec![Vec3::ONE; stream.len()];
            colors.append(&mut self.stream_colors(stream, &contributions, 0));
        }
        colors
    }

    /// The colours of one stream whose rays have `depth` bounces behind them.
    fn stream_colors(&mut self, rays: &[Ray], contributions: &[Vec3], depth: u32) -> Vec<Vec3> {
        let world = self.world;
        let mut colors = vec![world.background; rays.len()];
        let met = self.meet(rays, depth == 0);
        for Met { index, point } in &met {
            colors[*index] = point.own_light(world.ambient);
        }
        self.add_lights(&met, &mut colors);
        if depth < self.options.recursion {
            let mirrored = self.reflected(&met, contributions);
            self.stats.reflected_rays += mirrored.len() as u64;
            self.add_secondary(&mirrored, depth + 1, &mut colors);
            let bent = self.refracted(&met, contributions);
            self.stats.refracted_rays += bent.len() as u64;
            self.add_secondary(&bent, depth + 1, &mut colors);
        }
        colors
    }

    /// What each ray meets first, with its surface.
    fn meet(&mut self, rays: &[Ray], together: bool) -> Vec<Met<'a>> {
        let world = self.world;
        let t_min = [world.ray_eps];
        let queries = Queries { rays, t_min: &t_min, t_max: ENDLESS };
        let mut batch = NearestBatch::new(self.level, &world.caster.shapes, queries);
        if together {
            world.caster.accelerator.walk_together(self.level, &queries, &mut batch);
        } else {
            world.caster.accelerator.walk(self.level, &queries, &mut batch);
        }
        count(&mut self.stats, &batch.tests);
        let filter = self.options.texture_filter;
        let found = batch.found.iter().enumerate();
        found
            .filter_map(|(index, found)| {
                let point = ShadePoint::new(world, &rays[index], found.as_ref()?, filter);
                Some(Met { index, point })
            })
            .collect()
    }

    /// Adds every light's term to every point, light after light.
    fn add_lights(&mut self, met: &[Met<'_>], colors: &mut [Vec3]) {
        for light in &self.world.lights {
            let samples = light.samples(self.options.light_samples);
            if samples == 1 {
                self.add_light_sample(met, |point| light.incident(point, 0, 1), colors);
                continue;
            }
            let mut sums = vec![Vec3::ZERO; colors.len()];
            for sample in 0..samples {
                self.add_light_sample(met, |point| light.incident(point, sample, samples), &mut sums);
            }
            for Met { index, .. } in met {
                colors[*index] += sums[*index] / f64::from(samples);
            }
        }
    }

    /// Adds the term of one point lamp to every point that it reaches.
    fn add_light_sample(
        &mut self,
        met: &[Met<'_>],
        incident_at: impl Fn(Vec3) -> Option<crate::light::Incident>,
        sums: &mut [Vec3],
    ) {
        let mut rays = Vec::with_capacity(met.len());
        let mut ends = Vec::with_capacity(met.len());
        let mut waiting = Vec::with_capacity(met.len());
        for Met { index, point } in met {
            let Some(incident) = incident_at(point.point) else { continue };
            let lit = point.lit(&incident);
            // Where the lamp adds nothing, nobody asks what lies between.
            if lit != Vec3::ZERO {
                rays.push(Ray::new(point.point, incident.towards));
                ends.push(incident.distance - self.world.ray_eps);
                waiting.push((*index, lit));
            }
        }
        let filters = self.filters(&rays, &ends);
        for (&(index, lit), filter) in waiting.iter().zip(filters) {
            sums[index] += lit * filter;
        }
    }

    /// S_i of each shadow ray.
    fn filters(&mut self, rays: &[Ray], ends: &[f64]) -> Vec<Vec3> {
        let world = self.world;
        let all_opaque = match self.options.shadows {
            Shadows::Off => return vec![Vec3::ONE; rays.len()],
            Shadows::Opaque => true,
            Shadows::Filtered => false,
        };
        self.stats.shadow_rays += rays.len() as u64;
        let transmission = |material: u32| world.materials[material as usize].transmission;
        let see_through = |material| !all_opaque && transmission(material) != Vec3::ZERO;
        let t_min = [world.ray_eps];
        let queries = Queries { rays, t_min: &t_min, t_max: ends };
        let mut batch = ShadowBatch::new(self.level, &world.caster.shapes, queries, see_through);
        world.caster.accelerator.walk_together(self.level, &queries, &mut batch);
        batch.finish();
        count(&mut self.stats, &batch.tests);
        let filter = |between: &Between| match between {
            Between::Blocked(_) => Vec3::ZERO,
            Between::Crossed(crossings) => crossings.iter().fold(Vec3::ONE, |product, crossing| {
                product * transmission(world.caster.shapes.material(crossing.position))
            }),
        };
        batch.found.iter().map(filter).collect()
    }

    /// The mirrored rays that are worth tracing.
    fn reflected(&self, met: &[Met<'_>], contributions: &[Vec3]) -> Vec<PathRay> {
        let ray = |Met { index, point }: &Met<'_>| {
            let weight = point.material.reflection;
            let contribution = self.worth(contributions[*index], weight)?;
            Some(PathRay { ray: point.reflected_ray(), contribution, parent: *index, weight })
        };
        met.iter().filter_map(ray).collect()
    }

    /// The refracted rays that are worth tracing.
    fn refracted(&self, met: &[Met<'_>], contributions: &[Vec3]) -> Vec<PathRay> {
        let ray = |Met { index, point }: &Met<'_>| {
            let weight = point.material.transmission;
            let contribution = self.worth(contributions[*index], weight)?;
            Some(PathRay { ray: point.refracted_ray()?, contribution, parent: *index, weight })
        };
        met.iter().filter_map(ray).collect()
    }

    /// The path's contribution behind a surface, where its largest channel reaches the threshold and is above 0.
    fn worth(&self, contribution: Vec3, weight: Vec3) -> Option<Vec3> {
        let product = contribution * weight;
        let largest = product.max_element();
        (largest > 0.0 && largest >= self.options.threshold).then_some(product)
    }

    /// Adds weight · Trace() of each ray to its parent's colour.
    fn add_secondary(&mut self, paths: &[PathRay], depth: u32, colors: &mut [Vec3]) {
        for stream in paths.chunks(STREAM) {
            let rays: Vec<Ray> = stream.iter().map(|path| path.ray).collect();
            let contributions: Vec<Vec3> = stream.iter().map(|path| path.contribution).collect();
            let seen = self.stream_colors(&rays, &contributions, depth);
            for (path, color) in stream.iter().zip(seen) {
                colors[path.parent] += path.weight * color;
            }
        }
    }
}

fn count(stats: &mut Stats, tests: &[Tests]) {
    for test in tests {
        stats.box_tests += test.boxes;
        stats.shape_tests += test.shapes;
    }
}
