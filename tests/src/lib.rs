//! What the test files of this package share.
//!
//! The order of the `mod` lines is the floor order: a module uses only modules listed above it.

pub mod corpus;

pub mod pictures;

pub mod program;

pub mod targets;
