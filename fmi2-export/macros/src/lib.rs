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

/// Makes the variable table of an FMU from one module of plain structs: each variable is declared once.
///
/// The module holds at most one struct each with `#[inputs]`, `#[outputs]` and `#[parameters]`, the structs of their
/// groups, and enumerations. The macro adds the usual derives (with serde), start values `START` for every struct, a
/// struct `Vars { input, output, parameters }` of all variables, and its variable table.
///
/// | field | variable |
/// |---|---|
/// | `f64`, `i32`, `bool`, `String` | Real, Integer, Boolean, String |
/// | an enum of the module | Enumeration; the items are numbered from 1 |
/// | `[f64; N]`, `[i32; N]`, `[bool; N]` | an array: `name[1]` to `name[N]` |
/// | a struct of the module | a group: `field.name` |
/// | `[Group; 6]` | a group used six times: `field1.name` to `field6.name`; its attributes may use the constant `INDEX` (from 0), its doc comments `{n}` (from 1) |
/// | any struct with `#[var(fields = f64[x, y, z])]` | one variable for each of the named fields |
///
/// The doc comment is the description; a field without one takes that of its struct or enumeration, and that of a group is
/// the introduction to its parameters on the page. `#[var(...)]` takes
///
/// | key | meaning |
/// |---|---|
/// | `name = "spindle.speed"` | FMI name, where it is not the path of the field; with `fields` the part before their names; not in a repeated group |
/// | `unit = METRE as "um"` | unit of a Real, and the display unit, which may be left out |
/// | `range = 0.0..=1.0` | allowed values, both ends included |
/// | `start = 0.5` | start value; otherwise zero, false, empty, or the first item |
/// | `paper = 0.3` | value of the published variant, where it differs: the constant `PAPER` holds it, and so does the field `in_force` of `Vars` where the parameter `law` is `Paper` and the importer has not set the parameter; of a `hidden` field only `PAPER` holds it |
/// | `source = "derived: ..."` | the reason of the start value |
/// | `nominal = 1e-3` | usual magnitude of a Real |
/// | `tunable`, `calculated` | a parameter that may change between steps; one that `Model::calculate` computes |
/// | `essential`, `expert` | the tier of a parameter: to be set on every machine; for specialists. Expert parameters are listed last, and their names start with `expert.` |
/// | `local` | an output that is only plotted; packers restore it as an output by `cargo fmu --outputs all` |
/// | `accepts_nan` | NaN and infinities of a Real input reach the model |
/// | `hidden` | a field that the model reads and that is not a variable; needs `start` |
///
/// `local` and `expert` at a group are valid for all of its variables.
///
/// A Real parameter `sample_period` is the sample period of the model.
///
/// An item of an enumeration takes `#[hint("...")]`: what to do about it. An enumeration of faults declares its
/// reactions, the mildest first, and for each fault the reaction, how it is detected, and the remedy. Its first item
/// means that there is no fault. The macro adds the function `reaction`.
///
/// ```ignore
/// #[reactions(Reaction,
///     Stop = ["Stops and holds", "Rising edge of `reset_fault` at rest"],
///     DriveOff = ["Switches the drive off", "Rising edge of `reset_fault`"])]
/// pub enum Fault {
///     /// No fault
///     None,
///     /// The position does not change
///     #[reaction(DriveOff)] #[detection("More than 1 um of travel without a change")] #[hint("Check the encoder.")]
///     PositionFrozen,
/// }
/// ```
///
/// Where the outputs have enumerations `state` and `fault`, each new item is reported to the importer, with meaning and
/// hint.
///
/// A declaration that breaks a rule does not compile; the error names the field and the rule.
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
