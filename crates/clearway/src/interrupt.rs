//! Ctrl-C: asks the work to stop, and ends the program soon whether it listens or not.

use crate::exit::Exit;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Duration;

/// Work that has not stopped by itself after this long is ended.
const PATIENCE: Duration = Duration::from_millis(80);

/// A flag that Ctrl-C (or a termination signal) raises.
pub fn flag() -> Arc<AtomicBool> {
    let flag = Arc::new(AtomicBool::new(false));
    let raised = flag.clone();
    // Without a handler the program just ends at once; that is no reason not to plan.
    let _ = ctrlc::set_handler(move || {
        raised.store(true, Ordering::Relaxed);
        std::thread::sleep(PATIENCE);
        std::process::exit(Exit::Interrupted as i32);
    });
    flag
}
