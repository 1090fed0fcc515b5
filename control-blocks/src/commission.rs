//! Parts of the state `Commission` of every controller.

pub mod bounds;
pub mod excitation;
pub mod export;
pub mod in_force;
pub mod multisine;
