//! What was typed about long work: keeping it, stopping it, watching it.

use clap::Args;
use clap::ValueEnum;
use std::path::PathBuf;
use std::str::FromStr;
use std::time::Duration;

/// Options of long work.
#[derive(Clone, Debug, Default, PartialEq, Args)]
#[command(next_help_heading = "Long work")]
pub struct LongArgs {
    /// Keep finished tiles in this file while the picture is being made, so that nothing is lost if the program is
    /// stopped or killed. It goes once the picture is written.
    #[arg(long, value_name = "FILE")]
    pub checkpoint: Option<PathBuf>,
    /// How often, such as 30s or 5m [default: 10s].
    #[arg(long, value_name = "TIME", requires = "checkpoint")]
    pub every: Option<Span>,
    /// Go on with the tiles in the checkpoint; where there is none yet, begin.
    #[arg(long, requires = "checkpoint")]
    pub resume: bool,
    /// Stop tracing after this time, write the picture as far as it is, and end with exit code 4.
    #[arg(long, value_name = "TIME")]
    pub time_limit: Option<Span>,
    /// Write the picture so far this often: always a whole file.
    #[arg(long, value_name = "TIME")]
    pub partial_every: Option<Span>,
    /// The order of the tiles. The picture does not depend on it.
    #[arg(long, value_enum, value_name = "NAME", default_value_t)]
    pub order: OrderName,
    /// How progress is shown on standard error; docs/progress.md describes the lines of json.
    #[arg(long, value_enum, value_name = "HOW", default_value_t)]
    pub progress: ProgressName,
}

/// Orders of tiles.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default, ValueEnum)]
pub enum OrderName {
    /// Along a curve that keeps neighbours together
    #[default]
    Morton,
    /// Two coarse looks at everything first, for somebody who watches
    CoarseToFine,
}

/// Ways to show progress.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default, ValueEnum)]
pub enum ProgressName {
    /// A bar on a terminal, nothing elsewhere
    #[default]
    Auto,
    /// Nothing
    None,
    /// One JSON object a line, for programs
    Json,
}

/// A length of time.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Span(pub Duration);

impl FromStr for Span {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        const UNITS: [(&str, f64); 4] = [("ms", 1e-3), ("s", 1.0), ("m", 60.0), ("h", 3600.0)];
        let text = text.trim();
        let unit = UNITS.into_iter().find_map(|(unit, seconds)| Some((text.strip_suffix(unit)?, seconds)));
        let (digits, unit) = unit.unwrap_or((text, 1.0));
        let seconds = digits.trim().parse::<f64>().ok().map(|number| number * unit);
        // A hundred years are enough for everybody, and can be added to any time.
        seconds
            .filter(|seconds| (1e-3..3.2e9).contains(seconds))
            .map(|seconds| Self(Duration::from_secs_f64(seconds)))
            .ok_or_else(|| "expected a time such as 500ms, 90, 90s, 10m or 2h".to_owned())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn times_are_read() {
        let read = |text: &str| text.parse::<Span>().map(|span| span.0.as_secs_f64());
        for (text, seconds) in [("90", 90.0), ("1.5m", 90.0), ("2 h", 7200.0), ("500ms", 0.5), ("3s", 3.0)] {
            assert_eq!(read(text), Ok(seconds));
        }
        for wrong in ["", "s", "-1", "0", "nan", "inf", "1e99h", "1d", "1m30s"] {
            assert!(read(wrong).is_err(), "{wrong}");
        }
    }
}
