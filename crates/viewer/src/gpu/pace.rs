//! How coarsely a driver in software draws a view that moves.

use std::ops::Range;
use web_time::Duration;
use web_time::Instant;

/// How long a picture of a move should take.
const TIME: Range<Duration> = Duration::from_millis(20)..Duration::from_millis(60);

/// Pictures that are further apart belong to two moves.
const APART: Duration = Duration::from_millis(700);

/// At most so many pixels become one, each way.
const COARSEST: u32 = 4;

/// See the module.
#[derive(Debug)]
pub struct Pace {
    coarseness: u32,
    last: Option<Instant>,
}

impl Default for Pace {
    fn default() -> Self {
        Self { coarseness: 1, last: None }
    }
}

impl Pace {
    /// How many pixels are one each way in the picture that is drawn now.
    pub fn next(&mut self, now: Instant) -> u32 {
        let took = self.last.replace(now).map(|last| now.saturating_duration_since(last));
        match took.filter(|took| *took < APART) {
            Some(took) if took > TIME.end => self.coarseness = (self.coarseness * 2).min(COARSEST),
            Some(took) if took < TIME.start => self.coarseness = (self.coarseness / 2).max(1),
            Some(_) | None => {}
        }
        self.coarseness
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn slow_moves_are_drawn_coarsely_and_quick_ones_finely() {
        let mut pace = Pace::default();
        let mut now = Instant::now();
        let mut after = |milliseconds: u64| {
            now += Duration::from_millis(milliseconds);
            pace.next(now)
        };
        assert_eq!([after(0), after(100), after(100), after(100)], [1, 2, 4, 4]);
        // A rest tells nothing, nor does what takes neither long nor short.
        assert_eq!([after(5000), after(40)], [4, 4]);
        assert_eq!([after(10), after(10), after(10)], [2, 1, 1]);
    }
}
