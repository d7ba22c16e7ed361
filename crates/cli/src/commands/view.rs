//! `dotray view`: the scene in a window or on a page, by the program rayview.

use crate::args::ViewArgs;
use crate::exit::Failure;
use std::io::ErrorKind;
use std::path::PathBuf;
use std::process::Command;

/// Starts rayview and waits for its end.
pub fn run(typed: &ViewArgs) -> Result<(), Failure> {
    let program = program();
    let mut command = Command::new(&program);
    if typed.traced {
        command.arg("--traced");
    }
    if typed.serve {
        command.arg("--serve");
    }
    if let Some(port) = typed.port {
        command.arg("--port").arg(port.to_string());
    }
    // A name that begins with a dash is a name all the same.
    match command.arg("--").arg(&typed.scene).status() {
        Ok(status) if status.success() => Ok(()),
        // It has said why.
        Ok(_) => Err(Failure::Reported),
        Err(error) if error.kind() == ErrorKind::NotFound => Err(Failure::Failed(
            "the program `rayview` is neither beside dotray nor on the PATH; it is a package of its own: \
             cargo install --path crates/viewer --features screen"
                .to_owned(),
        )),
        Err(error) => Err(Failure::Failed(format!("cannot start `{}`: {error}", program.display()))),
    }
}

/// The rayview beside this program, else whichever the PATH has.
fn program() -> PathBuf {
    let name = format!("rayview{}", std::env::consts::EXE_SUFFIX);
    let beside = std::env::current_exe().ok().map(|path| path.with_file_name(&name));
    beside.filter(|path| path.is_file()).unwrap_or_else(|| PathBuf::from(name))
}
