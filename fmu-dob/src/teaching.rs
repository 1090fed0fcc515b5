//! How late a contact is found, taught by touches at several speeds.

pub mod bias;
pub mod lesson;
pub mod press;
pub mod spread;
pub mod teacher;
