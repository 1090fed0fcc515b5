//! Geometry of the arm from cut and probed parts.

pub mod calibrator;
pub mod cut;
pub mod flats;
pub mod form;
pub mod store;
pub mod toroid;
