//! What was typed after `dotray render`.

use clap::Args;
use std::path::PathBuf;

use crate::layer_args::Background;
use crate::layer_args::Layers;
use crate::layer_args::Overlay;
use crate::long_args::LongArgs;
use crate::reading_args::ReadingArgs;
use crate::values::Aa;
use crate::values::Accel;
use crate::values::Build;
use crate::values::CropArg;
use crate::values::Depth;
use crate::values::Filter;
use crate::values::FormatName;
use crate::values::MissingTexture;
use crate::values::ShadowMode;
use crate::values::Size;
use crate::values::TextOrJson;

/// `dotray render`.
#[derive(Clone, Debug, Args, Default)]
#[command(
    override_usage = "dotray render [OPTIONS] IN [OUT] [WIDTH HEIGHT [RECURSION [CUTOFF]]]",
    allow_negative_numbers = true,
    after_long_help = EXAMPLES
)]
pub struct RenderArgs {
    /// The scene, or - for standard input (names in it are then relative to the working directory).
    #[arg(value_name = "IN")]
    pub input: Option<PathBuf>,
    /// The picture, or - for standard output; its extension chooses the format [default: IN's name with .png, in the
    /// working directory; standard output if IN is -].
    #[arg(value_name = "OUT")]
    pub output: Option<PathBuf>,
    /// Columns [default: 640].
    #[arg(value_name = "WIDTH")]
    pub width_value: Option<u32>,
    /// Rows [default: 480].
    #[arg(value_name = "HEIGHT")]
    pub height_value: Option<u32>,
    /// How deep mirrored and refracted rays may go [default: 5].
    #[arg(value_name = "RECURSION")]
    pub recursion_value: Option<u32>,
    /// The least contribution for which a mirrored or refracted ray is traced [default: 0.002].
    #[arg(value_name = "CUTOFF")]
    pub cutoff_value: Option<f64>,

    /// The scene, in place of IN.
    #[arg(long = "in", value_name = "FILE", help_heading = FILES)]
    pub input_option: Option<PathBuf>,
    /// The picture, in place of OUT.
    #[arg(short, long = "output", visible_alias = "out", value_name = "FILE", help_heading = FILES)]
    pub output_option: Option<PathBuf>,
    /// The picture's format, whatever its name says [default: by OUT's extension; png on standard output].
    #[arg(long, value_enum, value_name = "NAME", help_heading = FILES)]
    pub format: Option<FormatName>,
    /// Bits a channel of a PNG [default: 8].
    #[arg(long, value_enum, value_name = "BITS", help_heading = FILES)]
    pub depth: Option<Depth>,
    /// Quality of a JPEG, 1 to 100 [default: 95].
    #[arg(long, value_name = "Q", value_parser = clap::value_parser!(u8).range(1..=100), help_heading = FILES)]
    pub jpeg_quality: Option<u8>,
    /// Store with the sRGB curve; without it, colours are display values already. Float formats keep the values as
    /// they are.
    #[arg(long, help_heading = FILES)]
    pub srgb: bool,

    /// Columns of the whole picture, in place of WIDTH; given alone, the height follows as 3/4 of it.
    #[arg(long, value_name = "PIXELS", help_heading = PICTURE)]
    pub width: Option<u32>,
    /// Rows of the whole picture, in place of HEIGHT; given alone, the width follows as 4/3 of it.
    #[arg(long, value_name = "PIXELS", help_heading = PICTURE)]
    pub height: Option<u32>,
    /// Both at once, such as 800x600.
    #[arg(long, value_name = "WxH", help_heading = PICTURE)]
    pub size: Option<Size>,
    /// Only this part of the picture, in pixels from the upper left, is computed and stored.
    #[arg(long, value_name = "X,Y,W,H", help_heading = PICTURE)]
    pub crop: Option<CropArg>,
    /// Samples a pixel: one ray through its centre, a grid of N x N rays, or the four corners with division of the
    /// pixel where they differ [possible values: none, grid=N, adaptive].
    #[arg(long, value_name = "HOW", default_value = "none", help_heading = PICTURE)]
    pub aa: Aa,
    /// Colour difference above which `--aa adaptive` divides [default: 0.1].
    #[arg(long, value_name = "X", help_heading = PICTURE)]
    pub aa_threshold: Option<f64>,
    /// How often `--aa adaptive` may divide a pixel [default: 3].
    #[arg(long, value_name = "N", help_heading = PICTURE)]
    pub aa_depth: Option<u32>,
    /// What lies behind everything: a colour R,G,B in place of the scene's; `transparent` for a picture with an alpha
    /// channel; or image:FILE, stretched over the picture.
    #[arg(long, value_name = "WHAT", allow_hyphen_values = true, help_heading = PICTURE)]
    pub background: Option<Background>,
    /// Also these layers, separated by commas, or all: depth, normal, position, shape, material, st, object, shadow,
    /// direct, reflected, transmitted, rays, boxtests, shapetests. Into an OpenEXR picture as channels such as
    /// depth.Z; else each into a picture of its own, such as OUT.depth.png.
    #[arg(long, value_name = "NAMES", help_heading = PICTURE)]
    pub layers: Option<Layers>,
    /// Drawn over the picture.
    #[arg(long, value_enum, value_name = "WHAT", help_heading = PICTURE)]
    pub overlay: Option<Overlay>,
    /// Of the boxes drawn over the picture, those of so many outer levels [default: all, at most 100000 boxes].
    #[arg(long, value_name = "N", requires = "overlay", help_heading = PICTURE)]
    pub overlay_levels: Option<usize>,

    /// How deep mirrored and refracted rays may go, in place of RECURSION.
    #[arg(long, visible_alias = "rLimit", value_name = "N", help_heading = LIGHT)]
    pub recursion: Option<u32>,
    /// The least contribution for which such a ray is traced, in place of CUTOFF.
    #[arg(long, visible_alias = "cLimit", value_name = "X", help_heading = LIGHT)]
    pub cutoff: Option<f64>,
    /// What stands between a point and a light.
    #[arg(long, value_enum, value_name = "MODE", default_value_t, help_heading = LIGHT)]
    pub shadows: ShadowMode,
    /// Point lights that stand for one area light [default: 64].
    #[arg(long, value_name = "N", help_heading = LIGHT)]
    pub light_samples: Option<u32>,
    /// How textures are read between their pixels.
    #[arg(long, value_enum, value_name = "FILTER", default_value_t, help_heading = LIGHT)]
    pub texture_filter: Filter,

    /// What becomes of a texture whose file is nowhere.
    #[arg(long, value_enum, value_name = "WHAT", default_value_t, help_heading = LIGHT)]
    pub missing_texture: MissingTexture,

    /// How the scene is read.
    #[command(flatten)]
    pub reading: ReadingArgs,

    /// How long work is kept and shown.
    #[command(flatten)]
    pub long: LongArgs,

    /// How the nearest shape is found. The picture does not depend on it.
    #[arg(long, value_enum, value_name = "KIND", default_value_t, help_heading = SPEED)]
    pub accel: Accel,
    /// Time for building that structure against time for tracing. The picture does not depend on it.
    #[arg(long, value_enum, value_name = "EFFORT", default_value_t, help_heading = SPEED)]
    pub build: Build,
    /// Threads [default: one a core]. The picture does not depend on it.
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..=1024), help_heading = SPEED)]
    pub threads: Option<u16>,
    /// Edge of the squares that threads take in turn, in pixels [default: 32]. The picture does not depend on it.
    #[arg(long, value_name = "PIXELS", help_heading = SPEED)]
    pub tile_size: Option<u32>,
    /// Refuse pictures, and textures, of more pixels than this [default: 268435456].
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u64).range(1..), help_heading = SPEED)]
    pub max_pixels: Option<u64>,

    /// Print nothing but errors (and what --stats asks for).
    #[arg(short, long, help_heading = MESSAGES)]
    pub quiet: bool,
    /// Say what the picture cost: rays, tests, bytes, seconds. Text goes to standard error; JSON to standard output,
    /// or to standard error if the picture goes to standard output.
    #[arg(long, value_enum, value_name = "FORMAT", help_heading = MESSAGES)]
    #[arg(num_args = 0..=1, require_equals = true, default_missing_value = "text")]
    pub stats: Option<TextOrJson>,
}

const FILES: &str = "Files";
const PICTURE: &str = "Picture";
const LIGHT: &str = "Light";
const SPEED: &str = "Speed and limits";
const MESSAGES: &str = "Messages";

const EXAMPLES: &str = "\
Every value may stand in its place or be given as an option, but not both.

Examples:
  dotray render slides.ray                            slides.png, 640x480
  dotray render slides.ray slides.bmp 800 600 7 0.01  the six values in their places
  dotray render slides.ray --size 1920x1080 --aa adaptive -o big.png
  dotray render --in room.ray --out room.bmp --width 500 --height 500 --rLimit 5 --cLimit 0.0001
                                                      as courses call their programs
  dotray render slides.ray hdr.exr                    unclamped floats
  dotray render slides.ray all.exr --layers all       with depth, normals, shapes and more as channels
  dotray render slides.ray cut.png --background transparent
  dotray render slides.ray --crop 100,50,64,64        a part, for a closer look
  dotray render slides.ray --stats --threads 1        what it cost
  dotray render slides.ray --checkpoint a.tiles --resume
                                                      may be killed at any moment and started again
  cat slides.ray | dotray render - - --format png > slides.png

On a terminal a bar shows progress, rate and time left. Ctrl-C stops; then nothing is written but a checkpoint.
A picture is written whole or not at all: an error leaves an older file as it was.";
