//! Animations: paths, missing frames, movies.

#![cfg(unix)]

mod common;

use common::Folder;
use dotray::image::Limits;
use dotray::image::decode;
use std::process::Command;
use std::process::Stdio;
use std::time::Duration;

/// A scene with a named group in a group.
const ARM: &str = "\
#camera 0 0 8 0 0 -1 0 1 0 .4
#light_point 1 1 1 3 4 5 1 0 0
#material .2 .1 0 .7 .6 .1 .5 .5 .5 0 0 0 .5 0 1 -1 !!
#group_begin // arm
1 0 0 0 0 1 0 0 0 0 1 0 0 0 0 1
#shape_box 0 1 0 0 2 .4 .4
#group_begin // hand
1 0 0 2.4 0 1 0 0 0 0 1 0 0 0 0 1
#shape_sphere 0 0 0 0 .5
#group_end
#group_end
#shape_sphere 0 -1 -1 0 .7
";

const MOVES: &str = "\
[camera.turntable]
frames = 8

[[group]]
group = 'arm'
axis = [0, 0, 1]
path = 'smooth'
[[group.key]]
frame = 0
angle = 0
[[group.key]]
frame = 4
angle = 90

[[group]]
group = '0/0'
[[group.key]]
frame = 0
translate = [0, 0, 0]
[[group.key]]
frame = 4
translate = [1, 0, 0]
";

fn folder() -> Folder {
    let folder = Folder::new();
    folder.put("arm.ray", ARM.as_bytes());
    folder.put("moves.toml", MOVES.as_bytes());
    folder
}

const LINE: &str = "animate arm.ray --animation moves.toml --frames 0-4 -o out.###.png --size 80x60";

#[test]
fn frames_show_what_a_scene_with_these_matrices_shows() {
    let folder = folder();
    folder.run(LINE).expect(0);
    let frames: Vec<String> = (0..5).map(|frame| format!("out.{frame:03}.png")).collect();
    assert!(frames.iter().all(|name| folder.names().contains(name)));
    // Frame 0 is the scene as it stands.
    folder.run("render arm.ray still.png --size 80x60").expect(0);
    assert!(folder.get("out.000.png") == folder.get("still.png"));
    // Frame 4 by hand: the arm up, the hand one further, the camera behind.
    let by_hand = ARM
        .replacen("0 0 8 0 0 -1 0 1 0", "0 0 -8 0 0 1 0 1 0", 1)
        .replacen("1 0 0 0 0 1 0 0 0 0 1 0", "0 -1 0 0 1 0 0 0 0 0 1 0", 1)
        .replacen("1 0 0 2.4", "1 0 0 3.4", 1);
    folder.put("end.ray", by_hand.as_bytes());
    folder.run("render end.ray end.png --size 80x60").expect(0);
    folder.run("compare out.004.png end.png --profile strict").expect(0);
    folder.run("compare out.004.png still.png").expect(3);
}

#[test]
fn fitted_and_built_frames_have_the_same_bytes() {
    let folder = folder();
    for accel in ["bvh", "boxes", "brute", "octree", "bsp"] {
        let line = LINE.replace("out", accel);
        let more = folder.run(&format!("{line} --accel {accel} -v")).expect(0).stderr;
        let fits = !["octree", "bsp"].contains(&accel);
        assert_eq!(more.contains("stage=\"refit\""), fits, "{more}");
        for frame in 0..5 {
            let alone = format!("{accel}-{frame}.###.png");
            folder
                .run(&line.replace("0-4", &frame.to_string()).replace(&format!("{accel}.###.png"), &alone))
                .expect(0);
            let (one, other) = (
                folder.get(&format!("{accel}.{frame:03}.png")),
                folder.get(&format!("{accel}-{frame}.{frame:03}.png")),
            );
            assert!(one == other, "{accel}, frame {frame}");
            assert!(one == folder.get(&format!("bvh.{frame:03}.png")), "{accel}, frame {frame}");
        }
    }
}

#[test]
fn groups_of_included_files_move_wherever_the_file_is_placed() {
    let folder = folder();
    let one = "1 0 0 0 0 1 0 0 0 0 1 0 0 0 0 1\n";
    let main = ARM.replacen("#shape_sphere 0 0 0 0 .5", "#ray_file_instance 0", 1)
        + "#ray_file parts/hand.ray\n#group_begin // other hand\n1 0 0 -2 0 1 0 0 0 0 1 0 0 0 0 1\n\
           #ray_file_instance 0\n#group_end\n";
    let hand = |shift: &str| {
        let inner = one.replacen("1 0 0 0", &format!("1 0 0 {shift}"), 1);
        format!(
            "#group_begin // palm\n{one}#shape_box -1 0 0 0 .5 .5 .5\n#group_begin // arm\n{inner}\
                 #ray_file tip.ray\n#ray_file_instance 0\n#group_end\n#group_end\n"
        )
    };
    std::fs::create_dir(folder.path("parts")).expect("a folder");
    folder.put("main.ray", main.as_bytes());
    folder.put(
        "parts/tip.ray",
        format!("#group_begin\n{one}#shape_sphere -1 0 .6 0 .3\n#group_end\n").as_bytes(),
    );
    let moves = |group: &str| {
        format!(
            "[[group]]\ngroup = '{group}'\n[[group.key]]\nframe = 0\n\
                 [[group.key]]\nframe = 4\ntranslate = [1.5, 0, 0]\n[[group.key]]\nframe = 5\nangle = 0\n"
        )
    };
    folder.put("parts/hand.ray", hand("1.5").as_bytes());
    folder.run("render main.ray by-hand.png --size 80x60").expect(0);
    folder.put("parts/hand.ray", hand("0").as_bytes());
    folder.run("render main.ray still.png --size 80x60").expect(0);
    assert!(folder.get("by-hand.png") != folder.get("still.png"));
    let line = LINE.replace("arm.ray", "main.ray").replace("0-4", "4-4");
    for (index, group) in ["parts/hand.ray:arm", "parts/hand.ray:0/0", "tip.ray:0"].into_iter().enumerate() {
        folder.put("moves.toml", moves(group).as_bytes());
        folder.run(&line.replace("out", &format!("{index}"))).expect(0);
        assert!(folder.get(&format!("{index}.004.png")) == folder.get("by-hand.png"), "{group}");
    }
    let line = line.replace("out", "more");
    folder.put("moves.toml", moves("palm").as_bytes());
    folder.run(&line).expect(0);
    let line = line.replace("more", "none");
    folder.put("moves.toml", moves("arm").as_bytes());
    folder.run(&line).expect(1).says("more than one group is named `arm`: say 0 or parts/hand.ray:0/0");
    folder.put("moves.toml", moves("tip.ray:1").as_bytes());
    folder.run(&line).expect(1).says("parts/hand.ray:0/0 (arm), tip.ray:0");
}

/// Which frames were built, and which fitted.
fn stages(said: &str) -> Vec<&'static str> {
    let stage = |line: &str| match line {
        line if line.contains("stage=\"build\"") => Some("build"),
        line if line.contains("stage=\"refit\"") => Some("refit"),
        _other => None,
    };
    said.lines().filter_map(stage).collect()
}

/// Spheres in slabs, each a group, that come apart along y until frame 6: from one place where `distance` is 1.
fn slabs(folder: &Folder, slabs: usize, spheres: usize, distance: f64) {
    let mut scene = "#camera 0 0 30 0 0 -1 0 1 0 .4\n#light_dir 1 1 1 -1 -1 -1\n".to_owned();
    let mut moves = String::new();
    // A simple generator, so that places look random and are the same on every run.
    let mut state = 1_u32;
    let mut random = || {
        state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        f64::from(state >> 8) / f64::from(1 << 24)
    };
    for slab in 0..slabs {
        scene.push_str("#group_begin 1 0 0 0 0 1 0 0 0 0 1 0 0 0 0 1\n");
        let low = slab as f64 / slabs as f64;
        for _ in 0..spheres {
            let (x, y, z) =
                (20.0 * random() - 10.0, 20.0 * (low + random() / slabs as f64) - 10.0, 20.0 * random());
            scene.push_str(&format!("#shape_sphere -1 {x} {y} {} .15\n", -z));
        }
        scene.push_str("#group_end\n");
        // From where the slab in the middle is.
        let way = distance * 20.0 * (0.5 - low);
        moves.push_str(&format!(
            "[[group]]\ngroup = '{slab}'\n[[group.key]]\nframe = 0\ntranslate = [0, {way}, 0]\n\
             [[group.key]]\nframe = 6\ntranslate = [0, 0, 0]\n"
        ));
    }
    folder.put("slabs.ray", scene.as_bytes());
    folder.put("slabs.toml", moves.as_bytes());
}

#[test]
fn the_tree_is_fitted_while_that_costs_less_and_built_once_it_costs_more() {
    // Large scenes and a small picture with little motion; small scenes, large pictures and much motion.
    for (count, spheres, distance, size, built_again) in
        [(2, 60_000, 0.01, "48x36", false), (12, 250, 1.0, "400x300", true)]
    {
        let folder = Folder::new();
        slabs(&folder, count, spheres, distance);
        let line = format!("animate slabs.ray --animation slabs.toml --size {size} --threads 1 --aa none");
        let said = folder.run(&format!("{line} --frames 0-6 -o a.#.png -v")).expect(0).stderr;
        let stages = stages(&said);
        assert_eq!((stages.len(), stages[0]), (7, "build"), "{stages:?}");
        assert_eq!(stages[1..].contains(&"build"), built_again, "{stages:?}");
        assert!(stages[1..].contains(&"refit"), "{stages:?}");
        for frame in [1, 3, 6] {
            folder.run(&format!("{line} --frames {frame}-{frame} -o b.#.png")).expect(0);
            let (one, other) = (folder.get(&format!("a.{frame}.png")), folder.get(&format!("b.{frame}.png")));
            assert!(one == other, "frame {frame} of {count} slabs");
        }
    }
}

#[test]
fn only_missing_frames_are_made() {
    let folder = folder();
    folder.run(LINE).expect(0);
    let before = folder.get("out.002.png");
    std::fs::remove_file(folder.path("out.002.png")).expect("a frame");
    folder.put("out.003.png", b"not touched");
    folder.run(LINE).expect(0).says("4 of 5 frames are there already");
    assert!(folder.get("out.002.png") == before);
    assert_eq!(folder.get("out.003.png"), b"not touched");
}

#[test]
fn a_frame_is_whole_or_absent() {
    let folder = folder();
    let line = format!("{LINE} --size 400x300 --aa grid=5 --threads 1")
        .replace("--size 80x60 ", "")
        .replace("0-4", "0-9");
    let mut child = folder.command(&line).stderr(Stdio::null()).spawn().expect("it starts");
    let whole = |name: &String| {
        let picture = decode(&folder.get(name), None, &Limits::default()).expect("a whole picture");
        assert_eq!((picture.width(), picture.height()), (400, 300));
    };
    while !folder.names().contains(&"out.001.png".to_owned()) {
        assert!(child.try_wait().expect("a child").is_none(), "it ended without a frame");
        std::thread::sleep(Duration::from_millis(5));
    }
    std::thread::sleep(Duration::from_millis(37));
    child.kill().and_then(|()| child.wait()).expect("killed");
    let frames = || folder.names().into_iter().filter(|name| name.starts_with("out.")).collect::<Vec<_>>();
    frames().iter().for_each(whole);
    assert!(frames().len() < 10);
    folder
        .run(&format!("{line} --time-limit 100ms"))
        .expect(4)
        .says("frames are there, and the same command goes on");
    frames().iter().for_each(whole);
    let mut child = folder.command(&line).stderr(Stdio::piped()).spawn().expect("it starts");
    std::thread::sleep(Duration::from_millis(200));
    Command::new("kill").args(["-INT", &child.id().to_string()]).status().expect("kill");
    assert_eq!(child.wait().expect("ended").code(), Some(130));
    frames().iter().for_each(whole);
}

#[test]
fn what_cannot_be_is_told() {
    let folder = folder();
    folder.run(&LINE.replace("out.###.png", "out.png")).expect(2).says("out.####.png");
    folder.run(&LINE.replace("0-4", "4-0")).expect(2).says("1-48");
    folder.run(&format!("{LINE} --checkpoint a")).expect(2).says("frames that are there are not made again");
    folder.put("moves.toml", MOVES.replace("'arm'", "'leg'").as_bytes());
    folder.run(LINE).expect(1).says("no group `leg`: 0 (arm), 0/0 (hand)");
    folder.put("moves.toml", b"[camera]\nspeed = 1");
    folder.run(LINE).expect(1).says("moves.toml").says("speed");
    folder.put("moves.toml", b"[[camera.key]]\nframe = 1\ndirection = [0, 1, 0]");
    folder.run(LINE).expect(1).says("frame 0: the camera looks along");
    folder.run(&LINE.replace("moves.toml", "none.toml")).expect(1).says("none.toml");
}

#[test]
fn movies_need_ffmpeg_and_say_so() {
    let folder = folder();
    let before = folder.names();
    let output =
        folder.command(&format!("{LINE} --movie out.mp4")).env("PATH", "/nowhere").output().expect("it runs");
    assert_eq!(output.status.code(), Some(1));
    let said = String::from_utf8_lossy(&output.stderr).into_owned();
    assert!(said.contains("--movie needs the program `ffmpeg`"), "{said}");
    assert_eq!(folder.names(), before, "told before the frames are made");
    folder.run(&format!("{LINE} --movie out.avi")).expect(2).says("expected .mp4, .gif or .webp");
    if Command::new("ffmpeg").arg("-version").output().is_err() {
        println!("skipped, no program `ffmpeg`");
        return;
    }
    // An odd width, which mp4 has to pad.
    let line = LINE.replace("80x60", "81x60");
    for (movie, mark, at) in
        [("out.mp4", &b"ftyp"[..], 4), ("out.gif", b"GIF89a", 0), ("out.webp", b"WEBP", 8)]
    {
        folder.run(&format!("{line} --movie {movie}")).expect(0);
        let bytes = folder.get(movie);
        assert_eq!(&bytes[at..at + mark.len()], mark, "{movie}");
        let count = Command::new("ffprobe")
            .args(["-v", "error", "-count_frames", "-select_streams", "v:0", "-of", "csv=p=0"])
            .args(["-show_entries", "stream=nb_read_frames"])
            .arg(folder.path(movie))
            .output()
            .expect("ffprobe");
        // ffmpeg itself cannot read what it writes as animated WebP: its frames are counted by their chunks.
        let frames = match movie {
            "out.webp" => bytes.windows(4).filter(|four| four == b"ANMF").count(),
            _ => {
                String::from_utf8_lossy(&count.stdout).trim().trim_end_matches(',').parse().expect("a number")
            }
        };
        assert_eq!(frames, 5, "{movie}");
    }
    assert!(!folder.names().iter().any(|name| name.starts_with(".dotray")));
}
