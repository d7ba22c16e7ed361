//! What a `.ray` file says: text → tokens → scene + diagnostics → resolved scene, and back to text.
//!
//! The order of the `mod` lines is the floor order: a module uses only modules listed above it.

pub mod span;

pub mod diagnostic;

pub mod files;

pub mod directive;

pub mod procedural;

pub mod model;

pub mod resolved;

pub use diagnostic::{Diagnostic, Severity};
pub use files::Files;
pub use model::Scene;
pub use resolved::Resolved;
