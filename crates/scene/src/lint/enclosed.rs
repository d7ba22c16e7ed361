//! Shapes wholly inside an opaque one: rays end on its surface, so none comes in.

use super::Standing;
use super::corners;
use super::standing;
use crate::diagnostic::Diagnostic;
use crate::diagnostic::Sink;
use crate::resolved::Resolved;
use dotray_geometry::Shape;
use dotray_geometry::Transform;
use dotray_geometry::Vec3;

/// Each shape is compared with each, so larger scenes are not searched.
const MOST_SHAPES: u32 = 2000;

/// Warns of each shape inside a sphere, box or cylinder that lets nothing through, unless the camera is in there, too.
pub fn find(scene: &Resolved, sink: &mut Sink) {
    if scene.shape_count > MOST_SHAPES {
        return;
    }
    let all: Vec<Standing<'_>> = standing(scene).collect();
    let opaque: Vec<&Standing<'_>> = all
        .iter()
        .filter(|container| is_opaque(scene, container) && !holds(container, scene.camera.position))
        .collect();
    for (number, inner) in all.iter().enumerate() {
        let box_corners = corners(inner.bounds());
        let outer = opaque.iter().find(|outer| {
            let itself = all.get(number).is_some_and(|inner| std::ptr::eq(inner, **outer));
            !itself && box_corners.iter().all(|corner| holds(outer, *corner))
        });
        if let Some(outer) = outer {
            sink.warn("enclosed-shape", || {
                let message =
                    format!("this `{}` stands wholly inside an opaque `{}`", inner.word(), outer.word());
                Diagnostic::warning("enclosed-shape", message)
                    .at(inner.span(scene))
                    .label("no ray meets it")
                    .note_at(outer.span(scene), "it is inside this one")
            });
        }
    }
}

fn is_opaque(scene: &Resolved, standing: &Standing<'_>) -> bool {
    let Standing { run, entry, .. } = standing;
    let materials = scene.files.get(run.file.0 as usize).map(|file| file.shape_materials(run.kind));
    let written = materials.and_then(|materials| materials.get(*entry).copied());
    let material =
        written.and_then(|written| scene.materials.get(scene.material_index(run, written) as usize));
    material.is_some_and(|material| material.transmission == Vec3::ZERO)
}

/// Whether a point of the world lies inside, clear of the surface; false for shapes that have no inside.
fn holds(outer: &Standing<'_>, point_in_world: Vec3) -> bool {
    const CLEAR: f64 = 1.0 - 1e-9;
    let frame = Transform::again(*outer.world_from_object);
    let point = frame.object_from_world.transform_point3(point_in_world);
    if let Shape::Sphere(sphere) = &outer.shape {
        point.distance(sphere.center()) < CLEAR * sphere.radius()
    } else if let Shape::Cuboid(cuboid) = &outer.shape {
        (point - cuboid.center()).abs().cmplt(0.5 * CLEAR * cuboid.size()).all()
    } else if let Shape::Cylinder(cylinder) = &outer.shape {
        let from_center = point - cylinder.center();
        let radial = Vec3::new(from_center.x, 0.0, from_center.z).length();
        radial < CLEAR * cylinder.radius() && from_center.y.abs() < 0.5 * CLEAR * cylinder.height()
    } else {
        false
    }
}
