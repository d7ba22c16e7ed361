//! Groups and their matrices.

use super::Parser;
use crate::diagnostic::Diagnostic;
use crate::model::Item;
use crate::model::Placed;
use dotray_geometry::Affine;
use dotray_geometry::Mat3;
use dotray_geometry::Mat4;
use dotray_geometry::Transform;
use dotray_geometry::Vec3;

/// A matrix row by row, as written.
pub(super) type Rows = [f64; 16];

const LAST_ROW: [f64; 4] = [0.0, 0.0, 0.0, 1.0];
const ORDINAL: [&str; 4] = ["first", "second", "third", "last"];

impl Parser<'_> {
    pub(super) fn group_begin(&mut self) {
        if self.call.count == 0 {
            // `hmc`: the directives that follow say where the group stands.
            return self.open_group(Placed { value: Mat4::IDENTITY, span: self.call_span() });
        }
        let rows = self.rows();
        if let Some(fault) = fault_of(&rows) {
            self.wrong_matrix(&rows, fault);
        }
        let span = self.call_span();
        self.open_group(Placed { value: Mat4::from_cols_array(&rows).transpose(), span });
    }

    pub(super) fn open_group(&mut self, matrix: Placed<Mat4>) {
        if self.open.len() == self.limits.max_nesting {
            let message = format!("groups are nested more than {} deep", self.limits.max_nesting);
            let error = Diagnostic::error("nesting-limit", message).at(matrix.span);
            self.sink.error(error.label("the first one too deep").help("`--max-nesting N` allows more"));
            self.stopped = true;
            return;
        }
        // A directive takes more than one byte and a file at most 2^32 of them.
        let number = self.scene.groups.len() as u32;
        self.scene.groups.push(matrix);
        self.open.push(number);
        self.push_item(Item::Open(number));
    }

    pub(super) fn group_end(&mut self) {
        if self.open.pop().is_some() {
            return self.push_item(Item::Close);
        }
        let span = self.call_span();
        let error = Diagnostic::error("stray-group-end", "`#group_end` without an open group");
        self.sink.error(error.at(span).label("no `#group_begin` belongs to it"));
    }

    pub(super) fn rows(&self) -> Rows {
        let mut rows = [0.0; 16];
        for (row, value) in rows.iter_mut().zip(&self.values) {
            *row = *value;
        }
        rows
    }

    #[cold]
    fn wrong_matrix(&mut self, rows: &Rows, fault: Fault) {
        let (row, label) = match fault {
            Fault::LastRow => (3, "must be `0 0 0 1`"),
            Fault::Singular(row @ (0..=2)) if is_zero(rows, row) => {
                (row, "a row of zeros flattens everything")
            }
            Fault::Singular(row) => (row, "adds nothing to the rows above it"),
        };
        let written: Vec<String> = (0..4).map(|column| plain(&self.written(4 * row + column))).collect();
        let ordinal = ORDINAL.get(row).copied().unwrap_or_default();
        let message = match fault {
            Fault::LastRow => {
                format!("the last row of the group's matrix is `{}`, not `0 0 0 1`", written.join(" "))
            }
            Fault::Singular(_) => {
                format!("the group's matrix is singular: its {ordinal} row is `{}`", written.join(" "))
            }
        };
        let error =
            Diagnostic::error("group-matrix", message).at(self.arguments_span(4 * row, 4)).label(label);
        self.sink.error(match repair(rows) {
            Some(help) => error.help(help),
            None => error.note("the matrix stands row by row and acts on columns"),
        });
    }
}

fn plain(shown: &str) -> String {
    shown.trim_matches('`').to_owned()
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Fault {
    LastRow,
    /// The row that makes it so.
    Singular(usize),
}

fn row3(rows: &Rows, row: usize) -> Vec3 {
    let mut numbers = rows.iter().skip(4 * row).copied();
    let mut next = || numbers.next().unwrap_or(0.0);
    Vec3::new(next(), next(), next())
}

fn is_zero(rows: &Rows, row: usize) -> bool {
    row3(rows, row) == Vec3::ZERO
}

pub(super) fn fault_of(rows: &Rows) -> Option<Fault> {
    if !rows.ends_with(&LAST_ROW) {
        return Some(Fault::LastRow);
    }
    let affine = Affine::from_mat4(Mat4::from_cols_array(rows).transpose());
    Transform::new(affine).is_err().then(|| Fault::Singular(dependent_row(rows)))
}

/// The first row that the rows above it make superfluous.
fn dependent_row(rows: &Rows) -> usize {
    let (first, second) = (row3(rows, 0), row3(rows, 1));
    let unit = |row: Vec3| row.normalize_or_zero();
    if is_zero(rows, 0) {
        0
    } else if is_zero(rows, 1) {
        1
    } else if is_zero(rows, 2) || unit(first).cross(unit(second)).length() > 1e-7 {
        2
    } else {
        1
    }
}

/// What was probably meant: the transposed matrix, or one in which a single number stands at another place. Only
/// matrices that merely shift and scale along the axes are thought likely; nearer moves go first.
fn repair(rows: &Rows) -> Option<String> {
    let transposed = Mat4::from_cols_array(rows).transpose().to_cols_array();
    if fault_of(&transposed).is_none() && rows.iter().skip(3).step_by(4).take(3).all(|&shift| shift == 0.0) {
        return Some(format!(
            "the matrix must stand row by row, with the shift at the ends of the rows: `{}`",
            list(&transposed)
        ));
    }
    let mut best: Option<(u32, usize, usize, Rows)> = None;
    for from in 0..16 {
        for to in (0..16).filter(|&to| to != from) {
            let Some(moved) = moved(rows, from, to) else { continue };
            let Some(unlikely) = unlikeliness(&moved) else { continue };
            let distance = u32::try_from(from.abs_diff(to)).unwrap_or(u32::MAX);
            // Where a zero and another number changed places, people see the zero as the one that slipped.
            let is_zero = rows.get(from) == Some(&0.0);
            let cost = (unlikely + distance) * 2 + u32::from(!is_zero);
            if best.is_none_or(|(least, ..)| cost < least) {
                best = Some((cost, from, to, moved));
            }
        }
    }
    let (_, from, to, moved) = best?;
    let number = rows.get(from)?;
    let slip = format!("the {number} in place {} of the 16 belongs in place {}", from + 1, to + 1);
    Some(format!("`{}` was probably meant: {slip}", list(&moved)))
}

/// The numbers with the one at `from` taken out and put in again so that it stands at `to`.
fn moved(rows: &Rows, from: usize, to: usize) -> Option<Rows> {
    let mut moved = *rows;
    if from < to {
        moved.get_mut(from..=to)?.rotate_left(1);
    } else {
        moved.get_mut(to..=from)?.rotate_right(1);
    }
    Some(moved)
}

/// 0 for a shift, more for a scaling; `None` for what nobody would have meant.
fn unlikeliness(rows: &Rows) -> Option<u32> {
    if fault_of(rows).is_some() {
        return None;
    }
    let (x, y, z) = (row3(rows, 0), row3(rows, 1), row3(rows, 2));
    let rotation = Mat3::from_cols(x, y, z);
    if rotation == Mat3::IDENTITY {
        return Some(0);
    }
    let diagonal = Mat3::from_diagonal(Vec3::new(x.x, y.y, z.z));
    (rotation == diagonal).then_some(16)
}

fn list(rows: &Rows) -> String {
    let lines = rows.chunks(4).map(|row| row.iter().map(f64::to_string).collect::<Vec<_>>().join(" "));
    lines.collect::<Vec<_>>().join("  ")
}

#[cfg(test)]
#[allow(clippy::unwrap_used, clippy::indexing_slicing)]
mod tests {
    use super::*;

    #[test]
    fn slipped_numbers_are_found() {
        let cases: [(Rows, &str); 4] = [
            (
                [1., 0., 0., -3., 0., 1., 0., 0., 0., 0., 0., 1., 0., 0., 0., 1.],
                "`1 0 0 -3  0 1 0 0  0 0 1 0  0 0 0 1` was",
            ),
            (
                [1., 0., 0., 0., 0., 1., 0., 3., 0., 0., 0., 1., 0., 0., 0., 1.],
                "`1 0 0 0  0 1 0 3  0 0 1 0  0 0 0 1` was",
            ),
            (
                [1., 0., 0., 0., 0., 1., 0., 0., 0., 0., 1., 0., 0., 0., 1., 0.],
                "`1 0 0 0  0 1 0 0  0 0 1 0  0 0 0 1` was",
            ),
            (
                [1., 0., 0., 0., 0., 1., 0., 0., 0., 0., 1., 0., 5., 6., 7., 1.],
                "the matrix must stand row by row",
            ),
        ];
        for (rows, start) in cases {
            let help = repair(&rows).unwrap();
            assert!(help.starts_with(start), "{help}");
        }
        assert_eq!(repair(&[1.0; 16]), None);
    }

    #[test]
    fn the_row_that_is_superfluous_is_named() {
        let matrix = |x: [f64; 3], y: [f64; 3], z: [f64; 3]| {
            let mut rows = [0.0; 16];
            rows[..3].copy_from_slice(&x);
            rows[4..7].copy_from_slice(&y);
            rows[8..11].copy_from_slice(&z);
            rows[15] = 1.0;
            rows
        };
        let cases = [
            (matrix([0., 0., 0.], [0., 1., 0.], [0., 0., 1.]), 0),
            (matrix([1., 2., 3.], [2., 4., 6.], [0., 0., 1.]), 1),
            (matrix([1., 2., 3.], [2., 4., 7.], [3., 6., 10.]), 2),
            (matrix([1., 0., 0.], [0., 1., 0.], [0., 0., 0.]), 2),
        ];
        for (rows, row) in cases {
            assert_eq!(fault_of(&rows), Some(Fault::Singular(row)), "{rows:?}");
        }
        assert_eq!(fault_of(&matrix([1., 0., 0.], [0., 1., 0.], [0., 0., 1e-9])), None);
    }
}
