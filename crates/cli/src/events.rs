//! Progress for programs: one JSON object a line on standard error, described in docs/progress.md.

use serde_json::Value;
use serde_json::json;
use std::io;
use std::io::Write;
use std::sync::OnceLock;
use std::time::Instant;

/// The version of the lines' meaning; a new key does not change it.
const SCHEMA: u32 = 1;

static START: OnceLock<Instant> = OnceLock::new();

/// Begins the stream.
pub fn start(command: &str, scene: &str, picture: &str) {
    START.get_or_init(Instant::now);
    emit(
        "start",
        json!({ "schema": SCHEMA, "version": env!("CARGO_PKG_VERSION"), "command": command, "scene": scene,
                "picture": picture }),
    );
}

/// Writes a line, if somebody asked for them. `more` is an object; `event` and `seconds` since the start are added.
pub fn emit(event: &str, more: Value) {
    let Some(start) = START.get() else { return };
    let mut line = json!({ "event": event, "seconds": start.elapsed().as_secs_f64() });
    if let (Some(line), Value::Object(more)) = (line.as_object_mut(), more) {
        line.extend(more);
    }
    // In one piece, so that lines of several threads never mix. If nobody reads, nothing can be done about it.
    let _ = io::stderr().lock().write_all(format!("{line}\n").as_bytes());
}

/// Ends the stream.
pub fn end(exit: u8) {
    let outcome = match exit {
        0 => "done",
        4 => "time-limit",
        130 | 143 => "interrupted",
        1..=3 | 5.. => "failed",
    };
    emit("end", json!({ "outcome": outcome, "exit": exit }));
}
