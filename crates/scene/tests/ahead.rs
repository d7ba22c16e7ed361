//! A large file read on several threads gives the scene and the messages of one thread.

use dotray_scene::files::Disk;
use dotray_scene::load::LoadOptions;
use dotray_scene::load::Loaded;
use dotray_scene::load::load_text;
use std::fmt::Write;

/// More than the bytes that are read on several threads, many times.
const LINES: u32 = 300_000;

fn read(threads: usize, text: &str, options: &LoadOptions) -> Loaded {
    let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
    pool.install(|| load_text("large.ray", text, &Disk, options))
}

fn shapes(insert: &[(u32, &str)]) -> String {
    let mut text = String::from("#camera 0 0 9 0 0 -1 0 1 0 .5\n#light_dir 1 1 1 0 0 -1\n");
    for line in 0..LINES {
        if let Some((_, inserted)) = insert.iter().find(|(place, _)| *place == line) {
            text.push_str(inserted);
        }
        let x = f64::from(line) * 0.001;
        match line / 1000 % 4 {
            0 => writeln!(text, "#shape_sphere -1 {x} 0.25 1e-3 .5"),
            1 => writeln!(text, "#vertex {x} 0 1  0 0 1  .5 .5"),
            2 => writeln!(text, "  #shape_cylinder -1 {x} 1 2 3\n 4 // its height"),
            _ => writeln!(text, "#shape_triangle -1 0 1 2"),
        }
        .unwrap();
    }
    text
}

/// Reads it on one thread and on several; says whether a scene came of it.
fn same(name: &str, text: &str, options: &LoadOptions) -> bool {
    let one = read(1, text, options);
    for threads in [2, 5] {
        let several = read(threads, text, options);
        assert!(one.scene == several.scene, "{name}: the scenes differ on {threads} threads");
        assert_eq!(one.diagnostics, several.diagnostics, "{name}, {threads} threads");
    }
    one.scene.is_some()
}

#[test]
fn several_threads_read_what_one_reads() {
    let options = LoadOptions::default();
    assert!(same("plain", &shapes(&[]), &options));
    let open = "#group_begin 1 0 0 0  0 1 0 0  0 0 1 0  0 0 0 1\n";
    assert!(same("groups", &shapes(&[(70_001, open), (200_000, "#group_end\n")]), &options));
    let material = "#material 1 1 1 1 1 1 1 1 1 0 0 0 0 0 1 -1 !two\nlines!\n";
    assert!(same("materials", &shapes(&[(150_000, material)]), &options));
    let flat = "#shape_sphere -1 0 0 0 0\n";
    assert!(same("warnings", &shapes(&[(50_000, flat), (250_000, flat)]), &options));
}

#[test]
fn colours_of_vertices_keep_their_vertices() {
    let options = LoadOptions::default();
    // A row of vertices without colours, then one with, in another dialect and past what is read at once.
    let colored = "1 0 1  0 0 1  .5 .5  .25 .5 .75";
    let text = shapes(&[(100, "#shader \"a\" \"VertexColour.frag\"\n")])
        .replace("#vertex 29", &format!("#vertex {colored}\n#vertex 29"));
    assert!(same("colours", &text, &options));
    let scene = read(3, &text, &options).scene.unwrap();
    let file = &scene.files[0];
    assert_eq!(file.vertex_colors.len(), file.vertices.len());
    let given = file.vertex_colors.iter().zip(&file.vertices).filter(|(color, _)| color.is_some());
    assert!(given.clone().count() > 1000 && given.clone().all(|(_, vertex)| vertex.position.x == 1.0));
}

#[test]
fn comments_that_hold_directives_reach_across_pieces() {
    let text = shapes(&[(40_000, "/* all of this\n"), (260_000, "*/\n")]);
    let options = LoadOptions::default();
    assert!(same("a long comment", &text, &options));
    let loaded = read(3, &text, &options);
    let spheres: usize = loaded.scene.unwrap().files.iter().map(|file| file.spheres.shapes.len()).sum();
    assert!(spheres < LINES as usize / 8, "{spheres}");
}

#[test]
fn faults_are_told_as_one_thread_tells_them() {
    let options = LoadOptions::default();
    for fault in
        ["#shape_sphere -1 0 0 0 x\n", "#shape_spere -1 0 0 0 1\n", "#group_end\n", "stray\n", "/* open\n"]
    {
        let text = shapes(&[(30_000, fault), (123_456, fault), (299_999, fault)]);
        assert!(!same(fault, &text, &options));
    }
}

#[test]
fn the_limit_on_shapes_holds_across_pieces() {
    let mut options = LoadOptions::default();
    options.limits.max_shapes = LINES / 3;
    assert!(!same("limited", &shapes(&[]), &options));
}
