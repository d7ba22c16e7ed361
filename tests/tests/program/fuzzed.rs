//! What the fuzzer runs for hours, over its kept inputs and a few thousand changes of them.

use super::bytes::Random;
use super::bytes::changed;
use dotray_tests::corpus;
use dotray_tests::targets::TARGETS;
use dotray_tests::targets::Target;
use std::panic::catch_unwind;
use std::path::Path;
use std::path::PathBuf;
use std::time::Duration;
use std::time::Instant;

/// How many changed inputs a target gets.
const CHANGES: usize = 3000;
/// What all changes of a target may take together; on a slow machine there are fewer of them.
const ENOUGH: Duration = Duration::from_secs(2);
/// What one input may take.
const PATIENCE: Duration = Duration::from_secs(10);

fn files_in(folder: &Path) -> Vec<PathBuf> {
    let entries = std::fs::read_dir(folder).into_iter().flatten().flatten();
    let mut files: Vec<PathBuf> = entries.map(|entry| entry.path()).filter(|path| path.is_file()).collect();
    files.sort();
    files
}

/// The kept inputs, and small scenes.
fn inputs(target: &Target) -> Vec<Vec<u8>> {
    let root = corpus::root();
    let mut files = files_in(&root.join("fuzz/corpus").join(target.name));
    assert!(!files.is_empty(), "fuzz/corpus/{} is empty", target.name);
    if target.name != "image" {
        files.extend(files_in(&root.join("scenes/dialects")));
        files.extend(corpus::scenes_in(&root.join("tests/conformance")));
    }
    let contents = files.iter().map(|path| std::fs::read(path).expect("an input"));
    contents.filter(|content| content.len() < 4000).collect()
}

fn runs(target: &Target, input: &[u8]) {
    let start = Instant::now();
    if catch_unwind(|| (target.run)(input)).is_err() {
        panic!("{} fails on {:?}", target.name, String::from_utf8_lossy(input));
    }
    let spent = start.elapsed();
    assert!(spent < PATIENCE, "{} takes {spent:?} for {:?}", target.name, String::from_utf8_lossy(input));
}

#[test]
fn every_target_keeps_its_promises() {
    for target in &TARGETS {
        let inputs = inputs(target);
        inputs.iter().for_each(|input| runs(target, input));
        let mut random = Random::new(0x2545_f491_4f6c_dd1d);
        let start = Instant::now();
        let mut count = 0;
        while count < CHANGES && start.elapsed() < ENOUGH {
            let input = &inputs[random.below(inputs.len())];
            runs(target, &changed(input, &mut random));
            count += 1;
        }
        println!("{}: {} inputs, {count} changes, {:?}", target.name, inputs.len(), start.elapsed());
        assert!(count > 100, "{}: too slow to test anything", target.name);
    }
}

#[test]
fn the_fuzzer_knows_every_target() {
    let fuzz = corpus::root().join("fuzz");
    let manifest = std::fs::read_to_string(fuzz.join("Cargo.toml")).expect("a manifest");
    let programs = files_in(&fuzz.join("fuzz_targets"));
    assert_eq!(programs.len(), TARGETS.len());
    for target in &TARGETS {
        let program = std::fs::read_to_string(fuzz.join(format!("fuzz_targets/{}.rs", target.name)));
        assert!(program.is_ok_and(|text| text.contains(&format!("run(\"{}\", bytes)", target.name))));
        assert!(manifest.contains(&format!("name = \"{}\"", target.name)));
    }
}

#[test]
fn kept_inputs_are_few_and_small() {
    let folders = TARGETS.map(|target| corpus::root().join("fuzz/corpus").join(target.name));
    let sizes =
        folders.iter().flat_map(|folder| files_in(folder)).map(|path| path.metadata().map_or(0, |m| m.len()));
    let total: u64 = sizes.sum();
    assert!(total < 1 << 20, "{total} bytes of inputs");
}
