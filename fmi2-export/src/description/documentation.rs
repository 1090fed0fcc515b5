//! `documentation/index.html`: the variable table for people.

use crate::description::model_description::used_types;
use crate::description::xml::Writer;
use crate::host::logger::Category;
use crate::model::{Interface, Model};
use crate::table::variable::{Kind, Role, Variable};

const STYLE: &str = "body{font-family:sans-serif;margin:2em;max-width:75em}\
table{border-collapse:collapse}td,th{border:1px solid silver;padding:.2em .6em;text-align:left;vertical-align:top}";

const TIMING: [&str; 3] = [
    "The controller samples at start time + n periods, whatever the communication step: a step [t, t + h) runs every \
     sample that lies in it, with the inputs set at t. Outputs are held between samples.",
    "Read the outputs after fmi2DoStep and apply them from t on, and the loop has no delay beside the sampling; a \
     master that applies them at t + h adds one communication step.",
    "Real inputs may be given with their derivatives of any order (fmi2SetRealInputDerivatives); they are extrapolated \
     to the samples inside the step.",
];

/// The whole page.
pub fn write<M: Model>() -> String {
    let info = M::INFO;
    let mut html = Writer::new("<!DOCTYPE html>");
    html.open("html", &[("lang", "en")]);
    html.open("head", &[]);
    html.empty("meta", &[("charset", "utf-8")]);
    html.element("title", info.name);
    html.element("style", STYLE);
    html.close();
    html.open("body", &[]);
    html.element("h1", info.name);
    html.element("p", info.description);
    let facts = [("Version", info.version), ("Licence:", info.license)];
    let facts = facts.iter().filter(|(_, fact)| !fact.is_empty()).map(|(what, fact)| format!("{what} {fact}."));
    html.element("p", &facts.collect::<Vec<_>>().join(" "));
    html.element("h2", "Timing");
    TIMING.iter().for_each(|text| html.element("p", text));
    for (title, roles) in [
        ("Inputs", &[Role::Input][..]),
        ("Outputs", &[Role::Output]),
        ("Parameters", &[Role::Parameter, Role::Tunable, Role::Calculated]),
        ("Local variables", &[Role::Local]),
    ] {
        section(&mut html, title, M::Vars::TABLE, roles);
    }
    enumerations(&mut html, M::Vars::TABLE);
    categories(&mut html);
    html.finish()
}

fn section<V>(html: &mut Writer, title: &'static str, table: &[Variable<V>], roles: &[Role]) {
    if !table.iter().any(|row| roles.contains(&row.role())) {
        return;
    }
    html.element("h2", title);
    html.open("table", &[]);
    line(html, "th", &["Name", "Type", "Unit", "Start", "Range", "Description"]);
    for row in table.iter().filter(|row| roles.contains(&row.role())) {
        variable(html, row);
    }
    html.close();
}

fn variable<V>(html: &mut Writer, row: &Variable<V>) {
    let name = row.size.map_or(row.name.to_owned(), |size| format!("{}[1..{size}]", row.name));
    let (kind, unit, start, range) = match &row.kind {
        Kind::Real { start, real, .. } => {
            let unit = real.unit.map_or("", |unit| unit.name);
            ("Real", unit, list(start), span(real.min, real.max, f64::NEG_INFINITY, f64::INFINITY))
        }
        Kind::Integer { start, min, max, .. } => ("Integer", "", list(start), span(*min, *max, i32::MIN, i32::MAX)),
        Kind::Boolean { start, .. } => ("Boolean", "", list(start), String::new()),
        Kind::Text { start, .. } => ("String", "", (*start).to_owned(), String::new()),
        Kind::Choice { start, ty, .. } => (ty.name, "", ty.items[*start as usize - 1].name.to_owned(), String::new()),
    };
    let (start, kind) = match row.role() {
        Role::Calculated => ("calculated", kind.to_owned()),
        Role::Tunable => (start.as_str(), format!("{kind}, tunable")),
        _ => (start.as_str(), kind.to_owned()),
    };
    line(html, "td", &[&name, &kind, unit, start, &range, row.description]);
}

fn enumerations<V>(html: &mut Writer, table: &[Variable<V>]) {
    for ty in used_types(table) {
        html.element("h2", &format!("Enumeration {}", ty.name));
        html.element("p", ty.description);
        html.open("table", &[]);
        for (i, item) in ty.items.iter().enumerate() {
            line(html, "td", &[&(i + 1).to_string(), item.name, item.description]);
        }
        html.close();
    }
}

fn categories(html: &mut Writer) {
    html.element("h2", "Log categories");
    html.open("table", &[]);
    Category::ALL.iter().for_each(|category| line(html, "td", &[category.name(), category.description()]));
    html.close();
}

fn line(html: &mut Writer, cell: &'static str, texts: &[&str]) {
    html.open("tr", &[]);
    texts.iter().for_each(|text| html.element(cell, text));
    html.close();
}

fn list<T: ToString>(values: &[T]) -> String {
    values.iter().map(T::to_string).collect::<Vec<_>>().join(", ")
}

fn span<T: PartialEq + ToString>(min: T, max: T, lowest: T, highest: T) -> String {
    match (min == lowest, max == highest) {
        (true, true) => String::new(),
        (true, false) => format!("<= {}", max.to_string()),
        (false, true) => format!(">= {}", min.to_string()),
        (false, false) => format!("{} .. {}", min.to_string(), max.to_string()),
    }
}
