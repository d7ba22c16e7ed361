//! The dialects of the language, and what a file of each means beyond its syntax: a table, never a branch later on.

use std::f64::consts::PI;
use std::fmt;

/// A dialect: which course's program a file was written for.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Default)]
pub enum Dialect {
    /// The lecture slides' own, with the extensions of later courses.
    #[default]
    Slides,
    /// Johns Hopkins to 2019, University of Virginia.
    Uva,
    /// Johns Hopkins since 2020.
    Jhu,
    /// Harvey Mudd, CS 155.
    Hmc,
    /// University of South Australia.
    Unisa,
}

/// What the same words mean in a dialect.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Conventions {
    /// What a camera's angle is multiplied by to give half of the vertical view angle in radians.
    pub half_angle: f64,
    /// How the camera's angle is called in messages.
    pub camera_angle: &'static str,
    /// The largest camera angle as written; no angle may reach it.
    pub most_camera_angle: f64,
    /// What a spot's cut-off angle is multiplied by to give radians.
    pub spot_angle: f64,
    /// What a spot's drop-off rate is multiplied by to give an exponent.
    pub dropoff: f64,
    /// Whether a mirrored or refracted ray that hits nothing returns the background; otherwise it adds nothing.
    pub background_behind_surfaces: bool,
    /// Whether light passes through see-through surfaces.
    pub see_through_shadows: bool,
    /// Whether a texture colours all the light that leaves a surface, highlights and emission included.
    pub texture_on_all_light: bool,
    /// Whether shapes may name material -1.
    pub default_material: bool,
    /// Whether a camera of all zeros stands for no camera, and included files are looked for in folders above, too.
    pub lenient: bool,
}

const DEGREE: f64 = PI / 180.0;

const SLIDES: Conventions = Conventions {
    half_angle: 1.0,
    camera_angle: "half angle",
    most_camera_angle: PI / 2.0,
    spot_angle: 1.0,
    dropoff: 128.0,
    background_behind_surfaces: true,
    see_through_shadows: true,
    texture_on_all_light: false,
    default_material: true,
    lenient: false,
};

const UVA: Conventions = Conventions {
    half_angle: 0.5,
    camera_angle: "angle",
    most_camera_angle: PI,
    dropoff: 1.0,
    background_behind_surfaces: false,
    texture_on_all_light: true,
    default_material: false,
    lenient: true,
    ..SLIDES
};

const UNISA: Conventions =
    Conventions { half_angle: DEGREE, most_camera_angle: 90.0, spot_angle: DEGREE, lenient: true, ..SLIDES };

const HMC: Conventions = Conventions { see_through_shadows: false, ..UNISA };

impl Dialect {
    /// Every dialect.
    pub const ALL: [Self; 5] = [Self::Slides, Self::Uva, Self::Jhu, Self::Hmc, Self::Unisa];

    /// Its name, as options and messages have it.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Slides => "slides",
            Self::Uva => "uva",
            Self::Jhu => "jhu",
            Self::Hmc => "hmc",
            Self::Unisa => "unisa",
        }
    }

    /// The dialect of this name.
    pub fn of_name(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|dialect| dialect.name() == name)
    }

    /// What its words mean.
    pub const fn conventions(self) -> &'static Conventions {
        match self {
            Self::Slides => &SLIDES,
            Self::Uva | Self::Jhu => &UVA,
            Self::Hmc => &HMC,
            Self::Unisa => &UNISA,
        }
    }
}

impl fmt::Display for Dialect {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_are_found_again() {
        for dialect in Dialect::ALL {
            assert_eq!(Dialect::of_name(dialect.name()), Some(dialect));
            assert_eq!(dialect.to_string(), dialect.name());
        }
        assert_eq!(Dialect::of_name("auto"), None);
    }
}
