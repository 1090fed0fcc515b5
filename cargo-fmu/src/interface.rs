//! Variables of a model, read from its description.

use std::collections::{BTreeMap, BTreeSet};

use anyhow::{Context, Result, ensure};
use roxmltree::{Document, Node};

use crate::functions::REQUIRED;
use crate::pack::DESCRIPTION;

/// A model as its description states it; missing attributes are empty.
pub struct Interface {
    /// Version of FMI.
    pub version: String,
    /// Program that wrote it.
    pub tool: String,
    /// Model identifier for co-simulation: the name of the binary.
    pub identifier: String,
    /// Functions that the standard requires of each binary, by model identifier.
    pub required: BTreeMap<String, BTreeSet<&'static str>>,
    /// Name for people.
    pub name: String,
    pub description: String,
    /// GUID that the description and every library of it share.
    pub guid: String,
    /// Communication step that the model suggests, s.
    pub step: String,
    pub choices: Vec<Choice>,
    pub variables: Vec<Quantity>,
}

/// An enumeration.
pub struct Choice {
    pub name: String,
    pub description: String,
    /// Name and description of each item; the first has the number 1.
    pub items: Vec<(String, String)>,
}

/// A variable.
pub struct Quantity {
    pub name: String,
    pub reference: u32,
    pub description: String,
    pub role: Part,
    pub kind: Type,
    pub unit: String,
    /// Unit that tools show it in.
    pub display: String,
    /// Empty where it is calculated.
    pub start: String,
    /// The item that `start` is the number of.
    pub item: String,
}

/// What a variable is to its user.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Part {
    Input,
    Output,
    Fixed,
    Tunable,
    /// A value that the model computes in addition to its outputs.
    Local,
}

/// All that a model computes.
pub const COMPUTED: &[Part] = &[Part::Output, Part::Local];

/// Type of a variable.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Type {
    Real,
    Integer,
    Boolean,
    Text,
    /// Of the enumeration of this name.
    Choice(String),
}

impl Interface {
    /// Reads a model description, whoever wrote it.
    ///
    /// # Errors
    /// When it is not well-formed, of another version than FMI 2.0, has no GUID, or a variable lacks what FMI asks for.
    pub fn read(description: &str) -> Result<Self> {
        let document = Document::parse(description).with_context(|| format!("`{DESCRIPTION}` is not well-formed"))?;
        let all = |tag: &'static str| document.descendants().filter(move |node| node.has_tag_name(tag));
        let first = |tag, attribute| all(tag).next().map_or_else(String::new, |node| text(node, attribute));
        let root = document.root_element();
        let version = text(root, "fmiVersion");
        ensure!(
            version.is_empty() || version.starts_with("2."),
            "the FMU has FMI {version}, only FMI 2.0 is read\nhint: Use `fmpy info FILE`."
        );
        let choices = all("SimpleType").filter_map(|ty| Some((ty, child(ty, "Enumeration")?)));
        let choices: Vec<_> = choices.map(|(ty, items)| Choice::read(ty, items)).collect();
        let variables = all("ScalarVariable").map(|node| Quantity::read(node, &choices)).collect::<Result<_>>()?;
        let guid = root.attribute("guid").with_context(|| format!("`{DESCRIPTION}` has no GUID"))?;
        Ok(Self {
            version,
            tool: text(root, "generationTool"),
            identifier: first("CoSimulation", "modelIdentifier"),
            required: required(root),
            name: text(root, "modelName"),
            description: text(root, "description"),
            guid: guid.to_owned(),
            step: first("DefaultExperiment", "stepSize"),
            choices,
            variables,
        })
    }

    /// Reads the model description of a library that is made for co-simulation.
    ///
    /// # Errors
    /// As [`Interface::read`], and when it has no identifier or no communication step.
    pub fn of_library(description: &str) -> Result<Self> {
        let interface = Self::read(description)?;
        for (value, name) in [(&interface.identifier, "modelIdentifier"), (&interface.step, "stepSize")] {
            ensure!(!value.is_empty(), "`{DESCRIPTION}` names no {name}");
        }
        Ok(interface)
    }

    /// The variables of a part, in their order.
    pub fn of(&self, parts: &'static [Part]) -> impl Iterator<Item = &Quantity> {
        self.variables.iter().filter(move |variable| parts.contains(&variable.role))
    }

    /// The same as languages without Booleans and enumerations in arrays take them: Reals, Integers with Booleans and
    /// items, and texts.
    pub fn split(&self, parts: &'static [Part]) -> [Vec<&Quantity>; 3] {
        let (reals, rest): (Vec<_>, Vec<_>) = self.of(parts).partition(|variable| variable.kind == Type::Real);
        let (texts, numbers) = rest.into_iter().partition(|variable| variable.kind == Type::Text);
        [reals, numbers, texts]
    }
}

impl Choice {
    fn read(ty: Node, items: Node) -> Self {
        let items = items.children().filter(Node::is_element);
        let items = items.map(|item| (text(item, "name"), text(item, "description"))).collect();
        Self { name: text(ty, "name"), description: text(ty, "description"), items }
    }
}

impl Quantity {
    fn read(node: Node, choices: &[Choice]) -> Result<Self> {
        let name = text(node, "name");
        let element = node.children().find(Node::is_element).with_context(|| format!("`{name}` has no type"))?;
        let kind = match element.tag_name().name() {
            "Real" => Type::Real,
            "Integer" => Type::Integer,
            "Boolean" => Type::Boolean,
            "String" => Type::Text,
            _ => Type::Choice(text(element, "declaredType")),
        };
        let role = match (node.attribute("causality"), node.attribute("variability")) {
            (Some("input"), _) => Part::Input,
            (Some("parameter"), Some("tunable")) => Part::Tunable,
            (Some("parameter"), _) => Part::Fixed,
            (Some("output"), _) => Part::Output,
            _ => Part::Local,
        };
        let start = text(element, "start");
        let choice = choices.iter().find(|choice| kind == Type::Choice(choice.name.clone()));
        let place = start.parse::<usize>().ok().and_then(|number| number.checked_sub(1));
        let item = choice.zip(place).and_then(|(choice, place)| choice.items.get(place));
        let reference = text(node, "valueReference").parse();
        Ok(Self {
            reference: reference.with_context(|| format!("`{name}` has no value reference"))?,
            description: text(node, "description"),
            role,
            kind,
            unit: text(element, "unit"),
            display: text(element, "displayUnit"),
            item: item.map(|(item, _)| item.clone()).unwrap_or_default(),
            start,
            name,
        })
    }
}

/// Functions that the standard requires for the kinds of an FMU and their capabilities, by model identifier.
fn required(root: Node) -> BTreeMap<String, BTreeSet<&'static str>> {
    let mut required = BTreeMap::<_, BTreeSet<_>>::new();
    for kind in root.children() {
        let name = kind.tag_name().name();
        let identifier = text(kind, "modelIdentifier");
        if identifier.is_empty() || !matches!(name, "CoSimulation" | "ModelExchange") {
            continue;
        }
        let can = |capability: &str| !matches!(kind.attribute(capability), None | Some("false" | "0"));
        let applies =
            |tag: &str, capability: &str| (tag.is_empty() || tag == name) && (capability.is_empty() || can(capability));
        let rules = REQUIRED.iter().filter(|(tag, capability, _)| applies(tag, capability));
        required.entry(identifier).or_default().extend(rules.flat_map(|(_, _, functions)| *functions));
    }
    required
}

fn text(node: Node, attribute: &str) -> String {
    node.attribute(attribute).unwrap_or_default().to_owned()
}

fn child<'a, 'd>(node: Node<'a, 'd>, tag: &str) -> Option<Node<'a, 'd>> {
    node.children().find(|child| child.has_tag_name(tag))
}

#[cfg(test)]
pub mod tests {
    use super::*;

    /// An input with a unit.
    pub fn real(name: &str) -> Quantity {
        let (name, description) = (name.to_owned(), format!("The {name}"));
        let (unit, display) = ("m".to_owned(), String::new());
        let (start, item) = ("0.0".to_owned(), String::new());
        Quantity { name, reference: 0, description, role: Part::Input, kind: Type::Real, unit, display, start, item }
    }

    /// A model of these variables.
    pub fn interface(variables: impl Iterator<Item = Quantity>) -> Interface {
        let [version, tool, identifier, name, description, guid, step] =
            ["2.0", "", "m", "M", "A model", "{0}", "0.001"].map(str::to_owned);
        let (choices, variables) = (Vec::new(), variables.collect());
        let required = BTreeMap::from([(identifier.clone(), BTreeSet::new())]);
        Interface { version, tool, identifier, required, name, description, guid, step, choices, variables }
    }

    #[test]
    fn a_library_names_its_binary_and_its_step() {
        let xml = |more: &str| format!("<fmiModelDescription guid=\"g\">{more}</fmiModelDescription>");
        let binary = "<CoSimulation modelIdentifier=\"spring\"/>";
        let whole = xml(&format!("{binary}<DefaultExperiment stepSize=\"1e-3\"/>"));
        let read = Interface::of_library(&whole).unwrap();
        assert_eq!((read.identifier.as_str(), read.step.as_str(), read.guid.as_str()), ("spring", "1e-3", "g"));
        let error = |xml: &str| Interface::of_library(xml).err().unwrap().to_string();
        assert_eq!(error(&xml("")), "`modelDescription.xml` names no modelIdentifier");
        assert_eq!(error(&xml(binary)), "`modelDescription.xml` names no stepSize");
        assert_eq!(error("<fmiModelDescription/>"), "`modelDescription.xml` has no GUID");
        let other = error("<fmiModelDescription fmiVersion=\"3.0\" instantiationToken=\"t\"/>");
        assert_eq!(other, "the FMU has FMI 3.0, only FMI 2.0 is read\nhint: Use `fmpy info FILE`.");
    }

    #[test]
    fn functions_are_required_for_kinds_and_capabilities() {
        let read = |kinds: &str| {
            Interface::read(&format!("<fmiModelDescription guid=\"g\">{kinds}</fmiModelDescription>")).unwrap().required
        };
        let cosimulation = read("<CoSimulation modelIdentifier=\"a\" canGetAndSetFMUstate=\"false\"/>");
        assert_eq!((cosimulation.len(), cosimulation["a"].len()), (1, 24));
        assert!(["fmi2GetDerivatives", "fmi2GetFMUstate"].iter().all(|name| !cosimulation["a"].contains(name)));

        let both = |exchange: &str| {
            read(&format!(
                "<ModelExchange modelIdentifier=\"{exchange}\" canGetAndSetFMUstate=\"true\"/>\
                <CoSimulation modelIdentifier=\"a\" maxOutputDerivativeOrder=\"1\"/>"
            ))
        };
        let (of_cosimulation, of_exchange) =
            (["fmi2GetRealOutputDerivatives", "fmi2DoStep"], ["fmi2GetDerivatives", "fmi2GetFMUstate"]);
        let (one, two) = (both("a"), both("b"));
        assert!(of_cosimulation.iter().chain(&of_exchange).all(|name| one["a"].contains(name)));
        assert!(of_cosimulation.iter().all(|name| two["a"].contains(name) && !two["b"].contains(name)));
        assert!(of_exchange.iter().all(|name| two["b"].contains(name) && !two["a"].contains(name)));
    }

    #[test]
    fn a_description_of_others_may_count_its_items_from_zero() {
        let xml = "<fmiModelDescription guid=\"g\"><SimpleType name=\"Mode\"><Enumeration><Item name=\"Off\" value=\"0\"/>\
            </Enumeration></SimpleType><ScalarVariable name=\"x\" valueReference=\"1\" causality=\"local\">\
            <Enumeration declaredType=\"Mode\" start=\"0\"/></ScalarVariable></fmiModelDescription>";
        let read = Interface::read(xml).unwrap();
        assert_eq!((read.variables[0].item.as_str(), read.variables[0].role), ("", Part::Local));
    }
}
