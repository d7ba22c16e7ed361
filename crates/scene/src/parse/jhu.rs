//! What the dialect `jhu` has besides: matrices for the one shape that follows, lists, tori.

use super::Parser;
use super::arguments;
use super::group::fault_of;
use crate::diagnostic::Diagnostic;
use crate::dialect::Dialect;
use crate::directive::Directive;
use crate::model::Placed;
use crate::model::ShapeKind;
use crate::span::Span;
use dotray_geometry::Mat4;
use dotray_geometry::Torus;
use dotray_geometry::Vec3;

/// Matrices that wait for their shape, and open lists.
#[derive(Default)]
pub(super) struct Affines {
    /// How many matrices stand before the shape that comes next.
    waiting: usize,
    lists: Vec<List>,
    /// The material of the triangles in the list that comes next.
    triangles: Option<i32>,
}

struct List {
    /// How many matrices stand before it.
    waiting: usize,
    /// The material of its triangles.
    triangles: Option<i32>,
    span: Span,
}

/// What completes the shape that a matrix waits for.
const SHAPES: [Directive; 8] = [
    Directive::ShapeSphere,
    Directive::ShapeBox,
    Directive::ShapeCylinder,
    Directive::ShapeCone,
    Directive::ShapeTriangle,
    Directive::ShapeTorus,
    Directive::RayFileInstance,
    Directive::ListEnd,
];

impl Parser<'_> {
    pub(super) fn static_affine(&mut self) {
        if self.call.count == 1 {
            self.ignored("`#dynamic_affine` has no effect: its shape stays where it is");
            return self.open_affine(Mat4::IDENTITY);
        }
        let columns = self.rows();
        let matrix = Mat4::from_cols_array(&columns);
        if fault_of(&matrix.transpose().to_cols_array()).is_some() {
            let message = "the matrix of `#static_affine` is singular, or its last row is not `0 0 0 1`";
            let error = Diagnostic::error("group-matrix", message).at(self.call_span());
            self.sink.error(error.note("it stands column by column, with the shift in places 13 to 15"));
        }
        self.open_affine(matrix);
    }

    pub(super) fn open_affine(&mut self, value: Mat4) {
        self.affine.waiting += 1;
        let span = self.call_span();
        self.open_group(Placed { value, span });
    }

    pub(super) fn list_begin(&mut self) {
        let Affines { waiting, triangles, .. } = self.affine;
        let span = self.call_span();
        self.affine.lists.push(List { waiting, triangles, span });
        (self.affine.waiting, self.affine.triangles) = (0, None);
    }

    pub(super) fn list_end(&mut self) {
        self.lonely_affines();
        match self.affine.lists.pop() {
            Some(list) => self.affine.waiting = list.waiting,
            None => {
                let error = Diagnostic::error("stray-group-end", "`#shape_list_end` without an open list");
                let span = self.call_span();
                self.sink.error(error.at(span).label("no `#shape_list_begin` belongs to it"));
            }
        }
    }

    pub(super) fn triangles(&mut self) {
        let Some(number) = self.whole(0) else { return };
        match i32::try_from(number) {
            Ok(number) if number >= 0 => self.affine.triangles = Some(number),
            Ok(_) | Err(_) => self.unknown(0, "unknown-material", "material", "materials"),
        }
    }

    /// A triangle whose material is its list's.
    pub(super) fn listed_triangle(&mut self) {
        let of_list = self.affine.lists.last().and_then(|list| list.triangles);
        let Some(material) = self.affine.triangles.or(of_list) else {
            let span = self.call_span();
            let message = "a triangle of three numbers takes its material from `#shape_triangles`";
            let error = Diagnostic::error("unknown-material", message).at(span);
            self.sink.error(error.label("no `#shape_triangles` stands before its list"));
            return;
        };
        self.take_material(material);
        self.call.skip = -1;
        self.indexed_triangle();
    }

    /// Puts a material's number before the values.
    pub(super) fn take_material(&mut self, material: i32) {
        self.values.rotate_right(1);
        if let Some(first) = self.values.first_mut() {
            *first = f64::from(material);
        }
    }

    pub(super) fn torus(&mut self) {
        let &[_, cx, cy, cz, inner, outer, ..] = &self.values;
        let shape = Torus::new(Vec3::new(cx, cy, cz), inner, outer);
        self.shape(shape, ShapeKind::Torus, |scene| &mut scene.tori);
    }

    /// After a directive: a shape closes the groups of the matrices that stood before it.
    pub(super) fn done_in_jhu(&mut self, directive: Directive) {
        if self.dialect != Dialect::Jhu {
            return;
        }
        let is_shape = SHAPES.contains(&directive);
        if directive != Directive::Triangles && directive != Directive::ShapeTriangle {
            self.affine.triangles = None;
        }
        if is_shape {
            self.close_affines();
        }
    }

    fn close_affines(&mut self) {
        for _ in 0..std::mem::take(&mut self.affine.waiting) {
            self.group_end();
        }
    }

    /// At the end of the file.
    pub(super) fn finish_affines(&mut self) {
        self.lonely_affines();
        for list in std::mem::take(&mut self.affine.lists).into_iter().rev() {
            let error = Diagnostic::error("unclosed-group", "a list of shapes is never closed");
            let error = error.at(list.span).label("opened here");
            self.sink.error(error.help("close it with `#shape_list_end`"));
            self.affine.waiting = list.waiting;
            self.close_affines();
        }
    }

    fn lonely_affines(&mut self) {
        if self.affine.waiting == 0 {
            return;
        }
        let matrix = self.open.last().and_then(|number| self.scene.groups.get(*number as usize));
        let span = matrix.map(|matrix| matrix.span).unwrap_or_default();
        let error = Diagnostic::error("lone-affine", "no shape follows `#static_affine`");
        self.sink.error(error.at(span).label("transforms the one shape that follows"));
        self.close_affines();
    }

    /// A directive of constructive solid geometry.
    pub(super) fn solid_geometry(&mut self, word: &[u8], span: Span) {
        self.recognized = true;
        let shown = arguments::shown(word);
        let message = format!("{shown} is not supported: dotray has no constructive solid geometry");
        self.sink.error(Diagnostic::error("unsupported-directive", message).at(span));
        self.skip_arguments();
    }
}
