//! Rates of rays, and the files of rays: see `cargo xtask bench`.

use std::process::ExitCode;

#[global_allocator]
static ALLOCATOR: dotray_memory::HugePages = dotray_memory::HugePages;

fn main() -> ExitCode {
    xtask::ended(xtask::rates::ray_rates(&xtask::arguments()))
}
