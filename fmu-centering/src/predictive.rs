//! The default control law: a recursive model of the ring, and pushes that are planned backwards from the center.

mod aim;
mod any_form;
mod assumptions;
mod contact;
mod gaussian;
mod ground_ring;
mod law;
mod learned;
mod normal;
mod press;
mod refit;
mod ring_estimate;
mod ring_line;
mod ring_model;
mod stroke;
mod tap;

pub use law::PredictiveLaw;
