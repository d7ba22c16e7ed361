//! Spheres in memory to a picture: see `cargo xtask bench`.

use std::process::ExitCode;

fn main() -> ExitCode {
    xtask::ended(xtask::from_memory::from_memory(&xtask::arguments()))
}
