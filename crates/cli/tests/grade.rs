//! `dotray grade`: small programs, right and wrong, graded by the real thing.

#![cfg(unix)]

mod common;

use common::Folder;
use common::Outcome;
use common::root;
use serde_json::Value;
use std::os::unix::fs::PermissionsExt;
use std::time::Duration;
use std::time::Instant;

const SUITE: &str = "\
title = 'Small & <sharp>'
format = 'bmp'
[defaults]
width = 64
height = 48
time_limit = 20
file_limit = 1
memory_limit = 1024
[[test]]
name = 'lit'
title = 'A ball & a box'
scene = 'lit.ray'
points = 4
advice = 'Look at the normals.'
[[test]]
name = 'turned'
scene = 'deep/turned.ray'
[[test]]
name = 'deep'
scene = 'mirrors.ray'
recursion = 2
";

const HEAD: &str = "\
#camera 0 1 7  0 -.1 -1  0 1 0  .35
#background .15 .2 .3
#ambient .2 .2 .2
#light_dir 1 1 1  .6 -.8 -.7
#material .8 .2 .1  .8 .2 .1  .4 .4 .4  0 0 0  .5 0 1 -1 !red!
";

/// A folder with a suite and a program `tracer`, a shell script that has our own program as `$DOTRAY`.
fn folder(script: &str) -> Folder {
    let folder = Folder::new();
    folder.put("suite.toml", SUITE.as_bytes());
    std::fs::create_dir(folder.path("deep")).expect("a folder");
    let lit = "#shape_sphere 0  -1 .5 0  1\n#shape_box 0  1.3 .2 0  .8 1.2 .8\n";
    let turned =
        "#group_begin .8 -.6 0 1  .6 .8 0 .3  0 0 1 0  0 0 0 1\n#shape_box 0  0 0 0  2 .7 1\n#group_end\n";
    let mirrors = "#material 0 0 0  0 0 0  .9 .9 .9  0 0 0  .9 0 1 -1 !mirror!\n#shape_box 1  -1.6 .5 0  .1 4 9\n\
        #shape_box 1  1.6 .5 0  .1 4 9\n#shape_sphere 0  0 0 0  .6\n";
    folder.put("lit.ray", format!("{HEAD}{lit}").as_bytes());
    folder.put("deep/turned.ray", format!("{HEAD}{turned}").as_bytes());
    folder.put("mirrors.ray", format!("{HEAD}{mirrors}").as_bytes());
    let script = format!("#!/bin/sh\nDOTRAY='{}'\n{script}\n", env!("CARGO_BIN_EXE_dotray"));
    folder.put("tracer", script.as_bytes());
    std::fs::set_permissions(folder.path("tracer"), std::fs::Permissions::from_mode(0o755))
        .expect("permissions");
    folder
}

fn grade(folder: &Folder, options: &[&str]) -> Outcome {
    let mut command = folder.command("grade suite.toml --program");
    command.arg("./tracer {scene} {output} {width} {height} {recursion} {cutoff}");
    let output = command.args(options).output().expect("the program starts");
    let stderr = String::from_utf8_lossy(&output.stderr).into_owned();
    Outcome { code: output.status.code(), stdout: output.stdout, stderr }
}

/// The report as JSON, with the exit code that goes with it.
fn graded(script: &str) -> Value {
    let folder = folder(script);
    let outcome = grade(&folder, &["--json", "report.json"]);
    let json: Value = serde_json::from_slice(&folder.get("report.json")).expect("one JSON object");
    let code = if json["points"] == json["max_points"] { 0 } else { 3 };
    outcome.expect(code);
    json
}

fn names(test: &Value) -> Vec<&str> {
    test["hints"].as_array().expect("a list").iter().filter_map(|hint| hint["name"].as_str()).collect()
}

const RIGHT: &str = "exec \"$DOTRAY\" render \"$@\"";

#[test]
fn a_right_program_has_all_points() {
    let json = graded(RIGHT);
    assert_eq!((&json["points"], &json["max_points"]), (&Value::from(6.0), &Value::from(6.0)), "{json:#}");
    assert_eq!(json["tests"][0]["figures"]["mean"], 0.0);
    assert_eq!(
        json["tests"][1]["command"]
            .as_str()
            .map(|c| c.ends_with("deep/turned.ray picture.bmp 64 48 5 0.002")),
        Some(true),
        "{json:#}"
    );
}

#[test]
fn wrong_programs_learn_what_is_wrong() {
    let flipped = "\"$DOTRAY\" render \"$1\" a.ppm $3 $4 $5 $6 -q || exit 9\n\
        { head -n 3 a.ppm; tail -n +4 a.ppm | xxd -p -c $(($3 * 3)) | tac | xxd -r -p; } > b.ppm; cp b.ppm \"$2\"";
    let edit = |program: &str| {
        format!("sed -E '{program}' \"$1\" > wrong.ray; shift; exec \"$DOTRAY\" render wrong.ray \"$@\"")
    };
    let fewer = "exec \"$DOTRAY\" render \"$1\" \"$2\" $3 $4 $(($5 - 1)) $6";
    let cases = [
        (flipped.to_owned(), 0, "upside-down"),
        (edit("/^#camera/s/\\.35/.7/"), 0, "half-angle-doubled"),
        (edit("/^#light/d"), 0, "unlit"),
        (edit("s/(#light_dir 1 1 1) *.6 -.8 -.7/\\1 -.6 .8 .7/"), 0, "light-reversed"),
        (edit("s/0 0 0  \\.5 0 1 -1/0 0 0  .00390625 0 1 -1/"), 0, "exponent"),
        (edit("s/\\.8 -\\.6 0 1  \\.6 \\.8 0 \\.3/.8 .6 0 0  -.6 .8 0 0/"), 1, "transposed"),
        (edit("s/\\.8 -\\.6 0 1  \\.6 \\.8 0 \\.3/.8 .6 0 1  -.6 .8 0 .3/"), 1, "rotations-reversed"),
        (fewer.to_owned(), 2, "one-bounce-less"),
    ];
    for (script, test, hint) in cases {
        if script.contains("xxd") && !["xxd", "tac"].iter().all(|tool| is_installed(tool)) {
            println!("skipped, no xxd or tac");
            continue;
        }
        let json = graded(&script);
        let test = &json["tests"][test];
        assert_eq!(names(test).first(), Some(&hint), "{script}: {test:#}");
        assert!(test["points"].as_f64() < test["max_points"].as_f64(), "{test:#}");
    }
}

fn is_installed(tool: &str) -> bool {
    std::process::Command::new(tool).arg("--version").output().is_ok()
}

#[test]
fn nearly_right_is_worth_more_than_wrong() {
    // Another oversampling: edges differ a little.
    let json = graded("exec \"$DOTRAY\" render \"$@\" --aa grid=2");
    let first = &json["tests"][0];
    let points = first["points"].as_f64().expect("a number");
    assert!(["close", "partly"].contains(&first["verdict"].as_str().expect("a word")), "{first:#}");
    assert!(points > 1.0 && points < 4.0, "{first:#}");
    let json = graded("\"$DOTRAY\" render \"$1\" \"$2\" $3 $4 $5 $6; echo warning; exit 1");
    assert_eq!(json["tests"][0]["points"], 4.0, "an exit code costs nothing where the picture is right");
    assert_eq!(json["tests"][0]["reasons"][0], "the program ended with exit code 1");
    let json = graded("\"$DOTRAY\" render \"$1\" \"$2\" $4 $3 $5 $6 -q");
    assert_eq!(json["points"], 0.0);
    assert!(
        json["tests"][0]["reasons"][0].as_str().is_some_and(|reason| reason.contains("64 x 48 and 48 x 64"))
    );
}

/// Each of these does harm in the second test only.
#[test]
fn harm_costs_one_test_only() {
    let harms = [
        ("kill -SEGV $$", "signal 11"),
        ("exit 0", "wrote no `picture.bmp`"),
        ("echo rubbish > \"$2\"; exit 0", "cannot be read"),
        ("exec yes > \"$2\"", "over 1 MiB"),
        ("exec yes", "over 1 MiB"),
        ("ln -s /dev/zero \"$2\"; exit 0", "no regular file"),
        ("mkfifo \"$2\"; exit 0", "no regular file"),
        ("mkdir \"$2\"; exit 0", "no regular file"),
        ("x=$(head -c 1500000000 /dev/zero | tr '\\0' x); exec \"$DOTRAY\" render \"$@\"", "the program"),
        ("chmod -R 0 .; rm -rf .. 2>/dev/null; exit 0", "picture.bmp"),
        ("printf 'P6 2000000000 2000000000 255 ' > \"$2\"; exit 0", "refused"),
    ];
    for (harm, told) in harms {
        let json = graded(&format!("case \"$1\" in *turned*) {harm};; esac\n{RIGHT}"));
        assert_eq!(json["points"], 5.0, "{harm}: {json:#}");
        let test = &json["tests"][1];
        let reasons = test["reasons"].to_string();
        assert!(reasons.contains(told), "{harm}: {reasons}");
    }
}

#[test]
fn hanging_programs_and_their_children_are_ended() {
    let start = Instant::now();
    let marker = format!("{}", 200_000 + std::process::id());
    let script = format!(
        "case \"$1\" in *turned*)\nfor i in 1 2 3; do (while :; do sleep {marker}; done) & \
         setsid sleep {marker} & done\nsleep {marker};; esac\n{RIGHT}"
    );
    let folder = folder(&script);
    let suite = SUITE.replace("scene = 'deep/turned.ray'", "scene = 'deep/turned.ray'\ntime_limit = 1");
    folder.put("suite.toml", suite.as_bytes());
    let outcome = grade(&folder, &[]).expect(3);
    assert!(outcome.text().contains("the program was stopped after 1 seconds"), "{}", outcome.text());
    assert!(outcome.text().contains("5 of 6 points, 2 of 3 tests right"), "{}", outcome.text());
    assert!(start.elapsed() < Duration::from_secs(15));
    std::thread::sleep(Duration::from_millis(200));
    let left = std::fs::read_dir("/proc").into_iter().flatten().flatten().filter(|entry| {
        let line = std::fs::read(entry.path().join("cmdline")).unwrap_or_default();
        line.starts_with(b"sleep") && String::from_utf8_lossy(&line).contains(&marker)
    });
    assert_eq!(left.count(), 0);
}

/// What a program does to the suite's files does not matter to later tests.
#[test]
fn the_suite_is_out_of_reach() {
    let folder = folder("");
    let scene = folder.path("mirrors.ray");
    let script = format!(
        "#!/bin/sh\necho '#camera' > '{}'\necho x > \"$1.bak\"\nexec '{}' render \"$@\"\n",
        scene.display(),
        env!("CARGO_BIN_EXE_dotray")
    );
    folder.put("tracer", script.as_bytes());
    let before = folder.names();
    grade(&folder, &["--jobs", "1"]).expect(0);
    assert_eq!(folder.names(), before);
}

#[test]
fn reports_are_what_others_read() {
    let folder = folder(&format!(
        "echo 'a <b> & \"c\"'\ncase \"$1\" in *lit*) exit 3;; *mirr*) set -- \"$1\" \"$2\" $3 $4 1 $6;; esac\n{RIGHT}"
    ));
    let options = "--html p.html --junit j.xml --gradescope r.json --json o.json --quiet";
    let outcome = grade(&folder, &options.split(' ').collect::<Vec<_>>()).expect(3);
    assert!(outcome.stdout.is_empty() && outcome.stderr.is_empty(), "{}", outcome.stderr);
    let text = |name: &str| String::from_utf8(folder.get(name)).expect("UTF-8");

    let xml = text("j.xml");
    for part in [
        "<testsuite name=\"Small &amp; &lt;sharp&gt;\" tests=\"3\" failures=\"1\" errors=\"1\"",
        "<testcase classname=\"Small &amp; &lt;sharp&gt;\" name=\"lit\"",
        "<error type=\"no picture\" message=\"0 of 4 points\">the program ended with exit code 3",
        "Look at the normals.</error>",
        "<system-out>a &lt;b&gt; &amp; &quot;c&quot;",
    ] {
        assert!(xml.contains(part), "no {part} in {xml}");
    }

    let json: Value = serde_json::from_str(&text("r.json")).expect("one JSON object");
    assert!(json["score"].as_f64() < Some(2.0) && json["execution_time"].as_f64() > Some(0.0), "{json:#}");
    let first = &json["tests"][0];
    assert_eq!((&first["score"], &first["max_score"]), (&Value::from(0.0), &Value::from(4.0)));
    assert_eq!((&first["name"], &first["status"]), (&Value::from("A ball & a box"), &Value::from("failed")));
    assert_eq!(json["tests"][1]["status"], "passed");
    let output = json["tests"][2]["output"].as_str().expect("text");
    assert!(output.contains("Likely fault: The recursion stops one bounce too early"), "{output}");

    let html = text("p.html");
    // Two pictures with a difference and a flicker pair each, and one that is wanted only.
    assert_eq!(html.matches("<img src=\"data:image/png;base64,").count(), 2 * 5 + 1);
    assert!(
        html.contains("Small &amp; &lt;sharp&gt;") && !html.contains("<sharp>") && !html.contains("a <b>")
    );
    for outside in ["http://", "https://", "src=\"/", "<link"] {
        assert!(!html.contains(outside), "the page needs {outside}");
    }
    let own: Value = serde_json::from_str(&text("o.json")).expect("one JSON object");
    assert_eq!(own["tests"][0]["stdout"], "a <b> & \"c\"\n");
}

#[test]
fn suites_are_listed_and_tests_chosen() {
    let folder = folder(RIGHT);
    let list = folder.run("grade suite.toml").expect(0).text();
    assert!(list.contains("A ball & a box") && list.contains("3 tests, 6 points"), "{list}");
    let text = grade(&folder, &["--only", "deep,lit"]).expect(0).text();
    assert!(text.contains("5 of 5 points, 2 of 2") && !text.contains("turned"), "{text}");
    let ready = root().join("grading");
    let list = folder.run(&format!("grade {}", ready.display())).expect(0).text();
    assert!(list.contains("sphere") && list.contains("oversampling"), "{list}");
}

#[test]
fn faults_of_suites_and_commands_are_told() {
    let folder = folder(RIGHT);
    folder.put("broken.toml", SUITE.replace("width = 64", "widht = 64").as_bytes());
    folder.put("absent.toml", SUITE.replace("lit.ray", "none.ray").as_bytes());
    folder.put("faulty.toml", SUITE.replace("lit.ray", "wrong.ray").as_bytes());
    let run = |words: &[&str]| {
        let output = folder.command("grade").args(words).output().expect("the program starts");
        let stderr = String::from_utf8_lossy(&output.stderr).into_owned();
        Outcome { code: output.status.code(), stdout: output.stdout, stderr }
    };
    let program = "./tracer {scene} {output}";
    run(&["none.toml"]).expect(1).says("cannot read `none.toml`");
    run(&["broken.toml"]).expect(1).says("widht");
    run(&["absent.toml", "--program", program]).expect(1).says("none.ray");
    run(&["faulty.toml", "--program", program]).expect(1).says("#shape_sphere");
    run(&["suite.toml", "--program", "./tracer {scene}"]).expect(2).says("{output}");
    run(&["suite.toml", "--program", "./none {scene} {output}"])
        .expect(2)
        .says("cannot find the program `./none`");
    run(&["suite.toml", "--program", program, "--only", "x"]).expect(2).says("`x`");
    run(&["suite.toml", "--program", program, "--html", "no/a.html"]).expect(1).says("no folder");
    run(&["suite.toml", "--program", program, "--jobs", "0"]).expect(2);
}
