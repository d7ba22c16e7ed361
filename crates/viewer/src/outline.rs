//! The scene's tree as rows of a list: what is closed costs nothing, and a run of a million shapes is one node.

use dotray_scene::Resolved;
use dotray_scene::model::ShapeKind;
use dotray_scene::walk::DEFAULT_STEPS;
use dotray_scene::walk::Step;
use dotray_scene::walk::Walk;
use std::collections::HashSet;
use std::ops::Range;

/// What is selected.
#[derive(Clone, Debug, PartialEq)]
pub struct Selection {
    /// The shapes.
    pub shapes: Range<u32>,
    /// What it is called.
    pub name: String,
    /// The box around it.
    pub bounds: dotray_geometry::Aabb,
}

/// What a node stands for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum NodeKind {
    /// A `#group_begin`: the file and the number of its matrix.
    Group(u32, u32),
    /// An instance of a file: the file in which it stands and the number of the include.
    Instance(u32, u32),
    /// Consecutive shapes of one kind.
    Shapes(ShapeKind),
}

/// A node of the tree.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Node {
    /// What it is.
    pub kind: NodeKind,
    /// How many nodes are around it.
    pub depth: u32,
    /// The shapes in it.
    pub shapes: Range<u32>,
    /// The number of the first node after all that is in it.
    pub end: u32,
}

/// A line of the list.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct Row {
    /// The node that it shows or that its shape belongs to.
    pub node: u32,
    /// One shape of the node; `None` for the node as a whole.
    pub shape: Option<u32>,
}

/// The tree, and what of it is open.
#[derive(Clone, Debug, Default)]
pub struct Outline {
    nodes: Vec<Node>,
    open: HashSet<u32>,
    /// The first row of each node that is visible.
    visible: Vec<(u64, u32)>,
    rows: u64,
}

/// Trees up to so many rows are shown open.
const SHOWN_OPEN: u64 = 60;

impl Outline {
    /// The tree of a scene.
    pub fn new(resolved: &Resolved) -> Self {
        let mut nodes: Vec<Node> = Vec::new();
        let mut around: Vec<usize> = Vec::new();
        let mut next_shape = 0_u32;
        for step in Walk::new(&resolved.files, DEFAULT_STEPS) {
            let node = |kind, count| {
                let shapes = next_shape..next_shape.saturating_add(count);
                Node { kind, depth: around.len() as u32, shapes, end: nodes.len() as u32 + 1 }
            };
            match step {
                Ok(Step::OpenGroup { file, group }) => {
                    let node = node(NodeKind::Group(file.0, group), 0);
                    around.push(nodes.len());
                    nodes.push(node);
                }
                Ok(Step::OpenInstance { file, include, .. }) => {
                    let node = node(NodeKind::Instance(file.0, include), 0);
                    around.push(nodes.len());
                    nodes.push(node);
                }
                Ok(Step::CloseGroup | Step::CloseInstance) => {
                    let end = nodes.len() as u32;
                    if let Some(node) = around.pop().and_then(|at| nodes.get_mut(at)) {
                        (node.shapes.end, node.end) = (next_shape, end);
                    }
                }
                Ok(Step::Shapes { kind, count, .. }) => {
                    let node = node(NodeKind::Shapes(kind), count);
                    next_shape = node.shapes.end;
                    nodes.push(node);
                }
                Err(_) => break,
            }
        }
        let mut outline = Self { nodes, ..Self::default() };
        outline.open_all();
        if outline.rows > SHOWN_OPEN {
            outline.open.clear();
            outline.lay();
        }
        outline
    }

    /// The nodes, what is in a node after it.
    pub fn nodes(&self) -> &[Node] {
        &self.nodes
    }

    /// How many rows there are.
    pub fn row_count(&self) -> usize {
        usize::try_from(self.rows).unwrap_or(usize::MAX)
    }

    /// A row; `None` past the last.
    pub fn row(&self, index: usize) -> Option<Row> {
        let index = index as u64;
        let at = self.visible.partition_point(|(first, _)| *first <= index).checked_sub(1)?;
        let &(first, node) = self.visible.get(at)?;
        let within = index - first;
        let shapes = &self.nodes.get(node as usize)?.shapes;
        if index >= self.rows {
            return None;
        }
        let shape = within.checked_sub(1).map(|within| shapes.start + within as u32);
        Some(Row { node, shape })
    }

    /// The shapes of a row.
    pub fn shapes(&self, row: Row) -> Range<u32> {
        match row.shape {
            Some(number) => number..number + 1,
            None => self.nodes.get(row.node as usize).map_or(0..0, |node| node.shapes.clone()),
        }
    }

    /// Whether a node can be opened: it holds something that it does not show itself.
    pub fn can_open(&self, node: u32) -> bool {
        self.nodes.get(node as usize).is_some_and(|it| match it.kind {
            NodeKind::Group(..) | NodeKind::Instance(..) => it.end > node + 1,
            NodeKind::Shapes(_) => it.shapes.len() > 1,
        })
    }

    /// Whether it is open.
    pub fn is_open(&self, node: u32) -> bool {
        self.open.contains(&node)
    }

    /// Opens or closes a node.
    pub fn toggle(&mut self, node: u32) {
        if !self.open.remove(&node) && self.can_open(node) {
            self.open.insert(node);
        }
        self.lay();
    }

    /// Opens every group and instance; runs of shapes stay closed.
    pub fn open_all(&mut self) {
        let groups = self.nodes.iter().enumerate().filter(|(_, n)| !matches!(n.kind, NodeKind::Shapes(_)));
        self.open = groups.map(|(at, _)| at as u32).collect();
        self.lay();
    }

    /// Opens all that is around a shape; answers with the shape's row.
    pub fn reveal(&mut self, shape: u32) -> Option<usize> {
        let mut at = 0;
        let mut leaf = None;
        while let Some(node) = self.nodes.get(at as usize) {
            if !node.shapes.contains(&shape) {
                at = node.end;
                continue;
            }
            leaf = Some(at);
            if self.can_open(at) {
                self.open.insert(at);
            }
            at += 1;
        }
        self.lay();
        let leaf = leaf?;
        let within = self.visible.binary_search_by_key(&leaf, |(_, node)| *node).ok()?;
        let (first, _) = self.visible.get(within)?;
        let node = self.nodes.get(leaf as usize)?;
        let below = if self.is_open(leaf) { u64::from(shape - node.shapes.start) + 1 } else { 0 };
        usize::try_from(first + below).ok()
    }

    /// Works out which nodes are visible.
    fn lay(&mut self) {
        self.visible.clear();
        let mut row = 0_u64;
        let mut at = 0_u32;
        while let Some(node) = self.nodes.get(at as usize) {
            self.visible.push((row, at));
            let open = self.open.contains(&at);
            let own = matches!(node.kind, NodeKind::Shapes(_)) && open;
            row += 1 + if own { node.shapes.len() as u64 } else { 0 };
            at = if open { at + 1 } else { node.end };
        }
        self.rows = row;
    }

    /// The nodes that `wanted` says yes to, at most `most`, of the first million.
    pub fn find(&self, most: usize, mut wanted: impl FnMut(&Node) -> bool) -> Vec<u32> {
        let all = self.nodes.iter().enumerate().take(1_000_000);
        all.filter(|(_, node)| wanted(node)).map(|(at, _)| at as u32).take(most).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use dotray_scene::files::Disk;
    use dotray_scene::load::LoadOptions;
    use dotray_scene::load::load_text;
    use dotray_scene::resolve::resolve;

    fn outline(text: &str) -> Outline {
        let scene = load_text("t.ray", text, &Disk, &LoadOptions::default()).scene.expect("a scene");
        Outline::new(&resolve(scene).resolved.expect("resolved"))
    }

    const TREE: &str = "#shape_sphere -1 0 0 0 1  #shape_sphere -1 1 0 0 1
        #group_begin 1 0 0 0 0 1 0 0 0 0 1 0 0 0 0 1
          #group_begin 1 0 0 0 0 1 0 0 0 0 1 0 0 0 0 1 #shape_box -1 0 0 0 1 1 1 #group_end
          #shape_sphere -1 0 0 0 1
        #group_end
        #shape_cone -1 0 0 0 1 1";

    #[test]
    fn rows_follow_what_is_open() {
        let mut outline = outline(TREE);
        let shapes = |outline: &Outline| -> Vec<Range<u32>> {
            (0..outline.row_count()).map(|row| outline.shapes(outline.row(row).unwrap())).collect()
        };
        // Small trees start open: the run of two spheres, outer, inner, box, sphere, cone.
        assert_eq!(shapes(&outline), [0..2, 2..4, 2..3, 2..3, 3..4, 4..5]);
        outline.toggle(1);
        assert_eq!(shapes(&outline), [0..2, 2..4, 4..5]);
        outline.toggle(0);
        assert_eq!(shapes(&outline), [0..2, 0..1, 1..2, 2..4, 4..5]);
        assert_eq!(outline.row(2), Some(Row { node: 0, shape: Some(1) }));
        assert_eq!(outline.row(5), None);
        // One shape alone has nothing to open.
        assert!(!outline.can_open(5) && outline.can_open(2));
    }

    #[test]
    fn a_shape_is_revealed_in_its_row() {
        let mut outline = outline(TREE);
        outline.toggle(1);
        assert_eq!(outline.reveal(2), Some(3));
        assert_eq!(outline.shapes(outline.row(3).unwrap()), 2..3);
        let row = outline.reveal(1).unwrap();
        assert_eq!(outline.row(row), Some(Row { node: 0, shape: Some(1) }));
        assert_eq!(outline.reveal(99), None);
        assert_eq!(outline.find(9, |node| matches!(node.kind, NodeKind::Group(..))), [1, 2]);
    }

    #[test]
    fn a_million_shapes_are_one_row() {
        let mut text = String::new();
        for _ in 0..20_000 {
            text.push_str("#shape_sphere -1 0 0 0 1\n");
        }
        let mut outline = outline(&text);
        assert_eq!((outline.nodes().len(), outline.row_count()), (1, 1));
        outline.toggle(0);
        assert_eq!(outline.row_count(), 20_001);
    }
}
