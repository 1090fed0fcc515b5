//! A quiet panic hook: a panic becomes a message of the instance, not noise on the host's stderr.

use std::panic::{self, PanicHookInfo};
use std::sync::{Mutex, Once, PoisonError};

static INSTALLED: Once = Once::new();
static LAST: Mutex<String> = Mutex::new(String::new());

/// Installs the hook once for this library; the host's own hook lives in another copy of std.
pub fn install() {
    INSTALLED.call_once(|| panic::set_hook(Box::new(remember)));
}

/// What the last panic said, with file and line.
pub fn last_panic() -> String {
    LAST.lock().unwrap_or_else(PoisonError::into_inner).clone()
}

fn remember(info: &PanicHookInfo) {
    let place = info.location().map_or(String::new(), |at| format!(" at {}:{}", at.file(), at.line()));
    let text = format!("the model panicked{place}: {}", info.payload_as_str().unwrap_or("(no text)"));
    *LAST.lock().unwrap_or_else(PoisonError::into_inner) = text;
}
