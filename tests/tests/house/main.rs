//! The rules of the house, read off the source tree: floors, sizes, words, manifests, tracked files.
//!
//! Each rule is a function from text to a list of faults, so that it can be shown planted faults as well as the tree.

mod files;
mod floors;
mod manifests;
mod ratchet;
mod rust;
mod words;

/// Fails with every fault on a line of its own.
fn expect_none(rule: &str, faults: &[String]) {
    assert!(faults.is_empty(), "{rule}: {} faults\n  {}", faults.len(), faults.join("\n  "));
}
