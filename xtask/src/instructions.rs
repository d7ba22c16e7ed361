//! `--check`: the instructions that fixed small pictures take, against those of the committed file. They are steadier
//! than seconds where several share a machine.

use crate::child::exists;
use crate::child::output;
use crate::machine::first_line;
use crate::machine::rustc;
use crate::place::Place;
use crate::scenes;
use crate::write;
use crate::write::Kind;
use serde::Deserialize;
use serde::Serialize;
use std::collections::BTreeMap;
use std::path::PathBuf;
use std::process::Command;

/// The pictures: name, scene, size. The last one is all reading and building.
const PICTURES: [(&str, &str, &str); 6] = [
    ("spheres", "rnd3", "256x192"),
    ("mirrors", "mirrors3", "256x192"),
    ("mesh", "knotc", "256x192"),
    ("cylinders", "cyl3", "256x192"),
    ("boxes", "box3", "256x192"),
    ("reading and building", "rnd4", "16x12"),
];

/// The committed counts and what they were taken with.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
struct Counts {
    rustc: String,
    valgrind: String,
    instructions: BTreeMap<String, u64>,
}

/// What to do with the counts.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Action {
    /// Compare them with the committed ones.
    Compare,
    /// Commit them.
    Update,
}

fn file(place: &Place) -> PathBuf {
    place.root.join("xtask/instructions.json")
}

/// Counts the instructions of one picture. Callgrind offers no AVX-512, so that machines with and without it count
/// alike.
fn count(place: &Place, scene: &str, size: &str) -> Result<u64, String> {
    let text = place.file("check", &format!("{scene}.ray"));
    let made = scenes::make(scene).ok_or_else(|| format!("there is no scene `{scene}`"))?;
    write::write(&made, Kind::Ray, &text)?;
    let log = place.file("check", &format!("{scene}.callgrind.txt"));
    let mut command = Command::new("valgrind");
    command
        .args(["--tool=callgrind", "--callgrind-out-file=/dev/null"])
        .arg(format!("--log-file={}", log.display()))
        .args([place.program("dotray"), "render".to_owned()])
        .arg(&text)
        .arg(text.with_extension("png"))
        .args(["--size", size, "--threads", "1", "--recursion", "4", "--cutoff", "0"]);
    output(&mut command)?;
    let told = std::fs::read_to_string(&log).map_err(|fault| format!("{}: {fault}", log.display()))?;
    collected(&told).ok_or_else(|| format!("{}: no count in it", log.display()))
}

/// The count in what Callgrind tells.
fn collected(log: &str) -> Option<u64> {
    log.lines().find_map(|line| line.split_once("Collected :")?.1.trim().parse().ok())
}

/// Whether a count has grown by more than 5 %.
fn grown_too_much(before: u64, now: u64) -> bool {
    u128::from(now) * 100 > u128::from(before) * 105
}

/// Lines of old and new counts, and whether none has grown too much.
fn compared(old: &Counts, new: &Counts) -> (String, bool) {
    let mut text = format!("{:22} {:>14} {:>14} {:>8}\n", "picture", "committed", "now", "change");
    let mut good = true;
    for (name, &now) in &new.instructions {
        let Some(&before) = old.instructions.get(name) else {
            text += &format!("{name:22} {:>14} {now:>14} {:>8}  not committed yet\n", "–", "–");
            good = false;
            continue;
        };
        let change = now as f64 / before as f64 - 1.0;
        let too_much = grown_too_much(before, now);
        let verdict = if too_much { "  too much" } else { "" };
        good &= !too_much;
        text += &format!("{name:22} {before:>14} {now:>14} {:>+7.2} %{verdict}\n", 100.0 * change);
    }
    (text, good)
}

/// Counts, and compares or commits.
///
/// # Errors
/// Where a count has grown by more than 5 %, or cannot be taken.
pub fn check(place: &Place, action: Action) -> Result<(), String> {
    if !exists("valgrind") {
        println!("skipped: no valgrind here");
        return Ok(());
    }
    let committed: Counts = std::fs::read(file(place))
        .ok()
        .and_then(|bytes| serde_json::from_slice(&bytes).ok())
        .unwrap_or_default();
    let (rustc, valgrind) = (rustc(), first_line("valgrind", &["--version"]).unwrap_or_default());
    if action == Action::Compare && (&committed.rustc, &committed.valgrind) != (&rustc, &valgrind) {
        println!(
            "skipped: the committed counts are of {}, {}; here are {rustc}, {valgrind} (see --update)",
            committed.rustc, committed.valgrind
        );
        return Ok(());
    }
    let mut now = Counts { rustc, valgrind, instructions: BTreeMap::new() };
    for (name, scene, size) in PICTURES {
        eprintln!("counting {name}");
        now.instructions.insert(name.to_owned(), count(place, scene, size)?);
    }
    let (text, good) = compared(&committed, &now);
    print!("{text}");
    if action == Action::Update {
        let json = serde_json::to_string_pretty(&now).map_err(|fault| fault.to_string())?;
        let path = file(place);
        return std::fs::write(&path, json + "\n").map_err(|fault| format!("{}: {fault}", path.display()));
    }
    if good { Ok(()) } else { Err("more instructions than committed; see the table above".to_owned()) }
}

#[cfg(test)]
mod tests {
    use super::Counts;
    use super::collected;
    use super::compared;

    fn counts(list: &[(&str, u64)]) -> Counts {
        let instructions = list.iter().map(|(name, count)| ((*name).to_owned(), *count)).collect();
        Counts { instructions, ..Counts::default() }
    }

    #[test]
    fn five_percent_more_is_too_much() {
        let old = counts(&[("mesh", 1000), ("spheres", 1000)]);
        assert!(compared(&old, &counts(&[("mesh", 1050), ("spheres", 500)])).1);
        let (text, good) = compared(&old, &counts(&[("mesh", 1051), ("spheres", 1000)]));
        assert!(!good && text.matches("too much").count() == 1, "{text}");
        assert!(!compared(&old, &counts(&[("boxes", 1)])).1);
    }

    #[test]
    fn the_count_is_found() {
        assert_eq!(collected("==7== Events    : Ir\n==7== Collected : 123456\n==7==\n"), Some(123_456));
        assert_eq!(collected("nothing"), None);
    }
}
