//! Lines of the world around which cylinders and cones lie.

use dotray_geometry::Aabb;
use dotray_geometry::Affine;
use dotray_geometry::Vec3;

/// A line of the world that a shape lies around.
#[derive(Clone, Copy, Debug)]
pub struct Spine {
    /// A point of the line: the middle of the shape's world box.
    pub point: Vec3,
    /// The line's direction, of length 1.
    pub axis: Vec3,
    /// How far the shape's points may be from the line.
    pub radius: f64,
    /// How far they may be from the point.
    pub reach: f64,
}

impl Spine {
    /// Around a cylinder or cone of the world from `base` along the unit vector `axis`.
    pub fn along(base: Vec3, axis: Vec3, radius: f64, height: f64) -> Self {
        let half = 0.5 * height;
        Self { point: base + axis * half, axis, radius, reach: (radius * radius + half * half).sqrt() }
    }

    /// Around a cylinder or cone along the object's y axis whose world box is `bounds`: its discs become ellipses,
    /// whose longer half axis is the radius times the larger singular value of the two other columns.
    pub fn new(world_from_object: &Affine, bounds: &Aabb, center: Vec3, radius: f64) -> Option<Self> {
        let m = &world_from_object.matrix3;
        let (xx, zz, xz) = (m.x_axis.length_squared(), m.z_axis.length_squared(), m.x_axis.dot(m.z_axis));
        let half_difference = 0.5 * (xx - zz);
        let largest = 0.5 * (xx + zz) + (half_difference * half_difference + xz * xz).sqrt();
        let axis = m.y_axis.try_normalize()?;
        // The line goes through the shape's centre, which is not quite the middle of a cone's box.
        let point = world_from_object.transform_point3(center);
        let reach = (bounds.max - point).max(point - bounds.min).length();
        let spine = Self { point, axis, radius: radius * largest.sqrt() * (1.0 + 1e-12), reach };
        (spine.radius.is_finite() && reach.is_finite()).then_some(spine)
    }
}
