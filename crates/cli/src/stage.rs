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
use std::time::Instant;

use crate::exit::Failure;
use crate::extras::Extras;
use crate::groups::find;
use crate::groups::groups_of;
use crate::input;
use crate::input::TimedDisk;
use crate::input::Written;
use crate::keyframes::Animation;
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
    /// The numbers of the groups that move, in the order of the animation.
    moving: Vec<u32>,
    scene: Scene,
    sources: Sources,
    disk: TimedDisk,
    /// The scene's camera, where the animation says nothing.
    camera: Camera,
    /// What was decoded for the fingerprint and no world has yet.
    textures: Option<Textures>,
    world: Option<World>,
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
    pub extras: Extras,
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
        let outcome = resolve_within(scene.clone(), &limits::resolve_limits(&typed.reading.limits));
        let mut diagnostics = warnings;
        diagnostics.extend(outcome.diagnostics);
        messages.print(&diagnostics, &sources);
        let resolved = outcome.resolved.ok_or(Failure::Reported)?;
        let groups = groups_of(&scene, &sources);
        let moving: Result<Vec<u32>, String> =
            animation.groups.iter().map(|group| find(&groups, &group.group)).collect();
        let moving = moving.map_err(Failure::Failed)?;
        let (camera, pace) = (resolved.camera, Pace::default());
        let (textures, world) = (None, None);
        Ok(Self {
            plan,
            typed,
            messages,
            animation,
            moving,
            scene,
            sources,
            disk,
            camera,
            textures,
            world,
            pace,
        })
    }

    /// The scene of a frame.
    pub fn resolved(&self, frame: u32) -> Result<Resolved, Failure> {
        let mut scene = self.scene.clone();
        for (path, &number) in self.animation.groups.iter().zip(&self.moving) {
            let main = scene.files.first_mut();
            if let Some(group) = main.and_then(|file| file.groups.get_mut(number as usize)) {
                group.value *= path.at(frame);
            }
        }
        let outcome = resolve_within(scene, &limits::resolve_limits(&self.typed.reading.limits));
        let Some(mut resolved) = outcome.resolved else {
            self.messages.print(&outcome.diagnostics, &self.sources);
            return Err(Failure::Failed(format!("frame {frame} cannot be made")));
        };
        resolved.camera = self.camera_of(frame)?;
        if self.typed.missing_texture == MissingTexture::White {
            // Told once, with the first frame.
            input::whiten(&mut resolved, &self.disk, self.plan.quiet || self.world.is_some());
        }
        Ok(resolved)
    }

    /// What pictures of the scene depend on, where nothing has moved.
    pub fn fingerprint(&mut self) -> Result<Fingerprint, Failure> {
        let outcome = resolve_within(self.scene.clone(), &limits::resolve_limits(&self.typed.reading.limits));
        let mut resolved = outcome.resolved.ok_or(Failure::Reported)?;
        if self.typed.missing_texture == MissingTexture::White {
            input::whiten(&mut resolved, &self.disk, true);
        }
        Extras::new(self.plan, &mut resolved, &self.sources)?;
        let textures = self.load_textures(&resolved)?;
        let fingerprint = Fingerprint::of(&resolved, &textures, &self.plan.options);
        self.textures = Some(textures);
        Ok(fingerprint)
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
        let mut resolved = self.resolved(frame)?;
        let extras = Extras::new(self.plan, &mut resolved, &self.sources)?;
        let refused = |faults: Vec<_>| {
            self.messages.print(&faults, &Sources::default());
            Failure::Reported
        };
        let world = match self.world.take() {
            None => {
                limits::check(
                    &resolved,
                    &self.plan.prepare,
                    Some(&self.plan.options),
                    &self.typed.reading.limits,
                )?;
                let textures = match self.textures.take() {
                    Some(textures) => textures,
                    None => self.load_textures(&resolved)?,
                };
                World::build(resolved, textures, &self.plan.prepare).map_err(refused)?
            }
            Some(mut world) if self.moving.is_empty() => {
                world.set_camera(resolved.camera);
                world
            }
            Some(world) => {
                let refit = !self.pace.rebuilds();
                world.moved(resolved, &self.plan.prepare, refit).map_err(refused)?
            }
        };
        self.pace.prepared(world.seconds());
        for (stage, seconds) in world.seconds() {
            tracing::debug!(frame, stage, seconds, "prepared");
        }
        tracing::debug!(frame, seconds = start.elapsed().as_secs_f64(), "ready");
        Ok(Set { world: self.world.insert(world), extras })
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
