//! What a machine does to long work: full disks, read-only folders, files that vanish, clocks that jump, little memory,
//! readers that go. What is finished is kept, and the message says what happened.

#![cfg(target_os = "linux")]

mod common;

use common::Folder;
use common::Outcome;
use std::process::Child;
use std::process::Command;
use std::process::Stdio;
use std::time::Duration;
use std::time::Instant;

const SLOW: &str = "render balls.ray a.png --size 480x360 --aa grid=5 --threads 1 --tile-size 16";

/// Runs a shell script with the program as `$DOTRAY`.
fn shell(folder: &Folder, script: &str) -> Outcome {
    let output = Command::new("sh")
        .args(["-c", script])
        .current_dir(folder.path(""))
        .env("DOTRAY", env!("CARGO_BIN_EXE_dotray"))
        .env("TMPDIR", folder.path(""))
        .stdin(Stdio::null())
        .output()
        .expect("a shell");
    let stderr = String::from_utf8_lossy(&output.stderr).into_owned();
    Outcome { code: output.status.code(), stdout: output.stdout, stderr }
}

/// The same with mounts of its own; `None`, told, where this machine forbids it.
fn with_mounts(folder: &Folder, script: &str) -> Option<Outcome> {
    let mut probe = Command::new("unshare");
    probe.args(["-rm", "sh", "-c", "mount -t tmpfs tmpfs /mnt"]);
    if !probe.output().is_ok_and(|output| output.status.success()) {
        println!("skipped, this machine allows no mounts of one's own");
        return None;
    }
    Some(shell(folder, &format!("unshare -rm sh -c '{script}'")))
}

fn start(folder: &Folder, arguments: &str) -> Child {
    let mut command = folder.command(arguments);
    command.env("TMPDIR", folder.path("tmp"));
    command.stdin(Stdio::null()).stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().expect("it starts")
}

fn ended(child: Child) -> Outcome {
    let output = child.wait_with_output().expect("it ends");
    let stderr = String::from_utf8_lossy(&output.stderr).into_owned();
    Outcome { code: output.status.code(), stdout: output.stdout, stderr }
}

fn await_file(folder: &Folder, name: &str, bytes: u64) {
    let start = Instant::now();
    while std::fs::metadata(folder.path(name)).map_or(0, |meta| meta.len()) < bytes {
        assert!(start.elapsed() < Duration::from_secs(60), "no {name}");
        std::thread::sleep(Duration::from_millis(5));
    }
}

#[test]
fn a_full_disk_costs_nothing_that_is_finished() {
    let folder = Folder::new();
    folder.run(&SLOW.replace("a.png", "whole.png")).expect(0);
    std::fs::create_dir(folder.path("small")).expect("a folder");
    // The checkpoint has no room: the picture is made all the same.
    let mount = "mount -t tmpfs -o size=40k tmpfs small";
    let line = format!("{mount} && $DOTRAY {SLOW} --checkpoint small/c.tiles --every 20ms");
    let Some(made) = with_mounts(&folder, &line) else { return };
    let made = made.expect(0).says("cannot add to the checkpoint").says("No space left on device");
    assert_eq!(made.stderr.matches("cannot add").count(), 1, "told once: {}", made.stderr);
    assert!(folder.get("a.png") == folder.get("whole.png"));
    // The picture has no room: its tiles and a copy are kept.
    let picture = SLOW.replace("a.png", "small/a.png");
    let line =
        format!("{mount} && head -c 36864 /dev/zero > small/fill; $DOTRAY {picture} --checkpoint c.tiles");
    let full = with_mounts(&folder, &line).expect("as before").expect(1);
    let full = full.says("No space left on device").says("keeps all tiles").says("the picture is in");
    let rescued = full.stderr.split("the picture is in `").nth(1).and_then(|rest| rest.split('`').next());
    assert!(std::fs::read(rescued.expect("a path")).expect("a file") == folder.get("whole.png"));
    std::fs::remove_file(folder.path("a.png")).expect("a file");
    folder.run(&format!("{SLOW} --checkpoint c.tiles --resume --time-limit 100ms")).expect(0);
    assert!(folder.get("a.png") == folder.get("whole.png"), "not one tile was made again");
}

#[test]
fn a_file_size_limit_is_told_like_a_full_disk() {
    let folder = Folder::new();
    // Ignored, the signal of the limit becomes an error of the write, as on a full disk.
    let script = format!("trap '' XFSZ; ulimit -f 24; exec $DOTRAY {SLOW} --checkpoint c.tiles --every 20ms");
    let made = shell(&folder, &script);
    assert!(made.stderr.contains("cannot add to the checkpoint"), "{}", made.stderr);
    assert!(made.stderr.contains("File too large"), "{}", made.stderr);
}

#[test]
fn a_read_only_folder_is_told_before_the_work() {
    let folder = Folder::new();
    std::fs::create_dir(folder.path("dry")).expect("a folder");
    let mount = "mount -t tmpfs -o ro tmpfs dry";
    let picture = SLOW.replace("a.png", "dry/a.png");
    let Some(refused) = with_mounts(&folder, &format!("{mount} && $DOTRAY {picture}")) else { return };
    refused.expect(1).says("dry/a.png").says("Read-only file system");
    let line = format!("{mount} && $DOTRAY {SLOW} --checkpoint dry/c.tiles");
    with_mounts(&folder, &line)
        .expect("as before")
        .expect(1)
        .says("dry/c.tiles")
        .says("Read-only file system");
    assert!(!folder.names().contains(&"a.png".to_owned()));
}

#[test]
fn a_checkpoint_that_vanishes_comes_back() {
    let folder = Folder::new();
    folder.run(&SLOW.replace("a.png", "whole.png")).expect(0);
    let mut child = start(&folder, &format!("{SLOW} --checkpoint c.tiles --every 20ms"));
    await_file(&folder, "c.tiles", 30_000);
    std::fs::remove_file(folder.path("c.tiles")).expect("a checkpoint");
    await_file(&folder, "c.tiles", 60_000);
    child.kill().expect("killed");
    ended(child).says("had vanished");
    let resumed = folder.run(&format!("{SLOW} --checkpoint c.tiles --resume --progress json")).expect(0);
    assert!(!resumed.stderr.contains("\"finished_pixels\":0"), "all was lost: {}", resumed.stderr);
    assert!(folder.get("a.png") == folder.get("whole.png"));
}

#[test]
fn a_folder_that_vanishes_does_not_take_the_picture_with_it() {
    let folder = Folder::new();
    folder.run(&SLOW.replace("a.png", "whole.png")).expect(0);
    for name in ["out", "tmp"] {
        std::fs::create_dir(folder.path(name)).expect("a folder");
    }
    let child = start(&folder, &SLOW.replace("a.png", "out/a.png"));
    std::thread::sleep(Duration::from_millis(300));
    std::fs::remove_dir_all(folder.path("out")).expect("removed");
    let stopped = ended(child).expect(1).says("out/a.png").says("the picture is in");
    let rescued = stopped.stderr.split("the picture is in `").nth(1).and_then(|rest| rest.split('`').next());
    assert!(std::fs::read(rescued.expect("a path")).expect("a file") == folder.get("whole.png"));
}

#[test]
fn a_texture_that_is_gone_is_told_by_name() {
    let folder = Folder::new();
    let text = common::BALLS.replace(" 0 1 -1 !!", " 0 1 0 !!") + "#texture gone.png\n";
    folder.put("balls.ray", text.as_bytes());
    folder.run(&format!("{SLOW} --checkpoint c.tiles")).expect(1).says("gone.png");
    assert!(!folder.names().contains(&"c.tiles".to_owned()));
}

#[test]
fn clocks_may_jump() {
    let Ok(found) = Command::new("faketime").arg("--version").output() else {
        println!("skipped, no program `faketime`");
        return;
    };
    assert!(found.status.success());
    let folder = Folder::new();
    folder.run(&SLOW.replace("a.png", "whole.png")).expect(0);
    // The wall clock runs a million times too fast, or back to the past, while the steady one keeps going.
    for clock in ["@2000-01-01 00:00:00 x1000000", "-30y"] {
        let line = format!(
            "DONT_FAKE_MONOTONIC=1 FAKETIME_DONT_FAKE_MONOTONIC=1 faketime -f '{clock}' $DOTRAY {SLOW}"
        );
        let jumps = "--checkpoint c.tiles --every 50ms --time-limit 1h --progress json";
        let made = shell(&folder, &format!("{line} {jumps}")).expect(0);
        assert!(made.stderr.contains("\"outcome\":\"done\""), "{}", made.stderr);
        assert!(folder.get("a.png") == folder.get("whole.png"));
    }
}

#[test]
fn little_memory_is_told_before_the_work() {
    let folder = Folder::new();
    let line = "render balls.ray a.bmp --size 8000x8000 --max-pixels 100000000";
    // A picture of 64 million pixels takes 768 MB as floats; 400 MB of addresses are allowed.
    shell(&folder, &format!("ulimit -v 400000; exec $DOTRAY {line}"))
        .expect(1)
        .says("of memory")
        .says("--max-memory");
    // The same limit is enough for a picture that fits.
    shell(&folder, "ulimit -v 400000; exec $DOTRAY render balls.ray a.bmp --size 800x600 --threads 2")
        .expect(0);
}

#[test]
fn a_reader_that_goes_costs_no_tile() {
    let folder = Folder::new();
    let line = SLOW.replace("a.png", "- --format bmp");
    let ended = shell(&folder, &format!("$DOTRAY {line} --checkpoint c.tiles 2>said | head -c 0")).expect(0);
    assert_eq!(ended.stderr, "");
    assert!(String::from_utf8_lossy(&folder.get("said")).contains("keeps all tiles"));
    folder.run(&format!("{line} --checkpoint c.tiles --resume")).expect(0);
    // Whoever reads the progress may go, too.
    let line = format!(
        "$DOTRAY {SLOW} --progress json --checkpoint c.tiles --every 20ms 2>&1 >/dev/null | head -n 2"
    );
    let text = shell(&folder, &line).expect(0).text();
    assert_eq!(text.lines().count(), 2);
    await_file(&folder, "a.png", 100);
}
