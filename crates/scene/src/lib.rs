//! What a `.ray` file says: text → tokens → scene + diagnostics → resolved scene, and back to text.
//!
//! The order of the `mod` lines is the floor order: a module uses only modules listed above it.

pub mod span;

pub mod diagnostic;

pub mod dialect;

pub mod files;

#[cfg(feature = "compressed")]
mod unpack;

pub mod sources;

pub mod directive;

pub mod similar;

pub mod number;

pub mod procedural;

pub mod model;

pub mod shapes;

pub mod colors;

pub mod lex;

pub mod lookalike;

pub mod detect;

mod parse;

pub mod load;

pub mod report;

pub mod context;

pub mod resolved;

pub mod walk;

pub mod frame;

pub mod bounds;

pub mod resolve;

pub mod textures;

pub mod lint;

pub mod look_over;

pub mod codes;

pub mod format;

pub mod write;

pub mod convert;

pub mod dump;

pub mod summary;

pub use diagnostic::{Diagnostic, Severity};
pub use dialect::Dialect;
pub use files::Files;
pub use load::{LoadOptions, Loaded, load, load_text};
pub use model::Scene;
pub use resolved::Resolved;
pub use sources::Sources;
