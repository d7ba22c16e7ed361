//! What a light sends to a point: direction, distance and strength, before shadows (SPEC 6).

use dotray_geometry::Vec3;
use dotray_scene::model;
use dotray_scene::model::Attenuation;

/// A light with all that does not depend on the point computed once.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Light {
    /// A point.
    Point(Lamp),
    /// A point that shines into a cone.
    Spot {
        /// The point.
        lamp: Lamp,
        /// The cone's axis, of length 1.
        axis: Vec3,
        /// The cosine of the cut-off angle.
        cos_cutoff: f64,
        /// 128 sd.
        exponent: f64,
    },
    /// Parallel light.
    Directional {
        /// Colour.
        color: Vec3,
        /// Against the light's way, of length 1.
        towards: Vec3,
    },
    /// A disc that emits to its front side.
    Area {
        /// The disc's centre.
        lamp: Lamp,
        /// The unit normal of the front side.
        axis: Vec3,
        /// Two directions in the disc, of the radius's length.
        radii: [Vec3; 2],
    },
}

/// A colour at a place, and how it fades.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Lamp {
    color: Vec3,
    position: Vec3,
    attenuation: Attenuation,
}

/// What all points of a light have in common that is one point, or infinitely far away.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Source {
    /// A point.
    Point {
        /// Where.
        position: Vec3,
        /// How its light fades.
        attenuation: Attenuation,
    },
    /// Parallel light.
    Parallel {
        /// Against the light's way, of length 1.
        towards: Vec3,
    },
}

/// The way from a point of a surface to a point of a light.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Way {
    /// L̂: of length 1.
    pub towards: Vec3,
    /// How far the light is; infinite for parallel light.
    pub distance: f64,
    /// F_ATTEN
    pub fading: f64,
}

/// What one point of a light sends to one point of a surface.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Incident {
    /// L̂: from the surface to the light, of length 1.
    pub towards: Vec3,
    /// How far the light is; infinite for parallel light.
    pub distance: f64,
    /// L_i · F_SPOT · F_ATTEN; zero where the light sends nothing.
    pub strength: Vec3,
}

impl Lamp {
    fn new(color: Vec3, position: Vec3, attenuation: Attenuation) -> Self {
        Self { color, position, attenuation }
    }

    /// The way to the lamp, which has been moved to `position`; `None` at the lamp itself.
    fn way(&self, position: Vec3, point: Vec3) -> Option<Way> {
        let offset = position - point;
        let distance = offset.length();
        if !(distance > 0.0 && distance.is_finite()) {
            return None;
        }
        Some(Way { towards: offset / distance, distance, fading: self.fading(distance) })
    }

    /// F_ATTEN
    fn fading(&self, distance: f64) -> f64 {
        let a = &self.attenuation;
        let sum = a.constant + a.linear * distance + a.quadratic * (distance * distance);
        if sum > 0.0 { (1.0 / sum).min(MOST) } else { 1.0 }
    }
}

impl Light {
    /// The light of the resolved scene.
    pub fn new(light: &model::Light) -> Self {
        match *light {
            model::Light::Point { color, position, attenuation } => {
                Self::Point(Lamp::new(color, position, attenuation))
            }
            model::Light::Spot { color, position, direction, attenuation, cutoff, dropoff } => Self::Spot {
                lamp: Lamp::new(color, position, attenuation),
                axis: direction.normalize(),
                // Past a half turn the cone is everything.
                cos_cutoff: libm::cos(cutoff.clamp(0.0, std::f64::consts::PI)),
                exponent: 128.0 * dropoff,
            },
            model::Light::Directional { color, direction } => {
                Self::Directional { color, towards: -direction.normalize() }
            }
            model::Light::Area { color, position, direction, radius, attenuation } => {
                let axis = direction.normalize();
                let across = axis.any_orthonormal_vector();
                Self::Area {
                    lamp: Lamp::new(color, position, attenuation),
                    axis,
                    radii: [across * radius, axis.cross(across) * radius],
                }
            }
        }
    }

    /// How many point lights stand for this one.
    pub fn samples(&self, area_samples: u32) -> u32 {
        match self {
            Self::Area { .. } => area_samples,
            Self::Point(_) | Self::Spot { .. } | Self::Directional { .. } => 1,
        }
    }

    /// L_i: its colour.
    pub fn color(&self) -> Vec3 {
        match self {
            Self::Point(lamp) | Self::Spot { lamp, .. } | Self::Area { lamp, .. } => lamp.color,
            Self::Directional { color, .. } => *color,
        }
    }

    /// F_SPOT and F_ATTEN in what it sends: the factors of [`Incident::strength`] besides the colour.
    pub fn factors(&self, incident: &Incident) -> (f64, f64) {
        match self {
            Self::Point(lamp) | Self::Area { lamp, .. } => (1.0, lamp.fading(incident.distance)),
            Self::Spot { lamp, axis, exponent, .. } => {
                (fall_off(-incident.towards.dot(*axis), *exponent), lamp.fading(incident.distance))
            }
            Self::Directional { .. } => (1.0, 1.0),
        }
    }

    /// What sample `index` of `count` sends to `point`; `None` where that is nothing.
    pub fn incident(&self, point: Vec3, index: u32, count: u32) -> Option<Incident> {
        let way = match self {
            Self::Point(lamp) | Self::Spot { lamp, .. } => lamp.way(lamp.position, point)?,
            Self::Directional { towards, .. } => {
                Way { towards: *towards, distance: f64::INFINITY, fading: 1.0 }
            }
            Self::Area { lamp, radii, .. } => {
                let (u, v) = disc_sample(index, count, turn_at(point));
                lamp.way(lamp.position + radii[0] * u + radii[1] * v, point)?
            }
        };
        self.along(way)
    }

    /// What comes along the way; `None` where that is nothing.
    #[inline]
    pub fn along(&self, way: Way) -> Option<Incident> {
        let Way { towards, distance, fading } = way;
        let strength = match self {
            Self::Point(lamp) => lamp.color * fading,
            Self::Directional { color, .. } => *color,
            Self::Spot { lamp, axis, cos_cutoff, exponent } => {
                let cosine = -towards.dot(*axis);
                if cosine < *cos_cutoff {
                    return None;
                }
                lamp.color * fading * fall_off(cosine, *exponent)
            }
            Self::Area { lamp, axis, .. } => {
                let in_front = -towards.dot(*axis) > 0.0;
                if !in_front {
                    return None;
                }
                lamp.color * fading
            }
        };
        Some(Incident { towards, distance, strength })
    }

    /// Where all its light comes from; `None` for a light that many points stand for.
    pub fn source(&self) -> Option<Source> {
        match self {
            Self::Point(lamp) | Self::Spot { lamp, .. } => {
                Some(Source::Point { position: lamp.position, attenuation: lamp.attenuation })
            }
            Self::Directional { towards, .. } => Some(Source::Parallel { towards: *towards }),
            Self::Area { .. } => None,
        }
    }
}

/// No factor is infinite, because infinite times black is not a number: an exponent below 0 or an attenuation of next
/// to nothing makes factors without bound. Far less than this is white.
pub(crate) const MOST: f64 = 1e100;

/// F_SPOT inside of the cone.
fn fall_off(cosine: f64, exponent: f64) -> f64 {
    libm::pow(cosine.max(0.0), exponent).min(MOST)
}

/// A place in the unit disc: `count` places by the golden angle, equal areas each (H. Vogel, "A better way to
/// construct the sunflower head", 1979), the whole pattern turned by `turn` radians.
fn disc_sample(index: u32, count: u32, turn: f64) -> (f64, f64) {
    const GOLDEN_ANGLE: f64 = 2.399_963_229_728_653;
    let radius = ((f64::from(index) + 0.5) / f64::from(count)).sqrt();
    let angle = f64::from(index) * GOLDEN_ANGLE + turn;
    (radius * libm::cos(angle), radius * libm::sin(angle))
}

/// An angle that looks random from point to point, so that the few places of a disc give grain rather than bands.
/// It is a function of the point's bits alone, hence of the scene and the pixel.
fn turn_at(point: Vec3) -> f64 {
    let mut hash = 0x9e37_79b9_7f4a_7c15_u64;
    for bits in [point.x.to_bits(), point.y.to_bits(), point.z.to_bits()] {
        // The finaliser of splitmix64 (Steele, Lea, Flood, OOPSLA 2014), once a coordinate.
        hash = (hash ^ bits).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        hash = (hash ^ (hash >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        hash ^= hash >> 31;
    }
    (hash >> 11) as f64 * (std::f64::consts::TAU / (1u64 << 53) as f64)
}

#[cfg(test)]
mod tests {
    use super::*;

    const NONE: Attenuation = Attenuation { constant: 1.0, linear: 0.0, quadratic: 0.0 };

    #[test]
    fn attenuation_by_hand() {
        let attenuation = Attenuation { constant: 1.0, linear: 0.5, quadratic: 0.25 };
        let light =
            Light::new(&model::Light::Point { color: Vec3::ONE, position: Vec3::Y * 2.0, attenuation });
        let incident = light.incident(Vec3::ZERO, 0, 1).expect("in front");
        assert_eq!((incident.towards, incident.distance), (Vec3::Y, 2.0));
        assert_eq!(incident.strength, Vec3::splat(1.0 / 3.0));
        assert_eq!(light.incident(Vec3::Y * 2.0, 0, 1), None);
    }

    #[test]
    fn a_spot_ends_at_its_cutoff() {
        let light = |cutoff| {
            Light::new(&model::Light::Spot {
                color: Vec3::ONE,
                position: Vec3::Y,
                direction: Vec3::NEG_Y * 3.0,
                attenuation: NONE,
                cutoff,
                dropoff: 1.0 / 128.0,
            })
        };
        let aside = Vec3::X; // 45 degrees from the axis
        assert!(light(0.78).incident(aside, 0, 1).is_none());
        let strength = light(0.79).incident(aside, 0, 1).expect("inside").strength.x;
        assert!((strength - 0.5f64.sqrt()).abs() < 1e-15);
        // Behind the lamp the clamped cosine leaves nothing, even with the widest cone.
        assert_eq!(light(4.0).incident(Vec3::Y * 2.0, 0, 1).expect("inside").strength, Vec3::ZERO);
    }

    #[test]
    fn the_disc_is_evenly_filled() {
        let count = 4096;
        let points: Vec<_> = (0..count).map(|i| disc_sample(i, count, 1.0)).collect();
        let mean = points.iter().fold((0.0, 0.0), |m, p| (m.0 + p.0, m.1 + p.1));
        assert!(mean.0.abs() / f64::from(count) < 1e-3 && mean.1.abs() / f64::from(count) < 1e-3);
        let inner = points.iter().filter(|p| p.0 * p.0 + p.1 * p.1 < 0.25).count();
        assert!((inner as f64 / f64::from(count) - 0.25).abs() < 1e-3);
    }

    #[test]
    fn no_factor_is_infinite() {
        assert_eq!(fall_off(0.5, -1e308), MOST);
        assert_eq!(fall_off(0.0, -1.0), MOST);
        let attenuation = Attenuation { constant: 5e-324, linear: 0.0, quadratic: 0.0 };
        assert_eq!(Lamp::new(Vec3::ONE, Vec3::ZERO, attenuation).fading(1.0), MOST);
    }

    #[test]
    fn a_disc_sends_nothing_backwards() {
        let light = Light::new(&model::Light::Area {
            color: Vec3::ONE,
            position: Vec3::ZERO,
            direction: Vec3::X,
            radius: 0.5,
            attenuation: NONE,
        });
        assert!((0..16).all(|i| light.incident(Vec3::X * 3.0, i, 16).is_some()));
        assert!((0..16).all(|i| light.incident(Vec3::NEG_X * 3.0, i, 16).is_none()));
    }
}
