//! The rate at which scenes are read: see `cargo xtask bench`.

use std::process::ExitCode;

#[global_allocator]
static ALLOCATOR: dotray_memory::HugePages = dotray_memory::HugePages;

fn main() -> ExitCode {
    xtask::ended(xtask::rates::parse_rate(&xtask::arguments()))
}
