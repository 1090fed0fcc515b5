//! Variables of a model, as its description tells them.

use anyhow::{Context, Result};
use roxmltree::{Document, Node};

/// What a model description tells of its model.
pub struct Interface {
    /// Model identifier.
    pub identifier: String,
    /// Name for people.
    pub name: String,
    pub description: String,
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
    /// Whatever the model computes.
    Output,
    Fixed,
    Tunable,
}

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
    /// Reads a model description.
    ///
    /// # Errors
    /// When it is not well-formed, or lacks what FMI asks for.
    pub fn read(description: &str) -> Result<Self> {
        let document = Document::parse(description).context("the model description is not well-formed")?;
        let all = |tag: &'static str| document.descendants().filter(move |node| node.has_tag_name(tag));
        let first = |tag: &'static str| all(tag).next().with_context(|| format!("there is no `{tag}`"));
        let root = document.root_element();
        let choices = all("SimpleType").filter_map(|ty| Some((ty, child(ty, "Enumeration")?)));
        let choices: Vec<_> = choices.map(|(ty, items)| Choice::read(ty, items)).collect();
        let variables = all("ScalarVariable").map(|node| Quantity::read(node, &choices)).collect::<Result<_>>()?;
        Ok(Self {
            identifier: text(first("CoSimulation")?, "modelIdentifier"),
            name: text(root, "modelName"),
            description: text(root, "description"),
            guid: text(root, "guid"),
            step: text(first("DefaultExperiment")?, "stepSize"),
            choices,
            variables,
        })
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
        let told = node.children().find(Node::is_element).with_context(|| format!("`{name}` has no type"))?;
        let kind = match told.tag_name().name() {
            "Real" => Type::Real,
            "Integer" => Type::Integer,
            "Boolean" => Type::Boolean,
            "String" => Type::Text,
            _ => Type::Choice(text(told, "declaredType")),
        };
        let role = match (node.attribute("causality"), node.attribute("variability")) {
            (Some("input"), _) => Part::Input,
            (Some("parameter"), Some("tunable")) => Part::Tunable,
            (Some("parameter"), _) => Part::Fixed,
            _ => Part::Output,
        };
        let start = text(told, "start");
        let choice = choices.iter().find(|choice| kind == Type::Choice(choice.name.clone()));
        let item = choice.zip(start.parse::<usize>().ok()).and_then(|(choice, number)| choice.items.get(number - 1));
        let reference = text(node, "valueReference").parse();
        Ok(Self {
            reference: reference.with_context(|| format!("`{name}` has no value reference"))?,
            description: text(node, "description"),
            role,
            kind,
            unit: text(told, "unit"),
            display: text(told, "displayUnit"),
            item: item.map(|(item, _)| item.clone()).unwrap_or_default(),
            start,
            name,
        })
    }
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
        let [identifier, name, description, guid, step] = ["m", "M", "A model", "{0}", "0.001"].map(str::to_owned);
        Interface { identifier, name, description, guid, step, choices: Vec::new(), variables: variables.collect() }
    }
}
