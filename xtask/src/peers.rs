//! The programs that dotray is measured beside: which are there, and how to get them.

use crate::child;
use crate::child::output;
use crate::place::Place;
use std::path::PathBuf;
use std::process::Command;

/// Debian's names of what `apt-get` provides.
const PACKAGES: [&str; 6] =
    ["povray", "povray-includes", "tachyon-bin-nox", "libtachyon-mt-0", "libembree-dev", "libtbb-dev"];
/// A Vulkan without a graphics card, which OVITO asks for.
const VULKAN: [&str; 2] = ["libvulkan1", "mesa-vulkan-drivers"];
const EMBREE_WHEEL: &str = "embreex==4.4.0.post1";
const OVITO_WHEEL: &str = "ovito==3.17.2";
const BLENDER_WHEEL: &str = "bpy==5.2.3";

/// What is there of the peers; where something is not, why.
#[derive(Clone, Debug)]
pub struct Peers {
    /// Tachyon's version.
    pub tachyon: Result<String, String>,
    /// POV-Ray's version.
    pub povray: Result<String, String>,
    /// The program that traces with Embree.
    pub embree: Result<String, String>,
    /// A Python with OVITO.
    pub ovito: Result<PathBuf, String>,
    /// A Python with Blender's Cycles.
    pub cycles: Result<PathBuf, String>,
}

/// Installs all peers that can be had, each on its own, and says which cannot.
pub fn install(place: &Place) {
    let told = |what: &str, result: Result<String, String>| match result {
        Ok(_) => eprintln!("{what}: installed"),
        Err(why) => eprintln!("{what}: not available: {why}"),
    };
    told("Tachyon, POV-Ray, Embree 3", apt(&PACKAGES));
    told("Embree 4", pip(place, "python3", "venv", EMBREE_WHEEL));
    told("Vulkan for OVITO", apt(&VULKAN));
    told("OVITO", pip(place, "python3", "venv", OVITO_WHEEL));
    let cycles = python_for_blender()
        .ok_or_else(|| "needs Python 3.13 (or PYTHON313, its path)".to_owned())
        .and_then(|python| pip(place, &python, "venv-bpy", BLENDER_WHEEL));
    told("Cycles", cycles);
}

/// A Python of the one version that Blender's wheel is for: the one that is named, the path's, or pyenv's.
fn python_for_blender() -> Option<String> {
    let named = std::env::var("PYTHON313").ok();
    let versions = std::env::home_dir().map(|home| home.join(".pyenv/versions"));
    let versions = versions.and_then(|folder| std::fs::read_dir(folder).ok()).into_iter().flatten().flatten();
    let own = versions.map(|version| version.path().join("bin/python3.13").to_string_lossy().into_owned());
    let mut all = named.into_iter().chain(["python3.13".to_owned()]).chain(own);
    all.find(|python| output(Command::new(python).arg("--version")).is_ok())
}

/// Installs packages of the system.
fn apt(packages: &[&str]) -> Result<String, String> {
    if !child::exists("apt-get") {
        return Err("no apt-get here".to_owned());
    }
    output(Command::new("apt-get").args(["install", "--yes"]).args(packages))
}

/// Installs a wheel into an environment of ours, which is made first where need be.
fn pip(place: &Place, python: &str, environment: &str, wheel: &str) -> Result<String, String> {
    if place.python(environment).is_none() {
        output(Command::new(python).args(["-m", "venv"]).arg(place.bench.join(environment)))?;
    }
    let python = place.python(environment).ok_or("the environment has no bin/python")?;
    output(Command::new(python).args(["-m", "pip", "install", "--quiet", wheel]))
}

impl Peers {
    /// Looks for what is there; compiles the Embree program where its library is.
    pub fn find(place: &Place) -> Self {
        let has = |program: &str, package: &str| {
            if !child::exists(program) {
                return Err(format!("no `{program}` here; try --peers"));
            }
            let version =
                output(Command::new("dpkg-query").args(["--show", "--showformat=${Version}", package]));
            Ok(version.unwrap_or_else(|_| "of unknown version".to_owned()))
        };
        let python = |environment: &str, module: &str| {
            let python = place.python(environment).ok_or("not installed; try --peers")?;
            let look = format!("import importlib.util as u, sys; sys.exit(u.find_spec('{module}') is None)");
            output(Command::new(&python).args(["-c", &look]))
                .map(|_| python)
                .map_err(|_| "not installed; try --peers".to_owned())
        };
        Self {
            tachyon: has("tachyon", "tachyon-bin-nox"),
            povray: has("povray", "povray"),
            embree: compile_embree(place),
            ovito: python("venv", "ovito"),
            cycles: python("venv-bpy", "bpy"),
        }
    }

    /// Names and versions, or why they are missing, for the table.
    pub fn told(&self) -> Vec<(String, String)> {
        let installed = |_: &PathBuf| "installed".to_owned();
        let all = [
            ("Tachyon", self.tachyon.clone()),
            ("POV-Ray", self.povray.clone()),
            ("Embree", self.embree.clone().map(|_| "see its rows".to_owned())),
            ("OVITO", self.ovito.as_ref().map(installed).map_err(String::clone)),
            ("Cycles", self.cycles.as_ref().map(installed).map_err(String::clone)),
        ];
        all.map(|(name, found)| {
            (name.to_owned(), found.unwrap_or_else(|why| format!("not available: {why}")))
        })
        .to_vec()
    }
}

/// The wheel's own library of Embree 4.
fn embree_library(place: &Place) -> Option<PathBuf> {
    let versions = std::fs::read_dir(place.bench.join("venv/lib")).ok()?;
    let mut libraries: Vec<_> = versions
        .flatten()
        .filter_map(|version| std::fs::read_dir(version.path().join("site-packages/embreex.libs")).ok())
        .flat_map(|folder| folder.flatten().map(|file| file.path()))
        .filter(|path| path.file_name().is_some_and(|name| name.to_string_lossy().starts_with("libembree4")))
        .collect();
    libraries.sort();
    libraries.pop()
}

/// Compiles a C++ source of ours; the program's path.
///
/// # Errors
/// The compiler's last word, or that there is none.
pub fn compile(place: &Place, source: &str, more: &[String]) -> Result<String, String> {
    if !child::exists("g++") {
        return Err("no g++ here".to_owned());
    }
    let program = place.bench.join(source.trim_end_matches(".cpp"));
    let mut command = Command::new("g++");
    command.args(["-std=c++17", "-O3", "-march=native"]).arg(place.peer_source(source)).args(more);
    output(command.arg("-o").arg(&program))?;
    Ok(program.to_string_lossy().into_owned())
}

fn compile_embree(place: &Place) -> Result<String, String> {
    let Some(library) = embree_library(place) else {
        return compile(place, "bench_embree.cpp", &["-DEMBREE3".to_owned(), "-lembree3".to_owned()])
            .map_err(|why| {
                format!("neither the wheel's Embree 4 nor Debian's Embree 3 ({why}); try --peers")
            });
    };
    let folder = library.parent().map(|folder| folder.display().to_string()).unwrap_or_default();
    let library = library.display().to_string();
    let unresolved = "-Wl,--allow-shlib-undefined".to_owned();
    compile(place, "bench_embree.cpp", &[library, format!("-Wl,-rpath,{folder}"), unresolved])
}
