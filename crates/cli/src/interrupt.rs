//! Ctrl-C: the first asks for an orderly end, the second ends at once.

use std::sync::atomic::AtomicBool;
use std::sync::atomic::Ordering;

use crate::exit::Failure;

static INTERRUPTED: AtomicBool = AtomicBool::new(false);

/// Starts to listen. Where the system has no such signal, nothing happens.
pub fn watch() {
    let _ = ctrlc::set_handler(|| {
        if INTERRUPTED.swap(true, Ordering::Relaxed) {
            // A person who asks twice does not want to wait for the end of a stage; this thread has nothing to
            // clean up.
            std::process::exit(130);
        }
    });
}

/// Whether Ctrl-C was pressed.
pub fn pressed() -> bool {
    INTERRUPTED.load(Ordering::Relaxed)
}

/// Stops here if Ctrl-C was pressed: to be called between stages.
pub fn check() -> Result<(), Failure> {
    if pressed() { Err(Failure::Interrupted) } else { Ok(()) }
}
