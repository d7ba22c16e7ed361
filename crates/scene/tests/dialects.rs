//! Other people's files of every dialect, where they lie beside the repository: each does what is expected of it.

use dotray_scene::diagnostic::Severity;
use dotray_scene::files::Disk;
use dotray_scene::load::LoadOptions;
use dotray_scene::load::Loaded;
use dotray_scene::load::load;
use dotray_scene::report::render_text;
use dotray_scene::resolve::resolve;
use std::path::Path;

/// The dialect that was found and the messages of reading and resolving; `Err` where there is an error.
fn outcome(path: &Path) -> (&'static str, Result<bool, String>) {
    let Loaded { scene, diagnostics, sources, dialect, .. } = load(path, &Disk, &LoadOptions::default());
    let text = render_text(&diagnostics, &sources, false);
    let Some(scene) = scene else { return (dialect.name(), Err(text)) };
    let has_camera = scene.files.first().is_some_and(|file| file.camera.is_some());
    let outcome = resolve(scene);
    let errors = outcome.diagnostics.iter().filter(|diagnostic| diagnostic.severity == Severity::Error);
    let errors: String = errors.map(|error| format!("{}: {}\n", error.code, error.message)).collect();
    (dialect.name(), if outcome.resolved.is_some() { Ok(has_camera) } else { Err(errors) })
}

#[test]
fn real_scenes_are_read_as_expected() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../../shared/real-scenes");
    let Ok(table) = std::fs::read_to_string(folder.join("expect.tsv")) else {
        println!("skipped, no ../shared");
        return;
    };
    let mut faults = Vec::new();
    // The table judges each file by itself; a few include one that is broken or was moved.
    let mut included = 0;
    for row in table.lines().skip(1) {
        let fields: Vec<&str> = row.split('\t').collect();
        let (path, dialect, expected) = (fields[0], fields[1], fields[2]);
        let (found, outcome) = outcome(&folder.join(path));
        match (&outcome, expected) {
            (Err(_), "error") => {}
            (Ok(_), "scene" | "fragment") if found == dialect => {}
            (Ok(_), _) => faults.push(format!("{path}: expected {expected} of {dialect}, read as {found}")),
            (Err(messages), _)
                if messages.contains("included from") || messages.contains("include-not-found") =>
            {
                included += 1;
            }
            (Err(messages), _) => {
                faults.push(format!("{path}: expected {expected} of {dialect}\n{messages}"))
            }
        }
    }
    assert!(included <= 3, "{included} files fail for what they include");
    assert!(faults.is_empty(), "{} files\n{}", faults.len(), faults.join("\n"));
}
