//! Trace(): streams of rays, a bounce at a time (Turner Whitted, "An improved illumination model for shaded
//! display", CACM 1980).
//!
//! The rays of a tile travel together: first all look for what they meet, then all points ask for each light, then
//! all secondary rays go on together. Sums are taken in the order of the formula, so the result does not depend on
//! which rays share a stream.

mod lighting;

use crate::inspect::End;
use crate::inspect::Inspector;
use crate::inspect::RayKind;
use crate::inspect::RayNode;
use crate::observer::Observer;
use crate::observer::Silent;
use crate::options::Options;
use crate::query::NearestBatch;
use crate::query::NearestBuffers;
use crate::query::Tests;
use crate::record::EyeRecord;
use crate::record::MetByEye;
use crate::record::Part;
use crate::record::Recorder;
use crate::shade::ShadePoint;
use crate::stats::Stats;
use crate::world::World;
use dotray_accel::ENDLESS;
use dotray_accel::Level;
use dotray_accel::Queries;
use dotray_geometry::Ray;
use dotray_geometry::Vec3;
use dotray_geometry::Vec4;

/// The rays of one stream: enough to keep SIMD lanes and caches busy, few enough that a deep recursion, which holds
/// one stream a level, stays small.
const STREAM: usize = 1024;

/// Tests between two looks at an observer who is impatient, and with how many rays a stream begins whose cost is not
/// known: without a tree over many shapes, a ray has a test with each.
const TESTS: u64 = 200_000;
const FIRST: usize = 16;

/// Traces rays through a world.
pub struct Tracer<'a> {
    world: &'a World,
    options: &'a Options,
    level: Level,
    /// What has been traced so far.
    pub stats: Stats,
    /// The streams under way, by depth: kept, so that a bounce allocates nothing.
    streams: Vec<Stream<'a>>,
    nearest: NearestBuffers,
    shadows: lighting::ShadowStream,
    lamp_ways: lighting::LampWays,
    /// Who wants to know everything of the one ray that is traced.
    inspector: Option<Inspector>,
    /// Who wants to know something of every eye ray.
    recorder: Option<Recorder>,
    /// Who may stop it.
    observer: &'a dyn Observer,
    stopped: bool,
    /// All tests when the observer was looked at last, and the most between two looks since the stream began.
    tests_before: u64,
    most_tests: u64,
}

/// Rays with the same number of bounces behind them, side by side.
#[derive(Default)]
struct Stream<'a> {
    rays: Vec<Ray>,
    /// The shape that each leaves and cannot meet again; empty for eye rays.
    left: Vec<u32>,
    /// The product of the weights along the path of each.
    contributions: Vec<Vec3>,
    /// Which ray of the stream above sent each, and what its colour is multiplied by there; empty for eye rays.
    senders: Vec<(usize, Vec3)>,
    met: Vec<Met<'a>>,
    /// What each sees.
    colors: Vec<Vec3>,
}

/// A point of the stream that met something, and the ray's place in the stream.
struct Met<'a> {
    index: usize,
    point: ShadePoint<'a>,
}

/// The two kinds of secondary rays.
#[derive(Clone, Copy)]
enum Secondary {
    Reflected,
    Refracted,
}

impl Secondary {
    fn kind(self) -> RayKind {
        match self {
            Self::Reflected => RayKind::Reflected,
            Self::Refracted => RayKind::Refracted,
        }
    }

    fn part(self) -> Part {
        match self {
            Self::Reflected => Part::Reflected,
            Self::Refracted => Part::Transmitted,
        }
    }
}

impl<'a> Tracer<'a> {
    /// A tracer that has traced nothing yet.
    pub fn new(world: &'a World, options: &'a Options, level: Level) -> Self {
        Self {
            world,
            options,
            level,
            stats: Stats::default(),
            streams: Vec::new(),
            nearest: NearestBuffers::default(),
            shadows: lighting::ShadowStream::default(),
            lamp_ways: lighting::LampWays::default(),
            inspector: None,
            recorder: None,
            observer: &Silent,
            stopped: false,
            tests_before: 0,
            most_tests: 0,
        }
    }

    /// The same, stopped once the observer cancels: colours that it gives then mean nothing.
    pub fn watched_by(self, observer: &'a dyn Observer) -> Self {
        Self { observer, ..self }
    }

    /// Who may stop it.
    pub fn observer(&self) -> &'a dyn Observer {
        self.observer
    }

    /// Whether it was stopped, so that the last colours mean nothing and may be too few.
    pub fn is_stopped(&self) -> bool {
        self.stopped
    }

    /// Asks whether to stop.
    fn stops(&mut self) -> bool {
        let tests = self.stats.box_tests + self.stats.shape_tests;
        self.most_tests = self.most_tests.max(tests - self.tests_before);
        self.tests_before = tests;
        self.stopped = self.stopped || self.observer.cancelled();
        self.stopped
    }

    /// The colours that the eye rays see.
    pub fn colors(&mut self, eye_rays: &[Ray]) -> Vec<Vec3> {
        let mut colors = Vec::with_capacity(eye_rays.len());
        self.eye_streams(eye_rays, |stream| colors.extend_from_slice(&stream.colors));
        colors
    }

    /// The same with alpha 1; 0 in all four channels where an eye ray meets nothing.
    pub fn covered_colors(&mut self, eye_rays: &[Ray]) -> Vec<Vec4> {
        let mut colors = Vec::with_capacity(eye_rays.len());
        self.eye_streams(eye_rays, |stream| {
            let first = colors.len();
            colors.resize(first + stream.rays.len(), Vec4::ZERO);
            for Met { index, .. } in &stream.met {
                colors[first + index] = stream.colors[*index].extend(1.0);
            }
        });
        colors
    }

    /// Traces the eye rays stream by stream and shows each.
    fn eye_streams(&mut self, eye_rays: &[Ray], mut show: impl FnMut(&Stream<'a>)) {
        self.stats.eye_rays += eye_rays.len() as u64;
        let impatient = self.observer.is_impatient();
        let (mut first, mut at_once) = (0, if impatient { FIRST } else { STREAM });
        while first < eye_rays.len() {
            if self.stops() {
                return;
            }
            let rays = &eye_rays[first..eye_rays.len().min(first + at_once)];
            let mut stream = self.take_stream();
            stream.rays.extend_from_slice(rays);
            stream.contributions.resize(rays.len(), Vec3::ONE);
            self.listen(|recorder| recorder.open_eyes(first, rays.len()));
            self.most_tests = 0;
            self.trace(&mut stream, 0);
            self.listen(Recorder::close);
            show(&stream);
            self.streams.push(stream);
            first += rays.len();
            if impatient {
                self.stops();
                at_once = fitting(rays.len(), self.most_tests);
            }
        }
    }

    /// All that the renderer computes for one eye ray, its colour included; `None` where it was stopped.
    pub fn inspect(&mut self, eye_ray: Ray) -> Option<RayNode> {
        let mut inspector = Inspector::default();
        inspector.begin(RayKind::Eye, eye_ray, 0, Vec3::ONE, Vec3::ONE);
        self.inspector = Some(inspector);
        let colors = self.colors(&[eye_ray]);
        let mut inspector = self.inspector.take()?;
        let color = colors.first().copied().filter(|_| !self.stopped)?;
        inspector.finish(color);
        inspector.root
    }

    /// What layers want to know of each eye ray; with `alone`, the tests that each ray costs by itself.
    pub fn record(&mut self, eye_rays: &[Ray], alone: bool) -> Vec<EyeRecord> {
        self.recorder = Some(Recorder::new(eye_rays.len(), alone));
        self.eye_streams(eye_rays, |_| {});
        self.recorder.take().map_or_else(Vec::new, |recorder| recorder.records)
    }

    /// Tells the recorder, if there is one.
    #[inline]
    fn listen(&mut self, tell: impl FnOnce(&mut Recorder)) {
        if let Some(recorder) = &mut self.recorder {
            tell(recorder);
        }
    }

    /// Whether rays may share their walks: not where somebody wants to know what each costs.
    fn together(&self) -> bool {
        self.recorder.as_ref().is_none_or(|recorder| !recorder.alone)
    }

    /// An empty stream, its memory taken from one that has done its work.
    fn take_stream(&mut self) -> Stream<'a> {
        let mut stream = self.streams.pop().unwrap_or_default();
        stream.rays.clear();
        stream.left.clear();
        stream.contributions.clear();
        stream.senders.clear();
        stream.met.clear();
        stream.colors.clear();
        stream
    }

    /// Finds the colours of a stream whose rays have `depth` bounces behind them.
    fn trace(&mut self, stream: &mut Stream<'a>, depth: u32) {
        let world = self.world;
        let background = if depth == 0 { world.background } else { world.secondary_background };
        stream.colors.resize(stream.rays.len(), background);
        if self.stops() {
            return;
        }
        let together = (depth == 0 || run_alike(&stream.rays)) && self.together();
        self.meet(stream, together);
        self.record_meetings(stream);
        for Met { index, point } in &stream.met {
            stream.colors[*index] =
                point.own_light(world.ambient) + lighting::ambient_of_lights(world, point);
            if let Some(inspector) = &mut self.inspector {
                inspector.own_light(stream.colors[*index]);
            }
        }
        self.add_lights(&stream.met, &mut stream.colors);
        self.listen(|recorder| recorder.direct(&stream.colors));
        if depth < self.options.recursion && !stream.met.is_empty() {
            self.add_secondary(stream, Secondary::Reflected, depth + 1);
            self.add_secondary(stream, Secondary::Refracted, depth + 1);
        }
    }

    /// Finds what each ray meets first, with its surface.
    fn meet(&mut self, stream: &mut Stream<'a>, together: bool) {
        let world = self.world;
        let t_min = [world.ray_eps];
        let queries = Queries { rays: &stream.rays, t_min: &t_min, t_max: ENDLESS };
        let shapes = &world.caster.shapes;
        let mut batch = NearestBatch::new(shapes, queries, &mut self.nearest).leaving(&stream.left);
        world.caster.accelerator.walk_rays(self.level, &queries, &mut batch, together);
        count(&mut self.stats, &self.nearest.tests);
        let filter = self.options.texture_filter;
        stream.met.reserve(stream.rays.len());
        for (index, found) in self.nearest.found.iter().enumerate() {
            if let Some(nearest) = found {
                let ray = &stream.rays[index];
                let point = ShadePoint::new(world, ray, nearest, filter);
                if let Some(inspector) = &mut self.inspector {
                    let surface = shapes.surface(nearest.position, ray, nearest.hit);
                    inspector.met(*nearest, surface, shapes.material(nearest.position), &point);
                }
                stream.met.push(Met { index, point });
            }
        }
        if let (Some(inspector), Some(tests)) = (&mut self.inspector, self.nearest.tests.first()) {
            inspector.tests(*tests);
        }
    }

    /// Tells the recorder what each ray cost, and of eye rays what they met.
    fn record_meetings(&mut self, stream: &Stream<'_>) {
        let Some(recorder) = &mut self.recorder else { return };
        recorder.cost(0..stream.rays.len(), &self.nearest.tests);
        if !recorder.at_eye() {
            return;
        }
        let shapes = &self.world.caster.shapes;
        for Met { index, point } in &stream.met {
            let Some(nearest) = self.nearest.found[*index] else { continue };
            let surface = shapes.surface(nearest.position, &stream.rays[*index], nearest.hit);
            let material = shapes.material(nearest.position);
            let met = MetByEye { nearest, surface, material, normal: point.normal };
            recorder.eye(*index, |record| record.met = Some(met));
        }
    }

    /// Adds weight · Trace() of each secondary ray of a kind that is worth tracing to its sender's colour.
    fn add_secondary(&mut self, stream: &mut Stream<'a>, kind: Secondary, depth: u32) {
        let mut next = self.take_stream();
        for Met { index, point } in &stream.met {
            let weight = match kind {
                Secondary::Reflected => point.material.reflection,
                Secondary::Refracted => point.material.transmission,
            };
            let (ray, contribution) =
                match self.secondary_ray(stream.contributions[*index], weight, kind, point) {
                    Ok(sent) => sent,
                    Err(end) => {
                        if let Some(inspector) = &mut self.inspector {
                            inspector.ended(kind.kind(), end);
                        }
                        continue;
                    }
                };
            if let Some(inspector) = &mut self.inspector {
                inspector.begin(kind.kind(), ray, depth, contribution, weight);
            }
            next.rays.push(ray);
            next.left.push(point.left_by(ray.direction));
            next.contributions.push(contribution);
            next.senders.push((*index, weight));
        }
        match kind {
            Secondary::Reflected => self.stats.reflected_rays += next.rays.len() as u64,
            Secondary::Refracted => self.stats.refracted_rays += next.rays.len() as u64,
        }
        if !next.rays.is_empty() {
            self.listen(|recorder| recorder.open(next.senders.iter().map(|(sender, _)| *sender)));
            self.trace(&mut next, depth);
            self.listen(Recorder::close);
            for (&(sender, weight), &color) in next.senders.iter().zip(&next.colors) {
                stream.colors[sender] += weight * color;
                self.listen(|recorder| recorder.adds(sender, kind.part(), weight * color));
                if let Some(inspector) = &mut self.inspector {
                    inspector.finish(color);
                }
            }
        }
        self.streams.push(next);
    }

    /// A secondary ray and its contribution, where that is worth tracing: its largest channel is above 0 and not
    /// below the threshold.
    #[inline]
    fn secondary_ray(
        &self,
        contribution: Vec3,
        weight: Vec3,
        kind: Secondary,
        point: &ShadePoint<'_>,
    ) -> Result<(Ray, Vec3), End> {
        let product = contribution * weight;
        let largest = product.max_element();
        // Weights near the end of f64's range: infinite times nothing is not a number.
        if largest <= 0.0 || largest.is_nan() {
            return Err(End::NoWeight);
        }
        if largest < self.options.threshold {
            return Err(End::Threshold { largest });
        }
        let ray = match kind {
            Secondary::Reflected => Some(point.reflected_ray()),
            Secondary::Refracted => point.refracted_ray(),
        };
        ray.map(|ray| (ray, product)).ok_or(End::TotalReflection)
    }
}

/// The square of the angle up to which neighbours run alike, found by measurement.
const ALIKE: f64 = 1e-3;

/// Whether most rays run in nearly the same direction as the one before: those that flat surfaces mirror do, those
/// that curved ones mirror do not.
fn run_alike(rays: &[Ray]) -> bool {
    let alike = |pair: &&[Ray]| (pair[0].direction - pair[1].direction).length_squared() < ALIKE;
    4 * rays.windows(2).filter(alike).count() >= 3 * rays.len()
}

/// How many rays may travel together where so many have had so many tests between two looks at the observer.
fn fitting(rays: usize, tests: u64) -> usize {
    let fitting = rays as u64 * TESTS / tests.max(1);
    usize::try_from(fitting).unwrap_or(STREAM).clamp(FIRST, STREAM)
}

fn count(stats: &mut Stats, tests: &[Tests]) {
    for test in tests {
        stats.box_tests += test.boxes;
        stats.shape_tests += test.shapes;
    }
}
