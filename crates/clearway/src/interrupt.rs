//! Ctrl-C: asks the work to stop, and ends the program soon whether it listens or not.

use crate::commands::output::tell;
use crate::exit::Exit;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, LazyLock, Mutex, MutexGuard, PoisonError};
use std::time::Duration;

/// Work that has not stopped by itself after this long is ended.
const PATIENCE: Duration = Duration::from_millis(60);

static RAISED: LazyLock<Arc<AtomicBool>> = LazyLock::new(Arc::default);
/// Held while a file is being written, so that none is left half done.
static WRITING: Mutex<()> = Mutex::new(());

/// From here on Ctrl-C raises the flag, and soon after ends the program.
pub fn heed() {
    let raised = flag();
    // Without a handler the program just ends at once; that is no reason not to work.
    let _ = ctrlc::set_handler(move || {
        raised.store(true, Ordering::Relaxed);
        std::thread::sleep(PATIENCE);
        let _writing = writing();
        tell("error: interrupted");
        std::process::exit(Exit::Interrupted as i32);
    });
}

/// The flag that Ctrl-C raises.
pub fn flag() -> Arc<AtomicBool> {
    RAISED.clone()
}

pub fn raised() -> bool {
    RAISED.load(Ordering::Relaxed)
}

/// Puts the end off until dropped.
pub fn writing() -> MutexGuard<'static, ()> {
    WRITING.lock().unwrap_or_else(PoisonError::into_inner)
}
