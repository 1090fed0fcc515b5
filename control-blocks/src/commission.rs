//! Parts of the state `Commission` of every controller.

pub mod active;
pub mod bounds;
pub mod excitation;
pub mod export;
pub mod multisine;
