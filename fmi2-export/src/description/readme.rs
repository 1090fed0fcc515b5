//! The tables of variables in Markdown, and the test that a README holds them.

use std::fmt::Write;
use std::path::Path;

use crate::description::model_description::used_types;
use crate::model::{Interface, Model};
use crate::table::enumeration::EnumType;
use crate::table::variable::{Kind, Role, Variable};

const BEGIN: &str = "<!-- variables: made from the interface; `BLESS=1 cargo test` renews them -->\n";
const END: &str = "<!-- end of the variables -->";

/// Tables of inputs, outputs, parameters and enumerations in Markdown.
pub fn markdown<M: Model>() -> String {
    let mut text = String::new();
    for (title, roles) in [
        ("Inputs", &[Role::Input][..]),
        ("Outputs", &[Role::Output, Role::Local]),
        ("Parameters", &[Role::Parameter, Role::Tunable, Role::Calculated]),
    ] {
        section(&mut text, title, M::Vars::TABLE, roles);
    }
    for ty in used_types(M::Vars::TABLE) {
        enumeration(&mut text, ty);
    }
    text
}

/// Asserts that the README at `path` holds the tables of the model between its two marks; with `BLESS` in the
/// environment it writes them there. For a test of the crate that makes the FMU.
///
/// # Panics
/// When the file cannot be read, has no marks, or holds other tables.
pub fn assert_readme<M: Model>(path: impl AsRef<Path>) {
    let path = path.as_ref();
    let text =
        std::fs::read_to_string(path).unwrap_or_else(|error| panic!("cannot read `{}`: {error}", path.display()));
    let wanted = renewed(&text, &markdown::<M>()).unwrap_or_else(|| {
        panic!("`{}` has no place for the tables\nhint: add the lines `{}` and `{END}`", path.display(), BEGIN.trim())
    });
    if text == wanted {
        return;
    }
    assert!(
        std::env::var_os("BLESS").is_some(),
        "the tables of `{}` are not those of the interface\nhint: `BLESS=1 cargo test` renews them",
        path.display()
    );
    std::fs::write(path, wanted).unwrap_or_else(|error| panic!("cannot write `{}`: {error}", path.display()));
}

/// The text with other tables between its marks.
fn renewed(text: &str, tables: &str) -> Option<String> {
    let (head, rest) = text.split_once(BEGIN)?;
    let (_, tail) = rest.split_once(END)?;
    Some(format!("{head}{BEGIN}\n{tables}{END}{tail}"))
}

fn section<V>(text: &mut String, title: &str, table: &[Variable<V>], roles: &[Role]) {
    let rows: Vec<_> = table.iter().filter(|row| roles.contains(&row.role())).collect();
    if rows.is_empty() {
        return;
    }
    let parameters = roles.contains(&Role::Parameter);
    _ = writeln!(text, "#### {title}\n");
    text.push_str(if parameters {
        "| Name | Unit | Start | Range | Paper | Meaning | Source |\n|---|---|---|---|---|---|---|\n"
    } else {
        "| Name | Unit | Start | Meaning |\n|---|---|---|---|\n"
    });
    for row in rows {
        let Cells { name, unit, start, range, paper } = Cells::of(row);
        let meaning = escaped(row.description);
        _ = if parameters {
            writeln!(text, "| `{name}` | {unit} | {start} | {range} | {paper} | {meaning} | {} |", escaped(row.source))
        } else {
            writeln!(text, "| `{name}` | {unit} | {start} | {meaning} |")
        };
    }
    text.push('\n');
}

fn enumeration(text: &mut String, ty: &EnumType) {
    _ = writeln!(
        text,
        "#### {}\n\n{}.\n\n| Number | Item | Meaning |\n|---|---|---|",
        ty.name,
        escaped(ty.description)
    );
    for (item, number) in ty.items.iter().zip(1..) {
        let hint = if item.hint.is_empty() { String::new() } else { format!("; hint: {}", escaped(item.hint)) };
        _ = writeln!(text, "| {number} | `{}` | {}{hint} |", item.name, escaped(item.description));
    }
    text.push('\n');
}

/// What a row shows beside its texts.
#[derive(Default)]
struct Cells {
    name: String,
    unit: String,
    start: String,
    range: String,
    paper: String,
}

impl Cells {
    fn of<V>(row: &Variable<V>) -> Self {
        let name = row.size.map_or(row.name.to_owned(), |size| format!("{}[1..{size}]", row.name));
        let mut cells = Self { name, ..Self::default() };
        match &row.kind {
            Kind::Real { start, real, .. } => {
                let display = real.display.map_or(String::new(), |display| format!(" ({display})"));
                cells.unit = real.unit.map_or(String::new(), |unit| format!("{}{display}", unit.name));
                cells.start = alike(start, |x| number(*x));
                cells.range =
                    range(real.min > f64::NEG_INFINITY, number(real.min), real.max < f64::INFINITY, number(real.max));
                cells.paper = row.paper.map_or(String::new(), number);
            }
            Kind::Integer { start, min, max, .. } => {
                cells.start = alike(start, i32::to_string);
                cells.range = range(*min > i32::MIN, min.to_string(), *max < i32::MAX, max.to_string());
                cells.paper = row.paper.map_or(String::new(), number);
            }
            Kind::Boolean { start, .. } => {
                cells.start = alike(start, bool::to_string);
                cells.paper = row.paper.map_or(String::new(), |value| (value != 0.0).to_string());
            }
            Kind::Text { start, .. } => {
                let quoted = |text: &str| if text.is_empty() { String::new() } else { format!("`{}`", escaped(text)) };
                (cells.start, cells.paper) = (quoted(start), quoted(row.paper_text));
            }
            Kind::Choice { start, ty, .. } => {
                let item = |number: i32| format!("`{}`", ty.items[number as usize - 1].name);
                cells.start = item(*start);
                cells.paper = row.paper.map_or(String::new(), |value| item(value as i32));
            }
        }
        if row.role() == Role::Calculated {
            cells.start = "calculated".to_owned();
        }
        cells
    }
}

/// The values of an array, as one where they are alike.
fn alike<T: PartialEq>(values: &[T], show: impl Fn(&T) -> String) -> String {
    match values {
        [first, rest @ ..] if rest.iter().all(|value| value == first) => show(first),
        _ => values.iter().map(show).collect::<Vec<_>>().join(", "),
    }
}

/// A number with a power of ten where that is shorter.
fn number(value: f64) -> String {
    if value == 0.0 || (1e-3..1e5).contains(&value.abs()) { format!("{value}") } else { format!("{value:e}") }
}

fn range(low: bool, min: String, high: bool, max: String) -> String {
    match (low, high) {
        (true, true) => format!("{min} .. {max}"),
        (true, false) => format!(">= {min}"),
        (false, true) => format!("<= {max}"),
        (false, false) => String::new(),
    }
}

fn escaped(text: &str) -> String {
    text.replace('|', "\\|")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_tables_stand_between_the_marks_and_the_rest_stays() {
        let text = format!("head\n{BEGIN}old\n{END}\ntail\n");
        let once = renewed(&text, "new\n").unwrap();
        assert_eq!(once, format!("head\n{BEGIN}\nnew\n{END}\ntail\n"));
        assert_eq!(renewed(&once, "new\n").unwrap(), once);
        assert_eq!(renewed("no marks", "new"), None);
    }

    #[test]
    fn numbers_are_short_and_arrays_of_one_value_are_that_value() {
        assert_eq!([1e-4, 0.5, 188.0, 1e5, 0.0, -2e-6].map(number), ["1e-4", "0.5", "188", "1e5", "0", "-2e-6"]);
        assert_eq!(alike(&[13.0; 6], |x| number(*x)), "13");
        assert_eq!(alike(&[1, 2], i32::to_string), "1, 2");
        assert_eq!(range(true, "1".into(), false, String::new()), ">= 1");
    }
}
