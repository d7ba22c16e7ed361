//! What the figures were taken on.

use crate::child::output;
use crate::place::Place;
use serde::Deserialize;
use serde::Serialize;
use std::fs::read_to_string;
use std::process::Command;

/// Machine, date and versions.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Machine {
    /// The processor's name.
    pub cpu: String,
    /// Its widest vector instructions.
    pub simd: String,
    /// Threads it runs at once.
    pub threads: usize,
    /// Its memory.
    pub memory_gib: f64,
    /// The system.
    pub system: String,
    /// The day, UTC.
    pub date: String,
    /// What of this project was measured.
    pub dotray: String,
    /// The compiler.
    pub rustc: String,
    /// The peers, or why they are not there.
    pub peers: Vec<(String, String)>,
}

/// The first line of what a command prints.
pub fn first_line(program: &str, arguments: &[&str]) -> Option<String> {
    let text = output(Command::new(program).args(arguments)).ok()?;
    text.lines().next().map(|line| line.trim().to_owned())
}

/// What stands behind the colon of the first line that starts with `key`.
fn field<'a>(text: &'a str, key: &str) -> Option<&'a str> {
    let line = text.lines().find(|line| line.starts_with(key))?;
    line.split_once(':').map(|(_, value)| value.trim())
}

/// The compiler's version.
pub fn rustc() -> String {
    first_line("rustc", &["--version"]).unwrap_or_else(|| "unknown".to_owned())
}

impl Machine {
    /// Asks the system.
    pub fn look(place: &Place, peers: Vec<(String, String)>) -> Self {
        let cpuinfo = read_to_string("/proc/cpuinfo").unwrap_or_default();
        let flags = field(&cpuinfo, "flags").unwrap_or_default();
        let widest =
            ["avx512f", "avx2", "sse4_2"].into_iter().find(|flag| flags.split(' ').any(|f| f == *flag));
        let memory = read_to_string("/proc/meminfo").unwrap_or_default();
        let kib = field(&memory, "MemTotal").and_then(|value| value.split(' ').next()?.parse::<f64>().ok());
        let system = read_to_string("/etc/os-release").unwrap_or_default();
        let name = system.lines().find_map(|line| line.strip_prefix("PRETTY_NAME="));
        let unknown = || "unknown".to_owned();
        let git = |arguments: &[&str]| {
            output(Command::new("git").args(arguments).current_dir(&place.root)).unwrap_or_default()
        };
        let changed = if git(&["status", "--porcelain"]).trim().is_empty() { "" } else { " with changes" };
        Self {
            cpu: field(&cpuinfo, "model name").map_or_else(unknown, str::to_owned),
            simd: widest.unwrap_or(std::env::consts::ARCH).to_owned(),
            threads: std::thread::available_parallelism().map_or(1, usize::from),
            memory_gib: (kib.unwrap_or_default() / (1024.0 * 1024.0)).round(),
            system: name
                .map_or_else(|| std::env::consts::OS.to_owned(), |name| name.trim_matches('"').to_owned()),
            date: first_line("date", &["-u", "+%Y-%m-%d"]).unwrap_or_else(unknown),
            dotray: format!("{}{changed}", git(&["rev-parse", "--short", "HEAD"]).trim()),
            rustc: rustc(),
            peers,
        }
    }

    /// One sentence for the table.
    pub fn sentence(&self) -> String {
        format!(
            "Measured on {} on {} ({}, {} threads, {} GiB), {}, {}, dotray {}.",
            self.date,
            self.cpu,
            self.simd,
            self.threads,
            self.memory_gib,
            self.system,
            self.rustc,
            self.dotray
        )
    }
}
