//! The rays of a pixel as rows of a list and as lines in space.

use dotray_geometry::Vec3;
use dotray_render::inspect::Branch;
use dotray_render::inspect::End;
use dotray_render::inspect::LightTerm;
use dotray_render::inspect::RayKind;
use dotray_render::inspect::RayNode;
use dotray_render::inspect::Shadow;
use serde::Deserialize;
use serde::Serialize;

/// A ray of the tree.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct RayRow {
    /// Why it was sent.
    pub kind: RayKind,
    /// How many bounces lie behind it.
    pub depth: u32,
    /// Where it starts.
    pub from: Vec3,
    /// Where it ends; a point far away where it met nothing.
    pub to: Vec3,
    /// The shape and the material that it met.
    pub met: Option<(u32, u32)>,
    /// Whether it came from outside.
    pub entering: bool,
    /// How far it went.
    pub distance: f64,
    /// The shading normal where it ended.
    pub normal: Vec3,
    /// What it sees.
    pub color: Vec3,
    /// What its colour is multiplied by where it was sent.
    pub weight: Vec3,
    /// The part of its colour that the surface and its lights give.
    pub direct: Vec3,
    /// The lights at its end.
    pub lights: Vec<LightRow>,
    /// Why no mirrored and why no refracted ray follows.
    pub ends: [Option<End>; 2],
}

/// A light at the end of a ray, its samples taken together.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct LightRow {
    /// Its number.
    pub light: u32,
    /// How many points stand for it.
    pub samples: u32,
    /// How many of them would shine here if nothing lay between.
    pub shining: u32,
    /// How many of those something hides.
    pub blocked: u32,
    /// A shape that hides it.
    pub blocker: Option<u32>,
    /// How many surfaces it shines through, all points together.
    pub crossed: usize,
    /// What it gives after all shadows.
    pub gives: Vec3,
    /// Where some of its points are, far away for parallel light, and whether something hides them.
    pub points: Vec<(Vec3, bool)>,
}

/// The tree as a list, mirrored rays before refracted ones. A ray that met nothing is `far` long.
pub fn rows(root: &RayNode, far: f64) -> Vec<RayRow> {
    let mut rows = Vec::new();
    // A stack, not recursion: the recursion limit is the user's.
    let mut open = vec![root];
    while let Some(node) = open.pop() {
        rows.push(row(node, far));
        if let Some(met) = &node.meeting {
            for branch in [&met.refracted, &met.reflected] {
                if let Branch::Traced(sent) = branch {
                    open.push(sent);
                }
            }
        }
    }
    rows
}

fn row(node: &RayNode, far: f64) -> RayRow {
    let met = node.meeting.as_ref();
    let distance = met.map_or(far, |met| met.nearest.hit.t);
    let ended = |branch: &Branch| match branch {
        Branch::Traced(_) => None,
        Branch::Ended(end) => Some(*end),
    };
    RayRow {
        kind: node.kind,
        depth: node.depth,
        from: node.ray.origin,
        to: met.map_or_else(|| node.ray.origin + node.ray.direction * far, |met| met.surface.point),
        met: met.map(|met| (met.nearest.number, met.material)),
        entering: met.is_none_or(|met| met.entering),
        distance,
        normal: met.map_or(Vec3::ZERO, |met| met.normal),
        color: node.color,
        weight: node.weight,
        direct: met.map_or(node.color, |met| met.direct()),
        lights: met.map_or_else(Vec::new, |met| {
            let lights = met.lights.chunk_by(|a, b| a.light == b.light);
            lights.map(|terms| light_row(terms, met.surface.point, far)).collect()
        }),
        ends: met.map_or([None, None], |met| [ended(&met.reflected), ended(&met.refracted)]),
    }
}

fn light_row(terms: &[LightTerm], point: Vec3, far: f64) -> LightRow {
    let first = terms.first();
    let mut row = LightRow {
        light: first.map_or(0, |term| term.light),
        samples: first.map_or(0, |term| term.samples),
        shining: 0,
        blocked: 0,
        blocker: None,
        crossed: 0,
        gives: Vec3::ZERO,
        points: Vec::new(),
    };
    for term in terms {
        let Some(incident) = term.incident else { continue };
        row.shining += u32::from(term.lit != Vec3::ZERO);
        let mut hidden = false;
        match &term.shadow {
            Shadow::NotAsked => {}
            Shadow::Blocked { number, .. } => {
                (row.blocked, row.blocker, hidden) = (row.blocked + 1, Some(*number), true);
            }
            Shadow::Crossed(crossings) => row.crossed += crossings.len(),
        }
        if row.points.len() < SAMPLES_DRAWN {
            row.points.push((point + incident.towards * incident.distance.min(far), hidden));
        }
        row.gives += term.lit * term.filter / f64::from(term.samples.max(1));
    }
    row
}

/// Of an area light's samples so many are drawn.
const SAMPLES_DRAWN: usize = 8;

/// A line in the world with its colour, red, green, blue and alpha.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Line {
    /// Both ends.
    pub ends: [Vec3; 2],
    /// Its colour.
    pub color: [u8; 4],
}

/// Eye rays are yellow, mirrored ones blue, refracted ones green, rays to lights pale, and red where something blocks;
/// normals are white. `chosen` is drawn bright, the others faint; `None` draws all bright.
pub fn lines(rows: &[RayRow], chosen: Option<usize>, normal_length: f64) -> Vec<Line> {
    let mut lines = Vec::new();
    for (index, row) in rows.iter().enumerate() {
        let alpha = if chosen.is_none_or(|chosen| chosen == index) { 255 } else { 70 };
        let mut draw = |from: Vec3, to: Vec3, [r, g, b]: [u8; 3]| {
            lines.push(Line { ends: [from, to], color: [r, g, b, alpha] });
        };
        let color = match row.kind {
            RayKind::Eye => [255, 200, 40],
            RayKind::Reflected => [70, 150, 255],
            RayKind::Refracted => [60, 210, 110],
        };
        draw(row.from, row.to, color);
        if row.met.is_some() {
            draw(row.to, row.to + row.normal * normal_length, [255, 255, 255]);
        }
        for (to, hidden) in row.lights.iter().flat_map(|light| &light.points) {
            draw(row.to, *to, if *hidden { [240, 70, 60] } else { [240, 230, 170] });
        }
    }
    lines
}

/// The twelve edges of a box.
pub fn box_lines(bounds: &dotray_geometry::Aabb, color: [u8; 4]) -> Vec<Line> {
    if bounds.is_empty() {
        return Vec::new();
    }
    let corner = |at: usize| {
        let pick = |bit: usize, low: f64, high: f64| if at >> bit & 1 == 1 { high } else { low };
        let (low, high) = (bounds.min, bounds.max);
        Vec3::new(pick(0, low.x, high.x), pick(1, low.y, high.y), pick(2, low.z, high.z))
    };
    let edges = (0..8_usize).flat_map(|at| [1, 2, 4].map(move |bit| (at, at | bit)));
    edges.filter(|(a, b)| a != b).map(|(a, b)| Line { ends: [corner(a), corner(b)], color }).collect()
}

/// What a reader is told of a ray that was not sent.
pub fn end_text(end: End) -> String {
    match end {
        End::Limit => "recursion limit".to_owned(),
        End::NoWeight => "none: the material has no weight for it".to_owned(),
        End::Threshold { largest } => format!("below the cut-off: {largest:.2e}"),
        End::TotalReflection => "total internal reflection".to_owned(),
    }
}
