//! The picture's file: its name, its format, how its pixels are stored.

use dotray::image::EncodeOptions;
use dotray::image::Format;
use dotray::render::Antialias;
use dotray::render::Layer;
use dotray::render::Options;
use std::path::Path;

use crate::exit::Failure;
use crate::layer_args::Background;
use crate::meaning;
use crate::meaning::Place;
use crate::render_args::RenderArgs;
use crate::values::Depth;

/// IN's name with the extension of the best format that this build has, in the working directory.
pub fn default_output(input: &Place) -> Place {
    match input {
        Place::Standard => Place::Standard,
        Place::File(path) => {
            let name = path.file_name().unwrap_or("picture".as_ref());
            Place::File(Path::new(name).with_extension(extension(default_format())))
        }
    }
}

fn default_format() -> Format {
    if Format::Png.is_built() { Format::Png } else { Format::Bmp }
}

fn extension(format: Format) -> &'static str {
    format.extensions().first().copied().unwrap_or("png")
}

/// The format that the name or an option chooses, if this build has it.
pub fn format(typed: &RenderArgs, output: &Place) -> Result<Format, Failure> {
    let format = match (typed.format, output) {
        (Some(name), Place::Standard | Place::File(_)) => meaning::named(name),
        (None, Place::Standard) => default_format(),
        (None, Place::File(path)) => {
            Format::from_path(path).map_err(|error| Failure::Usage(format!("{error} (or say --format)")))?
        }
    };
    let deeper = match (typed.depth, format) {
        (Some(Depth::Sixteen), Format::Png | Format::Png16) | (None, Format::Png16) => Format::Png16,
        (Some(Depth::Eight), Format::Png16) => {
            return Err(Failure::Usage("--format png16 and --depth 8 contradict each other".to_owned()));
        }
        (Some(Depth::Sixteen), other) => {
            let name = other.name();
            return Err(Failure::Usage(format!(
                "--depth 16 goes with PNG only; the picture would be {name}"
            )));
        }
        (Some(Depth::Eight) | None, other) => other,
    };
    if deeper.is_built() {
        Ok(deeper)
    } else {
        Err(Failure::Usage(format!("{} is left out of this build", deeper.name())))
    }
}

/// The one format whose edges are shorter than those of a picture: told now, not after the rays.
pub fn check_jpeg_edge(format: Format, options: &Options) -> Result<(), Failure> {
    let window = options.window();
    let longest = window.width.max(window.height);
    if format == Format::Jpeg && longest > u32::from(u16::MAX) {
        let most = u16::MAX;
        return Err(Failure::Usage(format!(
            "a JPEG has at most {most} columns and rows; asked for are {longest}"
        )));
    }
    Ok(())
}

/// Whether the format keeps an alpha channel, where one is asked for.
pub fn check_alpha(typed: &RenderArgs, format: Format) -> Result<(), Failure> {
    let keeps_alpha = match format {
        Format::Png | Format::Png16 | Format::Qoi | Format::Tiff | Format::Exr => true,
        Format::Bmp | Format::Jpeg | Format::Ppm | Format::Hdr | Format::Pfm => false,
    };
    if typed.background == Some(Background::Transparent) && !keeps_alpha {
        let name = format.name();
        return Err(Failure::Usage(format!(
            "--background transparent needs an alpha channel, which {name} has not: take PNG, QOI, TIFF or OpenEXR"
        )));
    }
    Ok(())
}

/// Whether layers have a place: beside the picture or in it.
pub fn check_layers(layers: &[Layer], format: Format, output: &Place) -> Result<(), Failure> {
    if layers.is_empty() || format == Format::Exr {
        return Ok(());
    }
    match output {
        Place::Standard => Err(Failure::Usage(
            "--layers on standard output needs --format exr: other formats take a file for each".to_owned(),
        )),
        Place::File(_) if !Format::Png.is_built() => {
            Err(Failure::Usage("--layers needs PNG or OpenEXR, which are left out of this build".to_owned()))
        }
        Place::File(_) => Ok(()),
    }
}

/// About how many rays leave the eye for a pixel; of adaptive oversampling nobody knows it before.
pub fn samples_a_pixel(options: &Options) -> f64 {
    match options.antialias {
        Antialias::None => 1.0,
        Antialias::Grid(n) => f64::from(n) * f64::from(n),
        Antialias::Adaptive { .. } => 2.0,
    }
}

/// How the pixels are stored.
pub fn encode_options(typed: &RenderArgs, format: Format) -> Result<EncodeOptions, Failure> {
    let defaults = EncodeOptions::default();
    if typed.jpeg_quality.is_some() && format != Format::Jpeg {
        let name = format.name();
        return Err(Failure::Usage(format!(
            "--jpeg-quality goes with JPEG only; the picture would be {name}"
        )));
    }
    let jpeg_quality = typed.jpeg_quality.unwrap_or(defaults.jpeg_quality);
    Ok(EncodeOptions { srgb: typed.srgb, jpeg_quality })
}
