//! Every SIMD level that this machine can run gives the same bytes. A process chooses its level once, so this file
//! runs itself again for each.

use crate::random;
use crate::same_bytes::small_corpus;
use dotray_accel::Kind;
use dotray_accel::simd;
use dotray_render::Options;
use dotray_tests::pictures;
use proptest::strategy::Strategy;
use proptest::strategy::ValueTree;
use proptest::test_runner::TestRunner;
use std::process::Command;

/// Set in the processes that only print fingerprints.
const CHILD: &str = "DOTRAY_TESTS_PRINT_FINGERPRINTS";
const MARK: &str = "fingerprint ";

/// One line a picture: its name and what stands for its bytes.
fn fingerprints() -> Vec<String> {
    let mut scenes = small_corpus();
    let mut runner = TestRunner::deterministic();
    for i in 0..20 {
        let text = random::scene().new_tree(&mut runner).expect("a scene can be made").current();
        let scene = pictures::scene_of_text("random.ray", text).unwrap_or_else(|error| panic!("{error}"));
        scenes.push((format!("random {i}"), scene, Options { width: 26, height: 21, ..Options::default() }));
    }
    let mut lines = Vec::new();
    for (name, scene, options) in scenes {
        for kind in Kind::ALL {
            let world =
                pictures::world(scene.clone(), kind).unwrap_or_else(|error| panic!("{name}: {error}"));
            let picture =
                pictures::picture(&world, &options).unwrap_or_else(|error| panic!("{name}: {error}"));
            lines.push(format!("{MARK}{name} {} {:016x}", kind.name(), pictures::fingerprint(&picture)));
        }
    }
    lines
}

#[test]
fn prints_fingerprints_when_asked() {
    if std::env::var_os(CHILD).is_some() {
        println!("\nlevel {}", simd::level_name(simd::level()));
        fingerprints().iter().for_each(|line| println!("{line}"));
    }
}

/// The fingerprints as a process of one level prints them.
fn fingerprints_at(level: &str) -> Vec<String> {
    let test = std::env::current_exe().expect("a test knows its own path");
    let output = Command::new(test)
        .args(["--exact", "levels::prints_fingerprints_when_asked", "--nocapture", "--test-threads", "1"])
        .env(CHILD, "1")
        .env(simd::VARIABLE, level)
        .output()
        .expect("the test can be run again");
    let text = String::from_utf8_lossy(&output.stdout).into_owned();
    assert!(output.status.success(), "{level}: {text}");
    assert!(text.lines().any(|line| line == format!("level {level}")), "{level} was not in use:\n{text}");
    text.lines().filter(|line| line.starts_with(MARK)).map(str::to_owned).collect()
}

#[test]
fn every_simd_level_gives_the_same_bytes() {
    let levels: Vec<&str> = simd::available_levels().into_iter().map(simd::level_name).collect();
    println!("levels: {levels:?}");
    let expected = fingerprints_at("scalar");
    assert_eq!(expected.len(), (47 + 20) * Kind::ALL.len());
    for level in levels.into_iter().filter(|&level| level != "scalar") {
        let actual = fingerprints_at(level);
        let other: Vec<&String> = actual.iter().filter(|line| !expected.contains(line)).collect();
        assert!(
            other.is_empty() && actual.len() == expected.len(),
            "{level} differs from scalar: {other:#?}"
        );
    }
}
