//! The window on a desktop.

use clap::Parser;
use eframe::egui;
use rayview::app::App;
use rayview::app::Start;
use std::path::PathBuf;
use std::process::ExitCode;

#[global_allocator]
static ALLOCATOR: dotray_memory::HugePages = dotray_memory::HugePages;

/// Shows a scene in a window: rasterised at once, then traced.
#[derive(Debug, Parser)]
#[command(name = "rayview", version, about)]
struct Args {
    /// The scene, a .ray file.
    scene: Option<PathBuf>,
    /// Trace at once.
    #[arg(long)]
    traced: bool,
    /// Trace whenever the camera has come to rest.
    #[arg(long)]
    trace_at_rest: bool,
    /// Open no window: serve a page on 127.0.0.1 that shows the same, for machines without a display.
    #[arg(long)]
    serve: bool,
    /// The port of the page; 0 for one that is free.
    #[arg(long, value_name = "PORT", default_value_t = 0, requires = "serve")]
    port: u16,
    /// The window's size in points.
    #[arg(long, value_name = "WIDTHxHEIGHT", default_value = "1280x800", value_parser = window_size)]
    window: [f32; 2],
}

fn window_size(text: &str) -> Result<[f32; 2], String> {
    let parts =
        text.split_once('x').and_then(|(w, h)| Some([w.parse::<u16>().ok()?, h.parse::<u16>().ok()?]));
    let fine = parts.filter(|parts| parts.iter().all(|edge| *edge >= 100));
    fine.map(|parts| parts.map(f32::from))
        .ok_or_else(|| "expected such as 1280x800, at least 100x100".to_owned())
}

#[cfg(feature = "page")]
fn serve(scene: Option<PathBuf>, port: u16) -> Result<(), String> {
    rayview::serve::run(scene, port)
}

#[cfg(not(feature = "page"))]
fn serve(_: Option<PathBuf>, _: u16) -> Result<(), String> {
    Err("this rayview was built without its page, and serves none; in a checkout of dotray, \
         `cargo xtask web` builds the page, and `cargo install --path crates/viewer --features page` a rayview with it"
        .to_owned())
}

/// Threads that trace step back behind the one that draws and hears of hands, and behind a driver in software.
fn step_back() {
    // Where there are pools already, or no priorities, all take turns.
    let _ = rayon::ThreadPoolBuilder::new().start_handler(|_| have_patience()).build_global();
}

#[cfg(target_os = "linux")]
fn have_patience() {
    // There a priority is the thread's own.
    let _ = rustix::process::nice(10);
}

#[cfg(not(target_os = "linux"))]
fn have_patience() {}

/// Opens it.
pub fn main() -> ExitCode {
    let args = Args::parse();
    step_back();
    if args.serve {
        return match serve(args.scene, args.port) {
            Ok(()) => ExitCode::SUCCESS,
            Err(sentence) => {
                eprintln!("rayview: {sentence}");
                ExitCode::FAILURE
            }
        };
    }
    let title =
        args.scene.as_ref().map_or("rayview".to_owned(), |path| format!("{} – rayview", path.display()));
    let options = eframe::NativeOptions {
        // What is traced stands on the screen as it is.
        dithering: false,
        viewport: egui::ViewportBuilder::default().with_inner_size(args.window).with_title(&title),
        ..Default::default()
    };
    let start = Start { scene: args.scene, traced: args.traced, trace_at_rest: args.trace_at_rest };
    let create: eframe::AppCreator<'_> = Box::new(move |creation| Ok(Box::new(App::new(creation, &start))));
    match eframe::run_native("rayview", options, create) {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("rayview: cannot open a window: {error}");
            eprintln!(
                "rayview: without a display, `rayview --serve` shows the same in a browser, and `Xvfb` gives one; \
                 without a GPU, Mesa's software drivers do"
            );
            ExitCode::FAILURE
        }
    }
}
