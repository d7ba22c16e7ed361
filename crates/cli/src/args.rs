//! What was typed: the one table from which the parser, the help, the man page, the completions and docs/cli.md come.

use clap::Args;
use clap::Parser;
use clap::Subcommand;
use std::path::PathBuf;

use crate::check_args::CheckArgs;
use crate::check_args::FormatArgs;
use crate::inspect_args::ExplainArgs;
use crate::inspect_args::TreeArgs;
use crate::judge_args::CompareArgs;
use crate::judge_args::GradeArgs;
use crate::log::LogFormat;
use crate::many_args::AnimateArgs;
use crate::many_args::MergeArgs;
use crate::many_args::PlanArgs;
use crate::many_args::WorkArgs;
use crate::reading_args::DialectName;
use crate::reading_args::LimitArgs;
use crate::reading_args::ReadingArgs;
use crate::render_args::RenderArgs;
use crate::values::TextOrJson;
use crate::values::When;

/// Render scenes written in the .ray language.
#[derive(Debug, Parser)]
#[command(
    name = "dotray",
    bin_name = "dotray",
    version,
    propagate_version = true,
    arg_required_else_help = true,
    subcommand_required = true,
    max_term_width = 100,
    after_help = "Exit codes: 0 done; 1 the scene, the picture or a file is at fault; 2 the command line is; \
                  3 a comparison found too much; 4 a time limit came first; 130 or 143 interrupted.",
    after_long_help = PROGRAM_EXAMPLES
)]
pub struct Cli {
    /// What to do.
    #[command(subcommand)]
    pub command: Command,

    /// Colour in messages: on a terminal only (and not where NO_COLOR is set), always, or never.
    #[arg(long, global = true, value_enum, value_name = "WHEN", default_value_t = When::Auto)]
    #[arg(help_heading = "Messages")]
    pub color: When,
    /// Also say what is being done; twice, of every tile.
    #[arg(short, long, global = true, action = clap::ArgAction::Count, help_heading = "Messages")]
    pub verbose: u8,
    /// Messages for people, or one JSON object a line for programs.
    #[arg(
        long,
        global = true,
        value_enum,
        value_name = "FORMAT",
        default_value_t,
        help_heading = "Messages"
    )]
    pub log_format: LogFormat,
}

const PROGRAM_EXAMPLES: &str = "\
Examples:
  dotray render slides.ray                    picture in slides.png, 640x480
  dotray render slides.ray slides.bmp 800 600
  dotray check slides.ray                     all faults and warnings, with likely repairs
  dotray info slides.ray                      what is in the scene
  dotray dump --world slides.ray              its tree with all matrices
  dotray explain slides.ray 320 240           why a pixel has its colour
  dotray help render                          every option of `render`

Exit codes:
  0    done
  1    the scene, the picture or a file is at fault; nothing was written
  2    the command line is at fault; nothing was read
  3    the pictures differ by more than is forgiven, or the graded program lost points
  4    a time limit came before the end; what is there was written
  130  interrupted (Ctrl-C); nothing was written but what --checkpoint and --partial-every ask for
  143  the same by SIGTERM

Environment:
  NO_COLOR     if set, no colour in messages
  DOTRAY_SIMD  a lower level of vector instructions (scalar, sse2, sse4.2, avx2, avx512, neon); the
               picture does not depend on it";

/// The commands.
#[derive(Debug, Subcommand)]
pub enum Command {
    /// Make a picture of a scene.
    Render(Box<RenderArgs>),
    /// Make the frames of an animation, and a movie of them.
    Animate(Box<AnimateArgs>),
    /// Cut a picture or an animation into pieces for many machines.
    Plan(Box<PlanArgs>),
    /// Compute one piece of a plan.
    Work(WorkArgs),
    /// Put the pieces of a plan together.
    Merge(MergeArgs),
    /// Tell every fault and warning of scenes, with place and likely repair.
    Check(CheckArgs),
    /// Put scene files into their canonical layout; numbers and comments stay as written.
    Format(FormatArgs),
    /// Print a scene's tree: one line a group or shape, as the reader understood it.
    Dump(DumpArgs),
    /// Tell why a pixel has its colour: its rays, what they met, each term of the formula.
    Explain(Box<ExplainArgs>),
    /// Show a scene's tree with the boxes around its groups, or the figures of an accelerator.
    Tree(TreeArgs),
    /// Say what is in a scene: shapes, lights, materials, textures, bounds, camera.
    Info(InfoArgs),
    /// Say how far two pictures are apart; 3 is the exit code where that is too far.
    Compare(CompareArgs),
    /// Run somebody else's ray tracer over a suite of scenes and grade its pictures.
    Grade(GradeArgs),
    /// Write a scene in another dialect, and say what could not be carried over.
    Convert(ConvertArgs),
    /// Show a scene in a window: starts rayview.
    View(ViewArgs),
    /// Help an editor with .ray files: a language server over standard input and output.
    Lsp(LspArgs),
    /// Print a manual page, or the reference in Markdown.
    Man(ManArgs),
    /// Print a completion script for a shell.
    Completions(CompletionsArgs),
}

/// `dotray dump`.
#[derive(Debug, Args)]
pub struct DumpArgs {
    /// The scene, or - for standard input.
    #[arg(value_name = "SCENE")]
    pub scene: PathBuf,

    /// With each group also its cumulative matrices: objectToWorld and worldToObject.
    #[arg(long)]
    pub world: bool,

    /// How the scene is read.
    #[command(flatten)]
    pub reading: ReadingArgs,
}

/// `dotray info`.
#[derive(Debug, Args)]
pub struct InfoArgs {
    /// The scene, or - for standard input.
    #[arg(value_name = "SCENE")]
    pub scene: PathBuf,

    /// For people or for programs.
    #[arg(long, value_enum, value_name = "FORMAT", default_value_t = TextOrJson::Text)]
    pub format: TextOrJson,

    /// How the scene is read.
    #[command(flatten)]
    pub reading: ReadingArgs,
}

/// `dotray view`.
#[derive(Debug, Args)]
pub struct ViewArgs {
    /// The scene.
    #[arg(value_name = "SCENE")]
    pub scene: PathBuf,

    /// Trace at once.
    #[arg(long)]
    pub traced: bool,

    /// Open no window: serve a page on 127.0.0.1 that shows the same, for machines without a display.
    #[arg(long, conflicts_with = "traced")]
    pub serve: bool,

    /// The port of the page; 0 for one that is free.
    #[arg(long, value_name = "PORT", requires = "serve")]
    pub port: Option<u16>,
}

/// `dotray convert`.
#[derive(Debug, Args)]
#[command(after_long_help = "\
Examples:
  dotray convert room.ray slides/room.ray         whatever room.ray is, as the slides have it
  dotray convert slides.ray new.ray --to jhu      for the Johns Hopkins course of today
  dotray convert old.ray - --from hmc             to standard output")]
pub struct ConvertArgs {
    /// The scene, or - for standard input.
    #[arg(value_name = "IN")]
    pub input: PathBuf,

    /// The new file, or - for standard output. Included files are written into it.
    #[arg(value_name = "OUT")]
    pub output: PathBuf,

    /// The dialect of IN; auto finds out from the file and what it includes.
    #[arg(long, value_enum, value_name = "NAME", default_value_t)]
    pub from: DialectName,

    /// The dialect of OUT: slides, uva or jhu; auto is slides.
    #[arg(long, value_enum, value_name = "NAME", default_value_t)]
    pub to: DialectName,

    /// How much the scene may ask for.
    #[command(flatten)]
    pub limits: LimitArgs,
}

/// `dotray lsp`.
#[derive(Debug, Args)]
#[command(after_long_help = "\
Editors start it by themselves; docs/editors.md says how each is told to.")]
pub struct LspArgs {
    /// Speak over standard input and output, which it does anyway; editors like to say so.
    #[arg(long)]
    pub stdio: bool,

    /// How scenes are read.
    #[command(flatten)]
    pub reading: ReadingArgs,
}

/// `dotray man`.
#[derive(Debug, Args)]
#[command(after_long_help = "\
Examples:
  dotray man | man -l -                       read the manual page
  dotray man render > dotray-render.1         the page of one command
  dotray man --markdown > docs/cli.md         the whole reference")]
pub struct ManArgs {
    /// The command whose page is wanted; without it the program's own page.
    #[arg(value_name = "COMMAND")]
    pub command: Option<String>,

    /// The reference of all commands in Markdown instead of roff.
    #[arg(long, conflicts_with = "command")]
    pub markdown: bool,
}

/// `dotray completions`.
#[derive(Debug, Args)]
#[command(after_long_help = "\
Examples:
  dotray completions bash > ~/.local/share/bash-completion/completions/dotray
  dotray completions zsh > ~/.zfunc/_dotray
  dotray completions fish > ~/.config/fish/completions/dotray.fish")]
pub struct CompletionsArgs {
    /// The shell.
    #[arg(value_enum, value_name = "SHELL")]
    pub shell: clap_complete::Shell,
}

/// A first word that is no command but looks like a scene, and what was probably meant.
pub fn forgotten_command(typed: &[std::ffi::OsString]) -> Option<String> {
    let words: Vec<String> = typed.iter().skip(1).map(|word| word.to_string_lossy().into_owned()).collect();
    let first = words.first()?;
    let names_scene = first.to_lowercase().ends_with(".ray") || first.contains('/') || first.contains('\\');
    let old_option = first == "--in" || first.starts_with("--in=");
    if !names_scene && !old_option {
        return None;
    }
    let line = words.iter().map(|word| quoted(word)).collect::<Vec<_>>().join(" ");
    Some(format!("`{first}` is not a command; did you mean `dotray render {line}`?"))
}

/// A word as a shell reads it back.
pub fn quoted(word: &str) -> String {
    let plain = |c: char| c.is_alphanumeric() || "-_./=:,+%@#".contains(c);
    let safe = !word.is_empty() && !word.starts_with('#') && word.chars().all(plain);
    if safe { word.to_owned() } else { format!("'{}'", word.replace('\'', "'\\''")) }
}

#[cfg(test)]
mod tests {
    use super::*;
    use clap::CommandFactory;

    #[test]
    fn the_table_is_sound() {
        Cli::command().debug_assert();
    }

    #[test]
    fn a_scene_in_the_place_of_a_command_is_explained() {
        let typed = |words: &[&str]| forgotten_command(&words.iter().map(Into::into).collect::<Vec<_>>());
        let message = typed(&["dotray", "my scene.ray", "a.png"]).unwrap_or_default();
        assert!(message.contains("did you mean `dotray render 'my scene.ray' a.png`?"), "{message}");
        assert!(typed(&["dotray", "--in", "x"]).is_some());
        assert_eq!(typed(&["dotray", "rendre", "a.ray"]), None);
        assert_eq!(typed(&["dotray"]), None);
    }
}
