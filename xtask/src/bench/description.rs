//! The part of modelDescription.xml that the bench needs: the GUID and value references.

use std::collections::BTreeMap;

use anyhow::{Context, Result};
use roxmltree::{Document, Node};

/// An FMU's description.
pub struct Description {
    /// Identity that `fmi2Instantiate` asks for.
    pub guid: String,
    references: BTreeMap<String, u32>,
}

impl Description {
    /// Reads modelDescription.xml.
    ///
    /// # Errors
    /// When the XML is broken or an attribute is missing.
    pub fn parse(xml: &str) -> Result<Self> {
        let document = Document::parse(xml).context("modelDescription.xml is broken")?;
        let root = document.root_element();
        let mut description = Self { guid: attribute(&root, "guid")?.to_owned(), references: BTreeMap::new() };
        for variable in root.descendants().filter(|node| node.has_tag_name("ScalarVariable")) {
            let reference = attribute(&variable, "valueReference")?.parse()?;
            description.references.insert(attribute(&variable, "name")?.to_owned(), reference);
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
}

fn attribute<'a>(node: &Node<'a, '_>, name: &str) -> Result<&'a str> {
    node.attribute(name).with_context(|| format!("`{}` has no attribute `{name}`", node.tag_name().name()))
}

#[cfg(test)]
mod tests {
    use super::*;

    const XML: &str = r#"<fmiModelDescription guid="abc"><ModelVariables>
        <ScalarVariable name="force.slope" valueReference="7"/></ModelVariables></fmiModelDescription>"#;

    #[test]
    fn identity_and_references_are_read() {
        let description = Description::parse(XML).unwrap();
        assert_eq!(description.guid, "abc");
        assert_eq!(description.reference("force.slope").unwrap(), 7);
    }

    #[test]
    fn what_is_not_there_is_named() {
        let description = Description::parse(XML).unwrap();
        assert!(description.reference("force").unwrap_err().to_string().contains("`force`"));
        assert!(Description::parse("<a>").is_err());
    }
}
