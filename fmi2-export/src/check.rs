//! Checks of a model's table and facts, made when it is compiled: a wrong one does not compile.

use crate::model::Info;
use crate::units::Unit;
use crate::variable::{Kind, Real, Role, Variable};

/// Refuses a wrong variable table.
pub const fn table<V>(table: &[Variable<V>]) {
    assert!(!table.is_empty(), "an FMU needs variables");
    let mut i = 0;
    while i < table.len() {
        let row = &table[i];
        variable(row);
        let mut j = 0;
        while j < i {
            require(!same(row.name, table[j].name), row.name, "two variables have this name");
            j += 1;
        }
        i += 1;
    }
}

/// Refuses a row that breaks a rule by itself.
pub const fn variable<V>(row: &Variable<V>) {
    require(is_structured_name(row.name), row.name, "a name is made of identifiers joined by dots");
    require(!row.description.is_empty(), row.name, "every variable needs a description");
    require(row.len() > 0, row.name, "an array needs elements");
    check_value(row);
}

/// Refuses wrong facts about a model.
pub const fn info(info: &Info) {
    assert!(is_structured_name(info.identifier), "the model identifier must be a C identifier");
    let mut i = 0;
    while i < info.identifier.len() {
        assert!(info.identifier.as_bytes()[i] != b'.', "the model identifier must be a C identifier");
        i += 1;
    }
    assert!(!info.name.is_empty() && !info.description.is_empty(), "an FMU needs a name and a description");
    assert!(info.step_size > 0.0 && info.stop_time > 0.0, "step size and stop time are positive");
}

const fn check_value<V>(row: &Variable<V>) {
    let name = row.name;
    require(row.role.is_some(), name, "needs a role: input, output, local, parameter, tunable or calculated");
    let role = row.role();
    let (count, limited) = match &row.kind {
        Kind::Real { start, real, .. } => {
            check_real(name, start, real, role);
            (start.len(), real.min > f64::NEG_INFINITY || real.max < f64::INFINITY)
        }
        Kind::Integer { start, min, max, .. } => {
            check_integer(name, start, *min, *max);
            (start.len(), *min > i32::MIN || *max < i32::MAX)
        }
        Kind::Boolean { start, .. } => (start.len(), false),
        Kind::Text { .. } => (1, false),
        Kind::Choice { start, ty, .. } => {
            let known = *start >= 1 && *start as usize <= ty.items.len();
            require(known, name, "the start value is no item of the enumeration");
            (1, false)
        }
    };
    require(count == row.len(), name, "an array and its start values differ in length");
    require(!limited || role.is_parameter(), name, "only parameters have a range: inputs are limited by the model");
}

const fn check_real(name: &str, start: &[f64], real: &Real, role: Role) {
    require(real.min <= real.max, name, "a range needs minimum <= maximum");
    require(real.nominal > 0.0 && real.nominal < f64::INFINITY, name, "a nominal value is positive");
    require(!real.accepts_nan || matches!(role, Role::Input), name, "only an input accepts NaN");
    let mut i = 0;
    while i < start.len() {
        require(start[i].is_finite(), name, "a start value must be finite");
        require(real.min <= start[i] && start[i] <= real.max, name, "the start value is outside its range");
        i += 1;
    }
    match (real.unit, real.display) {
        (Some(unit), display) => {
            require(unit.factor != 0.0, name, "a unit's factor is not zero");
            require(has_display(unit, display), name, "the unit has no such display unit");
        }
        (None, display) => require(display.is_none(), name, "a display unit needs a unit"),
    }
}

const fn check_integer(name: &str, start: &[i32], min: i32, max: i32) {
    require(min <= max, name, "a range needs minimum <= maximum");
    let mut i = 0;
    while i < start.len() {
        require(min <= start[i] && start[i] <= max, name, "the start value is outside its range");
        i += 1;
    }
}

/// Ends the compilation with the variable's name and the rule it breaks.
const fn require(holds: bool, name: &str, rule: &str) {
    if holds {
        return;
    }
    let mut message = [0; 256];
    let mut end = 0;
    let parts: [&[u8]; 4] = [b"variable `", name.as_bytes(), b"`: ", rule.as_bytes()];
    let mut part = 0;
    while part < parts.len() {
        let mut i = 0;
        while i < parts[part].len() && end < message.len() {
            message[end] = parts[part][i];
            end += 1;
            i += 1;
        }
        part += 1;
    }
    match str::from_utf8(message.split_at(end).0) {
        Ok(text) => panic!("{}", text),
        Err(_) => panic!("{}", rule),
    }
}

const fn has_display(unit: &Unit, display: Option<&str>) -> bool {
    let Some(name) = display else { return true };
    let mut i = 0;
    while i < unit.display.len() {
        if same(unit.display[i].name, name) {
            return unit.display[i].factor != 0.0;
        }
        i += 1;
    }
    false
}

/// Identifiers joined by dots, as the structured naming convention of FMI 2.0 wants it.
const fn is_structured_name(name: &str) -> bool {
    let bytes = name.as_bytes();
    let mut at_start = true;
    let mut i = 0;
    while i < bytes.len() {
        match bytes[i] {
            b'a'..=b'z' | b'A'..=b'Z' | b'_' => at_start = false,
            b'0'..=b'9' if !at_start => (),
            b'.' if !at_start => at_start = true,
            _ => return false,
        }
        i += 1;
    }
    !at_start
}

const fn same(a: &str, b: &str) -> bool {
    let (a, b) = (a.as_bytes(), b.as_bytes());
    if a.len() != b.len() {
        return false;
    }
    let mut i = 0;
    while i < a.len() {
        if a[i] != b[i] {
            return false;
        }
        i += 1;
    }
    true
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{EnumType, Item, Start, boolean, integer, real, text, units};
    use std::panic::catch_unwind;

    struct Vars {
        x: f64,
        pair: [f64; 2],
        n: i32,
        on: bool,
        label: String,
    }

    impl Start for Vars {
        const START: Self = Self { x: 3.0, pair: [0.0, 1.0], n: 3, on: false, label: String::new() };
    }

    const MODE: EnumType =
        EnumType { name: "Mode", description: "x", items: &[Item { name: "Off", description: "x", hint: "" }] };

    fn choice(start: i32) -> Variable<Vars> {
        Variable::new_choice("mode", &MODE, start, |_| 1, |_, _| ())
    }

    fn refusal(rows: &[Variable<Vars>]) -> String {
        let panic = catch_unwind(|| table(rows)).expect_err("the table is accepted");
        match panic.downcast::<String>() {
            Ok(text) => *text,
            Err(panic) => (*panic.downcast::<&str>().expect("a panic with a text")).to_owned(),
        }
    }

    #[test]
    fn a_right_table_is_accepted() {
        table(&[
            real!(Vars => x).tunable().unit(&units::METRE).display("um").range(3.0, 3.0).describe("x"),
            real!(Vars => pair[2]).input().describe("x"),
            integer!(Vars => n).parameter().range_int(3, 3).describe("x"),
            boolean!(Vars => on).output().describe("x"),
            text!(Vars => label).local().describe("x"),
            choice(1).parameter().describe("x"),
        ]);
    }

    #[test]
    fn a_wrong_table_is_refused_with_the_name_of_the_variable_and_the_rule() {
        let x = || real!(Vars => x).describe("x");
        let n = || integer!(Vars => n).describe("x");
        for (row, expected) in [
            (x(), "variable `x`: needs a role"),
            (real!(Vars => x).input(), "variable `x`: every variable needs a description"),
            (x().tunable().range(4.0, 5.0), "variable `x`: the start value is outside its range"),
            (x().tunable().range(1.0, 2.0), "variable `x`: the start value is outside its range"),
            (x().tunable().range(5.0, 1.0), "variable `x`: a range needs minimum <= maximum"),
            (x().tunable().range(f64::NAN, 1.0), "variable `x`: a range needs minimum <= maximum"),
            (x().output().range(0.0, 5.0), "variable `x`: only parameters have a range"),
            (x().input().nominal(0.0), "variable `x`: a nominal value is positive"),
            (x().output().accepts_nan(), "variable `x`: only an input accepts NaN"),
            (x().input().unit(&units::METRE).display("kg"), "variable `x`: the unit has no such display unit"),
            (x().input().display("um"), "variable `x`: a display unit needs a unit"),
            (n().parameter().range_int(4, 5), "variable `n`: the start value is outside its range"),
            (n().parameter().range_int(1, 2), "variable `n`: the start value is outside its range"),
            (choice(2).parameter().describe("x"), "variable `mode`: the start value is no item of the enumeration"),
        ] {
            assert!(refusal(&[row]).starts_with(expected), "{expected}");
        }
        assert_eq!(refusal(&[x().input(), x().output()]), "variable `x`: two variables have this name");
        assert_eq!(refusal(&[]), "an FMU needs variables");
    }

    #[test]
    fn names_follow_the_structured_convention() {
        for name in ["x", "gains.kp", "_a1.b2"] {
            assert!(is_structured_name(name), "{name}");
        }
        for name in ["", ".", "a.", ".a", "1a", "a b", "a..b", "a-b", "\u{e9}"] {
            assert!(!is_structured_name(name), "{name}");
        }
    }
}
