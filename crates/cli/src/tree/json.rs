//! A tree as JSON; docs/explain.md describes it.

use dotray::geometry::Aabb;
use dotray::geometry::Mat4;
use serde_json::Value;
use serde_json::json;

use crate::tree::Node;
use crate::tree::NodeKind;
use crate::tree::Tree;

/// As for explanations: members may come, none goes.
const VERSION: u32 = 1;

/// The whole object.
pub fn json(tree: &Tree<'_>, world: bool, most_shapes: u32) -> Value {
    let node = |(id, node): (usize, &Node)| node_json(tree, id, node, world, most_shapes);
    json!({
        "version": VERSION,
        "nodes": tree.nodes.iter().enumerate().map(node).collect::<Vec<_>>(),
        "cut": tree.cut,
    })
}

fn node_json(tree: &Tree<'_>, id: usize, node: &Node, world: bool, most_shapes: u32) -> Value {
    let mut value = json!({
        "id": id,
        "parent": node.parent,
        "bounds": bounds(&node.bounds),
        "shape_count": node.shapes,
    });
    let Some(members) = value.as_object_mut() else { return value };
    let mut put = |name: &str, value: Value| members.insert(name.to_owned(), value);
    match &node.kind {
        NodeKind::Root => {
            put("kind", json!("scene"));
        }
        NodeKind::Group(matrix) => {
            put("kind", json!("group"));
            put("place", json!(tree.place(node)));
            put("matrix", rows(matrix));
        }
        NodeKind::Instance(name) => {
            put("kind", json!("instance"));
            put("place", json!(tree.place(node)));
            put("file", json!(name));
        }
        NodeKind::Shapes(first, count) => {
            put("kind", json!("shapes"));
            put("first", json!(first));
            let numbers = *first..first.saturating_add(*count.min(&most_shapes));
            let shapes = numbers.filter_map(|number| tree.shape(number)).map(|shape| {
                json!({
                    "number": shape.number,
                    "kind": shape.kind,
                    "place": shape.place,
                    "bounds": bounds(&shape.bounds),
                })
            });
            put("shapes", shapes.collect());
            return value;
        }
    }
    if world {
        put("object_to_world", rows(&Mat4::from(node.frame.world_from_object)));
        put("world_to_object", rows(&Mat4::from(node.frame.object_from_world)));
    }
    value
}

fn bounds(bounds: &Aabb) -> Value {
    if bounds.is_empty() {
        return Value::Null;
    }
    json!({ "min": bounds.min.to_array(), "max": bounds.max.to_array() })
}

fn rows(matrix: &Mat4) -> Value {
    json!([0, 1, 2, 3].map(|row| matrix.row(row).to_array().map(|x| x + 0.0)))
}
