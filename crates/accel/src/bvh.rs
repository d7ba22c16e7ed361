//! The bounding-volume hierarchy: nodes of eight boxes in single precision, one walk for nearest and any hit.
//!
//! The order of the `mod` lines is the floor order here too.

pub mod wide;

pub mod partition;

pub mod cluster;

pub mod split;

pub mod build;

pub mod check;

pub mod refit;

pub mod walk;

pub mod turns;

pub mod beam;

pub use build::Builder;
pub use wide::{Child, Tree};
