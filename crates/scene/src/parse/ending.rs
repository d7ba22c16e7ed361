//! What can be judged only at the end of the file: numbers that name something, hints, groups left open.

use super::Hint;
use super::Parser;
use super::arguments::arguments_span;
use super::shapes::left_out;
use crate::diagnostic::Diagnostic;
use crate::diagnostic::Sink;
use crate::dialect::Dialect;
use crate::directive;
use crate::directive::Directive;
use crate::lex::Lexer;
use crate::lex::TokenKind;
use crate::model::Item;
use crate::model::Placed;
use crate::model::ShapeKind;
use crate::model::ShapeList;
use crate::model::Vertex;
use crate::span::FileId;
use crate::span::PackedStarts;
use crate::span::Span;
use dotray_geometry::ShapeError;
use dotray_geometry::Triangle;

impl Parser<'_> {
    pub(super) fn finish(&mut self) {
        self.finish_affines();
        self.unclosed_groups();
        self.finish_names();
        self.finish_vertex_colors();
        self.check_hints();
        self.check_textures();
        self.check_materials();
        self.check_instances();
        self.check_vertices();
        self.drop_flat_triangles();
    }

    fn unclosed_groups(&mut self) {
        const NOTES: usize = 3;
        const WORD: u64 = "#group_begin".len() as u64;
        let message = match self.open.len() {
            0 => return,
            1 => "a group is never closed".to_owned(),
            depth => format!("{depth} groups are never closed"),
        };
        let mut begins = self.open.iter().rev().filter_map(|&number| {
            let span = self.scene.groups.get(number as usize)?.span;
            Some(Span { end: span.start + WORD, ..span })
        });
        let mut error =
            Diagnostic::error("unclosed-group", message).help("close each group with `#group_end`");
        if let Some(innermost) = begins.next() {
            error = error.at(innermost).label("opened here");
        }
        for begin in begins.take(NOTES) {
            error = error.note_at(begin, "opened here");
        }
        self.sink.error(error);
    }

    fn check_hints(&mut self) {
        let kinds = [
            (Directive::LightNum, self.seen.lights, "light", "lights"),
            (Directive::TextureNum, self.seen.textures, "texture", "textures"),
            (Directive::MaterialNum, self.seen.materials, "material", "materials"),
            (Directive::VertexNum, self.seen.vertices, "vertex", "vertices"),
            (Directive::RayFileNum, self.seen.includes, "included file", "included files"),
        ];
        for (kind, found, one, many) in kinds {
            let mut hints = self.hints.iter().filter(|hint| hint.directive == kind).peekable();
            let Some(&&Hint { span, .. }) = hints.peek() else { continue };
            // Files put together from parts have one hint a part.
            let hinted: f64 = hints.map(|hint| hint.count).sum();
            if hinted == found as f64 {
                continue;
            }
            let span = arguments_span(self.bytes, span, 0, 1);
            let (word, whats) = (directive::spec(kind).word, if found == 1 { one } else { many });
            self.sink.warn("count-hint", || {
                let message = format!("`{word}` announces {hinted}, but the file has {found} {whats}");
                Diagnostic::warning("count-hint", message)
                    .at(span)
                    .label(format!("the {found} of the file count"))
                    .help(format!("`{word} {found}` says what the file has"))
            });
        }
    }

    fn check_textures(&mut self) {
        let found = self.seen.textures;
        let place = match self.dialect {
            Dialect::Uva | Dialect::Jhu => 17,
            Dialect::Slides | Dialect::Hmc | Dialect::Unisa => 15,
        };
        for material in &self.scene.materials {
            if material.value.texture.is_some_and(|number| number as usize >= found) {
                let span = arguments_span(self.bytes, material.span, place, 1);
                let number = material.value.texture.unwrap_or_default();
                self.sink.error(declared(
                    names_nothing("unknown-texture", "texture", number, found).at(span),
                    self.scene.textures.last(),
                ));
            }
        }
    }

    fn check_materials(&mut self) {
        let found = self.seen.materials;
        let check = MaterialCheck {
            bytes: self.bytes,
            file: self.file,
            found,
            last: self.scene.materials.last().map(|placed| placed.span),
        };
        let scene = &self.scene;
        let sink = &mut *self.sink;
        check.list(&scene.spheres, sink);
        check.list(&scene.cuboids, sink);
        check.list(&scene.cylinders, sink);
        check.list(&scene.cones, sink);
        check.list(&scene.triangles, sink);
        check.list(&scene.indexed_triangles, sink);
        check.list(&scene.tori, sink);
        check.list(&scene.open_sides, sink);
    }

    fn check_instances(&mut self) {
        let found = self.seen.includes;
        for &(number, span) in &self.instances {
            if number as usize >= found {
                let error = names_nothing("unknown-include", "included file", number, found).at(span);
                self.sink.error(declared(error, self.scene.includes.last()));
            }
        }
    }

    fn check_vertices(&mut self) {
        let found = self.seen.vertices;
        let list = &self.scene.indexed_triangles;
        for (entry, corners) in list.shapes.iter().enumerate() {
            if self.sink.is_full() {
                return;
            }
            for (place, &corner) in (1..).zip(corners) {
                if corner as usize >= found {
                    let start = list.starts.get(entry).unwrap_or(0);
                    let place =
                        place - usize::from(self.dialect == Dialect::Jhu && is_listed(self.bytes, start));
                    let span = argument_of_shape(self.bytes, self.file, &list.starts, entry, place);
                    self.sink.error(names_nothing("unknown-vertex", "vertex", corner, found).at(span));
                }
            }
        }
    }

    fn drop_flat_triangles(&mut self) {
        let vertices = &self.scene.vertices;
        let flat = |corners: &[u32; 3]| has_no_area(vertices, corners);
        let list = &self.scene.indexed_triangles;
        if self.sink.errors() > 0 || !list.shapes.iter().any(flat) {
            return;
        }
        let mut kept = ShapeList::default();
        // How many stay of those before each run's first.
        let mut stays = Vec::new();
        for (entry, (corners, material)) in list.shapes.iter().zip(&list.materials).enumerate() {
            stays.push(kept.shapes.len() as u32);
            let start = list.starts.get(entry).unwrap_or(0);
            if flat(corners) {
                let (bytes, file) = (self.bytes, self.file);
                self.sink.warn("degenerate-shape", || {
                    let span = shape_span(bytes, file, start);
                    left_out("#shape_triangle", ShapeError::Area).at(span).label("is left out")
                });
            } else {
                kept.shapes.push(*corners);
                kept.materials.push(*material);
                kept.starts.push(start);
            }
        }
        stays.push(kept.shapes.len() as u32);
        self.scene.indexed_triangles = kept;
        renumber(&mut self.scene.items, &stays);
    }
}

fn has_no_area(vertices: &[Vertex], corners: &[u32; 3]) -> bool {
    let corner = |number: u32| vertices.get(number as usize);
    let &[i, j, k] = corners;
    let (Some(a), Some(b), Some(c)) = (corner(i), corner(j), corner(k)) else { return false };
    Triangle::new(
        [a.position, b.position, c.position],
        [a.normal, b.normal, c.normal],
        [a.texcoord, b.texcoord, c.texcoord],
    )
    .is_err()
}

/// Runs of indexed triangles after some were left out: `stays[n]` is the new number of entry n. Empty runs go, and runs
/// that then touch stay apart, which is as good.
fn renumber(items: &mut Vec<Item>, stays: &[u32]) {
    let stay = |entry: u32| stays.get(entry as usize).copied().unwrap_or(0);
    items.retain_mut(|item| match item {
        Item::Run { kind: ShapeKind::IndexedTriangle, first, count } => {
            let end = stay(*first + *count);
            *first = stay(*first);
            *count = end - *first;
            *count > 0
        }
        Item::Run { .. } | Item::Open(_) | Item::Close | Item::Instance(_) => true,
    });
}

struct MaterialCheck<'a> {
    bytes: &'a [u8],
    file: FileId,
    found: usize,
    last: Option<Span>,
}

impl MaterialCheck<'_> {
    fn list<T>(&self, list: &ShapeList<T>, sink: &mut Sink) {
        let unknown = list
            .materials
            .iter()
            .enumerate()
            .filter(|&(_, &number)| number >= 0 && number as usize >= self.found);
        for (entry, &number) in unknown {
            if sink.is_full() {
                return;
            }
            let span = argument_of_shape(self.bytes, self.file, &list.starts, entry, 0);
            let error = names_nothing("unknown-material", "material", number as u32, self.found).at(span);
            sink.error(match self.last {
                Some(last) => error.note_at(last, "the last one is declared here"),
                None => error,
            });
        }
    }
}

fn names_nothing(code: &'static str, what: &str, number: u32, found: usize) -> Diagnostic {
    let label = match found {
        0 => format!("the file has no {what}"),
        1 => format!("the file has one {what}, number 0"),
        _ => format!("the file has {found}, numbered 0 to {}", found - 1),
    };
    Diagnostic::error(code, format!("{what} {number} does not exist")).label(label)
}

/// Whether the triangle at `start` has three arguments, its material being its list's.
fn is_listed(bytes: &[u8], start: u64) -> bool {
    let mut lexer = Lexer::from(bytes, usize::try_from(start).unwrap_or(usize::MAX));
    let words = std::iter::from_fn(|| lexer.token().ok().flatten());
    words.skip(1).take_while(|token| token.kind == TokenKind::Word).take(4).count() == 3
}

/// Says where the list ends that a number goes beyond.
fn declared<T>(error: Diagnostic, last: Option<&Placed<T>>) -> Diagnostic {
    match last {
        Some(last) => error.note_at(last.span, "the last one is declared here"),
        None => error,
    }
}

fn shape_span(bytes: &[u8], file: FileId, start: u64) -> Span {
    let call = Span { file, start, end: start };
    Span { start, ..arguments_span(bytes, call, 0, 4) }
}

fn argument_of_shape(bytes: &[u8], file: FileId, starts: &PackedStarts, entry: usize, place: usize) -> Span {
    let start = starts.get(entry).unwrap_or(0);
    arguments_span(bytes, Span { file, start, end: start }, place, 1)
}
