//! The commands, one file each.

mod animate;
mod check;
mod compare;
mod completions;
mod convert;
mod dump;
mod explain;
mod format;
mod grade;
mod info;
mod lsp;
mod man;
mod merge;
mod plan;
mod render;
mod tree;
mod view;
mod work;

use crate::args::Cli;
use crate::args::Command;
use crate::exit::Failure;

/// Does what was asked for.
pub fn run(cli: &Cli) -> Result<(), Failure> {
    match &cli.command {
        Command::Render(typed) => render::run(typed, cli.color),
        Command::Animate(typed) => animate::run(typed, cli.color),
        Command::Plan(typed) => plan::run(typed, cli.color),
        Command::Work(typed) => work::run(typed, cli.color),
        Command::Merge(typed) => merge::run(typed),
        Command::Check(typed) => check::run(typed, cli.color),
        Command::Format(typed) => format::run(typed, cli.color),
        Command::Dump(typed) => dump::run(typed, cli.color),
        Command::Explain(typed) => explain::run(typed, cli.color),
        Command::Tree(typed) => tree::run(typed, cli.color),
        Command::Info(typed) => info::run(typed, cli.color),
        Command::Convert(typed) => convert::run(typed, cli.color),
        Command::Grade(typed) => grade::run(typed),
        Command::Compare(typed) => compare::run(typed),
        Command::View(typed) => view::run(typed),
        Command::Lsp(typed) => lsp::run(typed),
        Command::Man(typed) => man::run(typed),
        Command::Completions(typed) => completions::run(typed),
    }
}
