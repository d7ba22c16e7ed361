//! From a scene built by hand to what the renderer, the dump and the summary make of it.

mod build;
mod dump;
mod resolve;
mod summary;
