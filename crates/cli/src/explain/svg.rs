//! A ray tree drawn in the scene, seen from above and from the side.

use dotray::geometry::Aabb;
use dotray::geometry::Vec3;
use dotray::render::inspect::LightTerm;
use dotray::render::inspect::RayKind;
use dotray::render::inspect::Shadow;
use dotray::scene::resolved::Run;
use std::collections::BTreeMap;

use crate::drawing::Drawing;
use crate::drawing::Side;
use crate::drawing::View;
use crate::explain::Explanation;
use crate::explain::text::kind_name;

const EYE: &str = "stroke=\"#1f5fbf\" stroke-width=\"2\" marker-end=\"url(#tip)\"";
const REFLECTED: &str = "stroke=\"#1a8f3c\" stroke-width=\"2\" marker-end=\"url(#tip)\"";
const REFRACTED: &str = "stroke=\"#d9730d\" stroke-width=\"2\" marker-end=\"url(#tip)\"";
const FREE: &str = "stroke=\"#c9a800\" stroke-width=\"1\" stroke-dasharray=\"5 3\"";
const BLOCKED: &str = "stroke=\"#c62828\" stroke-width=\"1\" stroke-dasharray=\"2 3\"";
const MET: &str = "fill=\"#7a7ad0\" fill-opacity=\"0.15\" stroke=\"#4a4a9a\" stroke-width=\"1.5\"";
const OTHER: &str = "fill=\"none\" stroke=\"#bbb\" stroke-width=\"0.7\"";

/// Boxes of shapes beyond those that rays met: more would hide the rays.
const MOST_SHAPES: u32 = 3000;

/// The drawing.
pub fn svg(of: &Explanation<'_>) -> String {
    let mut drawing = Drawing::new(&[View::Top, View::Side], region(of));
    others(of, &mut drawing);
    for (number, place) in &of.shapes {
        drawing.outline(&place.bounds, MET, &of.shape_name(*number));
    }
    // A light is named once, however many rays ask for it.
    let mut lights = BTreeMap::new();
    for ray in of.rays.iter() {
        for term in ray.node.meeting.iter().flat_map(|met| &met.lights) {
            let from = ray.node.meeting.as_ref().map(|met| met.surface.point);
            if let Some(end) = shadow_ray(of, &mut drawing, from, term) {
                lights.entry(term.light).or_insert(end);
            }
        }
    }
    for (number, end) in lights {
        drawing.mark(end, "#c9a800", &format!("light {number}"), Side::Below);
    }
    for (id, ray) in of.rays.iter().enumerate() {
        let node = ray.node;
        let look = match node.kind {
            RayKind::Eye => EYE,
            RayKind::Reflected => REFLECTED,
            RayKind::Refracted => REFRACTED,
        };
        let end = node
            .meeting
            .as_ref()
            .map_or_else(|| beyond(of, node.ray.at(0.0), node.ray.direction), |met| met.surface.point);
        let name = format!("ray {id}: {}", kind_name(node.kind));
        drawing.line(node.ray.origin, end, look, &name);
    }
    if let Some(eye) = of.rays.first() {
        drawing.mark(eye.node.ray.origin, "#1f5fbf", "eye", Side::Above);
    }
    let title = match of.pixel {
        Some((x, y)) => format!("{}: rays of pixel {x} {y}", of.scene),
        None => format!("{}: rays", of.scene),
    };
    let legend = [
        (EYE, "eye ray"),
        (REFLECTED, "reflected"),
        (REFRACTED, "refracted"),
        (FREE, "to a light"),
        (BLOCKED, "blocked on the way to a light"),
    ];
    drawing.finish(&title, &legend)
}

/// The box around all rays that meet something, and the lights that are near: a floor that reaches to the horizon would
/// make them too small to see.
fn region(of: &Explanation<'_>) -> Aabb {
    let mut region = Aabb::EMPTY;
    for ray in &of.rays {
        region = region.grown(ray.node.ray.origin);
        if let Some(met) = &ray.node.meeting {
            region = region.grown(met.surface.point);
        }
    }
    let farthest = 2.0 * region.size().max_element();
    for met in of.rays.iter().filter_map(|ray| ray.node.meeting.as_ref()) {
        for incident in met.lights.iter().filter_map(|term| term.incident.as_ref()) {
            let with_light = region.grown(met.surface.point + incident.towards * incident.distance);
            if incident.distance.is_finite() && with_light.size().max_element() <= farthest {
                region = with_light;
            }
        }
    }
    let margin = 0.15 * region.size().max_element();
    region.grown(region.min - margin).grown(region.max + margin)
}

/// Where a ray that meets nothing is cut off.
fn beyond(of: &Explanation<'_>, origin: Vec3, direction: Vec3) -> Vec3 {
    let size = region(of).size().max_element();
    origin + direction * if size > 0.0 { 0.3 * size } else { 1.0 }
}

/// The other shapes one by one, or, where they are too many, the boxes of none.
fn others(of: &Explanation<'_>, drawing: &mut Drawing) {
    if of.resolved.shape_count > MOST_SHAPES {
        return;
    }
    for Run { file, kind, first, count, frame, first_shape, .. } in &of.resolved.runs {
        let file = of.resolved.files.get(file.0 as usize);
        let (Some(file), Some(frame)) = (file, of.resolved.frames.get(*frame as usize)) else { continue };
        for (number, shape) in (*first_shape..).zip(file.shapes(*kind, *first, *count)) {
            if !of.shapes.contains_key(&number) {
                let name = format!("{} {number}", kind.directive().trim_start_matches('#'));
                drawing.outline(&shape.world_bounds(frame), OTHER, &name);
            }
        }
    }
}

/// Draws it and says where it ends; of an area light every eighth sample shows enough.
fn shadow_ray(
    of: &Explanation<'_>,
    drawing: &mut Drawing,
    from: Option<Vec3>,
    term: &LightTerm,
) -> Option<Vec3> {
    let (from, incident) = (from?, term.incident.as_ref()?);
    if term.samples > 8 && !term.sample.is_multiple_of(term.samples / 8) {
        return None;
    }
    let look = match &term.shadow {
        Shadow::NotAsked => return None,
        Shadow::Blocked { .. } => BLOCKED,
        Shadow::Crossed(_) => FREE,
    };
    let end = if incident.distance.is_finite() {
        from + incident.towards * incident.distance
    } else {
        beyond(of, from, incident.towards)
    };
    drawing.line(from, end, look, &format!("to light {}", term.light));
    Some(end)
}
