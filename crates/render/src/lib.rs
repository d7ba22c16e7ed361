//! How a picture is made: bake → accelerator → tiles of samples → film.
//!
//! [`World::prepare`] turns a resolved scene into what rays meet; [`render`] turns that into a picture. Both are
//! functions of their arguments alone: threads, tiles and SIMD levels change the time, never the bytes.
//!
//! The order of the `mod` lines is the floor order: a module uses only modules listed above it.

pub mod error;

mod threads;

pub mod options;

pub mod stats;

pub mod estimate;

pub mod camera;

pub mod noise;

pub mod solid;

pub mod texture;

pub mod light;

mod cull;

mod form;

mod bake;

pub mod shapes;

pub mod query;

pub mod caster;

pub mod world;

pub mod shade;

pub mod inspect;

pub mod trace;

pub mod sampler;

pub mod tiles;

pub mod layers;

pub use caster::Caster;
pub use error::RenderError;
pub use layers::{Layer, LayerPicture, render_layers};
pub use options::{Antialias, Crop, Options, PrepareOptions, Shadows, TextureFilter};
pub use query::{Crossing, Nearest};
pub use stats::{MemoryPart, Stats};
pub use tiles::{Observer, Rendering, Silent, render};
pub use world::{Textures, World};
