//! What the picture must not depend on, and what it must: same bytes for every accelerator, thread count, tile size
//! and SIMD level; a crop is a part of the whole; size does not matter; hits are those of a slow independent judge.

mod crops;
mod inspect;
mod judge;
mod levels;
mod random;
mod same_bytes;
mod scaled;
mod tiles;
mod transforms;
