//! The tables of variables in Markdown, and the test that a README holds them.

use std::fmt::Write;
use std::path::Path;

use crate::description::cells::Cells;
use crate::description::model_description::used_types;
use crate::model::{Interface, Model};
use crate::table::enumeration::EnumType;
use crate::table::variable::{Role, Variable};

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
        let Cells { name, unit, start, range, paper, words, .. } = Cells::of(row);
        let (start, paper) = if words { (word(&start), word(&paper)) } else { (start, paper) };
        let tunable = if row.role() == Role::Tunable { "; tunable" } else { "" };
        let meaning = format!("{}{tunable}", escaped(row.description));
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

fn word(text: &str) -> String {
    if text.is_empty() { String::new() } else { format!("`{}`", escaped(text)) }
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
}
