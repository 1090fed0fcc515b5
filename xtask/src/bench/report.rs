//! The table of results.

use anyhow::{Result, ensure};
use comfy_table::{ContentArrangement, Table, TableComponent, presets};
use serde::Serialize;

use super::statistics::Summary;

/// One line of the result.
#[derive(Serialize)]
pub struct Row {
    quantity: String,
    unit: &'static str,
    #[serde(flatten)]
    measured: Summary,
    /// Desired maximum of the measured value, in `unit`; shown in the table, not enforced. None without a goal.
    goal: Option<f64>,
}

impl Row {
    /// A quantity with its unit.
    pub fn new(quantity: impl Into<String>, unit: &'static str, measured: Summary) -> Self {
        Self { quantity: quantity.into(), unit, measured, goal: None }
    }

    /// A ratio.
    pub fn ratio(quantity: impl Into<String>, measured: Summary) -> Self {
        Self::new(quantity, "1", measured)
    }

    /// The row with a goal: the desired maximum of its value.
    pub fn goal(self, goal: f64) -> Self {
        Self { goal: Some(goal), ..self }
    }
}

/// Checks that all numbers can be what they are said to be.
///
/// # Errors
/// When one is not positive, or infinite, or no number.
pub fn check(rows: &[Row]) -> Result<()> {
    for Row { quantity, unit, measured, .. } in rows {
        for value in [measured.minimum, measured.median] {
            ensure!(value.is_finite() && value > 0.0, "`{quantity}` was measured as `{value}` {unit}");
        }
    }
    Ok(())
}

/// The rows as a table.
pub fn show(rows: &[Row]) -> String {
    let mut shown = Table::new();
    shown.load_preset(presets::UTF8_HORIZONTAL_ONLY).remove_style(TableComponent::HorizontalLines);
    shown.remove_style(TableComponent::MiddleIntersections).set_content_arrangement(ContentArrangement::Dynamic);
    shown.set_header(["quantity", "unit", "minimum", "median", "goal"]);
    for row in rows {
        shown.add_row([
            row.quantity.clone(),
            row.unit.to_owned(),
            digits(row.measured.minimum),
            digits(row.measured.median),
            row.goal.map(|goal| format!("<= {}", digits(goal))).unwrap_or_default(),
        ]);
    }
    shown.to_string()
}

/// Three digits that count, without an exponent.
fn digits(value: f64) -> String {
    let behind = (2.0 - value.abs().log10().floor()).clamp(0.0, 6.0);
    format!("{value:.*}", behind as usize)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_cannot_be_a_cost_is_refused() {
        let row = |value| [Row::new("one sample", "ns", Summary::once(value))];
        check(&row(1e-3)).unwrap();
        for value in [0.0, -1.0, f64::NAN, f64::INFINITY] {
            assert!(check(&row(value)).unwrap_err().to_string().starts_with("`one sample` was measured as"));
        }
    }

    #[test]
    fn three_digits_are_shown() {
        assert_eq!([12_345.6, 123.4, 1.234, 0.012_34].map(digits), ["12346", "123", "1.23", "0.0123"]);
    }
}
