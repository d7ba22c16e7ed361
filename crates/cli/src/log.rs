//! What the program says of itself on standard error: lines for people, or JSON objects for programs.

use clap::ValueEnum;
use std::io;
use std::io::IsTerminal;
use std::io::Write;
use std::sync::atomic::AtomicBool;
use std::sync::atomic::Ordering;
use tracing::Level;
use tracing_subscriber::fmt;

use crate::values::When;

/// Formats of the log.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default, ValueEnum)]
pub enum LogFormat {
    /// For people
    #[default]
    Text,
    /// One JSON object a line, every message included
    Json,
}

static JSON: AtomicBool = AtomicBool::new(false);

/// Whether messages are JSON objects.
pub fn is_json() -> bool {
    JSON.load(Ordering::Relaxed)
}

/// Starts the log: `verbose` 0 for nothing but messages, 1 for what is being done, 2 for every tile.
pub fn start(verbose: u8, format: LogFormat, color: When) {
    let level = match verbose {
        0 => Level::INFO,
        1 => Level::DEBUG,
        2.. => Level::TRACE,
    };
    let builder = fmt().with_max_level(level).with_writer(io::stderr).log_internal_errors(false);
    // A second start, as in tests, changes nothing.
    let _ = match format {
        LogFormat::Json => {
            JSON.store(true, Ordering::Relaxed);
            let json = builder.json().flatten_event(true).with_current_span(false).with_span_list(false);
            tracing::subscriber::set_global_default(json.with_target(false).finish())
        }
        LogFormat::Text => {
            let ansi = match color {
                When::Always => true,
                When::Never => false,
                When::Auto => io::stderr().is_terminal() && std::env::var_os("NO_COLOR").is_none(),
            };
            let text = builder.without_time().with_target(false).with_ansi(ansi);
            tracing::subscriber::set_global_default(text.finish())
        }
    };
}

/// Prints a line to standard error; if nobody reads there, nothing can be done about it.
pub fn say(line: &str) {
    if !is_json() {
        let _ = writeln!(io::stderr().lock(), "{line}");
        return;
    }
    match line.split_once(": ") {
        Some(("error", message)) => tracing::error!("{message}"),
        Some(("warning", message)) => tracing::warn!("{message}"),
        Some(("note", message)) => tracing::info!("{message}"),
        Some(_) | None => tracing::info!("{line}"),
    }
}
