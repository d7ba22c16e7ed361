//! The application on a page.

use crate::app::App;
use crate::app::Start;
use crate::host::Page;
use crate::worker;
use wasm_bindgen::closure::Closure;

/// Runs what the JavaScript around the program asks for by its global `rayview`: with `canvas`, the element to draw in,
/// the application; `say` is then a function that is told what goes on until there is something to see, and `tracer`,
/// where there is one, what traces; `files` are pairs of a name and bytes to show at once, `small` says that there is
/// little room, and `stop` ends the application once it has begun. Without a canvas the program is itself the tracer of
/// a page.
pub fn run() {
    match Page::find() {
        Ok(page) => wasm_bindgen_futures::spawn_local(show(page)),
        Err(_) => worker::run(),
    }
}

async fn show(page: Page) {
    let options = eframe::WebOptions { dithering: false, ..eframe::WebOptions::default() };
    let create: eframe::AppCreator<'static> =
        Box::new(|creation| Ok(Box::new(App::new(creation, &Start::default()))));
    let runner = eframe::WebRunner::new();
    match runner.start(page.canvas.clone(), options, create).await {
        Ok(()) => {
            let stop = Closure::once_into_js(move || runner.destroy());
            // Where the page cannot be told how to end it, it ends with the page.
            let _ = js_sys::Reflect::set(&page.given, &"stop".into(), &stop);
            page.say("");
        }
        Err(fault) => page.say(&format!("neither WebGPU nor WebGL2 can be had in this browser: {fault:?}")),
    }
}
