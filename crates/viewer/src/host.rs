//! Where files go: back to where the scene came from, or, for pictures, where people keep theirs.

use crate::bundle::Bundle;
use crate::memory::Dropped;
use crate::wire::Ask;
use dotray_scene::Files;
use dotray_scene::files::Disk;
use std::io;
use std::path::Path;
use std::sync::Arc;
use std::sync::Mutex;
use std::sync::PoisonError;

/// Where a scene's files come from and can be stored again.
pub trait Home: Files + Send + Sync {
    /// Stores a file of the scene, whole or not at all.
    ///
    /// # Errors
    /// What the system says.
    fn store(&self, path: &Path, bytes: &[u8]) -> Result<(), String>;

    /// Whether the file is still the one that was read.
    fn is_as_read(&self, path: &Path, read: &[u8]) -> bool {
        self.read(path).is_ok_and(|now| now == read)
    }

    /// Whether the tracer has these files without being sent them.
    fn is_known_elsewhere(&self) -> bool {
        false
    }
}

impl Home for Disk {
    fn store(&self, path: &Path, bytes: &[u8]) -> Result<(), String> {
        dotray_image::write_file(path, bytes)
            .map_err(|error| format!("cannot write `{}`: {error}", path.display()))
    }
}

impl Home for Dropped {
    /// The new file is handed out by way of the browser's downloads, for a page cannot write where it came from.
    fn store(&self, path: &Path, bytes: &[u8]) -> Result<(), String> {
        save(path, bytes)?;
        self.add(path, bytes.to_vec());
        Ok(())
    }
}

/// A scene that a program has sent, which stores its files where they came from.
#[derive(Debug)]
pub struct Served {
    files: Bundle,
    outgoing: Arc<Mutex<Vec<Ask>>>,
}

impl Served {
    /// These files; what is to be stored is put where the other end is told.
    pub fn new(files: Vec<(String, Vec<u8>)>, outgoing: Arc<Mutex<Vec<Ask>>>) -> Self {
        Self { files: Bundle::new(files), outgoing }
    }
}

impl Files for Served {
    fn read(&self, path: &Path) -> io::Result<Vec<u8>> {
        self.files.read(path)
    }

    fn names_in(&self, folder: &Path) -> Vec<String> {
        self.files.names_in(folder)
    }
}

impl Home for Served {
    fn store(&self, path: &Path, bytes: &[u8]) -> Result<(), String> {
        self.files.add(path, bytes.to_vec());
        let ask = Ask::Store(path.to_string_lossy().into_owned(), bytes.to_vec());
        self.outgoing.lock().unwrap_or_else(PoisonError::into_inner).push(ask);
        Ok(())
    }

    fn is_known_elsewhere(&self) -> bool {
        true
    }
}

/// Stores a picture.
///
/// # Errors
/// What the system says.
#[cfg(not(target_arch = "wasm32"))]
pub fn save(path: &Path, bytes: &[u8]) -> Result<(), String> {
    Disk.store(path, bytes)
}

/// Hands a file to the browser's downloads.
///
/// # Errors
/// What the browser says.
#[cfg(target_arch = "wasm32")]
pub fn save(path: &Path, bytes: &[u8]) -> Result<(), String> {
    download(path, bytes)
        .map_err(|fault| format!("the browser does not take `{}`: {fault:?}", path.display()))
}

#[cfg(target_arch = "wasm32")]
fn download(path: &Path, bytes: &[u8]) -> Result<(), wasm_bindgen::JsValue> {
    use wasm_bindgen::JsCast;
    let parts = js_sys::Array::of1(&js_sys::Uint8Array::from(bytes));
    let url = web_sys::Url::create_object_url_with_blob(&web_sys::Blob::new_with_u8_array_sequence(&parts)?)?;
    let document = web_sys::window().and_then(|window| window.document()).ok_or("no page")?;
    let link: web_sys::HtmlAnchorElement = document.create_element("a")?.dyn_into()?;
    link.set_href(&url);
    link.set_download(&path.file_name().unwrap_or(path.as_os_str()).to_string_lossy());
    link.click();
    web_sys::Url::revoke_object_url(&url)
}

/// The page around the application.
#[cfg(target_arch = "wasm32")]
#[derive(Clone, Debug)]
pub struct Page {
    /// What is drawn in.
    pub canvas: web_sys::HtmlCanvasElement,
    /// What the JavaScript around the application has put into its global `rayview`.
    pub given: js_sys::Object,
}

#[cfg(target_arch = "wasm32")]
impl Page {
    /// The page as its JavaScript describes it.
    ///
    /// # Errors
    /// What is missing.
    pub fn find() -> Result<Self, wasm_bindgen::JsValue> {
        use wasm_bindgen::JsCast;
        let given: js_sys::Object = js_sys::Reflect::get(&js_sys::global(), &"rayview".into())?.dyn_into()?;
        let canvas = js_sys::Reflect::get(&given, &"canvas".into())?.dyn_into()?;
        Ok(Self { canvas, given })
    }

    /// A function that was given by this name.
    pub fn function(&self, name: &str) -> Option<js_sys::Function> {
        use wasm_bindgen::JsCast;
        js_sys::Reflect::get(&self.given, &name.into()).ok()?.dyn_into().ok()
    }

    /// Whether there is little room: the panels are then closed at first.
    pub fn is_small(&self) -> bool {
        js_sys::Reflect::get(&self.given, &"small".into()).is_ok_and(|small| small.is_truthy())
    }

    /// Says something where there is no picture.
    pub fn say(&self, text: &str) {
        if let Some(say) = self.function("say") {
            // A page that cannot say it has nobody to hear it.
            let _ = say.call1(&self.given, &text.into());
        }
    }
}
