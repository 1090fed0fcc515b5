//! The path that needs no file: 15 mm in the middle of an LED lens mold.

/// Its name, as `path.file` gives it.
pub const NAME: &str = "led-short.cls";
/// Its CL data.
pub const BYTES: &[u8] = include_bytes!("../../resources/led-short.cls");
