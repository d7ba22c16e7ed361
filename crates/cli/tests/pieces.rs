//! Pictures and animations split among processes and joined again.

#![cfg(unix)]

mod common;

use common::Folder;
use serde_json::Value;
use std::process::Command;
use std::process::Stdio;
use yaml_rust2::Yaml;
use yaml_rust2::YamlLoader;

const OPTIONS: &str = "--size 200x150 --aa adaptive --tile-size 16 --recursion 4";

fn plan(folder: &Folder, name: &str) -> Value {
    serde_json::from_slice(&folder.get(name)).expect("JSON")
}

fn count(folder: &Folder, name: &str) -> usize {
    plan(folder, name)["pieces"].as_array().expect("pieces").len()
}

#[test]
fn pieces_of_separate_processes_make_the_same_picture() {
    for more in ["", "--background transparent", "--crop 20,30,101,77 --background .1,.2,.9 --shadows opaque"]
    {
        let folder = Folder::new();
        folder.run(&format!("render balls.ray whole.png {OPTIONS} {more}")).expect(0);
        folder.run(&format!("plan balls.ray -o a.plan --pieces 7 {OPTIONS} {more}")).expect(0);
        assert_eq!(count(&folder, "a.plan"), 7);
        // Backwards, two at a time, one of them twice at the same time.
        for numbers in [[6, 6], [5, 4], [3, 2], [1, 0]] {
            let children = numbers.map(|n| {
                let mut command = folder.command(&format!("work a.plan --piece {n} -o pieces --threads 1"));
                command.stdout(Stdio::null()).spawn().expect("it starts")
            });
            for mut child in children {
                assert!(child.wait().expect("it ends").success());
            }
        }
        folder.run("merge a.plan pieces -o merged.png").expect(0).says("of 7 pieces");
        assert!(folder.get("merged.png") == folder.get("whole.png"), "{more}");
        let before = folder.get("pieces/piece-00003.tiles");
        folder.run("work a.plan --piece 3 -o pieces").expect(0).says("piece 3 is there already");
        assert!(folder.get("pieces/piece-00003.tiles") == before);
    }
}

#[test]
fn what_is_missing_or_wrong_is_told_by_number() {
    let folder = Folder::new();
    folder.run(&format!("plan balls.ray -o a.plan --pieces 8 {OPTIONS}")).expect(0);
    let work = |n: usize| folder.run(&format!("work a.plan --piece {n} -o pieces")).expect(0);
    (0..8).for_each(|n| drop(work(n)));
    folder.run("merge a.plan pieces -o merged.png").expect(0);
    let whole = folder.get("merged.png");
    std::fs::remove_file(folder.path("merged.png")).expect("a picture");
    let path = |n: usize| folder.path(&format!("pieces/piece-0000{n}.tiles"));
    for n in [1, 5, 6] {
        std::fs::remove_file(path(n)).expect("a piece");
    }
    let mut bytes = std::fs::read(path(2)).expect("a piece");
    let middle = bytes.len() / 2;
    bytes[middle] ^= 1;
    std::fs::write(path(2), &bytes).expect("a piece");
    std::fs::copy(path(3), path(4)).expect("a piece");
    let told = folder.run("merge a.plan pieces -o merged.png").expect(1);
    let told = told
        .says("5 of 8 pieces are missing or not whole: 1-2, 4-6")
        .says("dotray work a.plan --piece N -o pieces");
    assert!(told.stderr.contains("piece-00002.tiles` is damaged"), "{}", told.stderr);
    assert!(!folder.names().contains(&"merged.png".to_owned()));
    [1, 2, 4, 5, 6].into_iter().for_each(|n| drop(work(n)));
    folder.run("merge a.plan pieces -o merged.png").expect(0);
    assert!(folder.get("merged.png") == whole);
    // A piece of another picture.
    folder.run(&format!("plan balls.ray -o b.plan --pieces 8 {OPTIONS} --light-samples 3")).expect(0);
    folder
        .run("merge b.plan pieces -o merged.png")
        .expect(1)
        .says("light samples: 64 in the piece, 3 in the plan");
    // A scene that has changed since.
    folder.put("balls.ray", common::BALLS.replace("#background .1", "#background .2").as_bytes());
    let refused = folder.run("work a.plan --piece 1 -o other").expect(1);
    refused.says("the plan `a.plan` is of another picture (background and ambient light differ)");
    folder.run("work a.plan --piece 8 -o pieces").expect(2).says("numbered from 0");
    folder.run("merge a.plan nowhere -o merged.png").expect(1).says("no folder");
    folder.put("c.plan", b"{}");
    folder.run("work c.plan --piece 0 -o pieces").expect(1).says("is no plan");
    folder.run("plan - -o a.plan --pieces 2").expect(2).says("a scene with a name");
    // A scheduler's tasks have numbers of their own: where tiles do not suffice, pieces are empty.
    folder.run(&format!("plan balls.ray -o d.plan --pieces 900 {OPTIONS}")).expect(0);
    assert_eq!(count(&folder, "d.plan"), 900);
    folder.run("work d.plan --piece 899 -o many").expect(0).says("piece 899 is empty");
}

#[test]
fn layers_are_split_and_joined_like_the_picture() {
    let folder = Folder::new();
    let layers = "--layers depth,normal,shadow,reflected,boxtests --crop 20,30,101,77";
    for picture in ["whole.exr", "whole.png"] {
        folder.run(&format!("render balls.ray {picture} {OPTIONS} {layers}")).expect(0);
    }
    folder.run(&format!("plan balls.ray -o a.plan --pieces 5 {OPTIONS} {layers}")).expect(0);
    // Nothing of theirs is written before the merge.
    assert!(!folder.names().iter().any(|name| name.contains("depth.png") && !name.starts_with("whole")));
    let plan = plan(&folder, "a.plan");
    let parts = |n: usize| plan["pieces"][n]["parts"][0].clone();
    // 20 bands of 4 rows come after the tiles, and some piece has both.
    let tiles = plan["tiles"].as_u64().expect("a number") - 20;
    let both = |n: &usize| {
        let (first, count) = (parts(*n)["first"].as_u64(), parts(*n)["count"].as_u64());
        first.zip(count).is_some_and(|(first, count)| first < tiles && first + count > tiles)
    };
    let both = (0..5).find(both).expect("a piece with tiles and bands");
    (0..5).for_each(|n| drop(folder.run(&format!("work a.plan --piece {n} -o pieces")).expect(0)));
    for picture in ["merged.exr", "merged.png"] {
        folder.run(&format!("merge a.plan pieces -o {picture}")).expect(0);
    }
    let mut made = folder.names();
    made.retain(|name| name.starts_with("merged."));
    assert_eq!(made.len(), 7, "{made:?}");
    for name in &made {
        assert!(folder.get(name) == folder.get(&name.replace("merged.", "whole.")), "{name}");
        std::fs::remove_file(folder.path(name)).expect("a picture");
    }
    // A band that is damaged is found, and only its piece is made again.
    let path = folder.path("pieces/piece-00004.tiles");
    let mut bytes = std::fs::read(&path).expect("a piece");
    let end = bytes.len() - 9;
    bytes[end] ^= 1;
    std::fs::write(&path, &bytes).expect("a piece");
    folder.run("merge a.plan pieces -o merged.exr").expect(1).says("missing or not whole: 4");
    folder.run(&format!("work a.plan --piece {both} -o pieces")).expect(0).says("is there already");
    folder.run("work a.plan --piece 4 -o pieces --progress json").expect(0).says("\"kind\":\"piece\"");
    folder.run("merge a.plan pieces -o merged.exr").expect(0);
    assert!(folder.get("merged.exr") == folder.get("whole.exr"));
    // A piece of other layers belongs to another picture.
    let fewer = layers.replace(",boxtests", "");
    folder.run(&format!("plan balls.ray -o b.plan --pieces 5 {OPTIONS} {fewer}")).expect(0);
    let refused = folder.run("merge b.plan pieces -o other.exr").expect(1);
    refused.says(
        "layers: depth,normal,shadow,reflected,boxtests in the piece, depth,normal,shadow,reflected in the",
    );
    folder.run("merge a.plan pieces -o - --format png").expect(2).says("--layers on standard output needs");
}

/// A picture of every colour, in which each pixel differs from its neighbours, to lie behind others.
fn put_sky(folder: &Folder) {
    let (width, height) = (61, 47);
    let mut bytes = format!("P6\n{width} {height}\n255\n").into_bytes();
    for y in 0..height {
        bytes
            .extend((0..width).flat_map(|x: u32| [4 * x, 5 * y, 7 * (x + y) % 256].map(|level| level as u8)));
    }
    folder.put("sky.ppm", &bytes);
}

#[test]
fn what_lies_behind_and_over_a_picture_is_split_and_joined_with_it() {
    let crop = "--crop 20,30,101,77";
    for more in [
        "--overlay bounds",
        "--overlay accel --overlay-levels 2 --build best --accel octree",
        "--background image:sky.ppm",
        &format!("--background image:sky.ppm --overlay bounds --layers st,depth {crop}"),
        &format!("--background transparent --overlay accel {crop}"),
    ] {
        let folder = Folder::new();
        put_sky(&folder);
        folder.run(&format!("render balls.ray whole.png {OPTIONS} {more}")).expect(0);
        folder.run(&format!("render balls.ray plain.png {OPTIONS} {}", crop_of(more))).expect(0);
        assert!(folder.get("whole.png") != folder.get("plain.png"), "{more} shows nothing");
        folder.run(&format!("plan balls.ray -o a.plan --pieces 5 {OPTIONS} {more}")).expect(0);
        (0..5).for_each(|n| drop(folder.run(&format!("work a.plan --piece {n} -o pieces")).expect(0)));
        folder.run("work a.plan --piece 3 -o pieces").expect(0).says("piece 3 is there already");
        // The merge needs none of the files that pieces were made of.
        for name in ["balls.ray", "sky.ppm"] {
            std::fs::rename(folder.path(name), folder.path(&format!("{name}.away"))).expect("a file");
        }
        folder.run("merge a.plan pieces -o merged.png").expect(0);
        for name in ["balls.ray", "sky.ppm"] {
            std::fs::rename(folder.path(&format!("{name}.away")), folder.path(name)).expect("a file");
        }
        assert!(folder.get("merged.png") == folder.get("whole.png"), "{more}");
        if more.contains("st,depth") {
            assert!(folder.get("merged.st.png") == folder.get("whole.st.png"));
        }
        // Neither does it matter whether the picture was made in one go.
        let slow = OPTIONS.replace("adaptive", "grid=9");
        let kept = format!("render balls.ray kept.png {slow} {more} --checkpoint c.tiles --resume");
        folder.run(&format!("{kept} --time-limit 3ms --threads 1")).expect(4);
        folder.run(&kept).expect(0);
        folder.run(&format!("render balls.ray whole.png {slow} {more}")).expect(0);
        assert!(folder.get("kept.png") == folder.get("whole.png"), "{more}");
    }
}

/// The part of the options that cuts the picture.
fn crop_of(options: &str) -> String {
    options.find("--crop").map_or_else(String::new, |at| options[at..].to_owned())
}

#[test]
fn another_picture_behind_and_other_boxes_are_named() {
    let folder = Folder::new();
    put_sky(&folder);
    let behind = "--background image:sky.ppm --overlay bounds";
    folder.run(&format!("plan balls.ray -o a.plan --pieces 2 {OPTIONS} {behind}")).expect(0);
    folder.run("work a.plan --piece 0 -o pieces").expect(0);
    let slow = OPTIONS.replace("adaptive", "grid=20");
    let kept = format!("render balls.ray kept.png {slow} --checkpoint c.tiles --resume");
    folder.run(&format!("{kept} {behind} --time-limit 1ms")).expect(4);
    for (other, said) in [
        ("--background image:sky.ppm", "overlay: only in the piece"),
        ("--overlay bounds", "background image: only in the piece"),
        (&format!("{behind} --overlay-levels 1"), "overlay levels: only in the plan"),
        (
            "--background image:sky.ppm --overlay accel",
            "overlay: bounds in the piece, accel (bvh, balanced) in the",
        ),
    ] {
        folder.run(&format!("plan balls.ray -o b.plan --pieces 2 {OPTIONS} {other}")).expect(0);
        folder.run("merge b.plan pieces -o merged.png").expect(1).says(said);
        let said =
            said.replace("in the piece", "there").replace("in the plan", "now").replace("in the", "now");
        folder.run(&format!("{kept} {other}")).expect(1).says(&said);
    }
    // One level of one pixel is another.
    let mut sky = folder.get("sky.ppm");
    *sky.last_mut().expect("a pixel") ^= 1;
    folder.put("sky.ppm", &sky);
    let refused = folder.run("work a.plan --piece 1 -o pieces").expect(1);
    refused.says("the plan `a.plan` is of another picture (background image differ)");
    let refused = folder.run(&format!("{kept} {behind}")).expect(1);
    refused.says("belongs to another picture (background image differ)");
    std::fs::remove_file(folder.path("sky.ppm")).expect("a file");
    folder.run("work a.plan --piece 1 -o pieces").expect(1).says("cannot read `sky.ppm`");
}

/// Balls, every other one in a group that moves among the others, so that a tree that is fitted to it is another than
/// one that is built.
fn swarm() -> String {
    let ball = |k: usize| {
        let at = |step: usize, edge: usize| 0.3 * (k * step % edge) as f64 - 0.15 * edge as f64;
        format!("#shape_sphere 0 {} {} {} .1\n", at(1, 11), at(3, 13), at(5, 7))
    };
    let of = |first: usize| (first..160).step_by(2).map(ball).collect::<String>();
    let head = common::BALLS.split("#group_begin").next().unwrap_or_default();
    let head = head.replace("0 0 4 0 0 -1", "0 0 6 0 0 -1");
    let unit = "1 0 0 0  0 1 0 0  0 0 1 0  0 0 0 1";
    format!("{head}#group_begin {unit}\n{}#group_end\n{}", of(0), of(1))
}

#[test]
fn boxes_of_groups_that_move_are_those_of_their_frame() {
    let folder = Folder::new();
    put_sky(&folder);
    folder.put("swarm.ray", swarm().as_bytes());
    folder.put("move.toml", b"[[group]]\ngroup = \"0\"\n[group.turntable]\nframes = 9\ncenter = [1, 0, 0]\n");
    for overlay in ["bounds", "accel"] {
        let options = format!(
            "--animation move.toml --frames 1-4 --size 200x150 --overlay {overlay} --background image:sky.ppm"
        );
        folder.run(&format!("animate swarm.ray {options} -o {overlay}.##.png")).expect(0);
        folder.run(&format!("plan swarm.ray {options} -o {overlay}.plan --pieces 4")).expect(0);
        let work = |n: usize| folder.run(&format!("work {overlay}.plan --piece {n} -o {overlay}")).expect(0);
        // Each in a process of its own, which begins at another frame.
        (0..4).for_each(|n| drop(work(n)));
        folder.run(&format!("merge {overlay}.plan {overlay} -o joined.{overlay}.##.png")).expect(0);
        let frame = |frame: usize| format!("{overlay}.{frame:02}.png");
        for number in 1..=4 {
            let one = folder.get(&frame(number));
            assert!(one == folder.get(&format!("joined.{}", frame(number))), "{overlay}, frame {number}");
            assert!(number == 1 || one != folder.get(&frame(number - 1)), "{overlay}, frame {number}");
        }
    }
}

#[test]
fn pieces_take_about_the_same_time() {
    let folder = Folder::new();
    // Half of the picture is empty, half of it glass.
    let glass: String = (0..60)
        .map(|k| {
            format!(
                "#shape_sphere 0 {} {} {} .3\n",
                0.5 + 0.4 * f64::from(k % 6),
                0.3 * f64::from(k / 6) - 1.5,
                -f64::from(k % 7)
            )
        })
        .collect();
    let scene = format!(
        "#camera 0 0 5 0 0 -1 0 1 0 .4\n#light_point 1 1 1 3 4 5 1 0 0\n\
         #material 0 0 0 .2 .2 .2 .9 .9 .9 0 0 0 .5 .9 1.4 -1 !!\n{glass}"
    );
    folder.put("glass.ray", scene.as_bytes());
    folder.run("plan glass.ray -o a.plan --pieces 6 --size 480x360 --recursion 9 --cutoff 0").expect(0);
    let plan = plan(&folder, "a.plan");
    let pieces = plan["pieces"].as_array().expect("pieces");
    let tiles: Vec<u64> =
        pieces.iter().map(|piece| piece["parts"][0]["count"].as_u64().expect("a number")).collect();
    let work: Vec<f64> = (0..pieces.len())
        .map(|n| {
            // Rays and tests, not seconds: machines are busy.
            let told =
                folder.run(&format!("work a.plan --piece {n} -o pieces -vv --log-format json")).expect(0);
            let rays = |line: &str| serde_json::from_str::<Value>(line).ok()?["rays"].as_f64();
            told.stderr.lines().filter_map(rays).sum()
        })
        .collect();
    let (least, most) =
        (work.iter().copied().fold(f64::INFINITY, f64::min), work.iter().copied().fold(0.0, f64::max));
    assert!(least > 0.0 && most < 2.5 * least, "{work:?} of {tiles:?} tiles");
    assert!(tiles.iter().max() > tiles.iter().min().map(|least| 2 * least).as_ref(), "{tiles:?}");
}

#[test]
fn animations_are_split_by_frames_and_tiles() {
    let folder = Folder::new();
    folder.put("turn.toml", b"[camera.turntable]\nframes = 12\n");
    let options = "--animation turn.toml --frames 3-6 --size 100x75 --layers st,direct";
    folder.run(&format!("animate balls.ray {options} -o one.##.png")).expect(0);
    folder.run(&format!("plan balls.ray {options} -o a.plan --pieces 6")).expect(0);
    assert_eq!(count(&folder, "a.plan"), 6);
    (0..5).for_each(|n| drop(folder.run(&format!("work a.plan --piece {n} -o pieces")).expect(0)));
    let told = folder.run("merge a.plan pieces -o two.##.png").expect(1);
    told.says("1 of 6 pieces are missing or not whole: 5").says("of 4 frames were written");
    folder.run("work a.plan --piece 5 -o pieces --progress json").expect(0).says("\"kind\":\"piece\"");
    folder.run("merge a.plan pieces -o two.##.png").expect(0).says("wrote 4 frames");
    for frame in 3..=6 {
        let (one, two) =
            (folder.get(&format!("one.{frame:02}.png")), folder.get(&format!("two.{frame:02}.png")));
        assert!(one == two, "frame {frame}");
        for layer in ["st", "direct"] {
            let [one, two] = ["one", "two"].map(|name| folder.get(&format!("{name}.{frame:02}.{layer}.png")));
            assert!(one == two, "frame {frame}, {layer}");
        }
    }
    folder.put("turn.toml", b"[camera.turntable]\nframes = 13\n");
    folder.run("work a.plan --piece 0 -o other").expect(1).says("animation differ");
}

/// Runs a recipe of docs/long.md with `dotray` on the path.
fn recipe(folder: &Folder, script: &str) -> std::process::Output {
    let program = std::path::Path::new(env!("CARGO_BIN_EXE_dotray"));
    let bin = program.parent().expect("a folder").display().to_string();
    let path = format!("{bin}:{}", std::env::var("PATH").unwrap_or_default());
    let mut command = Command::new("sh");
    command.args(["-ec", script]).current_dir(folder.path("")).env("PATH", path).output().expect("a shell")
}

/// The page, and its blocks of a language.
fn page() -> String {
    std::fs::read_to_string(common::root().join("docs/machines.md")).expect("the page")
}

fn blocks(language: &str) -> Vec<String> {
    let mark = format!("```{language}\n");
    let page = page();
    page.split(&mark).skip(1).filter_map(|block| Some(block.split("```").next()?.to_owned())).collect()
}

/// A folder with a plan of 16 pieces as the recipes name it, and the picture made in one go.
fn planned() -> Folder {
    let folder = Folder::new();
    folder.run(&format!("render balls.ray whole.png {OPTIONS}")).expect(0);
    folder.run(&format!("plan balls.ray -o room.plan --pieces 16 {OPTIONS}")).expect(0);
    folder
}

fn merged(folder: &Folder) {
    folder.run("merge room.plan pieces -o merged.png").expect(0);
    assert!(folder.get("merged.png") == folder.get("whole.png"));
}

#[test]
fn the_job_of_kubernetes_makes_every_piece() {
    let yaml = blocks("yaml").pop().expect("a Job");
    let job = &YamlLoader::load_from_str(&yaml).expect("YAML")[0];
    assert_eq!((job["apiVersion"].as_str(), job["kind"].as_str()), (Some("batch/v1"), Some("Job")));
    let spec = &job["spec"];
    assert_eq!(spec["completionMode"].as_str(), Some("Indexed"));
    let completions = spec["completions"].as_i64().expect("a number");
    let pod = &spec["template"]["spec"];
    let container = &pod["containers"][0];
    let folder = planned();
    assert_eq!(completions as usize, count(&folder, "room.plan"));
    // The folder that the container works in is that of the volume that all pods share.
    let mount = &container["volumeMounts"][0];
    assert_eq!(mount["mountPath"].as_str(), container["workingDir"].as_str());
    assert_eq!(mount["name"].as_str(), pod["volumes"][0]["name"].as_str());
    let words: Vec<&str> =
        container["command"].as_vec().expect("a list").iter().flat_map(Yaml::as_str).collect();
    let mut failures = spec["backoffLimit"].as_i64().expect("a number");
    for index in 0..completions {
        // The kubelet puts variables of the container in place of $(NAME), and starts the command without a shell.
        let pod = || {
            let mut words =
                words.iter().map(|word| word.replace("$(JOB_COMPLETION_INDEX)", &index.to_string()));
            let mut command = program(&words.next().expect("a program"));
            command.args(words).current_dir(folder.path("")).env("JOB_COMPLETION_INDEX", index.to_string());
            command
        };
        if index % 5 == 1 && failures > 0 {
            // A node that goes takes its pod with it; the Job starts another one for the index.
            let mut child = pod().stderr(Stdio::null()).spawn().expect("it starts");
            child.kill().and_then(|()| child.wait()).expect("killed");
            failures -= 1;
        }
        let ended = pod().output().expect("it runs");
        assert!(ended.status.success(), "{index}: {}", String::from_utf8_lossy(&ended.stderr));
    }
    merged(&folder);
}

/// The program that a recipe names.
fn program(name: &str) -> Command {
    assert_eq!(name, "dotray");
    Command::new(env!("CARGO_BIN_EXE_dotray"))
}

#[test]
fn the_command_of_opencue_makes_every_piece() {
    let line = blocks("sh").into_iter().find(|block| block.contains("CUE_IFRAME")).expect("a recipe");
    let folder = planned();
    let line = line.replace("/data", &folder.path("").display().to_string());
    for frame in 0..16 {
        // Frames begin in a folder of their own.
        let ended = recipe(&folder, &format!("cd /; export CUE_IFRAME={frame} CUE_FRAME={frame:04}\n{line}"));
        assert!(ended.status.success(), "{}", String::from_utf8_lossy(&ended.stderr));
    }
    merged(&folder);
}

/// A Python with pyoutline, RQD and the schemas of Kubernetes, where there is one: `DOTRAY_RECIPES` names it.
fn recipes_python() -> Option<std::path::PathBuf> {
    let own = || common::root().join("target/recipes/bin/python");
    let python = std::env::var_os("DOTRAY_RECIPES").map_or_else(own, Into::into);
    if !python.exists() {
        println!("skipped, no {}", python.display());
        return None;
    }
    std::path::absolute(python).ok()
}

#[test]
fn opencue_runs_both_of_its_recipes() {
    let Some(python) = recipes_python() else { return };
    let script = std::fs::canonicalize(common::root().join("crates/cli/tests/opencue.py")).expect("a script");
    let page = std::fs::canonicalize(common::root().join("docs/machines.md")).expect("the page");
    for way in ["outline", "command"] {
        let folder = Folder::new();
        let options = "--size 640x480 --aa grid=5";
        folder.run(&format!("render balls.ray whole.png {options}")).expect(0);
        folder.run(&format!("plan balls.ray -o room.plan --pieces 16 {options}")).expect(0);
        let line = format!("{} {} {} {way}", python.display(), script.display(), page.display());
        let ended = recipe(&folder, &line);
        assert!(ended.status.success(), "{way}: {}", String::from_utf8_lossy(&ended.stderr));
        merged(&folder);
    }
}

#[test]
fn the_job_is_what_kubernetes_takes() {
    let Some(python) = recipes_python() else { return };
    let yaml = blocks("yaml").pop().expect("a Job");
    let folder = Folder::new();
    let wrong =
        [("completions: 16", "completions: many"), ("workingDir", "workDir"), ("Indexed", "Indexed\n  x: 1")];
    let wrong = wrong.map(|(from, to)| yaml.replacen(from, to, 1));
    for (text, taken) in [(&yaml, true)].into_iter().chain(wrong.iter().map(|text| (text, false))) {
        folder.put("job.yaml", text.as_bytes());
        let mut command = Command::new(python.with_file_name("kubernetes-validate"));
        let ended =
            command.args(["--strict", "job.yaml"]).current_dir(folder.path("")).output().expect("it runs");
        assert_eq!(ended.status.success(), taken, "{text}\n{}", String::from_utf8_lossy(&ended.stdout));
    }
}

fn has_parallel() -> bool {
    let found = Command::new("parallel").arg("--version").output();
    let found = found.is_ok_and(|output| String::from_utf8_lossy(&output.stdout).contains("GNU"));
    if !found {
        println!("skipped, no GNU parallel");
    }
    found
}

#[test]
fn gnu_parallel_runs_its_recipe() {
    if !has_parallel() {
        return;
    }
    let folder = Folder::new();
    folder.run(&format!("render balls.ray whole.png {OPTIONS}")).expect(0);
    let recipes = blocks("sh");
    let local = recipes.iter().find(|block| block.contains("parallel") && !block.contains("--sshlogin"));
    let script = local
        .expect("a recipe")
        .replace("room.ray", "balls.ray")
        .replace("--size 4000x3000 --aa adaptive", OPTIONS);
    assert!(script.contains(OPTIONS), "{script}");
    let ended = recipe(&folder, &script);
    assert!(ended.status.success(), "{script}\n{}", String::from_utf8_lossy(&ended.stderr));
    assert!(folder.get("room.png") == folder.get("whole.png"));
}

/// A server for ssh of our own, on a port of its own, that lets in who has the key; ends with the test.
struct Ssh(std::process::Child);

impl Drop for Ssh {
    fn drop(&mut self) {
        let _ = self.0.kill().and_then(|()| self.0.wait());
    }
}

/// A server, and the file that makes `red` and `blue` this machine.
fn ssh(folder: &Folder) -> Option<(Ssh, std::path::PathBuf)> {
    let keygen = |name: &str| {
        let mut command = Command::new("ssh-keygen");
        command.args(["-q", "-t", "ed25519", "-N", "", "-f"]).arg(folder.path(name)).status()
    };
    let daemon =
        ["/usr/sbin/sshd", "/usr/bin/sshd"].into_iter().find(|path| std::path::Path::new(path).exists())?;
    if !keygen("host").ok()?.success() || !keygen("key").ok()?.success() {
        return None;
    }
    // Only root may need this folder, and only where nothing else has made it.
    let _ = std::fs::create_dir_all("/run/sshd");
    let probe = std::net::TcpListener::bind("127.0.0.1:0").ok()?;
    let port = probe.local_addr().ok()?.port();
    drop(probe);
    let at = |name: &str| folder.path(name).display().to_string();
    let bin = std::path::Path::new(env!("CARGO_BIN_EXE_dotray")).parent()?.display().to_string();
    let path = std::env::var("PATH").unwrap_or_default();
    let server = format!(
        "Port {port}\nListenAddress 127.0.0.1\nHostKey {}\nAuthorizedKeysFile {}\nStrictModes no\nUsePAM no\n\
         PasswordAuthentication no\nPermitRootLogin yes\nPidFile none\nSetEnv PATH={bin}:{path}\n",
        at("host"),
        at("key.pub")
    );
    folder.put("sshd.conf", server.as_bytes());
    let client = format!(
        "Host red blue\n HostName 127.0.0.1\n Port {port}\n IdentityFile {}\n IdentitiesOnly yes\n\
         \x20StrictHostKeyChecking no\n UserKnownHostsFile /dev/null\n LogLevel ERROR\n",
        at("key")
    );
    folder.put("ssh.conf", client.as_bytes());
    let mut command = Command::new(daemon);
    command.args(["-D", "-e", "-f"]).arg(folder.path("sshd.conf")).stderr(Stdio::null());
    let server = Ssh(command.spawn().ok()?);
    for _ in 0..100 {
        let mut probe = Command::new("ssh");
        probe.arg("-F").arg(folder.path("ssh.conf")).args(["red", "dotray --version"]);
        if probe.output().ok()?.status.success() {
            return Some((server, folder.path("ssh.conf")));
        }
        std::thread::sleep(std::time::Duration::from_millis(100));
    }
    None
}

#[test]
fn gnu_parallel_runs_its_recipe_over_ssh() {
    if !has_parallel() {
        return;
    }
    let folder = planned();
    let Some((_server, config)) = ssh(&folder) else {
        println!("skipped, no server for ssh, or nobody may log in by it");
        return;
    };
    let script = blocks("sh").into_iter().find(|block| block.contains("--sshlogin")).expect("a recipe");
    let script = format!("export PARALLEL_SSH='ssh -F {}'\n{script}", config.display());
    let ended = recipe(&folder, &script);
    assert!(ended.status.success(), "{script}\n{}", String::from_utf8_lossy(&ended.stderr));
    merged(&folder);
}

#[test]
fn slurm_runs_its_recipe() {
    let folder = Folder::new();
    folder.put("room.ray", common::BALLS.as_bytes());
    let program = std::path::Path::new(env!("CARGO_BIN_EXE_dotray"));
    let ended = Command::new("sh")
        .arg(common::root().join("crates/cli/tests/slurm.sh"))
        .arg(folder.path(""))
        .arg(std::fs::canonicalize(common::root().join("docs/machines.md")).expect("the page"))
        .arg(program.parent().expect("a folder"))
        .output()
        .expect("a shell");
    let said = String::from_utf8_lossy(&ended.stdout).into_owned() + &String::from_utf8_lossy(&ended.stderr);
    match ended.status.code() {
        Some(77) => println!("skipped: {said}"),
        code => assert_eq!(code, Some(0), "{said}"),
    }
}
