//! Records of progress: what `--progress json` writes, one a line, what functions in Python are called with, and what a
//! viewer shows. docs/progress.md describes every event and key.
//!
//! With the feature `serde`, a [`Record`] becomes the JSON object of a line and back. Who reads them ignores keys that
//! are unknown, and gets [`Record::Other`] for events that are.

use crate::observer::Progress;
use web_time::Instant;

/// The version of the records' meaning, raised where a key changes its meaning or goes; new keys and new events may
/// come without that.
pub const SCHEMA: u32 = 1;

/// Something that happened while pictures were being made.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(tag = "event", rename_all = "kebab-case"))]
pub enum Record {
    /// The work begins: once, first.
    Start(Start),
    /// A picture is about to be traced.
    Picture(Extent),
    /// The layers of a picture are about to be traced.
    Layers(Extent),
    /// So far the picture, or its layers, have come.
    Progress(Advance),
    /// A file was written.
    Saved(Saved),
    /// A frame of an animation begins.
    Frame(Frame),
    /// The work has ended: once, last.
    End(End),
    /// An event that a newer version tells of.
    #[cfg_attr(feature = "serde", serde(other))]
    Other,
}

/// What is being done.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Start {
    /// Since the start, by a steady clock, as in all records.
    pub seconds: f64,
    /// [`SCHEMA`]
    pub schema: u32,
    /// The version of the program.
    pub version: String,
    /// What was asked for: `render`, `animate`, `work`.
    pub command: String,
    /// The scene's file; `-` is standard input.
    pub scene: String,
    /// Where the picture goes: a file, a pattern with `#` for frames, a folder for pieces.
    pub picture: String,
}

/// How large a picture is, or its layers are.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Extent {
    /// Since the start.
    pub seconds: f64,
    /// Columns of what is stored.
    pub width: u32,
    /// Its rows.
    pub height: u32,
    /// How many tiles there are; those of layers are bands of rows.
    pub tiles: u64,
    /// Above 0 where a checkpoint goes on.
    pub finished_pixels: u64,
    /// Of the picture, or of its layers.
    pub total_pixels: u64,
}

/// How far a picture, or its layers, have come, and how fast.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Advance {
    /// Since the start.
    pub seconds: f64,
    /// Pixels that are finished.
    pub finished_pixels: u64,
    /// All pixels of the picture, or of its layers.
    pub total_pixels: u64,
    /// The mean since the picture, or its layers, began.
    pub pixels_per_second: f64,
    /// `None` as long as nobody knows.
    pub seconds_left: Option<f64>,
}

impl Advance {
    /// The whole per cent that are finished: 100 at the end and not before.
    pub fn percent(&self) -> u64 {
        let Self { finished_pixels, total_pixels, .. } = self;
        (100 * u128::from(*finished_pixels) / u128::from(*total_pixels).max(1)) as u64
    }
}

/// A file that was written.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Saved {
    /// Since the start.
    pub seconds: f64,
    /// What is in it.
    pub kind: SavedKind,
    /// Its name.
    pub file: String,
}

/// What is in a file that was written.
#[derive(Clone, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(rename_all = "kebab-case"))]
pub enum SavedKind {
    /// Finished tiles.
    Checkpoint,
    /// The picture so far.
    Partial,
    /// A frame of an animation.
    Frame,
    /// All frames.
    Movie,
    /// Part of a picture that is split.
    Piece,
    /// Something of which a newer version tells.
    #[cfg_attr(feature = "serde", serde(untagged))]
    Other(String),
}

/// A frame of an animation.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Frame {
    /// Since the start.
    pub seconds: f64,
    /// Its number.
    pub frame: u32,
    /// How many are to be made.
    pub frames: u64,
}

/// How the work ended.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct End {
    /// Since the start.
    pub seconds: f64,
    /// In a word.
    pub outcome: Outcome,
    /// The exit code.
    pub exit: u8,
}

/// How work ended.
#[derive(Clone, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(rename_all = "kebab-case"))]
pub enum Outcome {
    /// Well.
    Done,
    /// By a signal.
    Interrupted,
    /// By the time limit.
    TimeLimit,
    /// By a fault.
    Failed,
    /// In a way of which a newer version tells.
    #[cfg_attr(feature = "serde", serde(untagged))]
    Other(String),
}

/// Measures how fast a picture comes.
#[derive(Clone, Copy, Debug)]
pub struct Meter {
    start: Instant,
    /// Pixels that were finished at the first look, and at the last one.
    before: Option<u64>,
    last: u64,
}

impl Meter {
    /// Measures from now on.
    #[expect(clippy::new_without_default, reason = "the clock is read, which a default does not suggest")]
    pub fn new() -> Self {
        Self { start: Instant::now(), before: None, last: 0 }
    }

    /// Seconds since it measures.
    pub fn seconds(&self) -> f64 {
        self.start.elapsed().as_secs_f64()
    }

    /// How far it is and how fast. Tiles report from many threads: a count older than the last one is taken for that.
    pub fn advance(&mut self, progress: &Progress) -> Advance {
        let Progress { finished_pixels, total_pixels } = *progress;
        self.last = self.last.max(finished_pixels);
        let before = *self.before.get_or_insert(finished_pixels);
        let seconds = self.seconds();
        let made = self.last.saturating_sub(before) as f64;
        let pixels_per_second = if seconds > 0.0 { made / seconds } else { 0.0 };
        let left = total_pixels.saturating_sub(self.last) as f64;
        let seconds_left = (pixels_per_second > 0.0).then(|| left / pixels_per_second);
        Advance { seconds, finished_pixels: self.last, total_pixels, pixels_per_second, seconds_left }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn pace_counts_from_where_the_picture_began() {
        let mut meter = Meter::new();
        let at = |finished_pixels| Progress { finished_pixels, total_pixels: 1000 };
        let first = meter.advance(&at(400));
        assert_eq!((first.finished_pixels, first.pixels_per_second, first.seconds_left), (400, 0.0, None));
        std::thread::sleep(std::time::Duration::from_millis(20));
        let second = meter.advance(&at(600));
        assert!((second.pixels_per_second * second.seconds - 200.0).abs() < 1e-6, "{second:?}");
        assert!((second.seconds_left.unwrap() - 2.0 * second.seconds).abs() < 1e-6, "{second:?}");
        // An older count that comes late.
        assert_eq!(meter.advance(&at(500)).finished_pixels, 600);
        assert_eq!(meter.advance(&at(1000)).seconds_left, Some(0.0));
    }

    #[test]
    fn a_hundred_per_cent_come_at_the_end() {
        let percent = |finished_pixels, total_pixels| {
            Advance { finished_pixels, total_pixels, ..Advance::default() }.percent()
        };
        assert_eq!((percent(0, 3), percent(2, 3), percent(3, 3)), (0, 66, 100));
        assert_eq!((percent(u64::MAX - 1, u64::MAX), percent(0, 0)), (99, 0));
    }
}
