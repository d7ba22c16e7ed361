//! The directions in which texture coordinates grow, against differences of the coordinates themselves.

use dotray_geometry::Cone;
use dotray_geometry::Cuboid;
use dotray_geometry::Cylinder;
use dotray_geometry::OpenSide;
use dotray_geometry::Ray;
use dotray_geometry::Shape;
use dotray_geometry::Sphere;
use dotray_geometry::Surface;
use dotray_geometry::Torus;
use dotray_geometry::Triangle;
use dotray_geometry::Vec2;
use dotray_geometry::Vec3;

fn shapes() -> Vec<(&'static str, Shape)> {
    let c = Vec3::new(0.3, -0.2, 0.4);
    let corners = [Vec3::new(-1.0, -0.8, 0.2), Vec3::new(1.1, -0.6, 0.5), Vec3::new(0.2, 1.2, -0.3)];
    // Neither square nor unmirrored.
    let skewed = [Vec2::new(0.1, 0.2), Vec2::new(0.3, 0.9), Vec2::new(0.8, 0.4)];
    let cylinder = Cylinder::new(c, 0.8, 1.5).unwrap();
    vec![
        ("sphere", Shape::Sphere(Sphere::new(c, 1.2).unwrap())),
        ("box", Shape::Cuboid(Cuboid::new(c, Vec3::new(1.0, 1.4, 0.8)).unwrap())),
        ("cylinder", Shape::Cylinder(cylinder)),
        ("open cylinder", Shape::Open(OpenSide::Cylinder(cylinder))),
        ("cone", Shape::Cone(Cone::new(c, 0.9, 1.6).unwrap())),
        ("torus", Shape::Torus(Torus::new(c, 0.3, 0.9).unwrap())),
        ("triangle", Shape::Triangle(Triangle::new(corners, [Vec3::ZERO; 3], skewed).unwrap())),
    ]
}

fn surface_along(shape: &Shape, ray: &Ray) -> Option<Surface> {
    Some(shape.surface(ray, shape.intersect(ray, 0.0, f64::INFINITY)?))
}

/// How much (s, t) change over a small step along the surface; `None` across an edge or the seam.
fn change(shape: &Shape, from: &Surface, step: Vec3) -> Option<Vec2> {
    let normal = from.geometric_normal;
    let near = |step: Vec3| surface_along(shape, &Ray::new(from.point + step + normal * 1e-3, -normal));
    let (before, after) = (near(-step)?, near(step)?);
    let change = after.texcoord.get() - before.texcoord.get();
    let bent = (after.geometric_normal - before.geometric_normal).length() > 1e-3;
    (!bent && change.length() < 0.1).then_some(change)
}

#[test]
fn they_are_where_the_coordinates_grow_fastest() {
    for (name, shape) in shapes() {
        let mut checked = 0;
        for i in 0..400_u32 {
            // Rays from all around to points near the middle.
            let turn = |k: f64| (f64::from(i) * k).fract() * 2.0 - 1.0;
            let from = Vec3::new(turn(0.618), turn(0.754), turn(0.569)).normalize() * 9.0;
            let to = Vec3::new(turn(0.382), turn(0.137), turn(0.271)) * 1.2;
            let Some(surface) = surface_along(&shape, &Ray::new(from, to - from)) else { continue };
            let Some([along_s, along_t]) = shape.texture_axes(&surface) else { continue };
            let normal = surface.geometric_normal;
            for (which, axis) in [("s", along_s), ("t", along_t)] {
                assert!((axis.length() - 1.0).abs() < 1e-12, "{name}: {axis}");
                assert!(axis.dot(normal).abs() < 1e-9, "{name}: {axis} {normal}");
                let of = |change: Vec2| if which == "s" { change.x } else { change.y };
                let step = 1e-4;
                let along = change(&shape, &surface, axis * step);
                let across = change(&shape, &surface, axis.cross(normal) * step);
                let (Some(along), Some(across)) = (along.map(of), across.map(of)) else { continue };
                // The slope of a height that lies in one plane has no share across its own direction.
                assert!(along > 0.0, "{name}: {which} falls by {along} at {}", surface.point);
                assert!(
                    across.abs() <= 1e-3 * along,
                    "{name}: {which} grows by {across} across, {along} along"
                );
                checked += 1;
            }
        }
        assert!(checked > 60, "{name}: only {checked} places");
    }
}

#[test]
fn where_there_are_none_there_are_none() {
    let sphere = Shape::Sphere(Sphere::new(Vec3::ZERO, 1.0).unwrap());
    let pole = surface_along(&sphere, &Ray::new(Vec3::Y * 3.0, Vec3::NEG_Y)).unwrap();
    assert_eq!(sphere.texture_axes(&pole), None);
    let corners = [Vec3::ZERO, Vec3::X, Vec3::Y];
    for texcoords in [[Vec2::ZERO; 3], [Vec2::ZERO, Vec2::X, Vec2::X * 2.0]] {
        let triangle = Triangle::new(corners, [Vec3::ZERO; 3], texcoords).unwrap();
        assert_eq!(triangle.texture_axes(), None);
    }
    for size in [1e-150, 1e-20, 1e20, 1e150] {
        let corners = corners.map(|corner| corner * size);
        let texcoords = [Vec2::ZERO, Vec2::X, Vec2::Y];
        let triangle = Triangle::new(corners, [Vec3::ZERO; 3], texcoords).unwrap();
        assert_eq!(triangle.texture_axes(), Some([Vec3::X, Vec3::Y]), "{size}");
    }
}
