//! The part of modelDescription.xml that the bench needs: the GUID, value references, enumeration items.

use std::collections::BTreeMap;

use anyhow::{Context, Result};
use roxmltree::{Document, Node};

/// An FMU's description.
pub struct Description {
    /// Identity that `fmi2Instantiate` asks for.
    pub guid: String,
    references: BTreeMap<String, u32>,
    items: BTreeMap<(String, String), i32>,
}

impl Description {
    /// Reads modelDescription.xml.
    ///
    /// # Errors
    /// When the XML is broken or an attribute is missing.
    pub fn parse(xml: &str) -> Result<Self> {
        let document = Document::parse(xml).context("modelDescription.xml is broken")?;
        let root = document.root_element();
        let mut description =
            Self { guid: attribute(&root, "guid")?.to_owned(), references: BTreeMap::new(), items: BTreeMap::new() };
        for variable in root.descendants().filter(|node| node.has_tag_name("ScalarVariable")) {
            let reference = attribute(&variable, "valueReference")?.parse()?;
            description.references.insert(attribute(&variable, "name")?.to_owned(), reference);
        }
        for item in root.descendants().filter(|node| node.has_tag_name("Item")) {
            let simple_type = item.ancestors().find(|node| node.has_tag_name("SimpleType"));
            let simple_type = attribute(&simple_type.context("an item lies outside a type")?, "name")?.to_owned();
            let value = attribute(&item, "value")?.parse()?;
            description.items.insert((simple_type, attribute(&item, "name")?.to_owned()), value);
        }
        Ok(description)
    }

    /// Value reference of a variable.
    ///
    /// # Errors
    /// When there is no such variable.
    pub fn reference(&self, name: &str) -> Result<u32> {
        self.references.get(name).copied().with_context(|| format!("the FMU has no variable `{name}`"))
    }

    /// Number of an item of an enumeration type.
    ///
    /// # Errors
    /// When there is no such item.
    pub fn item(&self, simple_type: &str, name: &str) -> Result<i32> {
        let key = (simple_type.to_owned(), name.to_owned());
        self.items.get(&key).copied().with_context(|| format!("the FMU has no item `{name}` of `{simple_type}`"))
    }
}

fn attribute<'a>(node: &Node<'a, '_>, name: &str) -> Result<&'a str> {
    node.attribute(name).with_context(|| format!("`{}` has no attribute `{name}`", node.tag_name().name()))
}

#[cfg(test)]
mod tests {
    use super::*;

    const XML: &str = r#"<fmiModelDescription guid="abc"><TypeDefinitions><SimpleType name="State"><Enumeration>
        <Item name="Idle" value="1"/><Item name="Detect" value="4"/></Enumeration></SimpleType></TypeDefinitions>
        <ModelVariables><ScalarVariable name="force.slope" valueReference="7"/></ModelVariables></fmiModelDescription>"#;

    #[test]
    fn identity_references_and_items_are_read() {
        let description = Description::parse(XML).unwrap();
        assert_eq!(description.guid, "abc");
        assert_eq!(description.reference("force.slope").unwrap(), 7);
        assert_eq!(description.item("State", "Detect").unwrap(), 4);
    }

    #[test]
    fn what_is_not_there_is_named() {
        let description = Description::parse(XML).unwrap();
        assert!(description.reference("force").unwrap_err().to_string().contains("`force`"));
        assert!(description.item("State", "Ready").unwrap_err().to_string().contains("`Ready`"));
        assert!(Description::parse("<a>").is_err());
    }
}
