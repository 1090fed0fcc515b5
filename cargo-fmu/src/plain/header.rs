//! The header of a controller.

use std::fmt::Write as _;

use anyhow::{Result, bail};

use super::members::{declare, path};
use super::template::{comment, fill};
use crate::interface::{COMPUTED, Choice, Interface, Part, Type};

const TEMPLATE: &str = include_str!("header.h");

/// Other names with the identifier as their prefix, in addition to the functions for texts and the enumerations.
const TAKEN: [&str; 14] = [
    "new",
    "free",
    "step",
    "read",
    "period",
    "tune",
    "save",
    "restore",
    "start_parameters",
    "start_inputs",
    "inputs",
    "outputs",
    "parameters",
    "on_message",
];

/// The header.
///
/// # Errors
/// When a variable cannot be a member of a struct, or a text not be asked for by its name.
pub fn write(interface: &Interface) -> Result<String> {
    let identifier = &interface.identifier;
    // a text is asked for by itself: to hand it out allocates
    let outputs = interface.of(COMPUTED).filter(|variable| variable.kind != Type::Text);
    let tunable: Vec<_> = interface.of(&[Part::Tunable]).map(|variable| path(&variable.name)).collect();
    let tunable = if tunable.is_empty() { " none".to_owned() } else { listed(&tunable) };
    Ok(fill(
        TEMPLATE,
        interface,
        &[
            ("name", &comment(&interface.name)),
            ("description", &comment(&interface.description)),
            ("choices", &interface.choices.iter().map(choice).collect::<String>()),
            ("inputs", &declare(identifier, interface.of(&[Part::Input]))?),
            ("outputs", &declare(identifier, outputs)?),
            ("parameters", &declare(identifier, interface.of(&[Part::Fixed, Part::Tunable]))?),
            ("tunable", &tunable),
            ("texts", &texts(interface)?),
        ],
    ))
}

fn choice(choice: &Choice) -> String {
    let name = &choice.name;
    let mut text = format!("/** {} */\ntypedef enum {{\n", comment(&choice.description));
    for ((item, description), number) in choice.items.iter().zip(1..) {
        _ = writeln!(text, "    /** {} */\n    @id@_{name}_{item} = {number},", comment(description));
    }
    text + &format!("}} @id@_{name};\n\n")
}

fn texts(interface: &Interface) -> Result<String> {
    let mut declared = String::new();
    let mut taken: Vec<_> = TAKEN.iter().map(|name| (*name).to_owned()).collect();
    taken.extend(interface.choices.iter().map(|choice| choice.name.clone()));
    for variable in interface.of(COMPUTED).filter(|variable| variable.kind == Type::Text) {
        let description = comment(&variable.description);
        let name = function(&variable.name);
        if name.contains('[') {
            bail!("`{}` cannot be a function of C: it is an element of an array", variable.name);
        }
        if taken.contains(&name) {
            bail!("`{}` cannot be a function of C: its name is also that of another one or of a type", variable.name);
        }
        _ = write!(
            declared,
            "/** {description}. Lives until the next call with this controller; allocates. */\nconst char *@id@_{name}(@id@ *self);\n\n"
        );
        taken.push(name);
    }
    Ok(declared)
}

/// The name of the function for a text, after the identifier.
pub fn function(name: &str) -> String {
    name.replace('.', "_")
}

/// Names, a few in each line of a comment.
fn listed(names: &[String]) -> String {
    let lines: Vec<_> = names.chunks(4).map(|names| names.join(", ")).collect();
    format!("\n * {}", lines.join(",\n * "))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::interface::Quantity;
    use crate::interface::tests::{interface, real};

    #[test]
    fn a_text_that_cannot_be_a_function_is_refused_by_name() {
        let text = |name: &&str| Quantity { kind: Type::Text, role: Part::Output, ..real(name) };
        let header = |names: &[&str]| write(&interface(names.iter().map(text)));
        assert!(header(&["bank.message"]).unwrap().contains("const char *m_bank_message(m *self);"));
        for names in [&["step"][..], &["on_message"], &["words[1]"], &["a.b", "a_b"]] {
            let error = header(names).unwrap_err().to_string();
            assert!(error.starts_with(&format!("`{}` cannot be a function", names[names.len() - 1])), "{error}");
        }
    }
}
