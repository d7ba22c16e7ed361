//! What was typed for the commands that look after scene files: `check` and `format`.

use clap::Args;
use clap::ValueEnum;
use std::path::PathBuf;

use crate::reading_args::ReadingArgs;

/// `dotray check`.
#[derive(Debug, Args)]
#[command(after_long_help = "\
Each message begins FILE:LINE:COLUMN: error[CODE]; docs/messages.md lists all codes and the keys of the JSON.

Examples:
  dotray check scene.ray                        all faults and warnings of a scene and what it includes
  dotray check --strict scenes                  all .ray files below a folder; warnings count, too
  dotray check --format sarif . > dotray.sarif  for code scanning
  dotray check --explain half-angle             what a code means, with an example
  dotray check --explain list                   all codes

Exit codes: 0 no fault; 1 faults (with --strict also warnings); 2 the command line is at fault.")]
pub struct CheckArgs {
    /// Scenes, folders (all .ray files in and below them), or - for standard input.
    #[arg(value_name = "FILES", required_unless_present = "explain")]
    pub files: Vec<PathBuf>,

    /// How the messages are printed.
    #[arg(long, value_enum, value_name = "FORMAT", default_value_t = CheckFormat::Text)]
    pub format: CheckFormat,

    /// Warnings count as errors for the exit code.
    #[arg(long)]
    pub strict: bool,

    /// Explain a code at length, with an example; `list` prints all codes.
    #[arg(long, value_name = "CODE", conflicts_with_all = ["files", "strict"])]
    pub explain: Option<String>,

    /// How the scenes are read.
    #[command(flatten)]
    pub reading: ReadingArgs,
}

/// How `check` prints.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum CheckFormat {
    /// For people, with source lines
    Text,
    /// One JSON object
    Json,
    /// Workflow commands that GitHub shows beside the lines
    Github,
    /// A SARIF 2.1.0 log
    Sarif,
}

/// `dotray format`.
#[derive(Debug, Args)]
#[command(after_long_help = "\
The layout: each directive begins a line, in lower case, two blanks deeper for each group around it. One
blank parts arguments, two part groups of arguments: `#camera 0 0 4  0 0 -1  0 1 0  .5`. What does not fit
in 100 columns goes on in further lines, two blanks deeper; a matrix then stands row by row. Comments keep
their words and their places: behind something or on a line of their own; between arguments they make each
group of arguments a line of its own. Of several empty lines one stays. Numbers stay as they are written.

The meaning never changes. A file whose tokens are not certain (something is not closed, misspelt, or has
the wrong number of arguments) is told of and stays as it is.

Examples:
  dotray format scene.ray                       put a file in order
  dotray format --check scenes                  name the files that are not in order, with what would change
  dotray format - < scene.ray                   to standard output

Exit codes: 0 done; 1 a file is at fault or, with --check, would change; 2 the command line is at fault.")]
pub struct FormatArgs {
    /// Scenes, folders (all .ray files in and below them), or - for standard input to standard output.
    #[arg(value_name = "FILES", required = true)]
    pub files: Vec<PathBuf>,

    /// Change nothing; name the files that would change, with the first lines that would.
    #[arg(long)]
    pub check: bool,

    /// Print to standard output instead of replacing files.
    #[arg(long, conflicts_with = "check")]
    pub stdout: bool,

    /// How the files are read.
    #[command(flatten)]
    pub reading: ReadingArgs,
}
