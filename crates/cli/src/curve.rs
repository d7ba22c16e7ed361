//! Paths through keys.

use dotray::geometry::Vec3;
use serde::Deserialize;

/// How values go from key to key.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Path {
    /// Straight.
    #[default]
    Linear,
    /// Along a cubic that starts and ends at rest and has no corners.
    Smooth,
}

/// Values at times that ascend.
pub struct Curve {
    path: Path,
    keys: Vec<(f64, Vec3)>,
}

impl Curve {
    /// A path through these keys.
    pub fn new(path: Path, keys: Vec<(f64, Vec3)>) -> Self {
        Self { path, keys }
    }

    /// The value at a time; before the first key and after the last one it is theirs. `None` without keys.
    pub fn at(&self, time: f64) -> Option<Vec3> {
        let after = self.keys.partition_point(|key| key.0 <= time);
        let Some(before) = after.checked_sub(1) else { return self.keys.first().map(|key| key.1) };
        let (Some(&(start, from)), Some(&(end, to))) = (self.keys.get(before), self.keys.get(after)) else {
            return self.keys.last().map(|key| key.1);
        };
        let share = (time - start) / (end - start);
        Some(match self.path {
            Path::Linear => from + (to - from) * share,
            Path::Smooth => {
                // Hermite's cubic with the slopes of Catmull and Rom, 0 at both ends.
                let length = end - start;
                let (out, into) = (self.slope(before) * length, self.slope(after) * length);
                let (s, t) = (share, 1.0 - share);
                from * ((1.0 + 2.0 * s) * t * t)
                    + to * (s * s * (1.0 + 2.0 * t))
                    + out * (s * t * t)
                    + into * (-(s * s) * t)
            }
        })
    }

    fn slope(&self, key: usize) -> Vec3 {
        let neighbours = (key.checked_sub(1).and_then(|k| self.keys.get(k)), self.keys.get(key + 1));
        match neighbours {
            (Some((start, from)), Some((end, to))) => (*to - *from) / (end - start),
            (None, _) | (_, None) => Vec3::ZERO,
        }
    }
}

/// Turned about an axis through the origin, counter-clockwise as seen from the axis's tip (Rodrigues); the same bits on
/// every machine.
pub fn rotated(v: Vec3, axis: Vec3, angle: f64) -> Vec3 {
    let axis = axis.normalize_or_zero();
    let (sine, cosine) = (libm::sin(angle), libm::cos(angle));
    v * cosine + axis.cross(v) * sine + axis * (axis.dot(v) * (1.0 - cosine))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn paths_meet_their_keys() {
        let keys = vec![(0.0, Vec3::ZERO), (2.0, Vec3::X), (3.0, Vec3::new(4.0, 1.0, 0.0))];
        for path in [Path::Linear, Path::Smooth] {
            let curve = Curve::new(path, keys.clone());
            for (time, value) in &keys {
                assert_eq!(curve.at(*time), Some(*value));
            }
            assert_eq!((curve.at(-1.0), curve.at(9.0)), (Some(Vec3::ZERO), Some(keys[2].1)));
        }
        assert_eq!(Curve::new(Path::Linear, keys.clone()).at(1.0), Some(Vec3::X * 0.5));
        assert_eq!(Curve::new(Path::Smooth, keys[..2].to_vec()).at(1.0), Some(Vec3::X * 0.5));
        let smooth = Curve::new(Path::Smooth, keys);
        let at = |time| smooth.at(time).unwrap();
        // At rest at the start, no corner at the key between.
        assert!(at(1e-3).length() < 1e-5);
        let (before, after) = (at(2.0) - at(1.999), at(2.001) - at(2.0));
        assert!((before - after).length() < 1e-4 * 0.1, "{before} {after}");
        assert_eq!(Curve::new(Path::Smooth, Vec::new()).at(1.0), None);
    }

    #[test]
    fn a_quarter_turn_takes_x_to_y() {
        let turned = rotated(Vec3::X, Vec3::Z * 3.0, std::f64::consts::FRAC_PI_2);
        assert!((turned - Vec3::Y).length() < 1e-15);
    }
}
