//! dotray renders scenes written in the `.ray` language: a Whitted ray tracer for spheres, boxes, cylinders, cones and
//! triangles that stay exact under any group matrix.
//!
//! This crate is the library's face: text to picture in three lines, and the floors below under short names for those
//! who want more: [`geometry`] (numbers and shapes), [`image`] (pixels and files), [`accel`] (what a ray meets first),
//! [`scene`] (what the text says), [`render`] (how a picture is made). The program of the same name is behind the
//! default feature `program`.
//!
//! ```
//! let scene = "#camera 0 0 4 0 0 -1 0 1 0 .5  #light_dir 1 1 1 0 0 -1  #shape_sphere -1 0 0 0 1";
//! let options = dotray::Options { width: 32, height: 24, ..dotray::Options::default() };
//! let picture = dotray::render_text(scene, &options)?;
//! assert!(picture.pixel(16, 12) > picture.pixel(0, 0));
//! # Ok::<(), dotray::Error>(())
//! ```
//!
//! With a file it is as short, and [`image::encode`] and [`image::write_file`] store what comes out:
//!
//! ```no_run
//! use dotray::image::{EncodeOptions, Format, encode, write_file};
//!
//! let picture = dotray::render_file("slides.ray".as_ref(), &dotray::Options::default())?;
//! let bytes = encode(&picture, Format::Bmp, &EncodeOptions::default())?;
//! write_file("slides.bmp".as_ref(), &bytes)?;
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

pub use dotray_accel as accel;
pub use dotray_geometry as geometry;
pub use dotray_image as image;
pub use dotray_render as render;
pub use dotray_scene as scene;

mod picture;

pub use dotray_image::Image;
pub use dotray_render::Options;
pub use picture::{Error, SceneError, render_file, render_text};
