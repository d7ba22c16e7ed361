//! Wrong readings of shapes.

use dotray_geometry::Cone;
use dotray_geometry::Cuboid;
use dotray_geometry::Cylinder;
use dotray_geometry::Sphere;
use dotray_geometry::Triangle;
use dotray_geometry::Vec3;
use dotray_scene::Scene;

/// Changes what can be changed; what would be no shape stays.
fn each<T: Copy, E>(shapes: &mut [T], change: impl Fn(&T) -> Result<T, E>) {
    shapes.iter_mut().for_each(|shape| *shape = change(shape).unwrap_or(*shape));
}

pub fn doubled(scene: &mut Scene) {
    for file in &mut scene.files {
        each(&mut file.cuboids.shapes, |s| Cuboid::new(s.center(), 2.0 * s.size()));
        each(&mut file.cylinders.shapes, |s| Cylinder::new(s.center(), s.radius(), 2.0 * s.height()));
        each(&mut file.cones.shapes, |s| Cone::truncated(s.center(), s.radius(), s.top(), 2.0 * s.height()));
    }
}

pub fn centre_at_base(scene: &mut Scene) {
    let up = |height: f64| Vec3::new(0.0, 0.5 * height, 0.0);
    for file in &mut scene.files {
        each(&mut file.cylinders.shapes, |s| {
            Cylinder::new(s.center() + up(s.height()), s.radius(), s.height())
        });
        each(&mut file.cones.shapes, |s| {
            Cone::truncated(s.center() + up(s.height()), s.radius(), s.top(), s.height())
        });
    }
}

pub fn radius_halved(scene: &mut Scene) {
    for file in &mut scene.files {
        each(&mut file.spheres.shapes, |s| Sphere::new(s.center(), 0.5 * s.radius()));
        each(&mut file.cylinders.shapes, |s| Cylinder::new(s.center(), 0.5 * s.radius(), s.height()));
        each(&mut file.cones.shapes, |s| {
            Cone::truncated(s.center(), 0.5 * s.radius(), 0.5 * s.top(), s.height())
        });
    }
}

/// A corner without a normal has that of its face.
pub fn flat(scene: &mut Scene) {
    for file in &mut scene.files {
        each(&mut file.triangles.shapes, |s| Triangle::new(*s.vertices(), [Vec3::ZERO; 3], *s.texcoords()));
        file.vertices.iter_mut().for_each(|vertex| vertex.normal = Vec3::ZERO);
    }
}

pub fn texcoords_turned(scene: &mut Scene) {
    for file in &mut scene.files {
        each(&mut file.triangles.shapes, |s| {
            let [a, b, c] = *s.texcoords();
            Triangle::new(*s.vertices(), *s.normals(), [b, c, a])
        });
    }
}
