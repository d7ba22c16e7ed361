//! `dotray check`: faults with their places, the formats, the exit codes, the explanations.

mod common;

use common::BALLS;
use common::Folder;
use common::root;
use serde_json::Value;
use std::collections::BTreeSet;

/// One fault and one warning, the fault in a group of an included file.
const MAIN: &str = "#ray_file part.ray\n#ray_file_instance 0\n#light_num 2\n#light_dir 1 1 1  0 0 -1\n";
const PART: &str = "\
#group_begin 1 0 0 0  0 1 0 0  0 0 1 0  0 0 0 1
  #shape_sphere 0  0 0 0  1 // 100%, all of it
#group_end
";

fn faulty() -> Folder {
    let folder = Folder::new();
    folder.put("main.ray", MAIN.as_bytes());
    folder.put("part.ray", PART.as_bytes());
    folder
}

fn json(text: &str) -> Value {
    serde_json::from_str(text).unwrap_or_else(|error| panic!("{error} in: {text}"))
}

#[test]
fn a_clean_scene_ends_with_0_and_a_summary() {
    let folder = Folder::new();
    let ended = folder.run("check balls.ray").expect(0);
    assert_eq!((ended.text().as_str(), ended.stderr.as_str()), ("1 file: 0 errors, 0 warnings\n", ""));
}

#[test]
fn all_faults_of_all_files_come_in_one_run() {
    let folder = faulty();
    folder
        .put("first.ray", b"#shape_spere 0  0 0 0  1\n#camera 0 0 4  0 0 -1  0 1 0  45\n#texture gone.png\n");
    let text = folder.run("check first.ray main.ray balls.ray missing.ray").expect(1).text();
    let heads: Vec<&str> = text.lines().filter(|line| line.contains("]: ")).collect();
    let expected = [
        "first.ray:1:1: error[unknown-directive]: ",
        "first.ray:2:31: error[half-angle]: ",
        "first.ray:3:1: error[texture-not-found]: ",
        "main.ray:3:12: warning[count-hint]: ",
        "part.ray:2:17: error[unknown-material]: ",
        "missing.ray: error[cannot-read]: ",
    ];
    assert_eq!(heads.len(), expected.len(), "{text}");
    for (head, start) in heads.iter().zip(expected) {
        assert!(head.starts_with(start), "{head} is not {start}: {text}");
    }
    for part in [
        "\n1 | #shape_spere 0  0 0 0  1\n  | ^^^^^^^^^^^^ no directive has this name\n",
        "help: did you mean `#shape_sphere`?",
        "45 degrees are 0.7854",
        "included from main.ray:1:1",
        "note: inside this group\n --> part.ray:1:1",
        "folders searched: `.`",
    ] {
        assert!(text.contains(part), "no `{part}` in: {text}");
    }
    assert!(text.ends_with("\n4 files: 5 errors, 1 warning\n"), "{text}");
}

#[test]
fn warnings_count_only_where_one_is_strict() {
    let folder = Folder::new();
    let text = folder.run("check warning.ray").expect(0).text();
    assert!(text.starts_with("warning.ray:2:1: warning[repeated-directive]: "), "{text}");
    assert!(text.ends_with("1 file: 0 errors, 1 warning\n"), "{text}");
    assert_eq!(folder.run("check --strict warning.ray").expect(1).text(), text);
    folder.run("check --strict balls.ray").expect(0);
}

#[test]
fn standard_input_and_folders_are_read() {
    let folder = Folder::new();
    let text = folder.run_with_input("check -", common::WRONG.as_bytes()).expect(1).text();
    assert!(text.starts_with("<stdin>:2:1: error[unknown-directive]"), "{text}");
    std::fs::create_dir_all(folder.path("deep/er")).unwrap();
    std::fs::create_dir_all(folder.path("deep/.hidden")).unwrap();
    std::fs::create_dir_all(folder.path("empty")).unwrap();
    folder.put("deep/a.ray", BALLS.as_bytes());
    folder.put("deep/er/B.RAY", BALLS.as_bytes());
    folder.put("deep/notes.txt", b"#shape_spere");
    folder.put("deep/.hidden/c.ray", b"#shape_spere");
    assert_eq!(folder.run("check deep").expect(0).text(), "2 files: 0 errors, 0 warnings\n");
    let text = folder.run("check .").expect(1).text();
    assert!(text.contains("\nwrong.ray:2:1: ") || text.starts_with("wrong.ray:2:1: "), "{text}");
    let text = folder.run("check empty").expect(1).text();
    assert!(text.contains("no .ray file in or below the folder `empty`"), "{text}");
}

#[test]
fn parts_need_no_camera_and_are_told_once() {
    let folder = faulty();
    folder.put("other.ray", format!("{MAIN}#camera 0 0 9  0 0 -1  0 1 0  .4").as_bytes());
    let part = PART.replace("_sphere 0", "_sphere -1");
    let text = folder.run("check main.ray other.ray part.ray").expect(1).text();
    assert_eq!(text.matches("unknown-material").count(), 1, "{text}");
    folder.put("part.ray", part.as_bytes());
    let text = folder.run("check other.ray part.ray").expect(0).text();
    assert!(!text.contains("no-light") && !text.contains("no-camera"), "{text}");
    let text = folder.run("check part.ray").expect(0).text();
    assert!(text.contains("part.ray: warning[no-light]: ") && text.contains("no-camera"), "{text}");
}

#[test]
fn textures_are_looked_up_and_decoded() {
    let folder = Folder::new();
    std::fs::create_dir_all(folder.path("scenes/images")).unwrap();
    folder.run("render balls.ray good.png 4 4").expect(0);
    let text = format!(
        "{BALLS}#texture good.png\n#texture images\\wood.png\n#texture images\n#texture noise.png\n\
         #texture image/wood.png\n"
    );
    folder.put("scenes/a.ray", text.as_bytes());
    folder.put("scenes/images/wood.png", &folder.get("good.png"));
    folder.put("scenes/noise.png", b"\x89PNG\r\n\x1a\nno picture");
    let text = folder.run("check scenes/a.ray").expect(1).text();
    assert_eq!(text.matches("error[").count(), 3, "{text}");
    for part in [
        "scenes/a.ray:13:1: error[texture-not-found]: the texture `images` was not found",
        "cannot read `scenes/images`: it is a folder",
        "scenes/a.ray:14:1: error[texture-unreadable]: the texture `noise.png` cannot be decoded: ",
        "the file is `scenes/noise.png`",
        "scenes/a.ray:15:1: error[texture-not-found]: the texture `image/wood.png` was not found",
        "folders searched: `scenes/image`, `image`",
    ] {
        assert!(text.contains(part), "no `{part}` in: {text}");
    }
    folder.put("scenes/a.ray", format!("{BALLS}#texture Images/Wood.PNG\n#texture nosie.png").as_bytes());
    folder.run("check scenes/a.ray").expect(1);
    let text = folder.run("check scenes/a.ray").expect(1).text();
    assert!(text.contains("help: there is a file `scenes/noise.png`"), "{text}");
}

#[test]
fn the_slides_example_as_printed_is_explained() {
    let path = root().join("scenes/slides-as-printed.ray");
    let text = Folder::new().run(&format!("check {}", path.display())).expect(1).text();
    assert!(text.contains("slides-as-printed.ray:47:7: error[group-matrix]: "), "{text}");
    assert!(text.contains("`1 0 0 0  0 1 0 3  0 0 1 0  0 0 0 1` was probably meant"), "{text}");
    assert!(text.contains("`1 0 0 0  0 1 0 -3  0 0 1 0  0 0 0 1` was probably meant"), "{text}");
}

#[test]
fn every_scene_of_the_gallery_is_clean() {
    let folder = Folder::new();
    let scenes = root().join("scenes");
    let report = json(&folder.run(&format!("check --format json {}", scenes.display())).expect(1).text());
    let files: BTreeSet<&str> = report["diagnostics"]
        .as_array()
        .unwrap()
        .iter()
        .map(|found| found["file"].as_str().unwrap())
        .collect();
    assert!(files.iter().all(|file| file.ends_with("slides-as-printed.ray")), "{files:?}");
    assert_eq!((&report["errors"], &report["warnings"]), (&Value::from(2), &Value::from(0)));
}

#[test]
fn json_holds_everything() {
    let folder = faulty();
    let ended = folder.run("check --format json main.ray").expect(1);
    assert_eq!(ended.stderr, "");
    let report = json(&ended.text());
    assert_eq!((&report["version"], &report["files"]), (&Value::from(1), &Value::from(1)));
    assert_eq!((&report["errors"], &report["warnings"]), (&Value::from(1), &Value::from(1)));
    let found = &report["diagnostics"][1];
    for (key, value) in [
        ("severity", Value::from("error")),
        ("code", "unknown-material".into()),
        ("file", "part.ray".into()),
        ("line", 2.into()),
        ("column", 17.into()),
        ("end_line", 2.into()),
        ("end_column", 18.into()),
        ("help", Value::Null),
    ] {
        assert_eq!(found[key], value, "{key} in {found:#}");
    }
    let notes = found["notes"].as_array().unwrap();
    assert!(notes.iter().any(|note| note["message"] == "included from main.ray:1:1"), "{found:#}");
    assert!(notes.iter().any(|note| note["file"] == "part.ray" && note["line"] == 1), "{found:#}");
    let whole = json(&folder.run_with_input("check --format json -", b"#ambient 1 1 1").expect(0).text());
    let found = &whole["diagnostics"][0];
    assert_eq!((&found["file"], &found["line"]), (&Value::from("<stdin>"), &Value::Null));
}

#[test]
fn every_key_of_the_json_is_documented() {
    let folder = faulty();
    let report = json(&folder.run("check --format json main.ray").expect(1).text());
    let page = std::fs::read_to_string(root().join("docs/messages.md")).unwrap();
    let mut open = vec![&report];
    while let Some(value) = open.pop() {
        open.extend(value.as_array().into_iter().flatten());
        for (key, inner) in value.as_object().into_iter().flatten() {
            assert!(page.contains(&format!("`{key}`")), "`{key}` is not documented");
            open.push(inner);
        }
    }
}

#[test]
fn github_commands_are_escaped() {
    let folder = faulty();
    folder.put("a,b:100%.ray", b"#light_dir 1 1 1  0 0 -1\n#shape_sphere 50%  0 0 0  1\n");
    let text = folder.run("check --format github a,b:100%.ray main.ray").expect(1).text();
    let lines: Vec<&str> = text.lines().collect();
    assert_eq!(lines.len(), 3, "{text}");
    assert!(
        lines[0].starts_with(
            "::error file=a%2Cb%3A100%25.ray,line=2,col=15,endLine=2,endColumn=18,title=not-a-number::`m` of"
        ),
        "{text}"
    );
    assert!(lines[0].contains("not `50%25`%0A"), "{text}");
    assert!(lines[1].starts_with("::warning file=main.ray,line=3,col=12,"), "{text}");
    assert!(lines[2].contains("%0Anote: inside this group (part.ray:1:1)"), "{text}");
}

/// What the standard requires of a log, and that nothing stands in it that is not in its vocabulary.
#[test]
fn sarif_is_what_the_standard_wants() {
    let folder = faulty();
    folder.put("two words.ray", b"#shape_sphere x  0 0 0  1\n");
    let mut command = folder.command("check --format sarif main.ray balls.ray missing.ray");
    let output = command.arg("two words.ray").output().unwrap();
    assert_eq!(output.status.code(), Some(1));
    let log = json(&String::from_utf8(output.stdout).unwrap());
    assert_eq!(log["version"], "2.1.0");
    assert!(log["$schema"].as_str().unwrap().ends_with("sarif-schema-2.1.0.json"));
    keys(&log, &["$schema", "version", "runs"]);
    let [run] = log["runs"].as_array().unwrap().as_slice() else { panic!("{log:#}") };
    keys(run, &["tool", "columnKind", "results"]);
    assert_eq!(run["columnKind"], "unicodeCodePoints");
    let driver = &run["tool"]["driver"];
    keys(driver, &["name", "version", "semanticVersion", "informationUri", "rules"]);
    assert_eq!(
        (&driver["name"], &driver["version"]),
        (&Value::from("dotray"), &env!("CARGO_PKG_VERSION").into())
    );
    assert!(driver["informationUri"].as_str().unwrap().starts_with("https://"));
    let rules = driver["rules"].as_array().unwrap();
    let names: BTreeSet<&str> = rules.iter().map(|rule| rule["id"].as_str().unwrap()).collect();
    assert_eq!(names.len(), rules.len(), "ids of rules must differ");
    for rule in rules {
        keys(rule, &["id", "shortDescription", "fullDescription", "defaultConfiguration"]);
        assert!(!rule["shortDescription"]["text"].as_str().unwrap().is_empty());
        assert!(["error", "warning"].contains(&rule["defaultConfiguration"]["level"].as_str().unwrap()));
    }
    let results = run["results"].as_array().unwrap();
    assert_eq!(results.len(), 4);
    for result in results {
        keys(result, &["ruleId", "ruleIndex", "level", "message", "locations", "relatedLocations"]);
        let index = result["ruleIndex"].as_u64().unwrap() as usize;
        assert_eq!(rules[index]["id"], result["ruleId"]);
        assert!(["error", "warning"].contains(&result["level"].as_str().unwrap()));
        assert!(!result["message"]["text"].as_str().unwrap().is_empty());
        let related = result["relatedLocations"].as_array().into_iter().flatten();
        let ids: Vec<_> = related.clone().map(|location| location["id"].as_u64().unwrap()).collect();
        assert_eq!(ids, (0..ids.len() as u64).collect::<Vec<_>>());
        for location in result["locations"].as_array().unwrap().iter().chain(related) {
            keys(location, &["id", "message", "physicalLocation"]);
            location_is_sound(&location["physicalLocation"]);
        }
    }
    assert_eq!(results[3]["locations"][0]["physicalLocation"]["artifactLocation"]["uri"], "two%20words.ray");
    assert_eq!(results[1]["locations"][0]["physicalLocation"]["region"]["startLine"], 2);
    assert_eq!(results[2]["locations"][0]["physicalLocation"].get("region"), None);
}

fn location_is_sound(location: &Value) {
    keys(location, &["artifactLocation", "region"]);
    keys(&location["artifactLocation"], &["uri"]);
    let uri = location["artifactLocation"]["uri"].as_str().unwrap();
    assert!(uri.bytes().all(|byte| byte.is_ascii_alphanumeric() || b"-._~/%:".contains(&byte)), "{uri}");
    let Some(region) = location.get("region") else { return };
    keys(region, &["startLine", "startColumn", "endLine", "endColumn"]);
    let number = |key: &str| region[key].as_u64().unwrap();
    assert!(number("startLine") >= 1 && number("startColumn") >= 1);
    assert!((number("endLine"), number("endColumn")) >= (number("startLine"), number("startColumn")));
}

#[track_caller]
fn keys(value: &Value, known: &[&str]) {
    for key in value.as_object().unwrap_or_else(|| panic!("no object: {value}")).keys() {
        assert!(known.contains(&key.as_str()), "`{key}` is not of the standard's vocabulary used here");
    }
}

#[test]
fn codes_are_explained() {
    let folder = Folder::new();
    let text = folder.run("check --explain half-angle").expect(0).text();
    for part in
        ["error[half-angle]: ", "radians", "\nAn example:\n\n    #camera", "\nPut right:\n\n    #camera"]
    {
        assert!(text.contains(part), "no {part} in: {text}");
    }
    assert_eq!(folder.run("check --explain error[half-angle]").expect(0).text(), text);
    let list = folder.run("check --explain list").expect(0).text();
    assert!(list.lines().count() > 45 && list.contains("\nhalf-angle "), "{list}");
    assert_eq!(folder.run("check --explain all").expect(0).text(), list);
    for line in list.lines() {
        let code = line.split_whitespace().next().unwrap();
        let text = folder.run(&format!("check --explain {code}")).expect(0).text();
        assert!(text.contains(&format!("[{code}]")), "{text}");
    }
    folder.run("check --explain half-angel").expect(2).says("did you mean `half-angle`?");
    folder.run("check --explain unknown").expect(2).says("`unknown-vertex`").says("`unknown-directive`");
    folder.run("check --explain zzz").expect(2).says("--explain list");
    folder.run("check").expect(2).says("FILES");
    folder.run("check --explain half-angle balls.ray").expect(2);
    folder.run("check --format xml balls.ray").expect(2).says("sarif");
}

/// The examples of all codes, written to disk and checked by the program itself.
#[test]
fn the_examples_of_textures_give_their_codes() {
    let folder = Folder::new();
    folder.put("noise.png", b"no picture");
    for code in ["texture-not-found", "texture-unreadable"] {
        let text = folder.run(&format!("check --explain {code}")).expect(0).text();
        let example = text.lines().find(|line| line.starts_with("    #")).unwrap_or_default();
        folder.put("example.ray", format!("{BALLS}{example}\n").as_bytes());
        let report = json(&folder.run("check --format json example.ray").expect(1).text());
        let codes: Vec<&Value> =
            report["diagnostics"].as_array().unwrap().iter().map(|found| &found["code"]).collect();
        assert_eq!(codes, [code]);
    }
}

#[test]
fn colour_is_for_terminals() {
    let folder = Folder::new();
    assert!(!folder.run("check wrong.ray").expect(1).text().contains('\u{1b}'));
    let text = folder.run("check wrong.ray --color always").expect(1).text();
    assert!(text.contains('\u{1b}') && text.starts_with("wrong.ray:2:1: "), "{text}");
    assert!(!folder.run("check wrong.ray --color always --format json").expect(1).text().contains('\u{1b}'));
}
