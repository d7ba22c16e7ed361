//! Wire boxes over a picture.

use dotray::Image;
use dotray::geometry::Aabb;
use dotray::geometry::Vec3;
use dotray::render::Caster;
use dotray::render::Options;
use dotray::render::camera::Camera;
use dotray::scene::model;

use crate::tree::NodeKind;
use crate::tree::Tree;

/// A box and how many groups are around it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Wire {
    bounds: Aabb,
    /// 0 for the outermost.
    pub depth: usize,
}

/// At most so many boxes are drawn, so that the picture still shows.
const MOST: usize = 100_000;

/// The boxes of a scene's groups and instances.
pub fn group_wires(tree: &Tree<'_>) -> Vec<Wire> {
    let is_group = |kind: &NodeKind| match kind {
        NodeKind::Root | NodeKind::Group(_) | NodeKind::Instance(_) => true,
        NodeKind::Shapes(..) => false,
    };
    let groups = tree.nodes.iter().filter(|node| is_group(&node.kind) && !node.bounds.is_empty());
    groups.map(|node| Wire { bounds: node.bounds, depth: node.depth }).take(MOST).collect()
}

/// The boxes of the accelerator, level by level.
pub fn accelerator_wires(caster: &Caster) -> Vec<Wire> {
    let cells = caster.accelerator_cells(MOST);
    cells.into_iter().map(|cell| Wire { bounds: cell.bounds, depth: cell.depth as usize }).collect()
}

/// Colours by depth, again from the start: far apart from each other.
const COLORS: [[f32; 3]; 6] =
    [[1.0, 1.0, 1.0], [1.0, 0.6, 0.1], [0.3, 1.0, 0.4], [0.4, 0.7, 1.0], [1.0, 0.4, 0.9], [1.0, 1.0, 0.3]];

/// A segment in the window's pixels, without what lies behind the eye.
fn segment(camera: &Camera, options: &Options, from: Vec3, to: Vec3) -> Option<[(f64, f64); 2]> {
    let (a, b) = (from - camera.position(), to - camera.position());
    let (depth_a, depth_b) = (camera.depth(a), camera.depth(b));
    let near = 1e-6 * (a.length() + b.length());
    let cut = |p: Vec3, depth_p: f64, q: Vec3, depth_q: f64| {
        if depth_p >= near { p } else { p + (q - p) * ((near - depth_p) / (depth_q - depth_p)) }
    };
    if depth_a < near && depth_b < near {
        return None;
    }
    let window = options.window();
    let place = |p: Vec3| {
        let (x, y) = camera.place(p);
        (x - f64::from(window.x), f64::from(options.height) - y - f64::from(window.y))
    };
    Some([place(cut(a, depth_a, b, depth_b)), place(cut(b, depth_b, a, depth_a))])
}

/// Draws the boxes, the outer ones first.
pub fn draw<'a>(
    image: &mut Image,
    wires: impl Iterator<Item = &'a Wire>,
    camera: &model::Camera,
    options: &Options,
) {
    let camera = Camera::new(camera, options.width, options.height);
    for Wire { bounds, depth } in wires {
        let color = COLORS.get(depth % COLORS.len()).copied().unwrap_or([1.0; 3]);
        let corner = |index: usize| {
            let side = |axis: usize, low: f64, high: f64| if index >> axis & 1 == 0 { low } else { high };
            Vec3::new(
                side(0, bounds.min.x, bounds.max.x),
                side(1, bounds.min.y, bounds.max.y),
                side(2, bounds.min.z, bounds.max.z),
            )
        };
        for from in 0..8_usize {
            for axis in 0..3 {
                let to = from | 1 << axis;
                if to != from
                    && let Some(ends) = segment(&camera, options, corner(from), corner(to))
                {
                    draw_line(image, ends, color);
                }
            }
        }
    }
}

/// One pixel a step along the longer axis, cut at the picture's edges first.
fn draw_line(image: &mut Image, ends: [(f64, f64); 2], color: [f32; 3]) {
    let (width, height) = (image.width() as f64, image.height() as f64);
    let Some([a, b]) = clipped(ends, width, height) else { return };
    let steps = (b.0 - a.0).abs().max((b.1 - a.1).abs()).ceil().max(1.0);
    let [r, g, blue] = color;
    for step in 0..=steps as usize {
        let share = step as f64 / steps;
        let (x, y) = (a.0 + (b.0 - a.0) * share, a.1 + (b.1 - a.1) * share);
        image.set_pixel(x as usize, y as usize, [r, g, blue, 1.0]);
    }
}

/// The part of a segment inside the picture (Liang and Barsky, 1984).
fn clipped([a, b]: [(f64, f64); 2], width: f64, height: f64) -> Option<[(f64, f64); 2]> {
    let (dx, dy) = (b.0 - a.0, b.1 - a.1);
    if ![a.0, a.1, b.0, b.1].iter().all(|x| x.is_finite()) {
        return None;
    }
    let (mut from, mut to) = (0.0_f64, 1.0_f64);
    for (step, room) in [(-dx, a.0), (dx, width - a.0), (-dy, a.1), (dy, height - a.1)] {
        if step == 0.0 {
            if room < 0.0 {
                return None;
            }
        } else if step < 0.0 {
            from = from.max(room / step);
        } else {
            to = to.min(room / step);
        }
    }
    let at = |share: f64| (a.0 + dx * share, a.1 + dy * share);
    (from <= to).then(|| [at(from), at(to)])
}
