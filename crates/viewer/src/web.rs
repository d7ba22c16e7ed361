//! The application on a page.

use crate::app::App;
use crate::app::Start;
use crate::host::Page;

/// Runs the application in the page that the JavaScript around it describes by its global `rayview`: `canvas`, the
/// element to draw in, and `say`, a function that is told what goes on until there is something to see.
pub fn run() {
    wasm_bindgen_futures::spawn_local(async {
        // Where there is no page to say it on, nobody waits for it.
        let Ok(page) = Page::find() else { return };
        let options = eframe::WebOptions { dithering: false, ..eframe::WebOptions::default() };
        let create: eframe::AppCreator<'static> =
            Box::new(|creation| Ok(Box::new(App::new(creation, &Start::default()))));
        match eframe::WebRunner::new().start(page.canvas.clone(), options, create).await {
            Ok(()) => page.say(""),
            Err(fault) => {
                page.say(&format!("neither WebGPU nor WebGL2 can be had in this browser: {fault:?}"))
            }
        }
    });
}
