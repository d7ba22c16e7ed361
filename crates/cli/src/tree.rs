//! A scene's tree with places, matrices and boxes, as data.

pub mod json;
pub mod svg;
pub mod text;

use dotray::geometry::Aabb;
use dotray::geometry::Mat4;
use dotray::geometry::Transform;
use dotray::scene::Resolved;
use dotray::scene::Sources;
use dotray::scene::frame;
use dotray::scene::model::SceneFile;
use dotray::scene::span::FileId;
use dotray::scene::span::Span;
use dotray::scene::walk::DEFAULT_STEPS;
use dotray::scene::walk::Step;
use dotray::scene::walk::Walk;

use crate::places::entry_of;

/// What a node is.
#[derive(Clone, Debug, PartialEq)]
pub enum NodeKind {
    /// The file itself.
    Root,
    /// `#group_begin`, with its own matrix.
    Group(Box<Mat4>),
    /// `#ray_file_instance`, with the file's name.
    Instance(String),
    /// Consecutive shapes of one kind: the first one's number and how many.
    Shapes(u32, u32),
}

/// A node of the tree.
#[derive(Clone, Debug)]
pub struct Node {
    /// What it is.
    pub kind: NodeKind,
    /// Where it stands.
    pub place: Option<Span>,
    /// The number of the node around it.
    pub parent: Option<usize>,
    /// How many nodes are around it.
    pub depth: usize,
    /// Its cumulative transform.
    pub frame: Transform,
    /// The box around all shapes below, in the world.
    pub bounds: Aabb,
    /// How many shapes stand below.
    pub shapes: u64,
}

/// A shape of a run.
#[derive(Clone, Debug, PartialEq)]
pub struct ShapeLine {
    /// Its number in file order.
    pub number: u32,
    /// Its directive without `#shape_`.
    pub kind: &'static str,
    /// `path:line:column`
    pub place: String,
    /// The box around it in the world.
    pub bounds: Aabb,
}

/// The tree.
pub struct Tree<'a> {
    /// The scene.
    pub resolved: &'a Resolved,
    /// Its text.
    pub sources: &'a Sources,
    /// The nodes in file order, each before what stands in it.
    pub nodes: Vec<Node>,
    /// Whether the tree goes on beyond these nodes.
    pub cut: bool,
}

/// Nodes that are held; instances multiply quickly.
const MOST_NODES: usize = 1_000_000;

impl<'a> Tree<'a> {
    /// Walks the scene once.
    pub fn new(resolved: &'a Resolved, sources: &'a Sources) -> Self {
        let mut tree = Self { resolved, sources, nodes: Vec::new(), cut: false };
        let mut open: Vec<usize> = Vec::new();
        tree.begin(&mut open, NodeKind::Root, None, Transform::IDENTITY);
        let mut next_shape = 0;
        for step in Walk::new(&resolved.files, DEFAULT_STEPS) {
            if tree.nodes.len() >= MOST_NODES {
                tree.cut = true;
                break;
            }
            match step {
                Ok(Step::OpenGroup { file, group }) => tree.open_group(&mut open, file, group),
                Ok(Step::OpenInstance { file, include, .. }) => tree.open_instance(&mut open, file, include),
                Ok(Step::CloseGroup | Step::CloseInstance) => tree.end(&mut open),
                Ok(Step::Shapes { count, .. }) => {
                    tree.shapes(&mut open, next_shape, count);
                    next_shape += count;
                }
                Err(_) => {
                    tree.cut = true;
                    break;
                }
            }
        }
        while !open.is_empty() {
            tree.end(&mut open);
        }
        tree
    }

    fn begin(&mut self, open: &mut Vec<usize>, kind: NodeKind, place: Option<Span>, frame: Transform) {
        let (parent, depth) = (open.last().copied(), open.len());
        open.push(self.nodes.len());
        self.nodes.push(Node { kind, place, parent, depth, frame, bounds: Aabb::EMPTY, shapes: 0 });
    }

    /// Closes the last open node and adds its box and its shapes to the one around it.
    fn end(&mut self, open: &mut Vec<usize>) {
        let closed = open.pop().and_then(|index| self.nodes.get(index));
        let Some((bounds, shapes, parent)) = closed.map(|node| (node.bounds, node.shapes, node.parent))
        else {
            return;
        };
        if let Some(parent) = parent.and_then(|parent| self.nodes.get_mut(parent)) {
            parent.bounds = parent.bounds.union(bounds);
            parent.shapes += shapes;
        }
    }

    fn frame_around(&self, open: &[usize]) -> Transform {
        open.last().and_then(|&index| self.nodes.get(index)).map_or(Transform::IDENTITY, |node| node.frame)
    }

    fn file(&self, file: FileId) -> Option<&'a SceneFile> {
        self.resolved.files.get(file.0 as usize)
    }

    fn open_group(&mut self, open: &mut Vec<usize>, file: FileId, group: u32) {
        let placed = self.file(file).and_then(|file| file.groups.get(group as usize));
        let matrix = placed.map_or(Mat4::IDENTITY, |placed| placed.value);
        let around = self.frame_around(open);
        // A resolved scene has no singular matrices.
        let frame = frame::nested(&around, &matrix).unwrap_or(around);
        self.begin(open, NodeKind::Group(Box::new(matrix)), placed.map(|placed| placed.span), frame);
    }

    fn open_instance(&mut self, open: &mut Vec<usize>, file: FileId, include: u32) {
        let placed = self.file(file).and_then(|file| file.includes.get(include as usize));
        let name = placed.map_or(String::new(), |placed| placed.value.name.clone());
        let frame = self.frame_around(open);
        self.begin(open, NodeKind::Instance(name), placed.map(|placed| placed.span), frame);
    }

    fn shapes(&mut self, open: &mut Vec<usize>, first: u32, count: u32) {
        let frame = self.frame_around(open);
        self.begin(open, NodeKind::Shapes(first, count), None, frame);
        let numbers = first..first.saturating_add(count);
        let bounds = numbers.filter_map(|number| self.bounds(number)).fold(Aabb::EMPTY, Aabb::union);
        if let Some(node) = self.nodes.last_mut() {
            (node.bounds, node.shapes) = (bounds, u64::from(count));
        }
        self.end(open);
    }

    fn bounds(&self, number: u32) -> Option<Aabb> {
        let (run, entry) = entry_of(self.resolved, number)?;
        let shape = self.file(run.file)?.shape(run.kind, entry)?;
        let frame = self.resolved.frames.get(run.frame as usize)?;
        Some(shape.world_bounds(frame))
    }

    /// A shape by number.
    pub fn shape(&self, number: u32) -> Option<ShapeLine> {
        let (run, entry) = entry_of(self.resolved, number)?;
        let span = self.file(run.file)?.shape_span(run.file, run.kind, entry);
        Some(ShapeLine {
            number,
            kind: run.kind.directive().trim_start_matches('#').trim_start_matches("shape_"),
            place: span.map_or_else(String::new, |span| self.sources.place(span)),
            bounds: self.bounds(number)?,
        })
    }

    /// Where a node stands.
    pub fn place(&self, node: &Node) -> String {
        node.place.map_or_else(String::new, |span| self.sources.place(span))
    }
}
