//! `dotray info`: what is in a scene.

use dotray::geometry::Vec3;
use dotray::scene::summary::Summary;
use dotray::scene::summary::summarize;
use serde_json::Value;
use serde_json::json;

use crate::args::InfoArgs;
use crate::exit::Failure;
use crate::exit::put;
use crate::input::understand;
use crate::meaning::Place;
use crate::messages::Messages;
use crate::values::TextOrJson;
use crate::values::When;

/// Prints the scene in numbers.
pub fn run(typed: &InfoArgs, color: When) -> Result<(), Failure> {
    let understood = understand(&Place::of(&typed.scene), &typed.reading, Messages::new(color, false))?;
    let summary = summarize(&understood.resolved);
    match typed.format {
        TextOrJson::Text => put(summary.to_string().as_bytes()),
        TextOrJson::Json => put(format!("{:#}\n", json(&summary)).as_bytes()),
    }
}

fn json(summary: &Summary) -> Value {
    let Summary { shapes, groups, instances, max_depth, lights, materials, vertices, .. } = summary;
    let vector = |vector: Vec3| json!([vector.x, vector.y, vector.z]);
    let bounds = if summary.bounds.is_empty() {
        Value::Null
    } else {
        json!({ "min": vector(summary.bounds.min), "max": vector(summary.bounds.max) })
    };
    let camera = &summary.camera;
    json!({
        "files": summary.files.iter().map(|path| path.display().to_string()).collect::<Vec<_>>(),
        "shapes": {
            "total": shapes.total(),
            "spheres": shapes.spheres,
            "boxes": shapes.boxes,
            "cylinders": shapes.cylinders,
            "cones": shapes.cones,
            "triangles": shapes.triangles,
            "indexed_triangles": shapes.indexed_triangles,
            "tori": shapes.tori,
            "open": shapes.open,
        },
        "vertices": vertices,
        "groups": groups,
        "instances": instances,
        "depth": max_depth,
        "lights": {
            "total": lights.total(),
            "point": lights.point,
            "spot": lights.spot,
            "directional": lights.directional,
            "area": lights.area,
        },
        "materials": materials,
        "textures": summary.textures,
        "bounds": bounds,
        "camera": {
            "position": vector(camera.position),
            "direction": vector(camera.direction),
            "up": vector(camera.up),
            "half_angle": camera.half_angle,
            "is_default": summary.camera_is_default,
        },
        "background": vector(summary.background),
        "ambient": vector(summary.ambient),
    })
}
