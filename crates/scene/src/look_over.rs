//! Everything that there is to say about a scene: for whoever checks it, in a terminal or in an editor.

use crate::context::name_groups;
use crate::diagnostic::Diagnostic;
use crate::lint::lint;
use crate::load::Loaded;
use crate::resolve;
use crate::resolved::ResolvedTexture;
use crate::sources::Sources;
use crate::span::FileId;
use crate::textures::named_in;

/// The messages of reading, resolving and looking a scene over, in the order of its files and places. `textures` says
/// what is wrong with the scene's textures; it is shown those of a scene with faults elsewhere, too.
pub fn look_over(
    loaded: Loaded,
    limits: &resolve::Limits,
    textures: impl FnOnce(&[ResolvedTexture]) -> Vec<Diagnostic>,
) -> (Vec<Diagnostic>, Sources) {
    let Loaded { scene, mut diagnostics, sources, dialect, .. } = loaded;
    let mut resolved = None;
    if let Some(outcome) = scene.map(|scene| resolve::resolve_within(scene, limits)) {
        diagnostics.extend(outcome.diagnostics);
        resolved = outcome.resolved;
    }
    match &resolved {
        Some(resolved) => {
            diagnostics.extend(textures(&resolved.textures));
            diagnostics.extend(lint(resolved));
        }
        None => diagnostics.extend(textures(&named_in(&sources, dialect))),
    }
    name_groups(&mut diagnostics, &sources);
    diagnostics.sort_by_key(|diagnostic| match diagnostic.span {
        Some(span) => (false, span.file, span.start),
        None => (true, FileId(0), u64::from(diagnostic.code == "too-many-errors")),
    });
    (diagnostics, sources)
}
