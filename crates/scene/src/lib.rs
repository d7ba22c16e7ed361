//! What a `.ray` file says: text → tokens → scene + diagnostics → resolved scene, and back to text.
//!
//! The order of the `mod` lines is the floor order: a module uses only modules listed above it.

pub mod span;

pub mod diagnostic;

pub mod files;

pub mod sources;

pub mod directive;

pub mod number;

pub mod procedural;

pub mod model;

pub mod shapes;

pub mod lex;

pub mod lookalike;

mod parse;

pub mod load;

pub mod report;

pub mod resolved;

pub mod walk;

pub mod frame;

pub mod bounds;

pub mod resolve;

pub mod write;

pub mod dump;

pub mod summary;

pub use diagnostic::{Diagnostic, Severity};
pub use files::Files;
pub use load::{LoadOptions, Loaded, load, load_text};
pub use model::Scene;
pub use resolved::Resolved;
pub use sources::Sources;
