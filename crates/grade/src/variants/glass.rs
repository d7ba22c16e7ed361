//! Glass that rays do not leave as they should.

use crate::bent::Surface;
use crate::bent::snell;
use dotray_geometry::Vec3;

fn facing(at: &Surface) -> Vec3 {
    if at.entering { at.outward } else { -at.outward }
}

fn ratio(at: &Surface) -> f64 {
    if at.entering { 1.0 / at.index } else { at.index }
}

/// The normal is not turned where a ray leaves: it goes back inside.
pub fn normal_not_turned(at: &Surface) -> Option<Vec3> {
    snell(at.direction, at.outward, ratio(at))
}

/// Leaving is bent like entering.
pub fn ratio_not_turned(at: &Surface) -> Option<Vec3> {
    snell(at.direction, facing(at), 1.0 / at.index)
}

/// Neither the normal nor the ratio is turned: nobody asks whether the ray leaves.
pub fn leaving_not_seen(at: &Surface) -> Option<Vec3> {
    snell(at.direction, at.outward, 1.0 / at.index)
}

/// The right way: with it the picture is the truth.
#[cfg(test)]
pub fn right(at: &Surface) -> Option<Vec3> {
    snell(at.direction, facing(at), ratio(at))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn wrong_rays_go_wrong_and_right_ones_right() {
        let direction = Vec3::new(0.6, -0.8, 0.0);
        let inward = Surface { direction, outward: Vec3::Y, entering: true, index: 1.5 };
        for bend in [normal_not_turned, ratio_not_turned, leaving_not_seen, right] {
            let t = bend(&inward).unwrap();
            assert!((t.length() - 1.0).abs() < 1e-12 && (t.x - 0.4).abs() < 1e-12 && t.y < 0.0, "{t}");
        }
        let direction = Vec3::new(0.4, -0.84_f64.sqrt(), 0.0);
        let outward = Surface { direction, outward: -Vec3::Y, entering: false, index: 1.5 };
        let t = right(&outward).unwrap();
        assert!((t - Vec3::new(0.6, -0.8, 0.0)).length() < 1e-12);
        // Back inside, which is above.
        assert!(normal_not_turned(&outward).unwrap().y > 0.0 && leaving_not_seen(&outward).unwrap().y > 0.0);
        let t = ratio_not_turned(&outward).unwrap();
        assert!(t.y < 0.0 && (t.x - 0.4 / 1.5).abs() < 1e-12);
        // Total reflection where it belongs, and none for who bends towards the normal.
        let flat = Surface { direction: Vec3::new(0.8, -0.6, 0.0), ..outward };
        assert_eq!((right(&flat), normal_not_turned(&flat)), (None, None));
        assert!(ratio_not_turned(&flat).is_some());
    }
}
