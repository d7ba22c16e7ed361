//! What was typed after `dotray compare` and `dotray grade`.

use clap::Args;
use std::path::PathBuf;

use crate::values::ProfileName;
use crate::values::TextOrJson;

/// `dotray compare`.
#[derive(Debug, Args)]
#[command(after_long_help = COMPARE_EXAMPLES)]
pub struct CompareArgs {
    /// A picture: the reference, where there is one.
    #[arg(value_name = "A")]
    pub a: PathBuf,

    /// Another picture of the same size.
    #[arg(value_name = "B")]
    pub b: PathBuf,

    /// What is forgiven.
    #[arg(long, value_enum, value_name = "PROFILE", default_value_t)]
    pub profile: ProfileName,

    /// The difference above which a pixel counts as over, for values from 0 to 1 [default: the profile's].
    #[arg(long, value_name = "X", value_parser = tolerance)]
    pub tolerance: Option<f64>,

    /// Write a picture of three parts: A, eight times the difference, B.
    #[arg(long, value_name = "FILE")]
    pub picture: Option<PathBuf>,

    /// Write FLIP of every pixel as a grey picture: black where nothing is seen, white where most is.
    #[arg(long, value_name = "FILE")]
    pub flip_picture: Option<PathBuf>,

    /// For people or for programs.
    #[arg(long, value_enum, value_name = "FORMAT", default_value_t = TextOrJson::Text)]
    pub format: TextOrJson,
}

/// `dotray grade`.
#[derive(Debug, Args)]
#[command(after_long_help = GRADE_EXAMPLES)]
pub struct GradeArgs {
    /// The suite: its TOML file, or a folder with a suite.toml.
    #[arg(value_name = "SUITE")]
    pub suite: PathBuf,

    /// The command to be graded, with {scene} {output} {width} {height} {recursion} {cutoff} {arguments} where these
    /// stand; split into words as a shell would, but no shell runs it. Without it, the suite's tests are listed.
    #[arg(long, value_name = "COMMAND")]
    pub program: Option<String>,

    /// Tests that run side by side [default: one a core].
    #[arg(short, long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..=1024))]
    pub jobs: Option<u16>,

    /// Only these tests, by their names.
    #[arg(long, value_name = "NAME", value_delimiter = ',')]
    pub only: Vec<String>,

    /// Print no table.
    #[arg(short, long)]
    pub quiet: bool,

    /// One page for a browser: pictures side by side, difference, flicker.
    #[arg(long, value_name = "FILE", help_heading = REPORTS)]
    pub html: Option<PathBuf>,

    /// Everything but the pictures.
    #[arg(long, value_name = "FILE", help_heading = REPORTS)]
    pub json: Option<PathBuf>,

    /// JUnit XML, for continuous integration.
    #[arg(long, value_name = "FILE", help_heading = REPORTS)]
    pub junit: Option<PathBuf>,

    /// results.json, as Gradescope reads it.
    #[arg(long, value_name = "FILE", help_heading = REPORTS)]
    pub gradescope: Option<PathBuf>,
}

const REPORTS: &str = "Reports";

fn tolerance(text: &str) -> Result<f64, String> {
    let value = text.parse().ok().filter(|value: &f64| value.is_finite() && *value >= 0.0);
    value.ok_or_else(|| "expected a number of 0 or more, such as 0.01".to_owned())
}

const COMPARE_EXAMPLES: &str = "\
Profiles; a figure that is over ends the program with 3:
  exact    no sample differs by more than half a step of 1/255: forgives the rounding to 8 bits, nothing
           else. For the same program on another machine, or another file format.
  strict   99.5 % of the pixels within 2/255, mean difference at most 0.5/255, no 8x8 block with a mean
           difference above 0.08: forgives single pixels on silhouettes and shadow edges. For another
           correct program in double precision.
  lenient  95 % of the pixels within 8/255, mean difference at most 3/255, no 8x8 block above 0.2, FLIP at
           most 0.05: forgives noise, soft shadows with other samples, other oversampling of edges, single
           precision. A missing light, shadow or highlight is not forgiven.

Figures, of red, green and blue from 0 to 1 (and alpha where a picture has it):
  mean, max, RMSE, PSNR  of the absolute differences; PSNR in decibels for a peak of 1
  SSIM    structural similarity of the luma, 1 for equal pictures (Wang and others 2004: Gaussian window of
          11x11, sigma 1.5)
  FLIP    what a viewer sees who flips between both, mean over the pixels, 0 to 1 (Andersson and others 2020,
          67 pixels a degree)
  block   mean difference of the 8x8 block that differs most, in the channel where it does
Where only one of the files holds floats, its values are first clamped to 0 to 1, as the other's were.

Examples:
  dotray compare truth.png mine.bmp
  dotray compare truth.exr mine.exr --profile lenient --picture both.png
  dotray compare old.png new.png --format json | jq .flip.mean

Exit codes: 0 within the profile; 1 a file is at fault, or the sizes differ; 2 the command line is; 3 over.";

const GRADE_EXAMPLES: &str = "\
The program runs once for each test, in a folder of its own that is removed afterwards, with copies of the
scene's files. A crash, a hang, or output without end costs that test only: there are limits on time, memory
and files, and every process that it leaves behind is ended. This is no sandbox: a program that means harm can
do what your account can. docs/grading.md says how a suite is written.

Examples:
  dotray grade grading                                    what the ready suite holds
  dotray grade grading --program './raytracer {scene} {output} {width} {height} {recursion} {cutoff}'
  dotray grade grading --program 'python3 ray.py {scene} -o {output} -s {width}x{height}' --html page.html
  dotray grade grading --program \"$CMD\" --only sphere,camera --jobs 1

Exit codes: 0 all points; 1 the suite or a report's file is at fault; 2 the command line is; 3 points were lost;
130 interrupted.";
