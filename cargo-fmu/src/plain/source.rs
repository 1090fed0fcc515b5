//! The C code between the header and the functions of FMI.

use std::fmt::Write as _;

use super::header::function;
use super::members::path;
use super::template::{fill, literal};
use crate::interface::{COMPUTED, Interface, Part, Quantity, Type};

const TEMPLATE: &str = include_str!("adapter.c");

/// A type that functions of FMI are for: its name there, its type in C, and which variables are of it.
type Passed = (&'static str, &'static str, fn(&Type) -> bool);

const TYPES: [Passed; 3] = [
    ("Real", "double", |kind| *kind == Type::Real),
    ("Integer", "int", |kind| matches!(kind, Type::Integer | Type::Choice(_))),
    ("Boolean", "int", |kind| *kind == Type::Boolean),
];

/// The code.
pub fn write(interface: &Interface) -> String {
    let period = interface.variables.iter().find(|variable| variable.name == "sample_period");
    let period = match period {
        Some(Quantity { reference, .. }) => format!(
            "    const unsigned period = {reference};\n    \
             if (!DONE(fmi2GetReal(self->instance, &period, 1, &self->period))) return false;\n"
        ),
        None => format!("    self->period = {};\n", interface.step),
    };
    fill(
        TEMPLATE,
        interface,
        &[
            ("period", &period),
            ("set_fixed", &set_each(interface, &[Part::Fixed])),
            ("set_tunable", &set_each(interface, &[Part::Tunable])),
            ("set_inputs", &set_inputs(interface)),
            ("read", &read(interface)),
            ("start_parameters", &start("p", interface.of(&[Part::Fixed, Part::Tunable]))),
            ("start_inputs", &start("in", interface.of(&[Part::Input]))),
            ("texts", &texts(interface)),
        ],
    )
}

/// Each parameter that differs from the value it has.
fn set_each(interface: &Interface, parts: &'static [Part]) -> String {
    let set = interface.of(parts).map(|Quantity { name, reference, kind, .. }| {
        let kind = match kind {
            Type::Real => "real",
            Type::Integer | Type::Choice(_) => "integer",
            Type::Boolean => "boolean",
            Type::Text => "text",
        };
        format!(" &&\n           set_{kind}(c, {reference}, p->{})", path(name))
    });
    set.collect()
}

/// All inputs of a type in one call.
fn set_inputs(interface: &Interface) -> String {
    let mut text = String::new();
    for (fmi, c, is_of) in TYPES {
        let inputs: Vec<_> = interface.of(&[Part::Input]).filter(|input| is_of(&input.kind)).collect();
        let values = inputs.iter().map(|input| format!("in->{}", path(&input.name))).collect::<Vec<_>>().join(", ");
        if inputs.is_empty() {
            continue;
        }
        let (count, lower, references) = (inputs.len(), fmi.to_lowercase(), references(&inputs));
        _ = write!(
            text,
            "    static const unsigned {lower}[] = {{{references}}};\n    const {c} {lower}_values[] = {{{values}}};\n    \
             if (!DONE(fmi2Set{fmi}(c, {lower}, {count}, {lower}_values))) return false;\n"
        );
    }
    let texts = interface.of(&[Part::Input]).filter(|input| input.kind == Type::Text);
    for Quantity { name, reference, .. } in texts {
        _ = writeln!(text, "    if (!set_text(c, {reference}, in->{})) return false;", path(name));
    }
    text
}

/// All outputs of a type in one call.
fn read(interface: &Interface) -> String {
    let (mut get, mut take) = (String::new(), String::new());
    for (fmi, c, is_of) in TYPES {
        let outputs: Vec<_> = interface.of(COMPUTED).filter(|output| is_of(&output.kind)).collect();
        if outputs.is_empty() {
            continue;
        }
        let (count, lower, references) = (outputs.len(), fmi.to_lowercase(), references(&outputs));
        _ = write!(
            get,
            "    static const unsigned {lower}[] = {{{references}}};\n    {c} {lower}_values[{count}];\n    \
             if (!DONE(fmi2Get{fmi}(c, {lower}, {count}, {lower}_values))) return false;\n"
        );
        for (i, output) in outputs.iter().enumerate() {
            let value = match &output.kind {
                Type::Choice(name) => format!("(@id@_{name}){lower}_values[{i}]"),
                Type::Boolean => format!("{lower}_values[{i}] != 0"),
                _ => format!("{lower}_values[{i}]"),
            };
            _ = writeln!(take, "    out->{} = {value};", path(&output.name));
        }
    }
    get + &take
}

fn start<'a>(of: &str, variables: impl Iterator<Item = &'a Quantity>) -> String {
    let lines = variables.map(|variable| {
        let value = match &variable.kind {
            Type::Text => literal(&variable.start),
            Type::Choice(name) => format!("(@id@_{name}){}", variable.start),
            _ => variable.start.clone(),
        };
        format!("    {of}->{} = {value};\n", path(&variable.name))
    });
    lines.collect()
}

fn texts(interface: &Interface) -> String {
    let texts = interface.of(COMPUTED).filter(|variable| variable.kind == Type::Text);
    let functions = texts.map(|Quantity { name, reference, .. }| {
        format!(
            "\nconst char *@id@_{}(@id@ *self) {{\n    const unsigned reference = {reference};\n    const char *text = \"\";\n    \
             fmi2GetString(self->instance, &reference, 1, &text);\n    return text;\n}}\n",
            function(name)
        )
    });
    functions.collect()
}

fn references(variables: &[&Quantity]) -> String {
    variables.iter().map(|variable| variable.reference.to_string()).collect::<Vec<_>>().join(", ")
}
