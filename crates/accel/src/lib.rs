//! What does a ray meet first? Boxes, numbers and a leaf callback; never a shape.
//!
//! The order of the `mod` lines is the floor order: a module uses only modules listed above it.

pub mod simd;

pub mod input;

pub mod query;

pub mod accelerator;

pub use accelerator::{Accelerator, Built};
pub use input::{Boxes, GroupEvent, Kind, Quality, Settings};
pub use query::{Batch, Query};
pub use simd::Level;
