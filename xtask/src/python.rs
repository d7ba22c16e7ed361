//! Arrays of numpy to a picture's file: dotray's Python package beside OVITO, both of its engines, and Tachyon.

use crate::child::measure;
use crate::child::output;
use crate::figures::median;
use crate::peers::Peers;
use crate::picture::mean_difference;
use crate::place::Place;
use crate::results::ImageRow;
use serde::Deserialize;
use std::path::PathBuf;
use std::process::Command;

/// No program may take longer, seconds.
const LIMIT: f64 = 900.0;

/// What `spheres.py` prints of a program: from arrays in memory to the picture's file, the peak with the arrays.
#[derive(Clone, Debug, PartialEq, Deserialize)]
struct Told {
    cpu_s: f64,
    wall_s: f64,
    #[serde(rename = "peak_MB")]
    peak_mb: f64,
}

/// What a program has printed, whatever its libraries have said before.
fn told(printed: &str) -> Option<Told> {
    printed.lines().rev().find_map(|line| serde_json::from_str(line).ok())
}

/// A program by its name, by its word for `spheres.py`, and what came of its runs.
struct Course {
    name: &'static str,
    word: &'static str,
    runs: Vec<Told>,
    missing: Option<String>,
}

impl Course {
    fn picture(&self, place: &Place) -> PathBuf {
        let extension = if self.word == "tachyon" { "bmp" } else { "png" };
        place.file("pictures", &format!("spheres-{}.{extension}", self.word))
    }

    fn run(&mut self, place: &Place, count: u32) {
        if self.missing.is_some() {
            return;
        }
        let once = || {
            let python = place.python("venv").ok_or("no environment for Python; try --peers")?;
            let script = place.root.join("crates/python/bench/spheres.py");
            let pictures = place.bench.join("pictures");
            let command = [
                "env".to_owned(),
                format!("OUT={}", pictures.display()),
                python.display().to_string(),
                script.display().to_string(),
                self.word.to_owned(),
                count.to_string(),
                "1".to_owned(),
            ];
            let log = place.file("logs", &format!("spheres-{}.txt", self.word));
            let usage = measure(&command, &log, LIMIT)?;
            let printed = std::fs::read_to_string(&log).unwrap_or_default();
            let failed = || format!("failed, or ran for {LIMIT} s; see {}", log.display());
            told(&printed).filter(|_| usage.fine).ok_or_else(failed)
        };
        match once() {
            Ok(told) => self.runs.push(told),
            Err(why) => self.missing = Some(why),
        }
    }

    fn row(&self, place: &Place, scene: &str, ours: &Self) -> ImageRow {
        let of =
            |value: fn(&Told) -> f64| median(&self.runs.iter().map(value).collect::<Vec<_>>()).unwrap_or(0.0);
        // Tachyon's camera is left-handed.
        let apart = || mean_difference(&ours.picture(place), &self.picture(place), self.word == "tachyon");
        let is_peer = self.word != ours.word && self.missing.is_none();
        ImageRow {
            scene: scene.to_owned(),
            program: self.name.to_owned(),
            runs: self.runs.len(),
            cpu: of(|told| told.cpu_s),
            user: 0.0,
            wall: of(|told| told.wall_s),
            peak_mib: of(|told| told.peak_mb * 1e6 / f64::from(1 << 20)),
            difference: is_peer.then(|| apart().ok()).flatten(),
            missing: self.missing.clone(),
        }
    }
}

/// How many spheres `rndK` has: 10^K.
fn count_of(scene: &str) -> Option<u32> {
    10_u32.checked_pow(scene.strip_prefix("rnd")?.parse().ok()?)
}

/// Installs the package of this checkout into the environment of the peers.
fn install(place: &Place) -> Result<(), String> {
    let python = place.python("venv").ok_or("no environment for Python; try --peers")?;
    let mut command = Command::new(python);
    command.args(["-m", "pip", "install", "--quiet", "--force-reinstall", "--no-deps"]).arg(&place.root);
    output(&mut command).map(|_| ())
}

/// Runs all programs on as many spheres, in turns.
///
/// # Errors
/// Where the scene has no count.
pub fn run(place: &Place, peers: &Peers, scene: &str, rounds: usize) -> Result<Vec<ImageRow>, String> {
    let count = count_of(scene).ok_or("only rndK is made of arrays")?;
    let course = |name, word, missing: Option<String>| Course { name, word, runs: Vec::new(), missing };
    let ovito = || peers.ovito.as_ref().err().cloned();
    let mut courses = [
        course("dotray", "dotray", install(place).err()),
        course("OVITO, OSPRay", "ovito-ospray", ovito()),
        course("OVITO, Tachyon", "ovito-tachyon", ovito()),
        course("Tachyon, from text", "tachyon", peers.tachyon.as_ref().err().cloned()),
    ];
    for _ in 0..rounds {
        courses.iter_mut().for_each(|course| course.run(place, count));
    }
    let [ours, ..] = &courses;
    let rows: Vec<_> = courses.iter().map(|course| course.row(place, scene, ours)).collect();
    for row in &rows {
        let (program, cpu, wall, peak) = (&row.program, row.cpu, row.wall, row.peak_mib);
        match &row.missing {
            Some(why) => eprintln!("  {scene} {program}: not available: {why}"),
            None => eprintln!("  {scene} {program}: {cpu:.2} s CPU, {wall:.2} s, {peak:.0} MiB"),
        }
    }
    Ok(rows)
}

#[cfg(test)]
mod tests {
    use super::Told;
    use super::count_of;
    use super::told;

    #[test]
    fn counts_and_printed_lines_are_understood() {
        assert_eq!([count_of("rnd7"), count_of("rnd99"), count_of("pack6")], [Some(10_000_000), None, None]);
        let printed =
            "a warning\n{\"program\": \"dotray\", \"cpu_s\": 1.5, \"wall_s\": 2, \"peak_MB\": 3}\nbye\n";
        assert_eq!(told(printed), Some(Told { cpu_s: 1.5, wall_s: 2.0, peak_mb: 3.0 }));
        assert_eq!(told("Traceback\n"), None);
    }
}
