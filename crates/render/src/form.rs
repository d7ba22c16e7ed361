//! The forms in which shapes are baked, and how a position tells its form.

use dotray_geometry::Affine;
use dotray_geometry::Cuboid;
use dotray_geometry::Vec3;

/// In which form a shape was baked. Framed forms are tested in object coordinates with their run's transform, own forms
/// hold their transform themselves ([`crate::own`]).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Form {
    /// A sphere under a similarity.
    Sphere,
    /// A box that is axis-aligned in the world.
    Cuboid,
    /// A cylinder under a similarity.
    Cylinder,
    /// A cone under a similarity.
    Cone,
    /// A triangle: its corners in the world.
    Triangle,
    /// An ellipsoid.
    FramedSphere,
    /// A parallelepiped.
    FramedCuboid,
    /// A cylinder under any other map.
    FramedCylinder,
    /// A cone under any other map.
    FramedCone,
    /// A shape that is rare, under any map.
    FramedOther,
    /// A sphere or ellipsoid that stands alone in its group.
    OwnSphere,
    /// A box that stands alone in its group.
    OwnCuboid,
    /// A cylinder that stands alone in its group.
    OwnCylinder,
    /// A cone that stands alone in its group.
    OwnCone,
}

impl Form {
    pub(crate) const ALL: [Self; 14] = [
        Self::Sphere,
        Self::Cuboid,
        Self::Cylinder,
        Self::Cone,
        Self::Triangle,
        Self::FramedSphere,
        Self::FramedCuboid,
        Self::FramedCylinder,
        Self::FramedCone,
        Self::FramedOther,
        Self::OwnSphere,
        Self::OwnCuboid,
        Self::OwnCylinder,
        Self::OwnCone,
    ];
}

/// A form and an index into its array, in 32 bits.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Slot(u32);

impl Slot {
    const INDEX_BITS: u32 = 28;

    pub(crate) fn new(form: Form, index: usize) -> Self {
        debug_assert!(index < 1 << Self::INDEX_BITS);
        Self((form as u32) << Self::INDEX_BITS | index as u32)
    }

    #[inline(always)]
    pub(crate) fn form(self) -> Form {
        Form::ALL[(self.0 >> Self::INDEX_BITS) as usize]
    }

    #[inline(always)]
    pub(crate) fn index(self) -> usize {
        (self.0 & ((1 << Self::INDEX_BITS) - 1)) as usize
    }
}

/// The box as a box of the world, where the map only moves and stretches along the axes.
pub(crate) fn axis_aligned(cuboid: &Cuboid, world_from_object: &Affine) -> Option<Cuboid> {
    let m = &world_from_object.matrix3;
    let diagonal = Vec3::new(m.x_axis.x, m.y_axis.y, m.z_axis.z);
    let off_diagonal = [m.x_axis.y, m.x_axis.z, m.y_axis.x, m.y_axis.z, m.z_axis.x, m.z_axis.y];
    if off_diagonal.iter().any(|&v| v != 0.0) || !diagonal.cmpgt(Vec3::ZERO).all() {
        return None;
    }
    let center = world_from_object.transform_point3(cuboid.center());
    Cuboid::new(center, cuboid.size() * diagonal).ok()
}
