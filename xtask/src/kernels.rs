//! Rates of rays and builds: dotray beside Embree, and reading and drawing from memory beside what there is.

use crate::child::output;
use crate::figures::median;
use crate::files;
use crate::peers;
use crate::peers::Peers;
use crate::place::Place;
use crate::results::BuildRow;
use crate::results::KernelRow;
use crate::results::MemoryRow;
use crate::results::ParseRow;
use crate::results::RayRow;
use crate::write::Kind;
use std::path::Path;
use std::process::Command;

/// How often a program traces each file in one run.
const REPEATS: &str = "3";

/// What a program prints, line by line: a word and its fields.
fn lines<'a>(text: &'a str, word: &'a str) -> impl Iterator<Item = Vec<&'a str>> {
    text.lines().filter_map(move |line| {
        let mut fields = line.split(',');
        (fields.next() == Some(word)).then(|| fields.collect())
    })
}

fn number(field: Option<&&str>) -> f64 {
    field.and_then(|text| text.parse().ok()).unwrap_or_default()
}

/// The rows that one run of a program printed about a scene.
fn kernel_rows(scene: &str, text: &str) -> Vec<KernelRow> {
    let mut program = String::new();
    let mut rows = Vec::new();
    for fields in lines(text, "BUILD") {
        program = fields.first().map(|name| (*name).to_owned()).unwrap_or_default();
        rows.push(KernelRow::Build(BuildRow {
            scene: scene.to_owned(),
            program: program.clone(),
            shapes: number(fields.get(1)) as u64,
            cpu: number(fields.get(2)),
            bytes: number(fields.get(4)) as u64,
        }));
    }
    for fields in lines(text, "TRACE") {
        let word = |i: usize| fields.get(i).map(|word| (*word).to_owned()).unwrap_or_default();
        rows.push(KernelRow::Rays(RayRow {
            scene: scene.to_owned(),
            program: program.clone(),
            set: word(0),
            mode: word(1),
            rays: number(fields.get(2)) as u64,
            rate: number(fields.get(3)),
            hits: number(fields.get(4)) as u64,
            mean_t: number(fields.get(5)),
        }));
    }
    rows
}

/// The medians of rows that several rounds gave in the same order.
fn medians(rounds: &[Vec<KernelRow>]) -> Vec<KernelRow> {
    let first = rounds.first().cloned().unwrap_or_default();
    let middle = |i: usize, value: fn(&KernelRow) -> f64| {
        let values: Vec<_> = rounds.iter().filter_map(|rows| rows.get(i)).map(value).collect();
        median(&values).unwrap_or_default()
    };
    let value = |row: &KernelRow| match row {
        KernelRow::Rays(row) => row.rate,
        KernelRow::Build(row) => row.cpu,
    };
    first
        .into_iter()
        .enumerate()
        .map(|(i, row)| match row {
            KernelRow::Rays(row) => KernelRow::Rays(RayRow { rate: middle(i, value), ..row }),
            KernelRow::Build(row) => KernelRow::Build(BuildRow { cpu: middle(i, value), ..row }),
        })
        .collect()
}

/// Rates of dotray and Embree on a scene's rays, the programs in turns.
///
/// # Errors
/// Why dotray has no rates; Embree may be missing.
pub fn rays(place: &Place, peers: &Peers, scene: &str, rounds: usize) -> Result<Vec<KernelRow>, String> {
    let text = files::scene(place, scene, Kind::Ray)?;
    let rays = files::rays(place, scene)?;
    let raw = files::scene(place, scene, Kind::Raw);
    let (mut ours, mut theirs) = (Vec::new(), Vec::new());
    for _ in 0..rounds {
        let mut command = Command::new(place.program("ray_rates"));
        let printed = output(command.arg("trace").arg(&text).args([REPEATS, "1"]).args(&rays))?;
        ours.push(kernel_rows(scene, &printed));
        let (Ok(embree), Ok(raw)) = (&peers.embree, &raw) else { continue };
        match output(Command::new(embree).arg(raw).args([REPEATS, "1"]).args(&rays)) {
            Ok(printed) => theirs.push(kernel_rows(scene, &printed)),
            Err(why) => eprintln!("  {scene} Embree: not available: {why}"),
        }
    }
    let rows = [medians(&ours), medians(&theirs)].concat();
    for row in &rows {
        match row {
            KernelRow::Rays(r) => {
                eprintln!("  {scene} {} {} {}: {:.3} Mrays/s", r.program, r.set, r.mode, r.rate)
            }
            KernelRow::Build(b) => {
                eprintln!("  {scene} {}: {} shapes built in {:.3} s", b.program, b.shapes, b.cpu)
            }
        }
    }
    Ok(rows)
}

/// The medians of CPU and wall seconds of all lines that start with a word, and the field before them.
fn seconds(text: &str, word: &str) -> Option<(f64, f64)> {
    let (mut cpu, mut wall) = (Vec::new(), Vec::new());
    for fields in lines(text, word) {
        let [.., c, w] = fields[..] else { continue };
        cpu.push(c.parse().ok()?);
        wall.push(w.parse().ok()?);
    }
    Some((median(&cpu)?, median(&wall)?))
}

/// Reading a scene's text with dotray's loader, and through the barest reader.
///
/// # Errors
/// Why dotray has no rate.
pub fn parse(place: &Place, scene: &str, rounds: usize) -> Result<Vec<ParseRow>, String> {
    let text = files::scene(place, scene, Kind::Ray)?;
    let bytes = std::fs::metadata(&text).map_err(|fault| fault.to_string())?.len();
    let is_spheres = crate::scenes::raw_kind(scene) == Some("sph");
    let floor = if is_spheres { peers::compile(place, "parse_floor.cpp", &[]).ok() } else { None };
    let (mut ours, mut theirs) = (String::new(), String::new());
    for _ in 0..rounds {
        ours += &output(Command::new(place.program("parse_rate")).arg(&text).arg("1"))?;
        if let Some(floor) = &floor {
            theirs += &output(Command::new(floor).arg(&text)).unwrap_or_default();
        }
    }
    let row = |program: &str, printed: &str| {
        let (cpu, wall) = seconds(printed, "PARSE")?;
        Some(ParseRow { scene: scene.to_owned(), program: program.to_owned(), bytes, cpu, wall })
    };
    let rows: Vec<_> = [row("dotray", &ours), row("floor", &theirs)].into_iter().flatten().collect();
    rows.iter().for_each(|row| eprintln!("  {scene} {}: {:.0} MB/s", row.program, row.rate()));
    Ok(rows)
}

/// Pictures of spheres in memory: dotray, both engines of OVITO, Cycles; one thread.
///
/// # Errors
/// Why there are no spheres.
pub fn memory(place: &Place, peers: &Peers, scene: &str, rounds: usize) -> Result<Vec<MemoryRow>, String> {
    let raw = files::scene(place, scene, Kind::Raw)?;
    let camera = files::scene(place, scene, Kind::Camera)?;
    let script = |python: &Result<std::path::PathBuf, String>, name: &str, more: &[&str]| {
        python.clone().map(|python| {
            let mut command = Command::new(python);
            command.arg(place.peer_source(name)).args(more).current_dir(&place.bench);
            command
        })
    };
    let programs = [
        ("dotray", Ok(Command::new(place.program("from_memory")))),
        ("OVITO, OSPRay", script(&peers.ovito, "run_ovito.py", &["ospray"])),
        ("OVITO, Tachyon", script(&peers.ovito, "run_ovito.py", &["tachyon"])),
        ("Cycles", script(&peers.cycles, "run_cycles.py", &[])),
    ];
    let rows: Vec<_> = programs
        .into_iter()
        .map(|(program, command)| {
            let printed = command.and_then(|command| pictures(command, &raw, &camera, rounds));
            let (scene, program) = (scene.to_owned(), program.to_owned());
            match printed {
                Ok((cpu, wall)) => MemoryRow { scene, program, cpu, wall, missing: None },
                Err(why) => MemoryRow { scene, program, missing: Some(why), ..MemoryRow::default() },
            }
        })
        .collect();
    for row in &rows {
        match &row.missing {
            Some(why) => eprintln!("  {scene} {}: not available: {why}", row.program),
            None => eprintln!("  {scene} {}: {:.2} s CPU, {:.2} s", row.program, row.cpu, row.wall),
        }
    }
    Ok(rows)
}

/// The medians of a program's pictures, all from one process.
fn pictures(mut command: Command, raw: &Path, camera: &Path, rounds: usize) -> Result<(f64, f64), String> {
    let printed = output(command.arg(raw).arg(camera).arg("1").arg(rounds.to_string()))?;
    seconds(&printed, "PICTURE").ok_or_else(|| "no picture".to_owned())
}

#[cfg(test)]
mod tests {
    use super::kernel_rows;
    use super::medians;
    use super::seconds;
    use crate::results::KernelRow;

    #[test]
    fn printed_lines_become_rows_and_medians() {
        let text = |rate: &str| {
            format!("BUILD,Embree 4.4.0,1000,0.5,0.6,4096\nTRACE,shadow,single,16,{rate},7,0.25\n")
        };
        let rows = medians(&["3.0", "1.0", "2.0"].map(|rate| kernel_rows("rnd3", &text(rate))));
        let [KernelRow::Build(build), KernelRow::Rays(rays)] = &rows[..] else { panic!("{rows:?}") };
        assert_eq!((build.shapes, build.cpu, build.bytes), (1000, 0.5, 4096));
        assert_eq!((rays.program.as_str(), rays.rate, rays.hits), ("Embree 4.4.0", 2.0, 7));
        assert_eq!(seconds("PARSE,9,1.0,2.0\nPARSE,9,3.0,4.0\n", "PARSE"), Some((2.0, 3.0)));
        assert_eq!(seconds("nothing", "PARSE"), None);
    }
}
