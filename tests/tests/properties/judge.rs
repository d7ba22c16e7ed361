//! A slow judge of what a ray meets: plain arithmetic on the numbers of the text, with nothing of the crates in it.
//!
//! A solid is a function that is negative inside. Along a ray it is convex, because the solids are; so its lowest
//! place is found by sampling and golden sections, and the two crossings by halving on both sides of it.

use crate::random::AnyGroup;
use crate::random::AnyShape;
use crate::random::Rows;

/// Three numbers.
pub type V = [f64; 3];

fn dot(a: V, b: V) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

fn sub(a: V, b: V) -> V {
    [a[0] - b[0], a[1] - b[1], a[2] - b[2]]
}

fn cross(a: V, b: V) -> V {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

fn along(origin: V, direction: V, t: f64) -> V {
    [0, 1, 2].map(|i| origin[i] + t * direction[i])
}

fn product(a: &Rows, b: &Rows) -> Rows {
    let mut rows = [[0.0; 4]; 3];
    for (row, a) in rows.iter_mut().zip(a) {
        for (column, value) in row.iter_mut().enumerate() {
            *value = (0..3).map(|k| a[k] * b[k][column]).sum::<f64>() + if column == 3 { a[3] } else { 0.0 };
        }
    }
    rows
}

/// By Gauss and Jordan, the largest pivot first.
fn inverse(m: &Rows) -> Rows {
    let mut left = m.map(|row| [row[0], row[1], row[2]]);
    let mut right = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
    for column in 0..3 {
        let order = |&a: &usize, &b: &usize| f64::total_cmp(&left[a][column].abs(), &left[b][column].abs());
        let pivot = (column..3).max_by(order).expect("a row");
        left.swap(column, pivot);
        right.swap(column, pivot);
        let by = left[column][column];
        left[column] = left[column].map(|v| v / by);
        right[column] = right[column].map(|v| v / by);
        for row in (0..3).filter(|&row| row != column) {
            let factor = left[row][column];
            for k in 0..3 {
                left[row][k] -= factor * left[column][k];
                right[row][k] -= factor * right[column][k];
            }
        }
    }
    let shift = [m[0][3], m[1][3], m[2][3]];
    right.map(|row| [row[0], row[1], row[2], -dot(row, shift)])
}

/// A shape and the way from the world to its coordinates.
struct Judged {
    shape: AnyShape,
    object_from_world: Rows,
}

/// All shapes of a scene.
pub struct Judge {
    shapes: Vec<Judged>,
}

impl Judge {
    /// Takes the groups of a scene.
    pub fn new(groups: &[AnyGroup]) -> Self {
        let mut judge = Self { shapes: Vec::new() };
        let identity = [[1.0, 0.0, 0.0, 0.0], [0.0, 1.0, 0.0, 0.0], [0.0, 0.0, 1.0, 0.0]];
        groups.iter().for_each(|group| judge.add(group, &identity));
        judge
    }

    fn add(&mut self, group: &AnyGroup, outer: &Rows) {
        let world_from_object = product(outer, &group.matrix);
        let object_from_world = inverse(&world_from_object);
        for shape in &group.shapes {
            self.shapes.push(Judged { shape: shape.clone(), object_from_world });
        }
        group.inner.iter().for_each(|inner| self.add(inner, &world_from_object));
    }

    /// The smallest t above `t_min` at which the ray crosses a surface.
    pub fn nearest(&self, origin: V, direction: V, t_min: f64) -> Option<f64> {
        let crossings = self.shapes.iter().flat_map(|judged| {
            let m = &judged.object_from_world;
            let linear = m.map(|row| [row[0], row[1], row[2]]);
            let origin = [0, 1, 2].map(|i| dot(linear[i], origin) + m[i][3]);
            crossings(&judged.shape, origin, linear.map(|row| dot(row, direction)))
        });
        crossings.filter(|&t| t > t_min).min_by(f64::total_cmp)
    }
}

fn crossings(shape: &AnyShape, origin: V, direction: V) -> Vec<f64> {
    let n = &shape.numbers;
    if shape.kind == "#shape_triangle" {
        return triangle_crossing([0, 3, 6].map(|i| [n[i], n[i + 1], n[i + 2]]), origin, direction)
            .into_iter()
            .collect();
    }
    let origin = sub(origin, [n[0], n[1], n[2]]);
    match shape.kind {
        "#shape_sphere" => solid_crossings(|p| dot(p, p).sqrt() - n[3], n[3], origin, direction),
        "#shape_box" => {
            let half = [n[3] / 2.0, n[4] / 2.0, n[5] / 2.0];
            let depth = |p: V| (p[0].abs() - half[0]).max(p[1].abs() - half[1]).max(p[2].abs() - half[2]);
            solid_crossings(depth, dot(half, half).sqrt(), origin, direction)
        }
        "#shape_cylinder" => {
            let (r, half) = (n[3], n[4] / 2.0);
            let depth = |p: V| ((p[0] * p[0] + p[2] * p[2]).sqrt() - r).max(p[1].abs() - half);
            solid_crossings(depth, (r * r + half * half).sqrt(), origin, direction)
        }
        "#shape_cone" => {
            let ends = [n[3], n.get(5).copied().unwrap_or(0.0)];
            round_crossings(ends, n[4], origin, direction)
        }
        "#shape_side" => {
            let ends = [n[3], n.get(5).copied().unwrap_or(n[3])];
            let mut found = round_crossings(ends, n[4], origin, direction);
            // What is left are crossings of the discs, which lie at half the height but for rounding.
            found.retain(|&t| along(origin, direction, t)[1].abs() < n[4] / 2.0 * (1.0 - 1e-9));
            found
        }
        other => panic!("no judge for {other}"),
    }
}

/// Of a solid round about y, with these radii at its lower and its upper end.
fn round_crossings([low, high]: [f64; 2], height: f64, origin: V, direction: V) -> Vec<f64> {
    let width = |y: f64| high + (low - high) * (height / 2.0 - y) / height;
    let depth = |p: V| ((p[0] * p[0] + p[2] * p[2]).sqrt() - width(p[1])).max(p[1].abs() - height / 2.0);
    solid_crossings(depth, (low.max(high).powi(2) + height * height / 4.0).sqrt(), origin, direction)
}

fn triangle_crossing(v: [V; 3], origin: V, direction: V) -> Option<f64> {
    let normal = cross(sub(v[1], v[0]), sub(v[2], v[0]));
    let t = dot(sub(v[0], origin), normal) / dot(direction, normal);
    let p = along(origin, direction, t);
    let sides = [0, 1, 2].map(|i| dot(cross(sub(v[(i + 1) % 3], v[i]), sub(p, v[i])), normal));
    (t.is_finite() && sides.iter().all(|&side| side >= 0.0)).then_some(t)
}

/// Where the line enters and leaves the solid with this depth, which lies within `radius` of the origin.
fn solid_crossings(depth: impl Fn(V) -> f64, radius: f64, origin: V, direction: V) -> Vec<f64> {
    let at = |t: f64| depth(along(origin, direction, t));
    let square = dot(direction, direction);
    let middle = -dot(origin, direction) / square;
    let closest = along(origin, direction, middle);
    if dot(closest, closest) > radius * radius * 1.001 {
        return Vec::new();
    }
    let reach = 1.01 * radius / square.sqrt();
    let (mut low, mut high) = (middle - reach, middle + reach);
    // The lowest of some samples lies next to the lowest place of all.
    const SAMPLES: usize = 32;
    let place = |i: usize| middle - reach + 2.0 * reach * i as f64 / SAMPLES as f64;
    let best = (0..=SAMPLES).min_by(|&a, &b| at(place(a)).total_cmp(&at(place(b)))).expect("samples");
    let (mut left, mut right) = (place(best.max(1) - 1), place((best + 1).min(SAMPLES)));
    for _ in 0..80 {
        let (a, b) = (left + 0.382 * (right - left), left + 0.618 * (right - left));
        if at(a) < at(b) { right = b } else { left = a }
    }
    let lowest = (left + right) / 2.0;
    if at(lowest) >= 0.0 {
        return Vec::new();
    }
    let (mut inside_low, mut inside_high) = (lowest, lowest);
    for _ in 0..60 {
        let (a, b) = ((low + inside_low) / 2.0, (inside_high + high) / 2.0);
        if at(a) < 0.0 {
            inside_low = a
        } else {
            low = a
        }
        if at(b) < 0.0 { inside_high = b } else { high = b }
    }
    vec![low, high]
}

#[test]
fn the_judge_knows_simple_cases() {
    let shape = |kind, numbers: &[f64]| AnyShape { kind, numbers: numbers.to_vec(), material: 0 };
    let group = |matrix, shape| AnyGroup { matrix, shapes: vec![shape], inner: Vec::new() };
    let stretched = [[1.0, 0.0, 0.0, 0.0], [0.0, 1.0, 0.0, 0.0], [0.0, 0.0, 3.0, 1.0]];
    let judge = Judge::new(&[group(stretched, shape("#shape_sphere", &[0.0, 0.0, 0.0, 2.0]))]);
    let (eye, forward) = ([0.0, 0.0, 10.0], [0.0, 0.0, -1.0]);
    assert!((judge.nearest(eye, forward, 0.0).expect("a hit") - 3.0).abs() < 1e-12);
    assert!((judge.nearest(eye, forward, 4.0).expect("the far side") - 15.0).abs() < 1e-12);
    assert_eq!(judge.nearest([3.0, 0.0, 10.0], forward, 0.0), None);
    let unit = [[1.0, 0.0, 0.0, 0.0], [0.0, 1.0, 0.0, 0.0], [0.0, 0.0, 1.0, 0.0]];
    for (numbers, kind, t) in [
        ([0.0, 0.0, 0.0, 1.0, 1.0, 4.0].as_slice(), "#shape_box", 8.0),
        (&[0.0, 0.0, 0.0, 1.0, 2.0], "#shape_cylinder", 9.0),
        (&[0.0, 0.0, 0.0, 1.0, 2.0], "#shape_cone", 9.5),
        (&[0.0, 0.0, 0.0, 1.0, 2.0, 2.0], "#shape_cone", 8.5),
        (&[0.0, 0.0, 0.0, 1.0, 2.0], "#shape_side", 9.0),
        (&[0.0, 0.0, 0.0, 1.0, 2.0, 2.0], "#shape_side", 8.5),
    ] {
        let judge = Judge::new(&[group(unit, shape(kind, numbers))]);
        assert!((judge.nearest(eye, forward, 0.0).expect("a hit") - t).abs() < 1e-12, "{kind}");
        // What comes from above and goes down inside of a side meets nothing.
        let above = judge.nearest([0.25, 10.0, 0.0], [0.0, -1.0, 0.0], 0.0);
        assert_eq!(above.is_none(), kind == "#shape_side", "{kind}");
    }
}
