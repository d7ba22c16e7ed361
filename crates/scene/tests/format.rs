//! The canonical layout: what it looks like, that it is stable, and that it never changes what a file means.

use dotray_scene::files::Disk;
use dotray_scene::files::Files;
use dotray_scene::format::FormatError;
use dotray_scene::format::WIDTH;
use dotray_scene::format::format_text;
use dotray_scene::format::is_structural;
use dotray_scene::format::says_the_same;
use dotray_scene::load::LoadOptions;
use dotray_scene::load::load_text;
use dotray_scene::model::SceneFile;
use proptest::collection::vec;
use proptest::prelude::*;
use std::io;
use std::path::Path;
use std::path::PathBuf;

fn formatted(text: &str) -> String {
    let made = format_text(text.as_bytes()).unwrap_or_else(|fault| panic!("{fault}: {text}"));
    assert!(says_the_same(text.as_bytes(), &made), "{text}\nbecame\n{}", String::from_utf8_lossy(&made));
    let again = format_text(&made).unwrap();
    let (made, again) = (String::from_utf8(made).unwrap(), String::from_utf8(again).unwrap());
    assert_eq!(again, made, "not stable: {text}");
    made
}

#[test]
fn one_directive_a_line_groups_apart() {
    let text = "\u{feff}#Camera 0 0 4 0 0 -1\r\n  0 1 0 .50 #Background .1\t.2 +3e-1\n\n\n
#light_num 1 #light_dir 1 1 1 0 0 -1
#material 1 1 1 1 1 1 1 1 1 0 0 0 .5 0 1 -1 !two  words! #texture \"two words.bmp\"
#group_begin 1 0 0 0 0 1 0 0 0 0 1 0 0 0 0 1

#shape_sphere 0 0 0 0 1
#group_begin 1 0 0 0 0 1 0 0 0 0 1 0 0 0 0 1 #shape_cylinder 0 0 0 0 1 2
#group_end

#group_end #vertex 0 0 0 0 0 1 .5 .5";
    let expected = "\
#camera 0 0 4  0 0 -1  0 1 0  .50
#background .1 .2 +3e-1

#light_num 1
#light_dir 1 1 1  0 0 -1
#material 1 1 1  1 1 1  1 1 1  0 0 0  .5 0 1 -1 !two  words!
#texture \"two words.bmp\"
#group_begin 1 0 0 0  0 1 0 0  0 0 1 0  0 0 0 1
  #shape_sphere 0  0 0 0  1
  #group_begin 1 0 0 0  0 1 0 0  0 0 1 0  0 0 0 1
    #shape_cylinder 0  0 0 0  1 2
  #group_end
#group_end
#vertex 0 0 0  0 0 1  .5 .5
";
    assert_eq!(formatted(text), expected);
}

#[test]
fn windows_line_ends_are_one_line_end() {
    let text =
        "#light_num 0\r\n#texture_num 0 // none\r\n\r\n#material_num 0\r#vertex_num 0\r\r#ray_file_num 0";
    let expected =
        "#light_num 0\n#texture_num 0  // none\n\n#material_num 0\n#vertex_num 0\n\n#ray_file_num 0\n";
    assert_eq!(formatted(text), expected);
}

#[test]
fn comments_stay_where_they_stand() {
    let text = "
// top   \n\n/* a
   block */ // and more
#light_num 2//one word
// above
   #light_dir 1 1 1 0 0 -1 // behind


 // on its own
#group_begin // to the left
1 0 0 -3 // first row
0 1 0 0
0 0 1 /* z */ 0   0 0 0 1 // last row
  // inside
#shape_sphere /* material */ -1 /* centre */ 0 0 0 1
// end
#group_end /* done */ // done
#ambient 1 // red
1
// green
1
// last";
    // Tokens run up to the next blank, so the hint's number is no number here: layout does not mind.
    let expected = "\
// top

/* a
   block */  // and more
#light_num 2//one word
// above
#light_dir 1 1 1  0 0 -1  // behind

// on its own
#group_begin  // to the left
  1 0 0 -3  // first row
  0 1 0 0
  0 0 1 /* z */ 0
  0 0 0 1  // last row
  // inside
  #shape_sphere
    /* material */ -1
    /* centre */ 0 0 0
    1
  // end
#group_end  /* done */  // done
#ambient
  1  // red
  1
  // green
  1
// last
";
    assert_eq!(formatted(text), expected);
}

#[test]
fn long_directives_are_broken_between_groups() {
    let long = "0.12345678901234567";
    let row = format!("{long} {long} {long} {long}");
    let text = format!("#group_begin {row} {row} {row} 0 0 0 1 #group_end");
    let expected = format!("#group_begin\n  {row}\n  {row}\n  {row}\n  0 0 0 1\n#group_end\n");
    assert_eq!(formatted(&text), expected);
    let text = format!("#shape_triangle -1 {}", format!("{long} ").repeat(24));
    let made = formatted(&text);
    assert!(made.lines().all(|line| line.len() <= WIDTH), "{made}");
    assert!(made.lines().skip(1).all(|line| line.starts_with("  0.")), "{made}");
    assert!(made.starts_with("#shape_triangle -1  0."), "{made}");
    // One word longer than a line, and one that is not of the language, stand as they are.
    let name = "x".repeat(200);
    assert_eq!(formatted(&format!("#texture   {name}")), format!("#texture {name}\n"));
    assert_eq!(formatted("#nothing  1  2   -- three"), "#nothing 1 2 -- three\n");
}

#[test]
fn what_is_uncertain_is_refused() {
    for (text, start) in [("#texture \"abc", 9), ("#ambient 1 1 1 /* x", 15), ("/*", 0), ("#material !x", 10)]
    {
        match format_text(text.as_bytes()) {
            Err(FormatError::Unterminated(fault)) => assert_eq!(fault.start, start, "{text}"),
            other => panic!("{text}: {other:?}"),
        }
    }
    assert_eq!(format_text(b" My scene #ambient"), Err(FormatError::StrayText(1)));
    assert_eq!(format_text(b""), Ok(Vec::new()));
    assert_eq!(format_text(b"\n// only\n\n"), Ok(b"// only\n".to_vec()));
}

#[test]
fn a_difference_is_seen() {
    let same = |a: &str, b: &str| says_the_same(a.as_bytes(), b.as_bytes());
    assert!(same("#a  1 // x \r\n", "#a\n1 // x"));
    assert!(same("#Camera", "#camera"));
    for (a, b) in
        [("#a 1", "#a 1.0"), ("#a 1", "#a"), ("#a", "#a 1"), ("#a // x", "#a"), ("#a !x!", "#a !x !")]
    {
        assert!(!same(a, b), "{a} {b}");
    }
}

#[test]
fn long_texts_cost_their_length() {
    let many = "1 /* x */ ".repeat(200_000);
    let deep = "#group_begin 1 0 0 0 0 1 0 0 0 0 1 0 0 0 0 1 ".repeat(20_000);
    for text in [
        format!("#ambient {many}"),
        format!("#nothing {many}"),
        format!("#nothing {}", "1 ".repeat(1_000_000)),
        deep,
    ] {
        let begin = std::time::Instant::now();
        let made = formatted(&text);
        assert!(made.len() < 10 * text.len());
        assert!(begin.elapsed().as_secs_f64() < 10.0);
    }
}

/// Every included file is there and says little.
struct Parts;

impl Files for Parts {
    fn read(&self, _: &Path) -> io::Result<Vec<u8>> {
        Ok(b"#ambient 0 0 0\n".to_vec())
    }
}

/// The files as read; `None` where something is wrong with them.
fn read(path: &str, text: &[u8], files: &dyn Files) -> Option<Vec<SceneFile>> {
    let loaded = load_text(path, text, files, &LoadOptions::default());
    loaded.scene.map(|scene| scene.files.into_iter().map(SceneFile::without_places).collect())
}

/// Formatting a file on disk changes nothing of what it means.
fn means_the_same(path: &Path) {
    let text = std::fs::read(path).unwrap();
    let name = path.to_str().unwrap();
    let diagnostics = load_text(name, text.clone(), &Disk, &LoadOptions::default()).diagnostics;
    if diagnostics.iter().any(|diagnostic| is_structural(diagnostic.code)) {
        return;
    }
    let made = format_text(&text).unwrap_or_else(|fault| panic!("{name}: {fault}"));
    assert!(says_the_same(&text, &made), "{name}");
    assert_eq!(format_text(&made).unwrap(), made, "{name}: not stable");
    assert!(read(name, &made, &Disk) == read(name, &text, &Disk), "{name}: means something else");
    let messages = |diagnostics: Vec<dotray_scene::Diagnostic>| -> Vec<_> {
        diagnostics.into_iter().map(|diagnostic| (diagnostic.code, diagnostic.message)).collect()
    };
    let before =
        messages(diagnostics).into_iter().filter(|(code, _)| *code != "letter-case").collect::<Vec<_>>();
    assert_eq!(messages(load_text(name, made, &Disk, &LoadOptions::default()).diagnostics), before, "{name}");
}

fn scenes_in(folder: &Path) -> Vec<PathBuf> {
    let mut found = Vec::new();
    for entry in std::fs::read_dir(folder).into_iter().flatten().flatten() {
        let path = entry.path();
        if path.is_dir() {
            found.extend(scenes_in(&path));
        } else if path.extension().is_some_and(|extension| extension == "ray") {
            found.push(path);
        }
    }
    found.sort();
    found
}

#[test]
fn every_scene_at_hand_keeps_its_meaning() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../..");
    let scenes = scenes_in(&root.join("scenes"));
    assert!(scenes.len() > 15);
    scenes.iter().for_each(|path| means_the_same(path));
    scenes_in(&root.join("crates/scene/tests/messages")).iter().for_each(|path| means_the_same(path));
    if !root.join("../shared").exists() {
        println!("skipped, no ../shared");
    }
    scenes_in(&root.join("../shared/conformance")).iter().for_each(|path| means_the_same(path));
    scenes_in(&root.join("../shared/real-scenes")).iter().for_each(|path| means_the_same(path));
}

fn number() -> impl Strategy<Value = String> {
    prop_oneof![
        "[+-]?[0-9]{1,3}",
        "[+-]?[0-9]{0,2}\\.[0-9]{1,20}",
        "[0-9]{1,3}\\.",
        "-?[1-9](\\.[0-9]{0,3})?[eE][+-]?[0-2]",
    ]
}

fn numbers(count: usize) -> impl Strategy<Value = Vec<String>> {
    vec(number(), count)
}

/// White space and comments that may stand between two tokens.
fn gap() -> impl Strategy<Value = String> {
    prop_oneof![
        8 => Just(" ".to_owned()),
        4 => "[ \t\r\n]{1,4}",
        1 => "[ \n]{0,2}".prop_map(|blank| format!("{blank} /* x\n  #camera */ ")),
        1 => "[ \n]{0,2}".prop_map(|blank| format!("{blank} /* y */\n")),
        1 => "[ \n]{0,2}".prop_map(|blank| format!("{blank} // z \"!  \n")),
        1 => "[ \n]{0,2}".prop_map(|blank| format!("{blank} /*a*/ /*b*/// c\r\n")),
    ]
}

fn directive() -> impl Strategy<Value = Vec<String>> {
    let with = |word: &'static str, last: Vec<&'static str>, count: usize| {
        numbers(count).prop_map(move |numbers| {
            let last = last.iter().map(|word| (*word).to_owned());
            [word.to_owned()].into_iter().chain(numbers).chain(last).collect::<Vec<_>>()
        })
    };
    prop_oneof![
        with("#background", vec![], 3),
        with("#AMBIENT", vec![], 3),
        with("#light_point", vec![], 9),
        with("#light_dir", vec!["0", "1", "-1"], 3),
        with("#light_num", vec!["0"], 0),
        with("#texture", vec!["\"a  b.bmp\""], 0),
        with("#texture", vec!["a#b!c//d.bmp"], 0),
        with("#material", vec!["1", "-1", "!two\n  lines // of #text!"], 14),
        with("#material", vec!["1", "-1", "!!"], 14),
        with("#vertex", vec![], 8),
        with("#shape_sphere -1", vec!["2"], 3),
        with("#shape_box -1", vec!["2", "0", "1.5"], 3),
        with("#shape_cone -1", vec!["1", "1"], 3),
        with("#shape_triangle -1 0 0 0 1 0 0 0 1 0", vec![], 15),
        with("#ray_file", vec!["part.ray"], 0),
        with("#group_begin 1 0 0 3 0 1 0 0 0 0 1 0", vec!["0", "0", "0", "1", "", "#group_end"], 0),
    ]
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 400, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn generated_scenes_keep_their_meaning(
        directives in vec(directive(), 0..12),
        gaps in vec(gap(), 400),
        nested in any::<bool>(),
    ) {
        let mut text = String::new();
        let mut gaps = gaps.into_iter().cycle();
        for (number, directive) in directives.iter().enumerate() {
            let open = "#group_begin 2 0 0 0  0 2 0 0  0 0 2 0  0 0 0 1";
            if nested && number % 3 == 0 {
                text.push_str(open);
                text.push_str(&gaps.next().unwrap());
            }
            for word in directive.iter().flat_map(|words| match words.starts_with(['"', '!']) {
                true => vec![words.as_str()],
                false => words.split(' ').collect(),
            }) {
                text.push_str(word);
                text.push_str(&gaps.next().unwrap());
                text.push(' ');
            }
            if nested && number % 3 == 0 {
                text.push_str("#group_end\n");
            }
        }
        let made = format_text(text.as_bytes()).unwrap();
        prop_assert!(says_the_same(text.as_bytes(), &made), "{}\n{}", text, String::from_utf8_lossy(&made));
        prop_assert_eq!(&format_text(&made).unwrap(), &made, "not stable: {}", text);
        let before = read("main.ray", text.as_bytes(), &Parts);
        prop_assert!(before.is_some() || directives.is_empty(), "{}", text);
        prop_assert_eq!(read("main.ray", &made, &Parts), before, "{}", text);
    }

    #[test]
    fn any_bytes_end_in_a_layout_or_a_fault(bytes in vec(prop_oneof![
        Just(b' '), Just(b'\n'), Just(b'#'), Just(b'!'), Just(b'"'), Just(b'/'), Just(b'*'), Just(b'a'), any::<u8>()
    ], 0..200)) {
        if let Ok(made) = format_text(&bytes) {
            prop_assert!(says_the_same(&bytes, &made));
            prop_assert_eq!(format_text(&made), Ok(made.clone()));
        }
    }
}
