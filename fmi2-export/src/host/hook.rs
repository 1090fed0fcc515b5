//! A quiet panic hook: a panic becomes a message of the instance, not noise on the host's stderr.

use std::cell::RefCell;
use std::panic::{self, PanicHookInfo};
use std::sync::Once;

static INSTALLED: Once = Once::new();

thread_local! {
    static LAST: RefCell<String> = const { RefCell::new(String::new()) };
}

/// Installs the hook once for this library; the host's own hook lives in another copy of std.
pub fn install() {
    INSTALLED.call_once(|| panic::set_hook(Box::new(remember)));
}

/// Takes the message of the last panic of this thread, with file and line; empty if there was none since the last call.
pub fn take_panic() -> String {
    LAST.take()
}

fn remember(info: &PanicHookInfo) {
    let place = info.location().map_or(String::new(), |at| format!(" at {}:{}", at.file(), at.line()));
    let text = format!("the model panicked{place}: {}", info.payload_as_str().unwrap_or("(no text)"));
    // a thread that is ending has no place for it, and nobody who asks
    let _ = LAST.try_with(|last| last.replace(text));
}
