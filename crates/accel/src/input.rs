//! What a builder is given.

use dotray_geometry::Aabb;

/// The five ways to find what a ray meets. All give the same picture.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Default)]
pub enum Kind {
    /// Every item is tested: the reference for all others.
    Brute,
    /// Bounding boxes along the scene's own groups.
    Boxes,
    /// An octree.
    Octree,
    /// A binary space partition with axis-aligned planes.
    Bsp,
    /// A bounding-volume hierarchy, the default.
    #[default]
    Bvh,
}

impl Kind {
    /// All of them, in the order of the documentation.
    pub const ALL: [Self; 5] = [Self::Brute, Self::Boxes, Self::Octree, Self::Bsp, Self::Bvh];

    /// The word of the command line.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Brute => "brute",
            Self::Boxes => "boxes",
            Self::Octree => "octree",
            Self::Bsp => "bsp",
            Self::Bvh => "bvh",
        }
    }
}

/// How much building time a better tree is worth.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Default)]
pub enum Quality {
    /// The quickest build.
    Fast,
    /// The best sum of building and tracing for one picture.
    #[default]
    Balanced,
    /// The best tree: for many pictures of one scene.
    Best,
}

/// The most items that one accelerator holds: a leaf's first position has 28 bits, so that a child of a node and its
/// distance fit one 64-bit word. A caller checks this before it builds.
pub const MAX_ITEMS: u32 = (1 << 28) - 8;

/// The items to build over: numbered boxes in the world.
pub trait Boxes: Sync {
    /// How many items there are; item numbers are `0..len`.
    fn len(&self) -> u32;

    /// The item's box; not empty and finite.
    fn bounds(&self, item: u32) -> Aabb;

    /// Whether there is no item.
    fn is_empty(&self) -> bool {
        self.len() == 0
    }
}

/// The scene's groups as one flat walk in file order; only [`Kind::Boxes`] looks at them.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum GroupEvent {
    /// A group begins.
    Open,
    /// The innermost open group ends.
    Close,
    /// `count` items from number `first` on stand here.
    Items {
        /// The first item.
        first: u32,
        /// How many.
        count: u32,
    },
}

/// What the caller chooses about building.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default)]
pub struct Settings {
    /// Building time against tracing time.
    pub quality: Quality,
}
