//! What a walk asks.

use dotray_geometry::Ray;

/// One ray and the part of it that counts.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Query {
    /// The ray, in the world; its direction has length 1.
    pub ray: Ray,
    /// Items are looked for from here …
    pub t_min: f64,
    /// … to here, which shrinks as hits are found.
    pub t_max: f64,
}
