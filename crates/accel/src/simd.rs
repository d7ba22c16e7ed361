//! The only file that names `fearless_simd`: which level this machine has, and what kernels need of it.

pub use fearless_simd::{Level, Simd};
