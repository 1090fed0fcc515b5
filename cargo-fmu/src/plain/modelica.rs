//! A block of Modelica that runs the controller by its C library, and the C code between the two.

use std::collections::HashMap;
use std::fmt::Write as _;

use anyhow::{Result, bail};

use super::members::path;
use super::template::fill;
use crate::interface::{COMPUTED, Choice, Interface, Part, Quantity, Type};

const TEMPLATE: &str = include_str!("modelica.h");

/// Words of the language, and names that the equations of a block use; a variable with such a name gets a `_` at its end.
const TAKEN: &str = "algorithm and annotation block break class connect connector constant constrainedby der discrete each \
    else elseif elsewhen encapsulated end enumeration equation expandable extends external false final flow for function if \
    import impure in initial inner input loop model not operator or outer output package parameter partial protected public \
    pure record redeclare replaceable return stream then true type when while within \
    fill sample step time Boolean Controller ExternalObject Integer Real String";

/// Names in a block in addition to its variables and enumerations.
const OWN: [&str; 5] = ["controller_", "reals_", "integers_", "resources", "step"];

const PARAMETERS: &[Part] = &[Part::Fixed, Part::Tunable];
const INPUTS: &[Part] = &[Part::Input];
const OUTPUTS: &[Part] = &[Part::Output];
const LOCALS: &[Part] = &[Part::Local];

/// Prefix of the names of parameters for specialists, which get a tab of their own in the dialog.
const EXPERT: &str = "expert.";

/// Width of the icon's half, and the height of a port, in the units of the diagram.
const HALF: usize = 100;
const ROOM: usize = 20;

/// The C code, `<identifier>_modelica.h`.
pub fn adapter(interface: &Interface) -> String {
    let take = |parts, of: &str, from: &[&str]| {
        let lines = interface.split(parts).into_iter().zip(from).flat_map(|(variables, from)| {
            variables.into_iter().enumerate().map(move |(i, variable)| {
                let cast = match &variable.kind {
                    Type::Choice(name) => format!("(@id@_{name})"),
                    _ => String::new(),
                };
                format!("    {of}.{} = {cast}{from}[{i}];\n", path(&variable.name))
            })
        });
        lines.collect::<String>()
    };
    let give = interface.split(COMPUTED).into_iter().zip(["reals", "integers"]).flat_map(|(variables, to)| {
        let give = |(i, variable): (usize, &Quantity)| format!("    {to}[{i}] = out.{};\n", path(&variable.name));
        variables.into_iter().enumerate().map(give).collect::<Vec<_>>()
    });
    let outputs = give.collect::<String>();
    fill(
        TEMPLATE,
        interface,
        &[
            ("parameters", &take(PARAMETERS, "p", &["reals", "integers", "texts"])),
            ("inputs", &take(INPUTS, "in", &["reals_in", "integers_in"])),
            ("outputs", &outputs),
        ],
    )
}

/// The block, a class of `package`; `starts` are start values of the named parameters.
///
/// # Errors
/// When two variables would have one name, one has that of something else, or an input is a String.
pub fn block(interface: &Interface, package: &str, starts: &[(&str, &str)]) -> Result<String> {
    check(interface, package)?;
    let mut text = format!(
        "within {package};\nblock {} {}\n",
        interface.name,
        literal(interface.description.trim_end_matches('.'))
    );
    interface.choices.iter().for_each(|choice| text += &enumeration(choice));
    interface.of(PARAMETERS).for_each(|variable| text += &parameter(variable, starts));
    if names_files(interface) {
        text += "  parameter String resources = \"\" \"Folder of the files that parameters name; empty for the working directory\" \
                 annotation (Dialog(group = \"General\"));\n";
    }
    let height = ports(&mut text, interface, package);
    text += &object(interface, package);
    text += &equations(interface);
    _ = write!(
        text,
        "  annotation (\n    Icon(coordinateSystem(extent = {{{{-{HALF}, -{height}}}, {{{HALF}, {height}}}}}), graphics = {{\n      \
         Rectangle(extent = {{{{-{HALF}, {height}}}, {{{HALF}, -{height}}}}}, lineColor = {{0, 0, 127}}, fillColor = {{255, 255, 255}}, fillPattern = FillPattern.Solid),\n      \
         Text(extent = {{{{-150, {}}}, {{150, {}}}}}, textColor = {{0, 0, 255}}, textString = \"%name\")}}),\n    \
         Documentation(info = {}));\nend {};\n",
        height + 50,
        height + 10,
        literal(&documentation(interface)),
        interface.name
    );
    Ok(text)
}

/// A block of these variables can be read, and each of them has a unique name.
fn check(interface: &Interface, package: &str) -> Result<()> {
    let own = OWN.iter().map(|own| ((*own).to_owned(), "the block's own"));
    let mut names: HashMap<_, _> = own.chain([(package.to_owned(), "the package")]).collect();
    for choice in &interface.choices {
        if word(&choice.name) != choice.name || names.insert(choice.name.clone(), &choice.name).is_some() {
            bail!(
                "the enumeration `{0}` cannot be in a block of Modelica: `{0}` means something else there",
                choice.name
            );
        }
    }
    for variable in &interface.variables {
        if variable.role == Part::Input && variable.kind == Type::Text {
            bail!("`{}` cannot be an input of a block of Modelica: it is a String", variable.name);
        }
        if let Some(other) = names.insert(name(variable), &variable.name) {
            bail!("`{other}` and `{}` have one name in Modelica, `{}`", variable.name, name(variable));
        }
    }
    Ok(())
}

/// Whether a parameter may name a file: it is a String.
fn names_files(interface: &Interface) -> bool {
    interface.of(PARAMETERS).any(|variable| variable.kind == Type::Text)
}

fn enumeration(choice: &Choice) -> String {
    let items = choice.items.iter().map(|(item, description)| format!("    {} {}", word(item), literal(description)));
    let items = items.collect::<Vec<_>>().join(",\n");
    format!("  type {} = enumeration(\n{items}) {};\n", choice.name, literal(&choice.description))
}

fn parameter(variable: &Quantity, starts: &[(&str, &str)]) -> String {
    let kind = match &variable.kind {
        Type::Choice(name) => name.clone(),
        Type::Text => "String".to_owned(),
        kind => format!("{kind:?}"),
    };
    let given = starts.iter().find(|(name, _)| *name == variable.name).map(|(_, start)| *start);
    let start = match &variable.kind {
        Type::Choice(name) => format!("{name}.{}", word(given.unwrap_or(&variable.item))),
        Type::Text => literal(given.unwrap_or(&variable.start)),
        _ => given.unwrap_or(&variable.start).to_owned(),
    };
    let (tab, rest) =
        variable.name.strip_prefix(EXPERT).map_or(("", &*variable.name), |rest| ("tab = \"Expert\", ", rest));
    let group = rest.rsplit_once('.').map_or("General", |(group, _)| group);
    format!(
        "  parameter {kind} {}{} = {start} {} annotation (Dialog({tab}group = \"{group}\"));\n",
        name(variable),
        unit(variable),
        literal(&variable.description)
    )
}

/// The connectors, and the local variables; returns half of the block's height.
fn ports(text: &mut String, interface: &Interface, package: &str) -> usize {
    let sides = [(INPUTS, "Input", HALF as isize + ROOM as isize, -1), (OUTPUTS, "Output", HALF as isize + 10, 1)];
    let rows = |parts| interface.of(parts).filter(|variable| variable.kind != Type::Text).count();
    let height = (ROOM * rows(INPUTS).max(rows(OUTPUTS))).max(2 * HALF) / 2;
    for (parts, direction, x, side) in sides {
        let variables = interface.of(parts).filter(|variable| variable.kind != Type::Text);
        for (variable, y) in variables.zip((0..).map(|row| height as isize - ROOM as isize / 2 - row * ROOM as isize)) {
            let kind = value_type(variable);
            let (near, far) = (x * side - 10, x * side + 10);
            _ = writeln!(
                text,
                "  {package}.Interfaces.{kind}{direction} {}{} {} annotation (Placement(transformation(extent = {{{{{near}, {}}}, {{{far}, {}}}}})));",
                name(variable),
                unit(variable),
                literal(&variable.description),
                y - 10,
                y + 10
            );
        }
    }
    for variable in interface.of(LOCALS).filter(|variable| variable.kind != Type::Text) {
        let (kind, name, unit) = (value_type(variable), name(variable), unit(variable));
        _ = writeln!(text, "  {kind} {name}{unit} {};", literal(&variable.description));
    }
    height
}

/// The type of a variable whose items are numbers.
fn value_type(variable: &Quantity) -> &'static str {
    match &variable.kind {
        Type::Real => "Real",
        Type::Boolean => "Boolean",
        _ => "Integer",
    }
}

/// The controller as an external object, and its sample as a function.
fn object(interface: &Interface, package: &str) -> String {
    let [reals, integers, texts] = interface.split(PARAMETERS).map(|variables| variables.len());
    let [reals_in, integers_in, _] = interface.split(INPUTS).map(|variables| variables.len());
    let [reals_out, integers_out, _] = interface.split(COMPUTED).map(|variables| variables.len());
    let identifier = &interface.identifier;
    let annotation = format!(
        "annotation (\n        Include = \"#include \\\"{identifier}_modelica.h\\\"\", Library = {{\"{identifier}\", \"m\"}},\n        \
         IncludeDirectory = \"modelica://{package}/Resources/Include\",\n        \
         LibraryDirectory = \"modelica://{package}/Resources/Library\")"
    );
    format!(
        "  class Controller \"State of the controller\"\n    extends ExternalObject;\n    \
         function constructor\n      input Real reals[{reals}];\n      input Integer integers[{integers}];\n      input String texts[{texts}];\n      input String resources;\n      \
         output Controller controller;\n      external \"C\" controller = {identifier}_modelica_new(reals, integers, texts, resources) {annotation};\n    end constructor;\n    \
         function destructor\n      input Controller controller;\n      external \"C\" {identifier}_modelica_free(controller) {annotation};\n    end destructor;\n  end Controller;\n  \
         impure function step \"One sample\"\n    input Controller controller;\n    input Real realsIn[{reals_in}];\n    input Integer integersIn[{integers_in}];\n    \
         output Real reals[{reals_out}];\n    output Integer integers[{integers_out}];\n    \
         external \"C\" {identifier}_modelica_step(controller, realsIn, integersIn, reals, integers) {annotation};\n  end step;\n"
    )
}

fn equations(interface: &Interface) -> String {
    // an array of nothing has no type of its own
    let some = |list: String, nothing: &str| if list == "{}" { format!("fill({nothing}, 0)") } else { list };
    let [reals, integers, texts] = interface.split(PARAMETERS).map(list);
    let (reals, integers, texts) = (some(reals, "0.0"), some(integers, "0"), some(texts, "\"\""));
    let [reals_in, integers_in, _] = interface.split(INPUTS).map(list);
    let (reals_in, integers_in) = (some(reals_in, "0.0"), some(integers_in, "0"));
    let [outputs, numbers, _] = interface.split(COMPUTED);
    let period = interface.variables.iter().find(|variable| variable.name == "sample_period").map(name);
    let resources = if names_files(interface) { "resources" } else { "\"\"" };
    let mut text = format!(
        "protected\n  Controller controller_ = Controller(\n    {reals},\n    {integers},\n    {texts},\n    {resources});\n  \
         discrete Real reals_[{}];\n  discrete Integer integers_[{}];\nequation\n  when sample(0.0, {}) then\n    \
         (reals_, integers_) = step(controller_,\n      {reals_in},\n      {integers_in});\n  end when;\n",
        outputs.len(),
        numbers.len(),
        period.unwrap_or_else(|| interface.step.clone())
    );
    for (i, variable) in (1..).zip(&outputs) {
        _ = writeln!(text, "  {} = reals_[{i}];", name(variable));
    }
    for (i, variable) in (1..).zip(&numbers) {
        let as_boolean = if variable.kind == Type::Boolean { " <> 0" } else { "" };
        _ = writeln!(text, "  {} = integers_[{i}]{as_boolean};", name(variable));
    }
    text
}

/// Values as an array, Booleans and items as Integers.
fn list(variables: Vec<&Quantity>) -> String {
    let kind = |variable: &&Quantity| match &variable.kind {
        Type::Boolean => format!("if {} then 1 else 0", name(variable)),
        Type::Choice(_) if variable.role != Part::Input => format!("Integer({})", name(variable)),
        _ => name(variable),
    };
    let values = variables.iter().map(kind).collect::<Vec<_>>();
    format!("{{{}}}", values.join(", "))
}

fn documentation(interface: &Interface) -> String {
    let escape = |text: &str| text.replace('&', "&amp;").replace('<', "&lt;").replace('`', "");
    let mut html = format!("<html><p>{}.</p>", escape(interface.description.trim_end_matches('.')));
    let texts = interface.of(COMPUTED).filter(|variable| variable.kind == Type::Text);
    let texts = texts.map(|variable| format!("<code>{}</code>", variable.name)).collect::<Vec<_>>().join(", ");
    if !texts.is_empty() {
        _ = write!(html, "<p>Not here, as connectors have no Strings: {texts}.</p>");
    }
    for choice in &interface.choices {
        _ = write!(html, "<h4>{}</h4><p>{}.</p><ol>", choice.name, escape(&choice.description));
        for (item, description) in &choice.items {
            _ = write!(html, "<li>{item}: {}</li>", escape(description));
        }
        html += "</ol>";
    }
    html + "</html>"
}

/// The name of a variable in the block: `axis1_gain_2` for `axis1.gain[2]`.
fn name(variable: &Quantity) -> String {
    word(&variable.name.replace(['.', '['], "_").replace(']', ""))
}

fn word(name: &str) -> String {
    let taken = TAKEN.split_whitespace().any(|word| word == name);
    format!("{name}{}", if taken { "_" } else { "" })
}

/// A text as a string of Modelica, which has no numbers for characters.
fn literal(text: &str) -> String {
    let escaped = |c: char| match c {
        '"' | '\\' => format!("\\{c}"),
        '\n' => "\\n".to_owned(),
        c if c.is_ascii_control() => " ".to_owned(),
        c => c.to_string(),
    };
    format!("\"{}\"", text.chars().map(escaped).collect::<String>())
}

fn unit(variable: &Quantity) -> String {
    let [unit, display] = [("unit", &variable.unit), ("displayUnit", &variable.display)]
        .map(|(key, value)| (!value.is_empty()).then(|| format!("{key} = {}", literal(value))));
    let units = [unit, display].into_iter().flatten().collect::<Vec<_>>().join(", ");
    if units.is_empty() || variable.kind != Type::Real { String::new() } else { format!("({units})") }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::interface::tests::{interface, real};

    #[test]
    fn two_variables_with_one_name_are_refused_with_both() {
        let error = |names: &[&str]| block(&interface(names.iter().map(|name| real(name))), "P", &[]).err();
        assert!(error(&["a.x", "a_y"]).is_none());
        let found = error(&["a.x", "b", "a_x"]).unwrap().to_string();
        assert_eq!(found, "`a.x` and `a_x` have one name in Modelica, `a_x`");
        for own in ["controller_", "reals_", "resources", "P"] {
            assert!(
                error(&[own])
                    .unwrap()
                    .to_string()
                    .ends_with(&format!("and `{own}` have one name in Modelica, `{own}`"))
            );
        }
        assert!(error(&["end", "end_"]).is_some());
    }

    #[test]
    fn words_of_the_language_are_changed_and_enumerations_refused() {
        let text = block(&interface(["end", "sample", "a.end"].iter().map(|name| real(name))), "P", &[]).unwrap();
        assert!([" end_(", " sample_(", " a_end("].iter().all(|name| text.contains(name)), "{text}");
        let choice = |name: &str| Choice {
            name: name.to_owned(),
            description: String::new(),
            items: vec![("end".to_owned(), String::new())],
        };
        let with = |name| block(&Interface { choices: vec![choice(name)], ..interface([].into_iter()) }, "P", &[]);
        assert!(with("Mode").unwrap().contains("type Mode = enumeration(\n    end_ "));
        assert!(with("Controller").unwrap_err().to_string().starts_with("the enumeration `Controller` cannot be"));
    }

    #[test]
    fn a_parameter_has_the_given_start_value_and_files_have_a_folder() {
        let of = |name, kind| Quantity { role: Part::Fixed, kind, ..real(name) };
        let model = interface([of("delay", Type::Real), of("gain", Type::Real)].into_iter());
        let text = block(&model, "P", &[("delay", "0.5"), ("other", "1")]).unwrap();
        assert!(text.contains("delay(unit = \"m\") = 0.5 ") && text.contains("gain(unit = \"m\") = 0.0 "), "{text}");
        assert!(!text.contains("parameter String resources") && text.contains("    \"\");\n"), "{text}");
        let text = block(&interface([of("path.file", Type::Text)].into_iter()), "P", &[]).unwrap();
        assert!(text.contains("parameter String resources = \"\"") && text.contains("    resources);\n"), "{text}");
    }

    #[test]
    fn a_local_variable_is_no_connector_and_an_expert_parameter_has_another_tab() {
        let of = |role, name| Quantity { role, ..real(name) };
        let variables = [of(Part::Output, "u"), of(Part::Local, "error.rms"), of(Part::Fixed, "expert.limits.jump")];
        let text = block(&interface(variables.into_iter()), "P", &[]).unwrap();
        assert!(text.contains("P.Interfaces.RealOutput u(") && text.contains("\n  Real error_rms("), "{text}");
        assert!(text.contains("  error_rms = reals_[2];\n"), "{text}");
        assert!(text.contains(" annotation (Dialog(tab = \"Expert\", group = \"limits\"));"), "{text}");
    }

    #[test]
    fn a_text_is_no_connector() {
        let of = |role| Quantity { role, kind: Type::Text, ..real("note") };
        let error = block(&interface([of(Part::Input)].into_iter()), "P", &[]).unwrap_err().to_string();
        assert_eq!(error, "`note` cannot be an input of a block of Modelica: it is a String");
        let text = block(&interface([of(Part::Output)].into_iter()), "P", &[]).unwrap();
        assert!(text.contains("no Strings: <code>note</code>"), "{text}");
    }

    #[test]
    fn a_string_holds_no_escapes_of_c() {
        assert_eq!(literal("a\"b\\c\n1\u{1}2"), r#""a\"b\\c\n1 2""#);
    }
}
