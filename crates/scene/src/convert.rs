//! A scene of one dialect in the words of another, with all that they cannot say.

mod bumps;
mod carry;
mod colors;
mod hmc;
mod inline;

use crate::diagnostic::Diagnostic;
use crate::dialect::Dialect;
use crate::model::Scene;
use crate::model::SceneFile;
use crate::walk::WalkError;
use crate::write;

/// What becomes of a scene.
#[derive(Clone, Debug)]
pub struct Converted {
    /// One file, includes written into it.
    pub file: SceneFile,
    /// Its text.
    pub text: String,
    /// A warning for everything that could not be carried over.
    pub lost: Vec<Diagnostic>,
}

/// Why a scene cannot be converted.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum ConvertError {
    /// The tree of files cannot be walked.
    #[error(transparent)]
    Walk(#[from] WalkError),
    /// Instances multiply to more shapes than one file should hold.
    #[error("the instances multiply to more than {0} shapes")]
    TooManyShapes(u64),
}

/// More shapes than this are written only where the files hold them themselves.
const MOST_SHAPES: u64 = 10_000_000;

/// Puts a scene into the words of a dialect. `texture` gives the name under which the new file finds a texture, from
/// the file that names it and the name there.
///
/// # Errors
/// [`ConvertError`]
pub fn convert(
    scene: &Scene,
    to: Dialect,
    texture: &dyn Fn(&SceneFile, &str) -> String,
) -> Result<Converted, ConvertError> {
    let file = inline::inline(&scene.files, texture)?;
    let mut lost = Vec::new();
    let file = carry::carry(&scene.files, file, to, &mut lost);
    let text = write::write(&file);
    lost.sort_by_key(|warning: &Diagnostic| warning.span.map(|span| (span.file, span.start)));
    Ok(Converted { file, text, lost })
}
