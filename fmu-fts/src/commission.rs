//! The commissioning run: the experiment of an identification under a loop that is stable on every machine of the
//! class, the arm that its response identifies, and the derived parameters.

pub mod arm;
pub mod plan;
pub mod run;
pub mod values;
