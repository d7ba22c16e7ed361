//! The files of scenes: made here where they are missing, or by the yardsticks' own program on machines that have it.

use crate::child::output;
use crate::place::Place;
use crate::rays;
use crate::scenes;
use crate::write;
use crate::write::Kind;
use std::path::Path;
use std::path::PathBuf;
use std::process::Command;

/// The default scenes of Eric Haines' Standard Procedural Databases.
pub const DATABASES: [&str; 11] = [
    "balls4",
    "gears4",
    "jacks4",
    "lattice12",
    "mount6",
    "rings7",
    "shells5",
    "sombrero1",
    "teapot6",
    "tetra6",
    "tree11",
];
/// Scanned meshes.
pub const SCANS: [&str; 2] = ["bunny0", "bunny2"];

/// Whether a scene comes from the yardsticks.
pub fn is_shared(name: &str) -> bool {
    DATABASES.contains(&name) || SCANS.contains(&name)
}

/// Where a scene's file lies; it is made first where need be.
///
/// # Errors
/// Why it cannot be had.
pub fn scene(place: &Place, name: &str, kind: Kind) -> Result<PathBuf, String> {
    let extension = kind.extension(name).ok_or_else(|| format!("no {kind:?} file can say {name}"))?;
    let path = place.file("scenes", &format!("{name}.{extension}"));
    if path.is_file() {
        return Ok(path);
    }
    if is_shared(name) {
        make_shared(place)?;
        return if path.is_file() { Ok(path) } else { Err(format!("{} was not made", path.display())) };
    }
    eprintln!("making {}", path.display());
    let scene = scenes::make(name).ok_or_else(|| format!("there is no scene `{name}`"))?;
    write::write(&scene, kind, &path)?;
    Ok(path)
}

/// The four ray files of a scene.
///
/// # Errors
/// Why they cannot be had.
pub fn rays(place: &Place, name: &str) -> Result<Vec<PathBuf>, String> {
    let files: Vec<_> =
        rays::SETS.iter().map(|set| place.file("rays", &format!("{name}.{set}.rays"))).collect();
    if !files.iter().all(|file| file.is_file()) {
        eprintln!("making the rays of {name}");
        let text = scene(place, name, Kind::Ray)?;
        let prefix = place.file("rays", name);
        output(Command::new(place.program("ray_rates")).arg("make").arg(text).arg(prefix))?;
    }
    Ok(files)
}

/// Runs the yardsticks' `make_scenes.py` for databases and scans.
fn make_shared(place: &Place) -> Result<(), String> {
    let shared = place.shared().ok_or("skipped, no ../shared")?;
    eprintln!("making the databases' and scans' scenes");
    let folder = place.file("scenes", "");
    let python = place.python("venv").unwrap_or_else(|| PathBuf::from("python3"));
    let mut command = Command::new(python);
    command.arg(shared.join("make_scenes.py")).args(["spd", "mesh"]).env("BENCH_SCENES", &folder);
    output(command.current_dir(&place.bench))?;
    DATABASES.iter().try_for_each(|name| mend_materials(&folder.join(format!("{name}.ray"))))
}

/// In SPEC 6 a highlight's exponent is 128 kSpec, so that a material with kSpec 0 and a specular colour is lit all
/// over, which the databases do not mean: such materials lose their specular colour.
fn mend_materials(path: &Path) -> Result<(), String> {
    let text = std::fs::read_to_string(path).map_err(|fault| format!("{}: {fault}", path.display()))?;
    let mended: String = text.split_inclusive('\n').map(mend_material).collect();
    std::fs::write(path, mended).map_err(|fault| format!("{}: {fault}", path.display()))
}

fn mend_material(line: &str) -> String {
    let mut words: Vec<&str> = line.split(' ').collect();
    let is_zero = |i: usize| words.get(i).is_some_and(|word| word.parse() == Ok(0.0));
    // The specular colour is arguments 7 to 9, kSpec and kTrans are 13 and 14.
    if words[0] == "#material" && is_zero(13) && is_zero(14) {
        words[7..10].fill("0");
    }
    words.join(" ")
}

#[cfg(test)]
mod tests {
    use super::mend_material;

    #[test]
    fn only_dull_materials_lose_their_highlight() {
        let line = |ks: &str, kt: &str| format!("#material 1 1 1 .5 .5 .5 1 1 1 0 0 0 {ks} {kt} 1 -1 !m0!\n");
        assert_eq!(mend_material(&line("0", "0")), line("0", "0").replace(".5 1 1 1", ".5 0 0 0"));
        assert_eq!(mend_material(&line("0.3", "0")), line("0.3", "0"));
        assert_eq!(mend_material(&line("0", "0.9")), line("0", "0.9"));
        assert_eq!(mend_material("#shape_sphere 0 0 0 0 1\n"), "#shape_sphere 0 0 0 0 1\n");
    }
}
