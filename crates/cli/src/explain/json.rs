//! An explanation as JSON; docs/explain.md describes it.

use dotray::geometry::Vec3;
use dotray::render::Antialias;
use dotray::render::inspect::Branch;
use dotray::render::inspect::End;
use dotray::render::inspect::LightTerm;
use dotray::render::inspect::Meeting;
use dotray::render::inspect::Shadow;
use serde_json::Value;
use serde_json::json;

use crate::explain::Explanation;
use crate::explain::Listed;
use crate::explain::SamplePlace;
use crate::explain::text::kind_name;

/// What programs may rely on: new members may come, none goes or changes its meaning without a new number.
const VERSION: u32 = 1;

fn vector(v: Vec3) -> Value {
    json!([v.x, v.y, v.z])
}

/// The whole object.
pub fn json(of: &Explanation<'_>) -> Value {
    let options = of.options;
    let antialias = match options.antialias {
        Antialias::None => json!({ "kind": "none" }),
        Antialias::Grid(n) => json!({ "kind": "grid", "n": n }),
        Antialias::Adaptive { threshold, depth } => {
            json!({ "kind": "adaptive", "threshold": threshold, "depth": depth })
        }
    };
    let rays = of.rays.iter().enumerate().map(|(id, ray)| ray_json(of, id, ray)).collect::<Vec<_>>();
    json!({
        "version": VERSION,
        "scene": of.scene,
        "options": {
            "width": options.width,
            "height": options.height,
            "recursion": options.recursion,
            "cutoff": options.threshold,
            "shadows": format!("{:?}", options.shadows).to_lowercase(),
            "texture_filter": format!("{:?}", options.texture_filter).to_lowercase(),
            "light_samples": options.light_samples,
            "antialias": antialias,
            "accelerator": of.accelerator,
        },
        "pixel": of.pixel.map(|(x, y)| json!([x, y])),
        "color": vector(of.sampling.mean),
        "rendered": of.rendered,
        "checks": { "sums": of.sums_agree(), "pixel": of.pixel_agrees() },
        "samples": samples(of),
        "squares": squares(of),
        "sample": of.chosen,
        "rays": rays,
        "visits": visits(of),
    })
}

fn samples(of: &Explanation<'_>) -> Value {
    let sample = |sample: &SamplePlace| {
        let place = [sample.x, sample.y];
        json!({ "film": place, "weight": sample.weight, "color": vector(sample.color) })
    };
    of.sampling.samples.iter().map(sample).collect()
}

fn squares(of: &Explanation<'_>) -> Value {
    let square = |square: &crate::explain::Square| {
        let (x, y) = square.corner;
        json!({ "film": [x, y], "edge": square.edge, "level": square.level })
    };
    of.sampling.squares.iter().map(square).collect()
}

fn visits(of: &Explanation<'_>) -> Value {
    let visit = |visit: &crate::explain::Visit| {
        json!({
            "accelerator": visit.accelerator,
            "eye": { "boxes": visit.eye_boxes, "shapes": visit.eye_shapes },
            "all": { "boxes": visit.boxes, "shapes": visit.shapes },
            "same_color": visit.same_color,
        })
    };
    of.visits.iter().map(visit).collect()
}

fn ray_json(of: &Explanation<'_>, id: usize, ray: &Listed<'_>) -> Value {
    let node = ray.node;
    json!({
        "id": id,
        "parent": ray.parent,
        "kind": kind_name(node.kind),
        "depth": node.depth,
        "origin": vector(node.ray.origin),
        "direction": vector(node.ray.direction),
        "contribution": vector(node.contribution),
        "weight": vector(node.weight),
        "tests": { "boxes": node.tests.boxes, "shapes": node.tests.shapes },
        "hit": node.meeting.as_ref().map(|met| hit(of, met, ray.children)),
        "color": vector(node.color),
    })
}

/// A shape by number, with its place.
fn shape(of: &Explanation<'_>, number: u32) -> Value {
    let place = of.shapes.get(&number);
    json!({
        "number": number,
        "kind": place.map(|place| &place.kind),
        "place": place.map(|place| &place.place),
        "groups": place.map(|place| &place.groups),
    })
}

fn hit(of: &Explanation<'_>, met: &Meeting, children: [Option<usize>; 2]) -> Value {
    let before = |normal: Vec3| vector(if met.entering { normal } else { -normal });
    let st = met.surface.in_object.texcoord.get();
    let place = of.shapes.get(&met.nearest.number).and_then(|place| place.material_place.as_ref());
    json!({
        "shape": shape(of, met.nearest.number),
        "t": met.nearest.hit.t,
        "point": vector(met.surface.point),
        "object_point": vector(met.surface.in_object.point),
        "st": [st.x, st.y],
        "entering": met.entering,
        "normal": { "before": before(met.normal), "after": vector(met.normal) },
        "geometric_normal": {
            "before": before(met.geometric_normal),
            "after": vector(met.geometric_normal),
        },
        "mirrored": vector(met.mirrored),
        "material": material(of, met.material, place),
        "texture": vector(met.texture),
        "own_light": vector(met.own_light),
        "lights": met.lights.iter().map(|term| light(of, term)).collect::<Vec<_>>(),
        "reflected": branch(&met.reflected, children[0]),
        "refracted": branch(&met.refracted, children[1]),
        "sum": vector(met.sum()),
    })
}

fn material(of: &Explanation<'_>, number: u32, place: Option<&String>) -> Value {
    let material = of.resolved.materials.get(number as usize);
    json!({
        "number": number,
        "place": place,
        "ambient": material.map(|material| vector(material.ambient)),
        "diffuse": material.map(|material| vector(material.diffuse)),
        "specular": material.map(|material| vector(material.specular)),
        "emissive": material.map(|material| vector(material.emissive)),
        "exponent": material.map(|material| material.shininess),
        "reflection": material.map(|material| vector(material.reflection)),
        "transmission": material.map(|material| vector(material.transmission)),
        "index_of_refraction": material.map(|material| material.index_of_refraction),
        "global_ambient": vector(of.resolved.ambient),
    })
}

fn light(of: &Explanation<'_>, term: &LightTerm) -> Value {
    let place = of.lights.get(term.light as usize);
    let factors = term.incident.as_ref().zip(of.world.lights().get(term.light as usize));
    let factors = factors.map(|(incident, light)| (light.color(), light.factors(incident)));
    json!({
        "light": term.light,
        "kind": place.map(|place| place.kind),
        "place": place.map(|place| &place.place),
        "sample": term.sample,
        "samples": term.samples,
        "towards": term.incident.map(|incident| vector(incident.towards)),
        // Infinite for parallel light, which JSON has no number for.
        "distance": term.incident.map(|incident| incident.distance).filter(|distance| distance.is_finite()),
        "cosine": term.cosine,
        "color": factors.map(|(color, _)| vector(color)),
        "spot": factors.map(|(_, (spot, _))| spot),
        "attenuation": factors.map(|(_, (_, attenuation))| attenuation),
        "strength": term.incident.map(|incident| vector(incident.strength)),
        "diffuse": vector(term.diffuse),
        "highlight": vector(term.highlight),
        "unshadowed": vector(term.lit),
        "shadow": shadow(of, &term.shadow),
        "filter": vector(term.filter),
        "adds": vector(term.lit * term.filter / f64::from(term.samples)),
        "tests": { "boxes": term.tests.boxes, "shapes": term.tests.shapes },
    })
}

fn shadow(of: &Explanation<'_>, of_term: &Shadow) -> Value {
    match of_term {
        Shadow::NotAsked => json!({ "result": "not-asked" }),
        Shadow::Blocked { number, .. } => json!({ "result": "blocked", "by": shape(of, *number) }),
        Shadow::Crossed(crossings) if crossings.is_empty() => json!({ "result": "free" }),
        Shadow::Crossed(crossings) => {
            let through = crossings.iter().map(|(crossing, filter)| {
                json!({ "shape": shape(of, crossing.number), "t": crossing.hit.t, "filter": vector(*filter) })
            });
            json!({ "result": "filtered", "through": through.collect::<Vec<_>>() })
        }
    }
}

fn branch(branch: &Branch, child: Option<usize>) -> Value {
    match branch {
        Branch::Traced(node) => {
            json!({ "ray": child, "weight": vector(node.weight), "adds": vector(branch.color()) })
        }
        Branch::Ended(End::Limit) => json!({ "ended": "limit" }),
        Branch::Ended(End::NoWeight) => json!({ "ended": "no-weight" }),
        Branch::Ended(End::Threshold { largest }) => json!({ "ended": "threshold", "largest": largest }),
        Branch::Ended(End::TotalReflection) => json!({ "ended": "total-reflection" }),
    }
}
