//! The rows of the variable table, as `fmi2-export` takes them.

use proc_macro2::{Span, TokenStream};
use quote::{quote, quote_spanned};
use syn::Ident;

use crate::declaration::{Declaration, Kind, Root};
use crate::force;
use crate::rows::Row;

/// The table, and a check of each row at the position of its field.
pub fn emit(declaration: &Declaration, rows: &[Row]) -> TokenStream {
    let parameters = declaration.root(Root::Parameters).map(|group| &group.name);
    let paper = rows.iter().any(|row| row.field.var.paper.is_some());
    let paper = paper.then(|| quote!(const PAPER: &#parameters = &#parameters::PAPER;));
    let table = rows.iter().map(row);
    let (into_force, sample_period) = (force::bring_into_force(declaration, rows), force::sample_period(rows));
    let status = status(rows);
    let checks = rows.iter().enumerate().map(|(i, row)| {
        quote_spanned!(row.field.name.span()=>
            const _: () = ::fmi2_export::check_variable(&<Vars as ::fmi2_export::Interface>::TABLE[#i]);)
    });
    quote! {
        impl ::fmi2_export::Interface for Vars {
            const START: Self = Vars::START;
            const TABLE: &'static [::fmi2_export::Variable<Self>] = {
                const START: &Vars = &Vars::START;
                #paper
                &[#(#table),*]
            };
            #into_force
            #sample_period
            #status
        }

        #(#checks)*
    }
}

/// The items of the outputs `state` and `fault`.
fn status(rows: &[Row]) -> Option<TokenStream> {
    let choice = |name: &str| {
        let is = |row: &&Row| row.root == Root::Outputs && row.name == name && matches!(row.kind, Kind::Choice(_));
        rows.iter().find(is).map(Row::access)
    };
    let item = |access: &TokenStream| quote!(::fmi2_export::Enumeration::item(self.#access));
    let state =
        choice("state").map(|access| item(&access)).map(|item| quote!(state: ::core::option::Option::Some(#item),));
    let fault = choice("fault").map(|access| {
        let item = item(&access);
        let is_one = quote!(::fmi2_export::Enumeration::number(self.#access) != 1);
        quote!(fault: ::core::option::Option::Some(#item).filter(|_| #is_one),)
    });
    (state.is_some() || fault.is_some()).then(|| {
        quote! {
            #[inline]
            fn status(&self) -> ::fmi2_export::Report {
                #[allow(clippy::needless_update, reason = "a model may have one of the two")]
                ::fmi2_export::Report { #state #fault ..::core::default::Default::default() }
            }
        }
    })
}

fn row(row: &Row) -> TokenStream {
    let new = new(row);
    let role = role(row);
    let (docs, head) = (row.description(), row.head());
    let head = (!head.is_empty()).then(|| quote!(.head(#head)));
    let tier = ["essential", "expert"].into_iter().find(|tier| row.flag(tier));
    let tier = tier.map(|tier| Ident::new(tier, Span::call_site())).map(|tier| quote!(.#tier()));
    let var = &row.field.var;
    let unit = var.unit.as_ref().map(|unit| {
        let display = unit.display.as_ref().map(|display| quote!(.display(#display)));
        let unit = &unit.unit;
        quote!(.unit(&#unit) #display)
    });
    let range = var.range.as_ref().map(|range| {
        let (low, high) = (&range.low, &range.high);
        if *row.kind == Kind::Integer { quote!(.range_int(#low, #high)) } else { quote!(.range(#low, #high)) }
    });
    let nominal = var.nominal.as_ref().map(|nominal| quote!(.nominal(#nominal)));
    let accepts_nan = var.flag("accepts_nan").map(|_| quote!(.accepts_nan()));
    let source = var.source.as_ref().map(|source| quote!(.source(#source)));
    let paper = paper(row);
    let text = match (row.kind, &var.start) {
        (Kind::Text, Some(start)) => Some(quote!(.start_text(#start))),
        _ => None,
    };
    let index = row.index.map(|index| {
        quote! {
            #[allow(dead_code, reason = "the uses may be alike")]
            const INDEX: usize = #index;
        }
    });
    quote!({ #index #new.#role() #unit #range #nominal #accepts_nan #text .describe(#docs) #head #source #paper #tier })
}

/// The constructor with name, start value and accessors.
fn new(row: &Row) -> TokenStream {
    let (name, access) = (&row.name, row.access());
    let new = match row.kind {
        Kind::Real => quote!(new_real),
        Kind::Integer => quote!(new_integer),
        Kind::Boolean => quote!(new_boolean),
        Kind::Text => {
            return quote! {
                ::fmi2_export::Variable::<Vars>::new_text(
                    #name,
                    |vars| &vars.#access,
                    |vars, value| value.clone_into(&mut vars.#access),
                )
            };
        }
        Kind::Choice(ty) => {
            return quote! {
                ::fmi2_export::Variable::<Vars>::new_choice(
                    #name,
                    <#ty as ::fmi2_export::Enumeration>::TYPE,
                    START.#access as i32,
                    |vars| vars.#access as i32,
                    |vars, number| {
                        if let ::core::option::Option::Some(item) =
                            <#ty as ::fmi2_export::Enumeration>::from_number(number)
                        {
                            vars.#access = item;
                        }
                    },
                )
            };
        }
    };
    let (size, elements) = match row.length {
        None => (quote!(None), quote!(::core::slice::from_ref(&START.#access))),
        Some(length) => (quote!(Some(#length)), quote!(&START.#access)),
    };
    // the elements are a field of the start values, reached through fields and elements of arrays
    quote!(unsafe { ::fmi2_export::Variable::<Vars>::#new(#name, ::core::option::Option::#size, START, #elements) })
}

fn role(row: &Row) -> TokenStream {
    let flag = |name| row.flag(name);
    match row.root {
        Root::Inputs => quote!(input),
        Root::Outputs if flag("local") => quote!(local),
        Root::Outputs => quote!(output),
        Root::Parameters if flag("tunable") => quote!(tunable),
        Root::Parameters if flag("calculated") => quote!(calculated),
        Root::Parameters => quote!(parameter),
    }
}

/// The paper's value as a number, that of a String as it is, for the documentation.
fn paper(row: &Row) -> Option<TokenStream> {
    let given = row.field.var.paper.as_ref()?;
    let way = &row.way;
    let component = row.component.map(|component| quote!(.#component));
    let element = row.length.map(|_| quote!([0]));
    let value = quote!(PAPER.#way #component #element);
    Some(match row.kind {
        Kind::Real => quote!(.paper(#value)),
        Kind::Text => quote!(.paper_text(#given)),
        _ => quote!(.paper(#value as i32 as f64)),
    })
}
