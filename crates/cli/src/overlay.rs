//! Wire boxes over a picture.

use dotray::Image;
use dotray::geometry::Aabb;
use dotray::geometry::Vec3;
use dotray::render::Options;
use dotray::render::camera::Camera as PixelCamera;
use dotray::scene::model::Camera;

use crate::tree::NodeKind;
use crate::tree::Tree;

/// A box and how many groups are around it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Wire {
    bounds: Aabb,
    depth: usize,
}

/// The boxes of a scene's groups and instances: at most so many as still let the picture show.
pub fn group_wires(tree: &Tree<'_>) -> Vec<Wire> {
    const MOST: usize = 100_000;
    let is_group = |kind: &NodeKind| match kind {
        NodeKind::Root | NodeKind::Group(_) | NodeKind::Instance(_) => true,
        NodeKind::Shapes(..) => false,
    };
    let groups = tree.nodes.iter().filter(|node| is_group(&node.kind) && !node.bounds.is_empty());
    groups.map(|node| Wire { bounds: node.bounds, depth: node.depth }).take(MOST).collect()
}

/// Colours by depth, again from the start: far apart from each other.
const COLORS: [[f32; 3]; 6] =
    [[1.0, 1.0, 1.0], [1.0, 0.6, 0.1], [0.3, 1.0, 0.4], [0.4, 0.7, 1.0], [1.0, 0.4, 0.9], [1.0, 1.0, 0.3]];

/// Where points of the scene lie in the picture.
struct Projection {
    eye: Vec3,
    forward: Vec3,
    right: Vec3,
    up: Vec3,
    /// Pixels a unit at distance 1.
    scale: f64,
    center: (f64, f64),
}

impl Projection {
    fn new(camera: &Camera, options: &Options) -> Self {
        let forward = camera.direction.normalize();
        let right = forward.cross(camera.up).normalize();
        let up = right.cross(forward);
        let (width, height) = (f64::from(options.width), f64::from(options.height));
        // The ray through the upper edge's middle has the half angle's tangent.
        let upper =
            PixelCamera::new(camera, options.width, options.height).ray(width / 2.0, height).direction;
        let tangent = upper.dot(up) / upper.dot(forward);
        let window = options.window();
        Self {
            eye: camera.position,
            forward,
            right,
            up,
            scale: height / (2.0 * tangent),
            center: (width / 2.0 - f64::from(window.x), height / 2.0 - f64::from(window.y)),
        }
    }

    /// A segment in the picture, without what lies behind the eye.
    fn segment(&self, from: Vec3, to: Vec3) -> Option<[(f64, f64); 2]> {
        let (a, b) = (from - self.eye, to - self.eye);
        let (depth_a, depth_b) = (a.dot(self.forward), b.dot(self.forward));
        let near = 1e-6 * (a.length() + b.length());
        let cut = |p: Vec3, depth_p: f64, q: Vec3, depth_q: f64| {
            if depth_p >= near { p } else { p + (q - p) * ((near - depth_p) / (depth_q - depth_p)) }
        };
        if depth_a < near && depth_b < near {
            return None;
        }
        let place = |p: Vec3| {
            let depth = p.dot(self.forward);
            let (x, y) = (p.dot(self.right) / depth, p.dot(self.up) / depth);
            (self.center.0 + x * self.scale, self.center.1 - y * self.scale)
        };
        Some([place(cut(a, depth_a, b, depth_b)), place(cut(b, depth_b, a, depth_a))])
    }
}

/// Draws the boxes, the outer ones first.
pub fn draw(image: &mut Image, wires: &[Wire], camera: &Camera, options: &Options) {
    let projection = Projection::new(camera, options);
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
                    && let Some(ends) = projection.segment(corner(from), corner(to))
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
