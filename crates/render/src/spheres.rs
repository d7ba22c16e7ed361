//! Spheres of the world, in single precision where all of them came so: that halves their memory and loses nothing.

use dotray_accel::ahead;
use dotray_geometry::Sphere;
use dotray_geometry::shape::NarrowSphere;
use rayon::prelude::*;

/// A list of spheres.
#[derive(Debug)]
pub enum Spheres {
    /// Single precision holds all of them as they are.
    Narrow(Vec<NarrowSphere>),
    /// Some need double precision.
    Wide(Vec<Sphere>),
}

impl Default for Spheres {
    fn default() -> Self {
        Self::Narrow(Vec::new())
    }
}

/// Whether single precision holds these.
pub fn are_narrow(spheres: &[Sphere]) -> bool {
    spheres.par_iter().all(|sphere| sphere.narrowed().is_some())
}

impl Spheres {
    /// An empty list with room for so many.
    pub fn with_capacity(count: usize, narrow: bool) -> Self {
        if narrow { Self::Narrow(Vec::with_capacity(count)) } else { Self::Wide(Vec::with_capacity(count)) }
    }

    pub fn is_narrow(&self) -> bool {
        matches!(self, Self::Narrow(_))
    }

    pub fn len(&self) -> usize {
        match self {
            Self::Narrow(list) => list.len(),
            Self::Wide(list) => list.len(),
        }
    }

    #[inline(always)]
    pub fn get(&self, index: usize) -> Sphere {
        match self {
            Self::Narrow(list) => Sphere::from(list[index]),
            Self::Wide(list) => list[index],
        }
    }

    /// Appends one. The first that needs double precision takes the others along.
    #[inline]
    pub fn push(&mut self, sphere: Sphere) {
        if let Self::Narrow(list) = self {
            match sphere.narrowed() {
                Some(narrow) => return list.push(narrow),
                None => self.widen(),
            }
        }
        if let Self::Wide(list) = self {
            list.push(sphere);
        }
    }

    /// Appends these.
    pub fn extend(&mut self, spheres: &[Sphere]) {
        match self {
            Self::Narrow(_) => spheres.iter().for_each(|sphere| self.push(*sphere)),
            Self::Wide(list) => list.extend_from_slice(spheres),
        }
    }

    #[cold]
    fn widen(&mut self) {
        if let Self::Narrow(list) = self {
            // As much room as there was made.
            let mut wide = Vec::with_capacity(list.capacity());
            wide.extend(list.iter().copied().map(Sphere::from));
            *self = Self::Wide(wide);
        }
    }

    /// Moves all of another list here.
    pub fn append(&mut self, other: &mut Self) {
        if !other.is_narrow() {
            self.widen();
        }
        match (self, other) {
            (Self::Narrow(list), Self::Narrow(other)) => list.append(other),
            (Self::Wide(list), Self::Wide(other)) => list.append(other),
            (Self::Wide(list), Self::Narrow(other)) => list.extend(other.drain(..).map(Sphere::from)),
            (Self::Narrow(_), Self::Wide(_)) => unreachable!("the list has been widened"),
        }
    }

    pub fn shrink_to_fit(&mut self) {
        match self {
            Self::Narrow(list) => list.shrink_to_fit(),
            Self::Wide(list) => list.shrink_to_fit(),
        }
    }

    /// Asks for some of these.
    #[inline(always)]
    pub fn expect(&self, first: usize, count: usize) {
        match self {
            Self::Narrow(list) => ahead::fetch_some(list, first, count),
            Self::Wide(list) => ahead::fetch_some(list, first, count),
        }
    }

    /// The bytes of the list.
    pub fn memory(&self) -> u64 {
        match self {
            Self::Narrow(list) => size_of_val(list.as_slice()) as u64,
            Self::Wide(list) => size_of_val(list.as_slice()) as u64,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use dotray_geometry::Vec3;

    fn sphere(x: f64) -> Sphere {
        Sphere::new(Vec3::new(x, 0.0, 0.0), 1.0).expect("a sphere")
    }

    fn list(of: &[f64]) -> Spheres {
        let mut list = Spheres::default();
        list.extend(&of.iter().map(|&x| sphere(x)).collect::<Vec<_>>());
        list
    }

    #[test]
    fn one_sphere_widens_all() {
        for of in [&[][..], &[0.5, 2.0], &[0.5, 0.1, 2.0], &[0.1]] {
            let list = list(of);
            assert_eq!(list.is_narrow(), !of.contains(&0.1));
            assert_eq!(list.memory(), (of.len() * if list.is_narrow() { 16 } else { 32 }) as u64);
            assert_eq!((0..list.len()).map(|i| list.get(i).center().x).collect::<Vec<_>>(), of);
        }
    }

    #[test]
    fn lists_of_both_precisions_are_joined() {
        for (first, second) in [([0.5], [2.0]), ([0.5], [0.1]), ([0.1], [0.5]), ([0.1], [0.2])] {
            let (mut joined, mut other) = (list(&first), list(&second));
            joined.append(&mut other);
            assert_eq!((joined.len(), other.len()), (2, 0));
            assert_eq!([joined.get(0), joined.get(1)], [sphere(first[0]), sphere(second[0])]);
        }
    }
}
