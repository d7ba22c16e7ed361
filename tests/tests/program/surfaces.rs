//! Bump images and colours of vertices: pixel by pixel against what their definitions give by hand.

use dotray_accel::Kind;
use dotray_image::Channels;
use dotray_image::EncodeOptions;
use dotray_image::Format;
use dotray_image::Image;
use dotray_image::encode;
use dotray_render::Antialias;
use dotray_render::Options;
use dotray_scene::Dialect;
use dotray_scene::Scene;
use dotray_scene::convert::Converted;
use dotray_scene::convert::convert;
use dotray_tests::pictures;
use std::f64::consts::PI;
use std::path::Path;
use tempfile::TempDir;

const SIZE: u32 = 48;

/// Brightnesses of 4 by 4 texels, row by row from the top.
const TEXELS: [u8; 16] = [0, 40, 90, 200, 60, 255, 130, 20, 150, 170, 10, 80, 220, 30, 110, 240];

/// A folder with a picture of [`TEXELS`].
fn folder() -> TempDir {
    let samples = TEXELS.iter().flat_map(|&level| [f32::from(level) / 255.0; 3]).collect();
    let image = Image::from_samples(4, 4, Channels::Rgb, samples).expect("a size");
    let bytes = encode(&image, Format::Png, &EncodeOptions::default()).expect("a file");
    let folder = tempfile::tempdir().expect("a folder");
    std::fs::write(folder.path().join("bumps.png"), bytes).expect("written");
    folder
}

fn scene(folder: &Path, text: &str) -> Scene {
    let name = folder.join("scene.ray").display().to_string();
    pictures::scene_of_text(&name, text).unwrap_or_else(|fault| panic!("{fault}"))
}

fn render(scene: Scene, kind: Kind) -> Image {
    let world = pictures::world(scene, kind).expect("the scene is sound");
    let options = Options { width: SIZE, height: SIZE, antialias: Antialias::None, ..Options::default() };
    pictures::picture(&world, &options).expect("a picture")
}

fn picture(folder: &Path, text: &str) -> Image {
    let brute = render(scene(folder, text), Kind::Brute);
    assert_eq!(
        pictures::bits(&brute),
        pictures::bits(&render(scene(folder, text), Kind::Bvh)),
        "accelerators"
    );
    brute
}

type V = [f64; 3];

fn dot(a: V, b: V) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

fn plus(a: V, b: V, factor: f64) -> V {
    [a[0] + b[0] * factor, a[1] + b[1] * factor, a[2] + b[2] * factor]
}

fn unit(a: V) -> V {
    plus([0.0; 3], a, 1.0 / dot(a, a).sqrt())
}

/// The direction of the eye ray through the middle of a pixel: a camera on the z axis, half of whose view angle has
/// this tangent.
fn eye_ray(x: u32, y: u32, tangent: f64) -> V {
    let at = |pixel: u32| (2.0 * (f64::from(pixel) + 0.5) / f64::from(SIZE) - 1.0) * tangent;
    unit([at(x), -at(y), -1.0])
}

/// A texel, wrapping around.
fn texel(column: i64, row: i64) -> f64 {
    f64::from(TEXELS[(row.rem_euclid(4) * 4 + column.rem_euclid(4)) as usize]) / 255.0
}

/// The brightness between texel centres.
fn height(s: f64, t: f64) -> f64 {
    let (x, y) = (4.0 * s - 0.5, 4.0 * t - 0.5);
    let (column, row) = (x.floor(), y.floor());
    let (u, v) = (x - column, y - row);
    let row_of = |row: i64| texel(column as i64, row) * (1.0 - u) + texel(column as i64 + 1, row) * u;
    row_of(row as i64) * (1.0 - v) + row_of(row as i64 + 1) * v
}

/// The normal that leans by the differences of neighbours.
fn leaned(normal: V, along_s: V, along_t: V, [s, t]: [f64; 2], scale: f64) -> V {
    let across = height(s + 0.125, t) - height(s - 0.125, t);
    let down = height(s, t + 0.125) - height(s, t - 0.125);
    unit(plus(plus(normal, along_s, -scale * across), along_t, -scale * down))
}

/// Compares red with what `expected` gives for a pixel; both may leave out what they do not meet.
fn compare(image: &Image, expected: impl Fn(u32, u32) -> Option<f64>) {
    let (mut checked, mut least, mut most) = (0, f64::INFINITY, 0.0_f64);
    for y in 0..SIZE {
        for x in 0..SIZE {
            let Some(expected) = expected(x, y) else { continue };
            let found = f64::from(image.pixel(x as usize, y as usize).expect("a pixel")[0]);
            assert!((found - expected).abs() < 1e-5, "({x}, {y}): {found}, by hand {expected}");
            (checked, least, most) = (checked + 1, least.min(found), most.max(found));
        }
    }
    assert!(checked > 500 && most - least > 0.1, "{checked} pixels from {least} to {most}");
}

const HEAD: &str = "#version HMCCS155FALL2002\n#background 0 0 0\n#light_dir --  1 1 1  0.3 -0.4 -1\n\
                    #material -n rock -u bumps.png --  0 0 0  1 1 1  0 0 0  0 0 0  0 0 1\n";

const TOWARDS_LIGHT: V = [-0.3, 0.4, 1.0];

#[test]
fn a_box_leans_as_its_image_says() {
    let folder = folder();
    let text = format!(
        "{HEAD}#camera 0 0 6  0 0 -1  0 1 0  30\n#box -m rock -u .7 --  0.2 -0.1 0  4 4 2\n#rayfile_end"
    );
    let image = picture(folder.path(), &text);
    compare(&image, |x, y| {
        let ray = eye_ray(x, y, (PI / 6.0).tan());
        // The front face lies at z = 1.
        let point = plus([0.0, 0.0, 6.0], ray, -5.0 / ray[2]);
        let st = [(point[0] - 0.2) / 4.0 + 0.5, 0.5 - (point[1] + 0.1) / 4.0];
        let inside = st.iter().all(|&part| part > 0.0 && part < 1.0);
        let normal = leaned([0.0, 0.0, 1.0], [1.0, 0.0, 0.0], [0.0, -1.0, 0.0], st, 0.7);
        inside.then(|| dot(normal, unit(TOWARDS_LIGHT)).max(0.0))
    });
}

/// The nearer point of the unit sphere about the origin that a ray from z = 6 meets.
fn on_sphere(ray: V) -> Option<V> {
    let from = [0.0, 0.0, 6.0];
    let half = dot(from, ray);
    let root = half * half - 35.0;
    let point = (root > 1e-3).then(|| plus(from, ray, -half - root.sqrt()));
    // Where the sphere itself turns away from the light it lies in its own shadow, however the normal leans.
    point.filter(|&point| dot(point, TOWARDS_LIGHT) > 1e-3)
}

fn bumpy_sphere(point: V, scale: f64) -> V {
    let flat = (point[0] * point[0] + point[2] * point[2]).sqrt();
    let st = [point[0].atan2(point[2]) / (2.0 * PI) + 0.5, point[1].acos() / PI];
    let along_s = [point[2] / flat, 0.0, -point[0] / flat];
    // Down along the meridian.
    let along_t = [point[0] * point[1] / flat, -flat, point[2] * point[1] / flat];
    leaned(point, along_s, along_t, st, scale)
}

#[test]
fn a_sphere_leans_as_its_image_says() {
    let folder = folder();
    let text =
        format!("{HEAD}#camera 0 0 6  0 0 -1  0 1 0  10\n#sphere -m rock -u 1.5 --  0 0 0  1\n#rayfile_end");
    let image = picture(folder.path(), &text);
    compare(&image, |x, y| {
        let point = on_sphere(eye_ray(x, y, (PI / 18.0).tan()))?;
        Some(dot(bumpy_sphere(point, 1.5), unit(TOWARDS_LIGHT)).max(0.0))
    });
}

#[test]
fn groups_turn_leaned_normals_along() {
    let folder = folder();
    let text = format!(
        "{HEAD}#camera 0 0 6  0 0 -1  0 1 0  10\n#group_begin --\n#rotate 90  0 1 0\n\
         #sphere -m rock -u 1.5 --  0 0 0  1\n#group_end\n#rayfile_end"
    );
    let image = picture(folder.path(), &text);
    compare(&image, |x, y| {
        let [px, py, pz] = on_sphere(eye_ray(x, y, (PI / 18.0).tan()))?;
        // The turn takes z to x.
        let [nx, ny, nz] = bumpy_sphere([-pz, py, px], 1.5);
        Some(dot([nz, ny, -nx], unit(TOWARDS_LIGHT)).max(0.0))
    });
}

#[test]
fn scales_of_shapes_are_their_own_and_0_is_smooth() {
    let folder = folder();
    let of = |shape: &str| {
        let text = format!("{HEAD}#camera 0 0 6  0 0 -1  0 1 0  10\n{shape}\n#rayfile_end");
        pictures::bits(&picture(folder.path(), &text))
    };
    let smooth = of("#sphere -m rock --  0 0 0  1");
    assert_eq!(smooth, of("#sphere -m rock -u 0 --  0 0 0  1"));
    let [one, two] = ["1", "2"].map(|scale| of(&format!("#sphere -m rock -u {scale} --  0 0 0  1")));
    assert!(smooth != one && one != two);
    // Beside each other, each has its own.
    let both = of(
        "#sphere -m rock -u 1 --  0 0 0  1  #sphere -m rock -u 2 --  9 9 9  1  #sphere -m rock --  -9 9 9  1",
    );
    assert_eq!(both, one);
}

fn converted(scene: &Scene, to: Dialect) -> Converted {
    convert(scene, to, &|_, name| name.to_owned()).expect("it can be written")
}

#[test]
fn bumps_are_carried_where_there_are_words_for_them() {
    let folder = folder();
    let text = format!(
        "{HEAD}#material -n brick -t bumps.png -u bumps.png --  0 0 0  1 1 1  0 0 0  0 0 0  0 0 1\n\
         #camera 0 0 6  0 0 -1  0 1 0  30\n#sphere -m rock -u 1.5 --  -1 1 0  1\n#box -m rock --  1 1 0  1 1 1\n\
         #box -m brick -t -u 3 --  -1 -1 0  1 1 1\n#sphere -m brick -u -2 --  1 -1 0  .8\n#rayfile_end"
    );
    let original = scene(folder.path(), &text);
    let there = converted(&original, Dialect::Hmc);
    assert!(there.lost.is_empty());
    let again = scene(folder.path(), &there.text);
    assert_eq!(converted(&again, Dialect::Hmc).text, there.text);
    assert_eq!(
        pictures::bits(&render(original.clone(), Kind::Bvh)),
        pictures::bits(&render(again, Kind::Bvh))
    );
    for to in [Dialect::Slides, Dialect::Uva, Dialect::Jhu, Dialect::Unisa] {
        let there = converted(&original, to);
        let told = there.lost.iter().filter(|lost| lost.message.contains("has no bump images")).count();
        assert_eq!(told, 3, "{to}: {:?}", there.lost);
        // The one picture that is shown stays, the ones that only bumped go.
        let plain = scene(folder.path(), &there.text);
        assert_eq!(plain.files[0].textures.len(), 1, "{}", there.text);
        assert_ne!(
            pictures::bits(&render(plain, Kind::Bvh)),
            pictures::bits(&render(original.clone(), Kind::Bvh))
        );
    }
}

#[test]
fn a_bump_image_that_is_not_there_is_an_error() {
    let folder = tempfile::tempdir().expect("a folder");
    let of = |shape: &str| {
        pictures::world(scene(folder.path(), &format!("{HEAD}{shape}\n#rayfile_end")), Kind::Bvh)
    };
    let fault = of("#sphere -m rock -u 1 --  0 0 0  1").expect_err("no picture");
    assert!(fault.contains("texture-not-found: the texture `bumps.png`"), "{fault}");
    assert!(of("#sphere -m rock --  0 0 0  1").is_ok(), "nobody asks for it");
}

const CORNERS: &str = "#shader \"a.vert\" \"shaders/VertexColour.frag\"\n#camera 0 0 6  0 0 -1  0 1 0  10\n\
                       #background 0 0 0\n#ambient .5 .5 .5\n\
                       #material .9 .1 .2  .3 .4 .5  0 0 0  0 0 0  0 0 1 -1 !!\n\
                       #vertex -1 -1 0  0 0 1  0 0  .1 .2 .3\n#vertex 1 -1 0  0 0 1  0 0  .9 0 1\n\
                       #vertex 0 1 0  0 0 1  0 0  .4 1 .6\n";

/// The first channel of the three corners' colours, interpolated, at a point of that triangle.
fn red_at(x: f64, y: f64) -> Option<f64> {
    let gamma = (y + 1.0) / 2.0;
    let beta = (x + 1.0 - gamma) / 2.0;
    let weights = [1.0 - beta - gamma, beta, gamma];
    let inside = weights.iter().all(|&weight| weight > 1e-9);
    inside.then(|| 0.1 * weights[0] + 0.9 * weights[1] + 0.4 * weights[2])
}

#[test]
fn colours_of_vertices_are_interpolated_in_place_of_the_materials() {
    let folder = tempfile::tempdir().expect("a folder");
    let at = |x, y| {
        plus([0.0, 0.0, 6.0], eye_ray(x, y, (PI / 18.0).tan()), -6.0 / eye_ray(x, y, (PI / 18.0).tan())[2])
    };
    let image = picture(folder.path(), &format!("{CORNERS}#shape_triangle 0  0 1 2"));
    compare(&image, |x, y| Some(0.5 * red_at(at(x, y)[0], at(x, y)[1])?));
    // Matte light shows them as well, and groups carry them along: twice as wide, upside down, lit at an angle.
    let text = format!(
        "{CORNERS}#light_dir 1 1 1  0 -3 -4\n#group_begin 2 0 0 0  0 -1 0 0  0 0 1 0  0 0 0 1\n\
         #shape_triangle 0  0 1 2\n#group_end"
    );
    let image = picture(folder.path(), &text);
    compare(&image, |x, y| {
        let [x, y, _] = at(x, y);
        Some((0.5 + 0.8) * red_at(x / 2.0, -y)?)
    });
}

#[test]
fn only_the_shader_for_them_shows_colours_of_vertices() {
    let folder = tempfile::tempdir().expect("a folder");
    let of = |shader: &str| {
        let text = CORNERS.replace("#shader \"a.vert\" \"shaders/VertexColour.frag\"\n", shader);
        let image = picture(folder.path(), &format!("{text}#shape_triangle 0  0 1 2"));
        image.pixel(24, 24).map(|pixel| pixel[0])
    };
    // The material's own ambient colour times the light's.
    assert_eq!(of(""), Some(0.45));
    assert_eq!(of("#shader \"VertexColour.vert\" \"Diffuse.frag\"\n"), Some(0.45));
    assert_ne!(of("#shader \"a\" \"vertexColor\"\n"), Some(0.45));
}

#[test]
fn colours_of_vertices_are_carried_as_far_as_words_go() {
    let folder = tempfile::tempdir().expect("a folder");
    let plain = "#vertex 1 1 0  0 0 1  0 0  .1 .2 .3\n#vertex 2 1 0  0 0 1  0 0  .1 .2 .3\n\
                 #vertex 1 2 0  0 0 1  0 0  .1 .2 .3\n";
    let both = format!("{CORNERS}{plain}#shape_triangle 0  0 1 2\n#shape_triangle -1  3 4 5\n");
    let original = scene(folder.path(), &both);
    let truth = pictures::bits(&render(original.clone(), Kind::Bvh));
    let there = converted(&original, Dialect::Unisa);
    assert!(there.lost.is_empty());
    assert_eq!(truth, pictures::bits(&render(scene(folder.path(), &there.text), Kind::Bvh)));
    // A triangle of one colour becomes a material, in every dialect; of several, the mean.
    let single = scene(folder.path(), &format!("{CORNERS}{plain}#shape_triangle 0  3 4 5\n"));
    for to in [Dialect::Slides, Dialect::Uva, Dialect::Jhu, Dialect::Hmc] {
        let there = converted(&single, to);
        let lost: Vec<_> = there.lost.iter().map(|lost| &lost.message).collect();
        assert!(!lost.iter().any(|message| message.contains("colours of vertices")), "{to}: {lost:?}");
        let image = render(scene(folder.path(), &there.text), Kind::Bvh);
        assert_eq!(pictures::bits(&render(single.clone(), Kind::Bvh)), pictures::bits(&image), "{to}");
        let lost = converted(&original, to).lost;
        assert!(lost.iter().any(|lost| lost.message.contains("1 triangle takes the mean")), "{to}: {lost:?}");
    }
}
