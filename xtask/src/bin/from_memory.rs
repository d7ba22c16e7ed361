//! Spheres in memory to a picture: see `cargo xtask bench`.

use std::process::ExitCode;

#[global_allocator]
static ALLOCATOR: dotray_memory::HugePages = dotray_memory::HugePages;

fn main() -> ExitCode {
    xtask::ended(xtask::from_memory::from_memory(&xtask::arguments()))
}
