//! What a picture cost, for people and for programs.

use dotray::render::MemoryPart;
use dotray::render::Stats;
use serde::Serialize;
use serde::Serializer;
use std::fmt::Write;

use crate::exit::Failure;

/// The report of `--stats`. Its fields are the keys of the JSON object; docs/cli.md lists them.
#[derive(Debug, Serialize)]
pub struct Cost {
    /// The program's version.
    pub version: &'static str,
    /// Where the scene came from.
    pub scene: String,
    /// Where the picture went.
    pub picture: String,
    /// Columns stored.
    pub width: u32,
    /// Rows stored.
    pub height: u32,
    /// Which structure found the shapes.
    pub accelerator: &'static str,
    /// The instructions that kernels used.
    pub simd: &'static str,
    /// How many threads traced.
    pub threads: usize,
    /// Shapes, instances counted as often as they stand.
    pub shapes: usize,
    /// Rays by kind.
    pub rays: Rays,
    /// Tests that the structure made.
    pub tests: Tests,
    /// Bytes by part.
    #[serde(serialize_with = "as_object")]
    pub memory: Vec<(&'static str, u64)>,
    /// Seconds by stage.
    #[serde(serialize_with = "as_object")]
    pub seconds: Vec<(&'static str, f64)>,
}

/// Rays by kind.
#[derive(Debug, Serialize)]
pub struct Rays {
    eye: u64,
    shadow: u64,
    reflected: u64,
    refracted: u64,
    total: u64,
    per_second: f64,
}

/// Tests of the structure, also as a mean over the rays.
#[derive(Debug, Serialize)]
pub struct Tests {
    boxes: u64,
    shapes: u64,
    boxes_per_ray: f64,
    shapes_per_ray: f64,
}

fn as_object<S: Serializer, T: Serialize>(
    pairs: &[(&'static str, T)],
    serializer: S,
) -> Result<S::Ok, S::Error> {
    serializer.collect_map(pairs.iter().map(|(name, value)| (name, value)))
}

fn ratio(part: f64, whole: f64) -> f64 {
    if whole > 0.0 { part / whole } else { 0.0 }
}

impl Rays {
    /// The rays of a picture that took `seconds` to trace.
    pub fn new(stats: &Stats, seconds: f64) -> Self {
        Self {
            eye: stats.eye_rays,
            shadow: stats.shadow_rays,
            reflected: stats.reflected_rays,
            refracted: stats.refracted_rays,
            total: stats.rays(),
            per_second: ratio(stats.rays() as f64, seconds),
        }
    }
}

impl Tests {
    /// The tests of a picture.
    pub fn new(stats: &Stats) -> Self {
        let rays = stats.rays() as f64;
        Self {
            boxes: stats.box_tests,
            shapes: stats.shape_tests,
            boxes_per_ray: ratio(stats.box_tests as f64, rays),
            shapes_per_ray: ratio(stats.shape_tests as f64, rays),
        }
    }
}

/// The bytes of the text, of each part of the world, and at the worst moment of the whole program.
pub fn memory(text_bytes: u64, parts: &[MemoryPart]) -> Vec<(&'static str, u64)> {
    let text = std::iter::once(("text", text_bytes));
    let parts = parts.iter().map(|part| (part.name, part.bytes));
    text.chain(parts).chain(peak_memory().map(|bytes| ("peak", bytes))).collect()
}

/// The most memory this process has held at a time, where the system says.
fn peak_memory() -> Option<u64> {
    let status = std::fs::read_to_string("/proc/self/status").ok()?;
    let line = status.lines().find_map(|line| line.strip_prefix("VmHWM:"))?;
    let kibibytes: u64 = line.trim().strip_suffix("kB")?.trim().parse().ok()?;
    kibibytes.checked_mul(1024)
}

impl Cost {
    /// One JSON object and a line end.
    pub fn json(&self) -> Result<String, Failure> {
        let text = serde_json::to_string_pretty(self);
        text.map(|text| text + "\n")
            .map_err(|error| Failure::Failed(format!("cannot write statistics: {error}")))
    }

    /// A table for people.
    pub fn text(&self) -> String {
        let mut text = String::new();
        // Writing to a string does not fail.
        let mut row = |name: &str, value: String| {
            let _ = writeln!(text, "{name:<24}{value:>18}");
        };
        row("picture", format!("{} x {}", self.width, self.height));
        row("shapes", self.shapes.to_string());
        row("accelerator", self.accelerator.to_owned());
        row("SIMD level", self.simd.to_owned());
        row("threads", self.threads.to_string());
        row("eye rays", self.rays.eye.to_string());
        row("shadow rays", self.rays.shadow.to_string());
        row("reflected rays", self.rays.reflected.to_string());
        row("refracted rays", self.rays.refracted.to_string());
        row("rays", self.rays.total.to_string());
        row("rays a second", format!("{:.0}", self.rays.per_second));
        row("box tests", self.tests.boxes.to_string());
        row("box tests a ray", format!("{:.2}", self.tests.boxes_per_ray));
        row("shape tests", self.tests.shapes.to_string());
        row("shape tests a ray", format!("{:.2}", self.tests.shapes_per_ray));
        for (name, bytes) in &self.memory {
            row(&format!("memory: {name}"), format!("{bytes} B"));
        }
        for (name, seconds) in &self.seconds {
            row(&format!("time: {name}"), format!("{seconds:.6} s"));
        }
        text
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn nothing_over_nothing_is_nothing() {
        let tests = Tests::new(&Stats::default());
        assert_eq!((tests.boxes_per_ray, tests.shapes_per_ray), (0.0, 0.0));
        assert_eq!(Rays::new(&Stats::default(), 0.0).per_second, 0.0);
    }

    #[cfg(target_os = "linux")]
    #[test]
    fn the_peak_is_that_of_a_living_process() {
        assert!(peak_memory().is_some_and(|bytes| bytes > 100_000));
    }
}
