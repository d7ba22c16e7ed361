//! Scenes that are right, and scenes that are large, deep, cut off or broken at random.

use dotray_geometry::Mat4;
use dotray_geometry::Vec3;
use dotray_scene::diagnostic::Severity;
use dotray_scene::directive::DIRECTIVES;
use dotray_scene::files::Disk;
use dotray_scene::files::Files;
use dotray_scene::load::LoadOptions;
use dotray_scene::load::Loaded;
use dotray_scene::load::load;
use dotray_scene::load::load_text;
use dotray_scene::model::Item;
use dotray_scene::model::Scene;
use dotray_scene::model::ShapeKind;
use dotray_scene::report::render_text;
use proptest::prelude::ProptestConfig;
use proptest::prelude::any;
use proptest::proptest;
use std::collections::HashMap;
use std::io;
use std::path::Path;
use std::path::PathBuf;
use std::time::Instant;

/// Files in memory.
struct Memory(HashMap<PathBuf, String>);

impl Memory {
    fn new<'a>(files: impl IntoIterator<Item = (&'a str, &'a str)>) -> Self {
        Self(files.into_iter().map(|(path, text)| (PathBuf::from(path), text.to_owned())).collect())
    }
}

impl Files for Memory {
    fn read(&self, path: &Path) -> io::Result<Vec<u8>> {
        let text = self.0.get(path).ok_or(io::ErrorKind::NotFound)?;
        Ok(text.clone().into_bytes())
    }
}

fn read(text: impl Into<Vec<u8>>) -> Loaded {
    let files = Memory::new([("part.ray", "#shape_sphere -1  0 0 0  1\n")]);
    load_text("main.ray", text, &files, &LoadOptions::default())
}

/// The scene of a text that must give no message at all.
fn scene(text: &str) -> Scene {
    let loaded = read(text);
    let shown = render_text(&loaded.diagnostics, &loaded.sources, false);
    assert!(loaded.diagnostics.is_empty(), "{shown}");
    loaded.scene.unwrap()
}

/// Every directive at least once, in every form.
fn everything() -> String {
    let mut text = String::new();
    for spec in &DIRECTIVES {
        for form in spec.forms {
            text.push_str(form.example);
            text.push('\n');
        }
    }
    text + "#vertex 1 1 0  0 0 1  1 1\n#vertex -1 1 0  0 0 1  0 1\n"
}

#[test]
fn every_directive_is_read_as_its_example_says() {
    let scene = scene(&everything());
    let [main, part] = scene.files.as_slice() else { panic!("two files") };
    assert_eq!(main.camera.unwrap().value.half_angle, 0.523);
    assert_eq!(main.background.unwrap().value, Vec3::new(0.2, 0.3, 0.5));
    assert_eq!(main.ambient.unwrap().value, Vec3::splat(0.1));
    assert_eq!(main.lights.len(), 4);
    assert_eq!(main.textures[0].value, "two words.bmp");
    assert_eq!(main.materials[0].value.index_of_refraction, 1.4);
    assert_eq!(main.materials[0].value.texture, None);
    assert_eq!(main.vertices.len(), 3);
    assert_eq!((main.includes[0].value.name.as_str(), main.includes[0].value.file.0), ("part.ray", 1));
    assert_eq!(main.groups[0].value, Mat4::from_translation(Vec3::new(-3.0, 0.0, 0.0)));
    let run = |kind| Item::Run { kind, first: 0, count: 1 };
    let tree = [
        Item::Open(0),
        Item::Close,
        run(ShapeKind::Sphere),
        run(ShapeKind::Cuboid),
        run(ShapeKind::Cylinder),
        Item::Run { kind: ShapeKind::Cone, first: 0, count: 2 },
        Item::Run { kind: ShapeKind::Open, first: 0, count: 2 },
        run(ShapeKind::Triangle),
        run(ShapeKind::IndexedTriangle),
        Item::Instance(0),
    ];
    assert_eq!(main.items, tree);
    assert_eq!([0, 1].map(|cone: usize| main.cones.shapes[cone].top()), [0.0, 0.5]);
    assert_eq!(part.spheres.shapes.len(), 1);
    assert_eq!(part.path, Path::new("part.ray"));
}

#[test]
fn layout_means_nothing() {
    let compact = scene(
        "#material 1 1 1 1 1 1 1 1 1 0 0 0 0 0 1 -1 !a b! #shape_sphere 0 1 2 3 4 #shape_sphere 0 5 6 7 8",
    );
    let spread = "\u{feff}// begin\r\n#material\r\n 1 +1 1. 1e0 /* four */ 1 1\t1 1 1 0 0 0 .0 -0 1\n-1 \
        !a b!#shape_sphere 0 1 2\n\n\n3 // three\n 4\n#shape_sphere\t0\u{c}5\u{b}6 7 8/**/";
    // The last number and the comment are one word, as a comment may only stand where a word may.
    assert!(read(spread).scene.is_none());
    let spread = scene(&spread.replace("8/**/", "8 /**/"));
    let (compact, spread) = (&compact.files[0], &spread.files[0]);
    assert_eq!(compact.materials[0].value, spread.materials[0].value);
    assert_eq!(compact.spheres.shapes, spread.spheres.shapes);
    assert_eq!(compact.items, spread.items);
    assert_eq!(spread.items, [Item::Run { kind: ShapeKind::Sphere, first: 0, count: 2 }]);
}

#[test]
fn shapes_know_where_they_stand() {
    let text = "#shape_sphere -1 0 0 0 1\n #shape_box -1 0 0 0 1 1 1\n#shape_sphere -1 0 0 0 2";
    let scene = scene(text);
    let starts = &scene.files[0].spheres.starts;
    assert_eq!((starts.get(0), starts.get(1), starts.get(2)), (Some(0), Some(52), None));
    assert_eq!(scene.files[0].cuboids.starts.get(0), Some(26));
}

#[test]
fn flat_triangles_leave_the_tree_right() {
    let mut text = String::from("#vertex 0 0 0 0 0 1 0 0 #vertex 1 0 0 0 0 1 0 0 #vertex 0 1 0 0 0 1 0 0\n");
    for corners in ["0 0 1", "0 1 2", "1 1 1"] {
        text += &format!("#shape_triangle -1 {corners}\n");
    }
    text += "#group_begin 1 0 0 0 0 1 0 0 0 0 1 0 0 0 0 1 #shape_triangle -1 0 0 0 #group_end\n";
    text += "#shape_triangle -1 0 0 0 #shape_triangle -1 1 2 0 #shape_triangle -1 2 1 0";
    let loaded = read(text);
    assert_eq!(loaded.diagnostics.len(), 4);
    let file = &loaded.scene.unwrap().files[0];
    assert_eq!(file.indexed_triangles.shapes, [[0, 1, 2], [1, 2, 0], [2, 1, 0]]);
    let run = |first, count| Item::Run { kind: ShapeKind::IndexedTriangle, first, count };
    assert_eq!(file.items, [run(0, 1), Item::Open(0), Item::Close, run(1, 2)]);
}

#[test]
fn includes_are_found_beside_the_file_and_then_in_the_working_directory() {
    let files = Memory::new([
        (
            "a/main.ray",
            "#ray_file b/one.ray #ray_file two.ray #ray_file b/../b/one.ray #ray_file ./three.ray",
        ),
        ("a/b/one.ray", "#ray_file two.ray #shape_sphere -1 0 0 0 1"),
        ("a/b/two.ray", "#shape_sphere -1 0 0 0 2"),
        ("two.ray", "#shape_sphere -1 0 0 0 3"),
        ("work/three.ray", "#shape_sphere -1 0 0 0 4 #camera 0 0 4 0 0 -1 0 1 0 .4 #light_dir 1 1 1 0 0 -1"),
        ("work/two.ray", "#shape_sphere -1 0 0 0 5"),
    ]);
    let numbers = |loaded: &Loaded, file: usize| -> Vec<u32> {
        let scene = loaded.scene.as_ref().unwrap();
        scene.files[file].includes.iter().map(|include| include.value.file.0).collect()
    };
    let options = LoadOptions { working_directory: Some("work".into()), ..LoadOptions::default() };
    let loaded = load(Path::new("a/main.ray"), &files, &options);
    let paths: Vec<_> =
        loaded.scene.iter().flat_map(|scene| &scene.files).map(|file| file.path.clone()).collect();
    let expected = ["a/main.ray", "a/b/one.ray", "work/two.ray", "work/three.ray", "a/b/two.ray"];
    assert_eq!(paths, expected.map(PathBuf::from));
    // The same file twice is read once.
    assert_eq!(numbers(&loaded, 0), [1, 2, 1, 3]);
    assert_eq!(numbers(&loaded, 1), [4]);

    let loaded = load(Path::new("a/main.ray"), &files, &LoadOptions::default());
    let [error] = loaded.diagnostics.as_slice() else { panic!("{:?}", loaded.diagnostics) };
    assert_eq!(error.code, "include-not-found");
}

#[test]
fn an_endless_chain_of_includes_ends() {
    struct Endless;
    impl Files for Endless {
        fn read(&self, path: &Path) -> io::Result<Vec<u8>> {
            let number: u64 =
                path.file_stem().and_then(|stem| stem.to_str()).and_then(|stem| stem.parse().ok()).unwrap();
            Ok(format!("#ray_file {}.ray #ray_file {}.ray", 2 * number, 2 * number + 1).into_bytes())
        }
    }
    let loaded = load(Path::new("1.ray"), &Endless, &LoadOptions::default());
    assert!(loaded.scene.is_none());
    assert!(
        loaded
            .diagnostics
            .iter()
            .all(|diagnostic| ["include-limit", "too-many-errors"].contains(&diagnostic.code))
    );
}

#[test]
fn a_ring_through_files_side_by_side_is_found() {
    let files = Memory::new([
        ("a.ray", "#ray_file c.ray"),
        ("b.ray", "#ray_file a.ray"),
        ("c.ray", "#ray_file b.ray"),
    ]);
    let loaded = load_text("main.ray", "#ray_file a.ray #ray_file b.ray", &files, &LoadOptions::default());
    let [error] = loaded.diagnostics.as_slice() else { panic!("{:?}", loaded.diagnostics) };
    assert_eq!(error.code, "include-cycle");
    assert!(error.notes[0].1.ends_with("`a.ray` → `c.ray` → `b.ray` → `a.ray`"), "{:?}", error.notes);
}

#[test]
fn a_hundred_thousand_nested_groups_are_nothing_special() {
    const DEPTH: usize = 100_000;
    let open = "#group_begin 1 0 0 0 0 1 0 0 0 0 1 0 0 0 0 1\n".repeat(DEPTH);
    let scene = scene(&format!("{open}{}", "#group_end\n".repeat(DEPTH)));
    assert_eq!(scene.files[0].items.len(), 2 * DEPTH);
    let unclosed = read(open);
    assert_eq!(unclosed.diagnostics.len(), 1);
    let stray = read("#group_end\n".repeat(DEPTH));
    assert_eq!(stray.diagnostics.len(), 21);
}

#[test]
fn a_million_tokens_on_a_line_are_told_of_in_no_time() {
    let begin = Instant::now();
    let texts = [
        format!("#camera {}", "1 ".repeat(1_000_000)),
        format!("#ambient 1 1 1 {}", "#x ".repeat(1_000_000)),
        format!("{}#ambient 1 1 1", "x ".repeat(1_000_000)),
        format!("#ambient {}", "! ".repeat(1_000_001)),
        format!("#ambient {}", "\"! \n".repeat(1_000_001)),
        format!("#ambient 1 1 {}", "/".repeat(4_000_000)),
        format!("#ambient {}", "/* */ ".repeat(1_000_000)),
        format!("#ambient {} 1 1", "1".repeat(4_000_000)),
        format!("#{}", "a".repeat(4_000_000)),
        "#shape_sphere -1 0 0 0 0 ".repeat(100_000),
    ];
    for text in texts {
        let loaded = read(text);
        let shown = render_text(&loaded.diagnostics, &loaded.sources, true);
        assert!(!loaded.diagnostics.is_empty() && loaded.diagnostics.len() <= 21);
        assert!(shown.len() < 60_000, "{}", shown.len());
    }
    assert!(begin.elapsed().as_secs() < 20, "{:?}", begin.elapsed());
}

#[test]
fn a_million_spheres_are_one_run() {
    let begin = Instant::now();
    let scene = scene(&"#shape_sphere -1 0.123456 -7.654321 1e-3 .5\n".repeat(1_000_000));
    assert_eq!(scene.files[0].items.len(), 1);
    assert_eq!(scene.files[0].spheres.starts.get(999_999), Some(999_999 * 44));
    assert!(begin.elapsed().as_secs() < 20, "{:?}", begin.elapsed());
}

/// What holds for any input: it ends, errors and scene exclude each other, and every message can be shown.
fn survives(text: &[u8]) {
    let loaded = read(text);
    let has_errors = loaded.diagnostics.iter().any(|diagnostic| diagnostic.severity == Severity::Error);
    assert_eq!(has_errors, loaded.scene.is_none());
    render_text(&loaded.diagnostics, &loaded.sources, false);
}

#[test]
fn every_beginning_of_a_scene_is_survived() {
    let text = everything();
    for length in 0..text.len() {
        survives(&text.as_bytes()[..length]);
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(512))]

    #[test]
    fn any_bytes_are_survived(bytes: Vec<u8>) {
        survives(&bytes);
    }

    #[test]
    fn any_words_are_survived(words in proptest::collection::vec(0..WORDS.len(), 0..60)) {
        let words: Vec<_> = words.into_iter().filter_map(|word| WORDS.get(word).copied()).collect();
        survives(words.join(" ").as_bytes());
    }

    #[test]
    fn flipped_bytes_are_survived(flips in proptest::collection::vec((any::<usize>(), any::<u8>()), 1..8)) {
        let mut text = everything().into_bytes();
        for (place, byte) in flips {
            let place = place % text.len();
            text[place] = byte;
        }
        survives(&text);
    }
}

const WORDS: &[&str] = &[
    "0",
    "1",
    "-1",
    "2",
    ".5",
    "1e300",
    "-1e-300",
    "1e999",
    "nan",
    "x",
    "#",
    "\"",
    "!",
    "!!",
    "//",
    "/*",
    "*/",
    "\n",
    "é",
    "#camera",
    "#background",
    "#light_num",
    "#light_spot",
    "#light_area",
    "#texture",
    "#material",
    "#group_begin",
    "#group_begin 1 0 0 0 0 1 0 0 0 0 1 0 0 0 0 1",
    "#group_end",
    "#shape_sphere",
    "#shape_box",
    "#shape_side",
    "#shape_side 0 0 0 0 1 2",
    "#shape_side 0 0 0 0 1 2 .5",
    "#shape_triangle",
    "#vertex",
    "#vertex 0 0 0 0 0 1 0 0",
    "#ray_file",
    "#ray_file part.ray",
    "#ray_file main.ray",
    "#ray_file_instance",
    "0 0 0",
    "1 1 1",
    "#Camera 0 0 4 0 0 -1 0 1 0 .4",
    "#shape_spere",
];

#[test]
fn the_conformance_scenes_are_read_without_errors() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../../shared/conformance");
    let Ok(entries) = std::fs::read_dir(folder) else {
        println!("skipped, no ../shared");
        return;
    };
    for path in entries.map(|entry| entry.unwrap().path()) {
        if path.extension().is_some_and(|extension| extension == "ray") {
            let loaded = load(&path, &Disk, &LoadOptions::default());
            let shown = render_text(&loaded.diagnostics, &loaded.sources, false);
            assert!(loaded.scene.is_some(), "{shown}");
            let warned = path.ends_with("syntax_lenient.ray") || path.ends_with("light_attenuation.ray");
            assert_eq!(loaded.diagnostics.is_empty(), !warned, "{shown}");
        }
    }
}
