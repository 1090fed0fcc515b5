//! The variables of a model: one constant table, checked and hashed when it is compiled.

pub mod check;
pub mod enumeration;
pub mod guid;
pub mod hash;
pub mod index;
pub mod place;
pub mod text;
pub mod units;
pub mod variable;
