//! Shapes that stand twice: exact ties go to the first, so no ray meets the second.

use super::Standing;
use super::standing;
use crate::diagnostic::Diagnostic;
use crate::diagnostic::Sink;
use crate::resolved::Resolved;
use std::hash::DefaultHasher;
use std::hash::Hash;
use std::hash::Hasher;

/// Larger scenes are not searched: it would take 16 bytes a shape.
const MOST_SHAPES: u32 = 1 << 22;

/// Shapes whose boxes agree are compared with so many before them; the halves of a square share one box.
const COMPARED: usize = 8;

/// Warns of each shape that equals an earlier one.
pub fn find(scene: &Resolved, sink: &mut Sink) {
    if scene.shape_count > MOST_SHAPES {
        return;
    }
    let mut keys: Vec<(u64, u32)> = (0..).zip(standing(scene)).map(|(number, s)| (key(&s), number)).collect();
    keys.sort_unstable();
    let mut pairs = Vec::new();
    for group in keys.chunk_by(|a, b| a.0 == b.0).filter(|group| group.len() > 1) {
        for (place, (_, number)) in group.iter().enumerate().skip(1) {
            let earlier = group.get(place.saturating_sub(COMPARED)..place).unwrap_or_default();
            let same = earlier.iter().find(|(_, earlier)| equal(scene, *earlier, *number));
            pairs.extend(same.map(|(_, earlier)| (*number, *earlier)));
        }
    }
    pairs.sort_unstable();
    for (number, earlier) in pairs {
        sink.warn("duplicate-shape", || message(scene, number, earlier));
    }
}

fn message(scene: &Resolved, number: u32, earlier: u32) -> Diagnostic {
    let (Some(shape), Some(earlier)) = (nth(scene, number), nth(scene, earlier)) else {
        return Diagnostic::warning("duplicate-shape", "a shape stands twice");
    };
    let message = format!("the same `{}` stands here twice; rays meet the first one only", shape.word());
    let (here, there) = (shape.span(scene), earlier.span(scene));
    let warning = Diagnostic::warning("duplicate-shape", message).at(here).label("no ray meets it");
    if here == there {
        warning.note("its file is placed twice at the same place")
    } else {
        warning.note_at(there, "the first one stands here")
    }
}

fn equal(scene: &Resolved, a: u32, b: u32) -> bool {
    match (nth(scene, a), nth(scene, b)) {
        (Some(a), Some(b)) => a.shape == b.shape && a.world_from_object == b.world_from_object,
        (None, _) | (_, None) => false,
    }
}

/// The shape of a scene-wide number.
fn nth(scene: &Resolved, number: u32) -> Option<Standing<'_>> {
    let after = scene.runs.partition_point(|run| run.first_shape <= number);
    let run = scene.runs.get(after.checked_sub(1)?)?;
    let entry = run.first as usize + (number - run.first_shape) as usize;
    let shape = scene.files.get(run.file.0 as usize)?.shape(run.kind, entry)?;
    Some(Standing { run, entry, shape, world_from_object: scene.frames.get(run.frame as usize)? })
}

/// Equal for equal shapes: their world boxes, bit for bit.
fn key(standing: &Standing<'_>) -> u64 {
    let bounds = standing.bounds();
    let mut hasher = DefaultHasher::new();
    standing.run.kind.hash(&mut hasher);
    for value in bounds.min.to_array().into_iter().chain(bounds.max.to_array()) {
        // -0 and 0 are equal.
        (value + 0.0).to_bits().hash(&mut hasher);
    }
    hasher.finish()
}
