//! `dotray plan`: work for many machines, cut into pieces.

use dotray::image::Format;
use dotray::image::write_file;
use dotray::render::Antialias;
use dotray::render::LayerFilm;
use dotray::render::Options;
use dotray::render::Picture;
use dotray::render::Silent;
use dotray::render::Tile;
use dotray::render::World;
use dotray::render::layers::options_of;
use std::time::Instant;

use crate::exit::Failure;
use crate::exit::put;
use crate::interrupt;
use crate::keyframes::Animation;
use crate::many_args::PlanArgs;
use crate::meaning::Place;
use crate::messages::Messages;
use crate::output;
use crate::pieces::FORMAT;
use crate::pieces::PiecePlan;
use crate::pieces::cut;
use crate::pieces::words_of;
use crate::plan::Plan;
use crate::plan::plan;
use crate::stage::Stage;
use crate::storage;
use crate::values::FormatName;
use crate::values::When;

/// The edge of the squares of which the coarse look traces one ray.
const STEP: u32 = 16;
/// Frames that are looked at; those between them cost as much as the nearest one.
const LOOKS: usize = 9;
/// More tiles in all would take long to cut.
const MOST_TILES: u64 = 200_000_000;

/// Looks at the picture coarsely and writes the plan.
pub fn run(typed: &PlanArgs, color: When) -> Result<(), Failure> {
    let Some(path) = typed.render.output_option.clone().or(typed.render.output.clone()) else {
        return Err(Failure::Usage("no plan given: dotray plan SCENE -o PLAN --pieces N".to_owned()));
    };
    let render = crate::render_args::RenderArgs {
        // The plan's name says nothing of the pictures' format.
        format: Some(if Format::Png.is_built() { FormatName::Png } else { FormatName::Bmp }),
        ..typed.render.clone()
    };
    let plan = plan(&render)?;
    check(&plan)?;
    let Place::File(scene) = &plan.input else {
        return Err(Failure::Usage(
            "a plan needs a scene with a name: others will have to read it".to_owned(),
        ));
    };
    output::check(&Place::File(path.clone()), &plan.input)?;
    interrupt::watch();
    let (animation, text) = match &typed.animation {
        Some(path) => Animation::read(path).map(|(animation, text)| (animation, Some(text)))?,
        None => (Animation::default(), None),
    };
    let messages = Messages::new(color, plan.quiet);
    // They are files of the merge; nothing is written beside the plan.
    let bare = Plan { layers: Vec::new(), ..plan.clone() };
    let mut stage = Stage::new(&bare, &render, messages, animation)?;
    let fingerprint = stage.fingerprint(&plan, text.as_deref())?;
    let frames: Vec<Option<u32>> = match typed.frames {
        Some(range) => (range.first..=range.last).map(Some).collect(),
        None => vec![None],
    };
    let looks = looks(&mut stage, &plan, &frames)?;
    let costs: Vec<&[f64]> = (0..frames.len())
        .map(|index| {
            let nearest = looks.costs.iter().min_by_key(|(at, _)| at.abs_diff(index));
            nearest.map_or(&[][..], |(_, costs)| costs)
        })
        .collect();
    let tiles = costs.first().map_or(0, |costs| costs.len());
    if tiles as u64 * frames.len() as u64 > MOST_TILES {
        return Err(Failure::Usage(format!(
            "{} frames of {tiles} tiles are too many for one plan; take fewer frames or a larger --tile-size",
            frames.len()
        )));
    }
    let made = PiecePlan {
        dotray_plan: FORMAT,
        scene: scene.to_string_lossy().into_owned(),
        options: words_of(&plan, &render),
        animation: typed.animation.as_ref().map(|path| path.to_string_lossy().into_owned()),
        tiles: tiles as u32,
        fingerprint: fingerprint.entries().to_vec(),
        pieces: cut(&frames, &costs, typed.pieces),
    };
    let text = serde_json::to_string_pretty(&made)
        .map_err(|error| Failure::Failed(format!("cannot write the plan: {error}")))?;
    write_file(&path, (text + "\n").as_bytes()).map_err(|error| Failure::Failed(error.to_string()))?;
    if plan.quiet {
        return Ok(());
    }
    put(said(&made, looks.seconds * frames.len() as f64).as_bytes())
}

/// What is said about a plan whose pieces take so many seconds together.
fn said(made: &PiecePlan, seconds: f64) -> String {
    let pieces = made.pieces.len();
    let full = made.pieces.iter().filter(|piece| !piece.parts.is_empty()).count();
    let seconds = seconds / full.max(1) as f64;
    let empty = if full < pieces { format!(", of which {} are empty", pieces - full) } else { String::new() };
    let last = pieces.saturating_sub(1);
    format!("{pieces} pieces, 0 to {last}{empty}; about {seconds:.1} s of one core each\n")
}

/// Refuses what pieces cannot have.
fn check(plan: &Plan) -> Result<(), Failure> {
    let refused = [
        (plan.long.checkpoint.is_some(), "--checkpoint"),
        (plan.long.partial_every.is_some(), "--partial-every"),
        (plan.long.time_limit.is_some(), "--time-limit"),
    ];
    match refused.into_iter().find(|(typed, _)| *typed) {
        Some((_, option)) => {
            Err(Failure::Usage(format!("{option} goes with `dotray render`, not with pieces")))
        }
        None => Ok(()),
    }
}

/// What the coarse looks found.
struct Looks {
    /// Places in the list of frames, each with the costs of its tiles.
    costs: Vec<(usize, Vec<f64>)>,
    /// About the seconds that one picture takes on one core.
    seconds: f64,
}

fn looks(stage: &mut Stage<'_>, plan: &Plan, frames: &[Option<u32>]) -> Result<Looks, Failure> {
    let last = frames.len() - 1;
    let mut places: Vec<usize> = (0..LOOKS).map(|k| k * last / (LOOKS - 1)).collect();
    places.dedup();
    let mut looks = Looks { costs: Vec::new(), seconds: 0.0 };
    for &place in &places {
        interrupt::check()?;
        let frame = frames.get(place).copied().flatten();
        let set = stage.set(frame.unwrap_or(0))?;
        let look = look(set.world, &plan.options)?;
        let samples = storage::samples_a_pixel(&plan.options);
        let mut costs: Vec<f64> = look.tiles.iter().map(|(_, cost)| cost * samples).collect();
        let mut seconds = look.seconds * samples;
        if !plan.layers.is_empty() {
            let options = Options { antialias: Antialias::None, ..options_of(&plan.layers, &plan.options) };
            let look = self::look(set.world, &options)?;
            let layers = LayerFilm::new(&plan.options, &plan.layers)?;
            costs.extend(layers.bands().iter().map(|band| of_band(band, &look.tiles)));
            seconds += look.seconds;
        }
        looks.seconds += seconds / places.len() as f64;
        looks.costs.push((place, costs));
    }
    Ok(looks)
}

/// What a look at a picture found, one ray a pixel.
struct Look {
    /// The tiles, each with its cost.
    tiles: Vec<(Tile, f64)>,
    /// About the seconds that all of them take on one core.
    seconds: f64,
}

/// Looks at every tile of a picture.
fn look(world: &World, options: &Options) -> Result<Look, Failure> {
    let picture = Picture::new(world, options)?;
    let start = Instant::now();
    let mut tiles = Vec::with_capacity(picture.tiles().len());
    let (mut looked, mut pixels) = (0, 0);
    for tile in picture.tiles() {
        let look = picture.preview(tile, STEP, &Silent);
        // Nobody is asked whether to go on in the midst of a look.
        let counts = look.map(|look| look.counts).unwrap_or_default();
        // A ray by itself costs about as much as some tests of boxes, a shape's test as much as a few.
        let cost = 20.0 * counts.rays() as f64 + counts.box_tests as f64 + 4.0 * counts.shape_tests as f64;
        tiles.push((*tile, cost * tile.pixels() as f64 / counts.eye_rays.max(1) as f64));
        looked += counts.eye_rays;
        pixels += tile.pixels();
    }
    let seconds = start.elapsed().as_secs_f64() / looked.max(1) as f64 * pixels as f64;
    Ok(Look { tiles, seconds })
}

/// The cost of a band: of each tile the share that lies in it.
fn of_band(band: &Tile, tiles: &[(Tile, f64)]) -> f64 {
    let share = |(tile, cost): &(Tile, f64)| {
        let rows = (tile.y + tile.height).min(band.y + band.height).saturating_sub(tile.y.max(band.y));
        cost * f64::from(rows) / f64::from(tile.height.max(1))
    };
    tiles.iter().map(share).sum()
}
