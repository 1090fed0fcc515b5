//! Tables for people, and numbers as people write them.

use comfy_table::{ContentArrangement, Table, TableComponent, presets};

/// An empty table with these column names; as wide as the terminal, or as it needs to be when there is none.
pub fn new(columns: &[&str]) -> Table {
    let mut table = Table::new();
    table.load_preset(presets::UTF8_HORIZONTAL_ONLY).remove_style(TableComponent::HorizontalLines);
    table.remove_style(TableComponent::MiddleIntersections);
    table.set_content_arrangement(ContentArrangement::Dynamic).set_header(columns.iter().copied());
    table
}

/// A number with three digits and its unit, with the SI prefix that fits: 4.5e-7 m is `450 nm`.
pub fn quantity(value: f64, unit: &str) -> String {
    if unit.is_empty() || unit == "1" {
        return digits(value);
    }
    if value == 0.0 || !value.is_finite() || !takes_prefix(unit) {
        return format!("{} {unit}", digits(value));
    }
    // the prefix is chosen after rounding: 999.9e-9 m is 1 um
    let rounded = format!("{value:.2e}").parse().unwrap_or(value);
    let exponent = (f64::abs(rounded).log10().floor() as i32).div_euclid(3) * 3;
    let Some((_, prefix)) = PREFIXES.iter().find(|(power, _)| *power == exponent) else {
        return format!("{value:.2e} {unit}");
    };
    format!("{} {prefix}{unit}", digits(rounded / 10_f64.powi(exponent)))
}

const PREFIXES: [(i32, &str); 9] =
    [(-12, "p"), (-9, "n"), (-6, "u"), (-3, "m"), (0, ""), (3, "k"), (6, "M"), (9, "G"), (12, "T")];

// kg has a prefix already; m2 and 1/s would change their meaning; rpm, % and degrees take none
fn takes_prefix(unit: &str) -> bool {
    let first = unit.split('/').next().unwrap_or_default();
    matches!(first, "m" | "s" | "N" | "A" | "Hz" | "V" | "W" | "J" | "Pa")
}

fn digits(value: f64) -> String {
    if value != 0.0 && !(1e-3..1e6).contains(&value.abs()) {
        return format!("{value:.2e}");
    }
    let before = (value.abs().max(1e-3).log10().floor() as i32) + 1;
    let text = format!("{value:.*}", usize::try_from(3 - before).unwrap_or(0));
    if text.contains('.') { text.trim_end_matches('0').trim_end_matches('.').to_owned() } else { text }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lengths_forces_and_times_take_a_prefix() {
        assert_eq!(quantity(4.5e-7, "m"), "450 nm");
        assert_eq!(quantity(-2.1e-7, "m"), "-210 nm");
        assert_eq!(quantity(999.9e-9, "m"), "1 um");
        assert_eq!(quantity(0.0213, "N/s"), "21.3 mN/s");
        assert_eq!(quantity(1.0, "s"), "1 s");
        assert_eq!(quantity(36_000.0, "s"), "36 ks");
    }

    #[test]
    fn other_units_are_left_as_they_are() {
        assert_eq!(quantity(0.013, "kg"), "0.013 kg");
        assert_eq!(quantity(7.0, "1"), "7");
        assert_eq!(quantity(0.0, "m"), "0 m");
        assert_eq!(quantity(1234.0, "rad/s"), "1234 rad/s");
        assert_eq!(quantity(f64::NAN, "m"), "NaN m");
        assert_eq!(quantity(0.9987, ""), "0.999");
    }
}
