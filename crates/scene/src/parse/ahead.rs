//! Reading long rows of shapes and vertices on several threads.
//!
//! A large file is nearly always a row of millions of shapes or vertices. Pieces of it, cut in front of directives, are
//! read side by side, each as if it stood alone, and taken over one after the other as long as each is above doubt:
//! it begins exactly where the one before it ended (so no comment or text reaches across the cut), holds nothing but
//! shapes and vertices, and gave no reason for any message. The first piece that does not is read again the usual way,
//! so that scene and messages are those of one thread, byte for byte.

use super::Parser;
use super::Seen;
use crate::diagnostic::Sink;
use crate::dialect::Dialect;
use crate::directive;
use crate::directive::Directive;
use crate::model::Item;
use crate::model::SceneFile;
use crate::model::ShapeList;
use crate::span::Span;
use rayon::prelude::*;
use std::ops::Range;
use std::path::PathBuf;

/// The bytes of a piece: enough to be worth a thread's while, few enough that little is read twice.
const PIECE: usize = 1 << 20;

/// Pieces for each thread in one go.
const PIECES_A_THREAD: usize = 4;

/// So many shapes and vertices in a row promise more of them.
const PROMISING: u32 = 256;

/// When it is worth while to read on several threads.
pub(super) struct Ahead {
    threads: usize,
    /// How many shapes and vertices stood in a row before the place at hand.
    row: u32,
    /// How many have to: twice as many after each try that came to an early end.
    needed: u32,
}

impl Ahead {
    /// For so many threads; one reads nothing ahead.
    pub(super) fn new(threads: usize, dialect: Dialect) -> Self {
        let suits = match dialect {
            Dialect::Slides | Dialect::Uva | Dialect::Unisa => true,
            // Their shapes stand in lists and need what came before.
            Dialect::Jhu | Dialect::Hmc => false,
        };
        Self { threads, row: 0, needed: if threads > 1 && suits { PROMISING } else { u32::MAX } }
    }

    /// Counts a directive.
    #[inline]
    pub(super) fn count(&mut self, directive: Directive) {
        self.row = if suits(directive) { self.row.saturating_add(1) } else { 0 };
    }
}

/// What was read of a piece.
struct Piece {
    scene: SceneFile,
    shape_count: u32,
    vertices: usize,
    colored_vertex: Option<Span>,
    end: usize,
}

impl Parser<'_> {
    /// Takes over what several threads read from here on; true where that is anything.
    #[inline]
    pub(super) fn read_ahead(&mut self) -> bool {
        let start = self.lexer.at();
        self.ahead.row >= self.ahead.needed && self.bytes.len() - start > 2 * PIECE && self.read_pieces(start)
    }

    #[cold]
    fn read_pieces(&mut self, start: usize) -> bool {
        let ranges = cuts(self.bytes, start, self.ahead.threads * PIECES_A_THREAD);
        let read: Vec<Option<Piece>> = ranges.par_iter().map(|range| self.piece(range)).collect();
        for (range, piece) in ranges.iter().zip(read) {
            let Some(piece) = piece.filter(|_| range.start == self.lexer.at()) else { break };
            if piece.shape_count > self.limits.max_shapes - self.shape_count {
                break;
            }
            self.take_over(piece);
        }
        if ranges.last().is_some_and(|range| range.end > self.lexer.at()) {
            self.ahead.row = 0;
            self.ahead.needed = self.ahead.needed.saturating_mul(2);
        }
        self.lexer.at() > start
    }

    /// Reads a piece by itself, up to the first directive that is neither shape nor vertex; `None` where there would
    /// be anything to say.
    fn piece(&self, range: &Range<usize>) -> Option<Piece> {
        let mut sink = Sink::new(1, 1);
        let mut parser =
            Parser::new(PathBuf::new(), self.bytes, self.file, self.dialect, self.limits, &mut sink);
        parser.lexer.go_to(range.start);
        parser.shapes_until(range.end);
        let Parser { scene, shape_count, lexer, seen, sink, .. } = parser;
        let Seen { vertices, colored_vertex, .. } = seen;
        sink.is_silent().then(|| Piece { scene, shape_count, vertices, colored_vertex, end: lexer.at() })
    }

    fn shapes_until(&mut self, end: usize) {
        while self.lexer.skip_blank().is_ok() && self.lexer.at() < end && self.lexer.peek() == Some(b'#') {
            let start = self.lexer.at();
            let after_word = self.lexer.word_end();
            let word = self.bytes.get(start..after_word).unwrap_or_default();
            let Some(spec) = directive::find_in(self.dialect, word).filter(|spec| suits(spec.directive))
            else {
                return;
            };
            self.lexer.go_to(after_word);
            self.arguments(spec, start);
            if !self.sink.is_silent() {
                return;
            }
        }
    }

    fn take_over(&mut self, piece: Piece) {
        let Piece { scene, shape_count, vertices, colored_vertex, end } = piece;
        self.seen.colored_vertex = self.seen.colored_vertex.or(colored_vertex);
        for item in scene.items {
            if let Item::Run { kind, first, count } = item {
                match self.scene.items.last_mut() {
                    Some(Item::Run { kind: last, count: so_far, .. }) if *last == kind => *so_far += count,
                    Some(Item::Run { .. } | Item::Open(_) | Item::Close | Item::Instance(_)) | None => {
                        let before = self.scene.shape_materials(kind).len() as u32;
                        self.push_item(Item::Run { kind, first: before + first, count });
                    }
                }
            }
        }
        append(&mut self.scene.spheres, scene.spheres);
        append(&mut self.scene.cuboids, scene.cuboids);
        append(&mut self.scene.cylinders, scene.cylinders);
        append(&mut self.scene.cones, scene.cones);
        append(&mut self.scene.triangles, scene.triangles);
        append(&mut self.scene.indexed_triangles, scene.indexed_triangles);
        if !scene.vertex_colors.is_empty() {
            self.scene.vertex_colors.resize(self.scene.vertices.len(), None);
            self.scene.vertex_colors.extend(scene.vertex_colors);
        }
        self.scene.vertices.extend(scene.vertices);
        self.shape_count += shape_count;
        self.seen.vertices += vertices;
        self.recognized = true;
        self.lexer.go_to(end);
    }
}

/// What a piece may hold.
fn suits(directive: Directive) -> bool {
    matches!(
        directive,
        Directive::ShapeSphere
            | Directive::ShapeBox
            | Directive::ShapeCylinder
            | Directive::ShapeCone
            | Directive::ShapeTriangle
            | Directive::Vertex
    )
}

/// Up to `count` pieces from `start` on, each beginning with the `#` of a line.
fn cuts(bytes: &[u8], start: usize, count: usize) -> Vec<Range<usize>> {
    let mut ranges = Vec::with_capacity(count);
    let mut begin = start;
    while ranges.len() < count && begin < bytes.len() {
        let rest = bytes.get(begin + PIECE..).unwrap_or_default();
        let cut = rest.windows(2).position(|two| two == b"\n#");
        let end = cut.map_or(bytes.len(), |cut| begin + PIECE + cut + 1);
        ranges.push(begin..end);
        begin = end;
    }
    ranges
}

/// Appends a piece's shapes.
fn append<T>(list: &mut ShapeList<T>, mut piece: ShapeList<T>) {
    list.shapes.append(&mut piece.shapes);
    list.materials.append(&mut piece.materials);
    list.starts.extend(&piece.starts);
}
