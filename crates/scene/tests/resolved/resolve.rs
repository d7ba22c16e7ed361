//! Resolving: transforms, numbers, defaults, and what is refused.

use crate::build::Build;
use crate::build::scene;
use dotray_geometry::Affine;
use dotray_geometry::Vec3;
use dotray_scene::Resolved;
use dotray_scene::Severity;
use dotray_scene::diagnostic::Diagnostic;
use dotray_scene::model::Scene;
use dotray_scene::model::ShapeKind;
use dotray_scene::procedural::Pattern;
use dotray_scene::resolve::Limits;
use dotray_scene::resolve::RESOLVER_CODES;
use dotray_scene::resolve::resolve;
use dotray_scene::resolve::resolve_within;
use dotray_scene::resolved::Run;
use dotray_scene::resolved::RunColors;
use dotray_scene::resolved::TreeEvent;
use dotray_scene::span::FileId;
use dotray_scene::span::Span;
use std::path::PathBuf;

/// The resolved scene and the codes of its warnings.
fn good(scene: Scene) -> (Resolved, Vec<&'static str>) {
    let outcome = resolve(scene);
    assert_listed(&outcome.diagnostics);
    let codes = outcome.diagnostics.iter().map(|diagnostic| diagnostic.code).collect();
    (outcome.resolved.unwrap_or_else(|| panic!("{:#?}", outcome.diagnostics)), codes)
}

/// The errors of a scene that must not resolve.
fn errors(scene: Scene) -> Vec<Diagnostic> {
    let outcome = resolve(scene);
    assert_listed(&outcome.diagnostics);
    assert!(outcome.resolved.is_none());
    let errors: Vec<_> =
        outcome.diagnostics.into_iter().filter(|diagnostic| diagnostic.severity == Severity::Error).collect();
    assert!(!errors.is_empty());
    errors
}

/// Every message's code stands in the table, with its severity.
fn assert_listed(diagnostics: &[Diagnostic]) {
    for Diagnostic { code, severity, .. } in diagnostics {
        assert!(
            RESOLVER_CODES.iter().any(|(listed, level, _)| (listed, level) == (code, severity)),
            "{code}"
        );
    }
}

fn main_file() -> Build {
    Build::file(0).camera().light()
}

fn span(start: u64, end: u64) -> Option<Span> {
    Some(Span { file: FileId(0), start, end })
}

const O: [f64; 3] = [0.0, 0.0, 0.0];

#[test]
fn a_complete_scene_has_no_warning() {
    let (resolved, codes) = good(scene([main_file().sphere(-1, O, 1.0)]));
    assert!(codes.is_empty(), "{codes:?}");
    assert_eq!((resolved.shape_count, resolved.lights.len(), resolved.camera.half_angle), (1, 1, 0.523));
    assert_eq!((resolved.background, resolved.ambient), (Vec3::ZERO, Vec3::ZERO));
}

#[test]
fn matrices_multiply_outermost_first() {
    let build = main_file().translate(1.0, 2.0, 3.0).scale(2.0, 2.0, 2.0).sphere(-1, O, 1.0).close().close();
    let (resolved, _) = good(scene([build]));
    let frame = resolved.transform(resolved.runs[0].frame).unwrap();
    // The point is scaled first and moved afterwards.
    assert_eq!(frame.world_from_object.transform_point3(Vec3::X), Vec3::new(3.0, 2.0, 3.0));
    assert_eq!(frame.object_from_world.transform_point3(Vec3::new(3.0, 2.0, 3.0)), Vec3::X);
}

#[test]
fn groups_share_one_frame_each() {
    let build = main_file()
        .sphere(-1, O, 1.0)
        .translate(1.0, 0.0, 0.0)
        .translate(0.0, 1.0, 0.0)
        .sphere(-1, O, 1.0)
        .cone(-1, O, 1.0, 1.0)
        .close()
        .sphere(-1, O, 1.0)
        .sphere(-1, O, 1.0)
        .cuboid(-1, O, [1.0, 1.0, 1.0])
        .translate(0.0, 0.0, 0.0)
        .close()
        .cylinder(-1, O, 1.0, 1.0)
        .close()
        .scale(1.0, 1.0, 1.0)
        .sphere(-1, O, 1.0)
        .close();
    let (resolved, _) = good(scene([build]));
    let run = |kind, first, count, frame, first_shape| Run {
        file: FileId(0),
        kind,
        first,
        count,
        frame,
        material_base: 0,
        first_shape,
        colors: RunColors::No,
    };
    let expected = [
        run(ShapeKind::Sphere, 0, 1, 0, 0),
        run(ShapeKind::Sphere, 1, 1, 1, 1),
        run(ShapeKind::Cone, 0, 1, 1, 2),
        run(ShapeKind::Sphere, 2, 2, 2, 3),
        run(ShapeKind::Cuboid, 0, 1, 2, 5),
        run(ShapeKind::Cylinder, 0, 1, 2, 6),
        run(ShapeKind::Sphere, 4, 1, 0, 7),
    ];
    assert_eq!(resolved.runs, expected);
    assert_eq!(resolved.shape_count, 8);
    let translations: Vec<_> = resolved.frames.iter().map(|frame| frame.translation).collect();
    assert_eq!(translations, [Vec3::ZERO, Vec3::new(1.0, 1.0, 0.0), Vec3::X]);
    assert_eq!(resolved.frames[0], Affine::IDENTITY);
    use TreeEvent::{Close, Open, Run as Shapes};
    let tree = [
        Shapes(0),
        Open,
        Open,
        Shapes(1),
        Shapes(2),
        Close,
        Shapes(3),
        Shapes(4),
        Open,
        Close,
        Shapes(5),
        Close,
        Open,
        Shapes(6),
        Close,
    ];
    assert_eq!(resolved.tree, tree);
}

#[test]
fn instances_bring_their_own_materials_and_textures() {
    let main = main_file()
        .texture("a.bmp")
        .material(|_| {})
        .material(|m| m.texture = Some(0))
        .include(1)
        .sphere(1, O, 1.0)
        .translate(0.0, 5.0, 0.0)
        .instance(0)
        .sphere(0, O, 1.0)
        .close()
        .instance(0);
    let part = Build::file(1)
        .texture("b.bmp")
        .texture("c.bmp")
        .material(|m| m.texture = Some(1))
        .sphere(0, O, 1.0)
        .sphere(-1, O, 1.0);
    let (resolved, _) = good(scene([main, part]));
    let runs: Vec<_> =
        resolved.runs.iter().map(|r| (r.file.0, r.frame, r.material_base, r.first_shape)).collect();
    assert_eq!(runs, [(0, 0, 0, 0), (1, 1, 2, 1), (0, 1, 0, 3), (1, 0, 2, 4)]);
    assert_eq!(resolved.shape_count, 6);
    assert_eq!(resolved.frames.len(), 2);
    use TreeEvent::{Close, Open, Run as Shapes};
    let tree = [Shapes(0), Open, Open, Shapes(1), Close, Shapes(2), Close, Open, Shapes(3), Close];
    assert_eq!(resolved.tree, tree);
    let textures: Vec<_> = resolved.materials.iter().map(|material| material.texture).collect();
    assert_eq!(textures, [None, Some(0), Some(2), None]);
    assert_eq!(resolved.material_index(&resolved.runs[1], 0), 2);
    assert_eq!(resolved.material_index(&resolved.runs[1], -1), 3);
    let candidates: Vec<_> = resolved.textures.iter().map(|texture| texture.candidates.clone()).collect();
    let beside_or_here = |name: &str| vec![PathBuf::from(format!("scenes/{name}")), PathBuf::from(name)];
    assert_eq!(candidates, ["a.bmp", "b.bmp", "c.bmp"].map(beside_or_here));
}

#[test]
fn backslashes_in_texture_names_are_tried_as_slashes() {
    let (resolved, _) = good(scene([main_file().texture("t\\a.bmp").sphere(-1, O, 1.0)]));
    assert_eq!(resolved.textures[0].name, "t\\a.bmp");
    assert!(resolved.textures[0].candidates.contains(&PathBuf::from("scenes/t/a.bmp")));
}

#[test]
fn materials_hold_the_formulas_quantities() {
    let build = main_file()
        .material(|m| {
            m.k_specular = 0.25;
            m.k_transmission = 2.0;
            m.index_of_refraction = 1.5;
            m.text = "polished; wood scale=3; bump".to_owned();
        })
        .sphere(0, O, 1.0);
    let (resolved, codes) = good(scene([build]));
    assert!(codes.is_empty(), "{codes:?}");
    let material = &resolved.materials[0];
    assert_eq!(material.shininess, 32.0);
    assert_eq!(material.reflection, Vec3::new(0.0625, 0.125, 0.25));
    assert_eq!(material.transmission, Vec3::new(0.5, 1.0, 2.0));
    assert_eq!(material.index_of_refraction, 1.5);
    assert_eq!((material.procedural.solids.len(), material.procedural.bumps.len()), (1, 1));
    assert_eq!(material.procedural.solids[0].pattern, Pattern::Wood);
}

#[test]
fn the_default_material_stands_last() {
    let (resolved, _) = good(scene([main_file().material(|_| {}).sphere(-1, O, 1.0)]));
    let material = &resolved.materials[1];
    assert_eq!(resolved.materials.len(), 2);
    let [ambient, most] = [0.2, 0.8].map(Vec3::splat);
    assert_eq!((material.ambient, material.diffuse, material.specular), (ambient, most, most));
    assert_eq!(
        (material.emissive, material.reflection, material.transmission),
        (Vec3::ZERO, most, Vec3::ZERO)
    );
    assert_eq!((material.shininess, material.index_of_refraction, material.texture), (128.0, 1.0, None));
    assert!(material.procedural.solids.is_empty() && material.procedural.bumps.is_empty());
}

#[test]
fn odd_materials_are_warned_of() {
    let build = main_file()
        .material(|m| m.k_specular = -0.5)
        .material(|m| m.k_transmission = -1.0)
        .material(|m| m.text = "noise colour=1,0,0 scale=x".to_owned())
        .material(|m| m.k_specular = f64::MAX)
        .sphere(0, O, 1.0);
    let outcome = resolve(scene([build]));
    let warnings: Vec<_> = outcome.diagnostics.iter().map(|d| (d.severity, d.code, d.span)).collect();
    let expected = [
        (Severity::Warning, "material-range", span(20, 30)),
        (Severity::Warning, "material-range", span(30, 40)),
        (Severity::Warning, "material-text", span(40, 50)),
        (Severity::Warning, "material-text", span(40, 50)),
    ];
    assert_eq!(warnings, expected);
    assert!(outcome.diagnostics[0].message.contains("ks is -0.5"));
    assert!(outcome.diagnostics[2].message.contains("`colour=1,0,0`"));
    let materials = outcome.resolved.unwrap().materials;
    assert_eq!(materials[0].shininess, 0.0);
    assert_eq!(materials[0].reflection, Vec3::new(-0.125, -0.25, -0.5));
    assert!(materials.iter().all(|m| m.shininess.is_finite() && m.reflection.is_finite()));
}

#[test]
fn unknown_materials_are_told_with_their_places() {
    let mut build = main_file().material(|_| {}).material(|_| {}).material(|_| {});
    build = build.sphere(2, O, 1.0).cone(7, O, 1.0, 1.0).sphere(-2, O, 1.0).sphere(-1, O, 1.0);
    let errors = errors(scene([build]));
    let told: Vec<_> = errors.iter().map(|error| (error.code, error.message.as_str(), error.span)).collect();
    let expected = [
        ("unknown-material", "material 7 does not exist: the file has 3 (0 to 2)", span(60, 71)),
        ("unknown-material", "material -2 does not exist: the file has 3 (0 to 2)", span(70, 83)),
    ];
    assert_eq!(told, expected);
    assert!(errors.iter().all(|error| error.notes.is_empty()));
}

#[test]
fn many_unknown_materials_are_told_in_few_words() {
    let mut build = main_file();
    for _ in 0..10 {
        build = build.sphere(0, O, 1.0).cuboid(0, O, [1.0, 1.0, 1.0]);
    }
    let errors = errors(scene([build]));
    assert_eq!(errors.len(), 5);
    // In file order, though boxes and spheres lie in different lists.
    let starts: Vec<_> = errors.iter().map(|error| error.span.unwrap().start).collect();
    assert_eq!(starts, [20, 30, 40, 50, 60]);
    assert_eq!(errors[0].message, "material 0 does not exist: the file has no materials");
    assert_eq!(errors[4].notes, [(None, "and 15 more shapes of this file name no material".to_owned())]);
}

#[test]
fn an_instances_material_numbers_are_its_files_own() {
    let main = main_file().material(|_| {}).material(|_| {}).include(1).instance(0).sphere(1, O, 1.0);
    let part = Build::file(1).material(|_| {}).sphere(1, O, 1.0);
    let errors = errors(scene([main, part]));
    assert_eq!(errors.len(), 1);
    assert_eq!(errors[0].span.unwrap().file, FileId(1));
    assert_eq!(errors[0].message, "material 1 does not exist: the file has 1 (number 0)");
}

#[test]
fn unknown_textures_and_bad_refraction_are_errors() {
    let build = main_file()
        .texture("a.bmp")
        .material(|m| m.texture = Some(1))
        .material(|m| (m.k_transmission, m.index_of_refraction) = (0.5, 0.0))
        .material(|m| (m.k_transmission, m.index_of_refraction) = (0.0, 0.0))
        .sphere(0, O, 1.0);
    let errors = errors(scene([build]));
    let told: Vec<_> = errors.iter().map(|error| (error.code, error.span)).collect();
    assert_eq!(told, [("unknown-texture", span(30, 40)), ("index-of-refraction", span(40, 50))]);
    assert_eq!(errors[0].message, "texture 1 does not exist: the file has 1 (number 0)");
}

#[test]
fn a_product_that_becomes_singular_is_told_once_with_its_chain() {
    // A shear whose determinant is 1e-5: three of them, one in another, leave 1e-15.
    let shear = [[1.0, 1.0, 0.0, 0.0], [1.0, 1.00001, 0.0, 0.0], [0.0, 0.0, 1.0, 0.0], [0.0, 0.0, 0.0, 1.0]];
    let mut build = main_file();
    for _ in 0..10 {
        build = build.open(shear);
    }
    build = build.translate(1.0, 0.0, 0.0).sphere(-1, O, 1.0);
    let errors = errors(scene([build]));
    // Those inside the third one are not told again.
    assert_eq!(errors.len(), 1);
    assert_eq!((errors[0].code, errors[0].span), ("singular-product", span(40, 50)));
    let notes: Vec<_> = errors[0].notes.iter().map(|(span, _)| *span).collect();
    assert_eq!(notes, [span(30, 40), span(20, 30)]);
}

#[test]
fn a_product_that_overflows_is_told() {
    let mut build = main_file();
    for _ in 0..4 {
        build = build.scale(1e100, 1e100, 1e100);
    }
    assert_eq!(errors(scene([build.sphere(-1, O, 1.0)]))[0].code, "singular-product");
}

#[test]
fn long_chains_show_their_ends() {
    let mut build = main_file();
    for _ in 0..20 {
        build = build.translate(1.0, 0.0, 0.0);
    }
    let errors = errors(scene([build.scale(1.0, 0.0, 1.0)]));
    let notes: Vec<_> =
        errors[0].notes.iter().map(|(span, text)| (span.map(|s| s.start), text.as_str())).collect();
    let inside = |start| (Some(start), "inside this group");
    let mut expected: Vec<_> = [210, 200, 190, 180, 170, 160].map(inside).into();
    expected.extend([(None, "and 13 more around it"), inside(20)]);
    assert_eq!(notes, expected);
}

#[test]
fn several_singular_groups_are_all_told() {
    let mut build = main_file();
    for _ in 0..25 {
        build = build.scale(1.0, 0.0, 1.0).close();
    }
    let errors = errors(scene([build]));
    assert_eq!(errors.len(), 21);
    let starts: Vec<_> = errors.iter().filter_map(|error| error.span).map(|span| span.start).collect();
    assert_eq!(starts, (1..=20).map(|place| 20 * place).collect::<Vec<_>>());
    assert_eq!(errors[20].code, "too-many-errors");
}

#[test]
fn a_deep_chain_stays_accurate() {
    // A rotation by the 3-4-5 angle and a halving, 240 levels down and 240 levels back up again.
    let turn = |c: f64, s: f64, scale: f64| {
        [
            [c * scale, -s * scale, 0.0, 0.5],
            [s * scale, c * scale, 0.0, -0.25],
            [0.0, 0.0, scale, 1.0],
            [0.0, 0.0, 0.0, 1.0],
        ]
    };
    let mut build = main_file();
    for level in 0..240 {
        build = build.open(turn(0.6, 0.8, if level % 2 == 0 { 1.25 } else { 0.8 }));
    }
    // The exact inverse of two levels: rotate back, undo the translation.
    let pair =
        Affine::from_mat4(to_mat(turn(0.6, 0.8, 1.25))) * Affine::from_mat4(to_mat(turn(0.6, 0.8, 0.8)));
    let back = pair.inverse();
    let rows = dotray_geometry::Mat4::from(back).transpose().to_cols_array_2d();
    for _ in 0..120 {
        build = build.open(rows);
    }
    let (resolved, _) = good(scene([build.sphere(-1, O, 1.0)]));
    let frame = resolved.transform(resolved.runs[0].frame).unwrap();
    for affine in [frame.world_from_object, frame.object_from_world] {
        for point in [Vec3::ZERO, Vec3::X, Vec3::Y, Vec3::Z, Vec3::ONE] {
            let error = affine.transform_point3(point).distance(point);
            assert!(error < 1e-11, "{error:e}");
        }
    }
    let both = frame.world_from_object * frame.object_from_world;
    assert!(both.abs_diff_eq(Affine::IDENTITY, 1e-14), "{both}");
}

fn to_mat(rows: [[f64; 4]; 4]) -> dotray_geometry::Mat4 {
    dotray_geometry::Mat4::from_cols_array_2d(&rows).transpose()
}

#[test]
fn depth_is_bounded_only_by_memory() {
    let mut build = main_file();
    for _ in 0..100_000 {
        build = build.translate(1.0, 0.0, 0.0);
    }
    let (resolved, _) = good(scene([build.sphere(-1, O, 1.0)]));
    let frame = resolved.transform(resolved.runs[0].frame).unwrap();
    assert_eq!(frame.world_from_object.translation, Vec3::new(100_000.0, 0.0, 0.0));
    assert_eq!(resolved.tree.len(), 200_001);
    assert_eq!(resolved.frames.len(), 2);
}

#[test]
fn multiplying_instances_are_refused() {
    let mut files: Vec<_> =
        (0..40).map(|number| Build::file(number).include(number + 1).instance(0).instance(0).file).collect();
    files.push(Build::file(40).sphere(-1, O, 1.0).sphere(-1, O, 1.0).file);
    for limits in [
        Limits { steps: 10_000, ..Limits::default() },
        Limits { runs: 1000, ..Limits::default() },
        Limits { shapes: 1000, ..Limits::default() },
    ] {
        let outcome = resolve_within(Scene { files: files.clone() }, &limits);
        assert!(outcome.resolved.is_none());
        let errors = outcome.diagnostics.iter().filter(|d| d.severity == Severity::Error);
        let told: Vec<_> = errors.map(|error| error.message.as_str()).collect();
        assert_eq!(told.len(), 1);
        let number = if limits.steps == 10_000 { "10000 groups" } else { "1000 " };
        assert!(told[0].contains(number), "{told:?}");
    }
}

#[test]
fn what_a_file_writes_out_itself_is_never_refused() {
    let mut build = main_file();
    for _ in 0..50 {
        build = build.sphere(-1, O, 1.0).cone(-1, O, 1.0, 1.0).translate(0.0, 0.0, 0.0);
    }
    let outcome = resolve_within(scene([build]), &Limits { steps: 1, runs: 1, shapes: 100 });
    assert_eq!(outcome.resolved.unwrap().runs.len(), 100);
}

#[test]
fn a_circle_of_instances_is_an_error() {
    let main = main_file().include(1).instance(0);
    let part = Build::file(1).include(0).sphere(-1, O, 1.0).instance(0);
    let errors = errors(scene([main, part]));
    assert_eq!(errors[0].code, "include-cycle");
    assert_eq!(errors[0].span, Some(Span { file: FileId(1), start: 0, end: 10 }));
}

#[test]
fn an_empty_scene_is_warned_of_and_has_a_camera() {
    for empty in [Scene::default(), scene([Build::file(0)])] {
        let (resolved, codes) = good(empty);
        assert_eq!(codes, ["no-light", "no-shape", "no-camera"]);
        assert_eq!(resolved.camera.position, Vec3::ZERO);
        assert_eq!(resolved.camera.direction, Vec3::NEG_Z);
        assert_eq!(resolved.materials.len(), 1);
    }
}

#[test]
fn the_default_camera_just_frames_the_bounding_sphere() {
    let half_angle_sine = 0.4_f64.sin();
    // A ball of radius 3 around (1, 2, 4).
    let ball = Build::file(0).light().translate(1.0, 2.0, 4.0).scale(3.0, 3.0, 3.0).sphere(-1, O, 1.0);
    let (resolved, codes) = good(scene([ball]));
    assert_eq!(codes, ["no-camera"]);
    let camera = resolved.camera;
    assert_eq!((camera.direction, camera.up, camera.half_angle), (Vec3::NEG_Z, Vec3::Y, 0.4));
    let expected = Vec3::new(1.0, 2.0, 4.0 + 3.0 / half_angle_sine);
    assert!(camera.position.abs_diff_eq(expected, 1e-12), "{camera:?}");
    // A box of 2 by 4 by 4: half its diagonal is 3.
    let (resolved, _) = good(scene([Build::file(0).light().cuboid(-1, O, [2.0, 4.0, 4.0])]));
    let expected = Vec3::new(0.0, 0.0, 3.0 / half_angle_sine);
    assert!(resolved.camera.position.abs_diff_eq(expected, 1e-12), "{:?}", resolved.camera);
}

#[test]
fn the_default_camera_is_told_in_words() {
    let outcome = resolve(scene([Build::file(0).light().cuboid(-1, O, [2.0, 4.0, 4.0])]));
    let help = outcome.diagnostics[0].help.clone().unwrap();
    assert_eq!(help, "the same in words: `#camera 0 0 7.7038 0 0 -1 0 1 0 0.4`");
}
