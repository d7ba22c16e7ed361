//! How far a resolved scene reaches.

use crate::resolved::Resolved;
use crate::resolved::Run;
use dotray_geometry::Aabb;
use dotray_geometry::Affine;
use dotray_geometry::Shape;
use dotray_geometry::Vec3;
use dotray_geometry::similarity_scale;

/// A box around every shape of the scene, in world coordinates.
pub fn world_bounds(scene: &Resolved) -> Aabb {
    let mut bounds = Aabb::EMPTY;
    each_shape(scene, |shape, frame| bounds = bounds.union(shape.world_bounds(frame)));
    bounds
}

/// The radius of a sphere about `center` that holds every shape; exact where spheres under similarities and the
/// corners of boxes and triangles reach farthest, otherwise a little large. 0 for an empty scene.
pub fn radius_about(scene: &Resolved, center: Vec3) -> f64 {
    let mut radius = 0.0_f64;
    each_shape(scene, |shape, frame| radius = radius.max(reach(shape, frame, center)));
    radius
}

fn each_shape(scene: &Resolved, mut visit: impl FnMut(&Shape, &Affine)) {
    for Run { file, kind, first, count, frame, .. } in &scene.runs {
        let file = scene.files.get(file.0 as usize);
        let frame = scene.frames.get(*frame as usize);
        if let (Some(file), Some(frame)) = (file, frame) {
            file.shapes(*kind, *first, *count).for_each(|shape| visit(&shape, frame));
        }
    }
}

/// How far from `center` a point of the shape can lie at most.
fn reach(shape: &Shape, world_from_object: &Affine, center: Vec3) -> f64 {
    let distance = |point: Vec3| world_from_object.transform_point3(point).distance(center);
    match shape {
        Shape::Sphere(sphere) => match similarity_scale(world_from_object) {
            Some(scale) => distance(sphere.center()) + scale * sphere.radius(),
            None => farthest_corner(shape.bounds(), distance),
        },
        Shape::Triangle(triangle) => triangle.vertices().iter().copied().map(distance).fold(0.0, f64::max),
        Shape::Cuboid(_) | Shape::Cylinder(_) | Shape::Cone(_) | Shape::Torus(_) | Shape::Open(_) => {
            farthest_corner(shape.bounds(), distance)
        }
    }
}

fn farthest_corner(bounds: Aabb, distance: impl Fn(Vec3) -> f64) -> f64 {
    let [min, max] = [bounds.min, bounds.max];
    let x = [min.x, max.x].into_iter();
    x.flat_map(|x| [min.y, max.y].map(|y| (x, y)))
        .flat_map(|(x, y)| [min.z, max.z].map(|z| Vec3::new(x, y, z)))
        .map(distance)
        .fold(0.0, f64::max)
}
