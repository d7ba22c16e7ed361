//! Pictures in memory and on disk, and the comparison of two pictures.
//!
//! A picture is an [`Image`]: f32 samples, upper row first, three or four channels, never clamped. [`decode`] turns the
//! bytes of a file into one, [`encode`] the other way, [`write_file`] stores bytes whole or not at all, and
//! [`compare`](mod@compare) says how far two pictures are apart. Nothing in this crate panics on any input, and sizes
//! are checked against [`Limits`] before memory is taken.
//!
//! BMP, PPM, Radiance HDR and PFM are read and written by this crate itself; the other formats come through crates and
//! can be left out by turning the default feature `formats` off.
//!
//! The order of the `mod` lines is the floor order: a module uses only modules listed above it.
//!
//! ```
//! use dotray_image::{Channels, EncodeOptions, Format, Image, Limits, decode, encode};
//!
//! let mut image = Image::new(2, 1, Channels::Rgb)?;
//! image.set_pixel(0, 0, [1.0, 0.5, 0.0, 1.0]);
//! let bytes = encode(&image, Format::Bmp, &EncodeOptions::default())?;
//! let again = decode(&bytes, None, &Limits::default())?;
//! assert_eq!(again.pixel(0, 0), Some([1.0, 128.0 / 255.0, 0.0, 1.0]));
//! # Ok::<(), dotray_image::ImageError>(())
//! ```

#![warn(clippy::unwrap_used, clippy::indexing_slicing)]
#![cfg_attr(test, allow(clippy::unwrap_used, clippy::indexing_slicing))]

mod error;

mod limits;

mod bytes;

mod quantise;

mod image;

mod format;

mod bmp;

mod pnm;

mod pfm;

mod hdr;

#[cfg(feature = "formats")]
mod guard;

#[cfg(feature = "formats")]
mod raster;

#[cfg(feature = "formats")]
mod openexr;

mod codec;

mod exr_layers;

mod file;

pub mod compare;

pub use codec::{EncodeOptions, decode, encode};
pub use error::ImageError;
pub use exr_layers::{NamedChannel, encode_exr_layers};
pub use file::write_file;
pub use file::write_files;
pub use format::Format;
pub use image::{Channels, Image};
pub use limits::Limits;
