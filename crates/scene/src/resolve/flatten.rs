//! The tree as runs of shapes that share a transform.

use super::Limits;
use crate::diagnostic::Diagnostic;
use crate::diagnostic::Sink;
use crate::frame;
use crate::model::Item;
use crate::model::SceneFile;
use crate::model::ShapeKind;
use crate::resolved::Run;
use crate::resolved::RunColors;
use crate::resolved::TreeEvent;
use crate::span::FileId;
use crate::span::Span;
use crate::walk::Step;
use crate::walk::Walk;
use crate::walk::WalkError;
use dotray_geometry::Affine;

/// The parts of the resolved scene that come from the tree.
#[derive(Debug)]
pub struct Flat {
    pub frames: Vec<Affine>,
    pub runs: Vec<Run>,
    pub tree: Vec<TreeEvent>,
    pub shape_count: u32,
}

/// Walks the tree once.
pub fn flatten(files: &[SceneFile], bases: &[u32], limits: &Limits, sink: &mut Sink) -> Flat {
    let written = files.iter().map(|file| file.items.iter().filter(|item| is_run(item)).count() as u64).sum();
    let root = Group { world_from_group: Some(Affine::IDENTITY), frame: Some(0) };
    let flat = Flat { frames: vec![Affine::IDENTITY], runs: Vec::new(), tree: Vec::new(), shape_count: 0 };
    let limits = Limits { runs: limits.runs.max(written), ..*limits };
    let mut flattener = Flattener { files, bases, limits, flat, groups: vec![root], opened: Vec::new() };
    for step in Walk::new(files, limits.steps) {
        let fault = match step {
            Ok(step) => flattener.take(step, sink).map_err(|(what, option)| too_many(&what, option)),
            Err(error) => Err(walk_fault(files, error)),
        };
        if let Err(fault) = fault {
            sink.error(fault);
            break;
        }
    }
    flattener.flat
}

fn is_run(item: &Item) -> bool {
    matches!(item, Item::Run { .. })
}

/// An open group. Its matrix is `None` inside a fault already told.
struct Group {
    world_from_group: Option<Affine>,
    /// The number of its matrix in [`Flat::frames`], once a shape of its own needs one.
    frame: Option<u32>,
}

struct Flattener<'a> {
    files: &'a [SceneFile],
    bases: &'a [u32],
    limits: Limits,
    flat: Flat,
    /// The root and the open groups; an instance shares the group around it.
    groups: Vec<Group>,
    /// The directives of the open groups and instances, for messages.
    opened: Vec<(Span, &'static str)>,
}

impl Flattener<'_> {
    /// The error says what there is too much of.
    fn take(&mut self, step: Step, sink: &mut Sink) -> Result<(), (String, &'static str)> {
        match step {
            Step::OpenGroup { file, group } => {
                self.open_group(file, group, sink);
                self.flat.tree.push(TreeEvent::Open);
            }
            Step::OpenInstance { file, include, .. } => {
                let span = include_span(self.files, file, include);
                self.opened.push((span.unwrap_or_default(), "in an instance of this file"));
                self.flat.tree.push(TreeEvent::Open);
            }
            Step::CloseGroup => {
                self.groups.pop();
                self.opened.pop();
                self.flat.tree.push(TreeEvent::Close);
            }
            Step::CloseInstance => {
                self.opened.pop();
                self.flat.tree.push(TreeEvent::Close);
            }
            Step::Shapes { file, kind, first, count } => self.add_run(file, kind, first, count)?,
        }
        Ok(())
    }

    fn open_group(&mut self, file: FileId, group: u32, sink: &mut Sink) {
        let placed = self.files.get(file.0 as usize).and_then(|file| file.groups.get(group as usize));
        let around = self.groups.last().and_then(|group| group.world_from_group);
        let world_from_group = match (around, placed) {
            (Some(around), Some(placed)) => match frame::nested_in(&around, &placed.value) {
                Ok(transform) => Some(transform.world_from_object),
                Err(_) => {
                    sink.error(self.singular(placed.span));
                    None
                }
            },
            (None, _) | (_, None) => None,
        };
        let identity = world_from_group == Some(Affine::IDENTITY);
        self.groups.push(Group { world_from_group, frame: identity.then_some(0) });
        self.opened.push((placed.map(|placed| placed.span).unwrap_or_default(), "inside this group"));
    }

    fn add_run(
        &mut self,
        file: FileId,
        kind: ShapeKind,
        first: u32,
        count: u32,
    ) -> Result<(), (String, &'static str)> {
        let Some(group) = self.groups.last_mut() else { return Ok(()) };
        let Some(world_from_group) = group.world_from_group else { return Ok(()) };
        if self.flat.runs.len() as u64 >= self.limits.runs {
            return Err((format!("more than {} runs of shapes", self.limits.runs), "--max-groups"));
        }
        let shape_count = u64::from(self.flat.shape_count) + u64::from(count);
        let most = self.limits.shapes.min(u64::from(u32::MAX));
        let Some(shape_count) = u32::try_from(shape_count).ok().filter(|count| u64::from(*count) <= most)
        else {
            return Err((format!("more than {most} shapes"), "--max-shapes"));
        };
        let frames = &mut self.flat.frames;
        let frame = *group.frame.get_or_insert_with(|| {
            frames.push(world_from_group);
            (frames.len() - 1) as u32
        });
        let material_base = self.bases.get(file.0 as usize).copied().unwrap_or(0);
        let first_shape = self.flat.shape_count;
        self.flat.tree.push(TreeEvent::Run(self.flat.runs.len() as u32));
        let colors =
            self.files.get(file.0 as usize).map_or(RunColors::No, |file| run_colors(file, kind, first));
        self.flat.runs.push(Run { file, kind, first, count, frame, material_base, first_shape, colors });
        self.flat.shape_count = shape_count;
        Ok(())
    }

    fn singular(&self, span: Span) -> Diagnostic {
        /// Of a long chain only the ends are shown.
        const INNERMOST: usize = 6;
        let chain = self.opened.iter().rev();
        let mut notes: Vec<_> =
            chain.take(INNERMOST).map(|(span, text)| (Some(*span), (*text).to_owned())).collect();
        if let Some(hidden) = self.opened.len().checked_sub(INNERMOST + 1) {
            if hidden > 0 {
                notes.push((None, format!("and {hidden} more around it")));
            }
            notes.extend(self.opened.first().map(|(span, text)| (Some(*span), (*text).to_owned())));
        }
        let message = if self.opened.is_empty() {
            "the matrix of the group is singular or its inverse is not finite"
        } else {
            "the product of this group's matrix and those around it is singular or not finite"
        };
        let error = Diagnostic::error("singular-product", message);
        let error = error.at(span).label("from here on nothing can be placed");
        Diagnostic { notes, ..error }
            .help("scales this extreme flatten the shapes inside: check the matrices' scales")
    }
}

fn run_colors(file: &SceneFile, kind: ShapeKind, first: u32) -> RunColors {
    match file.colors_from(kind, first) {
        Some((list, first)) => RunColors::Shapes { list, first },
        None if kind == ShapeKind::IndexedTriangle && !file.vertex_colors.is_empty() => RunColors::Vertices,
        None => RunColors::No,
    }
}

fn include_span(files: &[SceneFile], file: FileId, include: u32) -> Option<Span> {
    Some(files.get(file.0 as usize)?.includes.get(include as usize)?.span)
}

fn walk_fault(files: &[SceneFile], fault: WalkError) -> Diagnostic {
    match fault {
        WalkError::Cycle { file, include } => {
            let span = include_span(files, file, include).unwrap_or_default();
            let error = Diagnostic::error("include-cycle", "the file includes itself");
            error.at(span).label("leads back to a file around it")
        }
        WalkError::TooLong(limit) => {
            too_many(&format!("more than {limit} groups, instances and runs of shapes"), "--max-groups")
        }
        WalkError::Broken { file, .. } => {
            Diagnostic::error("broken-scene", fault.to_string()).at(Span { file, start: 0, end: 0 })
        }
    }
}

fn too_many(what: &str, option: &str) -> Diagnostic {
    let error = Diagnostic::error("too-many-shapes", format!("the scene's instances multiply to {what}"));
    error.help(format!("`{option} N` allows more"))
}
