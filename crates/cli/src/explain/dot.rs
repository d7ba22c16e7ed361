//! A ray tree for Graphviz.

use dotray::geometry::Vec3;
use dotray::render::inspect::Branch;
use dotray::render::inspect::End;
use dotray::render::inspect::Shadow;
use dotray::scene::number::General;
use std::fmt::Write;

use crate::explain::Explanation;
use crate::explain::Listed;
use crate::explain::text::kind_name;

/// The graph: a node a ray, filled with its colour, a node a shadow ray and an ended branch.
pub fn dot(of: &Explanation<'_>) -> String {
    let mut graph = String::from(
        "digraph rays {\n  rankdir=LR;\n  node [shape=box, style=filled, fontname=\"sans-serif\"];\n  \
         edge [fontname=\"sans-serif\", fontsize=11];\n",
    );
    for (id, ray) in of.rays.iter().enumerate() {
        // Writing into a string cannot fail.
        let _ = write_ray(&mut graph, of, id, ray);
    }
    graph.push_str("}\n");
    graph
}

fn write_ray(graph: &mut String, of: &Explanation<'_>, id: usize, ray: &Listed<'_>) -> std::fmt::Result {
    let node = ray.node;
    let met = node.meeting.as_ref().map_or_else(
        || "background".to_owned(),
        |met| format!("{}\nt {}", of.shape_name(met.nearest.number), General(met.nearest.hit.t)),
    );
    let label = quoted(&format!("ray {id}: {}\n{met}\n{}", kind_name(node.kind), numbers(node.color)));
    let (fill, ink) = colors(node.color);
    writeln!(graph, "  r{id} [label={label}, fillcolor=\"{fill}\", fontcolor=\"{ink}\"];")?;
    if let Some(parent) = ray.parent {
        let label = quoted(&format!("{}\n· {}", kind_name(node.kind), numbers(node.weight)));
        writeln!(graph, "  r{parent} -> r{id} [label={label}];")?;
    }
    let Some(met) = &node.meeting else { return Ok(()) };
    for (number, terms) in met.lights.chunk_by(|a, b| a.light == b.light).enumerate() {
        let Some(first) = terms.first() else { continue };
        let sum = terms.iter().fold(Vec3::ZERO, |sum, term| sum + term.lit * term.filter);
        let adds = sum / f64::from(first.samples);
        let mut label = format!("light {}\nadds {}", first.light, numbers(adds));
        for term in terms.iter().take(1) {
            match &term.shadow {
                Shadow::NotAsked => {}
                Shadow::Blocked { number, .. } => {
                    label.push_str(&format!("\nblocked by {}", of.shape_name(*number)));
                }
                Shadow::Crossed(crossings) => {
                    for (crossing, _) in crossings {
                        label.push_str(&format!("\nthrough {}", of.shape_name(crossing.number)));
                    }
                }
            }
        }
        let (fill, ink) = colors(adds);
        let label = quoted(&label);
        let look = format!("shape=ellipse, fillcolor=\"{fill}\", fontcolor=\"{ink}\"");
        writeln!(graph, "  r{id}l{number} [label={label}, {look}];")?;
        let style = if adds == Vec3::ZERO { "dotted" } else { "dashed" };
        writeln!(graph, "  r{id} -> r{id}l{number} [style={style}];")?;
    }
    for (kind, branch) in [("reflected", &met.reflected), ("refracted", &met.refracted)] {
        let why = match branch {
            Branch::Traced(_) | Branch::Ended(End::NoWeight) => continue,
            Branch::Ended(End::Limit) => "recursion limit",
            Branch::Ended(End::Threshold { .. }) => "below the threshold",
            Branch::Ended(End::TotalReflection) => "total internal reflection",
        };
        let label = quoted(&format!("{kind}:\n{why}"));
        writeln!(graph, "  r{id}{kind} [label={label}, shape=plaintext, fillcolor=\"white\"];")?;
        writeln!(graph, "  r{id} -> r{id}{kind} [style=dotted];")?;
    }
    Ok(())
}

fn numbers(v: Vec3) -> String {
    let [x, y, z] = v.to_array().map(|x| General((x * 1e3).round() / 1e3 + 0.0).to_string());
    format!("({x} {y} {z})")
}

/// The fill of a colour, and black or white on it.
fn colors(color: Vec3) -> (String, &'static str) {
    let [r, g, b] = color.to_array().map(|c| (255.0 * c.clamp(0.0, 1.0)).round() as u8);
    let light = color.clamp(Vec3::ZERO, Vec3::ONE).dot(Vec3::new(0.3, 0.6, 0.1)) > 0.5;
    (format!("#{r:02x}{g:02x}{b:02x}"), if light { "black" } else { "white" })
}

fn quoted(text: &str) -> String {
    let escaped = text.replace('\\', "\\\\").replace('"', "\\\"").replace('\n', "\\n");
    format!("\"{escaped}\"")
}
