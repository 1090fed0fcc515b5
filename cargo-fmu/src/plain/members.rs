//! Members of the C structs: a group of variables is a struct, an array an array.

use std::fmt::Write as _;

use anyhow::{Result, bail};

use super::template::comment;
use crate::interface::{Quantity, Type};

/// Words of C and C++ that a variable may be named with, and a member not; it gets a `_` at its end.
const TAKEN: &str = "alignas alignof and and_eq asm auto bitand bitor bool break case catch char char16_t char32_t char8_t \
    class co_await co_return co_yield compl concept const const_cast consteval constexpr constinit continue decltype default \
    delete do double dynamic_cast else enum explicit export extern false final float for friend goto if import inline int \
    long module mutable namespace new noexcept not not_eq nullptr operator or or_eq override private protected public \
    register reinterpret_cast requires restrict return short signed sizeof static static_assert static_cast struct switch \
    template this thread_local throw true try typedef typeid typename union unsigned using virtual void volatile wchar_t \
    while xor xor_eq";

/// A member of a struct.
enum Member<'a> {
    /// A variable, and its number of elements if it is an array.
    Scalar(&'a Quantity, Option<usize>),
    Group(Vec<(String, Member<'a>)>),
}

/// The members of a struct that holds these variables, one a line.
///
/// # Errors
/// When one name is both a value and a group, which C cannot distinguish.
pub fn declare<'a>(identifier: &str, variables: impl Iterator<Item = &'a Quantity>) -> Result<String> {
    let mut members = Vec::new();
    for variable in variables {
        insert(&mut members, &variable.name, variable)?;
    }
    let mut text = String::new();
    write(&mut text, identifier, &members, 1);
    Ok(text)
}

/// A variable as a member of a struct: `axis1.gain[0]` for `axis1.gain[1]`.
pub fn path(name: &str) -> String {
    let parts = name.split('.').map(|part| match element(part) {
        (part, Some(number)) => format!("{}[{}]", word(part), number - 1),
        (part, None) => word(part),
    });
    parts.collect::<Vec<_>>().join(".")
}

fn insert<'a>(members: &mut Vec<(String, Member<'a>)>, name: &str, variable: &'a Quantity) -> Result<()> {
    let (head, rest) = name.split_once('.').map_or((name, None), |(head, rest)| (head, Some(rest)));
    let (part, number) = element(head);
    let part = word(part);
    let found = members.iter_mut().find(|(known, _)| *known == part).map(|(_, member)| member);
    match (found, rest) {
        (Some(Member::Group(inner)), Some(rest)) => insert(inner, rest, variable),
        (Some(Member::Scalar(_, size @ Some(_))), None) if number.is_some() => {
            *size = (*size).max(number);
            Ok(())
        }
        (None, Some(rest)) => {
            let mut inner = Vec::new();
            insert(&mut inner, rest, variable)?;
            members.push((part, Member::Group(inner)));
            Ok(())
        }
        (None, None) => {
            members.push((part, Member::Scalar(variable, number)));
            Ok(())
        }
        _ => bail!(
            "`{}` cannot be a member of a C struct: its name is also that of a group or of another variable",
            variable.name
        ),
    }
}

fn write(text: &mut String, identifier: &str, members: &[(String, Member)], depth: usize) {
    let indent = "    ".repeat(depth);
    for (name, member) in members {
        match member {
            Member::Scalar(variable, size) => {
                let unit = if variable.unit.is_empty() { String::new() } else { format!(", {}", variable.unit) };
                let size = size.map_or(String::new(), |size| format!("[{size}]"));
                let kind = match &variable.kind {
                    Type::Real => "double ".to_owned(),
                    Type::Integer => "int ".to_owned(),
                    Type::Boolean => "bool ".to_owned(),
                    Type::Text => "const char *".to_owned(),
                    Type::Choice(name) => format!("{identifier}_{name} "),
                };
                _ = writeln!(text, "{indent}/** {}{unit} */", comment(&variable.description));
                _ = writeln!(text, "{indent}{kind}{name}{size};");
            }
            Member::Group(inner) => {
                _ = writeln!(text, "{indent}struct {{");
                write(text, identifier, inner, depth + 1);
                _ = writeln!(text, "{indent}}} {name};");
            }
        }
    }
}

/// The name before `[number]`, and the number.
fn element(part: &str) -> (&str, Option<usize>) {
    let array = part.strip_suffix(']').and_then(|part| part.split_once('['));
    array.map_or((part, None), |(part, number)| (part, number.parse().ok()))
}

fn word(part: &str) -> String {
    let taken = TAKEN.split_whitespace().any(|word| word == part);
    format!("{part}{}", if taken { "_" } else { "" })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::interface::tests::real;

    fn declared(names: &[&str]) -> Result<String> {
        let variables: Vec<_> = names.iter().map(|name| real(name)).collect();
        declare("m", variables.iter())
    }

    #[test]
    fn a_group_is_a_struct_even_where_others_stand_between() {
        let text = declared(&["a.x", "b", "a.c.y[1]", "a.c.y[2]"]).unwrap();
        let lines: Vec<_> = text.lines().map(str::trim).filter(|line| !line.starts_with("/**")).collect();
        assert_eq!(lines, ["struct {", "double x;", "struct {", "double y[2];", "} c;", "} a;", "double b;"]);
        assert!(text.contains("/** The a.x, m */"));
    }

    #[test]
    fn words_of_the_languages_are_changed() {
        assert_eq!(path("bank.export"), "bank.export_");
        assert_eq!(path("axis1.gain[3]"), "axis1.gain[2]");
        assert!(declared(&["export"]).unwrap().contains("double export_;"));
        assert_eq!(path("axis.compl"), "axis.compl_");
    }

    #[test]
    fn a_value_that_is_also_a_group_is_refused_by_name() {
        for names in [["a", "a.x"], ["a.x", "a"], ["x", "x"]] {
            let error = declared(&names).unwrap_err().to_string();
            assert!(error.starts_with(&format!("`{}` cannot be a member", names[1])), "{error}");
        }
    }
}
