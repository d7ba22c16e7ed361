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

/// The rays of a batch.
#[derive(Clone, Copy, Debug)]
pub struct Queries<'a> {
    /// The rays, in the world; their directions have length 1.
    pub rays: &'a [Ray],
    /// Items are looked for from here: one number a ray, or one for all …
    pub t_min: &'a [f64],
    /// … to here: one number a ray, or one for all.
    pub t_max: &'a [f64],
}

/// No end.
pub const ENDLESS: &[f64] = &[f64::INFINITY];

impl Queries<'_> {
    /// How many rays there are.
    #[inline(always)]
    pub fn len(&self) -> usize {
        self.rays.len()
    }

    /// Whether there is no ray.
    pub fn is_empty(&self) -> bool {
        self.rays.is_empty()
    }

    /// Ray number `i`.
    #[inline(always)]
    pub fn query(&self, i: usize) -> Query {
        Query { ray: self.rays[i], t_min: one_or_each(self.t_min, i), t_max: one_or_each(self.t_max, i) }
    }
}

/// The number of ray `i`.
#[inline(always)]
fn one_or_each(numbers: &[f64], i: usize) -> f64 {
    if let [one] = numbers { *one } else { numbers[i] }
}
