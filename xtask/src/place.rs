//! Where things are: the repository, the bench's folder, the programs built beside this one.

use crate::child;
use std::path::Path;
use std::path::PathBuf;
use std::process::Command;

/// The folders and programs of a bench.
#[derive(Clone, Debug)]
pub struct Place {
    /// The repository.
    pub root: PathBuf,
    /// `target/bench`: scenes, pictures, logs, peers, results.
    pub bench: PathBuf,
    programs: PathBuf,
}

impl Place {
    /// Finds the folders and makes those of the bench.
    ///
    /// # Errors
    /// Tells which folder cannot be made.
    pub fn find() -> Result<Self, String> {
        let this = std::env::current_exe().map_err(|fault| fault.to_string())?;
        // target/release/xtask
        let programs = this.parent().map(Path::to_owned).unwrap_or_default();
        let bench = programs.parent().map(|target| target.join("bench")).unwrap_or_default();
        let root = Path::new(env!("CARGO_MANIFEST_DIR")).parent().map(Path::to_owned).unwrap_or_default();
        for folder in ["scenes", "pictures", "rays", "check", "logs"] {
            let folder = bench.join(folder);
            std::fs::create_dir_all(&folder).map_err(|fault| format!("{}: {fault}", folder.display()))?;
        }
        Ok(Self { root, bench, programs })
    }

    /// A program that is built with this one.
    pub fn program(&self, name: &str) -> String {
        self.programs.join(format!("{name}{}", std::env::consts::EXE_SUFFIX)).to_string_lossy().into_owned()
    }

    /// A file of the bench's folder.
    pub fn file(&self, folder: &str, name: &str) -> PathBuf {
        self.bench.join(folder).join(name)
    }

    /// What a peer brings along: a source or a script of ours.
    pub fn peer_source(&self, name: &str) -> PathBuf {
        self.root.join("xtask/peers").join(name)
    }

    /// The yardsticks that only some machines have.
    pub fn shared(&self) -> Option<PathBuf> {
        let folder = self.root.parent()?.join("shared/bench");
        folder.join("make_scenes.py").is_file().then_some(folder)
    }

    /// The Python of an environment of ours, where it was made.
    pub fn python(&self, environment: &str) -> Option<PathBuf> {
        let python = self.bench.join(environment).join("bin/python");
        python.is_file().then_some(python)
    }

    /// Builds `dotray` and the bench's own programs.
    ///
    /// # Errors
    /// The compiler's last word.
    pub fn build_programs(&self) -> Result<(), String> {
        // One by one: built together, packages share features of what they use, and this very program would be linked
        // anew while it runs.
        ["xtask", "dotray"].into_iter().try_for_each(|package| {
            let cargo = std::env::var_os("CARGO").unwrap_or_else(|| "cargo".into());
            let mut command = Command::new(cargo);
            command.args(["build", "--release", "--package", package, "--bins"]);
            // The folder above the programs is where this program itself was built.
            if let Some(target) = self.programs.parent() {
                command.env("CARGO_TARGET_DIR", target);
            }
            child::output(command.current_dir(&self.root)).map(|_| ())
        })
    }
}
