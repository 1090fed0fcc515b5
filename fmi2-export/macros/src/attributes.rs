//! The content of `#[var(...)]`.

use proc_macro2::{Span, TokenStream};
use quote::quote;
use syn::parse::{Parse, ParseStream};
use syn::punctuated::Punctuated;
use syn::{Attribute, Expr, ExprRange, Ident, LitStr, Path, RangeLimits, Token, bracketed};

/// Keys of `#[var(...)]`, in the order of the documentation.
const KEYS: &str = "`name`, `unit`, `range`, `start`, `paper`, `nominal`, `source`, `fields`, `tunable`, `calculated`, `local`, `essential`, `expert`, `accepts_nan`, `hidden`";

/// The settings of one field.
#[derive(Default)]
pub struct Attributes {
    pub name: Option<LitStr>,
    pub unit: Option<Unit>,
    pub range: Option<Range>,
    pub start: Option<Expr>,
    pub paper: Option<Expr>,
    pub nominal: Option<Expr>,
    pub source: Option<LitStr>,
    pub fields: Option<Fields>,
    /// Flags by name, with their positions in the source.
    pub flags: Vec<Ident>,
}

/// `METRE as "um"`; an element of a constant array, `JOINT[INDEX]`, may stand for either.
pub struct Unit {
    pub unit: TokenStream,
    pub display: Option<TokenStream>,
    pub span: Span,
}

/// `low..=high`.
pub struct Range {
    pub low: Expr,
    pub high: Expr,
    pub span: Span,
}

/// `f64[x, y, z]`: the fields of a struct that is declared elsewhere, each a variable.
pub struct Fields {
    pub ty: Ident,
    pub names: Vec<Ident>,
}

impl Attributes {
    /// Takes `#[var(...)]` out of the attributes of a field.
    pub fn take(attributes: &mut Vec<Attribute>) -> syn::Result<Self> {
        let mut found = None;
        for attribute in attributes.extract_if(.., |attribute| attribute.path().is_ident("var")) {
            if found.is_some() {
                return Err(syn::Error::new_spanned(attribute, "a field has one `#[var(...)]`"));
            }
            found = Some(attribute.parse_args::<Self>()?);
        }
        Ok(found.unwrap_or_default())
    }

    /// A flag with its position in the source, if it is set.
    pub fn flag(&self, name: &str) -> Option<&Ident> {
        self.flags.iter().find(|flag| *flag == name)
    }
}

impl Parse for Attributes {
    fn parse(input: ParseStream) -> syn::Result<Self> {
        let mut attributes = Self::default();
        let mut seen: Vec<Ident> = Vec::new();
        while !input.is_empty() {
            let key: Ident = input.parse()?;
            if seen.contains(&key) {
                return Err(syn::Error::new(key.span(), format!("`{key}` is given twice")));
            }
            attributes.read(&key, input)?;
            seen.push(key);
            if !input.is_empty() {
                input.parse::<Token![,]>()?;
            }
        }
        Ok(attributes)
    }
}

impl Attributes {
    /// Reads what follows a key.
    fn read(&mut self, key: &Ident, input: ParseStream) -> syn::Result<()> {
        match key.to_string().as_str() {
            "tunable" | "calculated" | "local" | "essential" | "expert" | "accepts_nan" | "hidden" => {
                self.flags.push(key.clone());
                return Ok(());
            }
            "name" | "unit" | "range" | "start" | "paper" | "nominal" | "source" | "fields" => {
                input.parse::<Token![=]>()?
            }
            _ => {
                let text = format!("there is no key `{key}`; the keys are {KEYS}");
                return Err(syn::Error::new(key.span(), text));
            }
        };
        match key.to_string().as_str() {
            "name" => self.name = Some(input.parse()?),
            "unit" => self.unit = Some(Unit::read(key, input)?),
            "range" => self.range = Some(Range::read(input)?),
            "start" => self.start = Some(input.parse()?),
            "paper" => self.paper = Some(input.parse()?),
            "nominal" => self.nominal = Some(input.parse()?),
            "source" => self.source = Some(input.parse()?),
            _ => self.fields = Some(Fields::read(input)?),
        }
        Ok(())
    }
}

impl Unit {
    fn read(key: &Ident, input: ParseStream) -> syn::Result<Self> {
        let unit = constant(input)?;
        let display = if input.parse::<Option<Token![as]>>()?.is_none() {
            None
        } else if let Some(name) = input.parse::<Option<LitStr>>()? {
            Some(quote!(#name))
        } else {
            Some(constant(input)?)
        };
        Ok(Self { unit, display, span: key.span() })
    }
}

/// A constant, or an element of one: `METRE`, `units::METRE`, `JOINT[INDEX]`.
fn constant(input: ParseStream) -> syn::Result<TokenStream> {
    let path = input.call(Path::parse_mod_style)?;
    if !input.peek(syn::token::Bracket) {
        return Ok(quote!(#path));
    }
    let content;
    bracketed!(content in input);
    let index: Expr = content.parse()?;
    Ok(quote!(#path[#index]))
}

impl Range {
    fn read(input: ParseStream) -> syn::Result<Self> {
        let expression: Expr = input.parse()?;
        let span = syn::spanned::Spanned::span(&expression);
        match expression {
            Expr::Range(ExprRange { start: Some(low), limits: RangeLimits::Closed(_), end: Some(high), .. }) => {
                Ok(Self { low: *low, high: *high, span })
            }
            other => Err(syn::Error::new_spanned(other, "a range has both ends: `low..=high`")),
        }
    }
}

impl Fields {
    fn read(input: ParseStream) -> syn::Result<Self> {
        let ty = input.parse()?;
        let content;
        bracketed!(content in input);
        let names = Punctuated::<Ident, Token![,]>::parse_terminated(&content)?;
        Ok(Self { ty, names: names.into_iter().collect() })
    }
}
