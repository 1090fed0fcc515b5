//! C strings.

use std::ffi::CString;

/// A C string without the NUL bytes that `text` may hold.
pub fn c_string(text: impl Into<String>) -> CString {
    let mut bytes = text.into().into_bytes();
    bytes.retain(|byte| *byte != 0);
    CString::new(bytes).unwrap_or_default()
}
