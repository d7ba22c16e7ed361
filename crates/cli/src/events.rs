//! Progress for programs: one JSON object a line on standard error, described in docs/progress.md.

use dotray::render::progress::End;
use dotray::render::progress::Extent;
use dotray::render::progress::Frame;
use dotray::render::progress::Outcome;
use dotray::render::progress::Record;
use dotray::render::progress::SCHEMA;
use dotray::render::progress::Saved;
use dotray::render::progress::SavedKind;
use dotray::render::progress::Start;
use std::io;
use std::io::Write;
use std::path::Path;
use std::sync::OnceLock;
use std::time::Instant;

static START: OnceLock<Instant> = OnceLock::new();

/// Begins the stream.
pub fn start(command: &str, scene: &str, picture: &str) {
    START.get_or_init(Instant::now);
    tell(|seconds| {
        Record::Start(Start {
            seconds,
            schema: SCHEMA,
            version: env!("CARGO_PKG_VERSION").to_owned(),
            command: command.to_owned(),
            scene: scene.to_owned(),
            picture: picture.to_owned(),
        })
    });
}

/// Writes the record that belongs to the seconds since the start, if somebody asked for records.
pub fn tell(record: impl FnOnce(f64) -> Record) {
    let Some(start) = START.get() else { return };
    // In one piece, so that lines of several threads never mix, and in the order of their time.
    let mut stderr = io::stderr().lock();
    let record = record(start.elapsed().as_secs_f64());
    if let Ok(line) = serde_json::to_string(&record) {
        // If nobody reads, nothing can be done about it.
        let _ = stderr.write_all((line + "\n").as_bytes());
    }
}

/// A picture, or its layers, are about to be traced: `extent` says so to those who ask at so many seconds.
pub fn picture(extent: impl FnOnce(f64) -> Extent) {
    tell(|seconds| Record::Picture(extent(seconds)));
}

/// The layers of a picture are about to be traced.
pub fn layers(extent: impl FnOnce(f64) -> Extent) {
    tell(|seconds| Record::Layers(extent(seconds)));
}

/// A file was written.
pub fn saved(kind: SavedKind, path: &Path) {
    tell(|seconds| Record::Saved(Saved { seconds, kind, file: path.display().to_string() }));
}

/// A frame begins, one of so many that are to be made.
pub fn frame(frame: u32, frames: usize) {
    tell(|seconds| Record::Frame(Frame { seconds, frame, frames: frames as u64 }));
}

/// Ends the stream.
pub fn end(exit: u8) {
    let outcome = match exit {
        0 => Outcome::Done,
        4 => Outcome::TimeLimit,
        130 | 143 => Outcome::Interrupted,
        1..=3 | 5.. => Outcome::Failed,
    };
    tell(|seconds| Record::End(End { seconds, outcome, exit }));
}

#[cfg(test)]
mod tests {
    use super::*;
    use dotray::render::progress::Advance;

    /// Every event with every key, as it has been written since schema 1: whoever changes one of these lines breaks
    /// programs that read them, unless the key is new.
    const LINES: [&str; 10] = [
        concat!(
            r#"{"event":"start","seconds":0.0,"schema":1,"version":"0.1.0","command":"render","#,
            r#""scene":"a.ray","picture":"a.png"}"#
        ),
        r#"{"event":"picture","seconds":0.5,"width":4,"height":3,"tiles":2,"finished_pixels":0,"total_pixels":12}"#,
        r#"{"event":"layers","seconds":0.5,"width":4,"height":3,"tiles":2,"finished_pixels":0,"total_pixels":12}"#,
        concat!(
            r#"{"event":"progress","seconds":1.0,"finished_pixels":6,"total_pixels":12,"#,
            r#""pixels_per_second":6.5,"seconds_left":1.25}"#
        ),
        concat!(
            r#"{"event":"progress","seconds":1.0,"finished_pixels":0,"total_pixels":12,"#,
            r#""pixels_per_second":0.0,"seconds_left":null}"#
        ),
        r#"{"event":"saved","seconds":1.5,"kind":"checkpoint","file":"a.tiles"}"#,
        r#"{"event":"saved","seconds":1.5,"kind":"partial","file":"a.png"}"#,
        r#"{"event":"frame","seconds":1.5,"frame":7,"frames":48}"#,
        r#"{"event":"end","seconds":2.0,"outcome":"done","exit":0}"#,
        r#"{"event":"end","seconds":2.0,"outcome":"time-limit","exit":4}"#,
    ];

    fn records() -> [Record; 10] {
        let extent =
            Extent { seconds: 0.5, width: 4, height: 3, tiles: 2, finished_pixels: 0, total_pixels: 12 };
        let advance = Advance {
            seconds: 1.0,
            finished_pixels: 6,
            total_pixels: 12,
            pixels_per_second: 6.5,
            seconds_left: Some(1.25),
        };
        let saved = |kind, file: &str| Record::Saved(Saved { seconds: 1.5, kind, file: file.to_owned() });
        let [version, command, scene, picture] = ["0.1.0", "render", "a.ray", "a.png"].map(str::to_owned);
        [
            Record::Start(Start { seconds: 0.0, schema: SCHEMA, version, command, scene, picture }),
            Record::Picture(extent.clone()),
            Record::Layers(extent),
            Record::Progress(advance),
            Record::Progress(Advance {
                finished_pixels: 0,
                pixels_per_second: 0.0,
                seconds_left: None,
                ..advance
            }),
            saved(SavedKind::Checkpoint, "a.tiles"),
            saved(SavedKind::Partial, "a.png"),
            Record::Frame(Frame { seconds: 1.5, frame: 7, frames: 48 }),
            Record::End(End { seconds: 2.0, outcome: Outcome::Done, exit: 0 }),
            Record::End(End { seconds: 2.0, outcome: Outcome::TimeLimit, exit: 4 }),
        ]
    }

    #[test]
    fn every_key_keeps_its_name_and_its_type() {
        for (record, line) in records().iter().zip(LINES) {
            assert_eq!(serde_json::to_string(record).unwrap(), line);
            assert_eq!(serde_json::from_str::<Record>(line).unwrap(), *record);
        }
        let word = |kind: &SavedKind| serde_json::to_string(kind).unwrap();
        let kinds = [SavedKind::Frame, SavedKind::Movie, SavedKind::Piece];
        assert_eq!(kinds.each_ref().map(word), [r#""frame""#, r#""movie""#, r#""piece""#]);
        let word = |outcome: &Outcome| serde_json::to_string(outcome).unwrap();
        let outcomes = [Outcome::Interrupted, Outcome::Failed];
        assert_eq!(outcomes.each_ref().map(word), [r#""interrupted""#, r#""failed""#]);
    }

    #[test]
    fn readers_ignore_what_they_do_not_know() {
        for (record, line) in records().iter().zip(LINES) {
            let longer = line.replacen('{', r#"{"more":[1,{"deep":null}],"#, 1);
            assert_eq!(serde_json::from_str::<Record>(&longer).unwrap(), *record);
        }
        let unknown = r#"{"event":"supper","seconds":3.5,"guests":["a"]}"#;
        assert_eq!(serde_json::from_str::<Record>(unknown).unwrap(), Record::Other);
        let Record::Saved(saved) =
            serde_json::from_str(r#"{"event":"saved","seconds":1,"kind":"log","file":"a"}"#).unwrap()
        else {
            panic!("a file was saved");
        };
        assert_eq!(saved.kind, SavedKind::Other("log".to_owned()));
        // What lacks a key, or has another type, is no record.
        for wrong in [r#"{"event":"end","seconds":1,"outcome":"done"}"#, r#"{"seconds":1}"#, "[]", "{}"] {
            assert!(serde_json::from_str::<Record>(wrong).is_err(), "{wrong}");
        }
        let wrong = LINES[7].replace("7", "\"7\"");
        assert!(serde_json::from_str::<Record>(&wrong).is_err());
    }
}
