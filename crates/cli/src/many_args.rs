//! What was typed about many pictures and many machines.

use clap::Args;
use std::path::PathBuf;
use std::str::FromStr;

use crate::render_args::RenderArgs;
use crate::values::Depth;
use crate::values::FormatName;

/// Frames `first` to `last`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct FrameRange {
    /// The first.
    pub first: u32,
    /// The last.
    pub last: u32,
}

/// So many frames are an hour at 24 a second, twelve times over.
const MOST_FRAMES: u32 = 1_000_000;

impl FromStr for FrameRange {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let (first, last) = text.split_once('-').unwrap_or((text, text));
        match (first.trim().parse(), last.trim().parse()) {
            (Ok(first), Ok(last)) if first <= last && last - first < MOST_FRAMES => Ok(Self { first, last }),
            (Ok(_) | Err(_), _) => Err("expected frames such as 1-48, or one such as 7".to_owned()),
        }
    }
}

/// `dotray animate`.
#[derive(Debug, Args)]
#[command(
    override_usage = "dotray animate SCENE --animation FILE --frames A-B -o out.####.png [OPTIONS]",
    after_long_help = "\
Every option of `dotray render` that says how a picture is made may be given. A frame that is there is not made again:
to go on after an interruption, run the same command. docs/long.md shows how an animation is written.

Examples:
  dotray animate room.ray --animation turn.toml --frames 1-48 -o out.####.png
  dotray animate room.ray --animation turn.toml --frames 1-48 -o out.####.png --movie out.mp4 --fps 24"
)]
pub struct AnimateArgs {
    /// The camera's path and the groups' transforms, as TOML.
    #[arg(long, value_name = "FILE", help_heading = "Animation")]
    pub animation: PathBuf,
    /// The frames.
    #[arg(long, value_name = "A-B", help_heading = "Animation")]
    pub frames: FrameRange,
    /// Also join all frames to a movie, .mp4, .gif or .webp, by the program ffmpeg.
    #[arg(long, value_name = "FILE", help_heading = "Animation")]
    pub movie: Option<PathBuf>,
    /// Frames a second of the movie.
    #[arg(long, value_name = "N", default_value_t = 24, value_parser = clap::value_parser!(u16).range(1..=240))]
    #[arg(help_heading = "Animation")]
    pub fps: u16,

    /// How each frame is made.
    #[command(flatten)]
    pub render: RenderArgs,
}

/// `dotray plan`.
#[derive(Debug, Args)]
#[command(
    override_usage = "dotray plan SCENE -o PLAN --pieces N [--animation FILE --frames A-B] [OPTIONS]",
    after_long_help = "\
Every option of `dotray render` that says how a picture is made may be given; the plan remembers them. Pieces are cut by
what a coarse look at the picture cost, so that they take about the same time.

Examples:
  dotray plan room.ray -o room.plan --pieces 64 --size 4000x3000 --aa adaptive
  dotray plan room.ray -o room.plan --pieces 200 --animation turn.toml --frames 1-480"
)]
pub struct PlanArgs {
    /// How many pieces, numbered from 0.
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=1_000_000))]
    #[arg(help_heading = "Pieces")]
    pub pieces: u32,
    /// The camera's path and the groups' transforms, as TOML.
    #[arg(long, value_name = "FILE", requires = "frames", help_heading = "Animation")]
    pub animation: Option<PathBuf>,
    /// The frames.
    #[arg(long, value_name = "A-B", requires = "animation", help_heading = "Animation")]
    pub frames: Option<FrameRange>,

    /// How each picture is made; its output is the plan's file.
    #[command(flatten)]
    pub render: RenderArgs,
}

/// `dotray work`.
#[derive(Debug, Args)]
#[command(after_long_help = "\
A piece that is there and whole is not made again, and appears whole or not at all: the same command may run twice, at
the same time even. The scene is looked for where the plan names it, seen from the working directory.

Examples:
  dotray work room.plan --piece 7 -o pieces
  seq 0 63 | parallel dotray work room.plan --threads 1 -o pieces --piece {}")]
pub struct WorkArgs {
    /// The plan.
    #[arg(value_name = "PLAN")]
    pub plan: PathBuf,
    /// The number of the piece, from 0.
    #[arg(long, value_name = "N")]
    pub piece: u32,
    /// The folder that the piece goes into; it is made where it is not there.
    #[arg(short, long = "output", visible_alias = "out", value_name = "FOLDER")]
    pub output: PathBuf,
    /// Threads [default: one a core].
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..=1024))]
    pub threads: Option<u16>,
    /// How progress is shown on standard error.
    #[arg(long, value_enum, value_name = "HOW", default_value_t)]
    pub progress: crate::long_args::ProgressName,
}

/// `dotray merge`.
#[derive(Debug, Args)]
#[command(after_long_help = "\
Neither scene nor textures are needed. Where pieces are missing or damaged, their numbers are told and the exit code is
1; of an animation, the frames that are whole are written.

Examples:
  dotray merge room.plan pieces -o room.png
  dotray merge turn.plan pieces -o out.####.png")]
pub struct MergeArgs {
    /// The plan.
    #[arg(value_name = "PLAN")]
    pub plan: PathBuf,
    /// The folder of the pieces.
    #[arg(value_name = "FOLDER")]
    pub folder: PathBuf,
    /// The picture; #### in its name stands for the number of a frame.
    #[arg(short, long = "output", visible_alias = "out", value_name = "FILE")]
    pub output: PathBuf,
    /// The picture's format, whatever its name says.
    #[arg(long, value_enum, value_name = "NAME")]
    pub format: Option<FormatName>,
    /// Bits a channel of a PNG [default: 8].
    #[arg(long, value_enum, value_name = "BITS")]
    pub depth: Option<Depth>,
    /// Quality of a JPEG, 1 to 100 [default: 95].
    #[arg(long, value_name = "Q", value_parser = clap::value_parser!(u8).range(1..=100))]
    pub jpeg_quality: Option<u8>,
    /// Store with the sRGB curve.
    #[arg(long)]
    pub srgb: bool,
    /// Print nothing but errors.
    #[arg(short, long)]
    pub quiet: bool,
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn frames_are_read() {
        assert_eq!("1-48".parse(), Ok(FrameRange { first: 1, last: 48 }));
        assert_eq!("7".parse(), Ok(FrameRange { first: 7, last: 7 }));
        for wrong in ["", "-", "5-4", "1-", "-1", "0-4000000000", "a-b", "1-2-3"] {
            assert!(wrong.parse::<FrameRange>().is_err(), "{wrong}");
        }
    }
}
