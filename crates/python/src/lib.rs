//! The compiled half of the Python package `dotray`: thin wrappers. What they take and give is checked and described in
//! the Python half, beside this folder.
//!
//! The order of the `mod` lines is the floor order: a module uses only modules listed above it.

mod arrays;

mod signals;

mod records;

mod files;

mod messages;

mod pictures;

mod view;

mod options;

mod explain;

mod caster;

mod world;

mod pieces;

mod builder;

mod solids;

use pyo3::prelude::*;

#[global_allocator]
static ALLOCATOR: dotray_memory::HugePages = dotray_memory::HugePages;

/// What the package `dotray` is made of.
#[pymodule]
mod _dotray {
    #[pymodule_export]
    use crate::arrays::faces_without_area;
    #[pymodule_export]
    use crate::arrays::first_not_finite;
    #[pymodule_export]
    use crate::arrays::first_not_positive;
    #[pymodule_export]
    use crate::arrays::is_singular;
    #[pymodule_export]
    use crate::builder::Builder;
    #[pymodule_export]
    use crate::messages::SceneError;
    #[pymodule_export]
    use crate::pictures::compare;
    #[pymodule_export]
    use crate::pictures::decode;
    #[pymodule_export]
    use crate::pictures::encode;
    #[pymodule_export]
    use crate::pictures::write_file;
    #[pymodule_export]
    use crate::pieces::Film;
    #[pymodule_export]
    use crate::pieces::work;
    #[pymodule_export]
    use crate::records::Meter;
    #[pymodule_export]
    use crate::solids::add_boxes;
    #[pymodule_export]
    use crate::solids::add_cones;
    #[pymodule_export]
    use crate::solids::add_cylinders;
    #[pymodule_export]
    use crate::solids::add_spheres;
    #[pymodule_export]
    use crate::solids::add_triangles;
    #[pymodule_export]
    use crate::world::World;

    /// The version of the records of progress.
    #[pymodule_export]
    const PROGRESS_SCHEMA: u32 = dotray_render::progress::SCHEMA;

    /// The version of the package.
    #[pymodule_export]
    const VERSION: &str = env!("CARGO_PKG_VERSION");
}
