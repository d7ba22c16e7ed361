//! The lights' part of the formula, for a whole stream of points at once: light after light, its shadow rays side by
//! side.

use super::Met;
use super::Tracer;
use super::count;
use crate::inspect::LightTerm;
use crate::inspect::Shadow;
use crate::light::Incident;
use crate::light::Light;
use crate::options::Shadows;
use crate::query::Crossing;
use crate::query::ShadowBatch;
use crate::query::ShadowBuffers;
use crate::query::Tests;
use crate::query::UNBLOCKED;
use crate::shade::ShadePoint;
use crate::ways::Places;
use crate::ways::Ways;
use crate::world::World;
use dotray_accel::Queries;
use dotray_geometry::Ray;
use dotray_geometry::Vec3;
use dotray_scene::model::Tint;

/// The shadow rays to one lamp, side by side.
#[derive(Default)]
pub(super) struct ShadowStream {
    rays: Vec<Ray>,
    /// The shape that each leaves and cannot meet again.
    left: Vec<u32>,
    ends: Vec<f64>,
    /// Whose each is: the place in the stream, and what the lamp gives where nothing lies between.
    waiting: Vec<(usize, Vec3)>,
    filters: Vec<Vec3>,
    buffers: ShadowBuffers,
}

/// Where the points of a stream lie, and how one lamp after the other lies to them.
#[derive(Default)]
pub(super) struct LampWays {
    places: Places,
    ways: Ways,
}

impl ShadowStream {
    /// Asks what lies between a point and the lamp, unless the lamp adds nothing.
    #[inline]
    fn ask(&mut self, index: usize, from: &ShadePoint<'_>, incident: &Incident, eps: f64, lit: Vec3) {
        if lit != Vec3::ZERO {
            self.rays.push(Ray::new(from.point, incident.towards));
            self.left.push(from.left_by(incident.towards));
            self.ends.push(incident.distance - eps);
            self.waiting.push((index, lit));
        }
    }
}

/// One point of a light that stands for it.
#[derive(Clone, Copy)]
struct LightSample<'a> {
    light: &'a Light,
    tint: &'a Tint,
    /// The light's number.
    number: u32,
    sample: u32,
    samples: u32,
}

impl Tracer<'_> {
    /// Adds every light's term to every point, light after light.
    pub(super) fn add_lights(&mut self, met: &[Met<'_>], colors: &mut [Vec3]) {
        self.lamp_ways.places.fill(met.iter().map(|Met { point, .. }| (point.point, point.normal)));
        for (number, (light, tint)) in (0..).zip(self.world.lights.iter().zip(&self.world.tints)) {
            let samples = light.samples(self.options.light_samples);
            let first = LightSample { light, tint, number, sample: 0, samples };
            if samples == 1 {
                self.add_light_sample(met, first, colors);
                continue;
            }
            let mut sums = vec![Vec3::ZERO; colors.len()];
            for sample in 0..samples {
                self.add_light_sample(met, LightSample { sample, ..first }, &mut sums);
            }
            for Met { index, .. } in met {
                colors[*index] += sums[*index] / f64::from(samples);
            }
        }
    }

    /// Adds the term of one point lamp to every point that it reaches.
    fn add_light_sample(&mut self, met: &[Met<'_>], from: LightSample<'_>, sums: &mut [Vec3]) {
        if self.stops() {
            return;
        }
        let shadows = &mut self.shadows;
        shadows.rays.clear();
        shadows.left.clear();
        shadows.ends.clear();
        shadows.waiting.clear();
        let eps = self.world.ray_eps;
        match from.light.source() {
            Some(source) if self.inspector.is_none() => {
                let LampWays { places, ways } = &mut self.lamp_ways;
                ways.find(self.level, &source, places);
                for (place, way, cosine) in ways.facing() {
                    let Met { index, point } = &met[place];
                    if let Some(incident) = from.light.along(way) {
                        let lit = point.lit_by(&incident, cosine, from.tint);
                        shadows.ask(*index, point, &incident, eps, lit);
                    }
                }
            }
            Some(_) | None => {
                for Met { index, point } in met {
                    let incident = from.light.incident(point.point, from.sample, from.samples);
                    if let Some(inspector) = &mut self.inspector {
                        inspector.light(light_term(point, from, incident.as_ref()));
                    }
                    if let Some(incident) = incident {
                        let lit = point.lit(&incident, from.tint);
                        shadows.ask(*index, point, &incident, eps, lit);
                    }
                }
            }
        }
        self.find_filters();
        for (&(index, lit), &filter) in self.shadows.waiting.iter().zip(&self.shadows.filters) {
            sums[index] += lit * filter;
            if let Some(recorder) = &mut self.recorder {
                recorder.filter(index, filter);
            }
        }
    }

    /// S_i of each shadow ray.
    fn find_filters(&mut self) {
        let world = self.world;
        let together = self.together();
        let ShadowStream { rays, left, ends, waiting, filters, buffers } = &mut self.shadows;
        filters.clear();
        filters.resize(rays.len(), Vec3::ONE);
        let all_opaque = match self.options.shadows {
            Shadows::Off => return,
            Shadows::Opaque => true,
            Shadows::Filtered => false,
        };
        self.stats.shadow_rays += rays.len() as u64;
        let transmission = |material: u32| world.materials[material as usize].shadow;
        let see_through = |material| !all_opaque && transmission(material) != Vec3::ZERO;
        let t_min = [world.ray_eps];
        let queries = Queries { rays, t_min: &t_min, t_max: ends };
        let mut batch = ShadowBatch::new(&world.caster.shapes, queries, &see_through, buffers).leaving(left);
        world.caster.accelerator.walk_rays(self.level, &queries, &mut batch, together);
        batch.finish();
        count(&mut self.stats, &buffers.tests);
        if let Some(recorder) = &mut self.recorder {
            recorder.cost(waiting.iter().map(|(index, _)| *index), &buffers.tests);
        }
        for crossing in &buffers.crossings {
            filters[crossing.ray as usize] *= transmission(world.caster.shapes.material(crossing.position));
        }
        for (filter, &blocker) in filters.iter_mut().zip(&buffers.blockers) {
            if blocker != UNBLOCKED {
                *filter = Vec3::ZERO;
            }
        }
        if let (Some(inspector), [filter]) = (&mut self.inspector, &filters[..]) {
            let shadow = match buffers.blockers[0] {
                UNBLOCKED => {
                    let through = |c: &Crossing| transmission(world.caster.shapes.material(c.position));
                    Shadow::Crossed(buffers.crossings.iter().map(|c| (*c, through(c))).collect())
                }
                position => Shadow::Blocked { position, number: world.caster.shapes.number(position) },
            };
            inspector.shadow(shadow, *filter, buffers.tests[0]);
        }
    }
}

/// The term of one light, its shadow not asked for yet.
fn light_term(point: &ShadePoint<'_>, from: LightSample<'_>, incident: Option<&Incident>) -> LightTerm {
    let cosine = incident.map_or(0.0, |incident| point.normal.dot(incident.towards));
    LightTerm {
        light: from.number,
        sample: from.sample,
        samples: from.samples,
        incident: incident.copied(),
        cosine,
        diffuse: point.diffuse(cosine.max(0.0)),
        highlight: incident.map_or(Vec3::ZERO, |incident| point.highlight(incident.towards)),
        lit: incident.map_or(Vec3::ZERO, |incident| point.lit(incident, from.tint)),
        shadow: Shadow::NotAsked,
        filter: Vec3::ONE,
        tests: Tests::default(),
    }
}

/// What the lights' own ambient colours add, whatever stands between; only one dialect has such lights.
pub(super) fn ambient_of_lights(world: &World, point: &ShadePoint<'_>) -> Vec3 {
    let lights = world.ambient_lights.iter();
    let incidents = lights.filter_map(|(light, color)| Some((light.incident(point.point, 0, 1)?, color)));
    incidents.fold(Vec3::ZERO, |sum, (incident, color)| sum + point.ambient(*color * incident.strength))
}
