//! The rules of a declaration; each error is reported at its position, with the name of the field and the rule.
//!
//! Rules about values (ranges, start values, units) are kept by `fmi2-export` when it makes the table.

use std::collections::HashMap;

use proc_macro2::Span;
use syn::Ident;

use crate::declaration::{Choice, Declaration, Errors, Field, Group, Kind, Root, Shape};
use crate::rows::Row;

/// Checks the declaration.
///
/// # Errors
/// Everything that breaks a rule.
pub fn check(declaration: &Declaration, rows: &[Row]) -> syn::Result<()> {
    let mut errors = Errors::default();
    declaration.choices.iter().for_each(|choice| check_choice(choice, &mut errors));
    for group in &declaration.groups {
        group.fields.iter().for_each(|field| check_field(field, &mut errors));
    }
    rows.iter().for_each(|row| check_role(row, &mut errors));
    check_roots(declaration, &mut errors);
    check_names(rows, &mut errors);
    check_use(declaration, rows, &mut errors);
    check_paper(declaration, rows, &mut errors);
    errors.end()
}

fn refuse(errors: &mut Errors, span: Span, name: &Ident, rule: &str) {
    errors.add(syn::Error::new(span, format!("`{name}`: {rule}")));
}

fn check_choice(choice: &Choice, errors: &mut Errors) {
    if choice.docs.is_empty() {
        refuse(errors, choice.name.span(), &choice.name, "an enumeration needs a description: a doc comment");
    }
    if choice.items.is_empty() {
        refuse(errors, choice.name.span(), &choice.name, "an enumeration needs items");
    }
    for item in choice.items.iter().filter(|item| item.docs.is_empty()) {
        refuse(errors, item.name.span(), &item.name, "an item needs a description: a doc comment");
    }
    check_reactions(choice, errors);
}

/// In an enumeration of faults every item but the first, no fault, has a reaction, a detection and a hint.
fn check_reactions(choice: &Choice, errors: &mut Errors) {
    let known: Vec<_> = choice.reactions.iter().flat_map(|reactions| &reactions.items).map(|item| &item.name).collect();
    for (i, item) in choice.items.iter().enumerate() {
        let is_whole = item.reaction.is_some() && item.detection.is_some() && item.hint.is_some();
        let rule = match &item.reaction {
            None if item.detection.is_some() && known.is_empty() => {
                "a detection needs `#[reactions]` at the enumeration"
            }
            Some(reaction) if !known.contains(&reaction) => "this reaction is not listed in `#[reactions]`",
            _ if !known.is_empty() && i > 0 && !is_whole => {
                "a fault has `#[reaction(...)]`, `#[detection(\"...\")]` and `#[hint(\"...\")]`"
            }
            _ => continue,
        };
        refuse(errors, item.name.span(), &item.name, rule);
    }
}

fn check_field(field: &Field, errors: &mut Errors) {
    let mut must = |holds: bool, span: Option<Span>, rule: &str| {
        if let (false, Some(span)) = (holds, span) {
            refuse(errors, span, &field.name, rule);
        }
    };
    let var = &field.var;
    let kind = match &field.shape {
        Shape::Scalar(kind) | Shape::Array(kind, _) | Shape::Fields(kind) => Some(kind),
        Shape::Group(_) | Shape::Repeated(..) | Shape::Hidden => None,
    };
    let real = kind == Some(&Kind::Real);
    let group = matches!(field.shape, Shape::Group(_) | Shape::Repeated(..));
    let at = Some(field.name.span());
    let start = var.start.as_ref().map(syn::spanned::Spanned::span);
    must(!field.docs.is_empty(), at, "needs a description: a doc comment");
    must(!matches!(field.visibility, syn::Visibility::Inherited), at, "must be `pub`: the model reads it");
    must(real, var.unit.as_ref().map(|unit| unit.span), "only a Real (f64) has a unit");
    must(real, var.nominal.as_ref().map(syn::spanned::Spanned::span), "only a Real (f64) has a nominal value");
    must(real, var.flag("accepts_nan").map(Ident::span), "only a Real (f64) can be NaN");
    must(real || kind == Some(&Kind::Integer), var.range.as_ref().map(|range| range.span), "only a number has a range");
    must(kind.is_some(), var.name.as_ref().map(syn::LitStr::span), "only a variable has a name of its own");
    must(!group, start, "a group starts as its fields do");
    must(
        !group,
        var.paper.as_ref().map(syn::spanned::Spanned::span),
        "a group has no value of the paper, its fields have",
    );
    must(start.is_some() || kind.is_some() || group, at, "what is no variable needs `start = ...`");
    let tiers = ["essential", "expert"];
    let kinds = ["tunable", "calculated", "local", "accepts_nan", "hidden"];
    for alternatives in [&tiers[..], &kinds[..]] {
        let found: Vec<_> = alternatives.iter().filter_map(|flag| var.flag(flag)).collect();
        let rule = format!("has at most one of the flags `{}`", alternatives.join("`, `"));
        must(found.len() < 2, found.last().map(|flag| flag.span()), &rule);
    }
    let of_a_group = |flag: &&Ident| *flag == "local" || *flag == "expert";
    let misplaced = var.flags.iter().find(|flag| !of_a_group(flag));
    must(!group, misplaced.map(Ident::span), "a group takes only the flags `local` and `expert`");
}

/// Checks the rules that depend on the use of the field: as input, output or parameter, and in which groups.
fn check_role(row: &Row, errors: &mut Errors) {
    let allowed = |flag: &str| match flag {
        "accepts_nan" => row.root == Root::Inputs,
        "local" => row.root == Root::Outputs,
        _ => row.root == Root::Parameters,
    };
    let fields = std::iter::once(&row.field).chain(&row.around);
    let flags = fields.flat_map(|field| field.var.flags.iter().map(|flag| (&field.name, flag)));
    for (name, flag) in flags.filter(|(_, flag)| !allowed(&flag.to_string())) {
        let rule = match flag.to_string().as_str() {
            "accepts_nan" => "only an input accepts NaN",
            "local" => "only an output can be local",
            "essential" | "expert" => "only a parameter has a tier",
            _ => "only a parameter is tunable or calculated",
        };
        refuse(errors, flag.span(), name, rule);
    }
    if let (Some(flag), true) =
        (row.field.var.flag("essential"), row.around.iter().any(|field| field.var.flag("expert").is_some()))
    {
        refuse(errors, flag.span(), &row.field.name, "its group is for specialists: it cannot be essential");
    }
    if let (true, "sample_period" | "law", Some(flag)) =
        (row.around.is_empty(), row.field.name.to_string().as_str(), row.field.var.flag("expert"))
    {
        refuse(errors, flag.span(), &row.field.name, "the exporter uses it by this name: it cannot be `expert`");
    }
    if let (Some(name), Some(0)) = (&row.field.var.name, row.index) {
        refuse(
            errors,
            name.span(),
            &row.field.name,
            "a variable of a repeated group is there several times, under no one name",
        );
    }
    if let (Some(paper), true) = (&row.field.var.paper, row.root != Root::Parameters) {
        refuse(
            errors,
            syn::spanned::Spanned::span(paper),
            &row.field.name,
            "only a parameter has a value of the paper",
        );
    }
}

fn check_roots(declaration: &Declaration, errors: &mut Errors) {
    let mut roots: Vec<Root> = Vec::new();
    for (group, root) in declaration.groups.iter().filter_map(|group| Some((group, group.root?))) {
        if roots.contains(&root) {
            refuse(errors, group.name.span(), &group.name, "inputs, outputs and parameters are one struct each");
        }
        roots.push(root);
    }
    if roots.is_empty() {
        let rule = "has no struct with `#[inputs]`, `#[outputs]` or `#[parameters]`";
        refuse(errors, declaration.name.span(), &declaration.name, rule);
    }
}

fn check_names(rows: &[Row], errors: &mut Errors) {
    let mut known = HashMap::new();
    for row in rows {
        if known.insert(row.name.as_str(), ()).is_some() {
            let rule = format!("two variables are named `{}`", row.name);
            refuse(errors, row.field.name.span(), &row.field.name, &rule);
        }
    }
}

/// Nothing may be declared in vain.
fn check_use(declaration: &Declaration, rows: &[Row], errors: &mut Errors) {
    let holds = |group: &Group, name: &Ident| {
        let is = |field: &Field| matches!(&field.shape, Shape::Group(ty) | Shape::Repeated(ty, _) if ty == name);
        group.fields.iter().any(is)
    };
    for group in declaration.groups.iter().filter(|group| group.root.is_none()) {
        if !declaration.groups.iter().any(|other| holds(other, &group.name)) {
            refuse(errors, group.name.span(), &group.name, "is in no table: no field has this type");
        }
    }
    for choice in &declaration.choices {
        if !rows.iter().any(|row| *row.kind == Kind::Choice(choice.name.clone())) {
            refuse(errors, choice.name.span(), &choice.name, "is in no table: no field has this type");
        }
    }
    repeated_alike(declaration, errors);
}

/// A group is used alone or repeated, always as often.
fn repeated_alike(declaration: &Declaration, errors: &mut Errors) {
    let mut counts: HashMap<String, Option<usize>> = HashMap::new();
    for field in declaration.groups.iter().flat_map(|group| &group.fields) {
        let (name, count) = match &field.shape {
            Shape::Group(name) => (name, None),
            Shape::Repeated(name, count) => (name, Some(*count)),
            _ => continue,
        };
        if *counts.entry(name.to_string()).or_insert(count) != count {
            refuse(errors, field.name.span(), &field.name, "a struct is one group or a repeated one, always as often");
        }
    }
}

/// Values of the paper need the switch that brings them into force.
fn check_paper(declaration: &Declaration, rows: &[Row], errors: &mut Errors) {
    let Some(row) = rows.iter().find(|row| row.field.var.paper.is_some()) else { return };
    let switch = rows.iter().find(|row| row.name == "law" && row.root == Root::Parameters);
    let choice = switch.and_then(|row| match row.kind {
        Kind::Choice(name) => declaration.choices.iter().find(|choice| choice.name == *name),
        _ => None,
    });
    if !choice.is_some_and(|choice| choice.items.iter().any(|item| item.name == "Paper")) {
        let rule = "a value of the paper needs a parameter `law`, an enumeration with the item `Paper`";
        refuse(errors, row.field.name.span(), &row.field.name, rule);
    }
}
