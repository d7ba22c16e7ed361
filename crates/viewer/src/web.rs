//! The application on a page.

use crate::app::App;
use crate::app::Start;
use wasm_bindgen::JsCast;

/// Runs the application in the page's canvas `view`. The page's element `message` says what is going on until then, and
/// what went wrong.
pub fn run() {
    wasm_bindgen_futures::spawn_local(async {
        let Some(document) = web_sys::window().and_then(|window| window.document()) else { return };
        let message = document.get_element_by_id("message");
        let say = |text: &str| {
            if let Some(element) = &message {
                element.set_text_content(Some(text));
            }
        };
        let canvas = document.get_element_by_id("view");
        let Some(canvas) = canvas.and_then(|it| it.dyn_into::<web_sys::HtmlCanvasElement>().ok()) else {
            return say("the page has no canvas");
        };
        let create: eframe::AppCreator<'static> =
            Box::new(|creation| Ok(Box::new(App::new(creation, &Start::default()))));
        match eframe::WebRunner::new().start(canvas, eframe::WebOptions::default(), create).await {
            Ok(()) => say(""),
            Err(fault) => say(&format!("neither WebGPU nor WebGL2 can be had in this browser: {fault:?}")),
        }
    });
}
