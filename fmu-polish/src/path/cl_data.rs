//! A point of cutter location (CL) data, and why CL data are rejected.

use std::fmt;

use nalgebra::Vector3;

/// A point of the path.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Point {
    /// Contact point, m.
    pub contact: Vector3<f64>,
    /// Unit normal out of the material.
    pub normal: Vector3<f64>,
    /// Feed towards this point, m/s; 0 if the file gives none.
    pub feed: f64,
    /// Line of the file.
    pub line: usize,
}

/// Why the CL data are rejected.
#[derive(Clone, Debug, PartialEq)]
pub struct ClError {
    /// Line of the file, from 1.
    pub line: usize,
    /// Error in that line, with value and limit.
    pub reason: String,
    /// Instruction that corrects the error.
    pub hint: &'static str,
}

impl ClError {
    /// The error in `line`.
    pub fn new(line: usize, reason: impl Into<String>, hint: &'static str) -> Self {
        Self { line, reason: reason.into(), hint }
    }
}

impl fmt::Display for ClError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "line {}: {}\nhint: {}", self.line, self.reason, self.hint)
    }
}

impl std::error::Error for ClError {}
