//! The declaration macro of `fmi2-export`; use it as `fmi2_export::interface`, where it is documented.
#![forbid(unsafe_code)]

mod attributes;
mod declaration;
mod emit;
mod force;
mod rows;
mod rules;
mod table;

use proc_macro::TokenStream;
use syn::{ItemMod, parse_macro_input};

/// Makes the variable table of an FMU from one module of plain structs: each variable is told once.
///
/// The module holds at most one struct each with `#[inputs]`, `#[outputs]` and `#[parameters]`, the structs of their
/// groups, and enumerations. The macro adds the usual derives (with serde), start values `START` for every struct, a
/// struct `Vars { input, output, parameters }` of all variables, and its variable table.
///
/// | field | variable |
/// |---|---|
/// | `f64`, `i32`, `bool`, `String` | Real, Integer, Boolean, String |
/// | an enum of the module | Enumeration; the items are numbered from 1, `#[hint("...")]` on an item says what to do about it |
/// | `[f64; N]`, `[i32; N]`, `[bool; N]` | an array: `name[1]` to `name[N]` |
/// | a struct of the module | a group: `field.name` |
/// | `[Group; 6]` | a group used six times: `field1.name` to `field6.name`; its attributes may use the constant `INDEX` (from 0), its doc comments `{n}` (from 1) |
/// | any struct with `#[var(fields = f64[x, y, z])]` | one variable for each of the named fields |
///
/// The doc comment is the description; a field without one takes that of its struct or enumeration, and that of a group stands above its parameters in the page. `#[var(...)]` takes
///
/// | key | meaning |
/// |---|---|
/// | `name = "spindle.speed"` | FMI name, where it is not the path of the field; with `fields` what stands before theirs; not in a repeated group |
/// | `unit = METRE as "um"` | unit of a Real, and the display unit, which may be left out |
/// | `range = 0.0..=1.0` | allowed values, both ends included |
/// | `start = 0.5` | start value; else zero, false, empty, or the first item |
/// | `paper = 0.3` | value of the paper that the model follows, where it differs: the constant `PAPER` holds it, and so does the field `in_force` of `Vars` where the parameter `law` is `Paper` and the importer has not set the parameter; of a `hidden` field only `PAPER` knows it |
/// | `source = "derived: ..."` | where the start value comes from |
/// | `nominal = 1e-3` | usual magnitude of a Real |
/// | `tunable`, `calculated` | a parameter that may change between steps; one that `Model::calculate` computes |
/// | `local` | an output that is only worth plotting |
/// | `accepts_nan` | NaN and infinities of a Real input reach the model |
/// | `hidden` | a field that the law reads and that is no variable; needs `start` |
///
/// A Real parameter `sample_period` is the sample period of the model.
///
/// Where the outputs have enumerations `state` and `fault`, the importer is told of each new one, with meaning and hint; the
/// first fault means that there is none.
///
/// What breaks a rule does not compile, and the error names the field and the rule.
#[proc_macro_attribute]
pub fn interface(arguments: TokenStream, item: TokenStream) -> TokenStream {
    let arguments = proc_macro2::TokenStream::from(arguments);
    let module = parse_macro_input!(item as ItemMod);
    expand(&arguments, module).unwrap_or_else(syn::Error::into_compile_error).into()
}

fn expand(arguments: &proc_macro2::TokenStream, module: ItemMod) -> syn::Result<proc_macro2::TokenStream> {
    if !arguments.is_empty() {
        return Err(syn::Error::new_spanned(arguments, "`interface` takes no arguments"));
    }
    let declaration = declaration::Declaration::read(module)?;
    let rows = rows::collect(&declaration);
    rules::check(&declaration, &rows)?;
    Ok(emit::module(&declaration, &rows))
}
