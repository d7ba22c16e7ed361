//! Rays against shapes, without a picture: what a program needs that casts rays of its own.

use crate::bake::world_bounds;
use crate::options::PrepareOptions;
use crate::query::Crossing;
use crate::query::Nearest;
use crate::query::NearestBatch;
use crate::query::NearestBuffers;
use crate::query::ShadowBatch;
use crate::query::ShadowBuffers;
use crate::query::UNBLOCKED;
use crate::shapes::Shapes;
use crate::shapes::WorldSurface;
use crate::stretch::Stretches;
use dotray_accel::Accelerator;
use dotray_accel::Boxes;
use dotray_accel::GroupEvent;
use dotray_accel::Kind;
use dotray_accel::Level;
use dotray_accel::Queries;
use dotray_accel::Settings;
use dotray_accel::simd::level;
use dotray_geometry::Aabb;
use dotray_geometry::Affine;
use dotray_geometry::Ray;
use dotray_scene::Resolved;
use dotray_scene::model::SceneFile;
use dotray_scene::resolved::Run;
use dotray_scene::resolved::TreeEvent;
use web_time::Instant;

/// Baked shapes and the accelerator over them.
///
/// ```
/// use dotray_accel::{ENDLESS, Queries};
/// use dotray_geometry::{Ray, Vec3};
/// use dotray_render::{Caster, PrepareOptions};
/// use dotray_scene::{files, load, resolve};
///
/// let text = "#camera 0 0 0 0 0 -1 0 1 0 0.5\n#shape_sphere -1 0 0 -5 1";
/// let options = load::LoadOptions::default();
/// let scene = load::load_text("one.ray", text, &files::Disk, &options).scene.expect("a scene");
/// let resolved = resolve::resolve(scene).resolved.expect("resolved");
/// let caster = Caster::build(resolved, &PrepareOptions::default());
/// let rays = [Ray::new(Vec3::ZERO, Vec3::NEG_Z), Ray::new(Vec3::ZERO, Vec3::Z)];
/// let found = caster.nearest(&Queries { rays: &rays, t_min: &[0.0], t_max: ENDLESS }, true);
/// assert_eq!(found.iter().map(|nearest| nearest.map(|n| n.hit.t)).collect::<Vec<_>>(), [Some(4.0), None]);
/// ```
#[derive(Debug)]
pub struct Caster {
    pub(crate) shapes: Shapes,
    pub(crate) accelerator: Accelerator,
    seconds: Vec<(&'static str, f64)>,
    level: Level,
}

/// The shapes' boxes in the world, by shape number.
struct ShapeBoxes<'a> {
    stretches: &'a Stretches,
    frames: &'a [Affine],
    files: &'a [SceneFile],
    count: u32,
}

impl Boxes for ShapeBoxes<'_> {
    fn len(&self) -> u32 {
        self.count
    }

    fn bounds(&self, item: u32) -> Aabb {
        let stretch = &self.stretches.list()[self.stretches.find(item)];
        world_bounds(stretch, self.frames, self.files, item)
    }
}

impl Caster {
    /// Builds the accelerator over a scene's shapes and bakes them; the scene's lights, textures and camera are not
    /// asked for.
    ///
    /// # Panics
    /// Where there are more than [`dotray_accel::MAX_ITEMS`] shapes.
    pub fn build(resolved: Resolved, options: &PrepareOptions) -> Self {
        let default_material = resolved.default_material();
        Self::with_default(resolved, default_material, options, None)
    }

    /// The same, where the materials have been taken out of the scene. The accelerator of a former caster over the same
    /// shapes, which may stand elsewhere now, is fitted to them instead of building a new one.
    pub(crate) fn with_default(
        resolved: Resolved,
        default_material: u32,
        options: &PrepareOptions,
        former: Option<Self>,
    ) -> Self {
        // Threads that cannot be had are no reason to fail: the common ones build the same tree.
        let pool = options.threads.and_then(|n| rayon::ThreadPoolBuilder::new().num_threads(n).build().ok());
        let build = || Self::build_here(resolved, default_material, options, former);
        match pool {
            Some(pool) => pool.install(build),
            None => build(),
        }
    }

    /// The same on the threads of the pool it is called in.
    fn build_here(
        resolved: Resolved,
        default_material: u32,
        options: &PrepareOptions,
        former: Option<Self>,
    ) -> Self {
        let start = Instant::now();
        let stretches = Stretches::new(&resolved.runs, resolved.frames.len(), resolved.shape_count);
        let boxes = ShapeBoxes {
            stretches: &stretches,
            frames: &resolved.frames,
            files: &resolved.files,
            count: resolved.shape_count,
        };
        let (stage, (accelerator, numbers)) =
            match former.and_then(|former| former.refitted(&boxes, options.accel)) {
                Some(refitted) => ("refit", refitted),
                None => {
                    let groups = group_events(&resolved);
                    let settings = Settings { quality: options.quality };
                    let built = Accelerator::build(options.accel, &boxes, &groups, &settings);
                    let numbers = built.order.unwrap_or_else(|| (0..resolved.shape_count).collect());
                    ("build", (built.accelerator, numbers))
                }
            };
        let mut seconds = vec![(stage, start.elapsed().as_secs_f64())];

        let start = Instant::now();
        let material = |run: &Run, written: i32| run.material(written).unwrap_or(default_material);
        let Resolved { frames, files, runs, tree, .. } = resolved;
        // Neither says more than the stretches do.
        drop((runs, tree));
        let shapes = Shapes::bake_stretches(stretches, frames, files, &numbers, Some(&accelerator), material);
        seconds.push(("bake", start.elapsed().as_secs_f64()));
        Self { shapes, accelerator, seconds, level: level() }
    }

    /// The accelerator fitted to boxes that have moved, with the shape number at each position; `None` where it is of
    /// another kind, over another number of shapes, or one that cannot be fitted.
    fn refitted(self, boxes: &ShapeBoxes<'_>, kind: Kind) -> Option<(Accelerator, Vec<u32>)> {
        let Self { shapes, mut accelerator, .. } = self;
        let numbers = shapes.into_numbers();
        let same = accelerator.kind() == kind && numbers.len() == boxes.len() as usize;
        (same && accelerator.refit(boxes, Some(&numbers))).then_some((accelerator, numbers))
    }

    /// What each ray meets first. `together` says that successive rays start and run alike (eye rays of neighbouring
    /// pixels, shadow rays to one light): they then share most of the work. The answers are the same.
    pub fn nearest(&self, queries: &Queries<'_>, together: bool) -> Vec<Option<Nearest>> {
        let mut buffers = NearestBuffers::default();
        let mut batch = NearestBatch::new(&self.shapes, *queries, &mut buffers);
        self.accelerator.walk_rays(self.level, queries, &mut batch, together);
        buffers.found
    }

    /// Whether anything lies on each ray; `together` as for [`Caster::nearest`].
    pub fn occluded(&self, queries: &Queries<'_>, together: bool) -> Vec<bool> {
        let mut buffers = ShadowBuffers::default();
        let mut batch = ShadowBatch::new(&self.shapes, *queries, &|_| false, &mut buffers);
        self.accelerator.walk_rays(self.level, queries, &mut batch, together);
        buffers.blockers.iter().map(|&blocker| blocker != UNBLOCKED).collect()
    }

    /// Every surface that each ray crosses between its bounds, ray by ray and nearest first: a ray enters a sphere and
    /// leaves it.
    pub fn crossings(&self, queries: &Queries<'_>, together: bool) -> Vec<Crossing> {
        let mut buffers = ShadowBuffers::default();
        // To a shadow ray for which everything is see-through nothing is hidden.
        let mut batch = ShadowBatch::new(&self.shapes, *queries, &|_| true, &mut buffers);
        self.accelerator.walk_rays(self.level, queries, &mut batch, together);
        batch.finish();
        buffers.crossings
    }

    /// The shapes alone.
    pub(crate) fn into_shapes(self) -> Shapes {
        self.shapes
    }

    /// The surface that `ray` met at `nearest`.
    pub fn surface(&self, ray: &Ray, nearest: &Nearest) -> WorldSurface {
        self.shapes.surface(nearest.position, ray, nearest.hit)
    }

    /// How many shapes there are, instances counted as often as they stand.
    pub fn shape_count(&self) -> usize {
        self.shapes.len()
    }

    /// The box around all shapes; empty without any.
    pub fn bounds(&self) -> Aabb {
        self.accelerator.bounds()
    }

    /// The accelerator's boxes (or cells), level by level: the first `most` of them.
    pub fn accelerator_cells(&self, most: usize) -> Vec<dotray_accel::Cell> {
        self.accelerator.cells(most)
    }

    /// The accelerator's figures; this looks at every node.
    pub fn accelerator_stats(&self) -> dotray_accel::Stats {
        self.accelerator.stats()
    }

    /// The bytes of shapes and accelerator.
    pub fn memory(&self) -> u64 {
        let (baked, written) = self.shapes.memory();
        baked + written + self.accelerator.memory() as u64
    }

    /// What building took, by stage.
    pub fn seconds(&self) -> &[(&'static str, f64)] {
        &self.seconds
    }
}

fn group_events(resolved: &Resolved) -> Vec<GroupEvent> {
    let event = |event: &TreeEvent| match *event {
        TreeEvent::Open => GroupEvent::Open,
        TreeEvent::Close => GroupEvent::Close,
        TreeEvent::Run(index) => {
            let run = &resolved.runs[index as usize];
            GroupEvent::Items { first: run.first_shape, count: run.count }
        }
    };
    resolved.tree.iter().map(event).collect()
}
