//! Floors between crates, and what every member inherits from the workspace.

use super::rust::root;

const FLOORS: [&str; 8] = [
    "dotray-geometry",
    "dotray-image",
    "dotray-accel",
    "dotray-scene",
    "dotray-render",
    "dotray-grade",
    "dotray-lsp",
    // Last, so that only programs use it.
    "dotray-memory",
];
const EVERYTHING: [&str; 9] = [
    "dotray-geometry",
    "dotray-image",
    "dotray-accel",
    "dotray-scene",
    "dotray-render",
    "dotray-grade",
    "dotray-lsp",
    "dotray-memory",
    "dotray",
];

/// Which members of the workspace a member may use; a member that is not here must be added with care.
fn allowed(member: &str) -> Option<&'static [&'static str]> {
    Some(match member {
        "dotray-geometry" | "dotray-image" | "dotray-memory" => &[],
        "dotray-accel" | "dotray-scene" => &FLOORS[..1],
        "dotray-render" => &FLOORS[..4],
        "dotray-grade" => &FLOORS[..5],
        "dotray-lsp" => &["dotray-scene"],
        "dotray" | "rayview" | "dotray-python" => &FLOORS,
        "dotray-tests" | "dotray-xtask" | "xtask" => &EVERYTHING,
        _ => return None,
    })
}

/// The lines of a manifest with the section that each stands in.
fn lines(manifest: &str) -> Vec<(String, String)> {
    let mut section = String::new();
    let mut lines = Vec::new();
    for line in manifest.lines() {
        let line = line.split('#').next().unwrap_or("").trim();
        if let Some(name) = line.strip_prefix('[') {
            section = name.trim_matches(['[', ']']).to_owned();
        }
        if !line.is_empty() {
            lines.push((section.clone(), line.to_owned()));
        }
    }
    lines
}

fn faults(manifest: &str) -> Vec<String> {
    let lines = lines(manifest);
    let has = |section: &str, line: &str| {
        lines.iter().any(|(s, l)| s == section && l.replace(' ', "") == line.replace(' ', ""))
    };
    let quoted = |line: &str| line.split('"').nth(1).unwrap_or("").to_owned();
    let name = lines.iter().find(|(s, l)| s == "package" && l.starts_with("name ")).map(|(_, l)| quoted(l));
    let name = name.unwrap_or_default();
    let mut faults = Vec::new();
    for (section, line) in [
        ("lints", "workspace = true"),
        ("package", "version.workspace = true"),
        ("package", "edition.workspace = true"),
        ("package", "license.workspace = true"),
        ("package", "rust-version.workspace = true"),
    ] {
        if !has(section, line) {
            faults.push(format!("{name}: `{line}` is missing in [{section}]"));
        }
    }
    let Some(allowed) = allowed(&name) else {
        faults.push(format!("{name}: not in the table of floors"));
        return faults;
    };
    for used in dependencies(&lines) {
        if !allowed.contains(&used.as_str()) {
            faults.push(format!("{name} uses {used}, which is on no floor below it"));
        }
    }
    faults
}

/// The workspace's members that a manifest names, under whatever name and in whatever table.
fn dependencies(lines: &[(String, String)]) -> Vec<String> {
    let mut names = Vec::new();
    for (section, line) in lines {
        let Some(at) = section.find("dependencies") else { continue };
        let of_table = section[at..].split_once('.').map(|(_, name)| name);
        let key = line.split(['.', '=', ' ']).next().unwrap_or("");
        let package = line.split_once("package").and_then(|(_, rest)| rest.split('"').nth(1));
        for name in [Some(key), of_table, package].into_iter().flatten() {
            if name == "dotray" || name.starts_with("dotray-") || name == "xtask" {
                names.push(name.to_owned());
            }
        }
    }
    names.sort();
    names.dedup();
    names
}

#[test]
fn members_use_only_floors_below_them_and_inherit_from_the_workspace() {
    let mut manifests = Vec::new();
    for entry in std::fs::read_dir(root().join("crates")).expect("crates").flatten() {
        manifests.push(entry.path().join("Cargo.toml"));
    }
    manifests.push(root().join("tests/Cargo.toml"));
    manifests.push(root().join("xtask/Cargo.toml"));
    let texts: Vec<String> = manifests.iter().filter_map(|path| std::fs::read_to_string(path).ok()).collect();
    assert!(texts.len() >= 7, "the manifests were not found");
    let faults: Vec<String> = texts.iter().flat_map(|text| faults(text)).collect();
    super::expect_none("floors between crates", &faults);
}

#[test]
fn planted_faults_are_found() {
    let head = |name: &str| {
        let inherited =
            ["version", "edition", "rust-version", "license"].map(|key| format!("{key}.workspace = true"));
        format!("[package]\nname = \"{name}\"\n{}\n[lints]\nworkspace = true\n", inherited.join("\n"))
    };
    let of = |name: &str, rest: &str| faults(&(head(name) + rest));
    assert_eq!(of("dotray-render", "[dependencies]\ndotray-scene.workspace = true\nlibm = \"1\""), [""; 0]);
    assert_eq!(of("dotray-scene", "# dotray-image\n[features]\ndotray-image = []"), [""; 0]);
    for rest in [
        "[dependencies]\ndotray-image.workspace = true",
        "[dev-dependencies]\ndotray-image = { path = \"../image\" }",
        "[target.'cfg(unix)'.build-dependencies]\ndotray-image = \"1\"",
        "[dependencies.dotray-image]\nworkspace = true",
        "[dependencies]\npictures = { package = \"dotray-image\", version = \"1\" }",
    ] {
        assert_eq!(
            of("dotray-scene", rest),
            ["dotray-scene uses dotray-image, which is on no floor below it"]
        );
    }
    assert_eq!(of("rayview", "[dependencies]\ndotray = \"1\"").len(), 1);
    assert_eq!(of("dotray-tests", "[dependencies]\ndotray-viewer = \"1\"").len(), 1);
    assert_eq!(of("dotray-new", "").len(), 1);
    for line in ["\nversion.workspace = true", "\nlicense.workspace = true", "\n[lints]\nworkspace = true"] {
        let text = head("dotray-image").replacen(line, "", 1);
        assert_eq!(faults(&text).len(), 1, "{text}");
    }
}
