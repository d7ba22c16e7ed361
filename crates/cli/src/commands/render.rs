//! `dotray render`: from a scene to a picture.

use dotray::render::Fingerprint;
use dotray::render::Rendering;
use dotray::render::Stats;
use dotray::render::Textures;
use dotray::render::World;
use dotray::render::on_threads;
use dotray::scene::sources::Sources;
use std::time::Instant;

use crate::cost::Cost;
use crate::cost::Rays;
use crate::cost::Tests;
use crate::cost::memory;
use crate::events;
use crate::exit::Failure;
use crate::exit::put;
use crate::exit::say;
use crate::extras::Encoded;
use crate::extras::Extras;
use crate::extras::back;
use crate::extras::encoded;
use crate::input;
use crate::input::Understood;
use crate::input::understand;
use crate::interrupt;
use crate::keep::Keep;
use crate::limits;
use crate::long_args::ProgressName;
use crate::making::Made;
use crate::making::again;
use crate::making::make;
use crate::meaning::Place;
use crate::messages::Messages;
use crate::output;
use crate::plan::Plan;
use crate::plan::plan;
use crate::render_args::RenderArgs;
use crate::values::MissingTexture;
use crate::values::TextOrJson;
use crate::values::When;
use std::io::IsTerminal;
use std::io::Write;

/// A scene that is ready for tracing.
struct Ready {
    world: World,
    extras: Extras,
    /// Of the picture, where its tiles are to be kept.
    fingerprint: Option<Fingerprint>,
    /// Bytes of text.
    text_bytes: u64,
    /// Seconds by stage.
    seconds: Vec<(&'static str, f64)>,
}

/// Reads the scene and makes it ready, within the limits.
fn ready(typed: &RenderArgs, plan: &Plan, messages: Messages) -> Result<Ready, Failure> {
    let Understood { mut resolved, sources, disk, text_bytes, seconds } =
        on_threads(plan.options.threads, || understand(&plan.input, &typed.reading, messages))??;
    interrupt::check()?;
    if typed.missing_texture == MissingTexture::White {
        input::whiten(&mut resolved, &disk, plan.quiet);
    }
    let extras = Extras::new(plan, &mut resolved, &sources, back(plan)?)?;
    limits::check(&resolved, &plan.prepare, Some(&plan.options), &typed.reading.limits)?;
    let textures = Textures::load(&resolved, &disk, &plan.prepare).map_err(|faults| {
        messages.print(&faults, &sources);
        Failure::Reported
    })?;
    let fingerprint = plan
        .long
        .checkpoint
        .is_some()
        .then(|| extras.added_to(Fingerprint::of(&resolved, &textures, &plan.options), plan));
    // Nothing can be said of a place in the text any more, and the tree may want the memory.
    drop(sources);
    let world = World::build(resolved, textures, &plan.prepare).map_err(|faults| {
        messages.print(&faults, &Sources::default());
        Failure::Reported
    })?;
    interrupt::check()?;
    Ok(Ready { world, extras, fingerprint, text_bytes, seconds })
}

/// Makes the picture and says what it cost.
pub fn run(typed: &RenderArgs, color: When) -> Result<(), Failure> {
    let start = Instant::now();
    let plan = plan(typed)?;
    if plan.long.progress == ProgressName::Json {
        events::start("render", &shown(&plan.input), &shown(&plan.output));
    }
    output::check(&plan.output, &plan.input)?;
    interrupt::watch();
    let messages = Messages::new(color, plan.quiet);
    let Ready { world, extras, fingerprint, text_bytes, mut seconds } = ready(typed, &plan, messages)?;
    let deadline = plan.long.time_limit.map(|span| Instant::now() + span.0);
    for (stage, seconds) in seconds.iter().chain(world.seconds()) {
        tracing::debug!(stage, seconds, "done");
    }
    let Made { rendering: Rendering { image, stats, .. }, layers: (layers, looking), keep } =
        make(&world, &plan, &extras, fingerprint, deadline)?;
    seconds.extend(&stats.seconds);
    if !layers.is_empty() {
        seconds.push(("layers", looking));
    }
    let encoding = Instant::now();
    let image = extras.apply(image, &world, &plan)?;
    let Encoded { picture, layers } = encoded(&image, layers, &plan)?;
    seconds.push(("encode", encoding.elapsed().as_secs_f64()));
    interrupt::check()?;
    let writing = Instant::now();
    let written = output::write_all(&plan.output, &picture, &layers);
    written.map_err(|failure| with_kept(failure, keep.as_ref()))?;
    if let Some(keep) = keep {
        keep.remove();
    }
    seconds.push(("write", writing.elapsed().as_secs_f64()));
    seconds.push(("total", start.elapsed().as_secs_f64()));

    say_done(&plan, start);
    say_cost(&plan, &cost(&plan, &world, &stats, text_bytes, seconds))
}

/// What the picture cost.
fn cost(
    plan: &Plan,
    world: &World,
    stats: &Stats,
    text_bytes: u64,
    seconds: Vec<(&'static str, f64)>,
) -> Cost {
    let tracing = seconds.iter().find(|(stage, _)| *stage == "trace").map_or(0.0, |(_, seconds)| *seconds);
    let window = plan.options.window();
    Cost {
        version: env!("CARGO_PKG_VERSION"),
        scene: shown(&plan.input),
        picture: shown(&plan.output),
        width: window.width,
        height: window.height,
        accelerator: plan.prepare.accel.name(),
        simd: dotray::accel::simd::level_name(dotray::accel::simd::level()),
        threads: threads(plan),
        shapes: world.shape_count(),
        rays: Rays::new(stats, tracing),
        tests: Tests::new(stats),
        memory: memory(text_bytes, &stats.memory),
        seconds,
    }
}

/// The failure, and where the finished tiles are.
fn with_kept(failure: Failure, keep: Option<&Keep>) -> Failure {
    let Some(keep) = keep else { return failure };
    let kept = format!("`{}` keeps all tiles; write the picture with:\n  {}", keep.path().display(), again());
    match failure {
        Failure::Failed(message) => Failure::Failed(format!("{message}\n{kept}")),
        Failure::ReaderGone => {
            say(&kept);
            Failure::ReaderGone
        }
        Failure::Usage(_)
        | Failure::Reported
        | Failure::Over
        | Failure::Interrupted { .. }
        | Failure::TimeLimit(_) => failure,
    }
}

fn shown(place: &Place) -> String {
    match place {
        Place::Standard => "-".to_owned(),
        Place::File(path) => path.display().to_string(),
    }
}

fn threads(plan: &Plan) -> usize {
    let cores = || std::thread::available_parallelism().map_or(1, usize::from);
    plan.options.threads.unwrap_or_else(cores)
}

/// Says where the picture is: to people, and to whoever has left its name to us.
fn say_done(plan: &Plan, start: Instant) {
    let Place::File(path) = &plan.output else { return };
    if !plan.quiet && (plan.output_is_default || std::io::stderr().is_terminal()) {
        let window = plan.options.window();
        let seconds = start.elapsed().as_secs_f64();
        say(&format!("wrote {} ({}x{}, {seconds:.2} s)", path.display(), window.width, window.height));
    }
}

fn say_cost(plan: &Plan, cost: &Cost) -> Result<(), Failure> {
    match (plan.stats, &plan.output) {
        (None, _) => Ok(()),
        (Some(TextOrJson::Json), Place::File(_)) => put(cost.json()?.as_bytes()),
        (Some(TextOrJson::Json), Place::Standard) => {
            // If nobody reads standard error, nothing can be done about it.
            let _ = std::io::stderr().lock().write_all(cost.json()?.as_bytes());
            Ok(())
        }
        (Some(TextOrJson::Text), _) => {
            let _ = std::io::stderr().lock().write_all(cost.text().as_bytes());
            Ok(())
        }
    }
}
