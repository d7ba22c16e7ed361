//! Foreign scenes, the courses' command line, and `convert`, as people use them.

mod common;

use common::Folder;
use common::Outcome;

const UVA: &str = "\
#camera 0 0 4 0 0 -1 0 1 0 1
#light_dir 1 1 1 0 0 -1
#material 0 0 0 .2 .2 .2 .7 .6 .1 .5 .5 .5 128 0 0 0 1 -1 !!
#shape_sphere 0 0 0 0 1
";

/// A folder with `a.ray` besides.
fn with(text: &str) -> Folder {
    let folder = Folder::new();
    folder.put("a.ray", text.as_bytes());
    folder
}

#[test]
fn the_dialect_is_found_out_and_said_in_one_line() {
    let folder = with(UVA);
    let outcome: Outcome = folder.run("render a.ray --size 8x6").expect(0);
    outcome.says("note: read in the dialect `uva`: a material of 19 arguments at a.ray:3:1");
    let quiet = folder.run("render a.ray --size 8x6 -q").expect(0);
    assert_eq!(quiet.stderr, "");
    folder.run("info a.ray --dialect slides").expect(1).says("takes 17 arguments, but 19 are given");
    folder.run("dump a.ray --dialect jhu").expect(0);
}

#[test]
fn courses_call_their_programs_like_this() {
    let folder = with(UVA);
    let words = "render --in a.ray --out a.bmp --width 12 --height 10 --rLimit 5 --cLimit 0.0001";
    folder.run(words).expect(0);
    assert_eq!(folder.get("a.bmp").get(..2), Some(&b"BM"[..]));
    folder.run("render --in a.ray --height 6").expect(0);
    assert!(folder.names().contains(&"a.png".to_owned()));
    folder.run("render a.ray --in a.ray").expect(2).says("the scene is given twice");
    folder.run("render --out b.bmp").expect(2).says("no scene given");
    folder.run("render a.ray b.bmp 8 6 5 --rLimit 5").expect(2).says("the recursion limit is given twice");
}

#[test]
fn white_takes_the_place_of_a_lost_texture_where_one_wants_it() {
    let text = UVA.replace("1 -1 !!", "1 0 !!") + "#texture gone.bmp\n";
    let folder = with(&text);
    folder.run("render a.ray --size 8x6").expect(1).says("texture-not-found");
    folder
        .run("render a.ray --size 8x6 --missing-texture white")
        .expect(0)
        .says("the texture `gone.bmp` was not found; white takes its place");
}

/// Courses' programs ran in a folder above that of their scenes; a fault elsewhere must not change where is searched.
#[test]
fn a_texture_above_is_found_in_a_scene_with_faults_too() {
    let folder = with(UVA);
    std::fs::create_dir_all(folder.path("scenes/deep")).unwrap();
    folder.run("render a.ray scenes/wood.png 4 4").expect(0);
    let text = UVA.replace("1 -1 !!", "1 0 !!") + "#texture wood.png\n";
    folder.put("scenes/deep/a.ray", text.as_bytes());
    folder.run("render scenes/deep/a.ray --size 8x6").expect(0);
    folder.run("check scenes/deep/a.ray").expect(0);
    folder.put("scenes/deep/a.ray", (text + "#shape_sphere 7 0 0 0 1\n").as_bytes());
    let text = folder.run("check scenes/deep/a.ray").expect(1).text();
    assert!(text.contains("error[unknown-material]") && !text.contains("texture"), "{text}");
}

#[test]
fn converting_says_what_is_lost_line_by_line() {
    let folder = with(&UVA.replace(" 128 ", " 64 "));
    let outcome = folder.run("convert a.ray b.ray").expect(0);
    outcome.says("a.ray:3:1: not carried over: the mirror's weight becomes ks = 0.5");
    let text = String::from_utf8_lossy(&folder.get("b.ray")).into_owned();
    assert!(text.contains("#camera 0 0 4 0 0 -1 0 1 0 0.5\n"), "{text}");
    folder.run("render b.ray --size 8x6 --dialect slides").expect(0);
    let jhu = folder.run("convert a.ray - --to jhu").expect(0).text();
    assert!(!jhu.contains("_num") && jhu.contains("#light_dir 0 0 0 1 1 1 1 1 1 0 0 -1"), "{jhu}");
}

#[test]
fn every_dialect_is_written_and_known_again() {
    let folder = with(UVA);
    for dialect in ["slides", "uva", "jhu", "hmc", "unisa"] {
        let name = format!("{dialect}.ray");
        folder.run(&format!("convert a.ray {name} --to {dialect}")).expect(0);
        let outcome = folder.run(&format!("render {name} {dialect}.ppm --size 8x6")).expect(0);
        if dialect != "slides" {
            outcome.says(&format!("read in the dialect `{dialect}`"));
        }
        assert_eq!(folder.get(&format!("{dialect}.ppm")), folder.get("slides.ppm"), "{dialect}");
    }
}

#[test]
fn a_faulty_scene_leaves_an_older_file_as_it_was() {
    let folder = with(&UVA.replace(".7", "seven"));
    folder.put("b.ray", b"older");
    folder.run("convert a.ray b.ray").expect(1).says("must be a number");
    assert_eq!(folder.get("b.ray"), b"older");
    folder.run("convert a.ray b.ray --to hmc --from slides").expect(1);
    let good = with(UVA);
    good.run("convert a.ray a.ray").expect(2).says("would overwrite the scene");
}
