//! `dotray completions`: scripts for shells.

use clap::CommandFactory;

use crate::args::Cli;
use crate::args::CompletionsArgs;
use crate::exit::Failure;
use crate::exit::put;

/// Prints the script.
pub fn run(typed: &CompletionsArgs) -> Result<(), Failure> {
    let mut script = Vec::new();
    clap_complete::generate(typed.shell, &mut Cli::command(), "dotray", &mut script);
    put(&script)
}
