//! Long work: killed, stopped, resumed, watched.

#![cfg(unix)]

mod common;

use common::Folder;
use common::Outcome;
use dotray::image::Limits;
use dotray::image::decode;
use serde_json::Value;
use std::process::Child;
use std::process::Command;
use std::process::Stdio;
use std::time::Duration;
use std::time::Instant;

/// Takes a second or two in small tiles.
const SLOW: &str = "render balls.ray a.png --size 480x360 --aa grid=5 --threads 1 --tile-size 16";

fn start(folder: &Folder, arguments: &str) -> Child {
    let mut command = folder.command(arguments);
    command.stdin(Stdio::null()).stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().expect("it starts")
}

fn ended(child: Child) -> Outcome {
    let output = child.wait_with_output().expect("it ends");
    let stderr = String::from_utf8_lossy(&output.stderr).into_owned();
    Outcome { code: output.status.code(), stdout: output.stdout, stderr }
}

fn signal(child: &Child, name: &str) {
    let status = Command::new("kill").args([name, &child.id().to_string()]).status();
    assert!(status.expect("the program `kill`").success());
}

/// Waits until the file is there, at least `bytes` of it.
fn await_file(folder: &Folder, name: &str, bytes: u64) {
    let start = Instant::now();
    while std::fs::metadata(folder.path(name)).map_or(0, |meta| meta.len()) < bytes {
        assert!(start.elapsed() < Duration::from_secs(60), "no {name}");
        std::thread::sleep(Duration::from_millis(5));
    }
}

/// Begins slow work and kills it once some tiles are kept.
fn killed(folder: &Folder, more: &str) {
    let mut child = start(folder, &format!("{SLOW} --checkpoint c.tiles --every 20ms {more}"));
    await_file(folder, "c.tiles", 60_000);
    child.kill().and_then(|()| child.wait()).expect("killed");
    assert!(!folder.names().contains(&"a.png".to_owned()), "it was not slow");
}

#[test]
fn killed_again_and_again_and_resumed_it_makes_the_same_picture() {
    for more in ["", "--aa adaptive --aa-threshold 0 --background transparent"] {
        let line = if more.is_empty() { SLOW.to_owned() } else { SLOW.replace("--aa grid=5", more) };
        let folder = Folder::new();
        folder.run(&line.replace("a.png", "whole.png")).expect(0);
        let kept = || std::fs::metadata(folder.path("c.tiles")).map_or(0, |meta| meta.len());
        let mut kills = 0;
        // Each time after some more tiles, a few milliseconds sooner or later; the last run is left in peace.
        for attempt in 0_u64.. {
            let goal = kept() + 60_000 + attempt * 7919 % 331 * 200;
            let mut child = start(&folder, &format!("{line} --checkpoint c.tiles --every 10ms --resume"));
            let mut runs = || child.try_wait().expect("a child").is_none();
            while attempt < 12 && runs() && kept() < goal {
                std::thread::sleep(Duration::from_millis(attempt % 7));
            }
            if attempt < 12 && runs() {
                child.kill().and_then(|()| child.wait()).expect("killed");
                kills += 1;
                continue;
            }
            ended(child).expect(0);
            break;
        }
        assert!(kills >= 3, "it was not slow: {kills} kills");
        assert!(folder.get("a.png") == folder.get("whole.png"), "other bytes after {kills} kills");
        assert!(!folder.names().contains(&"c.tiles".to_owned()), "a finished picture needs no checkpoint");
    }
}

/// The last line of an event of these.
fn event(lines: &str, event: &str) -> Value {
    let mut lines = lines.lines().filter_map(|line| serde_json::from_str::<Value>(line).ok());
    lines.rfind(|line| line["event"] == event).unwrap_or_else(|| panic!("no event `{event}`"))
}

#[test]
fn layers_are_kept_like_the_picture() {
    for picture in ["a.exr", "a.png"] {
        let folder = Folder::new();
        let line =
            "render balls.ray a.png --size 1000x750 --threads 1 --layers depth,shadow,reflected,boxtests";
        let line = line.replace("a.png", picture);
        folder.run(&line.replace("a.", "whole.")).expect(0);
        let mut child = start(&folder, &format!("{line} --checkpoint c.tiles --every 10ms"));
        // All of the picture and some bands of the layers.
        await_file(&folder, "c.tiles", 1000 * 750 * 12 + 500_000);
        child.kill().and_then(|()| child.wait()).expect("killed");
        assert!(!folder.names().contains(&picture.to_owned()), "it was not slow");
        let resume = format!("{line} --checkpoint c.tiles --resume");
        let refused = folder.run(&resume.replace(",boxtests", "")).expect(1);
        refused.says("layers: depth,shadow,reflected,boxtests there, depth,shadow,reflected now");
        // A time limit in the midst of the layers keeps them, too.
        folder.run(&format!("{resume} --time-limit 1ms")).expect(4).says("% of the picture and its layers");
        let said = folder.run(&format!("{resume} --progress json")).expect(0).stderr;
        assert_eq!(event(&said, "picture")["finished_pixels"], 1000 * 750);
        let layers = event(&said, "layers");
        assert!(layers["finished_pixels"].as_u64().is_some_and(|kept| kept > 1000), "{layers}");
        assert!(layers["finished_pixels"].as_u64().is_some_and(|kept| kept < 1000 * 750), "{layers}");
        let mut made = folder.names();
        made.retain(|name| name.starts_with("a."));
        assert_eq!(made.len(), if picture == "a.exr" { 1 } else { 5 });
        for name in made {
            assert!(folder.get(&name) == folder.get(&name.replace("a.", "whole.")), "{name}");
        }
    }
}

#[test]
fn damage_costs_the_damaged_tiles_only() {
    let folder = Folder::new();
    folder.run(&SLOW.replace("a.png", "whole.png")).expect(0);
    let child = start(&folder, &format!("{SLOW} --checkpoint c.tiles --every 20ms"));
    await_file(&folder, "c.tiles", 60_000);
    // Tiles that are added later come behind a head of their own.
    let length = std::fs::metadata(folder.path("c.tiles")).expect("a checkpoint").len();
    await_file(&folder, "c.tiles", length + 1);
    signal(&child, "-TERM");
    ended(child).expect(143);
    let whole = folder.get("c.tiles");
    let damaged = |name: &str, change: &dyn Fn(&mut Vec<u8>)| {
        let mut bytes = whole.clone();
        change(&mut bytes);
        folder.put("c.tiles", &bytes);
        let resumed = folder.run(&format!("{SLOW} --checkpoint c.tiles --resume --progress json")).expect(0);
        assert!(folder.get("a.png") == folder.get("whole.png"), "{name}");
        std::fs::remove_file(folder.path("a.png")).expect("a picture");
        let line = resumed.stderr.lines().find(|line| line.contains("\"picture\"") && line.contains("tiles"));
        let line: Value = serde_json::from_str(line.expect("a line of the picture")).expect("JSON");
        (line["finished_pixels"].as_u64().expect("a number"), resumed)
    };
    let (kept, resumed) = damaged("nothing", &|_| ());
    assert!(kept > 0 && !resumed.stderr.contains("damaged"), "{}", resumed.stderr);
    let tile = 16 * 16;
    let (less, resumed) = damaged("a byte", &|bytes| *bytes.last_mut().expect("bytes") ^= 1);
    assert_eq!(less, kept - tile);
    resumed.says("damaged; only their tiles are made again");
    assert_eq!(damaged("the head", &|bytes| bytes[20] ^= 1).0, kept, "another head follows");
    assert_eq!(damaged("the end", &|bytes| bytes.truncate(bytes.len() - 1)).0, kept - tile);
    assert_eq!(damaged("text after it", &|bytes| bytes.extend(b"dtt1 dth1 and more")).0, kept);
    let (less, _) = damaged("the middle", &|bytes| {
        let middle = bytes.len() / 2;
        bytes[middle..middle + 4000].fill(0);
    });
    assert!(less < kept && less >= kept - 4 * tile, "{less} of {kept}");
    folder.put("c.tiles", b"no checkpoint");
    folder.run(&format!("{SLOW} --checkpoint c.tiles --resume")).expect(1).says("is no checkpoint");
}

#[test]
fn a_checkpoint_of_something_else_is_refused_with_the_difference() {
    let folder = Folder::new();
    killed(&folder, "");
    let resume = format!("{SLOW} --checkpoint c.tiles --resume");
    let before = folder.get("c.tiles");
    folder.run(&resume.replace("480x360", "480x361")).expect(1).says("size: 480x360 there, 480x361 now");
    folder.run(&resume.replace("grid=5", "grid=4")).expect(1).says("aa: grid=5 there, grid=4 now");
    folder.run(&format!("{resume} --recursion 3")).expect(1).says("recursion: 5 there, 3 now");
    folder.run(&format!("{SLOW} --checkpoint c.tiles")).expect(1).says("--resume goes on with it");
    for (from, to, part) in [
        ("#ambient .2", "#ambient .3", "background and ambient light differ"),
        ("3 4 5 1 0 0", "3 4 6 1 0 0", "lights differ"),
        ("#shape_sphere 0 0 0 0 1\n", "#shape_sphere 0 0 0 0 1.5\n", "shapes differ"),
        (".7 .6 .1", ".7 .6 .2", "materials differ"),
    ] {
        let text = common::BALLS.replacen(from, to, 1);
        assert_ne!(text, common::BALLS, "{from}");
        folder.put("balls.ray", text.as_bytes());
        let refused = folder.run(&resume).expect(1).says(part);
        assert_eq!(refused.stderr.matches("differ").count(), 1, "{}", refused.stderr);
    }
    assert!(folder.get("c.tiles") == before, "what is refused is left alone");
    // Comments are no part of the picture; nor is its place or format.
    folder.put("balls.ray", format!("// hello\n{}", common::BALLS).as_bytes());
    folder.run(&resume.replace("a.png", "a.bmp")).expect(0);
    folder.run(&format!("{SLOW} --resume")).expect(2).says("--checkpoint");
}

#[test]
fn ctrl_c_and_sigterm_keep_the_tiles_and_say_how_to_go_on() {
    for (name, code, word) in [("-INT", 130, "interrupted"), ("-TERM", 143, "terminated")] {
        let folder = Folder::new();
        folder.run(&SLOW.replace("a.png", "whole.png")).expect(0);
        // An hour, so that only the end can have kept them.
        let child = start(&folder, &format!("{SLOW} --checkpoint c.tiles --every 1h"));
        await_file(&folder, "c.tiles", 10);
        std::thread::sleep(Duration::from_millis(300));
        signal(&child, name);
        let stopped = ended(child).expect(code).says(word).says("--checkpoint c.tiles --every 1h --resume");
        assert!(!folder.names().contains(&"a.png".to_owned()));
        assert!(folder.get("c.tiles").len() > 10_000, "{}", stopped.stderr);
        let line = stopped.stderr.lines().last().expect("a command").trim();
        let words = line.split_once(" render ").expect("the whole line").1;
        folder.run(&format!("render {words}")).expect(0);
        assert!(folder.get("a.png") == folder.get("whole.png"));
    }
}

#[test]
fn a_second_ctrl_c_stops_at_once() {
    let folder = Folder::new();
    let made = Command::new("mkfifo").arg(folder.path("pipe.png")).status();
    assert!(made.expect("the program `mkfifo`").success());
    // The orderly end writes the picture so far, and nobody reads the pipe: it waits.
    let line = format!("{SLOW} --partial-every 1h").replace("a.png", "pipe.png");
    let mut child = start(&folder, &line);
    std::thread::sleep(Duration::from_millis(300));
    signal(&child, "-INT");
    std::thread::sleep(Duration::from_millis(500));
    assert!(child.try_wait().expect("a child").is_none(), "the orderly end does not wait");
    signal(&child, "-INT");
    let pressed = Instant::now();
    ended(child).expect(130);
    assert!(pressed.elapsed() < Duration::from_secs(2));
}

#[test]
fn a_time_limit_writes_what_is_there() {
    let folder = Folder::new();
    folder.run(&SLOW.replace("a.png", "whole.png")).expect(0);
    let line = format!("{SLOW} --time-limit 300ms --order coarse-to-fine --checkpoint c.tiles");
    folder.run(&line).expect(4).says("the time limit came first").says("go on with");
    let (part, whole) = (folder.get("a.png"), folder.get("whole.png"));
    let part = decode(&part, None, &Limits::default()).expect("a picture");
    let whole_picture = decode(&whole, None, &Limits::default()).expect("a picture");
    assert_eq!((part.width(), part.height()), (whole_picture.width(), whole_picture.height()));
    assert!(part != whole_picture, "it was not slow");
    // The coarse looks have covered everything: nothing is black, as the background is not.
    assert!(part.samples().chunks(3).all(|pixel| pixel != [0.0; 3]));
    folder.run(&format!("{SLOW} --checkpoint c.tiles --resume --order coarse-to-fine")).expect(0);
    assert!(folder.get("a.png") == whole);
    folder.run(&format!("{SLOW} --time-limit 1h")).expect(0);
}

#[test]
fn the_picture_so_far_is_always_a_picture() {
    let folder = Folder::new();
    let mut child = start(&folder, &format!("{SLOW} --partial-every 30ms --order coarse-to-fine"));
    let mut seen = Vec::new();
    while child.try_wait().expect("a child").is_none() {
        if let Ok(bytes) = std::fs::read(folder.path("a.png")) {
            decode(&bytes, None, &Limits::default()).expect("a whole picture");
            if seen.last() != Some(&bytes) {
                seen.push(bytes);
            }
        }
    }
    ended(child).expect(0);
    assert!(seen.len() >= 3, "only {} states were seen", seen.len());
    let last = folder.get("a.png");
    folder.run(SLOW).expect(0);
    assert!(folder.get("a.png") == last);
    folder.run("render balls.ray - --partial-every 1s").expect(2).says("name a file");
}

/// A row of the page's table of keys: the key, its events, its type.
type Field = (String, Vec<String>, String);

/// What stands between backticks.
fn quoted(text: &str) -> Vec<String> {
    text.split('`').skip(1).step_by(2).map(str::to_owned).collect()
}

/// The events and the keys that docs/progress.md describes.
fn described() -> (Vec<String>, Vec<Field>) {
    let page = std::fs::read_to_string(common::root().join("docs/progress.md")).expect("the page");
    assert!(page.contains("This page describes schema 1,"));
    let rows = |columns: usize| {
        let cells = |line: &str| line.split('|').map(|cell| cell.trim().to_owned()).collect::<Vec<_>>();
        let rows = page.lines().filter(|line| line.starts_with("| `")).map(cells);
        rows.filter(|cells| cells.len() == columns + 2).collect::<Vec<_>>()
    };
    let events: Vec<String> = rows(2).iter().flat_map(|row| quoted(&row[1])).collect();
    let field = |row: &Vec<String>| {
        let of = if row[2] == "all" { events.clone() } else { quoted(&row[2]) };
        quoted(&row[1]).into_iter().map(move |key| (key, of.clone(), row[3].clone())).collect::<Vec<_>>()
    };
    let fields = rows(4).iter().flat_map(field).collect();
    (events, fields)
}

fn is_of_type(value: &Value, described: &str) -> bool {
    match described {
        "whole number" => value.is_u64(),
        "number" => value.is_number(),
        "number or null" => value.is_number() || value.is_null(),
        "text" => value.is_string(),
        other => value.as_str().is_some_and(|value| {
            other.strip_prefix("text: ").is_some_and(|words| quoted(words).contains(&value.to_owned()))
        }),
    }
}

/// Fails unless the line is what the page says: an event of the page with all of its keys and no others.
fn validate(line: &Value, (events, fields): &(Vec<String>, Vec<Field>)) {
    let event = line["event"].as_str().expect("an event").to_owned();
    assert!(events.contains(&event), "no such event on the page: {line}");
    let described: Vec<&Field> = fields.iter().filter(|(_, of, _)| of.contains(&event)).collect();
    for (key, _, kind) in &described {
        let value = line.get(key).unwrap_or_else(|| panic!("no `{key}` in {line}"));
        assert!(is_of_type(value, kind), "`{key}` is no {kind} in {line}");
    }
    for key in line.as_object().expect("an object").keys() {
        assert!(described.iter().any(|(name, ..)| name == key), "`{key}` is not on the page: {line}");
    }
}

/// The lines that a program writes, each of which is as the page says.
fn events_of(said: &str) -> Vec<Value> {
    let page = described();
    let lines = said.lines().filter(|line| line.starts_with('{'));
    let lines: Vec<Value> =
        lines.map(|line| serde_json::from_str(line).unwrap_or_else(|e| panic!("{e}: {line}"))).collect();
    lines.iter().for_each(|line| validate(line, &page));
    lines
}

#[test]
fn progress_is_json_as_its_page_says() {
    let folder = Folder::new();
    let ended = folder
        .run(&format!(
            "{SLOW} --progress json --partial-every 100ms --checkpoint c.tiles --every 50ms --layers st"
        ))
        .expect(0);
    assert_eq!(ended.stderr.lines().count(), events_of(&ended.stderr).len(), "nothing but events");
    let lines = events_of(&ended.stderr);
    let events: Vec<&str> = lines.iter().map(|line| line["event"].as_str().expect("an event")).collect();
    assert_eq!((events[0], events[1], *events.last().unwrap()), ("start", "picture", "end"));
    for event in ["progress", "saved", "layers"] {
        assert!(events.contains(&event), "{event}: {events:?}");
    }
    assert_eq!(lines[0]["schema"], 1);
    let layers = events.iter().position(|event| *event == "layers").expect("layers");
    for part in [&lines[..layers], &lines[layers..]] {
        let of = part.iter().filter(|line| line["event"] == "progress");
        let finished: Vec<u64> = of.map(|line| line["finished_pixels"].as_u64().unwrap()).collect();
        assert!(finished.is_sorted(), "{finished:?}");
        assert_eq!(finished.last(), Some(&(480 * 360)));
    }
    let seconds: Vec<f64> = lines.iter().map(|line| line["seconds"].as_f64().unwrap()).collect();
    assert!(seconds.is_sorted());
    assert_eq!(event(&ended.stderr, "end")["outcome"], "done");
    let kinds = |lines: &[Value]| -> Vec<String> {
        lines.iter().filter_map(|line| Some(line["kind"].as_str()?.to_owned())).collect()
    };
    assert!(
        kinds(&lines).contains(&"checkpoint".to_owned()) && kinds(&lines).contains(&"partial".to_owned())
    );
    let failed = folder.run("render wrong.ray a.png --progress json").expect(1).stderr;
    assert_eq!(events_of(&failed).last().expect("an event")["outcome"], "failed");
    let late = folder.run(&format!("{SLOW} --progress json --time-limit 100ms")).expect(4).stderr;
    assert_eq!(events_of(&late).last().expect("an event")["outcome"], "time-limit");
    // The other two commands.
    folder.put("turn.toml", b"[camera.turntable]\nframes = 9\n");
    let frames = "balls.ray --animation turn.toml --frames 1-2 --size 40x30";
    let said = folder.run(&format!("animate {frames} -o out.#.png --progress json")).expect(0).stderr;
    let lines = events_of(&said);
    assert_eq!(lines.iter().filter(|line| line["event"] == "frame").count(), 2);
    assert_eq!(kinds(&lines), ["frame", "frame"]);
    folder.run(&format!("plan {frames} -o a.plan --pieces 1")).expect(0);
    let said = folder.run("work a.plan --piece 0 -o pieces --progress json").expect(0).stderr;
    assert_eq!(kinds(&events_of(&said)), ["piece", "piece"]);
}

#[test]
fn what_the_page_does_not_say_is_found() {
    let page = described();
    let text = std::fs::read_to_string(common::root().join("docs/progress.md")).expect("the page");
    let shown = text.split("```json\n").nth(1).and_then(|rest| rest.split("```").next()).expect("lines");
    assert_eq!(events_of(shown).len(), 3);
    assert!(page.0.len() == 7 && page.1.len() > 15, "{page:?}");
    let fine = serde_json::json!({ "event": "end", "seconds": 0.5, "outcome": "done", "exit": 0 });
    validate(&fine, &page);
    for (key, value) in [
        ("exit", Some(serde_json::json!("0"))),
        ("exit", None),
        ("outcome", Some(serde_json::json!("well"))),
        ("more", Some(serde_json::json!(1))),
        ("event", Some(serde_json::json!("fin"))),
    ] {
        let mut wrong = fine.clone();
        match value {
            Some(value) => wrong[key] = value,
            None => drop(wrong.as_object_mut().expect("an object").remove(key)),
        }
        let found = std::panic::catch_unwind(|| validate(&wrong, &page));
        assert!(found.is_err(), "{wrong}");
    }
}

#[test]
fn messages_can_be_json_and_more_can_be_said() {
    let folder = Folder::new();
    let line = "render wrong.ray a.png --log-format json";
    let objects = |text: &str| -> Vec<Value> {
        text.lines()
            .map(|line| serde_json::from_str(line).unwrap_or_else(|e| panic!("{e}: {line}")))
            .collect()
    };
    let said = objects(&folder.run(line).expect(1).stderr);
    let errors: Vec<&Value> = said.iter().filter(|object| object["level"] == "ERROR").collect();
    assert_eq!(errors.len(), 1);
    assert_eq!(errors[0]["code"], "unknown-directive");
    assert!(errors[0]["text"].as_str().is_some_and(|text| text.contains("wrong.ray:2:1")), "{said:?}");
    let said = objects(&folder.run("render balls.ray 1/2/a.png --log-format json").expect(1).stderr);
    assert!(said[0]["message"].as_str().is_some_and(|text| text.contains("there is no folder")), "{said:?}");
    let quiet = folder.run("render balls.ray a.png 64 48").expect(0).stderr;
    assert_eq!(quiet, "");
    let more = folder.run("render balls.ray a.png 64 48 -v").expect(0).stderr;
    assert!(more.contains("stage=\"parse\"") && !more.contains("a tile is finished"), "{more}");
    let most = folder.run("render balls.ray a.png 64 48 -vv --log-format json").expect(0).stderr;
    let tiles = objects(&most).iter().filter(|object| object["message"] == "a tile is finished").count();
    assert_eq!(tiles, 4);
}
