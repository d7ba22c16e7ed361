//! What a machine does to long work: full disks, read-only folders, files that vanish, clocks that jump, little memory,
//! readers that go. What is finished is kept, and the message says what happened.

#![cfg(target_os = "linux")]

mod common;

use common::Folder;
use common::Outcome;
use dotray::image::Limits;
use dotray::image::decode;
use std::path::Path;
use std::path::PathBuf;
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

/// Four frames of a second each.
const FRAMES: &str =
    "animate balls.ray --animation turn.toml --frames 1-4 --size 320x240 --aa grid=5 --threads 1";

#[test]
fn frames_and_pieces_outlive_a_full_disk() {
    let folder = Folder::new();
    folder.put("turn.toml", b"[camera.turntable]\nframes = 9\n");
    folder.run(&format!("{FRAMES} -o whole.#.png")).expect(0);
    let frames = || (1..5).map(|n| folder.get(&format!("whole.{n}.png"))).collect::<Vec<_>>();
    // Room for two frames and a half.
    let room = frames()[..3].iter().map(|frame| frame.len() as u64).sum::<u64>() * 5 / 6 / 4096 * 4096;
    std::fs::create_dir(folder.path("small")).expect("a folder");
    let script = format!(
        "mount -t tmpfs -o size={room} tmpfs small && $DOTRAY {FRAMES} -o small/out.#.png; echo \"code $?\" >&2; \
         cp -r small full; mount -o remount,size=9M small; $DOTRAY {FRAMES} -o small/out.#.png && cp -r small enough"
    );
    let Some(ended) = with_mounts(&folder, &script) else { return };
    let ended = ended.expect(0).says("No space left on device").says("code 1");
    let ended = ended.says("of 4 frames are there, and the same command goes on");
    let there = |name: &str| (1..5).filter(|n| folder.path(&format!("{name}/out.{n}.png")).exists()).count();
    assert!((1..4).contains(&there("full")), "{}", ended.stderr);
    for n in 1..5 {
        let whole = &frames()[n - 1];
        if let Ok(frame) = std::fs::read(folder.path(&format!("full/out.{n}.png"))) {
            assert!(frame == *whole, "frame {n} on the full disk");
        }
        assert!(folder.get(&format!("enough/out.{n}.png")) == *whole, "frame {n}");
    }
    assert_eq!(
        std::fs::read_dir(folder.path("full")).expect("a folder").count(),
        there("full"),
        "nothing half"
    );
    // A piece is whole or absent, and so is what is merged.
    folder
        .run(&format!("{} --pieces 2 -o a.plan", SLOW.replace("render", "plan").replace(" a.png", "")))
        .expect(0);
    let script = "mount -t tmpfs -o size=100k tmpfs small && $DOTRAY work a.plan --piece 0 -o small; \
                  echo \"code $?\" >&2; ls -A small";
    let ended = with_mounts(&folder, script).expect("as before").expect(0);
    assert_eq!(ended.text(), "");
    ended.says("piece-00000.tiles").says("No space left on device").says("code 1");
}

#[test]
fn a_folder_that_turns_read_only_keeps_what_is_in_it() {
    let folder = Folder::new();
    std::fs::create_dir(folder.path("dry")).expect("a folder");
    folder.run(&SLOW.replace("a.png", "whole.png")).expect(0);
    // As long as a file is open for writing, it cannot turn: so it is tried until it does.
    let turns =
        "until mount -o remount,ro dry 2>/dev/null; do sleep 0.01; done; wait $!; echo \"code $?\" >&2";
    let line = format!("{} --partial-every 30ms --checkpoint c.tiles", SLOW.replace("a.png", "dry/a.png"));
    let script = format!(
        "mount -t tmpfs tmpfs dry && {{ $DOTRAY {line} & until [ -s dry/a.png ]; do sleep 0.01; done; {turns}; \
         cp dry/a.png part.png; }}"
    );
    let Some(ended) = with_mounts(&folder, &script) else { return };
    let ended = ended.expect(0).says("code 1").says("Read-only file system").says("the picture goes on");
    let ended = ended.says("keeps all tiles").says("the picture is in");
    let rescued = ended.stderr.split("the picture is in `").nth(1).and_then(|rest| rest.split('`').next());
    assert!(std::fs::read(rescued.expect("a path")).expect("a file") == folder.get("whole.png"));
    decode(&folder.get("part.png"), None, &Limits::default()).expect("what was there is whole");
    folder.run(&format!("{SLOW} --checkpoint c.tiles --resume --time-limit 100ms")).expect(0);
    assert!(folder.get("a.png") == folder.get("whole.png"), "not one tile was made again");
    // Frames.
    folder.put("turn.toml", b"[camera.turntable]\nframes = 9\n");
    let script = format!(
        "mount -t tmpfs tmpfs dry && {{ $DOTRAY {FRAMES} -o dry/out.#.png & \
         until [ -s dry/out.1.png ]; do sleep 0.01; done; {turns}; cp dry/* .; }}"
    );
    let ended = with_mounts(&folder, &script).expect("as before").expect(0).says("Read-only file system");
    ended.says("code 1").says("of 4 frames are there, and the same command goes on");
    let first = folder.get("out.1.png");
    folder.run(&format!("{FRAMES} -o out.#.png")).expect(0).says("of 4 frames are there already");
    assert!(folder.get("out.1.png") == first && folder.names().contains(&"out.4.png".to_owned()));
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
fn scene_and_textures_may_vanish_once_they_are_read() {
    let folder = Folder::new();
    let text = common::BALLS.replace(" 0 1 -1 !!", " 0 1 0 !!") + "#texture t.ppm\n#ray_file part.ray\n";
    folder.put(
        "balls.ray",
        (text
            + "#group_begin // all\n1 0 0 0 0 1 0 0 0 0 1 0 0 0 0 1\n\
        #ray_file_instance 0\n#group_end\n")
            .as_bytes(),
    );
    folder.put("part.ray", b"#shape_box -1 -1 1 -1 .5 .5 .5\n");
    folder.put("t.ppm", b"P3 2 1 255 255 0 0 0 0 255");
    folder.put("turn.toml", b"[[group]]\ngroup = 'all'\n[group.turntable]\nframes = 9\n");
    let files = ["balls.ray", "part.ray", "t.ppm", "turn.toml"];
    let contents = files.map(|name| folder.get(name));
    let vanish = || files.iter().for_each(|name| std::fs::remove_file(folder.path(name)).expect("removed"));
    folder.run(&SLOW.replace("a.png", "whole.png")).expect(0);
    let child = start(&folder, &format!("{SLOW} --checkpoint c.tiles --every 20ms"));
    await_file(&folder, "c.tiles", 30_000);
    vanish();
    ended(child).expect(0);
    assert!(folder.get("a.png") == folder.get("whole.png"));
    // Without its scene, nothing goes on, and the checkpoint is left alone.
    folder.put("c.tiles", b"some");
    folder
        .run(&format!("{SLOW} --checkpoint c.tiles --resume"))
        .expect(1)
        .says("balls.ray")
        .says("No such file");
    assert_eq!(folder.get("c.tiles"), b"some");
    for (name, content) in files.iter().zip(&contents) {
        folder.put(name, content);
    }
    folder.run(&format!("{FRAMES} -o whole.#.png")).expect(0);
    folder.run(&format!("{FRAMES} -o a.plan --pieces 2").replace("animate", "plan")).expect(0);
    let child = start(&folder, &format!("{FRAMES} -o out.#.png"));
    await_file(&folder, "out.1.png", 1);
    vanish();
    ended(child).expect(0);
    for n in 1..5 {
        assert!(folder.get(&format!("out.{n}.png")) == folder.get(&format!("whole.{n}.png")), "frame {n}");
    }
    folder.run("work a.plan --piece 0 -o pieces").expect(1).says("turn.toml").says("No such file");
}

#[test]
fn a_folder_of_pieces_that_vanishes_comes_back() {
    let folder = Folder::new();
    folder
        .run(&format!("{} --pieces 1 -o a.plan", SLOW.replace("render", "plan").replace(" a.png", "")))
        .expect(0);
    let child = start(&folder, "work a.plan --piece 0 -o pieces --threads 1");
    let begun = Instant::now();
    while std::fs::remove_dir(folder.path("pieces")).is_err() {
        assert!(begun.elapsed() < Duration::from_secs(60), "no folder");
    }
    ended(child).expect(0);
    assert!(folder.path("pieces/piece-00000.tiles").exists());
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
fn a_clock_that_jumps_in_the_midst_changes_nothing() {
    let library = Command::new("faketime").args(["-f", "+0", "sh", "-c", "echo $LD_PRELOAD"]).output();
    let library =
        library.map(|found| String::from_utf8_lossy(&found.stdout).trim().to_owned()).unwrap_or_default();
    if library.is_empty() {
        println!("skipped, no program `faketime`");
        return;
    }
    let folder = Folder::new();
    folder.run(&SLOW.replace("a.png", "whole.png")).expect(0);
    folder.put("clock", b"+0d");
    let mut command = folder.command(&format!(
        "{SLOW} --checkpoint c.tiles --every 50ms --partial-every 70ms --time-limit 1h --progress json"
    ));
    command.env("LD_PRELOAD", library).env("FAKETIME_TIMESTAMP_FILE", folder.path("clock"));
    command.envs([
        ("FAKETIME_NO_CACHE", "1"),
        ("DONT_FAKE_MONOTONIC", "1"),
        ("FAKETIME_DONT_FAKE_MONOTONIC", "1"),
    ]);
    let child = command.stdin(Stdio::null()).stdout(Stdio::piped()).stderr(Stdio::piped()).spawn();
    for clock in ["+9y", "-9y", "+1d"] {
        await_file(&folder, "c.tiles", 1);
        let length = std::fs::metadata(folder.path("c.tiles")).map_or(0, |meta| meta.len());
        folder.put("clock", clock.as_bytes());
        // Tiles are kept all the same.
        await_file(&folder, "c.tiles", length + 1);
    }
    let made = ended(child.expect("it starts")).expect(0).says("\"outcome\":\"done\"");
    assert!(folder.get("a.png") == folder.get("whole.png"));
    let seconds = |line: &str| serde_json::from_str::<serde_json::Value>(line).ok()?["seconds"].as_f64();
    let seconds: Vec<f64> = made.stderr.lines().filter_map(seconds).collect();
    assert!(seconds.is_sorted() && seconds.last().is_some_and(|&last| last < 100.0), "{seconds:?}");
}

/// A group with little memory, which goes with the test.
struct Group(PathBuf);

impl Drop for Group {
    fn drop(&mut self) {
        // One that somebody is still in stays.
        let _ = std::fs::remove_dir(&self.0);
    }
}

/// A group with so much memory, and a command that puts a shell into it; `None` where this machine lets nobody make
/// one.
fn group(bytes: u64) -> Option<(String, Group)> {
    let groups = std::fs::read_to_string("/proc/self/cgroup").ok()?;
    let own = |mark: &str| {
        Some(groups.lines().find_map(|line| line.split_once(mark))?.1.trim_matches('/').to_owned())
    };
    let name = format!("dotray-test-{}-{bytes}", std::process::id());
    let mut places = vec![("/sys/fs/cgroup/memory".to_owned(), "memory.limit_in_bytes")];
    if let Some(own) = own("0::") {
        places.push((format!("/sys/fs/cgroup/{own}"), "memory.max"));
        places.push(("/sys/fs/cgroup".to_owned(), "memory.max"));
    }
    for (folder, limit) in places {
        let group = Path::new(&folder).join(&name);
        if std::fs::create_dir(&group).is_ok() {
            if std::fs::write(group.join(limit), bytes.to_string()).is_ok() {
                // Without room to swap, where there is such a limit.
                for swap in ["memory.swap.max", "memory.swappiness"] {
                    let _ = std::fs::write(group.join(swap), "0");
                }
                return Some((format!("echo $$ > {}/cgroup.procs", group.display()), Group(group)));
            }
            let _ = std::fs::remove_dir(&group);
        }
    }
    None
}

#[test]
fn who_is_killed_for_memory_loses_no_tile() {
    let Some((enter, _group)) = group(160 << 20) else {
        println!("skipped, this machine allows no groups with a limit of memory");
        return;
    };
    let folder = Folder::new();
    let line =
        "render balls.ray a.png --size 3000x3000 --threads 1 --checkpoint c.tiles --every 50ms --resume";
    folder.run(&line.replace("a.png", "whole.png").replace("c.tiles", "other.tiles")).expect(0);
    // What the group allows is known before the work.
    let refused = shell(&folder, &format!("{enter}; exec $DOTRAY {line}")).expect(1);
    refused.says("of memory").says("the limit is 160 MiB").says("--max-memory");
    // Who asks for it all the same has just enough, until somebody else in the group wants some: then the system ends
    // it in the midst of the work, without a word.
    let mut command = Command::new("sh");
    let script =
        format!("{enter}; echo 1000 > /proc/self/oom_score_adj; exec $DOTRAY {line} --max-memory 1G");
    command.args(["-c", &script]).current_dir(folder.path("")).env("DOTRAY", env!("CARGO_BIN_EXE_dotray"));
    let child = command.stdin(Stdio::null()).stdout(Stdio::piped()).stderr(Stdio::piped()).spawn();
    await_file(&folder, "c.tiles", 5_000_000);
    shell(&folder, &format!("{enter}; head -c 100M /dev/zero | tail -c 100M > /dev/null"));
    let killed = ended(child.expect("it starts"));
    assert_eq!(killed.code, None, "it was not killed: {}", killed.stderr);
    assert!(!folder.names().contains(&"a.png".to_owned()));
    let resumed = folder.run(&format!("{line} --progress json")).expect(0).stderr;
    let kept = resumed.lines().find(|line| line.contains("\"event\":\"picture\"")).expect("an event");
    let kept: serde_json::Value = serde_json::from_str(kept).expect("JSON");
    assert!(kept["finished_pixels"].as_u64().is_some_and(|kept| kept > 400_000), "{kept}");
    assert!(folder.get("a.png") == folder.get("whole.png"));
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
    // Who asks for it all the same is told what there was no room for.
    shell(&folder, &format!("ulimit -v 400000; exec $DOTRAY {line} --max-memory 9G"))
        .expect(1)
        .says("8000x8000")
        .says("memory");
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
