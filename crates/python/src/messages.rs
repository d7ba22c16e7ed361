//! What is wrong with a scene, as Python has it.

use dotray_scene::Diagnostic;
use dotray_scene::Severity;
use dotray_scene::Sources;
use dotray_scene::report::render_text;
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;

pyo3::create_exception!(
    _dotray,
    SceneError,
    PyValueError,
    "The scene is at fault; the text tells every fault."
);

/// Severity, code, message, (file, line, column), help.
pub type Told = (&'static str, &'static str, String, Option<(String, usize, usize)>, Option<String>);

/// Diagnostics as tuples.
pub fn told(diagnostics: &[Diagnostic], sources: &Sources) -> Vec<Told> {
    let place = |diagnostic: &Diagnostic| {
        let span = diagnostic.span.filter(|span| (span.file.0 as usize) < sources.len())?;
        let position = sources.position(span);
        Some((sources.path(span.file).display().to_string(), position.line, position.column))
    };
    let one = |diagnostic: &Diagnostic| {
        let severity = match diagnostic.severity {
            Severity::Error => "error",
            Severity::Warning => "warning",
        };
        (severity, diagnostic.code, diagnostic.message.clone(), place(diagnostic), diagnostic.help.clone())
    };
    diagnostics.iter().map(one).collect()
}

/// The exception that tells them.
pub fn scene_error(mut diagnostics: Vec<Diagnostic>, sources: &Sources) -> PyErr {
    without_places(&mut diagnostics, sources);
    SceneError::new_err(render_text(&diagnostics, sources, false).trim_end().to_owned())
}

/// Takes away places in text that nobody has written: a scene of arrays has none.
fn without_places(diagnostics: &mut [Diagnostic], sources: &Sources) {
    for diagnostic in diagnostics.iter_mut().filter(|_| sources.is_empty()) {
        diagnostic.span = None;
        diagnostic.notes.iter_mut().for_each(|note| note.0 = None);
    }
}
