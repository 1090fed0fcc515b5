//! Tool path from a JSON file: harmonics of the depth z(x, theta) of eq. 2 on a grid of slide positions.

use std::path::Path;

use control_blocks::{FileParameter, ParameterError};
use nalgebra::Complex;
use serde::Deserialize;

use crate::interface::Parameters;
use crate::lists::harmonics::HIGHEST;
use crate::path::depth_table::DepthTable;
use crate::texts::json_table::Table;

/// Rows of a table.
const ROWS: (f64, f64) = (3.0, 2000.0);
/// Part of the arm length that the depth may have.
const DEPTH_RATIO: f64 = 0.99;

/// The file: for each slide position the coefficients a_0, a_1, ... and b_0, b_1, ... of z.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct PathFile {
    #[serde(rename = "description", default)]
    _description: String,
    /// Slide position of the first row, m.
    slide_start_m: f64,
    /// Distance of two rows, m.
    slide_step_m: f64,
    /// a_n, m.
    cosine_m: Vec<Vec<f64>>,
    /// b_n, m; b_0 is 0.
    sine_m: Vec<Vec<f64>>,
}

/// Reads the path that `path.file` names.
///
/// # Errors
/// Names the file, the field, its value and the limit.
pub fn read(file: &str, resources: Option<&Path>, p: &Parameters) -> Result<DepthTable, ParameterError> {
    let hint = "write {\"slide_start_m\": 0.02, \"slide_step_m\": 5e-4, \"cosine_m\": [[a_0, a_1, ...], ...], \
               \"sine_m\": [[0, b_1, ...], ...]}, one row for each slide position";
    let table = Table { file: FileParameter { name: "path.file", file, hint }, content: "a tool path" };
    let content: PathFile = table.read(resources)?;
    table.within(|| "slide_start_m".into(), content.slide_start_m, -10.0, 10.0)?;
    table.within(|| "slide_step_m".into(), content.slide_step_m, 1e-6, 0.1)?;
    table.within(|| "number of rows in cosine_m".into(), content.cosine_m.len() as f64, ROWS.0, ROWS.1)?;
    table.count(|| "sine_m".into(), content.sine_m.len(), content.cosine_m.len())?;
    let harmonics = content.cosine_m[0].len();
    table.within(|| "number of entries in cosine_m[0]".into(), harmonics as f64, 1.0, HIGHEST as f64 + 1.0)?;
    let depth_max = DEPTH_RATIO * p.tool.arm_length[p.tool.index()];
    let row = |i: usize| row(&table, &content, i, harmonics, depth_max);
    let rows = (0..content.cosine_m.len()).map(row).collect::<Result<_, _>>()?;
    Ok(DepthTable { first: content.slide_start_m, step: content.slide_step_m, rows, truncation: 0.0 })
}

/// c_n = a_n - j b_n of row `i`, checked.
fn row(
    table: &Table,
    content: &PathFile,
    i: usize,
    harmonics: usize,
    depth_max: f64,
) -> Result<Vec<Complex<f64>>, ParameterError> {
    let (cosine, sine) = (&content.cosine_m[i], &content.sine_m[i]);
    table.count(|| format!("cosine_m[{i}]"), cosine.len(), harmonics)?;
    table.count(|| format!("sine_m[{i}]"), sine.len(), harmonics)?;
    for (n, (a, b)) in cosine.iter().zip(sine).enumerate() {
        // sin(0 theta) is nothing
        let (low, high) = if n == 0 { (0.0, 0.0) } else { (-depth_max, depth_max) };
        table.within(|| format!("cosine_m[{i}][{n}]"), *a, -depth_max, depth_max)?;
        table.within(|| format!("sine_m[{i}][{n}]"), *b, low, high)?;
    }
    let row: Vec<_> = cosine.iter().zip(sine).map(|(a, b)| Complex::new(*a, -b)).collect();
    let depth = row[0].re.abs() + row[1..].iter().map(|c| c.norm()).sum::<f64>();
    table.within(|| format!("largest depth of row {i}, m"), depth, 0.0, depth_max)?;
    Ok(row)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::texts::json_table::tests::{assert_refusals, with_resource};

    fn read_text(text: &str) -> Result<DepthTable, String> {
        with_resource("path.json", text, |folder| read("path.json", Some(folder), &Parameters::START))
    }

    fn file(start: &str, step: &str, cosine: &str, sine: &str) -> String {
        format!(r#"{{"slide_start_m": {start}, "slide_step_m": {step}, "cosine_m": {cosine}, "sine_m": {sine}}}"#)
    }

    #[test]
    fn a_table_is_restored() {
        let cosine = "[[1e-3, 0, 2e-3], [1e-3, 0, 3e-3], [1e-3, 0, 4e-3]]";
        let sine = "[[0, 1e-4, 0], [0, 2e-4, 0], [0, 3e-4, 0]]";
        let table = read_text(&file("0.02", "0.5e-3", cosine, sine)).unwrap();
        assert_eq!((table.first, table.step, table.rows.len()), (0.02, 0.5e-3, 3));
        // z = a cos + b sin = Re (a - j b) e^(j n theta)
        assert_eq!(table.rows[1], [Complex::new(1e-3, 0.0), Complex::new(0.0, -2e-4), Complex::new(3e-3, 0.0)]);
    }

    #[test]
    fn every_malformed_table_is_rejected_with_field_value_and_limit() {
        let (good, zero) = ("[[0, 1e-3], [0, 1e-3], [0, 1e-3]]", "[[0, 0], [0, 0], [0, 0]]");
        let long = format!("[[{}]", vec!["0"; 66].join(","));
        let cases = [
            (file("99", "5e-4", good, zero), "`slide_start_m` is `99`, limits `-10` to `10`"),
            (file("0", "0", good, zero), "`slide_step_m` is `0`, limits `0.000001` to `0.1`"),
            (
                file("0", "5e-4", "[[0], [0]]", "[[0], [0]]"),
                "`number of rows in cosine_m` is `2`, limits `3` to `2000`",
            ),
            (file("0", "5e-4", good, "[[0, 0]]"), "`sine_m` has `1` entries, must have `3`"),
            (file("0", "5e-4", "[[], [], []]", "[[], [], []]"), "`number of entries in cosine_m[0]` is `0`"),
            (
                file("0", "5e-4", &format!("{long}, [0], [0]]"), zero),
                "`number of entries in cosine_m[0]` is `66`, limits `1` to `65`",
            ),
            (file("0", "5e-4", "[[0, 0], [0], [0, 0]]", zero), "`cosine_m[1]` has `1` entries, must have `2`"),
            (file("0", "5e-4", good, "[[0, 0], [0, 0], [0]]"), "`sine_m[2]` has `1` entries, must have `2`"),
            (
                file("0", "5e-4", good, "[[0, 0], [1e-9, 0], [0, 0]]"),
                "`sine_m[1][0]` is `0.000000001`, limits `0` to `0`",
            ),
            (
                file("0", "5e-4", "[[0, 0], [0, 0], [0, 0.2]]", zero),
                "`cosine_m[2][1]` is `0.2`, limits `-0.0792` to `0.0792`",
            ),
            (
                file("0", "5e-4", "[[0.05, 0.05], [0, 0], [0, 0]]", zero),
                "`largest depth of row 0, m` is `0.1`, limits `0` to `0.0792`",
            ),
            (file("0", "5e-4", good, "null"), "invalid type: null, expected a sequence at line 1 column"),
            (r#"{"slide_start_m": 0}"#.into(), "missing field `slide_step_m` at line 1 column 20"),
            (r#"{"slide_start_m": 0, "x": 1}"#.into(), "unknown field `x`"),
        ];
        assert_refusals(read_text, "parameter `path.file` is `path.json`, must be a tool path: ", &cases);
    }

    #[test]
    fn a_surface_written_as_a_file_is_the_same_path() {
        let p = Parameters::START;
        let table = DepthTable::of_surface(&p).unwrap();
        let list = |part: fn(&Complex<f64>) -> f64| {
            let row = |row: &Vec<Complex<f64>>| row.iter().map(part).collect::<Vec<_>>();
            serde_json::to_string(&table.rows.iter().map(row).collect::<Vec<_>>()).unwrap()
        };
        let (cosine, sine) = (list(|c| c.re), list(|c| if c.im == 0.0 { 0.0 } else { -c.im }));
        let back = read_text(&file(&table.first.to_string(), &table.step.to_string(), &cosine, &sine)).unwrap();
        assert_eq!((back.first, back.step), (table.first, table.step));
        let pairs = table.rows.iter().flatten().zip(back.rows.iter().flatten());
        assert!(pairs.into_iter().all(|(a, b)| (a - b).norm() < 1e-18));
    }
}
