//! A scene that moves: its world, frame by frame.

use dotray::render::Fingerprint;
use dotray::render::Textures;
use dotray::render::World;
use dotray::render::on_threads;
use dotray::scene::Resolved;
use dotray::scene::Scene;
use dotray::scene::model::Camera;
use dotray::scene::resolve::resolve_within;
use dotray::scene::sources::Sources;
use std::sync::Arc;
use std::time::Instant;

use crate::background::Back;
use crate::exit::Failure;
use crate::extras::Extras;
use crate::extras::back;
use crate::groups::find;
use crate::groups::groups_of;
use crate::input;
use crate::input::TimedDisk;
use crate::input::Written;
use crate::keyframes::Animation;
use crate::layer_args::Overlay;
use crate::limits;
use crate::messages::Messages;
use crate::plan::Plan;
use crate::render_args::RenderArgs;
use crate::values::MissingTexture;

/// A scene on its way through the frames of an animation.
pub struct Stage<'a> {
    plan: &'a Plan,
    typed: &'a RenderArgs,
    messages: Messages,
    animation: Animation,
    /// The files and numbers of the groups that move, in the order of the animation.
    moving: Vec<(usize, u32)>,
    /// The scene, where groups move: each frame has one of its own.
    scene: Option<Scene>,
    /// The scene where nothing has moved, until a world is built of it.
    still: Option<Resolved>,
    /// Whether what was wrong with textures is told.
    told: bool,
    sources: Sources,
    disk: TimedDisk,
    /// What lies behind all pictures, read once.
    back: Option<Arc<Back>>,
    /// The scene's camera, where the animation says nothing.
    camera: Camera,
    /// What was decoded for the fingerprint and no world has yet.
    textures: Option<Textures>,
    world: Option<World>,
    extras: Option<Extras>,
    pace: Pace,
}

/// What was measured of building, fitting and tracing.
#[derive(Debug, Default)]
struct Pace {
    build_seconds: f64,
    refit_seconds: f64,
    /// Tests a ray right after the last build.
    fresh_tests: f64,
    /// Seconds that the last frame lost because its accelerator was fitted, not built.
    lost_seconds: f64,
    /// Whether the next trace is the first one after a build.
    fresh: bool,
}

impl Pace {
    /// Whether to build anew: where the last frame lost more by fitting than building costs beyond fitting.
    fn rebuilds(&self) -> bool {
        self.lost_seconds > self.build_seconds - self.refit_seconds
    }

    fn prepared(&mut self, stages: &[(&'static str, f64)]) {
        for (stage, seconds) in stages {
            match *stage {
                "build" => {
                    self.build_seconds = *seconds;
                    self.fresh = true;
                }
                "refit" => {
                    self.refit_seconds = *seconds;
                    self.fresh = false;
                }
                _ => {}
            }
        }
    }

    /// Tests a ray tell how good the tree is, whatever else the machine is doing.
    fn traced(&mut self, rays: u64, tests: u64, seconds: f64) {
        let tests = tests as f64 / rays.max(1) as f64;
        if self.fresh {
            (self.fresh_tests, self.lost_seconds) = (tests, 0.0);
        } else if tests > 0.0 {
            self.lost_seconds = seconds * (1.0 - self.fresh_tests / tests).max(0.0);
        }
    }
}

/// A frame, ready for tracing.
pub struct Set<'a> {
    /// Its world.
    pub world: &'a World,
    /// What lies behind and over it.
    pub extras: &'a Extras,
}

impl<'a> Stage<'a> {
    /// Reads the scene; messages about it are printed once.
    pub fn new(
        plan: &'a Plan,
        typed: &'a RenderArgs,
        messages: Messages,
        animation: Animation,
    ) -> Result<Self, Failure> {
        let Written { scene, warnings, sources, disk, .. } =
            on_threads(plan.options.threads, || input::read(&plan.input, &typed.reading, messages))??;
        let groups = if animation.groups.is_empty() { Vec::new() } else { groups_of(&scene, &sources) };
        let moves = !animation.groups.is_empty();
        let kept = moves.then(|| scene.clone());
        let outcome = resolve_within(scene, &limits::resolve_limits(&typed.reading.limits));
        let mut diagnostics = warnings;
        diagnostics.extend(outcome.diagnostics);
        messages.print(&diagnostics, &sources);
        let still = outcome.resolved.ok_or(Failure::Reported)?;
        let moving = animation.groups.iter().map(|group| find(&groups, &group.group));
        let moving = moving.collect::<Result<_, String>>().map_err(Failure::Failed)?;
        Ok(Self {
            plan,
            typed,
            messages,
            animation,
            moving,
            scene: kept,
            camera: still.camera,
            still: Some(still),
            told: false,
            sources,
            disk,
            back: back(plan)?,
            textures: None,
            world: None,
            extras: None,
            pace: Pace::default(),
        })
    }

    /// The scene of a frame, with what lies behind and over it.
    fn resolved(&mut self, frame: u32) -> Result<(Resolved, Extras), Failure> {
        let mut resolved = match &self.scene {
            Some(scene) => self.moved(scene.clone(), frame)?,
            // Made once: a world takes it, and after that only the camera moves.
            None => self.still.take().ok_or(Failure::Reported)?,
        };
        resolved.camera = self.camera_of(frame)?;
        let extras = self.complete(&mut resolved)?;
        Ok((resolved, extras))
    }

    /// The scene with its groups where they are at a frame.
    fn moved(&self, mut scene: Scene, frame: u32) -> Result<Resolved, Failure> {
        for (path, &(file, number)) in self.animation.groups.iter().zip(&self.moving) {
            let file = scene.files.get_mut(file);
            if let Some(group) = file.and_then(|file| file.groups.get_mut(number as usize)) {
                group.value *= path.at(frame);
            }
        }
        let outcome = resolve_within(scene, &limits::resolve_limits(&self.typed.reading.limits));
        outcome.resolved.ok_or_else(|| {
            self.messages.print(&outcome.diagnostics, &self.sources);
            Failure::Failed(format!("frame {frame} cannot be made"))
        })
    }

    /// Puts into a scene what options say of it.
    fn complete(&mut self, resolved: &mut Resolved) -> Result<Extras, Failure> {
        if self.typed.missing_texture == MissingTexture::White {
            input::whiten(resolved, &self.disk, self.plan.quiet || self.told);
            self.told = true;
        }
        Extras::new(self.plan, resolved, &self.sources, self.back.clone())
    }

    /// What pictures of the scene depend on, where nothing has moved, and what they all have besides: what `plan` says
    /// lies behind, beside and over them, and the text of an animation. Asked for before the first frame.
    pub fn fingerprint(&mut self, plan: &Plan, animation: Option<&str>) -> Result<Fingerprint, Failure> {
        let mut resolved = self.still.take().ok_or(Failure::Reported)?;
        let extras = self.complete(&mut resolved)?;
        let textures = self.load_textures(&resolved)?;
        let fingerprint = Fingerprint::of(&resolved, &textures, &self.plan.options);
        self.textures = Some(textures);
        self.still = Some(resolved);
        let fingerprint = extras.added_to(fingerprint, plan);
        Ok(match animation {
            Some(text) => fingerprint.with_hash_of("animation", text.as_bytes()),
            None => fingerprint,
        })
    }

    fn camera_of(&self, frame: u32) -> Result<Camera, Failure> {
        match &self.animation.camera {
            Some(path) => path.at(frame, &self.camera).map_err(Failure::Failed),
            None => Ok(self.camera),
        }
    }

    /// The textures that a scene asks for.
    fn load_textures(&self, resolved: &Resolved) -> Result<Textures, Failure> {
        Textures::load(resolved, &self.disk, &self.plan.prepare).map_err(|faults| {
            self.messages.print(&faults, &self.sources);
            Failure::Reported
        })
    }

    /// Makes a frame ready: another camera costs nothing; where groups move, the accelerator is fitted or built anew.
    pub fn set(&mut self, frame: u32) -> Result<Set<'_>, Failure> {
        let start = Instant::now();
        let world = match self.world.take() {
            Some(mut world) if self.moving.is_empty() => {
                world.set_camera(self.camera_of(frame)?);
                world
            }
            before => {
                let (resolved, extras) = self.resolved(frame)?;
                self.extras = Some(extras);
                self.built(before, resolved)?
            }
        };
        self.pace.prepared(world.seconds());
        for (stage, seconds) in world.seconds() {
            tracing::debug!(frame, stage, seconds, "prepared");
        }
        tracing::debug!(frame, seconds = start.elapsed().as_secs_f64(), "ready");
        let extras = self.extras.as_ref().ok_or(Failure::Reported)?;
        Ok(Set { world: self.world.insert(world), extras })
    }

    /// The world of a scene, made of the one before it where there is one.
    fn built(&mut self, before: Option<World>, resolved: Resolved) -> Result<World, Failure> {
        let world = if let Some(world) = before {
            // Where its boxes are seen, they must not depend on what was measured.
            let seen = self.plan.overlay == Some(Overlay::Accel);
            world.moved(resolved, &self.plan.prepare, !seen && !self.pace.rebuilds())
        } else {
            let limits = &self.typed.reading.limits;
            limits::check(&resolved, &self.plan.prepare, Some(&self.plan.options), limits)?;
            let textures = match self.textures.take() {
                Some(textures) => textures,
                None => self.load_textures(&resolved)?,
            };
            World::build(resolved, textures, &self.plan.prepare)
        };
        world.map_err(|faults| {
            self.messages.print(&faults, &Sources::default());
            Failure::Reported
        })
    }

    /// What a frame took, for the choice between fitting and building.
    pub fn traced(&mut self, rays: u64, tests: u64, seconds: f64) {
        self.pace.traced(rays, tests, seconds);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn fitting_goes_on_until_it_costs_more_than_building() {
        let mut pace = Pace::default();
        pace.prepared(&[("build", 2.0)]);
        pace.traced(100, 1000, 5.0);
        assert!(!pace.rebuilds());
        pace.prepared(&[("refit", 0.5)]);
        pace.traced(100, 1100, 5.5);
        assert!(!pace.rebuilds(), "half a second is lost, one and a half would be spent");
        pace.prepared(&[("refit", 0.5)]);
        pace.traced(100, 2000, 10.0);
        assert!(pace.rebuilds(), "five seconds are lost");
        pace.prepared(&[("build", 2.0)]);
        pace.traced(100, 1200, 6.0);
        assert!(!pace.rebuilds(), "a new tree is a new measure");
    }
}
