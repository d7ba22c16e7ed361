//! Between the addresses of the protocol and paths.

use lsp_types::Uri;
use std::path::Path;
use std::path::PathBuf;
use std::str::FromStr;
use url::Url;

/// The path of an address; of one that is no file's, its last part.
pub fn path_of(uri: &Uri) -> PathBuf {
    let url = Url::parse(uri.as_str()).ok();
    let on_disk = url.as_ref().filter(|url| url.scheme() == "file").and_then(|url| url.to_file_path().ok());
    on_disk.unwrap_or_else(|| {
        let name = uri.as_str().rsplit(['/', ':']).next().unwrap_or_default();
        PathBuf::from(if name.is_empty() { "unnamed" } else { name })
    })
}

/// The address of a path; a relative one is meant from the working directory.
pub fn uri_of(path: &Path) -> Option<Uri> {
    let whole = std::path::absolute(path).ok()?;
    let url = Url::from_file_path(whole).ok()?;
    Uri::from_str(url.as_str()).ok()
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;

    #[test]
    #[cfg(unix)]
    fn paths_come_back() {
        for path in ["/tmp/a.ray", "/tmp/two words/\u{e4}#%.ray"] {
            let uri = uri_of(Path::new(path)).unwrap();
            assert!(uri.as_str().starts_with("file:///tmp/"), "{}", uri.as_str());
            assert_eq!(path_of(&uri), Path::new(path));
        }
    }

    #[test]
    fn what_is_on_no_disk_has_a_name() {
        for (uri, name) in
            [("untitled:Untitled-1", "Untitled-1"), ("git:/a/b.ray", "b.ray"), ("x:", "unnamed")]
        {
            assert_eq!(path_of(&Uri::from_str(uri).unwrap()), Path::new(name));
        }
    }
}
