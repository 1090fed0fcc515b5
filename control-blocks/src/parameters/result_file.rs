//! Files of results that text parameters name: flat JSON, a parameter and its value on each line.
//!
//! The names are those of the FMI variables, so that what was measured can be set where the controller is used next.

use std::fmt::Write;
use std::fs;

use super::error::ParameterError;

/// A text parameter that names the file to be written.
#[derive(Clone, Copy, Debug)]
pub struct ResultFile<'a> {
    /// FMI name of the parameter.
    pub name: &'static str,
    /// Its value: a path, from the working directory of the importer unless it is whole.
    pub file: &'a str,
    /// What to do when it cannot be written.
    pub hint: &'static str,
}

impl ResultFile<'_> {
    /// Writes names and finite values, in their order, in place of what the file held.
    ///
    /// # Errors
    /// When the file cannot be written.
    pub fn write(&self, values: &[(&str, f64)]) -> Result<(), ParameterError> {
        fs::write(self.file, json(values)).map_err(|error| ParameterError {
            name: self.name,
            value: self.file.to_owned(),
            limit: format!("a file that can be written: {error}"),
            hint: self.hint,
        })
    }
}

/// The object, a line for each value; whole numbers without a point, as FMI's Integers are.
fn json(values: &[(&str, f64)]) -> String {
    let mut text = String::from("{");
    for (i, (name, value)) in values.iter().enumerate() {
        let comma = if i > 0 { "," } else { "" };
        // writing into a String cannot fail
        let _ = if value.fract() == 0.0 && value.abs() < 1e9 {
            write!(text, "{comma}\n  \"{name}\": {value}")
        } else {
            write!(text, "{comma}\n  \"{name}\": {value:e}")
        };
    }
    text + "\n}\n"
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_value_keeps_its_bits_and_a_whole_number_its_form() {
        let text = json(&[("stage.force_constant", 19.4), ("io_delay", 2.0), ("kalman.position_noise", 5.7e-10)]);
        assert_eq!(
            text,
            "{\n  \"stage.force_constant\": 1.94e1,\n  \"io_delay\": 2,\n  \"kalman.position_noise\": 5.7e-10\n}\n"
        );
        let third = 1.0 / 3.0;
        let text = json(&[("a", third)]);
        let value: f64 = text[text.find(": ").unwrap() + 2..text.len() - 3].parse().unwrap();
        assert_eq!(value.to_bits(), f64::to_bits(third));
    }

    #[test]
    fn what_cannot_be_written_says_why() {
        let place = tempfile::tempdir().unwrap();
        let (good, bad) = (place.path().join("found.json"), place.path().join("no/such/found.json"));
        let file = |path: &std::path::Path| {
            ResultFile { name: "commission.export", file: path.to_str().unwrap(), hint: "name a folder that there is" }
                .write(&[("a", 1.5)])
                .map_err(|error| error.to_string())
        };
        assert_eq!(file(&good), Ok(()));
        assert_eq!(fs::read_to_string(&good).unwrap(), "{\n  \"a\": 1.5e0\n}\n");
        let message = file(&bad).unwrap_err();
        assert!(message.contains("commission.export") && message.contains("must be a file that can be written"));
        assert!(message.ends_with("hint: name a folder that there is"), "{message}");
    }
}
