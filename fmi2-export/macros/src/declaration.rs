//! The module as its author wrote it: groups of fields and enumerations.

use std::collections::HashMap;

use proc_macro2::Span;
use syn::parse::{Parse, ParseStream};
use syn::punctuated::Punctuated;
use syn::{
    Attribute, Expr, ExprLit, Ident, Item, ItemEnum, ItemMod, ItemStruct, Lit, LitStr, Meta, Path, Token, Type,
    Visibility, bracketed, parse_quote,
};

use crate::attributes::Attributes;

/// The whole module.
pub struct Declaration {
    pub attributes: Vec<Attribute>,
    pub visibility: Visibility,
    pub name: Ident,
    pub groups: Vec<Group>,
    pub choices: Vec<Choice>,
    /// Items that the macro does not change: imports, constants, `impl` blocks.
    pub others: Vec<Item>,
}

/// A struct of the module.
pub struct Group {
    pub attributes: Vec<Attribute>,
    pub visibility: Visibility,
    pub name: Ident,
    pub root: Option<Root>,
    pub fields: Vec<Field>,
}

/// The three structs that the model sees.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Root {
    Inputs,
    Outputs,
    Parameters,
}

/// A field of a group.
pub struct Field {
    pub attributes: Vec<Attribute>,
    pub visibility: Visibility,
    pub name: Ident,
    pub ty: Type,
    pub docs: String,
    pub var: Attributes,
    pub shape: Shape,
}

/// Structure of a field: one value, an array, a group of variables, or no variable.
pub enum Shape {
    Scalar(Kind),
    /// An array of scalars, with its length.
    Array(Kind, Expr),
    Group(Ident),
    /// A group used several times.
    Repeated(Ident, usize),
    /// A struct that is declared elsewhere, of fields of one kind.
    Fields(Kind),
    /// Not a variable.
    Hidden,
}

/// Type of a variable.
#[derive(Clone, PartialEq, Eq)]
pub enum Kind {
    Real,
    Integer,
    Boolean,
    Text,
    Choice(Ident),
}

/// An enumeration of the module.
pub struct Choice {
    pub attributes: Vec<Attribute>,
    pub visibility: Visibility,
    pub name: Ident,
    pub docs: String,
    pub items: Vec<ChoiceItem>,
    pub reactions: Option<Reactions>,
}

/// An item of an enumeration; the items are numbered from 1.
pub struct ChoiceItem {
    pub attributes: Vec<Attribute>,
    pub name: Ident,
    pub docs: String,
    pub hint: Option<LitStr>,
    /// Reaction to a fault: an item of [`Reactions`].
    pub reaction: Option<Ident>,
    /// How a fault is detected.
    pub detection: Option<LitStr>,
}

/// `#[reactions(Type, Item = ["what the machine does", "how the fault is acknowledged"], ...)]`: the mildest first.
pub struct Reactions {
    /// An enumeration of Rust that has the items.
    pub ty: Path,
    pub items: Vec<ReactionItem>,
}

/// One reaction.
pub struct ReactionItem {
    pub name: Ident,
    pub description: LitStr,
    pub acknowledge: LitStr,
}

impl Parse for Reactions {
    fn parse(input: ParseStream) -> syn::Result<Self> {
        let ty = input.call(Path::parse_mod_style)?;
        input.parse::<Token![,]>()?;
        let items: Vec<_> = Punctuated::<ReactionItem, Token![,]>::parse_terminated(input)?.into_iter().collect();
        if items.is_empty() {
            return Err(input.error("`reactions` lists at least one reaction"));
        }
        Ok(Self { ty, items })
    }
}

impl Parse for ReactionItem {
    fn parse(input: ParseStream) -> syn::Result<Self> {
        let name = input.parse()?;
        input.parse::<Token![=]>()?;
        let texts;
        bracketed!(texts in input);
        let description = texts.parse()?;
        texts.parse::<Token![,]>()?;
        let acknowledge = texts.parse()?;
        texts.parse::<Option<Token![,]>>()?;
        if !texts.is_empty() {
            return Err(texts.error("a reaction has two texts: what the machine does, how the fault is acknowledged"));
        }
        Ok(Self { name, description, acknowledge })
    }
}

impl Root {
    const ALL: [(&'static str, Self); 3] =
        [("inputs", Self::Inputs), ("outputs", Self::Outputs), ("parameters", Self::Parameters)];

    /// The field of the variables that holds the struct.
    pub fn field(self) -> Ident {
        let name = match self {
            Self::Inputs => "input",
            Self::Outputs => "output",
            Self::Parameters => "parameters",
        };
        Ident::new(name, Span::call_site())
    }
}

impl Declaration {
    /// Reads the module.
    ///
    /// # Errors
    /// Everything that is not a declaration, each at its position in the source.
    pub fn read(module: ItemMod) -> syn::Result<Self> {
        let Some((_, items)) = module.content else {
            return Err(syn::Error::new_spanned(
                module,
                "the interface is a module with its content: `mod variables { ... }`",
            ));
        };
        let names = Names::of(&items);
        let mut errors = Errors::default();
        let (mut groups, mut choices, mut others) = (Vec::new(), Vec::new(), Vec::new());
        for item in items {
            match item {
                Item::Struct(item) => groups.extend(errors.keep(Group::read(item, &names))),
                Item::Enum(item) => choices.extend(errors.keep(Choice::read(item))),
                item => others.push(item),
            }
        }
        errors.end()?;
        let mut declaration =
            Self { attributes: module.attrs, visibility: module.vis, name: module.ident, groups, choices, others };
        declaration.inherit_docs();
        Ok(declaration)
    }

    /// A field without a doc comment takes that of its struct or enumeration.
    fn inherit_docs(&mut self) {
        let groups = self.groups.iter().map(|group| (group.name.clone(), docs(&group.attributes)));
        let choices = self.choices.iter().map(|choice| (choice.name.clone(), choice.docs.clone()));
        let known: HashMap<Ident, String> = groups.chain(choices).collect();
        for field in self.groups.iter_mut().flat_map(|group| &mut group.fields) {
            let (Shape::Group(name) | Shape::Repeated(name, _) | Shape::Scalar(Kind::Choice(name))) = &field.shape
            else {
                continue;
            };
            if let (true, Some(docs)) = (field.docs.is_empty(), known.get(name)) {
                field.attributes.push(parse_quote!(#[doc = #docs]));
                field.docs.clone_from(docs);
            }
        }
    }

    /// The struct of a name.
    pub fn group(&self, name: &Ident) -> &Group {
        self.groups.iter().find(|group| group.name == *name).expect("a group is declared in the module")
    }

    /// The struct of a root, if there is one.
    pub fn root(&self, root: Root) -> Option<&Group> {
        self.groups.iter().find(|group| group.root == Some(root))
    }
}

/// Names that a type of a field may have.
struct Names {
    groups: Vec<Ident>,
    choices: Vec<Ident>,
}

impl Names {
    fn of(items: &[Item]) -> Self {
        let mut names = Self { groups: Vec::new(), choices: Vec::new() };
        for item in items {
            match item {
                Item::Struct(item) => names.groups.push(item.ident.clone()),
                Item::Enum(item) => names.choices.push(item.ident.clone()),
                _ => (),
            }
        }
        names
    }

    fn kind(&self, ty: &Ident) -> Option<Kind> {
        match ty.to_string().as_str() {
            "f64" => Some(Kind::Real),
            "i32" => Some(Kind::Integer),
            "bool" => Some(Kind::Boolean),
            "String" => Some(Kind::Text),
            _ => self.choices.contains(ty).then(|| Kind::Choice(ty.clone())),
        }
    }

    fn shape(&self, ty: &Type, var: &Attributes) -> syn::Result<Shape> {
        if var.flag("hidden").is_some() {
            return Ok(Shape::Hidden);
        }
        if let Some(fields) = &var.fields {
            let kind = self.kind(&fields.ty);
            return kind.map(Shape::Fields).ok_or_else(|| unknown(&fields.ty));
        }
        if let Type::Array(array) = ty {
            let element = ident(&array.elem).ok_or_else(|| unknown(&array.elem))?;
            if self.groups.contains(&element) {
                return Ok(Shape::Repeated(element, length(&array.len)?));
            }
            return match self.kind(&element) {
                Some(kind @ (Kind::Real | Kind::Integer | Kind::Boolean)) => Ok(Shape::Array(kind, array.len.clone())),
                _ => Err(unknown(&array.elem)),
            };
        }
        let name = ident(ty).ok_or_else(|| unknown(ty))?;
        if self.groups.contains(&name) {
            return Ok(Shape::Group(name));
        }
        self.kind(&name).map(Shape::Scalar).ok_or_else(|| unknown(ty))
    }
}

fn unknown(ty: &impl quote::ToTokens) -> syn::Error {
    let text = "a variable is f64, i32, bool, String, an enumeration or a struct of this module, an array of numbers \
                or of such structs; hint: `#[var(fields = f64[x, y, z])]` for a struct of elsewhere, \
                `#[var(hidden, start = ...)]` for what is no variable";
    syn::Error::new_spanned(ty, text)
}

fn ident(ty: &Type) -> Option<Ident> {
    match ty {
        Type::Path(path) if path.qself.is_none() => path.path.get_ident().cloned(),
        _ => None,
    }
}

fn length(expression: &Expr) -> syn::Result<usize> {
    match expression {
        Expr::Lit(ExprLit { lit: Lit::Int(number), .. }) => number.base10_parse(),
        other => Err(syn::Error::new_spanned(other, "a repeated group has its number of uses as a literal")),
    }
}

impl Group {
    fn read(item: ItemStruct, names: &Names) -> syn::Result<Self> {
        let mut attributes = item.attrs;
        let mut root = None;
        for (name, kind) in Root::ALL {
            if attributes.extract_if(.., |attribute| attribute.path().is_ident(name)).count() > 0 {
                root = Some(kind);
            }
        }
        let syn::Fields::Named(fields) = item.fields else {
            return Err(syn::Error::new_spanned(item.ident, "a group of variables is a struct with named fields"));
        };
        let mut errors = Errors::default();
        let fields = fields.named.into_iter().filter_map(|field| errors.keep(Field::read(field, names))).collect();
        errors.end()?;
        Ok(Self { attributes, visibility: item.vis, name: item.ident, root, fields })
    }

    /// Whether a field is, or holds, something without a copy.
    pub fn is_copy(&self, declaration: &Declaration) -> bool {
        self.fields.iter().all(|field| match &field.shape {
            Shape::Scalar(kind) => *kind != Kind::Text,
            Shape::Array(..) | Shape::Fields(_) => true,
            Shape::Group(name) | Shape::Repeated(name, _) => declaration.group(name).is_copy(declaration),
            Shape::Hidden => false,
        })
    }
}

impl Field {
    fn read(field: syn::Field, names: &Names) -> syn::Result<Self> {
        let mut attributes = field.attrs;
        let name = field.ident.expect("a named field has a name");
        let named = |error: syn::Error| syn::Error::new(error.span(), format!("`{name}`: {error}"));
        let var = Attributes::take(&mut attributes).map_err(named)?;
        let shape = names.shape(&field.ty, &var).map_err(named)?;
        let docs = docs(&attributes);
        Ok(Self { attributes, visibility: field.vis, name, ty: field.ty, docs, var, shape })
    }
}

impl Choice {
    fn read(item: ItemEnum) -> syn::Result<Self> {
        let mut items = Vec::new();
        for variant in item.variants {
            if !variant.fields.is_empty() || variant.discriminant.is_some() {
                let text = format!("`{}`: an item is a name alone; the items are numbered from 1", variant.ident);
                return Err(syn::Error::new(variant.ident.span(), text));
            }
            let mut attributes = variant.attrs;
            let hint = take(&mut attributes, "hint", &variant.ident)?;
            let reaction = take(&mut attributes, "reaction", &variant.ident)?;
            let detection = take(&mut attributes, "detection", &variant.ident)?;
            let docs = docs(&attributes);
            items.push(ChoiceItem { attributes, name: variant.ident, docs, hint, reaction, detection });
        }
        let mut attributes = item.attrs;
        let reactions = take(&mut attributes, "reactions", &item.ident)?;
        let docs = docs(&attributes);
        Ok(Self { attributes, visibility: item.vis, name: item.ident, docs, items, reactions })
    }
}

/// Takes `#[name(value)]` out of the attributes; an item has at most one.
fn take<T: Parse>(attributes: &mut Vec<Attribute>, name: &str, of: &Ident) -> syn::Result<Option<T>> {
    let found: Vec<_> = attributes.extract_if(.., |attribute| attribute.path().is_ident(name)).collect();
    if let Some(second) = found.get(1) {
        return Err(syn::Error::new_spanned(second, format!("`{of}`: has `#[{name}]` twice")));
    }
    found.first().map(Attribute::parse_args::<T>).transpose()
}

/// The doc comment as one line without a full stop at its end.
fn docs(attributes: &[Attribute]) -> String {
    let lines = attributes.iter().filter_map(|attribute| match &attribute.meta {
        Meta::NameValue(pair) if pair.path.is_ident("doc") => match &pair.value {
            Expr::Lit(ExprLit { lit: Lit::Str(text), .. }) => Some(text.value().trim().to_owned()),
            _ => None,
        },
        _ => None,
    });
    let text = lines.collect::<Vec<_>>().join(" ");
    text.strip_suffix('.').unwrap_or(&text).trim().to_owned()
}

/// Collects errors, so that one build reports all of them.
#[derive(Default)]
pub struct Errors(Option<syn::Error>);

impl Errors {
    /// The value, or nothing and one more error.
    pub fn keep<T>(&mut self, result: syn::Result<T>) -> Option<T> {
        result.map_err(|error| self.add(error)).ok()
    }

    pub fn add(&mut self, error: syn::Error) {
        match &mut self.0 {
            Some(all) => all.combine(error),
            none => *none = Some(error),
        }
    }

    pub fn end(self) -> syn::Result<()> {
        self.0.map_or(Ok(()), Err)
    }
}
