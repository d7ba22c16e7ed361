//! `dotray animate`: one scene, many frames.

use dotray::render::Rendering;
use dotray::render::Stats;
use dotray::render::progress::SavedKind;
use std::fs;
use std::path::Path;
use std::time::Instant;

use crate::events;
use crate::exit::Failure;
use crate::exit::say;
use crate::extras::Encoded;
use crate::extras::encoded;
use crate::interrupt;
use crate::keyframes::Animation;
use crate::long_args::ProgressName;
use crate::making::Made;
use crate::making::make;
use crate::many_args::AnimateArgs;
use crate::meaning::Place;
use crate::messages::Messages;
use crate::movie;
use crate::numbered::numbered;
use crate::output;
use crate::plan::Plan;
use crate::plan::plan;
use crate::stage::Stage;
use crate::values::When;

/// Makes the frames that are missing, and the movie.
pub fn run(typed: &AnimateArgs, color: When) -> Result<(), Failure> {
    let start = Instant::now();
    let mut plan = plan(&typed.render)?;
    let Place::File(pattern) = plan.output.clone() else {
        return Err(Failure::Usage("frames need names, such as -o out.####.png".to_owned()));
    };
    let long = &plan.long;
    if long.checkpoint.is_some() || long.partial_every.is_some() {
        return Err(Failure::Usage(
            "--checkpoint and --partial-every go with `dotray render`: frames that are there are not made again"
                .to_owned(),
        ));
    }
    // Checks the pattern, too.
    let first = numbered(&pattern, typed.frames.first)?;
    output::check(&Place::File(first), &plan.input)?;
    if let Some(movie) = &typed.movie {
        movie::check(movie, &pattern)?;
        output::check(&Place::File(movie.clone()), &plan.input)?;
    }
    if long.progress == ProgressName::Json {
        let scene = match &plan.input {
            Place::Standard => "-".to_owned(),
            Place::File(path) => path.display().to_string(),
        };
        events::start("animate", &scene, &pattern.display().to_string());
    }
    interrupt::watch();
    let (animation, _) = Animation::read(&typed.animation)?;
    // The limit is for all frames together, and a frame is whole or absent.
    let deadline = plan.long.time_limit.take().map(|span| start + span.0);
    let mut missing = Vec::new();
    for frame in typed.frames.first..=typed.frames.last {
        let path = numbered(&pattern, frame)?;
        if !fs::metadata(&path).is_ok_and(|metadata| metadata.is_file() && metadata.len() > 0) {
            missing.push((frame, path));
        }
    }
    let all = typed.frames.last - typed.frames.first + 1;
    let there = all as usize - missing.len();
    if there > 0 && !plan.quiet {
        say(&format!("{there} of {all} frames are there already"));
    }
    let messages = Messages::new(color, plan.quiet);
    if !missing.is_empty() {
        let mut animate =
            Animate { stage: Stage::new(&plan, &typed.render, messages, animation)?, plan: &plan };
        for (index, (frame, path)) in missing.iter().enumerate() {
            events::frame(*frame, missing.len());
            animate.frame(*frame, path, deadline).map_err(|failure| stopped(failure, there + index, all))?;
        }
    }
    if let Some(movie) = &typed.movie {
        interrupt::check()?;
        movie::join(movie, &pattern, typed.frames, typed.fps)?;
        events::saved(SavedKind::Movie, movie);
    }
    Ok(())
}

/// The failure, with how many frames are there.
fn stopped(failure: Failure, there: usize, all: u32) -> Failure {
    let kept = format!("{there} of {all} frames are there, and the same command goes on");
    match failure {
        Failure::Interrupted { signal, .. } => Failure::Interrupted { signal, kept: Some(kept) },
        Failure::TimeLimit(_) => Failure::TimeLimit(kept),
        Failure::Failed(message) => Failure::Failed(format!("{message}\n{kept}")),
        Failure::Usage(_) | Failure::Reported | Failure::Over | Failure::ReaderGone => failure,
    }
}

struct Animate<'a> {
    stage: Stage<'a>,
    plan: &'a Plan,
}

impl Animate<'_> {
    fn frame(&mut self, frame: u32, path: &Path, deadline: Option<Instant>) -> Result<(), Failure> {
        interrupt::check()?;
        let plan = Plan { output: Place::File(path.to_path_buf()), ..self.plan.clone() };
        let set = self.stage.set(frame)?;
        let start = Instant::now();
        let Made { rendering: Rendering { image, stats, .. }, layers: (layers, looking), .. } =
            make(set.world, &plan, set.extras, None, deadline)?;
        let seconds = start.elapsed().as_secs_f64() - looking;
        let image = set.extras.apply(image, set.world, &plan)?;
        let Encoded { picture, layers } = encoded(&image, layers, &plan)?;
        interrupt::check()?;
        // The frame comes last: where it is, its layers are.
        for (path, bytes) in layers {
            output::write(&Place::File(path), &bytes)?;
        }
        output::write(&plan.output, &picture)?;
        events::saved(SavedKind::Frame, path);
        let Stats { box_tests, shape_tests, .. } = stats;
        self.stage.traced(stats.rays(), box_tests + shape_tests, seconds);
        tracing::debug!(frame, seconds, "a frame is there");
        Ok(())
    }
}
