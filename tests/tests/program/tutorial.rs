//! Every command of the tutorials runs, in a copy of the folders that they name, and ends as the page says.
//!
//! A block ```` ```console ```` holds one command a line, after `$ `; `# exit N` at a line's end says that it ends with
//! that code, else it ends with 0.

use dotray_tests::corpus::root;
use dotray_tests::program;
use std::path::Path;
use std::process::Command;

/// A command and the code with which it ends.
#[derive(Debug, PartialEq)]
struct Step {
    words: Vec<String>,
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
            steps.push(Step { words: words(command), exit: exit.parse().expect("a code") });
        }
    }
    steps
}

/// The words of a command; what stands between single quotes is one.
fn words(command: &str) -> Vec<String> {
    let mut words = Vec::new();
    for (index, part) in command.split('\'').enumerate() {
        if index % 2 == 1 {
            words.push(part.to_owned());
        } else {
            words.extend(part.split_whitespace().map(str::to_owned));
        }
    }
    words
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

fn run_page(name: &str, least: usize) {
    let scratch = tempfile::tempdir().expect("a temporary folder");
    copy(&root().join("docs/tutorial"), &scratch.path().join("docs/tutorial"));
    copy(&root().join("docs/long"), &scratch.path().join("docs/long"));
    copy(&root().join("grading"), &scratch.path().join("grading"));
    let page = std::fs::read_to_string(root().join("docs").join(name)).expect("the page");
    let steps = steps(&page);
    assert!(steps.len() >= least, "only {} commands in {name}", steps.len());
    let program = program::path();
    for Step { words, exit } in steps {
        assert_eq!(words[0], "dotray", "only dotray's own commands are run");
        // A student's program is looked for by its whole path here: no `dotray` need be installed.
        let whole = |word: &String| match word.strip_prefix("dotray ") {
            Some(rest) => format!("'{}' {rest}", program.display()),
            None => word.clone(),
        };
        let output = Command::new(program)
            .args(words[1..].iter().map(whole))
            .current_dir(scratch.path().join("docs"))
            .output()
            .expect("the program runs");
        let said = String::from_utf8_lossy(&output.stderr);
        assert_eq!(output.status.code(), Some(exit), "{name}: {}\n{said}", words.join(" "));
    }
}

#[test]
fn every_command_for_students_runs() {
    run_page("tutorial.md", 25);
}

#[test]
fn every_command_for_teachers_runs() {
    run_page("teaching.md", 3);
}

#[test]
fn every_command_for_long_work_runs() {
    run_page("long.md", 10);
}

#[test]
fn a_page_is_read_as_its_reader_reads_it() {
    let page = "$ no\n```sh\n$ no\n```\n```console\n$ dotray a 'b c' # exit 3\n```\n";
    let words = ["dotray", "a", "b c"].map(str::to_owned).to_vec();
    assert_eq!(steps(page), [Step { words, exit: 3 }]);
}
