//! Shapes as plain numbers, for whoever wants to know whether two scenes say the same.

use dotray_geometry::Cone;
use dotray_geometry::Cylinder;
use dotray_geometry::OpenSide;
use dotray_geometry::Shape;
use dotray_geometry::Vec3;

/// Passes all numbers of a shape on, always in the same order.
pub fn of_shape(shape: &Shape, take: &mut impl FnMut(f64)) {
    let mut vector = |v: Vec3, rest: &[f64]| v.to_array().iter().chain(rest).for_each(|&x| take(x));
    match shape {
        Shape::Sphere(sphere) => vector(sphere.center(), &[sphere.radius()]),
        Shape::Cuboid(cuboid) => vector(cuboid.center(), &cuboid.size().to_array()),
        Shape::Cylinder(cylinder) => of_cylinder(cylinder, vector),
        Shape::Cone(cone) => of_cone(cone, vector),
        Shape::Triangle(triangle) => {
            triangle.vertices().iter().for_each(|vertex| vector(*vertex, &[]));
            triangle.normals().iter().for_each(|normal| vector(*normal, &[]));
            triangle.texcoords().iter().for_each(|st| st.to_array().into_iter().for_each(&mut *take));
        }
        Shape::Torus(torus) => vector(torus.center(), &[torus.tube(), torus.ring()]),
        Shape::Open(OpenSide::Cylinder(cylinder)) => of_cylinder(cylinder, vector),
        Shape::Open(OpenSide::Cone(cone)) => {
            // Told apart from the cylinder of the same numbers.
            vector(Vec3::ZERO, &[]);
            of_cone(cone, vector);
        }
    }
}

fn of_cylinder(cylinder: &Cylinder, mut vector: impl FnMut(Vec3, &[f64])) {
    vector(cylinder.center(), &[cylinder.radius(), cylinder.height()]);
}

fn of_cone(cone: &Cone, mut vector: impl FnMut(Vec3, &[f64])) {
    vector(cone.center(), &[cone.radius(), cone.height(), cone.top()]);
}
