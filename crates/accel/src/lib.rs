//! What does a ray meet first? Boxes, numbers and a leaf callback; never a shape.
//!
//! A caller numbers its items, gives their boxes ([`Boxes`]) and builds an [`Accelerator`] of one of five [`Kind`]s.
//! To trace, it hands over a [`Batch`] of rays; the walk calls it back with the items that a ray may hit, and takes
//! the new upper bound of t from the answer. Which kind, SIMD level or number of threads is chosen cannot change
//! what the callbacks find: single precision only rules boxes out, with a bound derived in [`narrow`].
//!
//! The order of the `mod` lines is the floor order: a module uses only modules listed above it.

pub mod simd;

pub mod input;

pub mod query;

pub mod stats;

pub mod clip;

pub mod narrow;

mod brute;

mod cells;

mod octree;

mod bsp;

mod bvh;

mod box_tree;

pub mod accelerator;

pub use accelerator::{Accelerator, Built};
pub use input::{Boxes, GroupEvent, Kind, MAX_ITEMS, Quality, Settings};
pub use query::{Batch, Query};
pub use simd::Level;
pub use stats::{Defect, Stats};
