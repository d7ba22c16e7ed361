//! Every command of the tutorials runs, in a copy of the folders that they name, and ends as the page says.
//!
//! A block ```` ```console ```` holds one command a line, after `$ `; `# exit N` at a line's end says that it ends with
//! that code, else it ends with 0.

#![cfg(unix)]

use dotray_tests::corpus::root;
use dotray_tests::program;
use std::path::Path;
use std::process::Command;

/// A command and the code with which it ends.
#[derive(Debug, PartialEq)]
struct Step {
    command: String,
    exit: i32,
}

fn steps(page: &str) -> Vec<Step> {
    let mut steps = Vec::new();
    let mut console = false;
    for line in page.lines() {
        if line.starts_with("```") {
            console = line == "```console";
        } else if console {
            let command = line.strip_prefix("$ ").unwrap_or_else(|| panic!("not a command: {line}"));
            let (command, exit) = command.rsplit_once(" # exit ").unwrap_or((command, "0"));
            steps.push(Step { command: command.to_owned(), exit: exit.parse().expect("a code") });
        }
    }
    steps
}

/// The pictures of the tutorial that a page shows: `name.png` of `![…](tutorial/name.png)`.
fn pictures(page: &str) -> Vec<&str> {
    let links = page.split("](tutorial/").skip(1);
    links.filter_map(|rest| rest.split(')').next()).filter(|name| name.ends_with(".png")).collect()
}

fn copy(from: &Path, to: &Path) {
    std::fs::create_dir_all(to).expect("a folder");
    for entry in std::fs::read_dir(from).expect("a folder of the checkout").flatten() {
        let (from, to) = (entry.path(), to.join(entry.file_name()));
        if from.is_dir() {
            copy(&from, &to);
        } else {
            std::fs::copy(&from, &to).expect("a copy");
        }
    }
}

/// Runs a page's commands as its reader does, with `dotray` on the path, and answers with the folder they ran in.
fn run_page(name: &str, least: usize) -> tempfile::TempDir {
    let scratch = tempfile::tempdir().expect("a temporary folder");
    let docs = scratch.path().join("docs");
    copy(&root().join("docs/tutorial"), &docs.join("tutorial"));
    copy(&root().join("docs/long"), &docs.join("long"));
    copy(&root().join("grading"), &scratch.path().join("grading"));
    let bin = scratch.path().join("bin");
    std::fs::create_dir(&bin).expect("a folder");
    std::os::unix::fs::symlink(program::path(), bin.join("dotray")).expect("a link");
    let path = format!("{}:{}", bin.display(), std::env::var("PATH").unwrap_or_default());
    let page = std::fs::read_to_string(root().join("docs").join(name)).expect("the page");
    let steps = steps(&page);
    assert!(steps.len() >= least, "only {} commands in {name}", steps.len());
    for Step { command, exit } in steps {
        let mut shell = Command::new("sh");
        let output = shell.args(["-c", &command]).current_dir(&docs).env("PATH", &path).output();
        let output = output.expect("a shell");
        let said = String::from_utf8_lossy(&output.stderr);
        assert_eq!(output.status.code(), Some(exit), "{name}: {command}\n{said}");
    }
    scratch
}

/// The pictures on the page are those that its commands make; `UPDATE=1` stores them anew.
#[test]
fn every_command_for_students_runs() {
    let scratch = run_page("tutorial.md", 25);
    let page = std::fs::read_to_string(root().join("docs/tutorial.md")).expect("the page");
    let shown = pictures(&page);
    assert!(shown.len() >= 15, "{shown:?}");
    for name in shown {
        let made = std::fs::read(scratch.path().join("docs").join(name)).expect("a command made it");
        let stored = root().join("docs/tutorial").join(name);
        if std::env::var_os("UPDATE").is_some() {
            std::fs::write(&stored, &made).expect("the picture is stored");
        }
        let stored = std::fs::read(&stored).unwrap_or_default();
        assert!(
            stored == made,
            "docs/tutorial/{name} is not what the page's command makes; UPDATE=1 stores it"
        );
    }
}

#[test]
fn every_command_for_teachers_runs() {
    let scratch = run_page("teaching.md", 20);
    let report = std::fs::read_to_string(scratch.path().join("docs/report.html")).expect("the page");
    assert!(report.starts_with("<!DOCTYPE html>") || report.starts_with("<!doctype html>"), "{report:.60}");
}

#[test]
fn every_command_for_long_work_runs() {
    run_page("long.md", 10);
}

/// What Gradescope reads after `run_autograder` has seen these files of a submission.
fn autograded(files: &[(&str, &str)]) -> serde_json::Value {
    let base = tempfile::tempdir().expect("a temporary folder");
    let (source, submission) = (base.path().join("source"), base.path().join("submission"));
    copy(&root().join("grading/homework"), &source.join("suite"));
    std::fs::copy(root().join("grading/gradescope/run_autograder"), source.join("run_autograder"))
        .expect("the script");
    std::os::unix::fs::symlink(program::path(), source.join("dotray")).expect("a link");
    std::fs::create_dir(&submission).expect("a folder");
    for (name, text) in files {
        let path = submission.join(name);
        std::fs::write(&path, text.replace("DOTRAY", &program::path().display().to_string()))
            .expect("a file of the submission");
        let mode = std::os::unix::fs::PermissionsExt::from_mode(0o755);
        std::fs::set_permissions(&path, mode).expect("permissions");
    }
    let mut script = Command::new(source.join("run_autograder"));
    let ended = script.env("AUTOGRADER", base.path()).output().expect("the script runs");
    assert_eq!(ended.status.code(), Some(0), "{}", String::from_utf8_lossy(&ended.stderr));
    let results = std::fs::read(base.path().join("results/results.json")).expect("results.json");
    let results: serde_json::Value = serde_json::from_slice(&results).expect("one JSON object");
    let graded = results["tests"].is_array();
    assert_eq!(base.path().join("results/report.html").exists(), graded);
    results
}

#[test]
fn the_autograder_gives_points_and_says_why_not() {
    let honest = "#!/bin/sh\nexec DOTRAY render \"$@\"\n";
    let results = autograded(&[("raytracer", honest)]);
    assert_eq!((&results["score"], results["tests"].as_array().map(Vec::len)), (&11.0.into(), Some(4)));

    let short = "#!/bin/sh\nexec DOTRAY render \"$1\" \"$2\" $3 $4 $(($5 + 1)) $6\n";
    let results = autograded(&[("raytracer", short)]);
    let told = results["tests"][1]["output"].as_str().expect("words").to_owned();
    assert!(
        results["score"].as_f64() < Some(11.0) && told.contains("see page 12 of the notes"),
        "{results:#}"
    );

    // A submission that is built, one that does not build, and one that is no program at all.
    if Command::new("make").arg("--version").output().is_ok() {
        let makefile = "raytracer: tracer.sh\n\tcp tracer.sh raytracer\n";
        let results = autograded(&[("Makefile", makefile), ("tracer.sh", honest)]);
        assert_eq!(results["score"], 11.0);
        let broken = "raytracer:\n\t@echo 'ray.c:3: expected \";\" \\ before }' >&2; exit 1\n";
        let results = autograded(&[("Makefile", broken)]);
        assert_eq!(results["score"], 0);
        let told = results["output"].as_str().expect("words");
        assert!(told.starts_with("make failed:") && told.contains("expected \";\" \\ before }"), "{told}");
    } else {
        println!("skipped, no make");
    }
    let results = autograded(&[("readme.txt", "not done yet")]);
    assert_eq!(results["score"].as_f64(), Some(0.0), "{results:#}");
}

#[test]
fn a_page_is_read_as_its_reader_reads_it() {
    let page = "$ no\n```sh\n$ no\n```\n```console\n$ dotray a 'b c' # exit 3\n```\n![a](tutorial/a.png)\n";
    assert_eq!(steps(page), [Step { command: "dotray a 'b c'".to_owned(), exit: 3 }]);
    assert_eq!(pictures(page), ["a.png"]);
}
