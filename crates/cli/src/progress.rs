//! A bar on a terminal: share, rate, time left. Nothing at all anywhere else.

use dotray::render::Observer;
use dotray::render::Progress;
use dotray::render::progress::Advance;
use dotray::render::progress::Meter;
use dotray::render::progress::Record;
use indicatif::ProgressBar;
use indicatif::ProgressDrawTarget;
use indicatif::ProgressState;
use indicatif::ProgressStyle;
use std::fmt;
use std::io::IsTerminal;
use std::sync::Mutex;
use std::sync::PoisonError;
use std::time::Duration;
use std::time::Instant;

use crate::events;
use crate::interrupt;
use crate::log;
use crate::long_args::ProgressName;

/// Watches a picture being made: draws the bar, if there is one, or writes lines for programs, and passes Ctrl-C on.
pub struct Watcher {
    bar: Option<ProgressBar>,
    lines: Option<Lines>,
}

/// Lines of progress for programs.
struct Lines {
    /// The pace, and when the last line was written.
    told: Mutex<(Meter, Option<Instant>)>,
}

/// The eye follows no faster, and each drawing costs a system call.
const DRAWINGS_A_SECOND: u8 = 5;
const BETWEEN_LINES: Duration = Duration::from_millis(100);

impl Watcher {
    /// A bar over `pixels` on standard error if that is a terminal and `quiet` is not asked for; lines for programs
    /// where those are wanted.
    pub fn new(pixels: u64, how: ProgressName, quiet: bool) -> Self {
        let terminal =
            || std::io::stderr().is_terminal() && std::env::var_os("TERM").is_none_or(|t| t != "dumb");
        let drawn = !quiet && how == ProgressName::Auto && !log::is_json() && terminal();
        let lines = || Lines { told: Mutex::new((Meter::new(), None)) };
        Self { bar: drawn.then(|| bar(pixels)), lines: (how == ProgressName::Json).then(lines) }
    }

    /// Takes the bar away.
    pub fn finish(&self) {
        if let Some(bar) = &self.bar {
            bar.finish_and_clear();
        }
    }
}

impl Lines {
    fn tell(&self, progress: &Progress) {
        let mut told = self.told.lock().unwrap_or_else(PoisonError::into_inner);
        let (meter, last) = &mut *told;
        let advance = meter.advance(progress);
        let now = Instant::now();
        let soon = last.is_some_and(|last| now.duration_since(last) < BETWEEN_LINES);
        if soon && progress.finished_pixels < progress.total_pixels {
            return;
        }
        *last = Some(now);
        // Seconds count from the start of the program in all lines.
        events::tell(|seconds| Record::Progress(Advance { seconds, ..advance }));
    }
}

fn bar(pixels: u64) -> ProgressBar {
    let target = ProgressDrawTarget::stderr_with_hz(DRAWINGS_A_SECOND);
    let bar = ProgressBar::with_draw_target(Some(pixels), target);
    let rate = |state: &ProgressState, out: &mut dyn fmt::Write| {
        // Nothing can be done about a terminal that takes no text.
        let _ = out.write_str(&rate_text(state.per_sec()));
    };
    let left = |state: &ProgressState, out: &mut dyn fmt::Write| {
        let _ = out.write_str(&left_text(state.pos(), state.eta()));
    };
    if let Ok(style) = ProgressStyle::with_template("{wide_bar} {percent:>3}%  {rate}  {left}") {
        bar.set_style(style.with_key("rate", rate).with_key("left", left));
    }
    bar.enable_steady_tick(Duration::from_millis(1000 / u64::from(DRAWINGS_A_SECOND)));
    bar
}

/// Pixels a second for people.
fn rate_text(per_second: f64) -> String {
    if per_second >= 1e6 {
        format!("{:.2} Mpixel/s", per_second / 1e6)
    } else if per_second >= 1e3 {
        format!("{:.1} kpixel/s", per_second / 1e3)
    } else {
        format!("{per_second:.0} pixel/s")
    }
}

/// Time left for people; nobody knows it before the first tile.
fn left_text(position: u64, left: Duration) -> String {
    let seconds = left.as_secs();
    let (hours, minutes) = (seconds / 3600, seconds / 60);
    if position == 0 {
        "started".to_owned()
    } else if hours > 0 {
        format!("{hours}h {}m left", minutes % 60)
    } else if minutes > 0 {
        format!("{minutes}m {}s left", seconds % 60)
    } else {
        format!("{seconds}s left")
    }
}

impl Observer for Watcher {
    fn tile_finished(&self, progress: &Progress) {
        if let Some(bar) = &self.bar {
            // Tiles report from many threads, so an older count may come after a newer one.
            if progress.finished_pixels > bar.position() {
                bar.set_position(progress.finished_pixels);
            }
        }
        if let Some(lines) = &self.lines {
            lines.tell(progress);
        }
    }

    fn cancelled(&self) -> bool {
        interrupt::pressed()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rates_are_readable() {
        assert_eq!(rate_text(12.4), "12 pixel/s");
        assert_eq!(rate_text(12_345.0), "12.3 kpixel/s");
        assert_eq!(rate_text(12_345_678.0), "12.35 Mpixel/s");
        assert_eq!(left_text(0, Duration::ZERO), "started");
        assert_eq!(left_text(1, Duration::from_secs(9)), "9s left");
        assert_eq!(left_text(1, Duration::from_secs(90)), "1m 30s left");
        assert_eq!(left_text(1, Duration::from_secs(2 * 3600 + 60)), "2h 1m left");
    }
}
