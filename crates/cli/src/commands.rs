//! The commands, one file each.

mod completions;
mod dump;
mod info;
mod man;
mod render;

use crate::args::Cli;
use crate::args::Command;
use crate::exit::Failure;

/// Does what was asked for.
pub fn run(cli: &Cli) -> Result<(), Failure> {
    match &cli.command {
        Command::Render(typed) => render::run(typed, cli.color),
        Command::Dump(typed) => dump::run(typed, cli.color),
        Command::Info(typed) => info::run(typed, cli.color),
        Command::Man(typed) => man::run(typed),
        Command::Completions(typed) => completions::run(typed),
    }
}
