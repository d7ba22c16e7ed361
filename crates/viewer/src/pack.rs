//! Shapes laid down as a GPU wants them: spheres, other round shapes and boxes as instances, triangles as vertices.
//! It is done once a scene; what is done a frame does not depend on the number of shapes.

use crate::tables::ViewFrame;
use dotray_geometry::Aabb;
use dotray_geometry::Affine;
use dotray_geometry::Mat3;
use dotray_geometry::OpenSide;
use dotray_geometry::Shape;
use dotray_geometry::Torus;
use dotray_geometry::Transform;
use dotray_geometry::Triangle;
use dotray_geometry::Vec2;
use dotray_geometry::Vec3;
use dotray_scene::Resolved;
use dotray_scene::bounds::world_bounds;
use dotray_scene::model::Color;
use dotray_scene::resolved::Run;
use dotray_scene::resolved::RunColors;
use rayon::prelude::*;
use std::ops::Range;

/// A sphere that stays one in the world, without texture.
#[derive(Clone, Copy, Debug, PartialEq, bytemuck::Pod, bytemuck::Zeroable)]
#[repr(C)]
pub struct Ball {
    /// Centre and radius.
    pub place: [f32; 4],
    /// The number of its material.
    pub material: u32,
}

/// A round shape or a box: the image of a unit shape.
#[derive(Clone, Copy, Debug, PartialEq, bytemuck::Pod, bytemuck::Zeroable)]
#[repr(C)]
pub struct Solid {
    /// The rows of `view_from_unit`.
    pub rows: [[f32; 4]; 3],
    /// The number of its material.
    pub material: u32,
    /// Which unit shape: see [`Unit`].
    pub unit: u32,
    /// The radii of what is round about y, below and above, the greater one 1.
    pub radii: [f32; 2],
    /// The number of its frame.
    pub frame: u32,
}

/// The unit shapes, each within -1 to 1 on all axes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(u32)]
pub enum Unit {
    /// A sphere.
    Sphere = 0,
    /// Round about y, with discs: a cylinder, or a cone whole or truncated.
    Round = 1,
    /// The same without discs.
    Open = 2,
    /// A box.
    Cuboid = 3,
}

/// A corner of a triangle.
#[derive(Clone, Copy, Debug, PartialEq, bytemuck::Pod, bytemuck::Zeroable)]
#[repr(C)]
pub struct Corner {
    /// The point.
    pub point: [f32; 3],
    /// The normal, folded into an octahedron: x in the lower half, y in the upper.
    pub normal: u32,
    /// (s, t)
    pub texcoord: [f32; 2],
    /// The number of its material.
    pub material: u32,
    /// The number of its frame; from [`COLORED`] on that of its colour in [`Packed::colors`], where the frame's is too.
    pub frame: u32,
}

/// See [`Corner::frame`].
pub const COLORED: u32 = 1 << 31;

/// So many corners have colours of their own at most: the others show their material's.
const MOST_COLORS: usize = 1 << 20;

/// Things of one kind that a GPU holds in one buffer.
#[derive(Clone, Debug, PartialEq)]
pub struct Batch<T> {
    /// The things.
    pub things: Vec<T>,
    /// The shape that each belongs to (each triangle, where they are corners), in rising order.
    pub numbers: Vec<u32>,
}

/// All shapes of a scene.
#[derive(Clone, Debug, PartialEq)]
pub struct Packed {
    /// The frame that they are laid down in.
    pub frame: ViewFrame,
    /// The box around all of them in the world.
    pub bounds: Aabb,
    /// Spheres.
    pub balls: Vec<Batch<Ball>>,
    /// Other round shapes.
    pub rounds: Vec<Batch<Solid>>,
    /// Boxes.
    pub boxes: Vec<Batch<Solid>>,
    /// Triangles.
    pub triangles: Vec<Batch<[Corner; 3]>>,
    /// The rows of `object_from_view` of each frame, where a material has 3-D textures or bumps: else nothing.
    pub frames: Vec<[[f32; 4]; 3]>,
    /// Colours of triangles' corners where they have some of their own: red, green, blue, and the number of the frame.
    pub colors: Vec<[f32; 4]>,
}

/// Bytes of a batch: GPUs refuse buffers of any size.
const BATCH_BYTES: usize = 64 << 20;

/// Appends to the last batch, or begins a new one.
fn put<T>(batches: &mut Vec<Batch<T>>, number: u32, thing: T) {
    let full = batches.last().is_none_or(|batch| (batch.things.len() + 1) * size_of::<T>() > BATCH_BYTES);
    if full {
        batches.push(Batch { things: Vec::new(), numbers: Vec::new() });
    }
    if let Some(batch) = batches.last_mut() {
        batch.things.push(thing);
        batch.numbers.push(number);
    }
}

/// Appends the batches of the shapes that follow.
fn append<T>(batches: &mut Vec<Batch<T>>, more: Vec<Batch<T>>) {
    for mut batch in more {
        let fits =
            |last: &&mut Batch<T>| (last.things.len() + batch.things.len()) * size_of::<T>() <= BATCH_BYTES;
        match batches.last_mut().filter(fits) {
            Some(last) => {
                last.things.append(&mut batch.things);
                last.numbers.append(&mut batch.numbers);
            }
            None => batches.push(batch),
        }
    }
}

/// A shape on its way.
struct Placed<'a> {
    number: u32,
    material: u32,
    frame: &'a Transform,
    frame_number: u32,
    /// Whether its colour depends on where on it one looks.
    textured: bool,
    /// Those of a triangle's corners.
    colors: Option<[Color; 3]>,
}

/// How many shapes one thread lays down at a time.
const PIECE: u32 = 1 << 14;

impl Packed {
    /// Lays down the shapes of a scene.
    pub fn new(resolved: &Resolved) -> Self {
        let bounds = world_bounds(resolved);
        let radius = bounds.size().length() / 2.0;
        let unit = if radius > 0.0 && radius.is_finite() { radius } else { 1.0 };
        let center = if bounds.is_empty() { Vec3::ZERO } else { bounds.center() };
        let frame = ViewFrame { center, unit };
        let mut packed = Self::nothing(frame, bounds);
        packed.frames = frames(resolved, &frame);
        let starts: Vec<u32> = (0..resolved.shape_count).step_by(PIECE as usize).collect();
        // A few pieces at a time, lest everything is there twice.
        for starts in starts.chunks(4 * rayon::current_num_threads().max(1)) {
            let piece = |start: &u32| {
                let mut piece = Self::nothing(frame, bounds);
                let shapes = *start..start.saturating_add(PIECE).min(resolved.shape_count);
                let first = resolved.runs.partition_point(|run| run.first_shape + run.count <= shapes.start);
                let runs = resolved.runs.iter().skip(first);
                runs.take_while(|run| run.first_shape < shapes.end)
                    .for_each(|run| piece.run(resolved, run, &shapes));
                piece
            };
            let pieces: Vec<Self> = starts.par_iter().map(piece).collect();
            pieces.into_iter().for_each(|piece| packed.append(piece));
        }
        packed
    }

    fn nothing(frame: ViewFrame, bounds: Aabb) -> Self {
        let (balls, rounds, boxes, triangles, frames, colors) = Default::default();
        Self { frame, bounds, balls, rounds, boxes, triangles, frames, colors }
    }

    fn append(&mut self, mut piece: Self) {
        self.take_colors(&mut piece);
        append(&mut self.balls, piece.balls);
        append(&mut self.rounds, piece.rounds);
        append(&mut self.boxes, piece.boxes);
        append(&mut self.triangles, piece.triangles);
    }

    /// The colours of the shapes that follow; where there are too many, their corners do without.
    fn take_colors(&mut self, piece: &mut Self) {
        if piece.colors.is_empty() {
            return;
        }
        let first = self.colors.len();
        let fits = first + piece.colors.len() <= MOST_COLORS;
        for corner in piece.triangles.iter_mut().flat_map(|batch| &mut batch.things).flatten() {
            if let Some(color) = corner.frame.checked_sub(COLORED) {
                let frame = piece.colors.get(color as usize).map_or(0, |color| color[3] as u32);
                corner.frame = if fits { corner.frame + first as u32 } else { frame };
            }
        }
        if fits {
            self.colors.append(&mut piece.colors);
        }
    }

    /// Lays down those shapes of a run that are among `shapes`.
    fn run(&mut self, resolved: &Resolved, run: &Run, shapes: &Range<u32>) {
        let file = resolved.files.get(run.file.0 as usize);
        let frame = resolved.transform(run.frame);
        let (Some(file), Some(frame)) = (file, frame) else { return };
        let frame = &frame;
        let written = file.shape_materials(run.kind);
        let end = (shapes.end - run.first_shape).min(run.count);
        for within in shapes.start.saturating_sub(run.first_shape)..end {
            let entry = (run.first + within) as usize;
            let material = resolved.material_index(run, written.get(entry).copied().unwrap_or(-1));
            let textured = resolved
                .materials
                .get(material as usize)
                .is_some_and(|m| m.texture.is_some() || !m.procedural.is_empty());
            if let Some(shape) = file.shape(run.kind, entry) {
                let number = run.first_shape + within;
                let colors = match run.colors {
                    RunColors::Vertices => file.corner_colors(entry),
                    // No file has them.
                    RunColors::No | RunColors::Shapes { .. } => None,
                };
                let frame_number = run.frame;
                self.shape(&shape, &Placed { number, material, frame, frame_number, textured, colors });
            }
        }
    }

    fn shape(&mut self, shape: &Shape, placed: &Placed<'_>) {
        let similar = placed.frame.similarity_scale();
        match (shape, similar) {
            (Shape::Sphere(sphere), Some(scale)) if !placed.textured => {
                let center = placed.frame.world_from_object.transform_point3(sphere.center());
                let place = self.frame.point(center).extend(sphere.radius() * scale / self.frame.unit);
                let place = place.to_array().map(|x| x as f32);
                put(&mut self.balls, placed.number, Ball { place, material: placed.material });
            }
            (Shape::Sphere(sphere), Some(_) | None) => {
                self.solid(Unit::Sphere, sphere.center(), Vec3::splat(sphere.radius()), [1.0; 2], placed);
            }
            (Shape::Cuboid(cuboid), _) => {
                self.solid(Unit::Cuboid, cuboid.center(), cuboid.size() / 2.0, [1.0; 2], placed);
            }
            (Shape::Cylinder(c), _) => {
                self.round(Unit::Round, c.center(), c.height(), [c.radius(); 2], placed);
            }
            (Shape::Cone(c), _) => {
                self.round(Unit::Round, c.center(), c.height(), [c.radius(), c.top()], placed);
            }
            (Shape::Open(OpenSide::Cylinder(c)), _) => {
                self.round(Unit::Open, c.center(), c.height(), [c.radius(); 2], placed);
            }
            (Shape::Open(OpenSide::Cone(c)), _) => {
                self.round(Unit::Open, c.center(), c.height(), [c.radius(), c.top()], placed);
            }
            (Shape::Triangle(triangle), _) => self.triangle(triangle, placed),
            (Shape::Torus(torus), _) => self.torus(torus, placed),
        }
    }

    fn round(&mut self, unit: Unit, center: Vec3, height: f64, radii: [f64; 2], placed: &Placed<'_>) {
        let widest = radii[0].max(radii[1]);
        let half = Vec3::new(widest, height / 2.0, widest);
        self.solid(unit, center, half, radii.map(|radius| (radius / widest) as f32), placed);
    }

    fn solid(&mut self, unit: Unit, center: Vec3, half: Vec3, radii: [f32; 2], placed: &Placed<'_>) {
        let object_from_unit = Affine::from_mat3_translation(Mat3::from_diagonal(half), center);
        let world_from_unit = placed.frame.world_from_object * object_from_unit;
        let m = world_from_unit.matrix3 * self.frame.unit.recip();
        let t = self.frame.point(world_from_unit.translation);
        let row = |at: usize, t: f64| m.row(at).extend(t).to_array().map(|x| x as f32);
        let rows = [row(0, t.x), row(1, t.y), row(2, t.z)];
        let solid =
            Solid { rows, material: placed.material, unit: unit as u32, radii, frame: placed.frame_number };
        let list = if unit == Unit::Cuboid { &mut self.boxes } else { &mut self.rounds };
        put(list, placed.number, solid);
    }

    fn triangle(&mut self, triangle: &Triangle, placed: &Placed<'_>) {
        let [a, b, c] = triangle.vertices();
        let face = (*b - *a).cross(*c - *a);
        let texcoords = triangle.texcoords();
        let normals = triangle.normals().map(|normal| if normal == Vec3::ZERO { face } else { normal });
        let corner = |point: Vec3, normal, texcoord| self.corner(point, normal, texcoord, placed);
        let mut corners = [
            corner(*a, normals[0], texcoords[0]),
            corner(*b, normals[1], texcoords[1]),
            corner(*c, normals[2], texcoords[2]),
        ];
        for (corner, color) in corners.iter_mut().zip(placed.colors.iter().flatten()) {
            corner.frame = COLORED + self.colors.len() as u32;
            self.colors.push(color.extend(f64::from(placed.frame_number)).to_array().map(|x| x as f32));
        }
        put(&mut self.triangles, placed.number, corners);
    }

    fn corner(&self, point: Vec3, normal: Vec3, texcoord: Vec2, placed: &Placed<'_>) -> Corner {
        let world = placed.frame.world_from_object.transform_point3(point);
        Corner {
            point: self.frame.point(world).to_array().map(|x| x as f32),
            normal: folded(placed.frame.world_normal(normal.normalize())),
            texcoord: texcoord.to_array().map(|x| x as f32),
            material: placed.material,
            frame: placed.frame_number,
        }
    }

    /// A torus as triangles: only some dialects have it, and few scenes have many.
    fn torus(&mut self, torus: &Torus, placed: &Placed<'_>) {
        const AROUND: u32 = 64;
        const ACROSS: u32 = 32;
        let corner = |i: u32, j: u32| {
            let (s, t) = (f64::from(i) / f64::from(AROUND), f64::from(j) / f64::from(ACROSS));
            let (u, v) = (s * std::f64::consts::TAU, t * std::f64::consts::TAU);
            let out = Vec3::new(libm::sin(u), 0.0, libm::cos(u));
            let normal = out * libm::cos(v) + Vec3::Y * libm::sin(v);
            let point = torus.center() + out * torus.ring() + normal * torus.tube();
            self.corner(point, normal, Vec2::new(s + 0.5, 0.5 - t), placed)
        };
        let mut corners = Vec::new();
        for i in 0..AROUND {
            for j in 0..ACROSS {
                let [a, b, c, d] = [corner(i, j), corner(i + 1, j), corner(i + 1, j + 1), corner(i, j + 1)];
                corners.extend([[a, b, c], [a, c, d]]);
            }
        }
        corners.into_iter().for_each(|corners| put(&mut self.triangles, placed.number, corners));
    }

    /// The box around some shapes in the world; it looks at those shapes only.
    pub fn bounds_of(&self, shapes: Range<u32>) -> Aabb {
        let mut bounds = Aabb::EMPTY;
        let mut grow = |point: Vec3| bounds = bounds.grown(point * self.frame.unit + self.frame.center);
        for_each(&self.balls, &shapes, |ball| {
            let [x, y, z, r] = ball.place.map(f64::from);
            grow(Vec3::new(x - r, y - r, z - r));
            grow(Vec3::new(x + r, y + r, z + r));
        });
        for solids in [&self.rounds, &self.boxes] {
            for_each(solids, &shapes, |solid| solid_corners(solid).into_iter().for_each(&mut grow));
        }
        for_each(&self.triangles, &shapes, |corners| {
            corners.iter().for_each(|corner| grow(Vec3::from_array(corner.point.map(f64::from))));
        });
        bounds
    }
}

/// The frames as the shader wants them; nothing where no material asks for places in object space.
fn frames(resolved: &Resolved, view: &ViewFrame) -> Vec<[[f32; 4]; 3]> {
    if resolved.materials.iter().all(|material| material.procedural.is_empty()) {
        return Vec::new();
    }
    let rows = |frame: Transform| {
        let object_from_world = &frame.object_from_world;
        let m = object_from_world.matrix3 * view.unit;
        let t = object_from_world.transform_point3(view.center);
        let row = |at: usize, t: f64| m.row(at).extend(t).to_array().map(|x| x as f32);
        [row(0, t.x), row(1, t.y), row(2, t.z)]
    };
    (0..resolved.frames.len() as u32).filter_map(|number| resolved.transform(number)).map(rows).collect()
}

/// What stands somewhere in the view's frame.
pub trait Bounded {
    /// The corners of a box around it, the lower and the upper one.
    fn corners(&self) -> [glam::Vec3; 2];
}

impl Bounded for Ball {
    fn corners(&self) -> [glam::Vec3; 2] {
        let [x, y, z, r] = self.place;
        let center = glam::Vec3::new(x, y, z);
        [center - r, center + r]
    }
}

impl Bounded for Solid {
    fn corners(&self) -> [glam::Vec3; 2] {
        let center = glam::Vec3::from_array(self.rows.map(|row| row[3]));
        let reach = glam::Vec3::from_array(self.rows.map(|[x, y, z, _]| x.abs() + y.abs() + z.abs()));
        [center - reach, center + reach]
    }
}

impl Bounded for [Corner; 3] {
    fn corners(&self) -> [glam::Vec3; 2] {
        let [a, b, c] = self.map(|corner| glam::Vec3::from_array(corner.point));
        [a.min(b).min(c), a.max(b).max(c)]
    }
}

fn for_each<T>(batches: &[Batch<T>], shapes: &Range<u32>, mut visit: impl FnMut(&T)) {
    for batch in batches {
        let first = batch.numbers.partition_point(|&number| number < shapes.start);
        let end = batch.numbers.partition_point(|&number| number < shapes.end).max(first);
        batch.things.get(first..end).unwrap_or_default().iter().for_each(&mut visit);
    }
}

fn solid_corners(solid: &Solid) -> [Vec3; 8] {
    let [x, y, z] = solid.rows.map(|row| row.map(f64::from));
    std::array::from_fn(|corner| {
        let sign = |bit: usize| if corner >> bit & 1 == 1 { 1.0 } else { -1.0 };
        let unit = [sign(0), sign(1), sign(2)];
        let along = |row: [f64; 4]| row[0] * unit[0] + row[1] * unit[1] + row[2] * unit[2] + row[3];
        Vec3::new(along(x), along(y), along(z))
    })
}

/// A unit vector on an octahedron whose lower half is folded up, as two 16-bit numbers (Cigolle et al., 'A survey of
/// efficient representations for independent unit vectors', JCGT 2014).
fn folded(normal: Vec3) -> u32 {
    let p = normal / (normal.x.abs() + normal.y.abs() + normal.z.abs()).max(f64::MIN_POSITIVE);
    let sign = |x: f64| if x < 0.0 { -1.0 } else { 1.0 };
    let (x, y) =
        if p.z < 0.0 { ((1.0 - p.y.abs()) * sign(p.x), (1.0 - p.x.abs()) * sign(p.y)) } else { (p.x, p.y) };
    let bits = |x: f64| u32::from((x.clamp(-1.0, 1.0) * 32767.0).round() as i16 as u16);
    bits(x) | bits(y) << 16
}

#[cfg(test)]
mod tests {
    use super::*;
    use dotray_scene::files::Disk;
    use dotray_scene::load::LoadOptions;
    use dotray_scene::load::load_text;
    use dotray_scene::resolve::resolve;

    fn packed(text: &str) -> Packed {
        let scene = load_text("t.ray", text, &Disk, &LoadOptions::default()).scene.expect("a scene");
        Packed::new(&resolve(scene).resolved.expect("resolved"))
    }

    fn unfolded(bits: u32) -> Vec3 {
        let part = |bits: u32| f64::from(bits as u16 as i16) / 32767.0;
        let (x, y) = (part(bits), part(bits >> 16));
        let z = 1.0 - x.abs() - y.abs();
        let fold = (-z).max(0.0);
        Vec3::new(x - x.signum() * fold, y - y.signum() * fold, z).normalize()
    }

    #[test]
    fn pieces_come_together_in_their_order() {
        // More shapes than a piece has, in runs of odd lengths.
        let mut text = String::new();
        for k in 0..40_000_u32 {
            text += &match k % 7 {
                0 => format!("#shape_box -1 {k} 0 0 1 1 1\n"),
                1 | 2 => format!("#shape_cone -1 {k} 0 0 1 1\n"),
                _ => format!("#shape_sphere -1 {k} 0 0 1\n"),
            };
        }
        let packed = packed(&text);
        let (balls, boxes) = (&packed.balls[0], &packed.boxes[0]);
        let wanted = |kinds: &[u32]| (0..40_000).filter(|k| kinds.contains(&(k % 7))).collect::<Vec<u32>>();
        assert_eq!((packed.balls.len(), packed.boxes.len(), packed.rounds.len()), (1, 1, 1));
        assert_eq!((&boxes.numbers, &balls.numbers), (&wanted(&[0]), &wanted(&[3, 4, 5, 6])));
        assert_eq!(packed.rounds[0].numbers, wanted(&[1, 2]));
        let x = |number: u32| packed.frame.point(Vec3::X * f64::from(number)).x as f32;
        assert!(balls.things.iter().zip(&balls.numbers).all(|(ball, number)| ball.place[0] == x(*number)));
    }

    #[test]
    fn normals_survive_folding() {
        for x in -3..=3 {
            for (y, z) in (-3..=3).flat_map(|y| (-3..=3).map(move |z| (y, z))) {
                let normal = Vec3::new(f64::from(x), f64::from(y) + 0.1, f64::from(z)).normalize();
                assert!((unfolded(folded(normal)) - normal).length() < 1e-4, "{normal}");
            }
        }
    }

    #[test]
    fn kinds_go_where_they_are_drawn_and_keep_their_numbers() {
        let text = "#shape_sphere -1 0 0 0 1
            #group_begin 2 0 0 10  0 1 0 0  0 0 1 0  0 0 0 1
              #shape_sphere -1 0 0 0 1
              #shape_box -1 0 0 0 2 4 6
              #shape_cylinder -1 0 5 0 1 2
            #group_end
            #group_begin 3 0 0 0  0 3 0 0  0 0 3 0  0 0 0 1
              #shape_sphere -1 1 0 0 1
              #shape_triangle -1 0 0 0 1 0 0 0 1 0  0 0 0 0 0 0 0 0 0  0 0 1 0 0 1
            #group_end";
        let packed = packed(text);
        let numbers = |list: &[Batch<Solid>]| list.iter().flat_map(|b| b.numbers.clone()).collect::<Vec<_>>();
        assert_eq!(packed.balls[0].numbers, [0, 4]);
        assert_eq!((numbers(&packed.rounds), numbers(&packed.boxes)), (vec![1, 3], vec![2]));
        assert_eq!(packed.triangles[0].numbers, [5]);
        assert_eq!(packed.rounds[0].things.iter().map(|s| s.unit).collect::<Vec<_>>(), [0, 1]);
        let near = |a: Aabb, min: [f64; 3], max: [f64; 3]| {
            let [min, max] = [min, max].map(Vec3::from_array);
            assert!((a.min - min).length() + (a.max - max).length() < 1e-5, "{a:?}");
        };
        near(packed.bounds_of(0..1), [-1.0; 3], [1.0; 3]);
        near(packed.bounds_of(1..2), [8.0, -1.0, -1.0], [12.0, 1.0, 1.0]);
        near(packed.bounds_of(2..3), [8.0, -2.0, -3.0], [12.0, 2.0, 3.0]);
        near(packed.bounds_of(3..4), [8.0, 4.0, -1.0], [12.0, 6.0, 1.0]);
        near(packed.bounds_of(4..5), [0.0, -3.0, -3.0], [6.0, 3.0, 3.0]);
        near(packed.bounds_of(5..6), [0.0; 3], [3.0, 3.0, 0.0]);
        assert!(packed.bounds_of(2..2).is_empty());
    }

    #[test]
    fn places_are_relative_to_the_scene() {
        let packed = packed("#shape_sphere -1 1e9 0 0 1 #shape_sphere -1 1000000004 0 0 1");
        let [a, b] = [packed.balls[0].things[0].place, packed.balls[0].things[1].place];
        // Two units of radius 1, 4 apart: the scene's half diagonal is √11.
        let unit = 11f64.sqrt();
        assert!((f64::from(b[0] - a[0]) - 4.0 / unit).abs() < 1e-5, "{a:?} {b:?}");
        assert!((f64::from(a[3]) - 1.0 / unit).abs() < 1e-5);
    }
}
