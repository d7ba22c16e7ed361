//! Why a pixel has its colour: all that is told about it, gathered from the renderer itself.

pub mod dot;
pub mod json;
pub mod svg;
pub mod text;

use dotray::accel::simd::level;
use dotray::geometry::Vec3;
use dotray::render::Antialias;
use dotray::render::Options;
use dotray::render::World;
use dotray::render::camera::Camera;
use dotray::render::inspect::Branch;
use dotray::render::inspect::RayNode;
use dotray::render::inspect::Shadow;
use dotray::render::sampler;
use dotray::render::sampler::Block;
use dotray::render::sampler::Division;
use dotray::render::sampler::LatticePoint;
use dotray::render::trace::Tracer;
use dotray::scene::Resolved;
use std::collections::BTreeMap;

use crate::places::LightPlace;
use crate::places::ShapePlace;

/// One sample of a pixel.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SamplePlace {
    /// Pixels from the left.
    pub x: f64,
    /// Pixels from below.
    pub y: f64,
    /// Its share of the pixel.
    pub weight: f64,
    /// What its ray sees.
    pub color: Vec3,
}

/// A square of an adaptively divided pixel.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Square {
    /// How often the pixel was divided to get it.
    pub level: u32,
    /// Its lower left corner, in pixels from the lower left.
    pub corner: (f64, f64),
    /// Its edge in pixels.
    pub edge: f64,
}

/// How a pixel's colour comes from its samples.
#[derive(Clone, Debug, Default)]
pub struct Sampling {
    /// All of them.
    pub samples: Vec<SamplePlace>,
    /// Where the pixel was divided adaptively: the squares whose corners the samples are.
    pub squares: Vec<Square>,
    /// The pixel's colour.
    pub mean: Vec3,
}

/// A ray of the tree in a list in which senders stand before what they send.
#[derive(Clone, Copy, Debug)]
pub struct Listed<'a> {
    /// The ray.
    pub node: &'a RayNode,
    /// The number of its sender.
    pub parent: Option<usize>,
    /// The numbers of the mirrored and the refracted ray.
    pub children: [Option<usize>; 2],
}

/// What one accelerator tested.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Visit {
    /// Its name.
    pub accelerator: &'static str,
    /// Boxes or cells for the eye ray alone.
    pub eye_boxes: u64,
    /// Shapes for the eye ray alone.
    pub eye_shapes: u64,
    /// Boxes or cells for all rays.
    pub boxes: u64,
    /// Shapes for all rays.
    pub shapes: u64,
    /// Whether it gives the very same colour.
    pub same_color: bool,
}

/// All that is told.
pub struct Explanation<'a> {
    /// The scene's name.
    pub scene: String,
    /// What the picture depends on.
    pub options: &'a Options,
    /// The accelerator's name.
    pub accelerator: &'static str,
    /// The pixel from the upper left; `None` for a place on the film.
    pub pixel: Option<(u32, u32)>,
    /// The samples.
    pub sampling: Sampling,
    /// Whose rays are shown.
    pub chosen: usize,
    /// These rays.
    pub rays: Vec<Listed<'a>>,
    /// What `render` makes of the pixel.
    pub rendered: Option<[f32; 3]>,
    /// What is traced.
    pub world: &'a World,
    /// The scene.
    pub resolved: &'a Resolved,
    /// The shapes that rays met, by number.
    pub shapes: BTreeMap<u32, ShapePlace>,
    /// The lights.
    pub lights: Vec<LightPlace>,
    /// What other accelerators test.
    pub visits: Vec<Visit>,
}

/// The samples of pixel (i, j), counted from the lower left, and its colour.
pub fn sample_pixel(world: &World, options: &Options, i: u32, j: u32) -> Sampling {
    let camera = Camera::new(world.camera(), options.width, options.height);
    let mut tracer = Tracer::new(world, options, level());
    match options.antialias {
        Antialias::None => grid(&camera, &mut tracer, i, j, 1),
        Antialias::Grid(n) => grid(&camera, &mut tracer, i, j, n),
        Antialias::Adaptive { threshold, depth } => {
            adaptive(&camera, &mut tracer, Block { x: i, y: j, width: 1, height: 1 }, threshold, depth)
        }
    }
}

fn grid(camera: &Camera, tracer: &mut Tracer<'_>, i: u32, j: u32, n: u32) -> Sampling {
    let places = sampler::grid_places(&[(i, j)], n);
    let rays: Vec<_> = places.iter().map(|&(x, y)| camera.ray(x, y)).collect();
    let colors = tracer.colors(&rays);
    let weight = 1.0 / f64::from(n * n);
    let sample = |(&(x, y), &color): (&(f64, f64), &Vec3)| SamplePlace { x, y, weight, color };
    let samples = places.iter().zip(&colors).map(sample).collect();
    let mean = sampler::grid_means(colors, n).first().copied().unwrap_or_default();
    Sampling { samples, squares: Vec::new(), mean }
}

fn adaptive(camera: &Camera, tracer: &mut Tracer<'_>, pixel: Block, threshold: f64, depth: u32) -> Sampling {
    let scale = 1.0 / (1_u64 << depth) as f64;
    let place = |point: LatticePoint| (point.x as f64 * scale, point.y as f64 * scale);
    let division = Division::new(pixel, threshold, depth, |points: &[LatticePoint]| {
        let ray = |point: &LatticePoint| {
            let (x, y) = place(*point);
            camera.ray(x, y)
        };
        tracer.colors(&points.iter().map(ray).collect::<Vec<_>>())
    });
    let mut weights: BTreeMap<(u64, u64), f64> = BTreeMap::new();
    let mut squares = Vec::new();
    for (level, quad) in division.squares() {
        squares.push(Square { level, corner: place(quad.lower_left), edge: quad.edge as f64 * scale });
        for LatticePoint { x, y } in quad.corners() {
            *weights.entry((y, x)).or_default() += 0.25 / (1_u64 << (2 * level)) as f64;
        }
    }
    let sample = |((y, x), weight): ((u64, u64), f64)| {
        let point = LatticePoint { x, y };
        let ((x, y), color) = (place(point), division.color(point).unwrap_or_default());
        SamplePlace { x, y, weight, color }
    };
    let samples = weights.into_iter().map(sample).collect();
    Sampling { samples, squares, mean: division.means().first().copied().unwrap_or_default() }
}

/// The tree as a list, mirrored rays first.
pub fn listed(root: &RayNode) -> Vec<Listed<'_>> {
    let mut list: Vec<Listed<'_>> = Vec::new();
    // A stack, not recursion: the recursion limit is the user's.
    let mut open: Vec<(&RayNode, Option<(usize, usize)>)> = vec![(root, None)];
    while let Some((node, sender)) = open.pop() {
        let number = list.len();
        if let Some((parent, branch)) = sender
            && let Some(slot) = list.get_mut(parent).and_then(|sender| sender.children.get_mut(branch))
        {
            *slot = Some(number);
        }
        list.push(Listed { node, parent: sender.map(|(parent, _)| parent), children: [None, None] });
        if let Some(met) = &node.meeting {
            for (branch, what) in [&met.reflected, &met.refracted].into_iter().enumerate().rev() {
                if let Branch::Traced(sent) = what {
                    open.push((sent, Some((number, branch))));
                }
            }
        }
    }
    list
}

/// The numbers of all shapes that rays met, were blocked by or went through.
pub fn shapes_of(rays: &[Listed<'_>]) -> Vec<u32> {
    let mut numbers = Vec::new();
    for met in rays.iter().filter_map(|ray| ray.node.meeting.as_ref()) {
        numbers.push(met.nearest.number);
        for term in &met.lights {
            match &term.shadow {
                Shadow::NotAsked => {}
                Shadow::Blocked { number, .. } => numbers.push(*number),
                Shadow::Crossed(crossings) => {
                    numbers.extend(crossings.iter().map(|(crossing, _)| crossing.number));
                }
            }
        }
    }
    numbers
}

/// Boxes and shapes that all rays of a tree were tested against.
pub fn tests_of(rays: &[Listed<'_>]) -> (u64, u64) {
    let (mut boxes, mut shapes) = (0, 0);
    for ray in rays {
        let terms = ray.node.meeting.iter().flat_map(|met| &met.lights).map(|term| term.tests);
        for tests in terms.chain([ray.node.tests]) {
            boxes += tests.boxes;
            shapes += tests.shapes;
        }
    }
    (boxes, shapes)
}

/// The bits of a colour.
pub fn bits(color: Vec3) -> [u64; 3] {
    color.to_array().map(f64::to_bits)
}

impl Explanation<'_> {
    /// Whether the terms of every ray add up to its colour, bit for bit.
    pub fn sums_agree(&self) -> bool {
        let agrees = |ray: &Listed<'_>| {
            ray.node.meeting.as_ref().is_none_or(|met| bits(met.sum()) == bits(ray.node.color))
        };
        self.rays.iter().all(agrees)
    }

    /// Whether the eye ray's colour is that of its sample, and the samples make what `render` stores, bit for bit;
    /// `None` where there is no pixel to compare with.
    pub fn pixel_agrees(&self) -> Option<bool> {
        let rendered = self.rendered?;
        let stored = self.sampling.mean.to_array().map(|x| (x as f32).to_bits());
        let sample = self.sampling.samples.get(self.chosen).map(|sample| bits(sample.color));
        let eye = self.rays.first().map(|ray| bits(ray.node.color));
        Some(stored == rendered.map(f32::to_bits) && sample == eye)
    }

    /// How a message names a shape.
    pub fn shape_name(&self, number: u32) -> String {
        match self.shapes.get(&number) {
            Some(place) => format!("{} {number} {}", place.kind, place.place),
            None => format!("shape {number}"),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use dotray::render::PrepareOptions;
    use dotray::scene::files::Disk;
    use dotray::scene::load::LoadOptions;
    use dotray::scene::load::load_text;
    use dotray::scene::resolve::resolve;

    const SCENE: &str = "#camera 0 0 4  0 0 -1  0 1 0  .5  #light_dir 1 1 1  0 -1 -1
        #material 1 1 1  1 1 1  .5 .5 .5  0 0 0  .5 0 1 -1 !!  #shape_sphere 0  0 0 0  1  #shape_sphere 0  0 2 2  1";

    /// The checks are worth something only if they can fail.
    #[test]
    fn a_term_that_is_off_by_a_bit_is_noticed() {
        let scene = load_text("t", SCENE, &Disk, &LoadOptions::default()).scene.expect("a scene");
        let resolved = resolve(scene).resolved.expect("it is sound");
        let world = World::prepare(resolved.clone(), &Disk, &PrepareOptions::default()).expect("a world");
        let options = Options { width: 8, height: 8, ..Options::default() };
        let sampling = sample_pixel(&world, &options, 4, 4);
        let camera = Camera::new(world.camera(), 8, 8);
        let ray = camera.ray(4.5, 4.5);
        let root = Tracer::new(&world, &options, level()).inspect(ray).expect("a tree");
        let rendered = sampling.mean.to_array().map(|x| x as f32);
        let told = |root: &RayNode, rendered: [f32; 3]| {
            let explanation = Explanation {
                scene: String::new(),
                options: &options,
                accelerator: "bvh",
                pixel: Some((4, 3)),
                sampling: sampling.clone(),
                chosen: 0,
                rays: listed(root),
                rendered: Some(rendered),
                world: &world,
                resolved: &resolved,
                shapes: BTreeMap::new(),
                lights: Vec::new(),
                visits: Vec::new(),
            };
            (explanation.sums_agree(), explanation.pixel_agrees())
        };
        assert_eq!(told(&root, rendered), (true, Some(true)));
        let mut off = root.clone();
        off.color.y = f64::from_bits(off.color.y.to_bits() + 1);
        assert_eq!(told(&off, rendered), (false, Some(false)));
        let mut off = root.clone();
        let Some(met) = &mut off.meeting else { panic!("the middle meets the ball") };
        met.own_light.x += 1e-9;
        assert_eq!(told(&off, rendered), (false, Some(true)));
        let [r, g, b] = rendered;
        assert_eq!(told(&root, [r, g, f32::from_bits(b.to_bits() + 1)]), (true, Some(false)));
    }
}
