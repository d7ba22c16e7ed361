//! Rates of rays, and the files of rays: see `cargo xtask bench`.

use std::process::ExitCode;

fn main() -> ExitCode {
    xtask::ended(xtask::rates::ray_rates(&xtask::arguments()))
}
