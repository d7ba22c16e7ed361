//! Random scenes as values that shrink: all shapes, nested groups of any affine kind, mirrors, glass, bumps, and
//! shapes that stand in the same place.

use proptest::collection::vec;
use proptest::prelude::*;
use std::fmt::Write;

/// A group's matrix, row by row, without the last row.
pub type Rows = [[f64; 4]; 3];

/// A shape's directive without its material, and its material.
#[derive(Clone, Debug)]
pub struct AnyShape {
    pub kind: &'static str,
    pub numbers: Vec<f64>,
    pub material: usize,
}

/// A group with its shapes and the groups inside.
#[derive(Clone, Debug)]
pub struct AnyGroup {
    pub matrix: Rows,
    pub shapes: Vec<AnyShape>,
    pub inner: Vec<AnyGroup>,
}

/// The materials: dull, mirror, glass, coloured glass, bumpy, marble, glowing.
const MATERIALS: [&str; 7] = [
    "0.6 0.5 0.4  0.6 0.5 0.4  0.5 0.5 0.5  0 0 0  0.2 0 1 -1 !!",
    "0.1 0.1 0.1  0.1 0.1 0.1  0.9 0.9 0.8  0 0 0  0.9 0 1 -1 !!",
    "0 0 0.05  0 0 0.05  1 1 1  0 0 0  0.1 0.9 1.5 -1 !!",
    "0.1 0 0  0.1 0 0  1 0.6 0.5  0 0 0  0.05 0.8 1.2 -1 !!",
    "0.4 0.5 0.6  0.4 0.5 0.6  0.5 0.5 0.5  0 0 0  0.4 0 1 -1 !bump scale=3 height=0.05!",
    "0.8 0.8 0.8  0.8 0.8 0.8  0.2 0.2 0.2  0 0 0  0.1 0 1 -1 !marble scale=2 color2=0.2,0.1,0.3!",
    "0 0 0  0.2 0.4 0.2  0 0 0  0.1 0.3 0.1  0 0 1 -1 !checker scale=2!",
];

/// Where a scene stands in the world, and how large it is there.
#[derive(Clone, Copy, Debug)]
pub struct Placement {
    pub scale: f64,
    pub shift: [f64; 3],
}

impl Placement {
    /// As the shapes are written.
    pub const PLAIN: Self = Self { scale: 1.0, shift: [0.0; 3] };

    /// Camera and lights for a scene that stands here.
    fn head(self) -> String {
        let place = |p: [f64; 3]| {
            let [x, y, z] = [0, 1, 2].map(|i| self.scale * p[i] + self.shift[i]);
            format!("{x} {y} {z}")
        };
        let (linear, quadratic) = (0.01 / self.scale, 0.001 / (self.scale * self.scale));
        let (eye, lamp, spot) = (place([0.3, 0.6, 9.0]), place([-5.0, 6.0, 7.0]), place([4.0, 3.0, 6.0]));
        format!(
            "#camera {eye}  0 0 -1  0.1 1 0  0.5\n#background 0.1 0.2 0.3\n#ambient 0.3 0.3 0.3\n\
             #light_point 0.8 0.8 0.7  {lamp}  1 0 0\n#light_dir 0.3 0.3 0.4  0.2 -1 -0.4\n\
             #light_spot 0.6 0.5 0.5  {spot}  -4 -3 -6  0.5 {linear} {quadratic}  0.5 0.02\n"
        )
    }

    fn group(self) -> String {
        let (s, [x, y, z]) = (self.scale, self.shift);
        format!("#group_begin {s} 0 0 {x}  0 {s} 0 {y}  0 0 {s} {z}  0 0 0 1\n")
    }
}

/// Any placement: small, large, far from the origin.
fn placement() -> impl Strategy<Value = Placement> {
    let scale = prop_oneof![2 => Just(1.0), 1 => Just(1e-4), 1 => Just(3e5)];
    let shift = prop_oneof![2 => Just([0.0; 3]), 1 => Just([1000.0, -300.0, 70.0])];
    (scale, shift).prop_map(|(scale, shift)| Placement { scale, shift: shift.map(|v| v * scale) })
}

/// A coordinate: half of them on a coarse grid, so that surfaces coincide.
fn coordinate() -> impl Strategy<Value = f64> {
    prop_oneof![(-8..=8_i32).prop_map(|n| f64::from(n) * 0.25), -2.0..2.0_f64]
}

fn length() -> impl Strategy<Value = f64> {
    prop_oneof![(1..=6_i32).prop_map(|n| f64::from(n) * 0.25), 0.05..1.5_f64]
}

fn material() -> std::ops::Range<usize> {
    0..MATERIALS.len()
}

/// Any shape.
pub fn shape() -> impl Strategy<Value = AnyShape> {
    let of = |kind: &'static str, lengths: usize| {
        (vec(coordinate(), 3), vec(length(), lengths), material()).prop_map(
            move |(mut numbers, lengths, material)| {
                numbers.extend(lengths);
                AnyShape { kind, numbers, material }
            },
        )
    };
    let triangle = (vec(coordinate(), 9), prop_oneof![Just(vec![0.0; 9]), vec(-1.0..1.0_f64, 9)], material());
    let triangle = triangle.prop_map(|(mut numbers, normals, material)| {
        numbers.extend(normals);
        numbers.extend([0.0, 0.0, 1.0, 0.0, 0.0, 1.0]);
        AnyShape { kind: "#shape_triangle", numbers, material }
    });
    prop_oneof![
        of("#shape_sphere", 1),
        of("#shape_box", 3),
        of("#shape_cylinder", 2),
        of("#shape_cone", 2),
        of("#shape_cone", 3),
        of("#shape_side", 2),
        of("#shape_side", 3),
        triangle,
    ]
}

fn determinant(m: &Rows) -> f64 {
    let minor = |a: usize, b: usize| m[1][a] * m[2][b] - m[1][b] * m[2][a];
    m[0][0] * minor(1, 2) - m[0][1] * minor(0, 2) + m[0][2] * minor(0, 1)
}

/// Any usable affine map: none, a shift, a quarter turn, a mirror, uneven scales, shears, and all at once.
pub fn matrix() -> impl Strategy<Value = Rows> {
    let diagonal = |x: f64, y: f64, z: f64, shift: &[f64]| {
        [[x, 0.0, 0.0, shift[0]], [0.0, y, 0.0, shift[1]], [0.0, 0.0, z, shift[2]]]
    };
    let shift = || vec(coordinate(), 3);
    prop_oneof![
        Just(diagonal(1.0, 1.0, 1.0, &[0.0; 3])),
        shift().prop_map(move |s| diagonal(1.0, 1.0, 1.0, &s)),
        shift().prop_map(|s| [[0.0, -1.0, 0.0, s[0]], [1.0, 0.0, 0.0, s[1]], [0.0, 0.0, 1.0, s[2]]]),
        shift().prop_map(move |s| diagonal(-1.0, 1.0, 1.0, &s)),
        (vec(0.3..2.0_f64, 3), shift()).prop_map(move |(d, s)| diagonal(d[0], d[1], d[2], &s)),
        (-1.0..1.0_f64, -1.0..1.0_f64, shift()).prop_map(|(a, b, s)| [
            [1.0, a, 0.0, s[0]],
            [0.0, 1.0, b, s[1]],
            [0.0, 0.0, 1.0, s[2]]
        ]),
        (vec(-1.5..1.5_f64, 9), shift())
            .prop_map(|(m, s)| [[m[0], m[1], m[2], s[0]], [m[3], m[4], m[5], s[1]], [m[6], m[7], m[8], s[2]]])
            .prop_filter("too flat", |m| determinant(m).abs() > 0.1),
    ]
}

/// Any group, two levels deep at most, with shapes that may stand twice.
pub fn group() -> impl Strategy<Value = AnyGroup> {
    let shapes = || {
        (vec(shape(), 0..8), any::<bool>(), material()).prop_map(|(mut shapes, twice, other)| {
            if let (true, Some(first)) = (twice, shapes.first().cloned()) {
                shapes.push(AnyShape { material: other, ..first });
            }
            shapes
        })
    };
    let leaf =
        (matrix(), shapes()).prop_map(|(matrix, shapes)| AnyGroup { matrix, shapes, inner: Vec::new() });
    (matrix(), shapes(), vec(leaf, 0..3)).prop_map(|(matrix, shapes, inner)| AnyGroup {
        matrix,
        shapes,
        inner,
    })
}

fn write_group(group: &AnyGroup, text: &mut String) {
    let numbers = |numbers: &[f64]| numbers.iter().map(|n| format!(" {n}")).collect::<String>();
    let rows: String = group.matrix.iter().map(|row| numbers(row)).collect();
    // Writing to a string cannot fail.
    let _ = writeln!(text, "#group_begin{rows} 0 0 0 1");
    for shape in &group.shapes {
        let _ = writeln!(text, "{} {}{}", shape.kind, shape.material, numbers(&shape.numbers));
    }
    group.inner.iter().for_each(|inner| write_group(inner, text));
    text.push_str("#group_end\n");
}

/// The scene as `.ray` text.
pub fn text(groups: &[AnyGroup], placement: Placement) -> String {
    let mut text = placement.head();
    for material in MATERIALS {
        let _ = writeln!(text, "#material {material}");
    }
    text.push_str(&placement.group());
    groups.iter().for_each(|group| write_group(group, &mut text));
    text.push_str("#group_end\n");
    text
}

/// Any scene, as text.
pub fn scene() -> impl Strategy<Value = String> {
    (vec(group(), 1..4), placement()).prop_map(|(groups, placement)| text(&groups, placement))
}
