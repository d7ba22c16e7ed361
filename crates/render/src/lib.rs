//! How a picture is made: bake → accelerator → tiles of samples → film.
//!
//! [`World::prepare`] turns a resolved scene into what rays meet; [`render`] turns that into a picture. Both are
//! functions of their arguments alone: threads, tiles and SIMD levels change the time, never the bytes.
//!
//! The order of the `mod` lines is the floor order: a module uses only modules listed above it.

pub mod error;

pub mod threads;

pub mod options;

pub mod stats;

pub mod tile;

pub mod observer;

pub mod progress;

mod stretch;

pub mod estimate;

pub mod camera;

pub mod noise;

pub mod solid;

pub mod texture;

pub mod light;

mod ways;

mod spheres;

mod spine;

mod cull;

mod form;

mod own;

mod leaving;

mod bake;

pub mod shapes;

pub mod query;

pub mod caster;

pub mod world;

pub mod shade;

pub mod inspect;

pub mod record;

pub mod trace;

pub mod sampler;

mod numbers;

pub mod fingerprint;

pub mod tile_file;

mod borders;

pub mod film;

pub mod picture;

pub mod tiles;

pub mod layers;

pub mod layer_film;

pub use caster::Caster;
pub use error::RenderError;
pub use film::Film;
pub use fingerprint::Fingerprint;
pub use layer_film::{LayerFilm, develop_bands, develop_layers, layer_band, render_layers};
pub use layers::{Layer, LayerPicture};
pub use observer::{Observer, Progress, Silent};
pub use options::{Antialias, Crop, Options, Order, PrepareOptions, Shadows, TextureFilter};
pub use picture::{Parts, Picture};
pub use query::{Crossing, Nearest};
pub use stats::{MemoryPart, Stats};
pub use threads::on_threads;
pub use tile::{Tile, TilePixels};
pub use tile_file::TileFile;
pub use tiles::{Rendering, develop, develop_part, render, render_missing};
pub use world::{Textures, World};
