//! `cargo xtask web`: the page, which is rayview as WebAssembly with the JavaScript that starts it.

use clap::Args;
use flate2::Compression;
use flate2::write::GzEncoder;
use std::io::Write;
use std::path::Path;
use std::path::PathBuf;
use std::process::Command;
use wasm_bindgen_cli_support::Bindgen;

const TARGET: &str = "wasm32-unknown-unknown";

/// What stands beside the program on the page as it is.
const AS_IT_IS: [&str; 5] = ["index.html", "page.css", "page.js", "crew.js", "tracer.js"];

/// Where the Python package has the viewer for notebooks, and what of the page it needs.
const NOTEBOOK: &str = "crates/python/python/dotray/web";
const IN_A_NOTEBOOK: [&str; 4] = ["rayview.js", "rayview_bg.wasm.gz", "crew.js", "tracer.js"];

/// What `cargo xtask web` takes.
#[derive(Debug, Args)]
pub struct WebArgs {
    /// The folder for the page; rayview takes it from the usual one when it is built with the feature `page`.
    #[arg(long, default_value = "crates/viewer/web/dist")]
    out: PathBuf,
    /// The profile to build in.
    #[arg(long, default_value = "web")]
    profile: String,
}

/// Builds the page.
///
/// # Errors
/// What failed, in a sentence.
pub fn run(arguments: &WebArgs) -> Result<(), String> {
    have_target()?;
    let target = std::env::var_os("CARGO_TARGET_DIR").map_or_else(|| PathBuf::from("target"), PathBuf::from);
    let status = Command::new(cargo())
        .args(["build", "--locked", "--package", "rayview", "--bin", "rayview", "--features", "screen"])
        .args(["--target", TARGET, "--profile", &arguments.profile])
        // Every browser of the last years has it.
        .env("CARGO_TARGET_WASM32_UNKNOWN_UNKNOWN_RUSTFLAGS", "-C target-feature=+simd128")
        .status()
        .map_err(|fault| format!("cannot run cargo: {fault}"))?;
    if !status.success() {
        return Err("the build of the page failed".to_owned());
    }
    let wasm = target.join(TARGET).join(&arguments.profile).join("rayview.wasm");
    bind(&wasm, &arguments.out)?;
    for name in AS_IT_IS {
        let from = Path::new("crates/viewer/web").join(name);
        std::fs::copy(&from, arguments.out.join(name))
            .map_err(|fault| format!("cannot copy `{}`: {fault}", from.display()))?;
    }
    let (whole, packed) = pack(&arguments.out.join("rayview_bg.wasm"))?;
    for name in IN_A_NOTEBOOK {
        let from = arguments.out.join(name);
        std::fs::copy(&from, Path::new(NOTEBOOK).join(name))
            .map_err(|fault| format!("cannot copy `{}`: {fault}", from.display()))?;
    }
    println!("the page is in {}: {whole} bytes of program, {packed} packed", arguments.out.display());
    Ok(())
}

/// The cargo that runs this.
fn cargo() -> std::ffi::OsString {
    std::env::var_os("CARGO").unwrap_or_else(|| "cargo".into())
}

/// Has rustup install the target where it is missing.
fn have_target() -> Result<(), String> {
    let found = Command::new("rustc").args(["--print", "target-libdir", "--target", TARGET]).output();
    let folder = found.map_err(|fault| format!("cannot run rustc: {fault}"))?.stdout;
    if Path::new(String::from_utf8_lossy(&folder).trim()).is_dir() {
        return Ok(());
    }
    println!("rustup target add {TARGET}");
    let added = Command::new("rustup").args(["target", "add", TARGET]).status();
    match added {
        Ok(status) if status.success() => Ok(()),
        _ => Err(format!(
            "Rust's standard library for {TARGET} is missing, and `rustup target add {TARGET}` has failed; \
             install it as your system does it"
        )),
    }
}

/// Writes the JavaScript between the page and the program.
fn bind(wasm: &Path, out: &Path) -> Result<(), String> {
    let fault = |fault: anyhow::Error| format!("cannot write the page's JavaScript: {fault:#}");
    let mut bindgen = Bindgen::new();
    bindgen.input_path(wasm).out_name("rayview").typescript(false).remove_name_section(true);
    bindgen.remove_producers_section(true).web(true).map_err(fault)?;
    bindgen.generate(out).map_err(fault)
}

/// Packs the program as browsers unpack it; answers both sizes.
fn pack(wasm: &Path) -> Result<(usize, usize), String> {
    let fault = |fault: std::io::Error| format!("cannot pack `{}`: {fault}", wasm.display());
    let whole = std::fs::read(wasm).map_err(fault)?;
    let mut encoder = GzEncoder::new(Vec::new(), Compression::best());
    encoder.write_all(&whole).map_err(fault)?;
    let packed = encoder.finish().map_err(fault)?;
    std::fs::write(wasm.with_extension("wasm.gz"), &packed).map_err(fault)?;
    Ok((whole.len(), packed.len()))
}
