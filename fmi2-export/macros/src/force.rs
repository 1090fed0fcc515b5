//! The parameters that the model uses: those that were set, and those of the published variant.

use proc_macro2::TokenStream;
use quote::quote;

use crate::declaration::{Declaration, Kind, Root};
use crate::rows::Row;

/// The parameters in force: where `law` is `Paper`, what the paper sets otherwise and the importer has not set takes the
/// value of the paper.
pub fn bring_into_force(declaration: &Declaration, rows: &[Row]) -> Option<TokenStream> {
    let group = declaration.root(Root::Parameters)?;
    if !rows.iter().any(|row| row.field.var.paper.is_some()) {
        return None;
    }
    let law = group.fields.iter().find(|field| field.name == "law").map(|field| &field.ty);
    let differs = |(_, row): &(usize, &Row)| row.field.var.paper.is_some() && row.name != "law";
    let takes = rows.iter().enumerate().filter(differs).map(|(i, row)| take_paper(&group.name, i, row));
    Some(quote! {
        #[allow(unused_variables, reason = "the variants may differ in `law` only")]
        fn bring_into_force(&mut self, is_set: impl ::core::ops::Fn(usize) -> bool) {
            self.in_force = self.parameters.clone();
            if self.parameters.law == #law::Paper {
                #(#takes)*
            }
        }
    })
}

/// Puts the value of the paper into a parameter that was not set; of an array into each such element.
fn take_paper(parameters: &syn::Ident, index: usize, row: &Row) -> TokenStream {
    let (way, component) = (&row.way, row.component.map(|component| quote!(.#component)));
    let reference =
        quote!(const { ::fmi2_export::__private::reference(<Self as ::fmi2_export::Interface>::TABLE, #index) });
    if row.length.is_some() {
        return quote! {
            for (i, value) in #parameters::PAPER.#way.into_iter().enumerate() {
                if !is_set(#reference + i) {
                    self.in_force.#way[i] = value;
                }
            }
        };
    }
    let value = match (row.kind, &row.field.var.paper) {
        // the constants do not hold the values of a String
        (Kind::Text, Some(text)) => quote!(::std::string::String::from(#text)),
        _ => quote!(#parameters::PAPER.#way #component),
    };
    quote! {
        if !is_set(#reference) {
            self.in_force.#way #component = #value;
        }
    }
}

/// The parameter `sample_period`, as it is in force.
pub fn sample_period(rows: &[Row]) -> Option<TokenStream> {
    let is = |row: &&Row| row.root == Root::Parameters && row.name == "sample_period" && *row.kind == Kind::Real;
    let row = rows.iter().find(is).filter(|row| row.length.is_none())?;
    let way = &row.way;
    let paper = rows.iter().any(|row| row.field.var.paper.is_some());
    let parameters = if paper { quote!(in_force) } else { quote!(parameters) };
    Some(quote! {
        #[inline]
        fn sample_period(&self) -> ::core::option::Option<f64> {
            ::core::option::Option::Some(self.#parameters.#way)
        }
    })
}
