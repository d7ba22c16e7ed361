//! `dotray man`: manual pages, and the reference in Markdown.

use clap::Command;
use clap::CommandFactory;
use clap_mangen::Man;

use crate::args::Cli;
use crate::args::ManArgs;
use crate::exit::Failure;
use crate::exit::put;
use crate::reference;

/// Prints the page.
pub fn run(typed: &ManArgs) -> Result<(), Failure> {
    let mut program = Cli::command();
    if typed.markdown {
        return put(reference::markdown(&mut program).as_bytes());
    }
    program.build();
    let page = match &typed.command {
        None => program,
        Some(wanted) => page_of(&program, wanted)?,
    };
    let mut roff = Vec::new();
    let source = concat!("dotray ", env!("CARGO_PKG_VERSION"));
    Man::new(page)
        .source(source)
        .manual("dotray")
        .render(&mut roff)
        .map_err(|error| Failure::Failed(format!("cannot make the manual page: {error}")))?;
    put(&roff)
}

fn page_of(program: &Command, wanted: &str) -> Result<Command, Failure> {
    let found = program.find_subcommand(wanted).cloned();
    found.ok_or_else(|| {
        let names: Vec<&str> = program.get_subcommands().map(Command::get_name).collect();
        Failure::Usage(format!("no command `{wanted}`; there are {}", names.join(", ")))
    })
}
