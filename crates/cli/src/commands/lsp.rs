//! `dotray lsp`: help for editors.

use crate::args::LspArgs;
use crate::exit::Failure;

/// Serves one editor until it says goodbye.
pub fn run(typed: &LspArgs) -> Result<(), Failure> {
    dotray_lsp::serve(typed.reading.dialect.chosen()).map_err(|error| Failure::Failed(error.to_string()))
}
