//! What does a ray meet first? Boxes, numbers and a leaf callback; never a shape.
//!
//! A caller numbers its items, gives their boxes ([`Boxes`]) and builds an [`Accelerator`] of one of five [`Kind`]s.
//! To trace, it hands over a [`Batch`] of rays; the walk calls it back with the items that a ray may hit, and takes
//! the new upper bound of t from the answer. Which kind, SIMD level or number of threads is chosen cannot change
//! what the callbacks find: single precision only rules boxes out, with a bound derived in [`narrow`].
//!
//! ```
//! use dotray_accel::simd::level;
//! use dotray_accel::{Accelerator, Batch, Boxes, Kind, Queries, Settings};
//! use dotray_geometry::{Aabb, Ray, Vec3};
//!
//! /// A row of unit cubes, which are their own boxes.
//! struct Row(u32);
//!
//! impl Boxes for Row {
//!     fn len(&self) -> u32 {
//!         self.0
//!     }
//!
//!     fn bounds(&self, item: u32) -> Aabb {
//!         let corner = Vec3::new(2.0 * f64::from(item), 0.0, 0.0);
//!         Aabb::new(corner, corner + 1.0)
//!     }
//! }
//!
//! /// The items that a ray is shown.
//! struct Look(Vec<u32>);
//!
//! impl Batch for Look {
//!     fn leaf_range(&mut self, i: usize, first: u32, count: u32, t_max: f64) -> f64 {
//!         let items: Vec<_> = (first..first + count).collect();
//!         self.leaf_list(i, &items, t_max)
//!     }
//!
//!     fn leaf_list(&mut self, _: usize, items: &[u32], t_max: f64) -> f64 {
//!         self.0.extend(items);
//!         t_max // nothing nearer was found
//!     }
//!
//!     fn finished(&mut self, _: usize, _: u64) {}
//! }
//!
//! let built = Accelerator::build(Kind::Octree, &Row(100), &[], &Settings::default());
//! let mut look = Look(Vec::new());
//! let along = [Ray::new(Vec3::new(-1.0, 0.5, 0.5), Vec3::X)];
//! built.accelerator.walk(level(), &Queries { rays: &along, t_min: &[0.0], t_max: &[4.5] }, &mut look);
//! assert!([0, 1].iter().all(|item| look.0.contains(item)) && look.0.len() < 20);
//! ```
//!
//! The order of the `mod` lines is the floor order: a module uses only modules listed above it.

#![allow(clippy::needless_range_loop, reason = "a loop over the axes reads several arrays at the same place")]

pub mod simd;

pub mod ahead;

pub mod input;

pub mod query;

pub mod stats;

pub mod clip;

pub mod narrow;

pub mod packet;

pub mod batch;

mod brute;

mod cells;

mod octree;

mod bsp;

mod bvh;

mod box_tree;

pub mod accelerator;

pub use accelerator::{Accelerator, Built};
pub use batch::Batch;
pub use input::{Boxes, GroupEvent, Kind, MAX_ITEMS, Quality, Settings};
pub use query::{ENDLESS, Queries, Query};
pub use simd::Level;
pub use stats::{Cell, Defect, Stats};
