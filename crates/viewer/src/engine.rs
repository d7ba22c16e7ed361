//! The tracer behind the screen: one picture at a time, from coarse to fine, in short portions. Whatever comes in
//! between (a newer camera, a question about a pixel) interrupts a portion and is answered at once.
//!
//! It is a state machine without threads of its own: a window lets it run on a thread, a page in slices of time.

mod interrupt;

mod job;

mod errand;

use crate::hidden::Hidden;
use crate::hidden::without;
use crate::hidden::without_shapes;
use crate::rays::RayRow;
use crate::rays::rows;
use dotray_accel::Queries;
use dotray_accel::simd::level;
use dotray_geometry::Ray;
use dotray_geometry::Vec3;
use dotray_image::Image;
use dotray_render::Crop;
use dotray_render::Options;
use dotray_render::PrepareOptions;
use dotray_render::TilePixels;
use dotray_render::World;
use dotray_render::camera::Camera;
use dotray_render::progress::Advance;
use dotray_render::trace::Tracer;
use dotray_scene::Resolved;
use dotray_scene::model;
use errand::Errand;
use interrupt::Interrupt;
use job::Job;
pub use job::PORTION;
use serde::Deserialize;
use serde::Serialize;
use std::ops::Range;
use std::sync::Arc;
use std::sync::atomic::AtomicBool;
use std::time::Duration;
use web_time::Instant;

/// What is to be traced.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Request {
    /// Told apart from other requests by this number, which rises.
    pub serial: u64,
    /// From where.
    pub camera: model::Camera,
    /// The size, the part and the quality.
    pub options: Options,
}

/// What the engine is told.
#[derive(Debug)]
pub enum Command {
    /// Another scene; the picture under way is dropped.
    World(Option<Box<World>>),
    /// What the world was built of besides its shapes, and how: without it no shape can be left out.
    Rest(Box<Resolved>, PrepareOptions),
    /// Other lights, materials and background of the same scene.
    Style(Box<Resolved>),
    /// These shapes are not traced; those that were left out before are again. The picture under way is dropped.
    Hide(Hidden),
    /// Traces a picture; the one under way is dropped.
    Draw(Box<Request>),
    /// Drops the picture under way.
    Stop,
    /// What lies under a place of the picture: pixels from the lower left.
    Look(Box<Request>, f64, f64),
    /// All rays of a place of the picture.
    Inspect(Box<Request>, f64, f64),
    /// Traces tiles of a picture that is put together elsewhere.
    Help(Box<Share>),
}

/// Tiles of a picture for another tracer of the same world.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Share {
    /// The picture's request.
    pub request: Request,
    /// How many of the coarse looks were done.
    pub looks: usize,
    /// The numbers of the tiles.
    pub tiles: Vec<u32>,
}

/// Tiles that another tracer has traced.
#[derive(Clone, Debug, PartialEq)]
pub struct Part {
    /// Of which request.
    pub serial: u64,
    /// How many of the coarse looks were done.
    pub looks: usize,
    /// The tiles.
    pub tiles: Vec<TilePixels>,
    /// Whether these are the last ones of their share.
    pub ended: bool,
}

/// What the engine tells.
#[derive(Clone, Debug)]
pub enum Reply {
    /// The window's pixels as far as they are known: red, green, blue, alpha, upper row first.
    Picture {
        /// Whose.
        serial: u64,
        /// Columns and rows of the window.
        size: [usize; 2],
        /// The pixels; alpha 0 where nothing is known yet.
        pixels: Arc<Vec<u8>>,
        /// How far it has come since the request came: the record `progress` of docs/progress.md.
        progress: Advance,
        /// The finished picture.
        image: Option<Arc<Image>>,
    },
    /// What lies under a place.
    Seen(Option<Seen>),
    /// The rays of a place, the eye ray first.
    Rays(Arc<Vec<RayRow>>),
    /// The request makes no sense; the sentence says why.
    Refused(String),
    /// Tiles of a picture that is put together elsewhere.
    Part(Box<Part>),
}

/// What lies under a place of the picture.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Seen {
    /// The shape.
    pub number: u32,
    /// Its material's number in the resolved scene.
    pub material: u32,
    /// The point.
    pub point: Vec3,
    /// How far it is.
    pub distance: f64,
}

/// How often a picture under way is shown: often while it is young, and then ever more seldom, for whoever draws it
/// wants the time that traces it, and hears of nothing else meanwhile.
const SHOWN_EVERY: Range<Duration> = Duration::from_millis(40)..Duration::from_millis(400);

/// What the world is built anew of where shapes are left out.
#[derive(Debug)]
struct Whole {
    /// Without shapes, as long as the world has all of them; else with all.
    resolved: Box<Resolved>,
    prepare: PrepareOptions,
}

/// See the module.
#[derive(Debug, Default)]
pub struct Engine {
    world: Option<Box<World>>,
    whole: Option<Whole>,
    /// The lights, materials and background that came last.
    style: Option<Box<Resolved>>,
    /// What is not to be traced, and what the world was built without.
    hidden: Hidden,
    left_out: Hidden,
    job: Option<Box<Job>>,
    errand: Option<Box<Errand>>,
    interrupt: Arc<AtomicBool>,
    ask: Option<fn() -> bool>,
}

impl Engine {
    /// Whether there is more to trace.
    pub fn is_busy(&self) -> bool {
        self.job.is_some() || self.errand.is_some()
    }

    /// Who is asked every now and then whether to stop, where no other thread can [interrupt](Engine::interrupt).
    pub fn ask_whether_to_stop(&mut self, ask: fn() -> bool) {
        self.ask = Some(ask);
    }

    /// As long as this is set, tracing stops between two bounces of a ray; a tile that was not finished comes again.
    pub fn interrupt(&self) -> Arc<AtomicBool> {
        self.interrupt.clone()
    }

    /// Takes a command.
    pub fn handle(&mut self, command: Command) -> Vec<Reply> {
        match command {
            Command::World(world) => {
                self.drop_work();
                (self.world, self.whole, self.style) = (world, None, None);
                (self.hidden, self.left_out) = Default::default();
                Vec::new()
            }
            Command::Rest(resolved, prepare) => {
                self.whole = Some(Whole { resolved, prepare });
                Vec::new()
            }
            Command::Style(resolved) => {
                self.drop_work();
                if let Some(world) = &mut self.world {
                    world.restyle(&resolved);
                }
                self.style = Some(resolved);
                Vec::new()
            }
            Command::Hide(hidden) => {
                self.drop_work();
                self.hidden = hidden;
                Vec::new()
            }
            Command::Draw(request) => self.draw(*request).into_iter().collect(),
            Command::Stop => {
                self.drop_work();
                Vec::new()
            }
            Command::Look(request, x, y) => vec![Reply::Seen(self.look(&request, x, y))],
            Command::Inspect(request, x, y) => self.inspect(&request, x, y).into_iter().collect(),
            Command::Help(share) => {
                self.help(*share);
                Vec::new()
            }
        }
    }

    fn drop_work(&mut self) {
        (self.job, self.errand) = (None, None);
    }

    /// Builds the world without what is hidden, once somebody wants to see it: many may be hidden one by one.
    fn leave_out(&mut self) {
        if self.left_out == self.hidden || self.whole.is_none() || self.world.is_none() {
            return;
        }
        let Some((mut whole, world)) = self.whole.take().zip(self.world.take()) else { return };
        // The shapes are kept once: by the world that has all of them, or else beside the one that lacks some.
        let world = if self.left_out.is_empty() {
            let (resolved, textures) = world.take_apart(*whole.resolved);
            *whole.resolved = resolved;
            World::build(without(&whole.resolved, &self.hidden), textures, &whole.prepare)
        } else if self.hidden.is_empty() {
            let rest = without_shapes(&whole.resolved);
            let all = std::mem::replace(&mut *whole.resolved, rest);
            world.moved(all, &whole.prepare, false)
        } else {
            world.moved(without(&whole.resolved, &self.hidden), &whole.prepare, false)
        };
        // As many shapes as before, or fewer, are never too many.
        self.world = world.ok().map(Box::new);
        self.whole = Some(whole);
        if let Some((world, style)) = self.world.as_mut().zip(self.style.as_ref()) {
            world.restyle(style);
        }
        self.left_out = self.hidden.clone();
    }

    fn draw(&mut self, request: Request) -> Option<Reply> {
        self.drop_work();
        self.leave_out();
        let world = self.world.as_deref_mut()?;
        world.set_camera(request.camera);
        match Job::new(world, request) {
            Ok(job) => {
                self.job = Some(Box::new(job));
                None
            }
            Err(error) => Some(Reply::Refused(error.to_string())),
        }
    }

    fn help(&mut self, share: Share) {
        let Share { request, looks, tiles } = share;
        if self.errand.as_ref().is_none_or(|errand| errand.request != request) {
            self.leave_out();
            let Some(world) = self.world.as_deref_mut() else { return };
            world.set_camera(request.camera);
            // Whoever shares a picture has seen that there can be one.
            self.errand = Errand::new(world, request).ok().map(Box::new);
        }
        if let Some(errand) = &mut self.errand {
            errand.take(looks, &tiles);
        }
    }

    /// So many tiles for another tracer of the same world; `None` where nothing is left to give away.
    pub fn lend(&mut self, count: usize) -> Option<Share> {
        self.job.as_deref_mut()?.lend(count)
    }

    /// Takes tiles that another has traced; answers where there is something new to show.
    pub fn accept(&mut self, part: &Part) -> Option<Reply> {
        let job = self.job.as_deref_mut()?;
        let any = job.accept(part);
        self.shown(any)
    }

    /// Traces one portion; answers where there is something new to show.
    pub fn advance(&mut self) -> Option<Reply> {
        let interrupt = Interrupt::new(&self.interrupt, self.ask);
        let world = self.world.as_deref()?;
        if let Some(errand) = self.errand.as_deref_mut() {
            let part = errand.portion(world, &interrupt);
            if errand.is_done() {
                self.errand = None;
            }
            return part.map(|part| Reply::Part(Box::new(part)));
        }
        let any = self.job.as_deref_mut()?.portion(world, &interrupt);
        self.shown(any)
    }

    /// The picture under way, where it is time to show it.
    fn shown(&mut self, any: bool) -> Option<Reply> {
        let job = self.job.as_deref_mut()?;
        let now = Instant::now();
        let pause = (now.duration_since(job.begun) / 3).clamp(SHOWN_EVERY.start, SHOWN_EVERY.end);
        let due = job.last_shown.is_none_or(|last| now.duration_since(last) >= pause);
        let complete = job.film.is_complete();
        let reply = (complete || any && due).then(|| job.reply(now));
        if complete {
            self.job = None;
        }
        reply
    }

    fn look(&mut self, request: &Request, x: f64, y: f64) -> Option<Seen> {
        self.leave_out();
        let world = self.world.as_deref()?;
        let ray = camera_of(request).ray(x, y);
        let nearest = nearest(world, ray)?;
        let surface = world.caster().surface(&ray, &nearest);
        // The tracer itself knows which material a shape has.
        let options = Options { recursion: 0, ..request.options.clone() };
        let node = Tracer::new(world, &options, level()).inspect(ray)?;
        let material = node.meeting.map(|met| met.material)?;
        let number = self.left_out.number_of_shown(nearest.number);
        Some(Seen { number, material, point: surface.point, distance: nearest.hit.t })
    }

    fn inspect(&mut self, request: &Request, x: f64, y: f64) -> Option<Reply> {
        self.leave_out();
        let world = self.world.as_deref()?;
        let interrupt = Interrupt::new(&self.interrupt, self.ask);
        let mut tracer = Tracer::new(world, &request.options, level()).watched_by(&interrupt);
        let Some(root) = tracer.inspect(camera_of(request).ray(x, y)) else {
            let what = "the view has moved before all rays of the pixel were followed: click it again";
            return Some(Reply::Refused(what.to_owned()));
        };
        let size = world.bounds().size().length();
        let mut rows = rows(&root, if size > 0.0 { 2.0 * size } else { 1.0 });
        for row in &mut rows {
            row.met = row.met.map(|(number, material)| (self.left_out.number_of_shown(number), material));
            for light in &mut row.lights {
                light.blocker = light.blocker.map(|number| self.left_out.number_of_shown(number));
            }
        }
        Some(Reply::Rays(Arc::new(rows)))
    }
}

fn camera_of(request: &Request) -> Camera {
    Camera::new(&request.camera, request.options.width, request.options.height)
}

fn nearest(world: &World, ray: Ray) -> Option<dotray_render::Nearest> {
    let queries = Queries { rays: &[ray], t_min: &[world.ray_eps()], t_max: dotray_accel::ENDLESS };
    world.caster().nearest(&queries, false).first().copied().flatten()
}

/// The whole pixels of a region; `None` where that is nothing.
pub fn whole_pixels([left, top, right, bottom]: [f64; 4], width: u32, height: u32) -> Option<Crop> {
    let at = |part: f64, size: u32| (part.clamp(0.0, 1.0) * f64::from(size)).round() as u32;
    let (x, y) = (at(left, width), at(top, height));
    let (right, bottom) = (at(right, width), at(bottom, height));
    (right > x && bottom > y).then(|| Crop { x, y, width: right - x, height: bottom - y })
}
