//! `documentation/index.html`: the variable table for people.

use crate::description::cells::Cells;
use crate::description::model_description::used_types;
use crate::description::xml::Writer;
use crate::host::logger::Category;
use crate::model::{Interface, Model};
use crate::table::variable::{Role, Variable};

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
    if info.longest_step.is_finite() {
        html.element("p", &step_limit(info.longest_step));
    }
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

fn step_limit(longest: f64) -> String {
    format!(
        "A closed loop works with communication steps of up to {longest} sample periods, best with one: in a longer step \
         inputs are held for all of its samples, and of the outputs those of the last sample are seen. The first step \
         beyond that is told as a warning."
    )
}

fn section<V>(html: &mut Writer, title: &'static str, table: &[Variable<V>], roles: &[Role]) {
    if !table.iter().any(|row| roles.contains(&row.role())) {
        return;
    }
    html.element("h2", title);
    html.open("table", &[]);
    let parameters = roles.contains(&Role::Parameter);
    let more: &[&str] = if parameters { &["Paper", "Source"] } else { &[] };
    line(html, "th", &[&["Name", "Type", "Unit", "Start", "Range", "Description"], more].concat());
    for row in table.iter().filter(|row| roles.contains(&row.role())) {
        let Cells { name, kind, unit, start, range, paper, .. } = Cells::of(row);
        let more: &[&str] = if parameters { &[&paper, row.source] } else { &[] };
        line(html, "td", &[&[name.as_str(), &kind, &unit, &start, &range, row.description], more].concat());
    }
    html.close();
}

fn enumerations<V>(html: &mut Writer, table: &[Variable<V>]) {
    for ty in used_types(table) {
        html.element("h2", &format!("Enumeration {}", ty.name));
        html.element("p", ty.description);
        html.open("table", &[]);
        for (i, item) in ty.items.iter().enumerate() {
            line(html, "td", &[&(i + 1).to_string(), item.name, item.description, item.hint]);
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
