//! Stopping in the midst of a tile.

use dotray_render::Observer;
use std::ops::Range;
use std::sync::atomic::AtomicBool;
use std::sync::atomic::AtomicU64;
use std::sync::atomic::Ordering;
use web_time::Instant;

/// Microseconds between two questions whether to stop, where there is somebody to ask.
const ASKED_EVERY: Range<u64> = 1_000..12_000;

/// Stops the tracer in the midst of a tile.
pub struct Interrupt<'a> {
    flag: &'a AtomicBool,
    /// Who is asked now and then, in microseconds since `start`.
    ask: Option<fn() -> bool>,
    start: Instant,
    next: AtomicU64,
    stopped: AtomicBool,
}

impl<'a> Interrupt<'a> {
    pub fn new(flag: &'a AtomicBool, ask: Option<fn() -> bool>) -> Self {
        let next = AtomicU64::new(ASKED_EVERY.start);
        Self { flag, ask, start: Instant::now(), next, stopped: AtomicBool::new(false) }
    }

    fn micros(&self) -> u64 {
        u64::try_from(self.start.elapsed().as_micros()).unwrap_or(u64::MAX)
    }
}

impl Observer for Interrupt<'_> {
    fn is_impatient(&self) -> bool {
        true
    }

    fn cancelled(&self) -> bool {
        if self.flag.load(Ordering::Relaxed) || self.stopped.load(Ordering::Relaxed) {
            return true;
        }
        let Some(ask) = self.ask else { return false };
        let now = self.micros();
        if now < self.next.load(Ordering::Relaxed) {
            return false;
        }
        let stopped = ask();
        let after = self.micros();
        // Asking may cost: a tenth of the time at most, as long as the answer does not come too late.
        let pause = (10 * after.saturating_sub(now)).clamp(ASKED_EVERY.start, ASKED_EVERY.end);
        self.next.store(after + pause, Ordering::Relaxed);
        self.stopped.store(stopped, Ordering::Relaxed);
        stopped
    }
}
