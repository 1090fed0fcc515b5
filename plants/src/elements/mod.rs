//! Plant elements beyond MJCF, one per file, by theme.

pub mod cutting;
pub mod drive;
pub mod friction;
pub mod polishing;
pub mod signal;
pub mod table;
