//! `cargo xtask`: chores of the project.

use clap::Parser;
use clap::Subcommand;
use std::path::PathBuf;
use std::process::ExitCode;

/// Chores of the project.
#[derive(Debug, Parser)]
#[command(name = "xtask", bin_name = "cargo xtask", arg_required_else_help = true)]
struct Cli {
    #[command(subcommand)]
    chore: Chore,
}

#[derive(Debug, Subcommand)]
enum Chore {
    /// Measure dotray beside its peers: pictures, rays, builds, reading.
    Bench(xtask::bench::BenchArgs),
    /// Build the page: rayview for browsers.
    Web(xtask::web::WebArgs),
    /// Run a command as the only child of this process and print its cost as JSON.
    #[command(hide = true)]
    Measure {
        /// Where its output goes.
        #[arg(long)]
        log: PathBuf,
        /// Seconds after which it is stopped.
        #[arg(long)]
        limit: f64,
        /// The command.
        #[arg(last = true, required = true)]
        command: Vec<String>,
    },
}

fn measure(command: &[String], log: &std::path::Path, limit: f64) -> Result<(), String> {
    let (program, arguments) = command.split_first().ok_or("no command")?;
    let usage = xtask::child::run_only_child(program, arguments, log, limit)?;
    println!("{}", serde_json::to_string(&usage).map_err(|fault| fault.to_string())?);
    Ok(())
}

fn main() -> ExitCode {
    xtask::ended(match Cli::parse().chore {
        Chore::Bench(arguments) => xtask::bench::run(&arguments),
        Chore::Web(arguments) => xtask::web::run(&arguments),
        Chore::Measure { log, limit, command } => measure(&command, &log, limit),
    })
}
