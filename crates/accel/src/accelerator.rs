//! The five accelerators behind one face.

use crate::ahead;
use crate::batch::Batch;
use crate::box_tree;
use crate::brute;
use crate::bsp::Bsp;
use crate::bvh;
use crate::bvh::Builder;
use crate::bvh::Child;
use crate::bvh::Tree;
use crate::bvh::build::MAX_STACK;
use crate::bvh::partition::Reference;
use crate::bvh::wide::WIDTH;
use crate::input::Boxes;
use crate::input::GroupEvent;
use crate::input::Kind;
use crate::input::MAX_ITEMS;
use crate::input::Settings;
use crate::narrow::Frame;
use crate::octree::Octree;
use crate::query::Queries;
use crate::simd::Level;
use crate::simd::dispatch;
use crate::simd::level;
use crate::stats::Cell;
use crate::stats::Defect;
use crate::stats::Stats;
use dotray_geometry::Aabb;
use rayon::prelude::*;

/// A structure that finds what a ray meets.
#[derive(Debug)]
pub struct Accelerator {
    kind: Kind,
    items: u32,
    bounds: Aabb,
    structure: Structure,
    is_far: bool,
}

/// What the five hold. A box tree and a BVH are walked alike.
#[derive(Debug)]
enum Structure {
    Brute,
    Tree(Tree),
    Octree(Octree),
    Bsp(Bsp),
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

/// Trees of as many nodes (3.5 MB), and the shapes in their leaves, do not fit the memory next to a processor.
const FAR: usize = 1 << 14;

/// Nor do smaller ones with the shapes in their leaves; but it helps to ask in advance only where a ray reads little of
/// them, as in a mesh. (Among 100,000 spheres or cylinders, random rays took 5 to 15 % longer.)
const RATHER_FAR: usize = 1 << 11;

/// As many tests are expected of a ray that reads little.
const FEW_TESTS: f64 = 12.0;

impl Accelerator {
    /// Builds over `boxes`. The result does not depend on the number of threads.
    ///
    /// While it grows, a BVH takes 32 bytes an item besides the order and itself (about 12).
    ///
    /// # Panics
    /// Where there are more than [`MAX_ITEMS`] items.
    pub fn build(kind: Kind, boxes: &impl Boxes, groups: &[GroupEvent], settings: &Settings) -> Built {
        let items = boxes.len();
        assert!(items <= MAX_ITEMS, "an accelerator holds at most {MAX_ITEMS} items");
        let bounds = union(boxes);
        let structure = |structure| {
            let is_far = is_far(&structure, kind, items);
            Self { kind, items, bounds, structure, is_far }
        };
        if items == 0 {
            return Built { accelerator: structure(Structure::Brute), order: None };
        }
        let frame = Frame::around(bounds);
        match kind {
            Kind::Brute => Built { accelerator: structure(Structure::Brute), order: None },
            Kind::Octree => {
                let octree = Octree::build(boxes, bounds);
                Built { accelerator: structure(Structure::Octree(octree)), order: None }
            }
            Kind::Bsp => {
                let bsp = Bsp::build(boxes, bounds);
                Built { accelerator: structure(Structure::Bsp(bsp)), order: None }
            }
            Kind::Boxes => {
                let (tree, order) = box_tree::build(boxes, groups, frame);
                Built { accelerator: structure(Structure::Tree(tree)), order: Some(order) }
            }
            Kind::Bvh => {
                let (tree, order) = build_bvh(boxes, frame, settings);
                Built { accelerator: structure(Structure::Tree(tree)), order: Some(order) }
            }
        }
    }

    /// Fits the boxes to items that have moved, without building anew; `order` is what the build gave. The answers
    /// stay exact, but the further items have moved from where they stood, the more boxes a ray has to test. False,
    /// and nothing done, for an octree or a BSP tree, whose cells do not move with the items: build those anew.
    ///
    /// # Panics
    /// Where the number of items has changed.
    pub fn refit(&mut self, boxes: &impl Boxes, order: Option<&[u32]>) -> bool {
        assert_eq!(boxes.len(), self.items, "refitting needs the items that the structure was built over");
        let bounds = union(boxes);
        match &mut self.structure {
            Structure::Brute => {}
            Structure::Tree(tree) => tree.refit(boxes, order.unwrap_or_default(), bounds),
            Structure::Octree(_) | Structure::Bsp(_) => return false,
        }
        self.bounds = bounds;
        true
    }

    /// Which of the five it is.
    pub fn kind(&self) -> Kind {
        self.kind
    }

    /// The box around all items; empty where there is none.
    pub fn bounds(&self) -> Aabb {
        self.bounds
    }

    /// Whether its walks call [`Batch::leaf_block`] and [`Batch::leaf_packet`], with rays in the single precision of
    /// [`Frame::around`] its bounds.
    pub fn shows_blocks(&self) -> bool {
        matches!(self.structure, Structure::Tree(_))
    }

    /// Whether it, and what its leaves hold, is so large that walks wait for memory, and it helps to ask in advance.
    pub fn is_far(&self) -> bool {
        self.is_far
    }

    /// Every leaf that its walks show as a block: the first position and the count. Each position lies in one of them.
    /// None of an accelerator that shows no blocks.
    pub fn each_leaf(&self, leaf: &mut dyn FnMut(u32, u32)) {
        match &self.structure {
            Structure::Tree(tree) => tree.each_leaf(leaf),
            Structure::Brute | Structure::Octree(_) | Structure::Bsp(_) => {}
        }
    }

    /// The bytes it holds.
    pub fn memory(&self) -> usize {
        size_of::<Self>()
            + match &self.structure {
                Structure::Brute => 0,
                Structure::Tree(tree) => tree.memory(),
                Structure::Octree(octree) => octree.memory(),
                Structure::Bsp(bsp) => bsp.memory(),
            }
    }

    /// Its figures, for dumps; this looks at every node.
    pub fn stats(&self) -> Stats {
        let stats = match &self.structure {
            Structure::Brute => {
                let mut stats = Stats { items: self.items, ..Stats::empty(self.kind) };
                stats.leaf(self.items as usize, 1.0, 0);
                stats
            }
            Structure::Tree(tree) => tree.stats(self.kind, self.items),
            Structure::Octree(octree) => octree.stats(),
            Structure::Bsp(bsp) => bsp.stats(),
        };
        Stats { bytes: self.memory(), ..stats }
    }

    /// Its boxes (or cells), level by level from the one around all items: the first `most` of them.
    pub fn cells(&self, most: usize) -> Vec<Cell> {
        match &self.structure {
            Structure::Brute if self.bounds.is_empty() => Vec::new(),
            Structure::Brute => vec![Cell { bounds: self.bounds, depth: 0, is_leaf: true }],
            Structure::Tree(tree) => tree.cells(most),
            Structure::Octree(octree) => octree.cells(most),
            Structure::Bsp(bsp) => bsp.cells(most),
        }
    }

    /// Checks the structure against the boxes it was built over and the order that the build gave: each item is in
    /// one leaf, or in all whose cells it touches, and every box holds what stands below it.
    ///
    /// # Errors
    /// Tells the first thing that is not so. No input leads to that; it would be a fault of the builder.
    pub fn validate(&self, boxes: &impl Boxes, order: Option<&[u32]>) -> Result<(), Defect> {
        match &self.structure {
            Structure::Brute => Ok(()),
            Structure::Tree(tree) => tree.validate(boxes, order.unwrap_or_default()),
            Structure::Octree(octree) => octree.validate(boxes),
            Structure::Bsp(bsp) => bsp.validate(boxes),
        }
    }

    /// Walks every ray of the batch. `level` says which instructions kernels may use; the calls to the batch are the
    /// same in effect for every level and kind.
    pub fn walk<B: Batch>(&self, level: Level, queries: &Queries<'_>, batch: &mut B) {
        match &self.structure {
            Structure::Brute => brute::walk(self.items, queries, batch),
            Structure::Tree(tree) if self.is_far() && bvh::turns::start_apart(queries, &self.bounds) => {
                let mut stack = vec![0; bvh::turns::WALKERS * (tree.stack + WIDTH)];
                dispatch!(level, simd => bvh::turns::walk(simd, tree, &mut stack, queries, batch));
            }
            Structure::Tree(tree) => {
                // Only scenes with very deeply nested groups ask for more than fits the fixed stack.
                let (mut fixed, mut grown) = ([0; MAX_STACK + WIDTH], Vec::new());
                let stack = if tree.stack <= MAX_STACK {
                    &mut fixed[..]
                } else {
                    grown.resize(tree.stack + WIDTH, 0);
                    &mut grown[..]
                };
                dispatch!(level, simd => bvh::walk::walk(simd, tree, stack, queries, batch));
            }
            Structure::Octree(octree) => octree.walk(queries, batch),
            Structure::Bsp(bsp) => bsp.walk(queries, batch),
        }
    }
}

impl Accelerator {
    /// The same as [`Accelerator::walk`], for rays that start and run alike (neighbours from the eye, or from a
    /// surface to one light): they share the reading of nodes and leaves. Any rays give the same answers, only slower.
    pub fn walk_together<B: Batch>(&self, level: Level, queries: &Queries<'_>, batch: &mut B) {
        match &self.structure {
            Structure::Tree(tree) if queries.len() > 1 => {
                dispatch!(level, simd => bvh::beam::walk(simd, tree, queries, batch));
            }
            Structure::Tree(_) | Structure::Brute | Structure::Octree(_) | Structure::Bsp(_) => {
                self.walk(level, queries, batch);
            }
        }
    }

    /// One or the other, as the caller knows its rays.
    pub fn walk_rays<B: Batch>(&self, level: Level, queries: &Queries<'_>, batch: &mut B, together: bool) {
        if together {
            self.walk_together(level, queries, batch);
        } else {
            self.walk(level, queries, batch);
        }
    }
}

/// See [`Accelerator::is_far`].
fn is_far(structure: &Structure, kind: Kind, items: u32) -> bool {
    let Structure::Tree(tree) = structure else { return false };
    let nodes = tree.nodes.len();
    let reads_little = || tree.stats(kind, items).sah_cost <= FEW_TESTS;
    ahead::HELPS && (nodes >= FAR || nodes >= RATHER_FAR && reads_little())
}

/// The box around all items.
fn union(boxes: &impl Boxes) -> Aabb {
    (0..boxes.len())
        .into_par_iter()
        .with_min_len(1 << 12)
        .map(|item| boxes.bounds(item))
        .reduce(|| Aabb::EMPTY, Aabb::union)
}

/// The tree of a BVH and the order of its leaves.
fn build_bvh(boxes: &impl Boxes, frame: Frame, settings: &Settings) -> (Tree, Vec<u32>) {
    let mut references: Vec<_> = (0..boxes.len())
        .into_par_iter()
        .with_min_len(1 << 12)
        .map(|item| Reference::new(frame.narrow(&boxes.bounds(item)), item))
        .collect();
    // Scenes have one node for some 15 to 30 items; room that is not used is never touched.
    let mut nodes = Vec::with_capacity(references.len() / 16);
    let root: Child =
        Builder { quality: settings.quality, level: level() }.build(&mut references, 0, &mut nodes);
    let order = references.par_iter().with_min_len(1 << 12).map(Reference::number).collect();
    drop(references);
    (Tree::new(frame, nodes, root), order)
}
