//! Everything an importer can do wrong, through the C API of the built library: the right status, a
//! text that says why, and an instance that can still be reset, restored and freed.

#![allow(
    clippy::undocumented_unsafe_blocks,
    reason = "each is one call of the C API, with pointers that live during it or the NULL under test"
)]

#[path = "../common/mod.rs"]
mod common;

mod arguments;
mod bytes;
mod derivatives;
mod exchange;
mod failures;
mod instantiate;
mod phases;
mod statuses;
mod steps;
mod values;
