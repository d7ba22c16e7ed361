//! Other people's files, where they lie beside the repository: no crash, pictures of what is a scene of any dialect,
//! and an error for what is broken.

use dotray_accel::Kind;
use dotray_render::Options;
use dotray_scene::files::Disk;
use dotray_tests::corpus;
use dotray_tests::pictures;
use std::path::Path;

/// Reads, resolves, and, where that went well, renders.
fn outcome(path: &Path) -> Result<(), String> {
    let scene = pictures::scene_of_file(path, &Disk)?;
    let world = pictures::world(scene, Kind::Bvh)?;
    pictures::picture(&world, &Options { width: 24, height: 18, ..Options::default() }).map(|_| ())
}

#[test]
fn real_scenes_render_or_are_refused() {
    let Some(table) = corpus::shared("real-scenes/expect.tsv") else { return };
    let text = std::fs::read_to_string(&table).expect("the table");
    let folder = table.parent().expect("a folder");
    let mut faults = Vec::new();
    let (mut rendered, mut refused, mut included) = (0, 0, 0);
    for row in text.lines().skip(1) {
        let fields: Vec<&str> = row.split('\t').collect();
        let (path, dialect, expected) = (fields[0], fields[1], fields[2]);
        let found = outcome(&folder.join(path));
        let renders = expected != "error";
        // A texture that was never published is an error, and rightly so.
        let unpublished = found.as_ref().is_err_and(|message| message.contains("texture-not-found"));
        // The table judges each file by itself; a few include one that is broken or was moved.
        let by_include =
            |message: &String| message.contains("included from") || message.contains("include-not-found");
        match &found {
            Ok(()) if renders => rendered += 1,
            Err(_) if !renders || unpublished => refused += 1,
            Err(message) if by_include(message) => included += 1,
            Ok(()) => faults.push(format!("{path} ({dialect}, {expected}) renders")),
            Err(message) => faults.push(format!("{path}: {message}")),
        }
    }
    println!("{rendered} scenes rendered, {refused} files refused, {included} for what they include");
    assert!(faults.is_empty(), "{} files\n{}", faults.len(), faults.join("\n"));
    assert!(rendered >= 180 && included <= 3, "{rendered} rendered, {included} fail by an include");
}
