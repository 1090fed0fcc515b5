//! Frequency response of the position loop, measured in place.

pub mod experiment;
pub mod glide;
pub mod tone;
