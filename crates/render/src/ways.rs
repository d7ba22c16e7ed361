//! The ways from many points of surfaces to one lamp, eight at a time, in the arithmetic of
//! [`Light::incident`](crate::light::Light::incident).

use crate::light::MOST;
use crate::light::Source;
use crate::light::Way;
use dotray_accel::Level;
use dotray_accel::simd::Simd;
use dotray_accel::simd::dispatch;
use dotray_accel::simd::f64x8;
use dotray_accel::simd::prelude::*;
use dotray_geometry::Vec3;

/// Points computed at once.
const LANES: usize = 8;

/// Numbers of many points, coordinate by coordinate; behind the last point as many zeros as fill eight lanes.
type Coordinates = [Vec<f64>; 3];

/// Points of surfaces and their shading normals, of which the lamps ask one after the other.
#[derive(Debug, Default)]
pub struct Places {
    points: Coordinates,
    normals: Coordinates,
    len: usize,
}

impl Places {
    /// Takes other points.
    pub fn fill(&mut self, places: impl ExactSizeIterator<Item = (Vec3, Vec3)>) {
        self.len = places.len();
        let filled = self.len.next_multiple_of(LANES);
        for list in self.points.iter_mut().chain(&mut self.normals) {
            list.clear();
            list.resize(filled, 0.0);
        }
        for (i, (point, normal)) in places.enumerate() {
            for axis in 0..3 {
                self.points[axis][i] = point[axis];
                self.normals[axis][i] = normal[axis];
            }
        }
    }
}

/// What a lamp and each of the places have with each other.
#[derive(Debug, Default)]
pub struct Ways {
    towards: Coordinates,
    distances: Vec<f64>,
    fading: Vec<f64>,
    cosines: Vec<f64>,
    /// The places that look towards the lamp.
    facing: Vec<u32>,
}

impl Ways {
    /// The ways to a light that is one point, or infinitely far away; of other lights it knows nothing.
    pub fn find(&mut self, level: Level, source: &Source, places: &Places) {
        let filled = places.points[0].len();
        let [x, y, z] = &mut self.towards;
        for list in [x, y, z, &mut self.distances, &mut self.fading, &mut self.cosines] {
            list.resize(filled, 0.0);
        }
        dispatch!(level, simd => self.compute(simd, source, places));
        // Without a branch: which way a place looks cannot be guessed.
        self.facing.resize(filled, 0);
        let parallel = matches!(source, Source::Parallel { .. });
        let mut count = 0;
        for (i, (&cosine, &distance)) in self.cosines.iter().zip(&self.distances).enumerate().take(places.len)
        {
            self.facing[count] = i as u32;
            let reaches = distance > 0.0 && (distance < f64::INFINITY || parallel);
            let turned_away = cosine <= 0.0;
            count += usize::from(reaches && !turned_away);
        }
        self.facing.truncate(count);
    }

    /// The places that look towards the lamp, with the ways there and the cosines n̂·L̂.
    pub fn facing(&self) -> impl Iterator<Item = (usize, Way, f64)> {
        self.facing.iter().map(|&i| {
            let i = i as usize;
            let [x, y, z] = &self.towards;
            let way = Way {
                towards: Vec3::new(x[i], y[i], z[i]),
                distance: self.distances[i],
                fading: self.fading[i],
            };
            (i, way, self.cosines[i])
        })
    }

    #[inline(always)]
    fn compute<S: Simd>(&mut self, simd: S, source: &Source, places: &Places) {
        for first in (0..places.points[0].len()).step_by(LANES) {
            let load = |list: &[f64]| f64x8::from_slice(simd, &list[first..first + LANES]);
            let number = |x: f64| f64x8::splat(simd, x);
            let (towards, distance, fading) = match source {
                Source::Parallel { towards } => (
                    [number(towards.x), number(towards.y), number(towards.z)],
                    number(f64::INFINITY),
                    number(1.0),
                ),
                Source::Point { position, attenuation: a } => {
                    let [x, y, z] = [
                        number(position.x) - load(&places.points[0]),
                        number(position.y) - load(&places.points[1]),
                        number(position.z) - load(&places.points[2]),
                    ];
                    let distance = (x * x + y * y + z * z).sqrt();
                    let sum = number(a.constant)
                        + number(a.linear) * distance
                        + number(a.quadratic) * (distance * distance);
                    let fading = (number(1.0) / sum).min(number(MOST));
                    let fading = sum.simd_gt(number(0.0)).select(fading, number(1.0));
                    ([x / distance, y / distance, z / distance], distance, fading)
                }
            };
            let normal = |axis: usize| load(&places.normals[axis]);
            let cosine = normal(0) * towards[0] + normal(1) * towards[1] + normal(2) * towards[2];
            let store = |list: &mut [f64], lanes: f64x8<S>| {
                list[first..first + LANES].copy_from_slice(&lanes.to_array());
            };
            for (list, lanes) in self.towards.iter_mut().zip(towards) {
                store(list, lanes);
            }
            store(&mut self.distances, distance);
            store(&mut self.fading, fading);
            store(&mut self.cosines, cosine);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::light::Light;
    use dotray_accel::simd::available_levels;
    use dotray_scene::model;

    const ATTENUATION: model::Attenuation =
        model::Attenuation { constant: -0.7, linear: 0.3, quadratic: 1e-3 };

    /// A point light, a spot and parallel light.
    fn lights() -> [Light; 3] {
        let (color, position, direction) = (Vec3::new(0.9, 0.5, 0.1), Vec3::new(1.0, 2.0, -0.5), Vec3::NEG_Y);
        [
            model::Light::Point { color, position, attenuation: ATTENUATION },
            model::Light::Spot {
                color,
                position,
                direction,
                attenuation: ATTENUATION,
                cutoff: 1.5,
                dropoff: 0.1,
            },
            model::Light::Directional { color, direction },
        ]
        .map(|light| Light::new(&light))
    }

    /// Points all around the lamp and on it, some where squares overflow or vanish, some that look at it from the side.
    fn points() -> Vec<(Vec3, Vec3)> {
        let lamp = Vec3::new(1.0, 2.0, -0.5);
        let mut points: Vec<_> = (0..99)
            .map(|i| {
                let i = f64::from(i);
                let to = Vec3::new(libm::sin(i * 1.3), libm::cos(i * 0.7), libm::sin(i * 2.1));
                (lamp + to * libm::exp(i * 0.1 - 5.0), Vec3::new(libm::cos(i), libm::sin(i), 0.3).normalize())
            })
            .collect();
        points.extend([
            (lamp, Vec3::Y),
            (Vec3::splat(1e300), Vec3::Y),
            (lamp + Vec3::X * 1e-200, Vec3::Z),
            (lamp + Vec3::X, Vec3::Y),
            (lamp + Vec3::Y, Vec3::NEG_Y),
        ]);
        points
    }

    #[test]
    fn every_level_finds_what_one_point_alone_finds() {
        let points = points();
        let mut places = Places::default();
        places.fill(points.iter().copied());
        for light in lights() {
            let source = light.source().expect("no area");
            for level in available_levels() {
                let mut ways = Ways::default();
                ways.find(level, &source, &places);
                let together: Vec<_> = ways
                    .facing()
                    .filter_map(|(place, way, cosine)| Some((place, light.along(way)?, cosine)))
                    .collect();
                let alone: Vec<_> = points
                    .iter()
                    .enumerate()
                    .filter_map(|(place, (point, normal))| {
                        let incident = light.incident(*point, 0, 1)?;
                        let cosine = normal.dot(incident.towards);
                        (cosine > 0.0).then_some((place, incident, cosine))
                    })
                    .collect();
                assert!(alone.len() > 10);
                assert_eq!(together, alone, "{light:?} with {level:?}");
            }
        }
    }
}
