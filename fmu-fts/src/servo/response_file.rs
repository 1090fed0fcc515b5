//! Frequency response from a JSON file, such as one written from the outputs of an earlier identification.

use std::f64::consts::{PI, TAU};
use std::path::Path;

use control_blocks::{FileParameter, ParameterError};
use nalgebra::Complex;
use serde::Deserialize;

use crate::lists::frequencies::COUNT_MAX;
use crate::servo::response::FrequencyResponse;
use crate::texts::json_table::Table;

/// The file: three lists of equal length.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct ResponseFile {
    #[serde(rename = "description", default)]
    _description: String,
    /// Hz, ascending.
    frequency_hz: Vec<f64>,
    magnitude: Vec<f64>,
    /// rad, with or without jumps of whole revolutions.
    phase_rad: Vec<f64>,
}

/// Reads the frequency response that `response.file` names.
///
/// # Errors
/// Names the file, the field, its value and the limit.
pub fn read(file: &str, resources: Option<&Path>) -> Result<FrequencyResponse, ParameterError> {
    let hint = "write {\"frequency_hz\": [20, ...], \"magnitude\": [1.05, ...], \"phase_rad\": [-0.1, ...]}";
    let file = FileParameter { name: "response.file", file, hint };
    let table = Table { file, content: "a frequency response" };
    let ResponseFile { frequency_hz, magnitude, phase_rad, .. } = table.read(resources)?;
    let count = frequency_hz.len();
    table.within(|| "number of frequencies".into(), count as f64, 1.0, COUNT_MAX as f64)?;
    table.count(|| "magnitude".into(), magnitude.len(), count)?;
    table.count(|| "phase_rad".into(), phase_rad.len(), count)?;
    let mut response = FrequencyResponse::EMPTY;
    let mut above = 0.1;
    for (i, hertz) in frequency_hz.iter().enumerate() {
        table.within(|| format!("frequency_hz[{i}]"), *hertz, above, 1e4)?;
        table.within(|| format!("magnitude[{i}]"), magnitude[i], 1e-6, 1e3)?;
        table.within(|| format!("phase_rad[{i}]"), phase_rad[i], -100.0 * PI, 100.0 * PI)?;
        response.push(TAU * hertz, Complex::from_polar(magnitude[i], phase_rad[i]));
        // the next one must be higher by a ten-thousandth
        above = hertz * 1.0001;
    }
    Ok(response)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::texts::json_table::tests::{assert_refusals, with_resource};

    fn read_text(text: &str) -> Result<FrequencyResponse, String> {
        with_resource("response.json", text, |folder| read("response.json", Some(folder)))
    }

    #[test]
    fn a_table_is_restored_with_a_phase_without_jumps() {
        let text =
            r#"{"frequency_hz": [20, 100.5, 400], "magnitude": [1.05, 1.3, 0.2], "phase_rad": [-0.1, -2.5, 2.9]}"#;
        let response = read_text(text).unwrap();
        let [a, b, c] = response.points() else { panic!("{response:?}") };
        assert!((a.frequency - TAU * 20.0).abs() < 1e-12 && (b.frequency - TAU * 100.5).abs() < 1e-12);
        assert!((a.magnitude - 1.05).abs() < 1e-15 && (a.phase + 0.1).abs() < 1e-12);
        assert!((b.phase + 2.5).abs() < 1e-12 && (c.phase - 2.9 + TAU).abs() < 1e-12);
    }

    #[test]
    fn the_example_in_the_resources_is_a_response() {
        let resources = Path::new(env!("CARGO_MANIFEST_DIR")).join("resources");
        let response = read("response.json", Some(&resources)).unwrap();
        assert_eq!(response.points().len(), 16);
        assert!(response.at(TAU * 225.0).norm() > 0.71 && response.at(TAU * 235.0).norm() < 0.70);
    }

    #[test]
    fn every_malformed_table_is_rejected_with_field_value_and_limit() {
        let file =
            |f: &str, m: &str, p: &str| format!(r#"{{"frequency_hz": {f}, "magnitude": {m}, "phase_rad": {p}}}"#);
        let many = format!("[{}]", (1..=33).map(|i| i.to_string()).collect::<Vec<_>>().join(","));
        let cases = [
            (file("[]", "[]", "[]"), "`number of frequencies` is `0`, limits `1` to `32`"),
            (file(&many, &many, &many), "`number of frequencies` is `33`"),
            (file("[20, 40]", "[1]", "[0, 0]"), "`magnitude` has `1` entries, must have `2`"),
            (file("[20, 40]", "[1, 1]", "[0]"), "`phase_rad` has `1` entries, must have `2`"),
            (file("[20, 20]", "[1, 1]", "[0, 0]"), "`frequency_hz[1]` is `20`, limits `20.00"),
            (file("[-1]", "[1]", "[0]"), "`frequency_hz[0]` is `-1`, limits `0.1` to `10000`"),
            (file("[20]", "[0]", "[0]"), "`magnitude[0]` is `0`, limits `0.000001` to `1000`"),
            (file("[20]", "[1]", "[1e6]"), "`phase_rad[0]` is `1000000`"),
            (file("[20]", "[1]", "0"), "expected a sequence at line 1 column"),
            (r#"{"frequency_hz": [20], "magnitude": [1]}"#.into(), "missing field `phase_rad` at line 1 column"),
            (r#"{"frequency_hz": [20], "gain": [1]}"#.into(), "unknown field `gain`"),
        ];
        assert_refusals(
            read_text,
            "parameter `response.file` is `response.json`, must be a frequency response: ",
            &cases,
        );
    }
}
