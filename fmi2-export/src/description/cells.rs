//! Texts of the cells of a row in a table of variables: for the documentation page and the Markdown pages.

use crate::table::units::DisplayUnit;
use crate::table::variable::{Kind, Real, Role, Variable};

/// The cells of a row, without its texts; empty where there is nothing to show.
#[derive(Default)]
pub struct Cells {
    pub name: String,
    /// Type.
    pub kind: String,
    /// Unit, and the display unit.
    pub unit: String,
    pub start: String,
    pub range: String,
    /// Value of the paper.
    pub paper: String,
    /// Start value in the display unit, where it is one number.
    pub shown: String,
    /// Start value and value of the paper are words of the interface: items and texts.
    pub words: bool,
    /// The variable is of an enumeration: `kind` is its name.
    pub is_choice: bool,
}

impl Cells {
    /// The cells of a row.
    pub fn of<V>(row: &Variable<V>) -> Self {
        let name = row.size.map_or(row.name.to_owned(), |size| format!("{}[1..{size}]", row.name));
        let mut cells = Self { name, kind: row.kind.type_name().to_owned(), ..Self::default() };
        match &row.kind {
            Kind::Real { start, real, .. } => {
                let display = real.display.map_or(String::new(), |display| format!(" ({display})"));
                let unit = unit_name(real);
                cells.unit = format!("{unit}{display}").trim_start().to_owned();
                cells.start = alike(start, |x| number(*x));
                let chosen = |display: &&DisplayUnit| real.display == Some(display.name);
                let display = real.unit.and_then(|unit| unit.display.iter().find(chosen));
                if let (Some(display), [value, rest @ ..]) = (display, *start)
                    && *value != 0.0
                    && rest.iter().all(|other| other == value)
                {
                    cells.shown = format!("{} {}", number(value * display.factor), display.name);
                }
                let (low, high) = (real.min > f64::NEG_INFINITY, real.max < f64::INFINITY);
                cells.range = range(low.then(|| number(real.min)), high.then(|| number(real.max)));
                cells.paper = row.paper.map_or(String::new(), number);
            }
            Kind::Integer { start, min, max, .. } => {
                cells.start = alike(start, i32::to_string);
                let (low, high) = (*min > i32::MIN, *max < i32::MAX);
                cells.range = range(low.then(|| min.to_string()), high.then(|| max.to_string()));
                cells.paper = row.paper.map_or(String::new(), number);
            }
            Kind::Boolean { start, .. } => {
                cells.start = alike(start, bool::to_string);
                cells.paper = row.paper.map_or(String::new(), |value| (value != 0.0).to_string());
            }
            Kind::Text { start, .. } => {
                (cells.start, cells.paper, cells.words) = ((*start).to_owned(), row.paper_text.to_owned(), true);
            }
            Kind::Choice { start, ty, .. } => {
                let item = |number: i32| ty.items[number as usize - 1].name.to_owned();
                ty.name.clone_into(&mut cells.kind);
                cells.paper = row.paper.map_or(String::new(), |value| item(value as i32));
                (cells.start, cells.words, cells.is_choice) = (item(*start), true, true);
            }
        }
        if row.role() == Role::Calculated {
            (cells.start, cells.shown) = ("calculated".to_owned(), String::new());
        }
        cells
    }
}

/// Name of the unit of a Real; that of a plain number, `1`, needs no mention.
pub fn unit_name(real: &Real) -> &'static str {
    real.unit.map(|unit| unit.name).filter(|name| *name != "1").unwrap_or_default()
}

/// The values of an array, as one where they are alike.
fn alike<T: PartialEq>(values: &[T], show: impl Fn(&T) -> String) -> String {
    match values {
        [first, rest @ ..] if rest.iter().all(|value| value == first) => show(first),
        _ => values.iter().map(show).collect::<Vec<_>>().join(", "),
    }
}

/// A number with at most 7 significant digits, and with a power of ten where that is shorter.
pub fn number(value: f64) -> String {
    let value: f64 = format!("{value:.6e}").parse().unwrap_or(value);
    if value == 0.0 || (1e-3..1e5).contains(&value.abs()) { format!("{value}") } else { format!("{value:e}") }
}

fn range(low: Option<String>, high: Option<String>) -> String {
    match (low, high) {
        (Some(low), Some(high)) => format!("{low} .. {high}"),
        (Some(low), None) => format!(">= {low}"),
        (None, Some(high)) => format!("<= {high}"),
        (None, None) => String::new(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_short_and_arrays_of_one_value_are_that_value() {
        assert_eq!([1e-4, 0.5, 188.0, 1e5, 0.0, -2e-6].map(number), ["1e-4", "0.5", "188", "1e5", "0", "-2e-6"]);
        assert_eq!(alike(&[13.0; 6], |x| number(*x)), "13");
        assert_eq!([0.1 * 3.0 * 1e3, 5e-5 * 1e6, 1e-7 * 1e9].map(number), ["300", "50", "100"]);
        assert_eq!(number(60.0 * std::f64::consts::TAU), "376.9911");
        assert_eq!(alike(&[1, 2], i32::to_string), "1, 2");
        assert_eq!(range(Some("1".into()), None), ">= 1");
    }
}
