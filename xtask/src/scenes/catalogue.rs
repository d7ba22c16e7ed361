//! The scenes by their names.

use crate::scenes::Material;
use crate::scenes::Scene;
use crate::scenes::Shapes;
use crate::scenes::View;
use crate::scenes::knot::knot;
use crate::scenes::particles;
use crate::scenes::rods;

const COLORS: [[f64; 3]; particles::MATERIALS] = [
    [0.9, 0.2, 0.2],
    [0.2, 0.9, 0.2],
    [0.2, 0.3, 0.9],
    [0.9, 0.9, 0.2],
    [0.9, 0.2, 0.9],
    [0.2, 0.9, 0.9],
    [0.9, 0.6, 0.2],
    [0.8, 0.8, 0.8],
];

const CUBE: View = View { eye: [1.9, 1.5, 2.4], at: [0.5; 3], angle: 32.0 };
const KNOT: View = View { eye: [0.5, 1.5, 2.4], at: [0.5, 0.45, 0.5], angle: 28.0 };

/// What a scene's raw float32 file is called, by its shapes; boxes have none.
pub fn raw_kind(name: &str) -> Option<&'static str> {
    ["rnd", "pack", "mirrors"]
        .iter()
        .map(|kind| (*kind, "sph"))
        .chain([("cyl", "cyl"), ("cone", "con"), ("knot", "tri"), ("bunny", "tri")])
        .find_map(|(start, kind)| name.starts_with(start).then_some(kind))
}

/// The number at the end of a name, if it is a kind and one digit.
fn power(name: &str, kind: &str) -> Option<usize> {
    let digit = name.strip_prefix(kind)?;
    let power: u32 = digit.parse().ok().filter(|power| (1..=8).contains(power))?;
    (digit.len() == 1).then(|| 10_usize.pow(power))
}

/// Makes a scene; `None` where the name is not one of `rndK`, `packK`, `mirrorsK`, `cylK`, `coneK`, `boxK` (10^K
/// shapes), `knot0`, `knot2` and `knots0`, `knots2` (small and large, flat and smooth) or `knotc` (a small one).
pub fn make(name: &str) -> Option<Scene> {
    let law = |words: &str| words.to_owned();
    let (law, shapes) = if let Some(count) = power(name, "rnd").or_else(|| power(name, "mirrors")) {
        (law("random spheres, N·π·r² = 2, r ± 25 %"), Shapes::Balls(particles::random(count)))
    } else if let Some(count) = power(name, "pack") {
        (law("packed spheres, a quarter of the volume"), Shapes::Balls(particles::packed(count)))
    } else if let Some(count) = power(name, "cyl") {
        (
            law("random cylinders, radius ⅛ of the length, optical depth 2"),
            Shapes::Cylinders(rods::rods(count, 3)),
        )
    } else if let Some(count) = power(name, "cone") {
        (
            law("random cones, radius ⅛ of the length, as long as the cylinders"),
            Shapes::Cones(rods::rods(count, 17)),
        )
    } else if let Some(count) = power(name, "box") {
        (law("random turned boxes, ¼ × 1 × ¼ of the cylinders' length"), Shapes::Blocks(rods::blocks(count)))
    } else {
        let (rings, sides, smooth) = match name {
            "knot0" => (512, 68, false),
            "knot2" => (2048, 272, false),
            "knots0" => (512, 68, true),
            "knots2" => (2048, 272, true),
            "knotc" => (128, 16, true),
            _ => return None,
        };
        (law("bumpy torus knot on a floor"), Shapes::Mesh(knot(rings, sides, smooth)))
    };
    let is_mesh = matches!(shapes, Shapes::Mesh(_));
    let reflection = if name.starts_with("mirrors") { 0.3 } else { 0.0 };
    let materials = if is_mesh {
        vec![Material { color: [0.8, 0.7, 0.5], reflection }]
    } else {
        COLORS.iter().map(|&color| Material { color, reflection }).collect()
    };
    Some(Scene { law, view: if is_mesh { KNOT } else { CUBE }, materials, shapes })
}

#[cfg(test)]
mod tests {
    use super::make;
    use super::raw_kind;

    #[test]
    fn names_tell_what_is_made() {
        for name in ["rnd3", "pack3", "mirrors3", "cyl3", "cone3", "box3"] {
            assert_eq!(make(name).map(|scene| scene.shapes.len()), Some(1000), "{name}");
        }
        assert_eq!(make("knotc").map(|scene| scene.shapes.len()), Some(2 * 128 * 16 + 2));
        for name in ["rnd", "rnd9", "rnd10", "rndx", "knot1", "balls4"] {
            assert_eq!(make(name), None, "{name}");
        }
        assert_eq!(["rnd3", "cone5", "box5"].map(raw_kind), [Some("sph"), Some("con"), None]);
    }

    #[test]
    fn making_twice_gives_the_same() {
        assert_eq!(make("cyl3"), make("cyl3"));
        assert_ne!(make("rnd3").map(|s| s.shapes), make("mirrors4").map(|s| s.shapes));
    }
}
