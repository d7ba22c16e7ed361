//! What was typed after `dotray explain` and `dotray tree`.

use clap::Args;
use clap::ValueEnum;
use std::path::PathBuf;
use std::str::FromStr;

use crate::reading_args::ReadingArgs;
use crate::render_args::RenderArgs;
use crate::values::Aa;
use crate::values::Accel;
use crate::values::Build;
use crate::values::Filter;
use crate::values::MissingTexture;
use crate::values::ShadowMode;
use crate::values::Size;

/// `dotray explain`.
#[derive(Debug, Args)]
#[command(
    allow_negative_numbers = true,
    after_long_help = "\
Examples:
  dotray explain slides.ray 320 240                  why the pixel in the middle has its colour
  dotray explain slides.ray 40 7 --size 80x60        a pixel of a smaller picture
  dotray explain slides.ray --film 320.5,239.5       a place: X to the right, Y up, in pixels
  dotray explain slides.ray 320 240 --aa grid=2 --sample 3
  dotray explain slides.ray 320 240 --visits         what each accelerator tests for it
  dotray explain slides.ray 320 240 --format svg > rays.svg
  dotray explain slides.ray 320 240 --format dot | dot -Tpdf > tree.pdf

The sum of all terms is compared with the rendered pixel bit for bit; exit code 1 if they should differ."
)]
pub struct ExplainArgs {
    /// The scene, or - for standard input.
    #[arg(value_name = "SCENE")]
    pub scene: PathBuf,
    /// The pixel's column, 0 at the left.
    #[arg(value_name = "X", requires = "y")]
    pub x: Option<u32>,
    /// The pixel's row, 0 at the top.
    #[arg(value_name = "Y")]
    pub y: Option<u32>,
    /// A place instead of a pixel: X to the right and Y up from the lower left corner, in pixels.
    #[arg(long, value_name = "X,Y", conflicts_with_all = ["x", "aa", "sample"])]
    pub film: Option<Film>,
    /// With several samples a pixel: the one whose rays are shown.
    #[arg(long, value_name = "N", default_value_t = 0)]
    pub sample: usize,

    /// For people, for programs, a drawing of the rays in the scene, or a graph for Graphviz.
    #[arg(long, value_enum, value_name = "FORMAT", default_value_t)]
    pub format: ExplainFormat,
    /// Also what each of the five accelerators tests for these rays.
    #[arg(long)]
    pub visits: bool,

    /// Columns and rows of the picture, such as 800x600 [default: 640x480].
    #[arg(long, value_name = "WxH", help_heading = "Picture")]
    pub size: Option<Size>,
    /// Samples a pixel, as for `render` [possible values: none, grid=N, adaptive].
    #[arg(long, value_name = "HOW", default_value = "none", help_heading = "Picture")]
    pub aa: Aa,
    /// Colour difference above which `--aa adaptive` divides [default: 0.1].
    #[arg(long, value_name = "X", help_heading = "Picture")]
    pub aa_threshold: Option<f64>,
    /// How often `--aa adaptive` may divide a pixel [default: 3].
    #[arg(long, value_name = "N", help_heading = "Picture")]
    pub aa_depth: Option<u32>,

    /// How deep mirrored and refracted rays may go [default: 5].
    #[arg(long, visible_alias = "rLimit", value_name = "N", help_heading = "Light")]
    pub recursion: Option<u32>,
    /// The least contribution for which such a ray is traced [default: 0.002].
    #[arg(long, visible_alias = "cLimit", value_name = "X", help_heading = "Light")]
    pub cutoff: Option<f64>,
    /// What stands between a point and a light.
    #[arg(long, value_enum, value_name = "MODE", default_value_t, help_heading = "Light")]
    pub shadows: ShadowMode,
    /// Point lights that stand for one area light [default: 64].
    #[arg(long, value_name = "N", help_heading = "Light")]
    pub light_samples: Option<u32>,
    /// How textures are read between their pixels.
    #[arg(long, value_enum, value_name = "FILTER", default_value_t, help_heading = "Light")]
    pub texture_filter: Filter,
    /// What becomes of a texture whose file is nowhere.
    #[arg(long, value_enum, value_name = "WHAT", default_value_t, help_heading = "Light")]
    pub missing_texture: MissingTexture,

    /// How the nearest shape is found. The colour does not depend on it.
    #[arg(long, value_enum, value_name = "KIND", default_value_t, help_heading = "Speed and limits")]
    pub accel: Accel,
    /// Threads [default: one a core].
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..=1024))]
    #[arg(help_heading = "Speed and limits")]
    pub threads: Option<u16>,

    /// How the scene is read.
    #[command(flatten)]
    pub reading: ReadingArgs,
}

impl ExplainArgs {
    /// The same options for `dotray render`, whose picture is explained.
    pub fn as_render(&self) -> RenderArgs {
        RenderArgs {
            input: Some(self.scene.clone()),
            size: self.size,
            aa: self.aa,
            aa_threshold: self.aa_threshold,
            aa_depth: self.aa_depth,
            recursion: self.recursion,
            cutoff: self.cutoff,
            shadows: self.shadows,
            light_samples: self.light_samples,
            texture_filter: self.texture_filter,
            missing_texture: self.missing_texture,
            accel: self.accel,
            threads: self.threads,
            reading: self.reading.clone(),
            ..RenderArgs::default()
        }
    }
}

/// A place in the picture.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Film(pub f64, pub f64);

impl FromStr for Film {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let number = |part: &str| part.trim().parse::<f64>().ok().filter(|number| number.is_finite());
        let both = text.split_once(',').and_then(|(x, y)| Some(Self(number(x)?, number(y)?)));
        both.ok_or_else(|| "expected x,y in pixels from the lower left, such as 320.5,239.5".to_owned())
    }
}

/// How an explanation is told.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default, ValueEnum)]
pub enum ExplainFormat {
    /// Indented text
    #[default]
    Text,
    /// One JSON object, described in docs/explain.md
    Json,
    /// The rays in the scene, seen from above and from the side
    Svg,
    /// The ray tree for Graphviz
    Dot,
}

/// `dotray tree`.
#[derive(Debug, Args)]
#[command(after_long_help = "\
Examples:
  dotray tree slides.ray                      groups, instances and shapes with their boxes
  dotray tree slides.ray --world              with cumulative matrices
  dotray tree slides.ray --format svg > tree.svg
  dotray tree slides.ray --accel bvh          the figures of an accelerator over it
  dotray tree slides.ray --accel all --format json")]
pub struct TreeArgs {
    /// The scene, or - for standard input.
    #[arg(value_name = "SCENE")]
    pub scene: PathBuf,
    /// For people, for programs, or a drawing of the boxes seen from above, in front and the side.
    #[arg(long, value_enum, value_name = "FORMAT", default_value_t)]
    pub format: TreeFormat,
    /// With each group also its cumulative matrices: objectToWorld and worldToObject.
    #[arg(long)]
    pub world: bool,
    /// Instead of the tree, the figures of an accelerator built over it: depth, leaves, cost, memory.
    #[arg(long, value_enum, value_name = "KIND", conflicts_with = "world")]
    pub accel: Option<AccelOrAll>,
    /// Time for building it against time for tracing.
    #[arg(long, value_enum, value_name = "EFFORT", default_value_t, requires = "accel")]
    pub build: Build,
    /// At most so many lines of shapes a run of shapes, then their number.
    #[arg(long, value_name = "N", default_value_t = 1000)]
    pub shapes: u32,

    /// How the scene is read.
    #[command(flatten)]
    pub reading: ReadingArgs,
}

/// One accelerator or each.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum AccelOrAll {
    /// Every shape is tested
    Brute,
    /// Bounding boxes along the scene's groups
    Boxes,
    /// Octree
    Octree,
    /// Binary space partition
    Bsp,
    /// Bounding-volume hierarchy
    Bvh,
    /// All five
    All,
}

impl AccelOrAll {
    /// Those that are meant.
    pub fn each(self) -> Vec<Accel> {
        match self {
            Self::Brute => vec![Accel::Brute],
            Self::Boxes => vec![Accel::Boxes],
            Self::Octree => vec![Accel::Octree],
            Self::Bsp => vec![Accel::Bsp],
            Self::Bvh => vec![Accel::Bvh],
            Self::All => vec![Accel::Brute, Accel::Boxes, Accel::Octree, Accel::Bsp, Accel::Bvh],
        }
    }
}

/// How a tree is told.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default, ValueEnum)]
pub enum TreeFormat {
    /// Indented text
    #[default]
    Text,
    /// One JSON object, described in docs/explain.md
    Json,
    /// A drawing of the boxes
    Svg,
}
