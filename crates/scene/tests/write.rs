//! Writing: the canonical text, and that reading it back gives the same file.

use dotray_geometry::Affine;
use dotray_geometry::Cone;
use dotray_geometry::Cuboid;
use dotray_geometry::Cylinder;
use dotray_geometry::Mat4;
use dotray_geometry::Sphere;
use dotray_geometry::Transform;
use dotray_geometry::Triangle;
use dotray_geometry::Vec2;
use dotray_geometry::Vec3;
use dotray_scene::files::Files;
use dotray_scene::load::LoadOptions;
use dotray_scene::load::load_text;
use dotray_scene::model::Attenuation;
use dotray_scene::model::Camera;
use dotray_scene::model::Include;
use dotray_scene::model::Item;
use dotray_scene::model::Light;
use dotray_scene::model::Material;
use dotray_scene::model::Placed;
use dotray_scene::model::SceneFile;
use dotray_scene::model::ShapeKind;
use dotray_scene::model::ShapeList;
use dotray_scene::model::Vertex;
use dotray_scene::span::FileId;
use dotray_scene::span::Span;
use dotray_scene::write::write;
use proptest::collection::vec;
use proptest::option;
use proptest::prelude::*;
use std::io;
use std::path::Path;

/// Every included file is there and says little.
struct Parts;

impl Files for Parts {
    fn read(&self, _: &Path) -> io::Result<Vec<u8>> {
        Ok(b"#ambient 0 0 0\n".to_vec())
    }
}

fn read(text: &str) -> SceneFile {
    let loaded = load_text("main.ray", text, &Parts, &LoadOptions::default());
    let Some(scene) = loaded.scene else { panic!("{:#?}\n{text}", loaded.diagnostics) };
    scene.files.into_iter().next().unwrap().without_places()
}

#[test]
fn the_canonical_text() {
    let text = "\
#camera 0 0 4 0 0 -1 0 1 0 0.523
#background 0.1 0.2 0.3
#ambient 1e-7 2 1e20
#light_num 4
#light_point 1 1 1 2 3 4 1 0 0.5
#light_spot 1 1 1 2 3 4 0 -1 0 1 0 0.5 0.25 0.125
#light_dir 1 1 1 0 -1 0
#light_area 1 1 1 2 3 4 0 -1 0 0.75 1 0 0.5
#texture_num 2
#texture a.bmp
#texture \"two words.bmp\"
#material_num 2
#material 0.1 0.2 0.3 0.4 0.5 0.6 0.7 0.8 0.9 1 1.1 1.2 0.5 0.25 1.5 1 !wood scale=2; by the yard!
#material 0 0 0 0 0 0 0 0 0 0 0 0 0 0 1 -1 !!
#vertex_num 3
#vertex 0 0 0 0 0 1 0 0
#vertex 1 0 0 0 0 1 1 0
#vertex 0 1 0 0 0 1 0 1
#ray_file part.ray
#shape_sphere 0 1 2 3 4
#group_begin  1 0 0 -3  0 1 0 0  0 0 1 0  0 0 0 1
  #shape_box -1 0 0 0 1 1.1 0
  #shape_box 1 0 0 0 1 1.1 1.2
  #group_begin  0 -2 0 0.1  2 0 0 0.2  0 0 2 0.3  0 0 0 1
    #shape_cylinder 0 0 0 0 1 1.4
    #shape_cone 0 0 -2.1 0 1.71 0.62
    #shape_cone 0 0 -2.1 0 1.71 0.62 0.5
    #shape_side 0 0 1 2 1.5 3
    #shape_side 0 0 1 2 1.5 3 0
    #shape_side 0 0 1 2 1.5 3 0.25
    #ray_file_instance 0
  #group_end
  #shape_triangle 0  0 -1 0  1 1 -0.2  -1 0.85 0.11  0 0 1  0 0 1  0 0 0  0.5 0  1 1  0 1
#group_end
#shape_triangle 1 2 0 1
";
    assert_eq!(write(&read(text)), text);
}

#[test]
fn bump_images_and_colours_of_vertices_are_written_as_they_were_read() {
    let of_hmc = "\
#version HMCCS155FALL2002
#camera 0 0 6 0 0 -1 0 1 0 30
#material -n m0 -t a.bmp -u b.bmp --  0 0 0 1 1 1 0 0 0 0 0 0 0 0 1
#material -n m1 -u \"two words.bmp\" --  0 0 0 1 1 1 0 0 0 0 0 0 0 0 1
#material -n m2 -t c.bmp --  0 0 0 1 1 1 0 0 0 0 0 0 0 0 1
#sphere -m m0 -t -u 10 --  0 0 0 1
#box -m m1 -u -0.5 --  0 0 0 1 1 1
#sphere -m m2 -t --  3 0 0 1
#rayfile_end
";
    assert_eq!(write(&read(of_hmc)), of_hmc);
    // What is used in several ways becomes several materials, which stay what they are.
    let mixed =
        of_hmc.replace("#rayfile_end", "#sphere -m m0 -u 2 -- 1 1 1 1 #sphere -m m0 -t d.bmp -- 2 2 2 1");
    let once = read(&mixed);
    assert_eq!(read(&write(&once)), once);
    let of_unisa = "\
#shader \"none\" \"VertexColour\"
#camera 0 0 6 0 0 -1 0 1 0 30
#vertex_num 3
#vertex 0 0 0 0 0 1 0 0 0.5 0.25 1
#vertex 1 0 0 0 0 1 1 0
#vertex 0 1 0 0 0 1 0 1 0 0 0
#shape_triangle -1 0 1 2
";
    assert_eq!(write(&read(of_unisa)), of_unisa);
}

#[test]
fn an_empty_file_is_still_a_scene() {
    assert_eq!(write(&SceneFile::default()), "#light_num 0\n");
    assert_eq!(read("#light_num 0\n").items, []);
}

#[test]
fn names_are_quoted_where_they_must_be() {
    for (name, written) in [
        ("a.bmp", "a.bmp"),
        ("a/b\\c-d!e#f.bmp", "a/b\\c-d!e#f.bmp"),
        ("it\"s.bmp", "it\"s.bmp"),
        ("two words", "\"two words\""),
        ("a\tb", "\"a\tb\""),
        ("#a", "\"#a\""),
        ("!a!", "\"!a!\""),
        ("//server/a.bmp", "\"//server/a.bmp\""),
        ("/*a*/", "\"/*a*/\""),
        ("a//b/*c", "a//b/*c"),
        ("größe\u{a0}\".bmp", "größe\u{a0}\".bmp"),
    ] {
        let value = name.to_owned();
        let file =
            SceneFile { textures: vec![Placed { value, span: Span::default() }], ..SceneFile::default() };
        let text = write(&file);
        assert_eq!(text, format!("#texture_num 1\n#texture {written}\n"));
        assert_eq!(read(&text).textures, file.textures);
    }
}

#[test]
fn what_no_text_can_hold_loses_its_signs() {
    let value = "a\" b".to_owned();
    let file = SceneFile { textures: vec![Placed { value, span: Span::default() }], ..SceneFile::default() };
    assert_eq!(write(&file), "#texture_num 1\n#texture \"a b\"\n");
}

#[test]
fn deep_nesting_stays_linear() {
    let mut file = SceneFile::default();
    for number in 0..100_000 {
        file.items.push(Item::Open(number));
        file.groups.push(Placed { value: Mat4::IDENTITY, span: Span::default() });
    }
    file.items.extend(vec![Item::Close; 100_000]);
    let text = write(&file);
    assert!(text.len() < 200_000 * 130, "{}", text.len());
    assert_eq!(read(&text).items, file.items);
}

/// One directive of the tree; its numbers are taken modulo what there is.
#[derive(Clone, Debug)]
enum Step {
    Open(Mat4),
    Close,
    Instance(u32),
    Sphere(Sphere, i32),
    Cuboid(Cuboid, i32),
    Cylinder(Cylinder, i32),
    Cone(Cone, i32),
    Triangle(Box<Triangle>, i32),
    Indexed([u32; 3], i32),
}

fn number() -> impl Strategy<Value = f64> {
    prop_oneof![
        (-100_i32..100).prop_map(|n| f64::from(n) / 8.0),
        -10.0..10.0,
        prop::num::f64::NORMAL | prop::num::f64::SUBNORMAL | prop::num::f64::ZERO | prop::num::f64::NEGATIVE,
    ]
}

fn any3() -> impl Strategy<Value = Vec3> {
    [number(), number(), number()].prop_map(Vec3::from)
}

fn near3() -> impl Strategy<Value = Vec3> {
    [-10.0..10.0, -10.0..10.0, -10.0..10.0].prop_map(Vec3::from)
}

fn direction() -> impl Strategy<Value = Vec3> {
    near3().prop_filter("a direction has a length", |v| v.length() > 0.1)
}

fn positive() -> impl Strategy<Value = f64> {
    prop_oneof![0.001..1000.0, 1e-30..1e-20, 1e20..1e30]
}

fn camera() -> impl Strategy<Value = Camera> {
    let parts = (any3(), direction(), direction(), 0.01..1.57);
    let parts =
        parts.prop_filter("not parallel", |(_, direction, up, _)| direction.cross(*up).length() > 0.1);
    parts.prop_map(|(position, direction, up, half_angle)| Camera { position, direction, up, half_angle })
}

fn attenuation() -> impl Strategy<Value = Attenuation> {
    (number(), number(), number()).prop_map(|(constant, linear, quadratic)| Attenuation {
        constant,
        linear,
        quadratic,
    })
}

fn light() -> impl Strategy<Value = Light> {
    prop_oneof![
        (any3(), any3(), attenuation()).prop_map(|(color, position, attenuation)| Light::Point {
            color,
            position,
            attenuation
        }),
        (any3(), any3(), direction(), attenuation(), 0.0..3.0, number()).prop_map(
            |(color, position, direction, attenuation, cutoff, dropoff)| Light::Spot {
                color,
                position,
                direction,
                attenuation,
                cutoff,
                dropoff
            }
        ),
        (any3(), direction()).prop_map(|(color, direction)| Light::Directional { color, direction }),
        (any3(), any3(), direction(), positive(), attenuation()).prop_map(
            |(color, position, direction, radius, attenuation)| Light::Area {
                color,
                position,
                direction,
                radius,
                attenuation
            }
        ),
    ]
}

fn name() -> impl Strategy<Value = String> {
    prop_oneof!["[a-z]{1,8}\\.bmp", "[a-z][a-z!#\"/*]{0,5}", "[ -!#-~äß€]{1,12}"]
}

fn material(textures: u32) -> impl Strategy<Value = Material> {
    let colors = (any3(), any3(), any3(), any3());
    let texture = option::of(0..textures.max(1)).prop_map(move |tn| tn.filter(|_| textures > 0));
    let text =
        prop_oneof![Just(String::new()), "[ -~äß€\n]{0,30}".prop_map(|text| text.replace(['!', '#'], "_"))];
    (colors, number(), number(), positive(), texture, text).prop_map(
        |((ambient, diffuse, specular, emissive), ks, kt, index_of_refraction, texture, text)| Material {
            ambient,
            diffuse,
            specular,
            emissive,
            k_specular: ks,
            k_transmission: kt,
            index_of_refraction,
            texture,
            bump: None,
            text,
            weights: None,
        },
    )
}

fn matrix() -> impl Strategy<Value = Mat4> {
    (near3(), near3(), near3(), any3())
        .prop_map(|(x, y, z, shift)| {
            Mat4::from_cols(x.extend(0.0), y.extend(0.0), z.extend(0.0), shift.extend(1.0))
        })
        .prop_filter("invertible", |matrix| Transform::new(Affine::from_mat4(*matrix)).is_ok())
}

fn triangle() -> impl Strategy<Value = Triangle> {
    let texcoord = || [number(), number()].prop_map(Vec2::from);
    let parts = ([near3(), near3(), near3()], [any3(), any3(), any3()], [texcoord(), texcoord(), texcoord()]);
    parts.prop_filter_map("an area", |(v, n, t)| Triangle::new(v, n, t).ok())
}

fn step() -> impl Strategy<Value = Step> {
    let m = || -1..20_i32;
    let round = || (any3(), positive(), positive());
    prop_oneof![
        2 => matrix().prop_map(Step::Open),
        2 => Just(Step::Close),
        1 => any::<u32>().prop_map(Step::Instance),
        3 => (any3(), positive(), m())
            .prop_filter_map("valid", |(c, r, m)| Some(Step::Sphere(Sphere::new(c, r).ok()?, m))),
        1 => (any3(), [positive(), positive(), positive()], any::<bool>(), m()).prop_filter_map(
            "valid",
            |(c, [x, y, z], flat, m)| {
                let size = Vec3::new(x, if flat { 0.0 } else { y }, z);
                Some(Step::Cuboid(Cuboid::new(c, size).ok()?, m))
            }
        ),
        1 => (round(), m())
            .prop_filter_map("valid", |((c, r, h), m)| Some(Step::Cylinder(Cylinder::new(c, r, h).ok()?, m))),
        1 => (round(), m())
            .prop_filter_map("valid", |((c, r, h), m)| Some(Step::Cone(Cone::new(c, r, h).ok()?, m))),
        1 => (triangle(), m()).prop_map(|(triangle, m)| Step::Triangle(Box::new(triangle), m)),
        1 => (any::<[u32; 3]>(), m()).prop_map(|(corners, m)| Step::Indexed(corners, m)),
    ]
}

fn vertex() -> impl Strategy<Value = Vertex> {
    (near3(), any3(), [number(), number()].prop_map(Vec2::from))
        .prop_map(|(position, normal, texcoord)| Vertex { position, normal, texcoord })
}

fn placed<T>(value: T) -> Placed<T> {
    Placed { value, span: Span::default() }
}

fn push<T>(
    file: &mut SceneFile,
    kind: ShapeKind,
    material: i32,
    shape: T,
    list: fn(&mut SceneFile) -> &mut ShapeList<T>,
) {
    // Numbers from -1 up to the last material.
    let material = (material + 1) % (file.materials.len() as i32 + 1) - 1;
    let list = list(file);
    list.shapes.push(shape);
    list.materials.push(material);
    let first = list.shapes.len() as u32 - 1;
    match file.items.last_mut() {
        Some(Item::Run { kind: last, count, .. }) if *last == kind => *count += 1,
        _ => file.items.push(Item::Run { kind, first, count: 1 }),
    }
}

fn add(file: &mut SceneFile, step: Step, depth: &mut u32) {
    match step {
        Step::Open(matrix) => {
            *depth += 1;
            file.items.push(Item::Open(file.groups.len() as u32));
            file.groups.push(placed(matrix));
        }
        Step::Close if *depth > 0 => {
            *depth -= 1;
            file.items.push(Item::Close);
        }
        Step::Close => {}
        Step::Instance(number) => {
            if let Some(number) = number.checked_rem(file.includes.len() as u32) {
                file.items.push(Item::Instance(number));
            }
        }
        Step::Sphere(shape, m) => push(file, ShapeKind::Sphere, m, shape, |file| &mut file.spheres),
        Step::Cuboid(shape, m) => push(file, ShapeKind::Cuboid, m, shape, |file| &mut file.cuboids),
        Step::Cylinder(shape, m) => push(file, ShapeKind::Cylinder, m, shape, |file| &mut file.cylinders),
        Step::Cone(shape, m) => push(file, ShapeKind::Cone, m, shape, |file| &mut file.cones),
        Step::Triangle(shape, m) => push(file, ShapeKind::Triangle, m, *shape, |file| &mut file.triangles),
        Step::Indexed(corners, m) => {
            let count = file.vertices.len() as u32;
            let corners = corners.map(|corner| corner.checked_rem(count).unwrap_or(0));
            if file.indexed_triangle(corners).is_some() {
                push(file, ShapeKind::IndexedTriangle, m, corners, |file| &mut file.indexed_triangles);
            }
        }
    }
}

fn scene_file() -> impl Strategy<Value = SceneFile> {
    let singles = (option::of(camera()), option::of(any3()), option::of(any3()));
    let textures = vec(name(), 0..3);
    let lists = textures.prop_flat_map(|textures| {
        let materials = vec(material(textures.len() as u32), 0..4);
        (Just(textures), materials, vec(light(), 0..4), vec(vertex(), 0..6), vec(name(), 0..3))
    });
    (singles, lists, vec(step(), 0..40)).prop_map(|(singles, lists, steps)| {
        let (camera, background, ambient) = singles;
        let (textures, materials, lights, vertices, includes) = lists;
        let include = |(number, name): (u32, String)| {
            // A folder of its own keeps the names apart.
            placed(Include { name: format!("{number}/x{}x", name.replace('/', "_")), file: FileId(number) })
        };
        let mut file = SceneFile {
            path: "main.ray".into(),
            camera: camera.map(placed),
            background: background.map(placed),
            ambient: ambient.map(placed),
            lights: lights.into_iter().map(placed).collect(),
            textures: textures.into_iter().map(placed).collect(),
            materials: materials.into_iter().map(placed).collect(),
            vertices,
            includes: (1..).zip(includes).map(include).collect(),
            ..SceneFile::default()
        };
        let mut depth = 0;
        steps.into_iter().for_each(|step| add(&mut file, step, &mut depth));
        file.items.extend(vec![Item::Close; depth as usize]);
        file
    })
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 400, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn reading_what_was_written_gives_the_same(file in scene_file()) {
        let text = write(&file);
        let again = read(&text);
        prop_assert_eq!(&again, &file, "{}", text);
        prop_assert_eq!(write(&again), text);
    }
}
