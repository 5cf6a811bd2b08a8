//! Ctrl-C: the run stops between two measurements and keeps what it has.

use std::sync::atomic::{AtomicBool, Ordering};

use crate::failure::Failure;

static STOP: AtomicBool = AtomicBool::new(false);

/// Listens for Ctrl-C (and a request to terminate). The second one ends the process at once: files
/// are written whole or not at all, so nothing breaks.
pub(crate) fn listen() {
    let heard = ctrlc::set_handler(|| {
        if STOP.swap(true, Ordering::SeqCst) {
            std::process::exit(130);
        }
    });
    // Without a handler Ctrl-C ends the process, which does no harm either.
    drop(heard);
}

/// The flag that is set once the user wants to stop.
pub(crate) fn flag() -> &'static AtomicBool {
    &STOP
}

/// Fails once the user wants to stop.
pub(crate) fn check() -> Result<(), Failure> {
    if STOP.load(Ordering::SeqCst) { Err(Failure::Interrupted("stopped".into())) } else { Ok(()) }
}
