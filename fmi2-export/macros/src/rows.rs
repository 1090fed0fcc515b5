//! The declaration, flattened: one row for each variable, with its FMI name and the path to its field.

use proc_macro2::TokenStream;
use quote::quote;
use syn::{Expr, Ident, LitStr};

use crate::declaration::{Declaration, Field, Group, Kind, Root, Shape};

/// Prefix of the names of expert parameters.
const EXPERT: &str = "expert.";

/// One row of the variable table.
pub struct Row<'a> {
    pub root: Root,
    /// FMI name: the path of the field, or what `name = ...` says.
    pub name: String,
    /// The path from the struct of the root to the field, such as `axis[2].position`.
    pub way: TokenStream,
    pub field: &'a Field,
    pub kind: &'a Kind,
    /// Length of an array.
    pub length: Option<&'a Expr>,
    /// Field of a struct that is declared elsewhere.
    pub component: Option<&'a Ident>,
    /// Which of the uses of a repeated group this is, from 0.
    pub index: Option<usize>,
    /// The field that is the group of this one.
    pub group: Option<&'a Field>,
    /// Flags of the groups around the field: what they say is true of it, too.
    pub around: Vec<&'a Field>,
}

/// All rows: inputs, outputs, parameters, each in the order of the declaration; expert parameters come last.
pub fn collect(declaration: &Declaration) -> Vec<Row<'_>> {
    let mut rows = Vec::new();
    for root in [Root::Inputs, Root::Outputs, Root::Parameters] {
        if let Some(group) = declaration.root(root) {
            Walk { declaration, root, rows: &mut rows, around: Vec::new() }.group(group, "", None, None, None);
        }
    }
    rows.sort_by_key(|row| row.flag("expert"));
    rows
}

/// A walk through the groups of a root.
struct Walk<'a, 'b> {
    declaration: &'a Declaration,
    root: Root,
    rows: &'b mut Vec<Row<'a>>,
    around: Vec<&'a Field>,
}

impl<'a> Walk<'a, '_> {
    fn group(
        &mut self,
        group: &'a Group,
        prefix: &str,
        above: Option<&TokenStream>,
        index: Option<usize>,
        of: Option<&'a Field>,
    ) {
        for field in &group.fields {
            let name = &field.name;
            let given = field.var.name.as_ref().map(LitStr::value);
            let full = given.unwrap_or_else(|| format!("{prefix}{}", plain(name)));
            let way = above.map_or_else(|| quote!(#name), |above| quote!(#above.#name));
            match &field.shape {
                Shape::Hidden => (),
                Shape::Group(ty) => {
                    self.around.push(field);
                    self.group(self.declaration.group(ty), &format!("{full}."), Some(&way), index, Some(field));
                    self.around.pop();
                }
                Shape::Repeated(ty, count) => {
                    self.around.push(field);
                    for i in 0..*count {
                        let group = self.declaration.group(ty);
                        self.group(group, &format!("{full}{}.", i + 1), Some(&quote!(#way[#i])), Some(i), Some(field));
                    }
                    self.around.pop();
                }
                Shape::Scalar(kind) => self.push(full, way, field, kind, index, of),
                Shape::Array(kind, length) => {
                    self.push(full, way, field, kind, index, of);
                    self.last().length = Some(length);
                }
                Shape::Fields(kind) => {
                    for component in &field.var.fields.as_ref().expect("the shape comes from them").names {
                        let full = format!("{full}.{}", plain(component));
                        self.push(full, way.clone(), field, kind, index, of);
                        self.last().component = Some(component);
                    }
                }
            }
        }
    }

    fn push(
        &mut self,
        name: String,
        way: TokenStream,
        field: &'a Field,
        kind: &'a Kind,
        index: Option<usize>,
        group: Option<&'a Field>,
    ) {
        let (root, around) = (self.root, self.around.clone());
        let mut row = Row { root, name, way, field, kind, length: None, component: None, index, group, around };
        if row.flag("expert") {
            // dialogs of importers group variables by the parts of their names
            row.name.insert_str(0, EXPERT);
        }
        self.rows.push(row);
    }

    fn last(&mut self) -> &mut Row<'a> {
        self.rows.last_mut().expect("a row was pushed")
    }
}

impl Row<'_> {
    /// Whether the field, or a group around it, has a flag.
    pub fn flag(&self, name: &str) -> bool {
        std::iter::once(&self.field).chain(&self.around).any(|field| field.var.flag(name).is_some())
    }

    /// The path from the variables to the value.
    pub fn access(&self) -> TokenStream {
        let (root, way) = (self.root.field(), &self.way);
        let component = self.component.map(|component| quote!(.#component));
        quote!(#root.#way #component)
    }

    /// The description: the doc comment, `{n}` as the number of a repeated group, and the component.
    pub fn description(&self) -> String {
        let text = self.numbered(self.field);
        match self.component {
            Some(component) => format!("{text}, {}", plain(component)),
            None => text,
        }
    }

    /// Description of the group of the row: the doc comment of its field; empty without a group.
    pub fn head(&self) -> String {
        self.group.map_or(String::new(), |group| self.numbered(group))
    }

    fn numbered(&self, field: &Field) -> String {
        let number = self.index.map_or(String::new(), |index| (index + 1).to_string());
        field.docs.replace("{n}", &number)
    }
}

/// The name of a field without the marks of a raw identifier.
fn plain(name: &Ident) -> String {
    let name = name.to_string();
    name.strip_prefix("r#").unwrap_or(&name).to_owned()
}
