//! Checks of a model's table and facts, made when it is compiled: a wrong one does not compile.

use crate::model::Info;
use crate::table::enumeration::EnumType;
use crate::table::text::{is_line, is_structured_name, is_text, same};
use crate::table::units::Unit;
use crate::table::variable::{Kind, Real, Role, Variable};

/// Rejects a wrong variable table.
pub const fn table<V>(table: &[Variable<V>]) {
    assert!(!table.is_empty(), "an FMU needs variables");
    let mut i = 0;
    while i < table.len() {
        let row = &table[i];
        variable(row);
        let mut j = 0;
        while j < table.len() {
            check_pair(row, &table[j], j < i);
            j += 1;
        }
        i += 1;
    }
}

/// Rejects a row that breaks a rule by itself.
pub const fn variable<V>(row: &Variable<V>) {
    require(is_structured_name(row.name), row.name, "a name is made of identifiers joined by dots");
    require(!row.description.is_empty(), row.name, "every variable needs a description");
    require(is_line(row.description), row.name, "a description is one line, without control characters");
    require(row.len() > 0, row.name, "an array needs elements");
    check_value(row);
}

/// Names that must not be the same, and those that must mean the same.
const fn check_pair<V>(row: &Variable<V>, other: &Variable<V>, is_before: bool) {
    let name = row.name;
    require(!is_before || !same(name, other.name), name, "two variables have this name");
    if let Kind::Choice { ty, .. } = &other.kind {
        require(!same(name, ty.name), name, "an enumeration has this name");
        if let Kind::Choice { ty: own, .. } = &row.kind
            && is_before
        {
            require(!same(own.name, ty.name) || same_type(own, ty), name, "two different enumerations have one name");
        }
    }
    if let (Kind::Real { real, .. }, Kind::Real { real: others, .. }) = (&row.kind, &other.kind)
        && let (Some(own), Some(unit)) = (real.unit, others.unit)
        && is_before
    {
        require(!same(own.name, unit.name) || same_unit(own, unit), name, "two different units have one name");
    }
}

/// Rejects wrong facts about a model.
pub const fn info(info: &Info) {
    assert!(is_structured_name(info.identifier), "the model identifier must be a C identifier");
    let mut i = 0;
    while i < info.identifier.len() {
        assert!(info.identifier.as_bytes()[i] != b'.', "the model identifier must be a C identifier");
        i += 1;
    }
    assert!(!info.name.is_empty() && !info.description.is_empty(), "an FMU needs a name and a description");
    let numbers = info.sample_period > 0.0 && info.stop_time >= 0.0;
    let finite = info.sample_period.is_finite() && info.stop_time.is_finite();
    assert!(numbers && finite, "the sample period is positive and finite, the stop time is not negative and finite");
    assert!(info.longest_step >= 1.0, "the longest communication step is at least one sample period");
    let texts = [info.name, info.description, info.version, info.author, info.copyright, info.license];
    let mut i = 0;
    while i < texts.len() {
        assert!(is_line(texts[i]), "the facts about a model are lines, without control characters");
        i += 1;
    }
}

const fn check_value<V>(row: &Variable<V>) {
    let name = row.name;
    require(row.role.is_some(), name, "needs a role: input, output, local, parameter, tunable or calculated");
    let role = row.role();
    let count = match &row.kind {
        Kind::Real { start, real, .. } => {
            check_real(name, start, real, role);
            start.len()
        }
        Kind::Integer { start, min, max, .. } => {
            check_integer(name, start, *min, *max);
            start.len()
        }
        Kind::Boolean { start, .. } => start.len(),
        Kind::Text { start, .. } => {
            require(is_text(start), name, "a start value has no control characters but line ends and tabs");
            1
        }
        Kind::Choice { start, ty, .. } => {
            let known = *start >= 1 && *start as usize <= ty.items.len();
            require(known, name, "the start value is no item of the enumeration");
            check_type(name, ty);
            1
        }
    };
    require(count == row.len(), name, "an array and its start values differ in length");
    require(paper_fits(row), name, "the value of the paper is outside its range");
}

/// Whether a parameter takes the value of the paper.
const fn paper_fits<V>(row: &Variable<V>) -> bool {
    match (row.paper, &row.kind) {
        (Some(paper), Kind::Real { real, .. }) => paper.is_finite() && real.min <= paper && paper <= real.max,
        (Some(paper), Kind::Integer { min, max, .. }) => *min as f64 <= paper && paper <= *max as f64,
        _ => true,
    }
}

const fn check_type(name: &str, ty: &EnumType) {
    const RULE: &str = "names and descriptions of an enumeration are lines, without control characters";
    require(is_line(ty.name) && is_line(ty.description), name, RULE);
    let mut i = 0;
    while i < ty.items.len() {
        require(is_line(ty.items[i].name) && is_line(ty.items[i].description), name, RULE);
        i += 1;
    }
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
            let finite = unit.factor.is_finite() && unit.offset.is_finite();
            require(
                finite && unit.factor != 0.0,
                name,
                "a unit's factor and offset are finite, the factor is not zero",
            );
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
            return unit.display[i].factor.is_finite() && unit.display[i].factor != 0.0;
        }
        i += 1;
    }
    false
}

/// Whether two types of one name are the same to a reader of the model description.
const fn same_type(a: &EnumType, b: &EnumType) -> bool {
    if !same(a.description, b.description) || a.items.len() != b.items.len() {
        return false;
    }
    let mut i = 0;
    while i < a.items.len() {
        if !same(a.items[i].name, b.items[i].name) || !same(a.items[i].description, b.items[i].description) {
            return false;
        }
        i += 1;
    }
    true
}

const fn same_unit(a: &Unit, b: &Unit) -> bool {
    if a.factor != b.factor || a.offset != b.offset || a.display.len() != b.display.len() {
        return false;
    }
    let mut i = 0;
    while i < a.base.len() {
        if a.base[i] != b.base[i] {
            return false;
        }
        i += 1;
    }
    let mut i = 0;
    while i < a.display.len() {
        if !same(a.display[i].name, b.display[i].name) || a.display[i].factor != b.display[i].factor {
            return false;
        }
        i += 1;
    }
    true
}

#[cfg(test)]
#[allow(unsafe_code, clippy::undocumented_unsafe_blocks, reason = "each is a field, in a constant")]
mod tests {
    use super::*;
    use crate::{DisplayUnit, EnumType, Item, units};
    use std::panic::catch_unwind;
    use std::slice::from_ref;

    struct Vars {
        x: f64,
        pair: [f64; 2],
        n: i32,
        on: bool,
        label: String,
    }

    const START: &Vars = &Vars { x: 3.0, pair: [0.0, 1.0], n: 3, on: false, label: String::new() };

    fn real() -> Variable<Vars> {
        const { unsafe { Variable::new_real("x", None, START, from_ref(&START.x)) } }
    }

    fn pair() -> Variable<Vars> {
        const { unsafe { Variable::new_real("pair", Some(2), START, &START.pair) } }
    }

    fn integer() -> Variable<Vars> {
        const { unsafe { Variable::new_integer("n", None, START, from_ref(&START.n)) } }
    }

    fn text(start: &'static str) -> Variable<Vars> {
        let text =
            Variable::new_text("label", |vars: &Vars| &vars.label, |vars, text| text.clone_into(&mut vars.label));
        text.start_text(start)
    }

    const fn item(name: &'static str) -> Item {
        Item { name, description: "x", hint: "", reaction: "", detection: "" }
    }

    const MODE: EnumType = EnumType { name: "Mode", description: "x", items: &[item("Off")], reactions: &[] };

    const OTHER_MODE: EnumType = EnumType { name: "Mode", description: "x", items: &[item("On")], reactions: &[] };
    const OTHER_METRE: Unit = Unit::si("m", [0, 2, 0, 0, 0], &[]);
    const INFINITE: Unit = Unit { factor: f64::INFINITY, ..OTHER_METRE };
    const SHOWN_INFINITE: Unit = Unit { display: &[DisplayUnit { name: "inf", factor: f64::INFINITY }], ..OTHER_METRE };

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
            real().tunable().unit(&units::METRE).display("um").range(3.0, 3.0).describe("x"),
            pair().input().unit(&units::METRE).range(0.0, 1.0).describe("x"),
            integer().output().range_int(3, 3).describe("x"),
            const { unsafe { Variable::new_boolean("on", None, START, from_ref(&START.on)) } }.output().describe("x"),
            text("two lines\n\tand a tab").local().describe("x"),
            choice(1).parameter().describe("x"),
        ]);
    }

    #[test]
    fn a_wrong_table_is_refused_with_the_name_of_the_variable_and_the_rule() {
        let x = || real().describe("x");
        let n = || integer().describe("x");
        for (row, expected) in [
            (x(), "variable `x`: needs a role"),
            (real().input(), "variable `x`: every variable needs a description"),
            (x().tunable().range(4.0, 5.0), "variable `x`: the start value is outside its range"),
            (x().tunable().range(1.0, 2.0), "variable `x`: the start value is outside its range"),
            (x().tunable().range(5.0, 1.0), "variable `x`: a range needs minimum <= maximum"),
            (x().tunable().range(f64::NAN, 1.0), "variable `x`: a range needs minimum <= maximum"),
            (x().input().unit(&INFINITE), "variable `x`: a unit's factor and offset are finite"),
            (x().input().unit(&SHOWN_INFINITE).display("inf"), "variable `x`: the unit has no such display unit"),
            (real().input().describe("two\nlines"), "variable `x`: a description is one line"),
            (text("\u{1}").local().describe("x"), "variable `label`: a start value has no control"),
            (x().tunable().range(3.0, 4.0).paper(5.0), "variable `x`: the value of the paper is outside its range"),
            (x().tunable().paper(f64::NAN), "variable `x`: the value of the paper is outside its range"),
            (n().parameter().range_int(3, 4).paper(5.0), "variable `n`: the value of the paper is outside its range"),
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
        let shown = || pair().output().unit(&OTHER_METRE).describe("x");
        let twice = refusal(&[x().input().unit(&units::METRE), shown()]);
        assert_eq!(twice, "variable `pair`: two different units have one name");
        let mode = |name, ty| Variable::new_choice(name, ty, 1, |_| 1, |_, _| ()).parameter().describe("x");
        let twice = refusal(&[mode("mode", &MODE), mode("other", &OTHER_MODE)]);
        assert_eq!(twice, "variable `other`: two different enumerations have one name");
        assert_eq!(refusal(&[mode("Mode", &MODE)]), "variable `Mode`: an enumeration has this name");
        assert_eq!(refusal(&[]), "an FMU needs variables");
    }

    #[test]
    fn facts_that_xml_cannot_hold_are_refused() {
        const GOOD: Info = Info { name: "Good", identifier: "good", description: "x", ..Info::DEFAULT };
        info(&GOOD);
        for bad in [
            Info { stop_time: f64::INFINITY, ..GOOD },
            Info { sample_period: f64::INFINITY, ..GOOD },
            Info { sample_period: f64::NAN, ..GOOD },
            Info { sample_period: 0.0, ..GOOD },
            Info { longest_step: 0.5, ..GOOD },
            Info { longest_step: f64::NAN, ..GOOD },
            Info { author: "two\nlines", ..GOOD },
            Info { description: "\u{1}", ..GOOD },
            Info { identifier: "a.b", ..GOOD },
            Info { name: "", ..GOOD },
        ] {
            catch_unwind(|| info(&bad)).expect_err(&format!("{bad:?}"));
        }
    }
}
