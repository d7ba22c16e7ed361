//! `dotray format`: files are put in order, or told of and left alone.

mod common;

use common::BALLS;
use common::Folder;
use common::root;
use std::path::Path;

const UNTIDY: &str = "\
#Ambient .10 +1e-1 1.   // faint
#light_dir 1 1 1 0 0 -1 #shape_sphere -1
   0 0 0   // centre
   1
";
const TIDY: &str = "\
#ambient .10 +1e-1 1.  // faint
#light_dir 1 1 1  0 0 -1
#shape_sphere
  -1
  0 0 0  // centre
  1
";

#[test]
fn the_dialect_may_be_said() {
    let folder = Folder::new();
    // Flags that are not closed leave open what belongs to what, and so does a file of two dialects at once.
    folder.put("hmc.ray", b"#version HMCCS155FALL2002\n#Sphere -m red --   0 0 0 1\n#rayfile_end\n");
    folder.put("open.ray", b"#version HMCCS155FALL2002\n#sphere -n ball  0 0 0  1\n#rayfile_end\n");
    folder.put("both.ray", b"#joint_begin elbow\n#shader \"a\" \"b\"\n");
    folder.run("format open.ray").expect(1).says("unclosed-flags");
    folder.run("format both.ray").expect(1).says("dialect-unclear");
    folder.run("format hmc.ray --dialect slides").expect(1).says("stays as it is");
    folder.run("format hmc.ray --dialect hmc").expect(0);
    let text = String::from_utf8_lossy(&folder.get("hmc.ray")).into_owned();
    assert!(text.contains("#Sphere -m red -- 0 0 0 1\n"), "{text}");
    // A camera of 40 degrees is a fault of a slides file, and none of a file of degrees.
    folder.put("wide.ray", BALLS.replace("0 1 0 .5", "0 1 0 40").as_bytes());
    assert!(folder.get("wide.ray") != BALLS.as_bytes());
    folder.run("check wide.ray").expect(1);
    folder.run("check wide.ray --dialect unisa").expect(0);
}

#[test]
fn files_are_replaced_and_then_stay() {
    let folder = Folder::new();
    folder.put("a.ray", UNTIDY.as_bytes());
    let before = folder.names();
    let ended = folder.run("format a.ray").expect(0);
    assert_eq!((ended.text().as_str(), ended.stderr.as_str()), ("", "formatted a.ray\n"));
    assert_eq!(String::from_utf8(folder.get("a.ray")).unwrap(), TIDY);
    let ended = folder.run("format a.ray").expect(0);
    assert_eq!((ended.text().as_str(), ended.stderr.as_str()), ("", ""));
    assert_eq!(folder.names(), before);
}

#[test]
fn standard_output_is_for_pipes() {
    let folder = Folder::new();
    let ended = folder.run_with_input("format -", UNTIDY.as_bytes()).expect(0);
    assert_eq!((ended.text().as_str(), ended.stderr.as_str()), (TIDY, ""));
    folder.put("a.ray", UNTIDY.as_bytes());
    assert_eq!(folder.run("format --stdout a.ray").expect(0).text(), TIDY);
    assert_eq!(folder.get("a.ray"), UNTIDY.as_bytes());
}

#[test]
fn check_names_what_would_change_and_changes_nothing() {
    let folder = Folder::new();
    std::fs::create_dir(folder.path("scenes")).unwrap();
    folder.put("scenes/a.ray", UNTIDY.as_bytes());
    folder.put("scenes/b.ray", TIDY.as_bytes());
    let text = folder.run("format --check scenes").expect(1).text();
    assert!(
        text.starts_with("scenes/a.ray would change\n  line 1:\n  - #Ambient .10 +1e-1 1.   // faint\n"),
        "{text}"
    );
    assert!(text.contains("\n  + #ambient .10 +1e-1 1.  // faint\n"), "{text}");
    assert!(!text.contains("b.ray") && text.lines().count() < 40, "{text}");
    assert_eq!(folder.get("scenes/a.ray"), UNTIDY.as_bytes());
    assert_eq!(folder.run("format --check scenes/b.ray").expect(0).text(), "");
    let text = folder.run_with_input("format --check -", UNTIDY.as_bytes()).expect(1).text();
    assert!(text.starts_with("<stdin> would change\n"), "{text}");
    folder.run_with_input("format --check -", TIDY.as_bytes()).expect(0);
}

#[test]
fn faulty_files_are_told_of_and_stay() {
    let folder = Folder::new();
    for text in [
        "#shape_spere 0  0 0 0  1",
        "#ambient   1 1",
        "#ambient   1 one 1",
        "#texture   \"abc",
        "#group_begin 1 0 0 0  0 1 0 0  0 0 1 0  0 0 0 1",
        "My scene   #ambient 1 1 1",
        "ply\nformat   ascii",
        "",
    ] {
        folder.put("a.ray", text.as_bytes());
        folder.put("b.ray", UNTIDY.as_bytes());
        let ended = folder.run("format a.ray b.ray").expect(1).says("a.ray:1:").says("a.ray stays as it is");
        assert!(ended.stderr.contains("error["), "{text}: {}", ended.stderr);
        assert_eq!(folder.get("a.ray"), text.as_bytes());
        // The others are formatted all the same.
        assert_eq!(folder.get("b.ray"), TIDY.as_bytes(), "{text}");
        let ended = folder.run_with_input("format -", text.as_bytes()).expect(1);
        assert!(ended.stdout.is_empty(), "{text}");
    }
    folder.run("format missing.ray").expect(1).says("missing.ray");
    folder.run("format").expect(2).says("FILES");
    folder.run("format --check --stdout balls.ray").expect(2);
}

#[test]
fn faults_of_meaning_do_not_hinder() {
    let folder = Folder::new();
    // A material and an include that do not exist, a flat matrix, an angle in degrees.
    let text = "#camera 0 0 4 0 0 -1 0 1 0 45\n#ray_file gone.ray #group_begin 0 0 0 0 0 0 0 0 0 0 0 0 0 0 0 1\n\
                #shape_sphere 7 0 0 0 1 #group_end";
    folder.put("a.ray", text.as_bytes());
    folder.run("format a.ray").expect(0);
    let made = String::from_utf8(folder.get("a.ray")).unwrap();
    assert!(
        made.contains("\n#group_begin 0 0 0 0  0 0 0 0  0 0 0 0  0 0 0 1\n  #shape_sphere 7  0 0 0  1\n"),
        "{made}"
    );
}

#[test]
fn pictures_stay_the_same() {
    let folder = Folder::new();
    folder.put("a.ray", BALLS.replace(' ', "\n").replace("!!", "!marble scale=3; two words!").as_bytes());
    folder.run("render a.ray before.png 32 24").expect(0);
    folder.run("format a.ray").expect(0).says("formatted a.ray");
    folder.run("render a.ray after.png 32 24").expect(0);
    assert!(folder.get("before.png") == folder.get("after.png"));
}

/// Windows line ends, a byte order mark and a link are no hindrance; the link stays one.
#[test]
fn odd_files_are_formatted() {
    let folder = Folder::new();
    folder.put("a.ray", format!("\u{feff}{}", UNTIDY.replace('\n', "\r\n")).as_bytes());
    folder.run("format a.ray").expect(0);
    assert_eq!(folder.get("a.ray"), TIDY.as_bytes());
    #[cfg(unix)]
    {
        folder.put("real.ray", UNTIDY.as_bytes());
        std::os::unix::fs::symlink("real.ray", folder.path("link.ray")).unwrap();
        folder.run("format link.ray").expect(0);
        assert!(std::fs::symlink_metadata(folder.path("link.ray")).unwrap().is_symlink());
        assert_eq!(folder.get("real.ray"), TIDY.as_bytes());
    }
}

#[test]
fn the_examples_of_the_gallery_can_be_formatted() {
    let folder = Folder::new();
    for name in ["slides.ray", "slides-as-printed.ray", "cornell.ray"] {
        let path = root().join("scenes").join(name);
        folder.put(name, &std::fs::read(&path).unwrap());
        folder.run(&format!("format {name}")).expect(0);
        folder.run(&format!("format --check {name}")).expect(0);
        let kept = |path: &Path| std::fs::read_to_string(path).unwrap().matches("//").count();
        assert_eq!(kept(&folder.path(name)), kept(&path), "comments of {name}");
    }
}
