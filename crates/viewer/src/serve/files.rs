//! The page's files, as `cargo xtask web` has built them.

/// A file of the page.
pub struct File {
    pub name: &'static str,
    pub kind: &'static str,
    /// Whether it is packed by gzip, which every browser unpacks.
    pub packed: bool,
    pub bytes: &'static [u8],
}

const SCRIPT: &str = "text/javascript; charset=utf-8";

/// All that can be had.
pub const PAGE: [File; 7] = [
    File {
        name: "index.html",
        kind: "text/html; charset=utf-8",
        packed: false,
        bytes: include_bytes!("../../web/dist/index.html"),
    },
    File {
        name: "page.css",
        kind: "text/css; charset=utf-8",
        packed: false,
        bytes: include_bytes!("../../web/dist/page.css"),
    },
    File { name: "page.js", kind: SCRIPT, packed: false, bytes: include_bytes!("../../web/dist/page.js") },
    File { name: "crew.js", kind: SCRIPT, packed: false, bytes: include_bytes!("../../web/dist/crew.js") },
    File {
        name: "tracer.js",
        kind: SCRIPT,
        packed: false,
        bytes: include_bytes!("../../web/dist/tracer.js"),
    },
    File {
        name: "rayview.js",
        kind: SCRIPT,
        packed: false,
        bytes: include_bytes!("../../web/dist/rayview.js"),
    },
    File {
        name: "rayview_bg.wasm",
        kind: "application/wasm",
        packed: true,
        bytes: include_bytes!("../../web/dist/rayview_bg.wasm.gz"),
    },
];
