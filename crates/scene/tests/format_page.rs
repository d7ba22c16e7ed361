//! docs/format.md is made from the table of directives; `UPDATE=1` rewrites it.

use dotray_scene::directive::format_page;
use std::path::Path;

#[test]
fn the_format_page_is_that_of_the_table() {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../docs/format.md");
    let made = format_page();
    if std::env::var_os("UPDATE").is_some() {
        std::fs::write(&path, &made).unwrap();
    }
    let written = std::fs::read_to_string(&path).unwrap_or_default();
    assert!(written == made, "docs/format.md is not what the table says; UPDATE=1 rewrites it");
}
