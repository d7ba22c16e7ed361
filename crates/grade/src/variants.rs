//! Wrong variants: what a picture would be if its program made a common fault.
//!
//! The renderer is never told to be wrong. A variant changes what goes into it (the scene as read, the scene as
//! resolved, the options, the textures' pictures) or what comes out.

mod camera;

mod glass;

mod light;

mod matrices;

mod pictures;

mod shapes;

mod shade;

use dotray_image::Image;
use dotray_render::Options;
use dotray_scene::Resolved;
use dotray_scene::Scene;

use crate::bent::Bend;

/// One common fault.
#[derive(Debug)]
pub struct Variant {
    /// Its name in suites and reports.
    pub name: &'static str,
    /// Told to whoever makes it.
    pub hint: &'static str,
    /// What it changes.
    pub change: Change,
}

/// Where a variant takes hold.
#[derive(Clone, Copy, Debug)]
pub enum Change {
    /// Of the scene as it was read.
    Scene(fn(&mut Scene)),
    /// Of the scene as it was understood, for a picture of so many columns and rows.
    Resolved(fn(&mut Resolved, (u32, u32))),
    /// Of the options.
    Options(fn(&mut Options)),
    /// Of every texture's picture.
    Texture(fn(&Image) -> Image),
    /// Of where refracted rays go.
    Bend(Bend),
    /// Of the picture.
    Picture(fn(&Image) -> Image),
    /// Each pixel is that of the truth or that of the scene in shadow, whichever the judged picture has.
    Speckles,
}

const fn picture(name: &'static str, change: fn(&Image) -> Image, hint: &'static str) -> Variant {
    Variant { name, hint, change: Change::Picture(change) }
}

const fn scene(name: &'static str, change: fn(&mut Scene), hint: &'static str) -> Variant {
    Variant { name, hint, change: Change::Scene(change) }
}

const fn resolved(name: &'static str, change: fn(&mut Resolved, (u32, u32)), hint: &'static str) -> Variant {
    Variant { name, hint, change: Change::Resolved(change) }
}

const fn options(name: &'static str, change: fn(&mut Options), hint: &'static str) -> Variant {
    Variant { name, hint, change: Change::Options(change) }
}

const fn bend(name: &'static str, change: Bend, hint: &'static str) -> Variant {
    Variant { name, hint, change: Change::Bend(change) }
}

const fn texture(name: &'static str, change: fn(&Image) -> Image, hint: &'static str) -> Variant {
    Variant { name, hint, change: Change::Texture(change) }
}

/// Every variant. Of two that give the same picture, the first is named.
pub static VARIANTS: &[Variant] = &[
    picture(
        "upside-down",
        pictures::upside_down,
        "The picture stands on its head: Y runs up in the formula of the eye rays, while many formats store the \
         upper row first (and BMP the lower).",
    ),
    picture(
        "mirrored",
        pictures::mirrored,
        "Left and right are exchanged: the vector to the right is direction x up, not up x direction.",
    ),
    picture(
        "turned",
        pictures::turned,
        "The picture is turned by half: both axes of the eye rays run the wrong way, or the pixels are stored \
         backwards.",
    ),
    picture(
        "red-blue-swapped",
        pictures::red_blue_swapped,
        "Red and blue are exchanged: BMP stores blue, green, red.",
    ),
    picture(
        "gamma",
        pictures::gamma,
        "The values have been through a gamma or sRGB curve: store round(255 c), nothing else.",
    ),
    resolved(
        "full-angle",
        camera::full_angle,
        "The camera's angle is taken as the whole vertical view angle: it is half of it.",
    ),
    resolved(
        "half-angle-doubled",
        camera::half_angle_doubled,
        "The view is too wide: the camera's angle is half of the vertical view angle already, and must not be doubled.",
    ),
    resolved(
        "horizontal-angle",
        camera::horizontal_angle,
        "The camera's angle is taken as the horizontal one: it is vertical, and tan(width) = tan(height) X0/Y0.",
    ),
    resolved(
        "stretched",
        camera::stretched,
        "The pixels are not square: the horizontal angle must follow from the vertical one, tan(width) = \
         tan(height) X0/Y0.",
    ),
    resolved(
        "angle-in-degrees",
        camera::angle_in_degrees,
        "The camera's angle is taken as degrees: it is in radians.",
    ),
    scene(
        "transposed",
        matrices::transposed,
        "Matrices are read column by column: they stand row by row, the translation in m14, m24, m34.",
    ),
    scene(
        "rotations-reversed",
        matrices::rotations_reversed,
        "Groups turn the wrong way: the rotation is transposed, or the inverse is taken for the matrix.",
    ),
    scene(
        "matrix-order",
        matrices::order_reversed,
        "Matrices of nested groups are multiplied in the wrong order: objectToWorld = outermost x ... x innermost.",
    ),
    scene(
        "inner-only",
        matrices::inner_only,
        "Only the innermost group's matrix is used: multiply all of them.",
    ),
    scene("groups-ignored", matrices::ignored, "The groups' matrices have no effect."),
    resolved(
        "normals-by-matrix",
        matrices::normals_by_matrix,
        "Normals go to the world by the matrix itself: they need its inverse transpose (and renormalising).",
    ),
    scene(
        "half-sizes",
        shapes::doubled,
        "Edge lengths and heights are taken as half of what they are: they are full lengths, half of them on \
         either side of the centre.",
    ),
    scene(
        "centre-at-base",
        shapes::centre_at_base,
        "Cylinders and cones stand on their centre: it lies at half the height.",
    ),
    scene("radius-as-diameter", shapes::radius_halved, "A radius is taken as a diameter."),
    scene(
        "flat-triangles",
        shapes::flat,
        "Triangles look flat: the normals of their corners are to be interpolated (alpha, beta, gamma).",
    ),
    scene(
        "corners-turned",
        shapes::texcoords_turned,
        "Texture coordinates stand at the wrong corners of triangles: alpha belongs to the first corner.",
    ),
    resolved(
        "unlit",
        light::unlit,
        "Lights have no effect: the normal may point away from the light (turn it to the side of the viewer), or \
         every point may lie in its own shadow (leave out hits closer than RAYEPS).",
    ),
    resolved("one-light", light::one_light, "Only the first light counts: add up all of them."),
    resolved(
        "light-reversed",
        light::directions_reversed,
        "Light directions are reversed: #light_dir and #light_spot say where the light travels to.",
    ),
    resolved(
        "no-attenuation",
        light::no_attenuation,
        "Light does not fade with distance: F = 1/(ca + la d + qa d^2).",
    ),
    resolved(
        "attenuation-exchanged",
        light::attenuation_exchanged,
        "Linear and quadratic attenuation are exchanged, or d and d^2 are.",
    ),
    resolved(
        "spot-as-point",
        light::spot_as_point,
        "Spot lights shine to all sides: their factor is missing.",
    ),
    resolved(
        "spot-half",
        light::spot_half,
        "The cut-off angle of spots is measured from the axis, not across.",
    ),
    resolved(
        "spot-double",
        light::spot_double,
        "The spot's cone is too wide: its angle is measured from the axis.",
    ),
    resolved(
        "spot-in-degrees",
        light::spot_in_degrees,
        "The cut-off angle of spots is in radians, not degrees.",
    ),
    resolved(
        "spot-without-dropoff",
        light::spot_without_dropoff,
        "Spots are equally bright up to their edge: the factor (-L.axis)^(128 sd) is missing.",
    ),
    resolved(
        "spot-exponent",
        light::spot_exponent,
        "The drop-off of spots has the wrong exponent: it is 128 sd, not sd.",
    ),
    resolved(
        "area-as-point",
        light::area_as_point,
        "Area lights cast hard shadows: take the mean over points of their disc.",
    ),
    resolved(
        "area-back",
        light::area_on_both_sides,
        "Area lights shine backwards as well: they emit to their front.",
    ),
    options("no-shadows", shade::shadows_off, "Shadows are missing."),
    options(
        "opaque-shadows",
        shade::shadows_opaque,
        "Transparent shapes cast black shadows: each surface lets kTrans M_S of the light pass.",
    ),
    resolved("no-ambient", shade::no_ambient, "The global ambient light is missing: M_A L_G."),
    resolved(
        "ambient-per-light",
        shade::ambient_per_light,
        "The ambient term is added for every light: it belongs before the sum.",
    ),
    resolved("no-emission", shade::no_emission, "Emissive colours are missing."),
    resolved("no-diffuse", shade::no_diffuse, "The diffuse term is missing: M_D (n.L)."),
    resolved("no-highlight", shade::no_highlight, "Highlights are missing: M_S (r.L)^(128 kSpec)."),
    resolved(
        "exponent",
        shade::exponent_without_128,
        "Highlights are too wide: the exponent is 128 kSpec, not kSpec.",
    ),
    resolved(
        "half-vector",
        shade::half_vector,
        "Highlights look like those of the half vector (Blinn): the formula has the mirrored view ray, r.L.",
    ),
    resolved(
        "exponent-too-large",
        shade::exponent_doubled,
        "Highlights are too narrow: the exponent is 128 kSpec.",
    ),
    resolved("no-reflection", shade::no_reflection, "Reflections are missing: kSpec M_S Trace(P, r)."),
    resolved(
        "no-refraction",
        shade::no_refraction,
        "What is transparent looks opaque: kTrans M_S Trace(P, t).",
    ),
    resolved(
        "no-bending",
        shade::no_bending,
        "Light is not bent: use Snell's law with 1/ir on entering and ir on leaving.",
    ),
    resolved(
        "ratio-inverted",
        shade::ratio_inverted,
        "Light is bent the wrong way: eta is 1/ir on entering and ir on leaving, not the reverse.",
    ),
    bend(
        "glass-normal",
        glass::normal_not_turned,
        "Rays do not get out of the glass: where a ray leaves (d.n > 0), the normal in Snell's law must be turned to \
         its side.",
    ),
    bend(
        "glass-ratio",
        glass::ratio_not_turned,
        "Light that leaves the glass is bent like light that enters: eta is 1/ir on entering, but ir on leaving.",
    ),
    bend(
        "glass-leaving",
        glass::leaving_not_seen,
        "Nobody asks whether a ray enters the glass or leaves it: on leaving (d.n > 0) turn the normal, and take ir \
         for eta.",
    ),
    resolved(
        "black-sky",
        shade::black_sky,
        "Mirrored and refracted rays that hit nothing come back black: they see the background.",
    ),
    options(
        "one-bounce-less",
        shade::one_bounce_less,
        "The recursion stops one bounce too early: an eye ray has depth 0, and rays go on while depth < limit.",
    ),
    options(
        "one-bounce-more",
        shade::one_bounce_more,
        "The recursion stops one bounce too late: an eye ray has depth 0, and rays go on while depth < limit.",
    ),
    options(
        "no-cutoff",
        shade::no_cutoff,
        "The contribution threshold has no effect: leave out rays whose contribution is below it.",
    ),
    texture(
        "texture-upside-down",
        pictures::upside_down,
        "Textures stand on their head: t = 0 is the upper row of the image.",
    ),
    texture(
        "texture-mirrored",
        pictures::mirrored,
        "Textures are mirrored: s = 0 is the left column of the image.",
    ),
    texture(
        "texture-turned",
        pictures::turned,
        "Textures are turned by half: both s and t run the wrong way.",
    ),
    texture(
        "texture-axes-exchanged",
        pictures::axes_exchanged,
        "Texture coordinates are exchanged: s runs right, t runs down.",
    ),
    texture("texture-red-blue", pictures::red_blue_swapped, "Red and blue of textures are exchanged."),
    resolved("no-texture", shade::no_texture, "Textures are missing."),
    options(
        "nearest-texel",
        shade::nearest_texel,
        "Textures look blocky: interpolate between the centres of the four texels around.",
    ),
    options("no-oversampling", shade::no_oversampling, "There is one ray a pixel: oversampling is missing."),
    options(
        "corners-only",
        shade::corners_only,
        "Pixels are the mean of their corners but are never divided further.",
    ),
    Variant {
        name: "speckles",
        hint: "Points lie in the shadow of their own surface: leave out hits of shadow rays closer than RAYEPS.",
        change: Change::Speckles,
    },
];

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_are_distinct_and_hints_are_sentences() {
        for (place, variant) in VARIANTS.iter().enumerate() {
            assert!(VARIANTS.iter().take(place).all(|other| other.name != variant.name), "{}", variant.name);
            assert!(variant.hint.ends_with('.') && variant.hint.len() > 15, "{}", variant.name);
            assert!(variant.name.chars().all(|c| c.is_ascii_lowercase() || c == '-'), "{}", variant.name);
        }
    }
}
