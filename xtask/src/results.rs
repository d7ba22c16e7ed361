//! What a run finds, as `results.json` keeps it. Each part carries its own machine and date: parts may be run apart.

use crate::machine::Machine;
use serde::Deserialize;
use serde::Serialize;
use std::path::Path;

/// A part of the results with what it was taken on.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Part<Row> {
    /// Machine, date, versions.
    pub machine: Machine,
    /// How many rounds the medians are of.
    pub rounds: usize,
    /// The rows.
    pub rows: Vec<Row>,
}

/// A program on a scene: medians over its runs.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct ImageRow {
    /// The scene.
    pub scene: String,
    /// The program and how it was run.
    pub program: String,
    /// How often.
    pub runs: usize,
    /// User and system seconds of all threads.
    pub cpu: f64,
    /// User seconds alone.
    pub user: f64,
    /// Seconds on the wall.
    pub wall: f64,
    /// The most memory.
    pub peak_mib: f64,
    /// How far its picture is from dotray's: the mean difference of a channel.
    pub difference: Option<f64>,
    /// Why there are no figures.
    pub missing: Option<String>,
}

/// A program on a set of rays.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct RayRow {
    /// The scene.
    pub scene: String,
    /// The program, with its version or instructions.
    pub program: String,
    /// The set.
    pub set: String,
    /// How rays are handed over: batch, single or packet.
    pub mode: String,
    /// How many.
    pub rays: u64,
    /// Millions of rays a second of thread-CPU time.
    pub rate: f64,
    /// How many hit.
    pub hits: u64,
    /// The mean t of the hits.
    pub mean_t: f64,
}

/// A program's tree over a scene.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct BuildRow {
    /// The scene.
    pub scene: String,
    /// The program, with its version or instructions.
    pub program: String,
    /// How many shapes.
    pub shapes: u64,
    /// CPU seconds on one thread.
    pub cpu: f64,
    /// Bytes of tree and shapes.
    pub bytes: u64,
}

/// Rates of rays and builds.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(untagged)]
pub enum KernelRow {
    /// Of a set of rays.
    Rays(RayRow),
    /// Of a tree.
    Build(BuildRow),
}

/// A reader on a file.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct ParseRow {
    /// The scene.
    pub scene: String,
    /// The program.
    pub program: String,
    /// The text's length.
    pub bytes: u64,
    /// CPU seconds of all threads.
    pub cpu: f64,
    /// Seconds on the wall.
    pub wall: f64,
}

impl ParseRow {
    /// Millions of bytes a second of CPU time.
    pub fn rate(&self) -> f64 {
        self.bytes as f64 * 1e-6 / self.cpu
    }
}

/// A program that draws spheres from memory.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct MemoryRow {
    /// The scene.
    pub scene: String,
    /// The program.
    pub program: String,
    /// CPU seconds of all threads.
    pub cpu: f64,
    /// Seconds on the wall.
    pub wall: f64,
    /// Why there are no figures.
    pub missing: Option<String>,
}

/// All parts that have been run.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct Results {
    /// Whole programs.
    pub images: Option<Part<ImageRow>>,
    /// Rates of rays and builds.
    pub rays: Option<Part<KernelRow>>,
    /// Reading.
    pub parse: Option<Part<ParseRow>>,
    /// Pictures from memory.
    pub memory: Option<Part<MemoryRow>>,
    /// Pictures from arrays of numpy.
    pub python: Option<Part<ImageRow>>,
}

impl Results {
    /// The results of earlier runs; none where there is no file, or one of another form.
    pub fn load(path: &Path) -> Self {
        let bytes = std::fs::read(path).unwrap_or_default();
        serde_json::from_slice(&bytes).unwrap_or_default()
    }

    /// Stores them.
    ///
    /// # Errors
    /// What the system says.
    pub fn store(&self, path: &Path) -> Result<(), String> {
        let text = serde_json::to_string_pretty(self).map_err(|fault| fault.to_string())?;
        std::fs::write(path, text + "\n").map_err(|fault| format!("{}: {fault}", path.display()))
    }
}

#[cfg(test)]
mod tests {
    use super::BuildRow;
    use super::KernelRow;
    use super::Machine;
    use super::Part;
    use super::RayRow;
    use super::Results;

    #[test]
    fn rows_of_rays_and_builds_survive_the_file() {
        let rows = vec![
            KernelRow::Rays(RayRow { scene: "rnd3".to_owned(), rate: 2.0, ..RayRow::default() }),
            KernelRow::Build(BuildRow { scene: "rnd3".to_owned(), shapes: 7, ..BuildRow::default() }),
        ];
        let results = Results {
            rays: Some(Part { rows, machine: Machine::default(), rounds: 3 }),
            ..Results::default()
        };
        let path = std::env::temp_dir().join(format!("xtask-results-{}", std::process::id()));
        assert_eq!(results.store(&path), Ok(()));
        assert_eq!(Results::load(&path), results);
        assert!(std::fs::remove_file(&path).is_ok());
        assert_eq!(Results::load(&path), Results::default());
    }
}
