//! Places in source files.

/// The number of a file in [`crate::model::Scene::files`]; 0 is the file that was asked for.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash, Default)]
pub struct FileId(pub u32);

/// Bytes `start .. end` of a file.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash, Default)]
pub struct Span {
    /// Which file.
    pub file: FileId,
    /// The first byte.
    pub start: u64,
    /// The byte after the last.
    pub end: u64,
}

impl Span {
    /// Bytes `start .. end` of `file`.
    pub fn new(file: FileId, start: usize, end: usize) -> Self {
        Self { file, start: start as u64, end: end as u64 }
    }
}

/// Where each shape's directive begins: four bytes a shape, for files of any size.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct PackedStarts {
    blocks: Vec<u64>,
    offsets: Vec<u32>,
}

impl PackedStarts {
    const BLOCK: usize = 1 << 12;

    /// Appends the byte offset of the next shape; offsets do not fall.
    pub fn push(&mut self, start: u64) {
        if self.offsets.len().is_multiple_of(Self::BLOCK) {
            self.blocks.push(start);
        }
        let base = self.blocks.last().copied().unwrap_or(0);
        self.offsets.push(u32::try_from(start.saturating_sub(base)).unwrap_or(u32::MAX));
    }

    /// Appends those of another list of the same file.
    pub fn extend(&mut self, other: &Self) {
        let bases = other.blocks.iter().zip(other.offsets.chunks(Self::BLOCK));
        bases
            .flat_map(|(base, offsets)| offsets.iter().map(move |&offset| base + u64::from(offset)))
            .for_each(|start| self.push(start));
    }

    /// The byte offset of shape `index`.
    pub fn get(&self, index: usize) -> Option<u64> {
        let base = self.blocks.get(index / Self::BLOCK)?;
        Some(base + u64::from(*self.offsets.get(index)?))
    }

    /// How many there are.
    pub fn len(&self) -> usize {
        self.offsets.len()
    }

    /// Whether there is none.
    pub fn is_empty(&self) -> bool {
        self.offsets.is_empty()
    }
}
