//! Chores of the project: `cargo xtask bench` measures dotray beside its peers, `cargo xtask web` builds the page.
//!
//! The order of the `mod` lines is the floor order: a module uses only modules listed above it.

mod figures;

mod random;

mod clock;

pub mod child;

mod place;

mod machine;

mod scenes;

mod write;

mod picture;

mod rays;

mod ray_sets;

pub mod rates;

pub mod from_memory;

mod files;

mod peers;

mod plan;

mod results;

mod images;

mod kernels;

mod python;

mod report;

mod instructions;

pub mod bench;

pub mod web;

use std::process::ExitCode;

/// What was typed after the program's name.
pub fn arguments() -> Vec<String> {
    std::env::args().skip(1).collect()
}

/// The exit code, after the fault has been told.
pub fn ended(result: Result<(), String>) -> ExitCode {
    match result {
        Ok(()) => ExitCode::SUCCESS,
        Err(fault) => {
            eprintln!("{fault}");
            ExitCode::FAILURE
        }
    }
}
