//! The file that a good commissioning run writes: flat JSON, one parameter and its value per line.
//!
//! The names are those of the FMI variables, so that the values can be set where the controller is used next.

use std::fmt::Write;
use std::fs;

use crate::parameters::error::ParameterError;

/// Remedy if it cannot be written.
const HINT: &str = "name a file in a folder that there is and that the importer may write to";

/// Writes the file that the parameter `commission.export` names, as [`export_values`] does.
///
/// # Errors
/// When the file cannot be written.
pub fn export_commission(file: &str, values: &[(&str, f64)]) -> Result<(), ParameterError> {
    export_values("commission.export", file, values)
}

/// Writes the file that a parameter `name` names, if it names one: names and finite values in their order, in
/// place of the previous content; a relative path starts at the working directory of the importing tool.
///
/// # Errors
/// When the file cannot be written.
pub fn export_values(name: &'static str, file: &str, values: &[(&str, f64)]) -> Result<(), ParameterError> {
    if file.is_empty() {
        return Ok(());
    }
    fs::write(file, json(values)).map_err(|error| ParameterError {
        name,
        value: file.to_owned(),
        limit: format!("a file that can be written: {error}"),
        hint: HINT,
    })
}

/// The object, a line for each value; whole numbers without a point, as Integers of FMI are.
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
        let folder = tempfile::tempdir().unwrap();
        let (good, bad) = (folder.path().join("found.json"), folder.path().join("no/such/found.json"));
        let file = |path: &std::path::Path| {
            export_commission(path.to_str().unwrap(), &[("a", 1.5)]).map_err(|error| error.to_string())
        };
        assert_eq!(file(&good), Ok(()));
        assert_eq!(fs::read_to_string(&good).unwrap(), "{\n  \"a\": 1.5e0\n}\n");
        let message = file(&bad).unwrap_err();
        assert!(message.contains("commission.export") && message.contains("must be a file that can be written"));
        assert!(message.contains("hint: name a file in a folder that there is"), "{message}");
        assert_eq!(export_commission("", &[("a", 1.5)]), Ok(()));
    }
}
