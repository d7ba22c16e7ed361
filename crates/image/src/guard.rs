//! A wall around decoders and encoders of other crates.

use std::panic::AssertUnwindSafe;
use std::panic::catch_unwind;

/// Runs code of another crate; if that panics, which would be a defect there, its message becomes an ordinary error.
pub(crate) fn guarded<T>(work: impl FnOnce() -> Result<T, String>) -> Result<T, String> {
    // What the closure touches is dropped or returned whole, so nothing broken can be seen afterwards.
    catch_unwind(AssertUnwindSafe(work)).unwrap_or_else(|panic| {
        let text = panic.downcast_ref::<&str>().map(ToString::to_string);
        let text = text.or_else(|| panic.downcast_ref::<String>().cloned());
        Err(format!("the library for it broke down: {}", text.unwrap_or_default()))
    })
}
