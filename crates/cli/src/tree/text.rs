//! A tree as indented text.

use dotray::geometry::Aabb;
use dotray::geometry::Affine;
use dotray::geometry::Mat4;
use dotray::scene::number::General;
use std::io;
use std::io::Write;

use crate::tree::NodeKind;
use crate::tree::Tree;

/// What is shown.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Shown {
    /// Cumulative matrices.
    pub world: bool,
    /// Lines of shapes a run.
    pub shapes: u32,
    /// With colour.
    pub color: bool,
}

/// Writes the tree: one line a group, instance or shape with its place and its box in the world.
pub fn write(tree: &Tree<'_>, shown: Shown, out: &mut impl Write) -> io::Result<()> {
    let bold = |text: &str| if shown.color { format!("\x1b[1m{text}\x1b[0m") } else { text.to_owned() };
    for node in &tree.nodes {
        let indent = Indent(node.depth);
        let (count, extent) = (node.shapes, extent(&node.bounds));
        let (name, matrix) = match &node.kind {
            NodeKind::Root => ("scene".to_owned(), None),
            NodeKind::Group(matrix) => ("group".to_owned(), Some(matrix)),
            NodeKind::Instance(file) => (format!("instance of {file}"), None),
            NodeKind::Shapes(first, count) => {
                write_shapes(tree, node.depth, *first, *count, shown, out)?;
                continue;
            }
        };
        let place = tree.place(node);
        writeln!(out, "{indent}{} {place}  {count} shapes  {extent}", bold(&name))?;
        if let Some(matrix) = matrix {
            writeln!(out, "{indent}  matrix {}", rows(matrix))?;
        }
        if shown.world {
            writeln!(out, "{indent}  objectToWorld {}", affine(&node.frame.world_from_object))?;
            writeln!(out, "{indent}  worldToObject {}", affine(&node.frame.object_from_world))?;
        }
    }
    if tree.cut {
        writeln!(out, "(the tree goes on: its instances multiply too often)")?;
    }
    Ok(())
}

fn write_shapes(
    tree: &Tree<'_>,
    depth: usize,
    first: u32,
    count: u32,
    shown: Shown,
    out: &mut impl Write,
) -> io::Result<()> {
    let indent = Indent(depth);
    for number in first..first.saturating_add(count.min(shown.shapes)) {
        if let Some(shape) = tree.shape(number) {
            writeln!(out, "{indent}{} {number} {}  {}", shape.kind, shape.place, extent(&shape.bounds))?;
        }
    }
    let rest = count.saturating_sub(shown.shapes);
    if rest > 0 {
        writeln!(out, "{indent}… and {rest} more (--shapes N shows more)")?;
    }
    Ok(())
}

/// Two blanks a level; from 100 levels on the depth in brackets.
struct Indent(usize);

impl std::fmt::Display for Indent {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let width = 2 * self.0.min(100);
        write!(f, "{:width$}", "")?;
        if self.0 > 100 { write!(f, "[{}] ", self.0) } else { Ok(()) }
    }
}

/// `x -1…1, y …` or `empty`.
pub fn extent(bounds: &Aabb) -> String {
    if bounds.is_empty() {
        return "empty".to_owned();
    }
    let (min, max) = (bounds.min.to_array(), bounds.max.to_array());
    let axes = ["x", "y", "z"].iter().zip(min.iter().zip(max));
    let axes =
        axes.map(|(axis, (low, high))| format!("{axis} {} … {}", General(low + 0.0), General(high + 0.0)));
    axes.collect::<Vec<_>>().join(", ")
}

fn rows(matrix: &Mat4) -> String {
    let row = |row: usize| matrix.row(row).to_array().map(|x| General(x + 0.0).to_string()).join(" ");
    [0, 1, 2, 3].map(row).join("; ")
}

fn affine(affine: &Affine) -> String {
    rows(&Mat4::from(*affine))
}
