//! A scene of very many shapes with few, for drivers that are too slow to draw all of them while the camera moves:
//! large shapes as they are, and of the small ones every so many'th, enlarged such that they cover as much.

use crate::pack::Ball;
use crate::pack::Batch;
use crate::pack::Corner;
use crate::pack::Packed;
use crate::pack::Solid;

/// So many small things are left.
const MOST: usize = 40_000;

/// What is larger than this part of the scene stays.
const LARGE: f32 = 0.02;

/// How often the scene may cover itself with solid things: more could not be seen, and each layer costs time.
const LAYERS: f32 = 2.0;

/// What can stand for its neighbours.
trait Sketched: Copy {
    /// Whether it is a part of a surface: those that are left must then cover all of it.
    const SURFACE: bool;

    /// About its radius.
    fn radius(&self) -> f32;

    /// The same about its middle, so many times as large.
    fn enlarged(&self, by: f32) -> Self;
}

impl Sketched for Ball {
    const SURFACE: bool = false;

    fn radius(&self) -> f32 {
        self.place[3]
    }

    fn enlarged(&self, by: f32) -> Self {
        let [x, y, z, r] = self.place;
        Self { place: [x, y, z, r * by], ..*self }
    }
}

impl Sketched for Solid {
    const SURFACE: bool = false;

    fn radius(&self) -> f32 {
        let column = |at: usize| self.rows.iter().map(|row| row[at] * row[at]).sum::<f32>().sqrt();
        let mut columns = [column(0), column(1), column(2)];
        columns.sort_by(f32::total_cmp);
        (columns[1] * columns[2]).sqrt()
    }

    fn enlarged(&self, by: f32) -> Self {
        let rows = self.rows.map(|[x, y, z, at]| [x * by, y * by, z * by, at]);
        Self { rows, ..*self }
    }
}

impl Sketched for [Corner; 3] {
    const SURFACE: bool = true;

    fn radius(&self) -> f32 {
        let [a, b, c] = self.map(|corner| glam::Vec3::from_array(corner.point));
        (b - a).cross(c - a).length().sqrt().max(a.distance(b).max(b.distance(c)) * 0.25)
    }

    fn enlarged(&self, by: f32) -> Self {
        let middle = self.iter().map(|corner| glam::Vec3::from_array(corner.point)).sum::<glam::Vec3>() / 3.0;
        self.map(|corner| {
            let point = middle + (glam::Vec3::from_array(corner.point) - middle) * by;
            Corner { point: point.to_array(), ..corner }
        })
    }
}

/// How many things are small, and how often they cover the scene's disc.
#[derive(Clone, Copy, Default)]
struct Small {
    count: usize,
    layers: f32,
}

fn measure<T: Sketched>(batches: &[Batch<T>], small: &mut Small) {
    for thing in batches.iter().flat_map(|batch| &batch.things) {
        let radius = thing.radius();
        if radius <= LARGE {
            small.count += 1;
            if !T::SURFACE {
                small.layers += radius * radius;
            }
        }
    }
}

fn sketch<T: Sketched>(batches: &[Batch<T>], step: usize, layers: f32) -> Vec<Batch<T>> {
    let share = if T::SURFACE { 1.0 } else { (LAYERS / layers.max(LAYERS)).min(1.0) };
    let by = (step as f32 * share).sqrt().max(1.0);
    let (mut sketch, mut seen) = (Batch { things: Vec::new(), numbers: Vec::new() }, 0_usize);
    for (thing, number) in batches.iter().flat_map(|batch| batch.things.iter().zip(&batch.numbers)) {
        let radius = thing.radius();
        if radius > LARGE {
            sketch.things.push(*thing);
            sketch.numbers.push(*number);
            continue;
        }
        // Some one of each so many, lest rows of a grid come out.
        let pick = ((seen / step) as u32).wrapping_mul(2_654_435_761) >> 8;
        if seen % step == pick as usize % step {
            sketch.things.push(thing.enlarged(by.min(LARGE / radius.max(f32::MIN_POSITIVE)).max(1.0)));
            sketch.numbers.push(*number);
        }
        seen += 1;
    }
    if sketch.things.is_empty() { Vec::new() } else { vec![sketch] }
}

/// The draft of a scene; `None` where the scene has so few shapes that there is nothing to gain.
pub fn draft(packed: &Packed) -> Option<Packed> {
    let mut small = Small::default();
    measure(&packed.balls, &mut small);
    measure(&packed.rounds, &mut small);
    measure(&packed.boxes, &mut small);
    measure(&packed.triangles, &mut small);
    if small.count <= 2 * MOST {
        return None;
    }
    let step = small.count.div_ceil(MOST);
    Some(Packed {
        frame: packed.frame,
        frames: packed.frames.clone(),
        colors: packed.colors.clone(),
        bounds: packed.bounds,
        balls: sketch(&packed.balls, step, small.layers),
        rounds: sketch(&packed.rounds, step, small.layers),
        boxes: sketch(&packed.boxes, step, small.layers),
        triangles: sketch(&packed.triangles, step, small.layers),
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::tables::ViewFrame;
    use dotray_geometry::Aabb;
    use dotray_geometry::Vec3;

    fn packed(balls: Vec<Ball>) -> Packed {
        let numbers = (0..balls.len() as u32).collect();
        let frame = ViewFrame { center: Vec3::ZERO, unit: 1.0 };
        let balls = vec![Batch { things: balls, numbers }];
        let (rounds, boxes, triangles, frames, colors) = Default::default();
        Packed { frame, bounds: Aabb::EMPTY, balls, rounds, boxes, triangles, frames, colors }
    }

    #[test]
    fn large_shapes_stay_and_small_ones_cover_as_much() {
        let small = Ball { place: [0.0, 0.0, 0.0, 0.001], material: 1 };
        let large = Ball { place: [0.0, 0.0, 0.0, 0.5], material: 2 };
        let mut balls = vec![small; 4 * MOST];
        assert!(draft(&packed(balls[..2 * MOST].to_vec())).is_none());
        balls.insert(7, large);
        let draft = draft(&packed(balls)).expect("a draft");
        let batch = &draft.balls[0];
        assert_eq!((batch.things.len(), batch.numbers.len()), (MOST + 1, MOST + 1));
        assert!(batch.numbers.is_sorted() && batch.things.contains(&large));
        let area = |balls: &[Ball]| {
            balls.iter().filter(|ball| ball.material == 1).map(|b| b.place[3].powi(2)).sum::<f32>()
        };
        let whole = 4.0 * MOST as f32 * 1e-6;
        assert!((area(&batch.things) / whole - 1.0).abs() < 1e-3);
    }

    #[test]
    fn what_covers_itself_often_is_not_enlarged_as_much() {
        let ball = Ball { place: [0.0, 0.0, 0.0, 0.01], material: 0 };
        let draft = draft(&packed(vec![ball; 8 * MOST])).expect("a draft");
        let area: f32 = draft.balls[0].things.iter().map(|ball| ball.place[3].powi(2)).sum();
        assert!((area - LAYERS.max(MOST as f32 * 1e-4)).abs() < 0.1, "{area}");
    }
}
