//! The module that the compiler sees: the structs as written, their start values, and the table.

use proc_macro2::TokenStream;
use quote::{format_ident, quote};
use syn::Ident;

use crate::declaration::{Choice, Declaration, Field, Group, Kind, ReactionItem, Reactions, Root, Shape};
use crate::rows::Row;
use crate::table;

/// The whole module.
pub fn module(declaration: &Declaration, rows: &[Row]) -> TokenStream {
    let Declaration { attributes, visibility, name, others, .. } = declaration;
    let choices = declaration.choices.iter().map(choice);
    let papers = papers(declaration, rows);
    let groups = declaration.groups.iter().map(|group| structure(declaration, group, &papers));
    let vars = variables(declaration, &papers);
    let table = table::emit(declaration, rows);
    quote! {
        #(#attributes)*
        #visibility mod #name {
            #(#others)*
            #(#choices)*
            #(#groups)*
            #vars
            #table
        }
    }
}

fn derives(copy: bool) -> TokenStream {
    let copy = copy.then(|| quote!(Copy,));
    quote! {
        #[derive(Clone, #copy Debug, PartialEq, ::fmi2_export::serde::Serialize, ::fmi2_export::serde::Deserialize)]
        #[serde(crate = "::fmi2_export::serde")]
    }
}

fn choice(choice: &Choice) -> TokenStream {
    let Choice { attributes, visibility, name, docs, items, reactions } = choice;
    let derives = derives(true);
    let names: Vec<_> = items.iter().map(|item| &item.name).collect();
    let numbers: Vec<i32> = (1..).take(items.len()).collect();
    let variants = items.iter().zip(&numbers).map(|(item, number)| {
        let (attributes, name) = (&item.attributes, &item.name);
        quote!(#(#attributes)* #name = #number)
    });
    let table = items.iter().map(|item| {
        let (name, docs) = (item.name.to_string(), &item.docs);
        let text = |text: &Option<syn::LitStr>| text.as_ref().map_or(String::new(), syn::LitStr::value);
        let (hint, detection) = (text(&item.hint), text(&item.detection));
        let reaction = item.reaction.as_ref().map_or(String::new(), Ident::to_string);
        quote!(::fmi2_export::Item {
            name: #name, description: #docs, hint: #hint, reaction: #reaction, detection: #detection,
        })
    });
    let reaction_items = reactions.iter().flat_map(|reactions| &reactions.items).map(|item| {
        let (name, ReactionItem { description, acknowledge, .. }) = (item.name.to_string(), item);
        quote!(::fmi2_export::Reaction { name: #name, description: #description, acknowledge: #acknowledge })
    });
    let reaction = reactions.as_ref().map(|reactions| reaction(choice, reactions));
    let label = name.to_string();
    quote! {
        #(#attributes)*
        #derives
        #[derive(Eq)]
        #[repr(i32)]
        #visibility enum #name { #(#variants,)* }

        impl #name {
            /// All items, in the order of their numbers.
            #[allow(dead_code, reason = "not every enumeration is walked through")]
            #visibility const ALL: &'static [Self] = &[#(Self::#names),*];
            #reaction
        }

        impl ::fmi2_export::Enumeration for #name {
            const TYPE: &'static ::fmi2_export::EnumType =
                &::fmi2_export::EnumType {
                    name: #label, description: #docs, items: &[#(#table),*], reactions: &[#(#reaction_items),*],
                };
            fn from_number(number: i32) -> ::core::option::Option<Self> {
                match number {
                    #(#numbers => ::core::option::Option::Some(Self::#names),)*
                    _ => ::core::option::Option::None,
                }
            }
            fn number(self) -> i32 {
                self as i32
            }
        }
    }
}

/// The reaction to each fault; no fault has the mildest.
fn reaction(choice: &Choice, reactions: &Reactions) -> TokenStream {
    let (visibility, ty) = (&choice.visibility, &reactions.ty);
    let arms = choice.items.iter().map(|item| {
        let reaction = item.reaction.as_ref().unwrap_or(&reactions.items[0].name);
        let name = &item.name;
        quote!(Self::#name => #ty::#reaction)
    });
    quote! {
        /// What the machine does when this fault occurs.
        #visibility const fn reaction(self) -> #ty {
            match self { #(#arms),* }
        }
    }
}

/// Names of the groups that need a constant with the values of the paper: those of the parameters, if any differs.
fn papers(declaration: &Declaration, rows: &[Row]) -> Vec<Ident> {
    fn below(declaration: &Declaration, group: &Group, names: &mut Vec<Ident>) {
        names.push(group.name.clone());
        for field in &group.fields {
            if let Shape::Group(name) | Shape::Repeated(name, _) = &field.shape {
                below(declaration, declaration.group(name), names);
            }
        }
    }
    let mut names = Vec::new();
    if let (Some(root), true) =
        (declaration.root(Root::Parameters), rows.iter().any(|row| row.field.var.paper.is_some()))
    {
        below(declaration, root, &mut names);
    }
    names
}

fn structure(declaration: &Declaration, group: &Group, papers: &[Ident]) -> TokenStream {
    let Group { attributes, visibility, name, fields, .. } = group;
    let derives = derives(group.root.is_none() && group.is_copy(declaration));
    let members = fields.iter().map(|field| {
        let Field { attributes, visibility, name, ty, .. } = field;
        quote!(#(#attributes)* #visibility #name: #ty)
    });
    let start = constant(declaration, group, &format_ident!("START"), "Start values.");
    let paper = papers.contains(name).then(|| {
        constant(
            declaration,
            group,
            &format_ident!("PAPER"),
            "Start values, with those of the paper where they differ.",
        )
    });
    quote! {
        #(#attributes)*
        #derives
        #visibility struct #name { #(#members,)* }

        impl #name {
            #start
            #paper
        }
    }
}

/// `START` or `PAPER` of a group; an array of them where the group is repeated.
fn constant(declaration: &Declaration, group: &Group, constant: &Ident, docs: &str) -> TokenStream {
    let visibility = &group.visibility;
    let values: Vec<_> = group
        .fields
        .iter()
        .map(|field| {
            let (name, value) = (&field.name, start(declaration, field, constant));
            quote!(#name: #value)
        })
        .collect();
    let allow = quote!(#[allow(dead_code, reason = "not every group is started alone")]);
    match repetitions(declaration, &group.name) {
        None => quote!(#[doc = #docs] #allow #visibility const #constant: Self = Self { #(#values),* };),
        Some(count) => {
            let elements = (0..count).map(|i| {
                quote!({
                    #[allow(dead_code, reason = "the uses may be alike")]
                    const INDEX: usize = #i;
                    Self { #(#values),* }
                })
            });
            quote!(#[doc = #docs] #allow #visibility const #constant: [Self; #count] = [#(#elements),*];)
        }
    }
}

/// How often a group is repeated, if it is.
fn repetitions(declaration: &Declaration, name: &Ident) -> Option<usize> {
    declaration.groups.iter().flat_map(|group| &group.fields).find_map(|field| match &field.shape {
        Shape::Repeated(ty, count) if ty == name => Some(*count),
        _ => None,
    })
}

fn start(declaration: &Declaration, field: &Field, constant: &Ident) -> TokenStream {
    let given = match (constant == "PAPER", &field.var.paper) {
        (true, Some(paper)) => Some(paper),
        (true, None) if field.name == "law" && is_switch(declaration, field) => return switched(field),
        _ => field.var.start.as_ref(),
    };
    match (&field.shape, given) {
        (Shape::Group(name) | Shape::Repeated(name, _), _) => quote!(#name::#constant),
        // the table holds the start value of a String
        (Shape::Scalar(Kind::Text), _) => quote!(::std::string::String::new()),
        (_, Some(value)) => quote!(#value),
        (Shape::Scalar(kind), None) => zero(declaration, kind),
        (Shape::Array(kind, length), None) => {
            let zero = zero(declaration, kind);
            quote!([#zero; #length])
        }
        (Shape::Fields(kind), None) => fields_of(declaration, field, kind),
        (Shape::Hidden, None) => unreachable!("the rules ask for a start value"),
    }
}

/// Whether a field is the parameter `law`, which the values of the paper belong to.
fn is_switch(declaration: &Declaration, field: &Field) -> bool {
    let parameters = declaration.root(Root::Parameters);
    parameters.is_some_and(|group| group.fields.iter().any(|own| std::ptr::eq(own, field)))
}

fn switched(field: &Field) -> TokenStream {
    let law = &field.ty;
    quote!(#law::Paper)
}

fn fields_of(declaration: &Declaration, field: &Field, kind: &Kind) -> TokenStream {
    let zero = zero(declaration, kind);
    let names = field.var.fields.iter().flat_map(|fields| &fields.names);
    let syn::Type::Path(path) = &field.ty else { unreachable!("a struct has a path") };
    let path = without_arguments(path);
    quote!(#path { #(#names: #zero),* })
}

/// The path of a struct without its generic arguments, for a literal.
fn without_arguments(path: &syn::TypePath) -> syn::Path {
    let mut path = path.path.clone();
    path.segments.iter_mut().for_each(|segment| segment.arguments = syn::PathArguments::None);
    path
}

fn zero(declaration: &Declaration, kind: &Kind) -> TokenStream {
    match kind {
        Kind::Real => quote!(0.0),
        Kind::Integer => quote!(0),
        Kind::Boolean => quote!(false),
        Kind::Text => quote!(::std::string::String::new()),
        Kind::Choice(name) => {
            let choice = declaration.choices.iter().find(|choice| choice.name == *name);
            let first = choice.and_then(|choice| choice.items.first()).map(|item| &item.name);
            quote!(#name::#first)
        }
    }
}

/// The struct of all variables.
fn variables(declaration: &Declaration, papers: &[Ident]) -> TokenStream {
    let derives = derives(false);
    let (mut members, mut starts) = (Vec::new(), Vec::new());
    for (root, docs) in
        [(Root::Inputs, "Inputs."), (Root::Outputs, "Outputs."), (Root::Parameters, "Parameters as they were set.")]
    {
        if let Some(group) = declaration.root(root) {
            let (field, ty) = (root.field(), &group.name);
            members.push(quote!(#[doc = #docs] pub #field: #ty));
            starts.push(quote!(#field: #ty::START));
        }
    }
    if let (Some(group), false) = (declaration.root(Root::Parameters), papers.is_empty()) {
        let ty = &group.name;
        members.push(quote!(#[doc = "Parameters in force: those that the model uses."] pub in_force: #ty));
        starts.push(quote!(in_force: #ty::START));
    }
    quote! {
        /// All variables of the FMU.
        #derives
        pub struct Vars { #(#members,)* }

        impl Vars {
            /// Start values.
            const START: Self = Self { #(#starts),* };
        }
    }
}
