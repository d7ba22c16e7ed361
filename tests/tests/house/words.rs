//! Words that must not be written: in code, in comments, in docs.

use super::files::tracked;
use super::rust::code;
use super::rust::code_without_tests;
use super::rust::is_word;
use super::rust::line_of;
use super::rust::sources;
use super::rust::words;

/// Files that may hold `unsafe`, each for a measured gain and with tests of its own.
const UNSAFE_FILES: &[&str] = &["crates/memory/src/lib.rs"];

/// Crate roots that may lower a lint for all of their code: path and lint.
const LOWERED_LINTS: &[(&str, &str)] = &[
    // Kernels count axes and lanes, several arrays at a time.
    ("crates/accel/src/lib.rs", "clippy::needless_range_loop"),
    // An allocator is unsafe code.
    ("crates/memory/src/lib.rs", "unsafe_code"),
];

/// The crates whose bytes must be the same on every system.
const EXACT: [&str; 4] =
    ["crates/geometry/src/", "crates/accel/src/", "crates/scene/src/", "crates/render/src/"];

/// Methods of floats whose last bits depend on the platform; `libm` has them all.
const PLATFORM_METHODS: [&str; 28] = [
    "sin",
    "cos",
    "tan",
    "asin",
    "acos",
    "atan",
    "atan2",
    "sin_cos",
    "sinh",
    "cosh",
    "tanh",
    "asinh",
    "acosh",
    "atanh",
    "exp",
    "exp2",
    "exp_m1",
    "ln",
    "ln_1p",
    "log",
    "log2",
    "log10",
    "powf",
    "powi",
    "cbrt",
    "hypot",
    "angle_between",
    "slerp",
];

/// Functions that call them.
const PLATFORM_FUNCTIONS: [&str; 8] = [
    "from_rotation_x",
    "from_rotation_y",
    "from_rotation_z",
    "from_axis_angle",
    "from_scaled_axis",
    "from_euler",
    "from_angle",
    "to_axis_angle",
];

/// Files whose kernels may fuse: single precision that only rules out, with a bound that holds either way.
const FUSED_FILES: &[&str] =
    &["crates/accel/src/bvh/walk.rs", "crates/accel/src/packet.rs", "crates/render/src/cull.rs"];

/// Fused operations, which round differently from machine to machine.
fn fused() -> [String; 4] {
    ["_add", "_add_f64x4", "_sub", "_add_precise"].map(|end| format!("mul{end}"))
}

fn platform_faults(text: &str) -> Vec<String> {
    let code = code_without_tests(text);
    let mut faults = Vec::new();
    for (at, word) in words(&code) {
        let before = code[..at].trim_end();
        let called = before.ends_with('.') && code[at + word.len()..].starts_with(['(', ':']);
        let named = before.ends_with("f64::") || before.ends_with("f32::");
        let method = PLATFORM_METHODS.contains(&word) && (called || named);
        if method || PLATFORM_FUNCTIONS.contains(&word) {
            faults.push(format!("{}: `{word}` depends on the platform: use libm", line_of(&code, at)));
        }
    }
    faults
}

fn fused_faults(text: &str) -> Vec<String> {
    let code = code(text);
    let fused = fused();
    let of_word = |&(at, word): &(usize, &str)| {
        fused.iter().any(|name| name == word).then(|| format!("{}: `{word}`", line_of(&code, at)))
    };
    words(&code).iter().filter_map(of_word).collect()
}

fn unsafe_faults(text: &str) -> Vec<String> {
    let code = code(text);
    let keyword = words(&code).into_iter().filter(|word| word.1 == "unsafe");
    keyword.map(|(at, _)| format!("{}: `unsafe`", line_of(&code, at))).collect()
}

/// The lints that `#![allow(…)]`, `#![expect(…)]` or `#![cfg_attr(…, allow(…))]` name; those for tests are fine.
fn lowered_lints(text: &str) -> Vec<String> {
    let code = code_without_tests(text);
    let mut lints = Vec::new();
    for (at, _) in code.match_indices("#![") {
        let attribute = code[at..].split(']').next().unwrap_or("").replace("cfg_attr(test, allow", "");
        for keyword in ["allow(", "expect("] {
            for (_, rest) in attribute.match_indices(keyword).map(|(i, k)| attribute.split_at(i + k.len())) {
                let list = rest.split(')').next().unwrap_or("");
                let names = list.split(',').map(str::trim).filter(|name| !name.starts_with("reason"));
                lints.extend(names.filter(|name| !name.is_empty()).map(str::to_owned));
            }
        }
    }
    lints
}

/// An open task needs somebody's name: the word, then the name in brackets.
fn nameless_tasks(text: &str) -> Vec<String> {
    let mut faults = Vec::new();
    for task in ["TO", "FIX"].iter().zip(["DO", "ME"]).map(|(a, b)| format!("{a}{b}")) {
        for (at, _) in text.match_indices(&task) {
            let (before, after) = (&text[..at], &text[at + task.len()..]);
            let whole = !before.ends_with(is_word) && !after.starts_with(is_word);
            let named = after.strip_prefix('(').is_some_and(|rest| rest.starts_with(char::is_alphabetic));
            if whole && !named {
                faults.push(format!("{}: a {task} without a name", line_of(text, at)));
            }
        }
    }
    faults
}

/// Places on one machine's disk.
fn machine_paths(text: &str) -> Vec<String> {
    let mut faults = Vec::new();
    for top in ["work", "home", "root", "Users"] {
        for (at, found) in text.match_indices(&format!("/{top}/")) {
            let before = text[..at].chars().next_back().unwrap_or(' ');
            // `~/work/`, `x.org/home/`, `../root/` are no places on this machine.
            if !is_word(before) && !['.', '~', '-', '}'].contains(&before) {
                faults.push(format!("{}: `{found}` is a place on one machine", line_of(text, at)));
            }
        }
    }
    faults
}

/// Faults of every source that `wanted` lets pass, with their paths.
fn faults_of(wanted: impl Fn(&str) -> bool, rule: impl Fn(&str) -> Vec<String>) -> Vec<String> {
    let mut faults = Vec::new();
    for source in sources().iter().filter(|source| wanted(&source.path)) {
        faults.extend(rule(&source.text).into_iter().map(|fault| format!("{}:{fault}", source.path)));
    }
    faults
}

#[test]
fn what_decides_a_pixel_never_asks_the_platform() {
    let exact = |path: &str| EXACT.iter().any(|folder| path.starts_with(folder));
    super::expect_none("platform mathematics", &faults_of(exact, platform_faults));
    let unlisted = |path: &str| !FUSED_FILES.contains(&path);
    super::expect_none("fused operations", &faults_of(unlisted, fused_faults));
    for path in FUSED_FILES {
        let faults = faults_of(|found| found == *path, fused_faults);
        assert!(!faults.is_empty(), "{path} fuses nothing: take it off the list");
    }
}

#[test]
fn unsafe_code_is_listed() {
    let unlisted = |path: &str| !UNSAFE_FILES.contains(&path);
    super::expect_none("unsafe code", &faults_of(unlisted, unsafe_faults));
    for path in UNSAFE_FILES {
        let faults = faults_of(|found| found == *path, unsafe_faults);
        assert!(!faults.is_empty(), "{path} holds none: take it off the list");
    }
}

#[test]
fn lints_are_lowered_by_list_only() {
    let mut faults = Vec::new();
    for source in sources().iter().filter(|source| source.path.contains("/src/")) {
        for lint in lowered_lints(&source.text) {
            if !LOWERED_LINTS.contains(&(source.path.as_str(), lint.as_str())) {
                faults.push(format!("{}: lowers `{lint}` for a whole file", source.path));
            }
        }
    }
    super::expect_none("lowered lints", &faults);
    for (path, lint) in LOWERED_LINTS {
        let lowered = sources()
            .iter()
            .any(|source| source.path == *path && lowered_lints(&source.text).contains(&(*lint).to_owned()));
        assert!(lowered, "{path} no longer lowers {lint}: take it off the list");
    }
}

#[test]
fn tasks_have_names_and_paths_are_relative() {
    let mut faults = Vec::new();
    let mut texts = 0;
    for path in tracked() {
        let skipped = path.ends_with("Cargo.lock") || path.starts_with("tests/conformance/");
        let Ok(text) = std::fs::read_to_string(super::rust::root().join(&path)) else { continue };
        if skipped || text.contains('\0') {
            continue;
        }
        texts += 1;
        let found = nameless_tasks(&text).into_iter().chain(machine_paths(&text));
        faults.extend(found.map(|fault| format!("{path}:{fault}")));
    }
    assert!(texts > 50, "the tree was not found");
    super::expect_none("tasks and paths", &faults);
}

#[test]
fn lines_fit_the_page() {
    let long = |text: &str| -> Vec<String> {
        let lines = text.lines().enumerate();
        lines
            .filter(|(_, l)| l.chars().count() > 120)
            .map(|(i, _)| format!("{}: over 120 columns", i + 1))
            .collect()
    };
    assert_eq!(long(&format!("{}\n{}", "ö".repeat(120), "x".repeat(121))), ["2: over 120 columns"]);
    super::expect_none("long lines", &faults_of(|_| true, long));
}

#[test]
fn planted_faults_are_found() {
    for text in
        ["x.sin()", "x\n    .powi(2)", "f64::exp(x)", "Mat3::from_rotation_y(1.0)", "a.map(f64::atan2)"]
    {
        assert_eq!(platform_faults(text).len(), 1, "{text}");
    }
    for text in ["libm::sin(x)", "// x.sin()", "\"x.cos()\"", "self.log", "#[cfg(test)]\nfn f() { x.ln() }"] {
        assert_eq!(platform_faults(text), [""; 0], "{text}");
    }
    let fused = format!("a.{}(b, c)", fused()[0]);
    assert_eq!(fused_faults(&fused).len(), 1);
    assert_eq!(fused_faults(&format!("// no {}", fused)).len(), 0);
    assert_eq!(unsafe_faults("unsafe { x }\n// unsafe\n#![forbid(unsafe_code)]").len(), 1);
    assert_eq!(
        lowered_lints("#![allow(dead_code, clippy::x, reason = \"b\")]\n#![cfg_attr(test, allow(a))]"),
        ["dead_code", "clippy::x"]
    );
    assert_eq!(lowered_lints("#![cfg_attr(feature, expect(a))]\n#![warn(b)]"), ["a"]);
    let task = format!("{}{}", "TO", "DO");
    assert_eq!(nameless_tasks(&format!("// {task}: this")).len(), 1);
    assert_eq!(nameless_tasks(&format!("// {task}()")).len(), 1);
    assert_eq!(nameless_tasks(&format!("// {task}(ada): this; {task}S")), [""; 0]);
    let place = format!("/{}/x", "work");
    assert_eq!(machine_paths(&format!("see {place}")).len(), 1);
    assert_eq!(machine_paths(&format!("see net{place} and ~{place}")), [""; 0]);
}
