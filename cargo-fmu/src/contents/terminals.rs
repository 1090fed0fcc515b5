//! `terminalsAndIcons/terminalsAndIcons.xml`: the inputs and outputs in bundles, and the icon.

use std::fmt::Write as _;

use super::markup::escaped;
use crate::interface::{Interface, Part};

/// Path of the file inside an FMU.
pub const FILE: &str = "terminalsAndIcons/terminalsAndIcons.xml";

/// Path of the icon that the file speaks of.
pub const ICON: &str = "terminalsAndIcons/icon.png";

/// Inputs and outputs of a model, in the order of its description.
pub struct Ports {
    /// Names of the inputs.
    pub inputs: Vec<String>,
    /// Names of the outputs.
    pub outputs: Vec<String>,
}

impl Ports {
    /// Those of a model.
    pub fn of(interface: &Interface) -> Self {
        let names = |parts| interface.of(parts).map(|variable| variable.name.clone()).collect();
        Self { inputs: names(&[Part::Input]), outputs: names(&[Part::Output]) }
    }
}

/// The file: a terminal for each group, which is the part of a name before its first dot; what has no group is in the
/// terminal `inputs` or `outputs`.
pub fn write(ports: &Ports) -> String {
    let mut terminals: Vec<(String, Vec<(&str, &str)>)> = Vec::new();
    let all = [("inputs", &ports.inputs), ("outputs", &ports.outputs)];
    for (rest, name) in all.iter().flat_map(|(rest, names)| names.iter().map(move |name| (*rest, name))) {
        let (group, member) = name.split_once('.').unwrap_or((rest, name));
        match terminals.iter_mut().find(|(terminal, _)| terminal == group) {
            Some((_, members)) => members.push((name, member)),
            None => terminals.push((group.to_owned(), vec![(name, member)])),
        }
    }
    let mut xml = "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<fmiTerminalsAndIcons fmiVersion=\"3.0\">\n  \
                   <GraphicalRepresentation>\n    \
                   <CoordinateSystem x1=\"-100\" y1=\"-100\" x2=\"100\" y2=\"100\" suggestedScalingFactorTo_mm=\"0.1\"/>\n    \
                   <Icon x1=\"-100\" y1=\"-100\" x2=\"100\" y2=\"100\"/>\n  </GraphicalRepresentation>\n"
        .to_owned();
    if !terminals.is_empty() {
        xml += "  <Terminals>\n";
        for (terminal, members) in &terminals {
            _ = writeln!(xml, "    <Terminal name=\"{}\" matchingRule=\"bus\">", escaped(terminal));
            for (name, member) in members {
                _ = writeln!(
                    xml,
                    "      <TerminalMemberVariable variableName=\"{}\" memberName=\"{}\" variableKind=\"signal\"/>",
                    escaped(name),
                    escaped(member)
                );
            }
            xml += "    </Terminal>\n";
        }
        xml += "  </Terminals>\n";
    }
    xml + "</fmiTerminalsAndIcons>\n"
}

#[cfg(test)]
mod tests {
    use roxmltree::Document;

    use super::*;
    use crate::interface::Quantity;
    use crate::interface::tests::{interface, real};

    #[test]
    fn names_that_xml_would_misread_come_through() {
        let ports = Ports { inputs: vec!["'a<b & \"c\"'".to_owned()], outputs: vec!["<g>.y".to_owned()] };
        let text = write(&ports);
        let document = Document::parse(&text).unwrap();
        let of = |name| document.descendants().filter_map(|node| node.attribute(name)).collect::<Vec<_>>();
        assert_eq!(of("variableName"), ["'a<b & \"c\"'", "<g>.y"]);
        assert_eq!(of("name"), ["inputs", "<g>"]);
    }

    #[test]
    fn each_group_is_a_terminal_with_its_members() {
        let of = |role, name: &str| Quantity { role, ..real(name) };
        let outputs = ["force.slope", "force.raw[1]", "u"].map(|name| of(Part::Output, name));
        let variables = [real("x"), of(Part::Fixed, "k"), of(Part::Local, "l")].into_iter().chain(outputs);
        let ports = Ports::of(&interface(variables));
        assert_eq!((ports.inputs.len(), ports.outputs.len()), (1, 3));
        let text = write(&ports);
        let document = Document::parse(&text).unwrap();
        let terminals = document.descendants().filter(|node| node.has_tag_name("Terminal"));
        let seen: Vec<_> = terminals
            .map(|node| {
                let members = node.children().filter_map(|member| member.attribute("memberName"));
                (node.attribute("name").unwrap(), members.collect::<Vec<_>>().join(" "))
            })
            .collect();
        let wanted = [("inputs", "x"), ("force", "slope raw[1]"), ("outputs", "u")];
        assert_eq!(seen, wanted.map(|(name, members)| (name, members.to_owned())));
    }
}
