//! The generated parts of a crate's Markdown pages, and the test that the pages hold them.

use std::fmt::Write;
use std::path::Path;

use crate::description::cells::Cells;
use crate::description::model_description::used_types;
use crate::model::{Interface, Model};
use crate::table::enumeration::{EnumType, Item};
use crate::table::variable::{Role, Tier, Variable};

const INPUTS: &[Role] = &[Role::Input];
const OUTPUTS: &[Role] = &[Role::Output];
const PARAMETERS: &[Role] = &[Role::Parameter, Role::Tunable, Role::Calculated];

/// A generated part: its page, its name in the marks, and its text.
struct Part {
    page: &'static str,
    name: &'static str,
    text: String,
}

impl Part {
    fn begin(&self) -> String {
        format!("<!-- {}: generated from the interface -->\n", self.name)
    }

    fn end(&self) -> String {
        format!("<!-- end of {} -->", self.name)
    }

    /// The page with this part between its marks.
    fn renewed(&self, page: &str) -> Option<String> {
        let (begin, end) = (self.begin(), self.end());
        let (head, rest) = page.split_once(&begin)?;
        let (_, tail) = rest.split_once(&end)?;
        Some(format!("{head}{begin}\n{}{end}{tail}", self.text))
    }
}

/// The parts of a model: ports in the landing page, faults where the model has them, all variables.
fn parts<M: Model>() -> Vec<Part> {
    let table = M::Vars::TABLE;
    let mut parts = vec![
        Part { page: "README.md", name: "ports", text: ports(table) },
        Part { page: "doc/variables.md", name: "variables", text: variables(table) },
    ];
    if let Some(ty) = fault_type(table) {
        parts.push(Part { page: "doc/faults.md", name: "faults", text: faults(ty) });
    }
    parts
}

/// Asserts that the pages in the folder of a crate hold what is generated from its interface: inputs, outputs and essential
/// parameters in `README.md`, faults in `doc/faults.md` (of a model with reactions to its faults), all variables in
/// `doc/variables.md`. With `BLESS` in the environment it writes them. For a test of the crate that makes the FMU:
///
/// ```ignore
/// fmi2_export::assert_pages::<Controller>(env!("CARGO_MANIFEST_DIR"));
/// ```
///
/// # Panics
/// When a page cannot be read, has no marks, or differs from the interface.
pub fn assert_pages<M: Model>(folder: impl AsRef<Path>) {
    for part in parts::<M>() {
        assert_part(&part, &folder.as_ref().join(part.page));
    }
}

fn assert_part(part: &Part, path: &Path) {
    let shown = path.display();
    let text = std::fs::read_to_string(path).unwrap_or_else(|error| panic!("cannot read `{shown}`: {error}"));
    let (begin, end) = (part.begin(), part.end());
    let renewed = part
        .renewed(&text)
        .unwrap_or_else(|| panic!("`{shown}` has no marks\nhint: Add the lines `{}` and `{end}`.", begin.trim()));
    if text == renewed {
        return;
    }
    assert!(
        std::env::var_os("BLESS").is_some(),
        "`{shown}` differs from the interface\nhint: Run `BLESS=1 cargo test` to renew it."
    );
    std::fs::write(path, renewed).unwrap_or_else(|error| panic!("cannot write `{shown}`: {error}"));
}

/// Part of the README: inputs, outputs and essential parameters.
fn ports<V>(table: &[Variable<V>]) -> String {
    let mut text = String::new();
    signals(&mut text, "Inputs", table, INPUTS);
    signals(&mut text, "Outputs", table, OUTPUTS);
    parameters(&mut text, "Essential parameters", table, |row| row.tier == Tier::Essential);
    text
}

/// All variables and enumerations; faults have a page of their own.
fn variables<V>(table: &[Variable<V>]) -> String {
    let mut text = String::new();
    signals(&mut text, "Inputs", table, INPUTS);
    signals(&mut text, "Outputs", table, OUTPUTS);
    signals(&mut text, "Local variables", table, &[Role::Local]);
    parameters(&mut text, "Essential parameters", table, |row| row.tier == Tier::Essential);
    parameters(&mut text, "Parameters", table, |row| row.tier == Tier::Normal);
    parameters(&mut text, "Expert parameters", table, |row| row.tier == Tier::Expert);
    for ty in used_types(table) {
        enumeration(&mut text, ty);
    }
    text
}

fn signals<V>(text: &mut String, title: &str, table: &[Variable<V>], roles: &[Role]) {
    let rows = rows(table, |row| roles.contains(&row.role()));
    if rows.is_empty() {
        return;
    }
    _ = writeln!(text, "### {title}\n\n| Name | Unit | Start | Meaning |\n|---|---|---|---|");
    for (cells, meaning, _) in rows {
        let Cells { name, unit, start, words, .. } = cells;
        let start = if words { word(&start) } else { start };
        _ = writeln!(text, "| `{name}` | {unit} | {start} | {meaning} |");
    }
    text.push('\n');
}

fn parameters<V>(text: &mut String, title: &str, table: &[Variable<V>], tier: impl Fn(&Variable<V>) -> bool) {
    let rows = rows(table, |row| PARAMETERS.contains(&row.role()) && tier(row));
    if rows.is_empty() {
        return;
    }
    _ = writeln!(
        text,
        "### {title}\n\n| Name | Unit | Default | Range | Paper | Meaning | Reason of the default |\n|---|---|---|---|---|---|---|"
    );
    for (cells, meaning, source) in rows {
        let Cells { name, unit, start, range, paper, words, .. } = cells;
        let (start, paper) = if words { (word(&start), word(&paper)) } else { (start, paper) };
        _ = writeln!(text, "| `{name}` | {unit} | {start} | {range} | {paper} | {meaning} | {source} |");
    }
    text.push('\n');
}

/// Cells, meaning and reason of the chosen rows. Rows of a repeated group that differ in their number alone become one
/// row: `axis1.error` to `axis6.error` are `axis1..6.error`.
fn rows<V>(table: &[Variable<V>], chosen: impl Fn(&Variable<V>) -> bool) -> Vec<(Cells, String, String)> {
    let mut rows: Vec<(Option<Family>, Vec<Cells>, String, String)> = Vec::new();
    for row in table.iter().filter(|row| chosen(row)) {
        let cells = Cells::of(row);
        let tunable = if row.role() == Role::Tunable { "; tunable" } else { "" };
        let (meaning, source) = (format!("{}{tunable}", escaped(row.description)), escaped(row.source));
        let family = Family::of(&cells.name, &meaning);
        match rows.iter_mut().find(|(known, ..)| family.is_some() && Family::alike(known.as_ref(), family.as_ref())) {
            Some((Some(known), all, ..)) => {
                known.last = family.map_or(String::new(), |family| family.last);
                all.push(cells);
            }
            _ => rows.push((family, vec![cells], meaning, source)),
        }
    }
    let merged = rows.into_iter().map(|(family, all, meaning, source)| {
        let mut cells = merged(all);
        match family {
            Some(Family { first, last, name, meaning }) if first != last => {
                cells.name = name.replacen(NUMBER, &format!("{first}..{last}"), 1);
                (cells, meaning.replace(NUMBER, "n"), source)
            }
            _ => (cells, meaning, source),
        }
    });
    merged.collect()
}

/// The cells of a repeated group as one row: values that differ are listed in their order, each unit once.
fn merged(mut all: Vec<Cells>) -> Cells {
    let mut units: Vec<&str> = Vec::new();
    for cells in &all {
        if !units.contains(&cells.unit.as_str()) {
            units.push(&cells.unit);
        }
    }
    let unit = units.join(", ");
    let each = |cell: fn(&Cells) -> &String| {
        let mut values: Vec<&str> = all.iter().map(|cells| cell(cells).as_str()).collect();
        if values.windows(2).all(|pair| pair[0] == pair[1]) {
            values.truncate(1);
        }
        values.join(", ")
    };
    let (start, range, paper) = (each(|cells| &cells.start), each(|cells| &cells.range), each(|cells| &cells.paper));
    Cells { unit, start, range, paper, ..all.swap_remove(0) }
}

/// Stands for the number of a repeated group.
const NUMBER: &str = "{n}";

/// A variable of a repeated group: its name and meaning without the number, and the numbers of its first and last use.
#[derive(Debug, PartialEq)]
struct Family {
    name: String,
    meaning: String,
    first: String,
    last: String,
}

impl Family {
    fn of(name: &str, meaning: &str) -> Option<Self> {
        let groups = name.rsplit_once('.')?.0;
        let numbered = groups.split('.').find(|part| part.ends_with(|c: char| c.is_ascii_digit()))?;
        let stem = numbered.trim_end_matches(|c: char| c.is_ascii_digit());
        let number = numbered[stem.len()..].to_owned();
        let words = meaning.split(' ').map(|word| {
            let is_number = word.trim_end_matches([',', ';']) == number;
            if is_number { word.replacen(&number, NUMBER, 1) } else { word.to_owned() }
        });
        Some(Self {
            name: name.replacen(numbered, &format!("{stem}{NUMBER}"), 1),
            meaning: words.collect::<Vec<_>>().join(" "),
            first: number.clone(),
            last: number,
        })
    }

    fn alike(one: Option<&Self>, other: Option<&Self>) -> bool {
        one.zip(other).is_some_and(|(one, other)| (&one.name, &one.meaning) == (&other.name, &other.meaning))
    }
}

fn enumeration(text: &mut String, ty: &EnumType) {
    let title = escaped(ty.description);
    _ = writeln!(text, "### {}\n\n{title}.\n\n| Number | Item | Meaning |\n|---|---|---|", ty.name);
    for (item, number) in ty.items.iter().zip(1..) {
        _ = writeln!(text, "| {number} | `{}` | {} |", item.name, escaped(item.description));
    }
    text.push('\n');
}

/// The enumeration of the faults of a model that declares reactions to them.
pub fn fault_type<V>(table: &[Variable<V>]) -> Option<&'static EnumType> {
    used_types(table).into_iter().find(|ty| !ty.reactions.is_empty())
}

/// Faults by reaction, the mildest first.
fn faults(ty: &EnumType) -> String {
    let mut text = String::new();
    for reaction in ty.reactions {
        let of = |item: &&Item| item.reaction == reaction.name;
        if !ty.items.iter().any(|item| of(&item)) {
            continue;
        }
        _ = writeln!(
            text,
            "### {}\n\n**Reaction:** {}.\n**Acknowledge:** {}.\n\n| Fault | Cause | Detected when | Remedy |\n|---|---|---|---|",
            reaction.name, reaction.description, reaction.acknowledge
        );
        for Item { name, description, detection, hint, .. } in ty.items.iter().filter(of) {
            _ = writeln!(text, "| `{name}` | {} | {} | {} |", escaped(description), escaped(detection), escaped(hint));
        }
        text.push('\n');
    }
    text
}

fn word(text: &str) -> String {
    if text.is_empty() { String::new() } else { format!("`{}`", escaped(text)) }
}

fn escaped(text: &str) -> String {
    text.replace('|', "\\|")
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::table::enumeration::Reaction;

    #[test]
    fn a_part_is_between_its_marks_and_the_rest_stays() {
        let part = Part { page: "README.md", name: "ports", text: "new\n".to_owned() };
        let page = format!("head\n{}old\n{}\ntail\n", part.begin(), part.end());
        let once = part.renewed(&page).unwrap();
        assert_eq!(once, format!("head\n{}\nnew\n{}\ntail\n", part.begin(), part.end()));
        assert_eq!(part.renewed(&once).unwrap(), once);
        assert_eq!(part.renewed("no marks"), None);
    }

    #[test]
    fn faults_are_listed_by_reaction_with_all_their_fields() {
        const fn fault(name: &'static str, reaction: &'static str) -> Item {
            Item { name, description: "cause", hint: "Check it.", reaction, detection: "a > b|c" }
        }
        const FAULTS: EnumType = EnumType {
            name: "Fault",
            description: "x",
            items: &[fault("None", ""), fault("Late", "DriveOff"), fault("Early", "Retract")],
            reactions: &[
                Reaction { name: "Retract", description: "Retracts", acknowledge: "Reset" },
                Reaction { name: "Stop", description: "Stops", acknowledge: "Reset" },
                Reaction { name: "DriveOff", description: "Switches the drive off", acknowledge: "Reset at rest" },
            ],
        };
        let text = faults(&FAULTS);
        let (early, late) = (text.find("`Early`").unwrap(), text.find("`Late`").unwrap());
        assert!(early < late && !text.contains("`None`") && !text.contains("### Stop"));
        assert!(text.contains("**Reaction:** Switches the drive off.\n**Acknowledge:** Reset at rest.\n"));
        assert!(text.contains("| `Late` | cause | a > b\\|c | Check it. |\n"));
    }

    #[test]
    fn different_cells_of_a_repeated_group_are_listed() {
        let cells = |unit: &str, start: &str| Cells {
            unit: unit.to_owned(),
            start: start.to_owned(),
            range: "0 .. 9".to_owned(),
            ..Cells::default()
        };
        let Cells { unit, start, range, paper, .. } =
            merged(vec![cells("rad", "1"), cells("m", "2"), cells("rad", "1")]);
        assert_eq!([unit.as_str(), &start, &range, &paper], ["rad, m", "1, 2, 1", "0 .. 9", ""]);
    }

    #[test]
    fn variables_of_a_repeated_group_are_one_family() {
        let [third, fourth] = [3, 4]
            .map(|n| Family::of(&format!("limits.axis{n}.error"), &format!("Error of axis {n}, in pulses")).unwrap());
        assert_eq!((&*third.name, &*third.meaning), ("limits.axis{n}.error", "Error of axis {n}, in pulses"));
        assert!(Family::alike(Some(&third), Some(&fourth)) && third != fourth);
        assert_eq!(Family::of("servo_gain", "x"), None);
        assert_eq!(Family::of("gain2", "x"), None);
    }
}
