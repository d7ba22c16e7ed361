//! Shapes in groups: what they take at rest, and that they come back as they were written.

use dotray_accel::Queries;
use dotray_geometry::Ray;
use dotray_geometry::Vec3;
use dotray_render::Caster;
use dotray_render::PrepareOptions;
use dotray_render::Textures;
use dotray_render::World;
use dotray_scene::Resolved;
use dotray_scene::files::Disk;
use dotray_scene::load::LoadOptions;
use dotray_scene::load::load_text;
use dotray_scene::model::ShapeList;
use dotray_scene::resolve::resolve;
use std::fmt::Write;

const HEAD: &str = "#camera 0 0 9 0 0 -1 0 1 0 0.5\n#material_num 2\n\
    #material 1 1 1 1 1 1 0 0 0 0 0 0 0 0 1 -1 !!\n#material 1 0 0 1 0 0 0 0 0 0 0 0 0 0 1 -1 !!\n";

fn resolved(text: &str) -> Resolved {
    let scene = load_text("groups.ray", text, &Disk, &LoadOptions::default()).scene.expect("a scene");
    resolve(scene).resolved.expect("resolved")
}

/// Numbers that look random, by the finaliser of splitmix64 (Steele, Lea, Flood, OOPSLA 2014): from -1 to 1.
fn random(state: &mut u64) -> f64 {
    *state = state.wrapping_add(0x9e37_79b9_7f4a_7c15);
    let mut hash = *state;
    hash = (hash ^ (hash >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    hash = (hash ^ (hash >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    ((hash ^ (hash >> 31)) >> 11) as f64 / (1_u64 << 52) as f64 - 1.0
}

/// A group that turns by two random angles, scales evenly and moves, written as text does it.
fn turned_group(state: &mut u64) -> String {
    let (s, c) = libm::sincos(4.0 * random(state));
    let (t, d) = libm::sincos(4.0 * random(state));
    let scale = 1.5 + random(state);
    let rows = [[c, -s * d, s * t], [s, c * d, -c * t], [0.0, t, d]];
    let mut group = "#group_begin".to_owned();
    for row in rows {
        let [x, y, z] = row.map(|number| number * scale);
        let _ = write!(group, " {x} {y} {z} {}", 100.0 * random(state));
    }
    group + " 0 0 0 1\n"
}

/// As many groups, each with one shape in it.
fn one_by_one(count: usize, shape: &str) -> String {
    let mut state = 1;
    let mut text = HEAD.to_owned();
    for _ in 0..count {
        text += &turned_group(&mut state);
        text += shape;
        text += "\n#group_end\n";
    }
    text
}

/// So many shapes alone in their groups are held with their matrices; few are held ready for rays.
const MANY: usize = 24_000;

/// The bytes a shape at rest, tree and all.
fn bytes_a_shape(text: &str) -> u64 {
    let caster = Caster::build(resolved(text), &PrepareOptions::default());
    caster.memory() / caster.shape_count() as u64
}

#[test]
fn a_shape_alone_in_its_group_takes_few_bytes() {
    let count = MANY;
    // What they take now, and one byte in a hundred for spills and chance.
    for (shape, most) in [
        ("#shape_cylinder 0 0 0 0 0.2 1", 148),
        ("#shape_cone 1 0 0 0 0.2 1", 148),
        ("#shape_box -1 0 0 0 1 0.2 3", 149),
        ("#shape_sphere 0 0 0 0 0.2", 125),
    ] {
        let bytes = bytes_a_shape(&one_by_one(count, shape));
        assert!(bytes <= most, "{shape}: {bytes} bytes");
    }
    // Two more numbers a shape, where there is anything else.
    let mixed = one_by_one(count, "#shape_cylinder 0 0 0 0 0.2 1") + "#shape_box 0 0 -9 0 50 1 50\n";
    assert!(bytes_a_shape(&mixed) <= 190, "{} bytes", bytes_a_shape(&mixed));
    // Where it does not stand about the origin.
    let aside = one_by_one(count, "#shape_cylinder 0 1 2 3 0.2 1");
    assert!(bytes_a_shape(&aside) <= 206, "{} bytes", bytes_a_shape(&aside));
}

/// Spheres in no group, their numbers as text that a number of single precision is written as, or any.
fn spheres(count: usize, narrow: bool) -> String {
    let mut state = 3;
    let mut text = HEAD.to_owned();
    for _ in 0..count {
        let [x, y, z] = [(); 3].map(|()| 100.0 * random(&mut state));
        let _ = match narrow {
            true => writeln!(
                text,
                "#shape_sphere 0 {} {} {} 0.5",
                x as f32 as f64, y as f32 as f64, z as f32 as f64
            ),
            false => writeln!(text, "#shape_sphere 0 {x} {y} {z} 0.5"),
        };
    }
    text
}

#[test]
fn a_sphere_takes_few_bytes_and_fewer_in_single_precision() {
    let count = 20_000;
    for (narrow, most) in [(true, 52), (false, 68)] {
        let bytes = bytes_a_shape(&spheres(count, narrow));
        assert!(bytes <= most, "{bytes} bytes, narrow: {narrow}");
    }
    let one_more = spheres(count, true) + "#shape_sphere 0 0.1 0 0 1\n";
    assert!(bytes_a_shape(&one_more) > 60, "one sphere in double precision needs it for all");
}

/// Shapes of all kinds: alone in groups, together in one, in none.
fn all_sorts(count: usize) -> String {
    let mut state = 5;
    let mut text = HEAD.to_owned();
    let shapes = [
        "#shape_cylinder 0 0 0 0 0.2 1",
        "#shape_cylinder 1 0 -0 0 0.2 1",
        "#shape_cone -1 0 0 0 0.2 1",
        "#shape_cone 1 0.5 0 0 0.2 1",
        "#shape_box -1 0 0 0 1 0.2 3",
        "#shape_box 1 0 3 0 1 0.2 0",
        "#shape_sphere 0 0 0 0 0.2",
        "#shape_sphere 1 0 7 0 0.3",
    ];
    for index in 0..count {
        let shape = shapes[index / 3 % shapes.len()];
        let other = shapes[index % 7];
        match index % 11 {
            0 => text += "#group_begin 1 0.5 0 3 0 1 0 0 0 0 2 1 0 0 0 1\n",
            1 => text += "#group_begin 2 0 0 3 0 1 0 0 0 0 1 1 0 0 0 1\n",
            2 => text += "#group_begin 1 0 0 3 0 1 0 0 0 0 -1 1 0 0 0 1\n",
            _ => text += &turned_group(&mut state),
        }
        text += shape;
        if index % 10 == 9 {
            let _ = write!(text, "\n{other}\n{}{shape}\n#group_end\n{other}", turned_group(&mut state));
        }
        text += "\n#group_end\n";
        if index % 17 == 16 {
            text = text + other + "\n";
        }
    }
    text
}

/// Bit by bit: zeros have signs.
fn same<T: std::fmt::Debug>(again: &ShapeList<T>, written: &ShapeList<T>) {
    assert_eq!(format!("{:?}", again.shapes), format!("{:?}", written.shapes));
    assert_eq!(again.materials, written.materials);
}

#[test]
fn what_was_written_comes_back() {
    let spheres = spheres(500, true);
    let mixed = spheres.clone() + "#shape_sphere 0 0.1 0 0 1\n#shape_sphere 0 -0.0 0 0 1\n";
    for text in
        [one_by_one(MANY, "#shape_cone 0 0 0 0 0.2 1"), all_sorts(300), all_sorts(MANY), spheres, mixed]
    {
        let written = resolved(&text);
        let mut rest = written.clone();
        (rest.runs, rest.frames) = (Vec::new(), Vec::new());
        rest.files.iter_mut().for_each(|file| *file = Default::default());
        let options = PrepareOptions::default();
        let world = World::build(written.clone(), Textures::default(), &options).expect("a world");
        let (again, _) = world.take_apart(rest);
        assert_eq!(again.runs, written.runs);
        assert_eq!(format!("{:?}", again.frames), format!("{:?}", written.frames));
        for (again, written) in again.files.iter().zip(&written.files) {
            same(&again.spheres, &written.spheres);
            same(&again.cuboids, &written.cuboids);
            same(&again.cylinders, &written.cylinders);
            same(&again.cones, &written.cones);
        }
    }
}

#[test]
fn shapes_are_met_alike_whether_there_are_few_or_many() {
    let few = all_sorts(2000);
    let far = one_by_one(MANY, "#shape_cylinder 0 0 0 0 0.2 1");
    let far = far.strip_prefix(HEAD).expect("the head");
    let many = format!("{few}#group_begin 1 0 0 9000 0 1 0 0 0 0 1 0 0 0 0 1\n{far}#group_end\n");
    let [few, many] = [few, many].map(|text| Caster::build(resolved(&text), &PrepareOptions::default()));
    let mut state = 7;
    // Towards the middle, where the shapes lie, and past it: nothing of what is far away is on these ways.
    let mut point = |size: f64| Vec3::new(random(&mut state), random(&mut state), random(&mut state)) * size;
    let rays: Vec<Ray> = (0..40_000)
        .map(|_| (point(200.0), point(60.0)))
        .map(|(a, b)| Ray::new(a, (b - a).normalize()))
        .collect();
    let queries = Queries { rays: &rays, t_min: &[0.0], t_max: &[500.0] };
    for together in [false, true] {
        let hits = few.nearest(&queries, together);
        assert!(hits.iter().flatten().count() > 2000, "{}", hits.iter().flatten().count());
        for (few, many) in hits.iter().zip(many.nearest(&queries, together)) {
            assert_eq!(few.map(|hit| (hit.number, hit.hit)), many.map(|hit| (hit.number, hit.hit)));
        }
    }
}
