//! The boxes of a tree, seen from above, in front and the side.

use crate::drawing::Drawing;
use crate::drawing::View;
use crate::tree::NodeKind;
use crate::tree::Tree;
use crate::tree::text::extent;

/// Boxes that are drawn: a viewer holds each as an object.
const MOST_BOXES: usize = 20_000;
/// Looks by depth, again from the start.
const LOOKS: [&str; 5] = [
    "fill=\"none\" stroke=\"#1f5fbf\" stroke-width=\"1.6\"",
    "fill=\"none\" stroke=\"#d9730d\" stroke-width=\"1.4\"",
    "fill=\"none\" stroke=\"#1a8f3c\" stroke-width=\"1.2\"",
    "fill=\"none\" stroke=\"#8e24aa\" stroke-width=\"1\"",
    "fill=\"none\" stroke=\"#c62828\" stroke-width=\"1\"",
];
const SHAPE: &str = "fill=\"#999\" fill-opacity=\"0.12\" stroke=\"#999\" stroke-width=\"0.6\"";

/// The drawing.
pub fn svg(tree: &Tree<'_>, scene: &str) -> String {
    let shown = tree.nodes.first().map_or(dotray::geometry::Aabb::EMPTY, |root| root.bounds);
    let mut drawing = Drawing::new(&[View::Top, View::Front, View::Side], shown);
    let mut left = MOST_BOXES;
    // Shapes first, so that the boxes around them lie over them.
    for node in &tree.nodes {
        if let NodeKind::Shapes(first, count) = node.kind {
            for shape in (first..first.saturating_add(count)).take(left).filter_map(|n| tree.shape(n)) {
                let name = format!("{} {} {}", shape.kind, shape.number, shape.place);
                drawing.outline(&shape.bounds, SHAPE, &name);
            }
            left = left.saturating_sub(count as usize);
        }
    }
    for node in tree.nodes.iter().rev().take(MOST_BOXES) {
        let what = match &node.kind {
            NodeKind::Root => "scene".to_owned(),
            NodeKind::Group(_) => format!("group {}", tree.place(node)),
            NodeKind::Instance(name) => format!("instance of {name} {}", tree.place(node)),
            NodeKind::Shapes(..) => continue,
        };
        let look = LOOKS.get(node.depth % LOOKS.len()).copied().unwrap_or(SHAPE);
        drawing.outline(&node.bounds, look, &format!("{what}: {}", extent(&node.bounds)));
    }
    let [scene_look, first, second, third, ..] = LOOKS;
    let legend = [
        (scene_look, "scene"),
        (first, "groups"),
        (second, "groups in groups"),
        (third, "deeper"),
        (SHAPE, "shapes"),
    ];
    drawing.finish(scene, &legend)
}
