//! The program `dotray`: what was typed, what it means, and the commands.
//!
//! The order of the `mod` lines is the floor order: a module uses only modules listed above it.

mod values;

mod reading_args;

mod layer_args;

mod long_args;

mod render_args;

mod many_args;

mod check_args;

mod judge_args;

mod inspect_args;

mod log;

mod args;

mod events;

mod exit;

mod meaning;

mod scenes;

mod diff;

mod storage;

mod plan;

mod messages;

mod interrupt;

mod progress;

mod cost;

mod limits;

mod input;

mod places;

mod drawing;

mod explain;

mod tree;

mod textures;

mod findings;

mod output;

mod background;

mod overlay;

mod layers;

mod extras;

mod keep;

mod making;

mod curve;

mod keyframes;

mod groups;

mod numbered;

mod pieces;

mod stage;

mod movie;

mod reference;

mod commands;

use clap::Parser;
use std::ffi::OsString;
use std::process::ExitCode;

#[global_allocator]
static ALLOCATOR: dotray_memory::HugePages = dotray_memory::HugePages;

fn main() -> ExitCode {
    let typed: Vec<OsString> = std::env::args_os().collect();
    if let Some(message) = args::forgotten_command(&typed) {
        return exit::Failure::Usage(message).report().into();
    }
    match args::Cli::try_parse_from(typed) {
        Ok(cli) => {
            log::start(cli.verbose, cli.log_format, cli.color);
            let exit = commands::run(&cli).map_or_else(|failure| failure.report(), |()| 0);
            events::end(exit);
            ExitCode::from(exit)
        }
        Err(error) => {
            // Help goes to standard output, a fault to standard error; a reader who has gone is no fault of ours.
            let _ = error.print();
            ExitCode::from(u8::try_from(error.exit_code()).unwrap_or(2))
        }
    }
}
