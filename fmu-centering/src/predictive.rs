//! The default law: a recursive model of the ring, and pushes that are planned backwards from the centre.

mod aim;
mod contact;
mod gaussian;
mod law;
mod learned;
mod press;
mod ring_line;
mod ring_model;
mod stroke;
mod tap;

pub use law::PredictiveLaw;
