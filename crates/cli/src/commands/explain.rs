//! `dotray explain`: why a pixel has its colour.

use dotray::accel::Kind;
use dotray::accel::simd::level;
use dotray::render::Crop;
use dotray::render::Options;
use dotray::render::PrepareOptions;
use dotray::render::Silent;
use dotray::render::World;
use dotray::render::camera::Camera;
use dotray::render::inspect::RayNode;
use dotray::render::on_threads;
use dotray::render::render;
use dotray::render::trace::Tracer;
use dotray::scene::Resolved;
use std::io::IsTerminal;

use crate::exit::Failure;
use crate::exit::put;
use crate::explain::Explanation;
use crate::explain::SamplePlace;
use crate::explain::Sampling;
use crate::explain::Visit;
use crate::explain::bits;
use crate::explain::dot::dot;
use crate::explain::json::json;
use crate::explain::listed;
use crate::explain::sample_pixel;
use crate::explain::shapes_of;
use crate::explain::svg::svg;
use crate::explain::tests_of;
use crate::explain::text::text;
use crate::input;
use crate::input::TimedDisk;
use crate::input::Understood;
use crate::input::understand;
use crate::inspect_args::ExplainArgs;
use crate::inspect_args::ExplainFormat;
use crate::limits;
use crate::messages::Messages;
use crate::messages::wants_color;
use crate::places::light_places;
use crate::places::shape_places;
use crate::plan::plan;
use crate::values::MissingTexture;
use crate::values::When;

/// Tells all about one pixel; fails where the terms do not add up to it.
pub fn run(typed: &ExplainArgs, color: When) -> Result<(), Failure> {
    let plan = plan(&typed.as_render())?;
    let options = &plan.options;
    let pixel = aimed_at(typed, options)?;
    let messages = Messages::new(color, false);
    let Understood { mut resolved, sources, disk, .. } =
        on_threads(plan.options.threads, || understand(&plan.input, &typed.reading, messages))??;
    if typed.missing_texture == MissingTexture::White {
        input::whiten(&mut resolved, &disk, false);
    }
    limits::check(&resolved, &plan.prepare, None, &typed.reading.limits)?;
    let world = World::prepare(resolved.clone(), &disk, &plan.prepare).map_err(|faults| {
        messages.print(&faults, &sources);
        Failure::Reported
    })?;

    let sampling = match (pixel, typed.film) {
        (Some((x, y)), _) => sample_pixel(&world, options, x, options.height - 1 - y),
        (None, film) => sample_film(&world, options, film.map_or((0.0, 0.0), |film| (film.0, film.1))),
    };
    let place = sampling.samples.get(typed.sample).copied().ok_or_else(|| {
        let last = sampling.samples.len().saturating_sub(1);
        Failure::Usage(format!("there is no sample {}; the pixel's samples are 0 to {last}", typed.sample))
    })?;
    let tree = tree(&world, options, &place)?;
    let rays = listed(&tree);
    let rendered = pixel.map(|pixel| rendered(&world, options, pixel)).transpose()?;
    let visits =
        if typed.visits { visits(&resolved, &disk, &plan.prepare, options, &place)? } else { vec![] };
    let explanation = Explanation {
        scene: typed.scene.display().to_string(),
        options,
        accelerator: plan.prepare.accel.name(),
        pixel,
        sampling,
        chosen: typed.sample,
        shapes: shape_places(&resolved, &sources, shapes_of(&rays)),
        lights: light_places(&resolved, &sources),
        rays,
        rendered,
        world: &world,
        resolved: &resolved,
        visits,
    };
    let told = match typed.format {
        ExplainFormat::Text => text(&explanation, wants_color(color, std::io::stdout().is_terminal())),
        ExplainFormat::Json => format!("{:#}\n", json(&explanation)),
        ExplainFormat::Svg => svg(&explanation),
        ExplainFormat::Dot => dot(&explanation),
    };
    put(told.as_bytes())?;
    if explanation.sums_agree() && explanation.pixel_agrees() != Some(false) {
        Ok(())
    } else {
        Err(Failure::Failed("the terms do not add up to the rendered pixel: please report this".to_owned()))
    }
}

/// The pixel that is meant; `None` for a place on the film.
fn aimed_at(typed: &ExplainArgs, options: &Options) -> Result<Option<(u32, u32)>, Failure> {
    match (typed.x, typed.y, typed.film) {
        (None, None, Some(_)) => Ok(None),
        (Some(x), Some(y), None) if x < options.width && y < options.height => Ok(Some((x, y))),
        (Some(x), Some(y), _) => {
            let (width, height) = (options.width, options.height);
            Err(Failure::Usage(format!("there is no pixel {x} {y} in a picture of {width}x{height}")))
        }
        (..) => Err(Failure::Usage("no pixel given: dotray explain SCENE X Y, or --film X,Y".to_owned())),
    }
}

fn sample_film(world: &World, options: &Options, (x, y): (f64, f64)) -> Sampling {
    let camera = Camera::new(world.camera(), options.width, options.height);
    let colors = Tracer::new(world, options, level()).colors(&[camera.ray(x, y)]);
    let color = colors.first().copied().unwrap_or_default();
    Sampling { samples: vec![SamplePlace { x, y, weight: 1.0, color }], squares: Vec::new(), mean: color }
}

fn tree(world: &World, options: &Options, place: &SamplePlace) -> Result<RayNode, Failure> {
    let camera = Camera::new(world.camera(), options.width, options.height);
    let tree = Tracer::new(world, options, level()).inspect(camera.ray(place.x, place.y));
    tree.ok_or_else(|| Failure::Failed("the ray could not be traced".to_owned()))
}

/// What `dotray render` stores for the pixel.
fn rendered(world: &World, options: &Options, (x, y): (u32, u32)) -> Result<[f32; 3], Failure> {
    let crop = Some(Crop { x, y, width: 1, height: 1 });
    let picture = render(world, &Options { crop, ..options.clone() }, &Silent)?;
    let [r, g, b, _] = picture.image.pixel(0, 0).unwrap_or_default();
    Ok([r, g, b])
}

/// What each of the five accelerators tests for the rays of a sample.
fn visits(
    resolved: &Resolved,
    disk: &TimedDisk,
    prepare: &PrepareOptions,
    options: &Options,
    place: &SamplePlace,
) -> Result<Vec<Visit>, Failure> {
    let visit = |accel: Kind| {
        let prepare = PrepareOptions { accel, ..prepare.clone() };
        let world = World::prepare(resolved.clone(), disk, &prepare).map_err(|_| Failure::Reported)?;
        let tree = tree(&world, options, place)?;
        let (boxes, shapes) = tests_of(&listed(&tree));
        Ok(Visit {
            accelerator: accel.name(),
            eye_boxes: tree.tests.boxes,
            eye_shapes: tree.tests.shapes,
            boxes,
            shapes,
            same_color: bits(tree.color) == bits(place.color),
        })
    };
    Kind::ALL.into_iter().map(visit).collect()
}
