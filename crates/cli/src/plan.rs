//! What the typed words mean: a plan that leaves nothing to decide, or a usage error before any file is read.

use dotray::image::EncodeOptions;
use dotray::image::Format;
use dotray::image::Limits;
use dotray::render::Antialias;
use dotray::render::Crop;
use dotray::render::Layer;
use dotray::render::Options;
use dotray::render::Order;
use dotray::render::PrepareOptions;
use std::fmt::Display;
use std::path::PathBuf;

use crate::exit::Failure;
use crate::layer_args::Background;
use crate::layer_args::Overlay;
use crate::long_args::LongArgs;
use crate::long_args::OrderName;
use crate::meaning;
use crate::meaning::Place;
use crate::render_args::RenderArgs;
use crate::storage;
use crate::values::Aa;
use crate::values::Build;
use crate::values::TextOrJson;

/// All that `dotray render` is to do.
#[derive(Clone, Debug, PartialEq)]
pub struct Plan {
    /// Where the scene comes from.
    pub input: Place,
    /// Where the picture goes.
    pub output: Place,
    /// Whether the output's name is our choice, so that we must say it.
    pub output_is_default: bool,
    /// The picture's format.
    pub format: Format,
    /// How it is stored.
    pub encode: EncodeOptions,
    /// What the picture depends on.
    pub options: Options,
    /// How the scene is prepared.
    pub prepare: PrepareOptions,
    /// What lies behind everything, if not what the scene says.
    pub background: Option<Background>,
    /// What else is stored.
    pub layers: Vec<Layer>,
    /// What is drawn over the picture.
    pub overlay: Option<Overlay>,
    /// How many levels of boxes.
    pub overlay_levels: usize,
    /// The effort of building the accelerator, as it was typed.
    pub build: Build,
    /// How the work is kept and shown.
    pub long: LongArgs,
    /// Print errors only.
    pub quiet: bool,
    /// Whether and how to print what it cost.
    pub stats: Option<TextOrJson>,
}

/// Finds out what was meant.
pub fn plan(typed: &RenderArgs) -> Result<Plan, Failure> {
    let shown = |path: &PathBuf| path.display().to_string();
    let input = either("scene", "--in", typed.input.as_ref(), typed.input_option.as_ref(), shown)?
        .ok_or_else(|| Failure::Usage("no scene given: dotray render IN [OUT]".to_owned()))?;
    let input = Place::of(input);
    let output = either("picture", "--output", typed.output.as_ref(), typed.output_option.as_ref(), shown)?;
    let output_is_default = output.is_none();
    let output = output.map_or_else(|| storage::default_output(&input), |path| Place::of(path));
    let format = storage::format(typed, &output)?;
    let options = options(typed)?;
    options.validate()?;
    let limits = limits(typed, &options)?;
    let prepare = PrepareOptions {
        accel: meaning::accel(typed.accel),
        quality: meaning::quality(typed.build),
        threads: options.threads,
        image_limits: limits,
    };
    let encode = storage::encode_options(typed, format)?;
    storage::check_jpeg_edge(format, &options)?;
    storage::check_alpha(typed, format)?;
    let layers = typed.layers.clone().unwrap_or_default().0;
    storage::check_layers(&layers, format, &output)?;
    if typed.long.partial_every.is_some() && output == Place::Standard {
        let message = "--partial-every writes the picture again and again: name a file for it";
        return Err(Failure::Usage(message.to_owned()));
    }
    Ok(Plan {
        input,
        output,
        output_is_default,
        format,
        encode,
        options,
        prepare,
        background: typed.background.clone(),
        layers,
        overlay: typed.overlay,
        overlay_levels: typed.overlay_levels.unwrap_or(usize::MAX),
        build: typed.build,
        long: typed.long.clone(),
        quiet: typed.quiet,
        stats: typed.stats,
    })
}

/// A value that has a place and an option: one of them, or neither.
fn either<T: Copy>(
    what: &str,
    option: &str,
    placed: Option<T>,
    named: Option<T>,
    show: impl Fn(T) -> String,
) -> Result<Option<T>, Failure> {
    match (placed, named) {
        (Some(placed), Some(named)) => Err(Failure::Usage(format!(
            "the {what} is given twice: `{}` in its place and `{option} {}`",
            show(placed),
            show(named)
        ))),
        (placed, named) => Ok(placed.or(named)),
    }
}

fn number<T: Copy + Display>(
    what: &str,
    option: &str,
    placed: Option<T>,
    named: Option<T>,
) -> Result<Option<T>, Failure> {
    either(what, option, placed, named, |value| value.to_string())
}

fn options(typed: &RenderArgs) -> Result<Options, Failure> {
    let defaults = Options::default();
    let (width, height) = size(typed, &defaults)?;
    let crop = typed.crop.map(|crop| {
        let [x, y, width, height] = crop.0;
        Crop { x, y, width, height }
    });
    Ok(Options {
        width,
        height,
        crop,
        recursion: number("recursion limit", "--recursion", typed.recursion_value, typed.recursion)?
            .unwrap_or(defaults.recursion),
        threshold: number("contribution threshold", "--cutoff", typed.cutoff_value, typed.cutoff)?
            .unwrap_or(defaults.threshold),
        antialias: antialias(typed)?,
        shadows: meaning::shadows(typed.shadows),
        texture_filter: meaning::texture_filter(typed.texture_filter),
        light_samples: typed.light_samples.unwrap_or(defaults.light_samples),
        transparent: matches!(typed.background, Some(Background::Transparent | Background::Image(_))),
        max_pixels: typed.max_pixels.unwrap_or(defaults.max_pixels),
        threads: typed.threads.map(usize::from),
        tile_size: typed.tile_size.unwrap_or(defaults.tile_size),
        order: match typed.long.order {
            OrderName::Morton => Order::Morton,
            OrderName::CoarseToFine => Order::CoarseToFine,
        },
    })
}

/// Width and height; where only one is given, the other keeps the shape of the default picture.
fn size(typed: &RenderArgs, defaults: &Options) -> Result<(u32, u32), Failure> {
    let width = number("width", "--width", typed.width_value, typed.width)?;
    let height = number("height", "--height", typed.height_value, typed.height)?;
    let scaled = |edge: u32, to: u32, from: u32| {
        let rounded = (u64::from(edge) * u64::from(to) + u64::from(from) / 2) / u64::from(from);
        u32::try_from(rounded).unwrap_or(u32::MAX).max(edge.min(1))
    };
    match (typed.size, width, height) {
        (Some(size), None, None) => Ok((size.0, size.1)),
        (Some(size), width, height) => {
            let (what, value) = if width.is_some() { ("width", width) } else { ("height", height) };
            let value = value.unwrap_or_default();
            let size = format!("{}x{}", size.0, size.1);
            Err(Failure::Usage(format!("the {what} is given twice: {value} and `--size {size}`")))
        }
        (None, Some(width), Some(height)) => Ok((width, height)),
        (None, Some(width), None) => Ok((width, scaled(width, defaults.height, defaults.width))),
        (None, None, Some(height)) => Ok((scaled(height, defaults.width, defaults.height), height)),
        (None, None, None) => Ok((defaults.width, defaults.height)),
    }
}

fn limits(typed: &RenderArgs, options: &Options) -> Result<Limits, Failure> {
    let defaults = Limits::default();
    let max_pixels = typed.max_pixels.unwrap_or(defaults.max_pixels);
    let window = options.window();
    let pixels = u64::from(window.width) * u64::from(window.height);
    if pixels > max_pixels {
        let size = format!("{}x{}", window.width, window.height);
        let more = "--max-pixels allows more";
        return Err(Failure::Usage(format!(
            "a picture of {size} has {pixels} pixels; the limit is {max_pixels} ({more})"
        )));
    }
    // Whoever allows more pixels than usual allows the memory for them.
    let max_bytes = defaults.max_bytes.max(max_pixels.saturating_mul(16));
    // Textures keep within the limit on memory, too.
    let most = typed.reading.limits.max_memory.map_or(u64::MAX, |size| size.0);
    Ok(Limits { max_pixels, max_bytes: max_bytes.min(most) })
}

fn antialias(typed: &RenderArgs) -> Result<Antialias, Failure> {
    let idle = typed.aa_threshold.map(|_| "--aa-threshold").or(typed.aa_depth.map(|_| "--aa-depth"));
    match (typed.aa, idle) {
        (Aa::None | Aa::Grid(_), Some(option)) => {
            Err(Failure::Usage(format!("{option} has a meaning only with --aa adaptive")))
        }
        (Aa::None, None) => Ok(Antialias::None),
        (Aa::Grid(n), None) => Ok(Antialias::Grid(n)),
        (Aa::Adaptive, Some(_) | None) => Ok(Antialias::Adaptive {
            threshold: typed.aa_threshold.unwrap_or(0.1),
            depth: typed.aa_depth.unwrap_or(3),
        }),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::values::Depth;
    use crate::values::FormatName;
    use crate::values::Size;

    fn planned(change: impl FnOnce(&mut RenderArgs)) -> Result<Plan, String> {
        let mut typed = RenderArgs { input: Some(PathBuf::from("folder/a.ray")), ..RenderArgs::default() };
        change(&mut typed);
        plan(&typed)
            .map_err(|failure| if let Failure::Usage(message) = failure { message } else { String::new() })
    }

    fn size_of(change: impl FnOnce(&mut RenderArgs)) -> Result<(u32, u32), String> {
        planned(change).map(|plan| (plan.options.width, plan.options.height))
    }

    #[test]
    fn nothing_said_means_the_defaults() {
        let plan = planned(|_| ()).unwrap();
        assert_eq!(plan.output, Place::File(PathBuf::from("a.png")));
        assert!(plan.output_is_default);
        assert_eq!((plan.format, plan.options), (Format::Png, Options::default()));
        let plan = planned(|typed| typed.input = Some("-".into())).unwrap();
        assert_eq!((plan.input, plan.output, plan.format), (Place::Standard, Place::Standard, Format::Png));
    }

    #[test]
    fn one_edge_gives_the_other() {
        assert_eq!(size_of(|typed| typed.width = Some(800)), Ok((800, 600)));
        assert_eq!(size_of(|typed| typed.height_value = Some(600)), Ok((800, 600)));
        assert_eq!(size_of(|typed| typed.width = Some(1)), Ok((1, 1)));
        assert_eq!(size_of(|typed| typed.size = Some(Size(7, 5))), Ok((7, 5)));
        assert!(size_of(|typed| typed.width = Some(0)).unwrap_err().contains("width is 0"));
        assert!(size_of(|typed| typed.height = Some(u32::MAX)).unwrap_err().contains("width is"));
    }

    #[test]
    fn said_twice_is_told_with_both() {
        let message = planned(|typed| {
            (typed.output, typed.output_option) = (Some("a.png".into()), Some("b.png".into()))
        });
        assert_eq!(
            message.unwrap_err(),
            "the picture is given twice: `a.png` in its place and `--output b.png`"
        );
        let message =
            planned(|typed| (typed.cutoff_value, typed.cutoff) = (Some(0.5), Some(0.5))).unwrap_err();
        assert!(message.contains("`0.5` in its place and `--cutoff 0.5`"), "{message}");
        let message = size_of(|typed| (typed.size, typed.height) = (Some(Size(7, 5)), Some(5))).unwrap_err();
        assert_eq!(message, "the height is given twice: 5 and `--size 7x5`");
    }

    #[test]
    fn formats_follow_the_name_and_the_depth() {
        let format = |name: &str, typed: Option<FormatName>, depth| {
            planned(|args| (args.output, args.format, args.depth) = (Some(name.into()), typed, depth))
                .map(|plan| plan.format)
        };
        assert_eq!(format("a.BMP", None, None), Ok(Format::Bmp));
        assert_eq!(format("a.png", None, Some(Depth::Sixteen)), Ok(Format::Png16));
        assert_eq!(format("a", Some(FormatName::Exr), None), Ok(Format::Exr));
        assert_eq!(format("-", Some(FormatName::Png16), None), Ok(Format::Png16));
        assert!(format("a.bmp", None, Some(Depth::Sixteen)).is_err());
        assert!(format("a.png", Some(FormatName::Png16), Some(Depth::Eight)).is_err());
        assert!(format("a", None, None).unwrap_err().contains("--format"));
    }

    #[test]
    fn idle_and_impossible_options_are_refused() {
        assert!(planned(|typed| typed.aa_depth = Some(2)).unwrap_err().contains("--aa adaptive"));
        assert!(planned(|typed| typed.jpeg_quality = Some(50)).unwrap_err().contains("JPEG only"));
        assert!(planned(|typed| typed.max_pixels = Some(1000)).unwrap_err().contains("the limit is 1000"));
        assert!(planned(|typed| typed.aa = Aa::Grid(65)).unwrap_err().contains("grid is 65"));
        assert!(planned(|typed| typed.cutoff = Some(f64::NAN)).unwrap_err().contains("cutoff"));
        let wide =
            planned(|typed| (typed.size, typed.format) = (Some(Size(70_000, 10)), Some(FormatName::Jpeg)));
        assert!(wide.unwrap_err().contains("65535"));
    }
}
