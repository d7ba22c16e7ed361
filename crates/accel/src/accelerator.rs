//! The five accelerators behind one face.

use crate::input::Boxes;
use crate::input::GroupEvent;
use crate::input::Kind;
use crate::input::Settings;
use crate::query::Batch;
use crate::simd::Level;

/// A structure that finds what a ray meets.
#[derive(Debug)]
pub struct Accelerator {
    kind: Kind,
}

/// What a build gives.
#[derive(Debug)]
pub struct Built {
    /// The structure; its leaves speak of positions.
    pub accelerator: Accelerator,
    /// `order[position]` is the item that stands there; `None` where positions are item numbers. The caller should
    /// lay its own data out in this order, so that a leaf is one block of memory.
    pub order: Option<Vec<u32>>,
}

impl Accelerator {
    /// Builds over `boxes`. The result does not depend on the number of threads.
    pub fn build(kind: Kind, boxes: &impl Boxes, groups: &[GroupEvent], settings: &Settings) -> Built {
        let _ = (boxes, groups, settings);
        Built { accelerator: Self { kind }, order: None }
    }

    /// Which of the five it is.
    pub fn kind(&self) -> Kind {
        self.kind
    }

    /// The bytes it holds.
    pub fn memory(&self) -> usize {
        todo!()
    }

    /// Walks every ray of the batch. `level` says which instructions kernels may use; the calls to the batch are the
    /// same in effect for every level and kind.
    pub fn walk<B: Batch>(&self, level: Level, batch: &mut B) {
        let _ = (level, batch);
        todo!()
    }
}
