//! Ctrl-C and SIGTERM: the first asks for an orderly end, the second ends at once.

use signal_hook::consts::SIGINT;
use signal_hook::consts::SIGTERM;
use signal_hook::flag;
use std::sync::Arc;
use std::sync::OnceLock;
use std::sync::atomic::AtomicBool;
use std::sync::atomic::AtomicUsize;
use std::sync::atomic::Ordering;

use crate::exit::Failure;

/// The number of the signal that came; 0 before.
static CAME: OnceLock<Arc<AtomicUsize>> = OnceLock::new();

/// Starts to listen. Where the system has no such signals, nothing happens.
pub fn watch() {
    let came = CAME.get_or_init(Arc::default);
    let asked = Arc::new(AtomicBool::new(false));
    for signal in [SIGINT, SIGTERM] {
        // A person who asks twice does not want to wait for the end of a stage. Handlers run in this order, so the
        // first signal finds the flag down.
        let _ = flag::register_conditional_shutdown(signal, 128 + signal, Arc::clone(&asked));
        let _ = flag::register(signal, Arc::clone(&asked));
        let _ = flag::register_usize(signal, Arc::clone(came), usize::try_from(signal).unwrap_or(1));
    }
}

/// The number of the signal that asked to stop.
pub fn signal() -> Option<u8> {
    let number = CAME.get()?.load(Ordering::Relaxed);
    u8::try_from(number).ok().filter(|number| *number > 0)
}

/// Whether somebody asked to stop.
pub fn pressed() -> bool {
    signal().is_some()
}

/// The end that was asked for, nothing being kept.
pub fn failure() -> Failure {
    Failure::Interrupted { signal: signal().unwrap_or(2), kept: None }
}

/// Stops here if somebody asked to: to be called between stages.
pub fn check() -> Result<(), Failure> {
    if pressed() { Err(failure()) } else { Ok(()) }
}
