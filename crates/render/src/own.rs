//! Shapes that stand alone in their groups: the group's matrix and the shape's measures in the fewest bytes that say
//! every bit of both.
//!
//! Where every cylinder has a matrix of its own, its two matrices and its numbers as written would take 230 bytes
//! beside those that a ray is tested against. Here they take 96 in all, and serve for the test as well: one column of
//! a turned and evenly scaled matrix follows from the other two but for a few last bits, which are kept; the inverse
//! is computed when it is asked for, by the same operations as ever; and a shape in a group of its own mostly stands
//! about the origin. What is otherwise in any of this is kept apart, whole ([`Spill`]).

use crate::form::axis_aligned;
use dotray_geometry::Affine;
use dotray_geometry::Cone;
use dotray_geometry::Crossings;
use dotray_geometry::Cuboid;
use dotray_geometry::Cylinder;
use dotray_geometry::Mat3;
use dotray_geometry::Ray;
use dotray_geometry::Sphere;
use dotray_geometry::Transform;
use dotray_geometry::Vec3;
use dotray_geometry::shape::OrientedCone;
use dotray_geometry::shape::OrientedCylinder;

/// What does not follow from the rest of a shape.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Spill {
    /// The third column of the matrix.
    z_axis: Vec3,
    /// Where the shape stands in its group.
    center: Vec3,
    /// The radius of a cone's upper disc.
    top: f64,
}

/// A shape of `N` measures and its matrix.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Own<const N: usize> {
    x_axis: Vec3,
    y_axis: Vec3,
    translation: Vec3,
    /// A sphere's radius, a cylinder's or cone's radius and height, a box's edges.
    sizes: [f64; N],
    /// What to add to the bits of the third column that the other two foretell; or the two halves of an index into
    /// the list of spills.
    rest: [u16; 3],
    flags: u16,
}

/// A sphere and its matrix.
pub(crate) type OwnSphere = Own<1>;
/// A cylinder or a cone, and its matrix.
pub(crate) type OwnRound = Own<2>;
/// A box and its matrix.
pub(crate) type OwnCuboid = Own<3>;

/// [`Own::flags`]: the third column points the other way.
const MIRRORED: u16 = 1;
/// [`Own::flags`]: there is a spill.
const SPILLED: u16 = 2;
/// [`Own::flags`]: rays are tested in the world.
const IN_WORLD: u16 = 4;

/// [`Own::flags`]: the matrix only turns, so that nothing need be divided to foretell.
const UNIT: u16 = 8;

/// Smaller parts of a foretold column, whose length is 1, are rounding: 0 is likelier.
const NOTHING: f64 = 1e-14;

/// Numbers in the order of the numbers that bits mean, neighbours one apart.
#[inline]
fn rank(x: f64) -> i64 {
    let bits = x.to_bits() as i64;
    bits ^ ((bits >> 63) as u64 >> 1) as i64
}

/// The number of this rank.
#[inline]
fn of_rank(rank: i64) -> f64 {
    f64::from_bits((rank ^ ((rank >> 63) as u64 >> 1) as i64) as u64)
}

/// The third column of a turned and evenly scaled matrix, but for rounding.
#[inline]
fn foretold(x_axis: Vec3, y_axis: Vec3, flags: u16) -> [f64; 3] {
    let sign = if flags & MIRRORED != 0 { -1.0 } else { 1.0 };
    let length = if flags & UNIT != 0 { 1.0 } else { x_axis.length() };
    let scale = if flags & UNIT != 0 { sign } else { sign / length };
    let column = x_axis.cross(y_axis) * scale;
    let least = NOTHING * length;
    column.to_array().map(|part| if part.abs() < least { 0.0 } else { part })
}

/// How far the bits of the column are from those foretold, if near.
#[inline]
fn rest_of(column: Vec3, foretold: [f64; 3]) -> Option<[u16; 3]> {
    let mut rest = [0; 3];
    for (rest, (part, foretold)) in rest.iter_mut().zip(column.to_array().into_iter().zip(foretold)) {
        *rest = i16::try_from(rank(part).wrapping_sub(rank(foretold))).ok()? as u16;
    }
    Some(rest)
}

impl<const N: usize> Own<N> {
    /// The shape of these measures about `center` under the matrix; `top` is 0 but for truncated cones.
    fn new(
        world_from_object: &Affine,
        (center, sizes, top): (Vec3, [f64; N], f64),
        is_in_world: bool,
        spills: &mut Vec<Spill>,
    ) -> Self {
        let Mat3 { x_axis, y_axis, z_axis } = world_from_object.matrix3;
        let flag = |is_so: bool, flag: u16| if is_so { flag } else { 0 };
        let flags = flag(is_in_world, IN_WORLD)
            | flag(x_axis.cross(y_axis).dot(z_axis) < 0.0, MIRRORED)
            | flag((x_axis.length_squared() - 1.0).abs() < 1e-13, UNIT);
        let is_plain = [center.x, center.y, center.z, top].into_iter().all(|x| x.to_bits() == 0);
        let rest = if is_plain { rest_of(z_axis, foretold(x_axis, y_axis, flags)) } else { None };
        let (rest, flags) = match rest {
            Some(rest) => (rest, flags),
            None => {
                spills.push(Spill { z_axis, center, top });
                (halves(spills.len() - 1), flags | SPILLED)
            }
        };
        Self { x_axis, y_axis, translation: world_from_object.translation, sizes, rest, flags }
    }

    /// The same shape where its spill stands so many further down the list.
    pub fn moved(mut self, by: usize) -> Self {
        if self.flags & SPILLED != 0 {
            self.rest = halves(self.spill_index() + by);
        }
        self
    }

    fn spill_index(&self) -> usize {
        usize::from(self.rest[0]) | usize::from(self.rest[1]) << 16
    }

    #[inline]
    fn spill<'a>(&self, spills: &'a [Spill]) -> Option<&'a Spill> {
        if self.flags & SPILLED == 0 { None } else { spills.get(self.spill_index()) }
    }

    #[inline]
    fn center(&self, spills: &[Spill]) -> Vec3 {
        self.spill(spills).map_or(Vec3::ZERO, |spill| spill.center)
    }

    /// Whether rays are tested in the world.
    #[inline]
    pub fn is_in_world(&self) -> bool {
        self.flags & IN_WORLD != 0
    }

    /// The group's matrix.
    #[inline]
    pub fn world_from_object(&self, spills: &[Spill]) -> Affine {
        let z_axis = match self.spill(spills) {
            Some(spill) => spill.z_axis,
            None => {
                let mut column = foretold(self.x_axis, self.y_axis, self.flags);
                for (part, rest) in column.iter_mut().zip(self.rest) {
                    *part = of_rank(rank(*part) + i64::from(rest as i16));
                }
                Vec3::from_array(column)
            }
        };
        Affine { matrix3: Mat3::from_cols(self.x_axis, self.y_axis, z_axis), translation: self.translation }
    }

    /// The group's matrix and its inverse.
    #[inline]
    pub fn transform(&self, spills: &[Spill]) -> Transform {
        Transform::again(self.world_from_object(spills))
    }

    #[inline]
    fn object_from_world(&self, spills: &[Spill]) -> Affine {
        self.transform(spills).object_from_world
    }

    /// The matrix as far as a test in the world asks for it, and its scale: about the origin the third column is
    /// multiplied by 0.
    #[inline]
    fn similarity(&self, spills: &[Spill]) -> (Affine, f64) {
        let z_axis = self.spill(spills).map_or(Vec3::ZERO, |spill| spill.z_axis);
        let matrix3 = Mat3::from_cols(self.x_axis, self.y_axis, z_axis);
        (Affine { matrix3, translation: self.translation }, self.x_axis.length_squared().sqrt())
    }
}

/// A shape with all that follows from its matrix, so that many rays can be tested one after the other.
pub(crate) enum Ready {
    Sphere(Sphere),
    Cuboid(Cuboid),
    Cylinder(OrientedCylinder),
    Cone(OrientedCone),
    /// Here and below: rays are brought into the shape's coordinates.
    SphereInObject(Affine, Sphere),
    CuboidInObject(Affine, Cuboid),
    CylinderInObject(Affine, Cylinder),
    ConeInObject(Affine, Cone),
}

impl Ready {
    /// All crossings of the ray's line.
    #[inline(always)]
    pub fn crossings(&self, ray: &Ray) -> Crossings {
        match self {
            Self::Sphere(sphere) => sphere.crossings(ray),
            Self::Cuboid(cuboid) => cuboid.crossings(ray),
            Self::Cylinder(cylinder) => cylinder.crossings(ray),
            Self::Cone(cone) => cone.crossings(ray),
            Self::SphereInObject(map, sphere) => sphere.crossings(&ray.transformed(map)),
            Self::CuboidInObject(map, cuboid) => cuboid.crossings(&ray.transformed(map)),
            Self::CylinderInObject(map, cylinder) => cylinder.crossings(&ray.transformed(map)),
            Self::ConeInObject(map, cone) => cone.crossings(&ray.transformed(map)),
        }
    }
}

/// An index in two halves.
fn halves(index: usize) -> [u16; 3] {
    [index as u16, (index >> 16) as u16, 0]
}

/// What was written was a shape, and is again.
const SAME: &str = "the numbers of a shape that was made before";

impl OwnSphere {
    /// Of a sphere that is tested in the world, or is an ellipsoid there.
    pub fn of(sphere: &Sphere, matrix: &Affine, is_in_world: bool, spills: &mut Vec<Spill>) -> Self {
        Self::new(matrix, (sphere.center(), [sphere.radius()], 0.0), is_in_world, spills)
    }

    /// As written.
    pub fn sphere(&self, spills: &[Spill]) -> Sphere {
        Sphere::new(self.center(spills), self.sizes[0]).expect(SAME)
    }

    /// Ready for rays.
    #[inline]
    pub fn ready(&self, spills: &[Spill]) -> Ready {
        if !self.is_in_world() {
            return Ready::SphereInObject(self.object_from_world(spills), self.sphere(spills));
        }
        let (matrix, scale) = self.similarity(spills);
        let center = matrix.transform_point3(self.center(spills));
        Ready::Sphere(Sphere::new(center, self.sizes[0] * scale).expect(SAME))
    }
}

impl OwnRound {
    /// Of a cylinder under a similarity, or under any map.
    pub fn of_cylinder(
        cylinder: &Cylinder,
        matrix: &Affine,
        is_in_world: bool,
        spills: &mut Vec<Spill>,
    ) -> Self {
        let sizes = [cylinder.radius(), cylinder.height()];
        Self::new(matrix, (cylinder.center(), sizes, 0.0), is_in_world, spills)
    }

    /// Of a cone under a similarity, or under any map.
    pub fn of_cone(cone: &Cone, matrix: &Affine, is_in_world: bool, spills: &mut Vec<Spill>) -> Self {
        let sizes = [cone.radius(), cone.height()];
        Self::new(matrix, (cone.center(), sizes, cone.top()), is_in_world, spills)
    }

    /// The cylinder as written.
    #[inline]
    pub fn cylinder(&self, spills: &[Spill]) -> Cylinder {
        let [radius, height] = self.sizes;
        Cylinder::new(self.center(spills), radius, height).expect(SAME)
    }

    /// The cone as written.
    #[inline]
    pub fn cone(&self, spills: &[Spill]) -> Cone {
        let [radius, height] = self.sizes;
        let top = self.spill(spills).map_or(0.0, |spill| spill.top);
        Cone::truncated(self.center(spills), radius, top, height).expect(SAME)
    }

    /// The cylinder, ready for rays.
    #[inline]
    pub fn ready_cylinder(&self, spills: &[Spill]) -> Ready {
        let cylinder = self.cylinder(spills);
        if !self.is_in_world() {
            return Ready::CylinderInObject(self.object_from_world(spills), cylinder);
        }
        let (matrix, scale) = self.similarity(spills);
        Ready::Cylinder(OrientedCylinder::from_object(&cylinder, &matrix, scale))
    }

    /// The cone, ready for rays.
    #[inline]
    pub fn ready_cone(&self, spills: &[Spill]) -> Ready {
        let cone = self.cone(spills);
        if !self.is_in_world() {
            return Ready::ConeInObject(self.object_from_world(spills), cone);
        }
        let (matrix, scale) = self.similarity(spills);
        Ready::Cone(OrientedCone::from_object(&cone, &matrix, scale))
    }
}

impl OwnCuboid {
    /// Of a box that is axis-aligned in the world, or is not.
    pub fn of(cuboid: &Cuboid, matrix: &Affine, is_in_world: bool, spills: &mut Vec<Spill>) -> Self {
        Self::new(matrix, (cuboid.center(), cuboid.size().to_array(), 0.0), is_in_world, spills)
    }

    /// As written.
    #[inline]
    pub fn cuboid(&self, spills: &[Spill]) -> Cuboid {
        Cuboid::new(self.center(spills), Vec3::from_array(self.sizes)).expect(SAME)
    }

    /// Ready for rays.
    #[inline]
    pub fn ready(&self, spills: &[Spill]) -> Ready {
        let cuboid = self.cuboid(spills);
        if !self.is_in_world() {
            return Ready::CuboidInObject(self.object_from_world(spills), cuboid);
        }
        Ready::Cuboid(axis_aligned(&cuboid, &self.world_from_object(spills)).expect(SAME))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use dotray_geometry::similarity_scale;

    /// Numbers that look random, by the finaliser of splitmix64 (Steele, Lea, Flood, OOPSLA 2014).
    struct Random(u64);

    impl Random {
        /// From -1 to 1.
        fn number(&mut self) -> f64 {
            self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
            let mut hash = self.0;
            hash = (hash ^ (hash >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
            hash = (hash ^ (hash >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
            ((hash ^ (hash >> 31)) >> 11) as f64 / (1_u64 << 52) as f64 - 1.0
        }

        fn vector(&mut self) -> Vec3 {
            Vec3::new(self.number(), self.number(), self.number())
        }
    }

    /// The axis along a direction, the others computed as exporters do: often one part of one is 0.
    fn turn_to(along: Vec3, random: &mut Random) -> Mat3 {
        let across = match (random.number() * 8.0) as i32 {
            0 => along.cross(Vec3::X),
            1 => along.cross(Vec3::Z),
            _ => along.cross(random.vector()),
        };
        let x_axis = across.normalize_or(Vec3::X);
        let y_axis = along.normalize_or(Vec3::Y);
        Mat3::from_cols(x_axis, y_axis, x_axis.cross(y_axis))
    }

    fn bits(affine: &Affine) -> [u64; 12] {
        affine.to_cols_array().map(f64::to_bits)
    }

    #[test]
    fn turned_and_scaled_matrices_come_back_bit_by_bit_and_nearly_all_in_short() {
        let (mut random, mut spills) = (Random(1), Vec::new());
        let cylinder = Cylinder::new(Vec3::ZERO, 0.125, 2.0).unwrap();
        let count = 20_000;
        for index in 0..count {
            let turn = turn_to(random.vector(), &mut random);
            let scale = if index % 3 == 0 { 1.0 } else { libm::exp(10.0 * random.number()) };
            let mirror = Vec3::new(1.0, 1.0, if index % 5 == 0 { -1.0 } else { 1.0 });
            let matrix3 = turn * Mat3::from_diagonal(mirror) * scale;
            let matrix = Affine { matrix3, translation: random.vector() * 100.0 };
            let own = OwnRound::of_cylinder(&cylinder, &matrix, true, &mut spills);
            assert_eq!(bits(&own.world_from_object(&spills)), bits(&matrix), "{matrix3}");
            let transform = Transform::new(matrix).unwrap();
            assert_eq!(bits(&own.transform(&spills).object_from_world), bits(&transform.object_from_world));
        }
        assert!(spills.len() < count / 200, "{} of {count} spilled", spills.len());
    }

    #[test]
    fn quarter_turns_need_no_spill() {
        let mut spills = Vec::new();
        let axes = [Vec3::X, Vec3::Y, Vec3::Z, Vec3::NEG_X, Vec3::NEG_Y, Vec3::NEG_Z];
        for x_axis in axes {
            for y_axis in axes.into_iter().filter(|y_axis| x_axis.dot(*y_axis) == 0.0) {
                for z_axis in [x_axis.cross(y_axis), y_axis.cross(x_axis)] {
                    let matrix3 = Mat3::from_cols(x_axis, y_axis, z_axis) * 3.5;
                    let matrix = Affine { matrix3, translation: Vec3::ONE };
                    let sphere = Sphere::new(Vec3::ZERO, 1.5).unwrap();
                    let own = OwnSphere::of(&sphere, &matrix, true, &mut spills);
                    assert_eq!(bits(&own.world_from_object(&spills)), bits(&matrix));
                }
            }
        }
        assert!(spills.is_empty());
    }

    #[test]
    fn whatever_does_not_follow_is_spilled_and_comes_back() {
        let (mut random, mut spills) = (Random(7), vec![]);
        let mut owns = Vec::new();
        for index in 0..1000 {
            let mut matrix3 = turn_to(random.vector(), &mut random);
            if index % 2 == 0 {
                matrix3 *= Mat3::from_cols(Vec3::X, random.vector(), Vec3::Z * 2.0);
            }
            let matrix = Affine { matrix3, translation: random.vector() };
            let center = if index % 3 == 0 { Vec3::new(0.0, -0.0, 0.0) } else { random.vector() };
            let cone = Cone::truncated(center, 1.0, if index % 4 == 0 { 0.5 } else { 0.0 }, 3.0).unwrap();
            let cuboid = Cuboid::new(center, random.vector().abs()).unwrap();
            let cones = OwnRound::of_cone(&cone, &matrix, false, &mut spills);
            let cuboids = OwnCuboid::of(&cuboid, &matrix, false, &mut spills);
            owns.push((cones, cuboids, cone, cuboid, matrix));
        }
        // As if they were appended to others.
        let mut all = vec![spills[0]; 70_000];
        all.extend_from_slice(&spills);
        for (cones, cuboids, cone, cuboid, matrix) in owns {
            let (cones, cuboids) = (cones.moved(70_000), cuboids.moved(70_000));
            assert_eq!(format!("{:?}", cones.cone(&all)), format!("{cone:?}"));
            assert_eq!(format!("{:?}", cuboids.cuboid(&all)), format!("{cuboid:?}"));
            assert_eq!(bits(&cones.world_from_object(&all)), bits(&matrix));
            assert_eq!(bits(&cuboids.world_from_object(&all)), bits(&matrix));
        }
    }

    #[test]
    fn rays_meet_them_where_they_meet_the_shape_itself() {
        let (mut random, mut spills) = (Random(3), Vec::new());
        let mut met = 0;
        for index in 0..20_000 {
            let mut matrix3 = turn_to(random.vector(), &mut random) * random.number().abs();
            if index % 4 == 0 {
                matrix3 *= Mat3::from_diagonal(random.vector());
            }
            let Ok(frame) = Transform::new(Affine { matrix3, translation: random.vector() }) else {
                continue;
            };
            let matrix = frame.world_from_object;
            let center = if index % 3 == 0 { random.vector() } else { Vec3::ZERO };
            let scale = similarity_scale(&matrix);
            let origin = random.vector() * 4.0;
            let aim = matrix.transform_point3(center) + random.vector() * 0.5;
            let ray = Ray::new(origin, aim - origin);
            let in_object = ray.transformed(&frame.object_from_world);
            let (radius, height) = (random.number().abs(), random.number().abs());

            let cylinder = Cylinder::new(center, radius, height).unwrap();
            let own = OwnRound::of_cylinder(&cylinder, &matrix, scale.is_some(), &mut spills);
            let expected = match scale {
                Some(scale) => OrientedCylinder::from_object(&cylinder, &matrix, scale).crossings(&ray),
                None => cylinder.crossings(&in_object),
            };
            let found = own.ready_cylinder(&spills).crossings(&ray);
            assert_eq!(found, expected);
            met += found.as_slice().len();

            let cone =
                Cone::truncated(center, radius, if index % 8 < 2 { 0.3 } else { 0.0 }, height).unwrap();
            let own = OwnRound::of_cone(&cone, &matrix, scale.is_some(), &mut spills);
            let expected = match scale {
                Some(scale) => OrientedCone::from_object(&cone, &matrix, scale).crossings(&ray),
                None => cone.crossings(&in_object),
            };
            assert_eq!(own.ready_cone(&spills).crossings(&ray), expected);

            let sphere = Sphere::new(center, radius).unwrap();
            let own = OwnSphere::of(&sphere, &matrix, scale.is_some(), &mut spills);
            let expected = match scale {
                Some(scale) => {
                    Sphere::new(matrix.transform_point3(center), radius * scale).unwrap().crossings(&ray)
                }
                None => sphere.crossings(&in_object),
            };
            assert_eq!(own.ready(&spills).crossings(&ray), expected);

            let cuboid = Cuboid::new(center, Vec3::new(radius, height, 0.5)).unwrap();
            let own = OwnCuboid::of(&cuboid, &matrix, false, &mut spills);
            assert_eq!(own.ready(&spills).crossings(&ray), cuboid.crossings(&in_object));
        }
        assert!(met > 5000, "{met}");
    }

    #[test]
    fn they_are_small() {
        assert_eq!((size_of::<OwnSphere>(), size_of::<OwnRound>(), size_of::<OwnCuboid>()), (88, 96, 104));
    }
}
