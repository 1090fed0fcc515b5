//! The bank of control patterns, and its files.

pub(crate) mod bank_file;
pub(crate) mod kept;
pub mod pattern_bank;
pub(crate) mod records;
pub(crate) mod save;
pub(crate) mod storage;
