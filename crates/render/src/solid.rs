//! 3-D textures and bumps at a point of object space (SPEC 7).

use crate::noise::fbm;
use crate::noise::fbm_gradient;
use crate::noise::turbulence;
use dotray_geometry::Vec3;
use dotray_scene::procedural::Bump;
use dotray_scene::procedural::Pattern;
use dotray_scene::procedural::Solid;

/// The weight w of a pattern at `point_in_object`.
pub fn weight(solid: &Solid, point_in_object: Vec3) -> f64 {
    let q = point_in_object * solid.scale;
    if !q.is_finite() {
        return 0.0;
    }
    match solid.pattern {
        Pattern::Noise => (0.5 + 0.5 * fbm(q, solid.octaves)).clamp(0.0, 1.0),
        Pattern::Marble => {
            0.5 + 0.5 * libm::sin(std::f64::consts::PI * (q.x + 2.0 * turbulence(q, solid.octaves)))
        }
        Pattern::Wood => {
            let rings = (q.x * q.x + q.z * q.z).sqrt() + 0.2 * fbm(q, solid.octaves);
            if rings.is_finite() { rings - rings.floor() } else { 0.0 }
        }
        Pattern::Checker => {
            // ε keeps faces that lie on cell borders from speckling.
            let cells = (q + Vec3::splat(1e-6)).floor();
            let sum = cells.x + cells.y + cells.z;
            if sum - 2.0 * (sum * 0.5).floor() == 0.0 { 1.0 } else { 0.0 }
        }
    }
}

/// The product of all 3-D textures' colours; 1 without any.
pub fn color(solids: &[Solid], point_in_object: Vec3) -> Vec3 {
    solids.iter().fold(Vec3::ONE, |product, solid| {
        product * (solid.color2 + (solid.color - solid.color2) * weight(solid, point_in_object))
    })
}

/// The unit shading normal `normal` of object space, leaned by the bumps' slopes; `of_image` gives the slope of a
/// texture as a height, along the surface.
pub fn bumped(bumps: &[Bump], normal: Vec3, point_in_object: Vec3, of_image: impl Fn(u32) -> Vec3) -> Vec3 {
    if bumps.is_empty() {
        return normal;
    }
    let slopes = bumps.iter().fold(Vec3::ZERO, |sum, bump| {
        sum + match *bump {
            Bump::Noise { scale, octaves, height } => {
                fbm_gradient(point_in_object * scale, octaves) * (height * scale)
            }
            Bump::Image { texture, scale } => of_image(texture) * scale,
        }
    });
    let leaned = normal - (slopes - normal * slopes.dot(normal));
    // Slopes past 1e150 would overflow the length; such a normal lies in the surface.
    let longest = leaned.abs().max_element();
    if !longest.is_finite() { normal } else { (leaned / longest).normalize() }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn solid(pattern: Pattern) -> Solid {
        Solid { pattern, scale: 1.0, octaves: 4, color: Vec3::ONE, color2: Vec3::ZERO }
    }

    #[test]
    fn checker_alternates_and_does_not_speckle() {
        let checker = solid(Pattern::Checker);
        assert_eq!(weight(&checker, Vec3::new(0.5, 0.5, 0.5)), 1.0);
        assert_eq!(weight(&checker, Vec3::new(1.5, 0.5, 0.5)), 0.0);
        assert_eq!(weight(&checker, Vec3::new(-0.5, 0.5, 0.5)), 0.0);
        assert_eq!(
            weight(&checker, Vec3::new(0.5, 1.0 - 1e-12, 0.5)),
            weight(&checker, Vec3::new(0.5, 1.0, 0.5))
        );
    }

    #[test]
    fn weights_stay_in_range() {
        for pattern in [Pattern::Noise, Pattern::Marble, Pattern::Wood, Pattern::Checker] {
            for i in 0..1000 {
                let x = f64::from(i) * 1.37 - 500.0;
                let w = weight(&solid(pattern), Vec3::new(x, x * 0.7, -x * 0.3));
                assert!((0.0..=1.0).contains(&w), "{pattern:?} {w}");
            }
        }
    }

    #[test]
    fn a_bump_leans_against_the_slope() {
        let bump = Bump::Noise { scale: 1.0, octaves: 1, height: 0.3 };
        let p = Vec3::new(0.4, 0.3, 0.7);
        let slope = fbm_gradient(p, 1) * 0.3;
        let n = bumped(&[bump], Vec3::Y, p, |_| Vec3::ZERO);
        assert!((n.length() - 1.0).abs() < 1e-15);
        assert!((n - Vec3::new(-slope.x, 1.0, -slope.z).normalize()).length() < 1e-15);
    }
}
