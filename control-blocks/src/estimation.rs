//! What is learned from samples, in constant time and memory.

pub mod running_line;
