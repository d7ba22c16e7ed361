//! Where files go: to the disk, or out of a page by way of its downloads.

use std::path::Path;

/// Stores a file, whole or not at all.
///
/// # Errors
/// What the system says.
#[cfg(not(target_arch = "wasm32"))]
pub fn store(path: &Path, bytes: &[u8]) -> Result<(), String> {
    dotray_image::write_file(path, bytes)
        .map_err(|error| format!("cannot write `{}`: {error}", path.display()))
}

/// Whether the file on the disk is the one that was read.
#[cfg(not(target_arch = "wasm32"))]
pub fn is_as_read(path: &Path, read: &[u8]) -> bool {
    std::fs::read(path).is_ok_and(|now| now == read)
}

/// Hands a file to the browser's downloads.
///
/// # Errors
/// What the browser says.
#[cfg(target_arch = "wasm32")]
pub fn store(path: &Path, bytes: &[u8]) -> Result<(), String> {
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

/// A page never sees the disk: what it was given is what it shows.
#[cfg(target_arch = "wasm32")]
pub fn is_as_read(_: &Path, _: &[u8]) -> bool {
    true
}
