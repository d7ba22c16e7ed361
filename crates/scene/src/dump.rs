//! The scene's tree as text: one line a node or shape, indented by depth, in file order.

use crate::frame;
use crate::model::SceneFile;
use crate::model::ShapeKind;
use crate::number::General;
use crate::span::FileId;
use crate::walk::DEFAULT_STEPS;
use crate::walk::Step;
use crate::walk::Walk;
use dotray_geometry::Affine;
use dotray_geometry::Mat4;
use dotray_geometry::OpenSide;
use dotray_geometry::Shape;
use dotray_geometry::Transform;
use dotray_geometry::Triangle;
use dotray_geometry::Vec3;
use std::fmt;
use std::io;

/// What else to print.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct DumpOptions {
    /// Each node's cumulative matrices, from object to world and back.
    pub world: bool,
}

/// Prints the tree of file 0 with its instances expanded. The files may be those of a [`crate::model::Scene`] or
/// of a [`crate::resolved::Resolved`].
///
/// # Errors
/// Those of `out`.
pub fn dump(files: &[SceneFile], options: DumpOptions, out: &mut impl io::Write) -> io::Result<()> {
    dump_within(files, options, DEFAULT_STEPS, out)
}

fn dump_within(
    files: &[SceneFile],
    options: DumpOptions,
    most_steps: u64,
    out: &mut impl io::Write,
) -> io::Result<()> {
    let mut dumper = Dumper { files, options, out, depth: 0, frames: Vec::new() };
    dumper.node(&Mat4::IDENTITY)?;
    let mut shapes_left = MOST_SHAPES.max(written_shapes(files));
    for step in Walk::new(files, most_steps) {
        match step {
            Ok(Step::OpenGroup { file, group }) => {
                let matrix = files.get(file.0 as usize).and_then(|file| file.groups.get(group as usize));
                dumper.node(&matrix.map_or(Mat4::IDENTITY, |placed| placed.value))?;
            }
            Ok(Step::OpenInstance { file, include, .. }) => dumper.instance(file, include)?,
            Ok(Step::CloseGroup) => {
                dumper.frames.pop();
                dumper.depth -= 1;
            }
            Ok(Step::CloseInstance) => dumper.depth -= 1,
            Ok(Step::Shapes { file, kind, first, count }) => {
                let Some(left) = shapes_left.checked_sub(u64::from(count)) else {
                    return writeln!(dumper.out, "(the tree goes on: its instances multiply too often)");
                };
                shapes_left = left;
                dumper.shapes(file, kind, first, count)?;
            }
            Err(fault) => return writeln!(dumper.out, "(the tree goes on: {fault})"),
        }
    }
    Ok(())
}

/// Instances multiply to at most so many lines of shapes.
const MOST_SHAPES: u64 = 1 << 31;

fn written_shapes(files: &[SceneFile]) -> u64 {
    let kinds =
        |file: &SceneFile| ShapeKind::ALL.map(|kind| file.shape_count(kind) as u64).iter().sum::<u64>();
    files.iter().map(kinds).sum()
}

struct Dumper<'a, W> {
    files: &'a [SceneFile],
    options: DumpOptions,
    out: &'a mut W,
    /// Of the next line.
    depth: usize,
    /// The cumulative transforms of the open nodes; `None` in and below a singular one.
    frames: Vec<Option<Transform>>,
}

impl<W: io::Write> Dumper<'_, W> {
    fn node(&mut self, matrix: &Mat4) -> io::Result<()> {
        let parent = if self.frames.is_empty() {
            Some(Transform::IDENTITY)
        } else {
            self.frames.last().copied().flatten()
        };
        let frame = parent.and_then(|parent| frame::nested(&parent, matrix).ok());
        writeln!(self.out, "{}NODE: {}", Indent(self.depth), Matrix(*matrix))?;
        self.depth += 1;
        self.frames.push(frame);
        if !self.options.world {
            return Ok(());
        }
        let indent = Indent(self.depth);
        match frame {
            Some(Transform { world_from_object, object_from_world }) => {
                writeln!(self.out, "{indent}objectToWorld: {}", matrix_of(&world_from_object))?;
                writeln!(self.out, "{indent}worldToObject: {}", matrix_of(&object_from_world))
            }
            None => writeln!(self.out, "{indent}objectToWorld: singular"),
        }
    }

    fn instance(&mut self, file: FileId, include: u32) -> io::Result<()> {
        let include = self.files.get(file.0 as usize).and_then(|file| file.includes.get(include as usize));
        let name = include.map_or("", |placed| placed.value.name.as_str());
        writeln!(self.out, "{}INSTANCE: {name}", Indent(self.depth))?;
        self.depth += 1;
        Ok(())
    }

    fn shapes(&mut self, file: FileId, kind: ShapeKind, first: u32, count: u32) -> io::Result<()> {
        let Some(file) = self.files.get(file.0 as usize) else { return Ok(()) };
        let indent = Indent(self.depth);
        for shape in file.shapes(kind, first, count) {
            writeln!(self.out, "{indent}{}", Line(&shape))?;
        }
        Ok(())
    }
}

/// Two blanks a level; from 100 levels on no more blanks, but the depth in brackets, because a hundred thousand
/// nested groups would otherwise print gigabytes of blanks.
#[derive(Clone, Copy)]
struct Indent(usize);

impl fmt::Display for Indent {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        const MOST: usize = 100;
        let width = 2 * self.0.min(MOST);
        write!(f, "{:width$}", "")?;
        if self.0 > MOST { write!(f, "[{}] ", self.0) } else { Ok(()) }
    }
}

/// `M(…)`, row by row, a semicolon between rows.
struct Matrix(Mat4);

/// A computed matrix; adding 0 turns the -0 that inversion leaves into 0.
fn matrix_of(affine: &Affine) -> Matrix {
    Matrix(Mat4::from(*affine) + Mat4::ZERO)
}

impl fmt::Display for Matrix {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let rows = [0, 1, 2, 3].map(|row| numbers(&self.0.row(row).to_array()));
        write!(f, "M({})", rows.join("; "))
    }
}

/// A shape as the slides print it.
struct Line<'a>(&'a Shape);

impl fmt::Display for Line<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self.0 {
            Shape::Sphere(sphere) => {
                write!(f, "SPHERE: C({}) R={}", point(sphere.center()), General(sphere.radius()))
            }
            Shape::Cuboid(cuboid) => {
                write!(f, "BOX: C({}) L({})", point(cuboid.center()), point(cuboid.size()))
            }
            Shape::Cylinder(cylinder) => {
                let [radius, height] = [cylinder.radius(), cylinder.height()].map(General);
                write!(f, "CYLINDER: C({}) R={radius} H={height}", point(cylinder.center()))
            }
            Shape::Cone(cone) => {
                let [radius, height] = [cone.radius(), cone.height()].map(General);
                write!(f, "CONE: C({}) R={radius} H={height}", point(cone.center()))?;
                if cone.top() > 0.0 { write!(f, " TOP={}", General(cone.top())) } else { Ok(()) }
            }
            Shape::Triangle(triangle) => triangle_line(triangle, f),
            Shape::Torus(torus) => {
                let [tube, ring] = [torus.tube(), torus.ring()].map(General);
                write!(f, "TORUS: C({}) R={ring} TUBE={tube}", point(torus.center()))
            }
            Shape::Open(OpenSide::Cylinder(side)) => write!(f, "OPEN {}", Line(&Shape::Cylinder(*side))),
            Shape::Open(OpenSide::Cone(side)) => write!(f, "OPEN {}", Line(&Shape::Cone(*side))),
        }
    }
}

fn triangle_line(triangle: &Triangle, f: &mut fmt::Formatter<'_>) -> fmt::Result {
    f.write_str("TRIANGLE:")?;
    for vertex in *triangle.vertices() {
        write!(f, " V({})", point(vertex))?;
    }
    for normal in *triangle.normals() {
        write!(f, " N({})", point(normal))?;
    }
    for texcoord in *triangle.texcoords() {
        write!(f, " T({})", numbers(&texcoord.to_array()))?;
    }
    Ok(())
}

fn point(point: Vec3) -> String {
    numbers(&point.to_array())
}

fn numbers(numbers: &[f64]) -> String {
    let numbers: Vec<String> = numbers.iter().map(|number| General(*number).to_string()).collect();
    numbers.join(", ")
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::model::Include;
    use crate::model::Item;
    use crate::model::Placed;
    use crate::span::Span;

    #[test]
    fn multiplying_instances_end() {
        let file = |next: u32| {
            let value = Include { name: format!("{next}.ray"), file: FileId(next) };
            let items = if next < 60 { vec![Item::Instance(0); 2] } else { Vec::new() };
            let includes = vec![Placed { value, span: Span::default() }];
            SceneFile { includes, items, ..SceneFile::default() }
        };
        let files: Vec<_> = (1..=60).map(file).collect();
        let mut out = Vec::new();
        dump_within(&files, DumpOptions::default(), 1000, &mut out).unwrap();
        let text = String::from_utf8(out).unwrap();
        assert!(text.lines().count() <= 1002);
        assert_eq!(
            text.lines().last(),
            Some("(the tree goes on: the instances multiply to more than 1000 steps)")
        );
    }
}
