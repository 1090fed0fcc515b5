//! The machine measured by its own controller: the experiment of an identification under a loop that every such machine
//! bears, what its response tells of the arm, and what is made of it.

pub mod arm;
pub mod plan;
pub mod run;
pub mod values;
