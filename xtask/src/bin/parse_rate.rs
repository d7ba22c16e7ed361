//! The rate at which scenes are read: see `cargo xtask bench`.

use std::process::ExitCode;

fn main() -> ExitCode {
    xtask::ended(xtask::rates::parse_rate(&xtask::arguments()))
}
