//! Scenes on a page: dropped or picked, read by the browser by and by, and never sent anywhere.

use crate::document::Document;
use crate::host::Page;
use crate::link::Source;
use crate::link::Wake;
use crate::memory::Dropped;
use crate::memory::MOST;
use crate::memory::scene_among;
use crate::state::State;
use eframe::egui;
use std::cell::RefCell;
use std::path::Path;
use std::path::PathBuf;
use std::rc::Rc;
use std::sync::Arc;
use wasm_bindgen::JsCast;
use wasm_bindgen::JsValue;
use wasm_bindgen::closure::Closure;

/// Whether files can be picked from a list.
pub const CAN_PICK: bool = true;

/// What the browser has read of what came.
#[derive(Default)]
struct Arrivals {
    files: Arc<Dropped>,
    /// Files that the browser still reads.
    awaited: usize,
    /// Files that have come since the last look.
    fresh: Vec<PathBuf>,
    fault: Option<String>,
}

/// See the module.
pub struct Inbox {
    wake: Wake,
    arrivals: Rc<RefCell<Arrivals>>,
}

impl Inbox {
    /// What the page was given at its start.
    pub fn new(wake: Wake) -> Self {
        let inbox = Self { wake, arrivals: Rc::default() };
        if let Ok(page) = Page::find() {
            inbox.take_given(&page);
        }
        inbox
    }

    /// Takes the files of the page's `files`: pairs of a name and bytes.
    fn take_given(&self, page: &Page) {
        let files = js_sys::Reflect::get(&page.given, &"files".into()).ok();
        let Some(files) = files.and_then(|files| files.dyn_into::<js_sys::Array>().ok()) else { return };
        let mut arrivals = self.arrivals.borrow_mut();
        for file in files.iter().filter_map(|pair| pair.dyn_into::<js_sys::Array>().ok()) {
            let Some(name) = file.get(0).as_string() else { continue };
            arrivals.files.add(Path::new(&name), js_sys::Uint8Array::new(&file.get(1)).to_vec());
            arrivals.fresh.push(PathBuf::from(name));
        }
    }

    /// Whether there is little room.
    pub fn is_small(&self) -> bool {
        Page::find().is_ok_and(|page| page.is_small())
    }

    /// A page is given no names.
    pub fn open(&mut self, _: PathBuf, _: &mut State) {}

    /// Files are read once; what is dropped again replaces them.
    pub fn opened(&mut self, _: &Document) {}

    /// Takes what has come since the last time.
    pub fn look(&mut self, ctx: &egui::Context, state: &mut State) {
        for file in ctx.input(|input| input.raw.dropped_files.clone()) {
            let Some(file) = file.web_file() else { continue };
            receive(&self.arrivals, &self.wake, file.clone());
        }
        let mut arrivals = self.arrivals.borrow_mut();
        if let Some(fault) = arrivals.fault.take() {
            state.notice = fault;
        }
        if arrivals.awaited > 0 || arrivals.fresh.is_empty() {
            return;
        }
        let fresh = std::mem::take(&mut arrivals.fresh);
        let files = arrivals.files.clone();
        drop(arrivals);
        show(state, files, &fresh);
    }

    /// Lets the user pick files.
    pub fn pick(&self) {
        // Without a document there is no page to pick on.
        let _ = ask_for_files(self.arrivals.clone(), self.wake.clone());
    }
}

/// Shows the scene among the files that came, or the present one again with its new textures.
fn show(state: &mut State, files: Arc<Dropped>, fresh: &[PathBuf]) {
    let shown = state.source.as_ref().map(|source| source.path.clone());
    let scene = scene_among(fresh.iter().map(PathBuf::as_path), &files);
    let again = shown.clone().filter(|shown| scene.as_ref().is_none_or(|scene| scene == shown));
    if let Some(path) = again {
        state.source = Some(Source { path, files });
        state.changed_outside();
    } else if let Some(path) = scene {
        state.open(Source { path, files });
    } else {
        state.notice = "there is no .ray file among these: drop one, too".to_owned();
    }
}

/// Has the browser read a file.
fn receive(arrivals: &Rc<RefCell<Arrivals>>, wake: &Wake, file: web_sys::File) {
    let path = PathBuf::from(file.name());
    let mut now = arrivals.borrow_mut();
    if file.size() + now.files.size() as f64 > MOST as f64 {
        now.fault = Some(format!("`{}` is too large: a page takes at most {MOST} bytes", path.display()));
        wake();
        return;
    }
    now.awaited += 1;
    let (arrivals, wake) = (arrivals.clone(), wake.clone());
    wasm_bindgen_futures::spawn_local(async move {
        let content = wasm_bindgen_futures::JsFuture::from(file.array_buffer()).await;
        let mut arrivals = arrivals.borrow_mut();
        arrivals.awaited -= 1;
        match content {
            Ok(content) => {
                arrivals.files.add(&path, js_sys::Uint8Array::new(&content).to_vec());
                arrivals.fresh.push(path);
            }
            Err(fault) => arrivals.fault = Some(unreadable(&path, &fault)),
        }
        wake();
    });
}

fn unreadable(path: &Path, fault: &JsValue) -> String {
    format!("cannot read `{}`: {fault:?}", path.display())
}

/// Opens the browser's list of files.
fn ask_for_files(arrivals: Rc<RefCell<Arrivals>>, wake: Wake) -> Result<(), JsValue> {
    let document = web_sys::window().and_then(|window| window.document()).ok_or("no page")?;
    let input: web_sys::HtmlInputElement = document.create_element("input")?.dyn_into()?;
    input.set_type("file");
    input.set_multiple(true);
    let chosen = input.clone();
    let take = Closure::once_into_js(move || {
        let Some(files) = chosen.files() else { return };
        (0..files.length())
            .filter_map(|index| files.get(index))
            .for_each(|file| receive(&arrivals, &wake, file));
    });
    input.set_onchange(Some(take.unchecked_ref()));
    input.click();
    Ok(())
}
