//! Cutter location (CL) data from a file: contact points and normals, checked before anything moves.

use std::path::Path;

use control_blocks::{FileParameter, ParameterError};
use nalgebra::Vector3;

use super::built_in;
use super::cl_checks as checks;
use super::cl_data::{ClError, Point};
use super::cl_statement::{Statement, Units, parse};
use crate::interface::Parameters;

/// Largest file that is read, bytes.
const BYTES_MAX: u64 = 32 << 20;
/// Most points of a path.
const POINTS_MAX: usize = 200_000;

/// Reads and checks the CL data that `path.file` names.
///
/// # Errors
/// Names the file, the line, the value and the limit.
pub fn read(resources: Option<&Path>, p: &Parameters) -> Result<Vec<Point>, ParameterError> {
    let hint = "Set a file in the folder resources of the FMU, or an absolute path.";
    let parameter = FileParameter { name: "path.file", file: &p.path.file, hint };
    let bytes = if parameter.file == built_in::NAME {
        built_in::BYTES.to_vec()
    } else {
        parameter.read(resources, BYTES_MAX)?
    };
    points(&bytes, p).map_err(|error| {
        let limit = format!("CL data without error; line {}: {}", error.line, error.reason);
        FileParameter { hint: error.hint, ..parameter }.wrong(limit)
    })
}

/// The checked points in the text of a CL file.
///
/// # Errors
/// The first line that is wrong, and why.
pub fn points(bytes: &[u8], p: &Parameters) -> Result<Vec<Point>, ClError> {
    let text = std::str::from_utf8(bytes).map_err(|error| {
        let line = 1 + bytes[..error.valid_up_to()].iter().filter(|byte| **byte == b'\n').count();
        ClError::new(
            line,
            "the file is not UTF-8 text",
            "Export CL data as text, not as the binary file of a CAM system.",
        )
    })?;
    let mut reader = Interpreter::default();
    for (i, line) in text.lines().enumerate() {
        let number = i + 1;
        reader.lines = number;
        if let Some(statement) = parse(line).map_err(|(reason, hint)| ClError::new(number, reason, hint))? {
            reader.take(statement, number, p)?;
        }
    }
    reader.finish(p)
}

/// Units, feed (m/s) and points from the statements that were read so far.
#[derive(Debug, Default)]
struct Interpreter {
    units: Option<Units>,
    feed: f64,
    finished: bool,
    lines: usize,
    points: Vec<Point>,
}

impl Interpreter {
    /// Takes one statement of line `line`.
    fn take(&mut self, statement: Statement, line: usize, p: &Parameters) -> Result<(), ClError> {
        if self.finished {
            return Err(ClError::new(line, "a statement after FINI", "End the file with FINI."));
        }
        match statement {
            Statement::Remark => Ok(()),
            Statement::Units(units) => self.set_units(units, line),
            Statement::Cutter(diameter) => {
                let diameter = diameter * self.metre(line)?;
                checks::cutter(diameter, p).map_err(|reason| {
                    ClError::new(line, reason, "Set `tool.radius` to the radius of the tool, and make the path for it.")
                })
            }
            Statement::Feed(feed) => {
                self.feed = feed;
                Ok(())
            }
            Statement::Goto(numbers) => self.go(numbers, line),
            Statement::Fini => {
                self.finished = true;
                Ok(())
            }
        }
    }

    fn set_units(&mut self, units: Units, line: usize) -> Result<(), ClError> {
        if self.units.is_some_and(|known| known != units) {
            return Err(ClError::new(line, "a second UNITS that differs", "Write the whole file in one unit."));
        }
        self.units = Some(units);
        Ok(())
    }

    /// Meters in a unit of the file.
    fn metre(&self, line: usize) -> Result<f64, ClError> {
        let hint = "Write `UNITS/MM` or `UNITS/INCH` before the first length.";
        self.units.map(Units::metre).ok_or_else(|| ClError::new(line, "a length before UNITS", hint))
    }

    fn go(&mut self, [x, y, z, i, j, k]: [f64; 6], line: usize) -> Result<(), ClError> {
        let metre = self.metre(line)?;
        if self.points.len() == POINTS_MAX {
            let reason = format!("more than `{POINTS_MAX}` points");
            return Err(ClError::new(line, reason, "Increase the spacing of the points, or divide the path."));
        }
        let normal = checks::unit_normal(Vector3::new(i, j, k)).map_err(|reason| {
            ClError::new(line, reason, "Write the unit normal out of the material as the last three numbers.")
        })?;
        let contact = metre * Vector3::new(x, y, z);
        let new = self.points.last().is_none_or(|last| (contact - last.contact).norm() >= checks::SPACING_MIN);
        // a point twice says nothing new
        if new {
            self.points.push(Point { contact, normal, feed: self.feed, line });
        }
        Ok(())
    }

    fn finish(self, p: &Parameters) -> Result<Vec<Point>, ClError> {
        if !self.finished {
            let reason = if self.lines == 0 { "the file is empty" } else { "the file ends without FINI" };
            return Err(ClError::new(self.lines.max(1), reason, "Write the whole path, then FINI."));
        }
        checks::path(&self.points, self.lines, p)?;
        Ok(self.points)
    }
}
