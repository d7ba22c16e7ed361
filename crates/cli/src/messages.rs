//! Messages about scenes, in rustc's style, on standard error.

use dotray::scene::Diagnostic;
use dotray::scene::Severity;
use dotray::scene::report::render_text;
use dotray::scene::sources::Sources;
use std::io;
use std::io::IsTerminal;
use std::io::Write;

use crate::log;
use crate::values::When;

/// How messages are printed.
#[derive(Clone, Copy, Debug)]
pub struct Messages {
    /// With colour.
    pub color: bool,
    /// Errors only.
    pub quiet: bool,
}

/// What `--color` means for a stream that is a terminal or is not.
pub fn wants_color(color: When, is_terminal: bool) -> bool {
    let unwanted = |name: &str| std::env::var_os(name).is_some_and(|value| !value.is_empty());
    let dumb = std::env::var_os("TERM").is_some_and(|term| term == "dumb");
    match color {
        When::Always => true,
        When::Never => false,
        When::Auto => is_terminal && !unwanted("NO_COLOR") && !dumb,
    }
}

impl Messages {
    /// What `--color` and `--quiet` mean here.
    pub fn new(color: When, quiet: bool) -> Self {
        Self { color: wants_color(color, io::stderr().is_terminal()), quiet }
    }

    /// Prints messages about a scene to standard error; true if there is an error among them.
    pub fn print(self, diagnostics: &[Diagnostic], sources: &Sources) -> bool {
        let is_error = |diagnostic: &Diagnostic| diagnostic.severity == Severity::Error;
        let shown: Vec<Diagnostic> =
            diagnostics.iter().filter(|&diagnostic| !self.quiet || is_error(diagnostic)).cloned().collect();
        if log::is_json() {
            for diagnostic in &shown {
                let text = render_text(std::slice::from_ref(diagnostic), sources, false);
                match diagnostic.severity {
                    Severity::Error => {
                        tracing::error!(code = diagnostic.code, text, "{}", diagnostic.message)
                    }
                    Severity::Warning => {
                        tracing::warn!(code = diagnostic.code, text, "{}", diagnostic.message)
                    }
                }
            }
        } else if !shown.is_empty() {
            let text = render_text(&shown, sources, self.color);
            // If nobody reads standard error, nothing can be done about it.
            let _ = io::stderr().lock().write_all(text.as_bytes());
        }
        diagnostics.iter().any(is_error)
    }
}
