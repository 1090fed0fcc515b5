//! `documentation/index.html`: the declaration as one page for screens, light and dark, and for paper.
//!
//! Order: facts, block, quick start, inputs, outputs, essential parameters, timing, faults, guide, all other variables,
//! results.

use crate::description::block_diagram;
use crate::description::cells::{Cells, number};
use crate::description::model_description::used_types;
use crate::description::pages::fault_type;
use crate::description::xml::escape;
use crate::exported::Exported;
use crate::host::logger::Category;
use crate::instance::start_period;
use crate::model::{Info, Interface};
use crate::table::enumeration::{EnumType, Item};
use crate::table::variable::{Role, Tier, Variable};
use std::fmt::Write;

const STYLE: &str = include_str!("documentation.css");

/// Where a packer inserts what only it knows: the platforms, an example of use, and chapters with headings of the second
/// order and the links to them.
const PLATFORMS: &str = "<!-- platforms -->";
const QUICK_START: &str = "<!-- quick start -->\n";
const QUICK_START_CONTENTS: &str = "<!-- contents of the quick start -->\n";
const GUIDE: &str = "<!-- guide -->\n";
const GUIDE_CONTENTS: &str = "<!-- contents of the guide -->\n";
const RESULTS: &str = "<!-- results -->\n";
const RESULTS_CONTENTS: &str = "<!-- contents of the results -->\n";

const STEPS: &str = "<p>The controller samples at the start time plus <var>n</var> sample periods, whatever the communication \
step is. Outputs are held between samples.</p>
<h3>Co-simulation</h3>
<p>A step [t, t + h) runs every sample in it, with the inputs that were set at t. A master that applies the outputs at t adds no \
delay. A master that applies them at t + h, as most do, adds one communication step. Real inputs may come with derivatives \
(<code>fmi2SetRealInputDerivatives</code>): they are extrapolated to the samples inside the step.</p>
";

const EVENTS: &str = "<h3>Model exchange</h3>
<p>There are no continuous states. Each sample is a time event: <code>fmi2NewDiscreteStates</code> runs the sample that is due \
and returns the time of the next one. There is no communication step, and outputs act immediately: set a parameter that \
states the delay in samples, such as <code>io_delay</code>, to 0.</p>
";

/// The whole page.
pub fn write<M: Exported>() -> String {
    let (info, table) = (M::INFO, M::Vars::TABLE);
    let mut page = Page { text: String::new(), names: table.iter().map(|row| row.name).collect() };
    let faults = fault_type(table);
    page.head(&info, start_period::<M>(), table);
    page.contents(table);
    page.section("block", "Block");
    page.text += &block_diagram::write(info.name, table);
    page.text += QUICK_START;
    page.signals(table, "inputs", "Inputs", Role::Input);
    page.signals(table, "outputs", "Outputs", Role::Output);
    page.parameters(table, "essential", "Essential parameters", Tier::Essential);
    page.section("timing", "Timing and delay");
    page.step(&info, start_period::<M>());
    page.text += STEPS;
    page.text += EVENTS;
    if let Some(ty) = faults {
        page.faults(ty);
    }
    page.text += GUIDE;
    page.signals(table, "locals", "Local variables", Role::Local);
    page.parameters(table, "parameters", "Parameters", Tier::Normal);
    page.parameters(table, "expert-parameters", "Expert parameters", Tier::Expert);
    page.enumerations(table);
    page.section("log", "Log categories");
    page.table("log", &["Category", "Meaning"], &mut |page| {
        for category in Category::ALL {
            page.row(&[&code(category.name()), &escape(category.description())]);
        }
    });
    page.text += RESULTS;
    page.text += "</main>\n</body>\n</html>\n";
    page.text
}

struct Page {
    text: String,
    /// Names of the variables, each of which has a row to lead to.
    names: Vec<&'static str>,
}

impl Page {
    fn head<V>(&mut self, info: &Info, period: f64, table: &[Variable<V>]) {
        let name = escape(info.name);
        self.put(format_args!(
            "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\"/>\n\
             <meta name=\"viewport\" content=\"width=device-width\"/>\n<title>{name}</title>\n<style>\n{STYLE}</style>\n</head>\n\
             <body>\n<header>\n<h1>{}</h1>\n<p>{}</p>\n",
            breakable(info.name),
            self.inline(info.description)
        ));
        let count =
            |role: fn(Role) -> bool| -> usize { table.iter().filter(|row| role(row.role())).map(Variable::len).sum() };
        let (inputs, outputs) = (count(|role| role == Role::Input), count(|role| role == Role::Output));
        let (locals, parameters) = (count(|role| role == Role::Local), count(is_parameter));
        self.put(format_args!(
            "<p class=\"facts\">FMI 2.0 co-simulation (communication step {}) and model exchange{PLATFORMS} &#183; \
             {inputs} inputs, {outputs} outputs, {locals} local variables, {parameters} parameters</p>\n",
            shown(period)
        ));
        let facts = [("Version", info.version), ("Author", info.author), ("License", info.license)];
        let facts = facts.iter().filter(|(_, fact)| !fact.is_empty());
        let facts: Vec<_> = facts.map(|(what, fact)| format!("{what} {}", escape(fact))).collect();
        self.put(format_args!("<p class=\"facts\">{}</p>\n</header>\n", facts.join(" &#183; ")));
    }

    /// Links to the sections.
    fn contents<V>(&mut self, table: &[Variable<V>]) {
        self.text += "<nav>\n";
        let has = |role: Role| table.iter().any(|row| row.role() == role);
        let has_tier = |tier: Tier| table.iter().any(|row| is_parameter(row.role()) && row.tier == tier);
        let faults = fault_type(table);
        self.link("block", "Block");
        self.text += QUICK_START_CONTENTS;
        for (is_there, id, title) in [
            (has(Role::Input), "inputs", "Inputs"),
            (has(Role::Output), "outputs", "Outputs"),
            (has_tier(Tier::Essential), "essential", "Essential parameters"),
            (true, "timing", "Timing and delay"),
            (faults.is_some(), "faults", "Faults"),
        ] {
            if is_there {
                self.link(id, title);
            }
        }
        self.text += GUIDE_CONTENTS;
        for (is_there, id, title) in [
            (has(Role::Local), "locals", "Local variables"),
            (has_tier(Tier::Normal), "parameters", "Parameters"),
            (has_tier(Tier::Expert), "expert-parameters", "Expert parameters"),
        ] {
            if is_there {
                self.link(id, title);
            }
        }
        for ty in used_types(table).into_iter().filter(|ty| ty.reactions.is_empty()) {
            self.link(&format!("type-{}", ty.name), ty.name);
        }
        self.link("log", "Log");
        self.text += RESULTS_CONTENTS;
        self.text += "</nav>\n<main>\n";
    }

    fn link(&mut self, id: &str, title: &str) {
        self.put(format_args!("<a href=\"#{id}\">{title}</a>\n"));
    }

    fn step(&mut self, info: &Info, period: f64) {
        self.put(format_args!("<p>Recommended communication step: {}, one sample period. ", shown(period)));
        if info.longest_step.is_finite() {
            let longest = match info.longest_step {
                1.0 => "one sample period".to_owned(),
                longest => format!("{longest} sample periods"),
            };
            self.put(format_args!(
                "A closed loop works with steps of up to {longest}. In a longer step the inputs are held for all of its samples, \
                 and only the outputs of the last sample are visible; the first such step returns a warning."
            ));
        }
        self.text += "</p>\n";
    }

    fn signals<V>(&mut self, table: &[Variable<V>], id: &str, title: &str, role: Role) {
        if !table.iter().any(|row| row.role() == role) {
            return;
        }
        self.section(id, title);
        self.table("signals", &["Name", "Type", "Unit", "Start", "Meaning"], &mut |page| {
            for row in table.iter().filter(|row| row.role() == role) {
                let cells = Cells::of(row);
                let kind = if cells.is_choice { link_to_type(&cells.kind) } else { cells.kind };
                let description = page.inline(row.description);
                page.row_of(row.name, &[&code(&cells.name), &kind, &cells.unit, &escape(&cells.start), &description]);
            }
        });
    }

    /// Parameters of a tier. All but the essential ones are listed by group: the part of a name before its last dot.
    fn parameters<V>(&mut self, table: &[Variable<V>], id: &str, title: &str, tier: Tier) {
        let head = ["Name", "Default", "Range", "Paper", "Meaning", "Reason of the default"];
        let rows: Vec<_> = table.iter().filter(|row| is_parameter(row.role()) && row.tier == tier).collect();
        if rows.is_empty() {
            return;
        }
        self.section(id, title);
        if tier == Tier::Essential {
            return self.table("parameters", &head, &mut |page| rows.iter().for_each(|row| page.parameter(row)));
        }
        let mut groups: Vec<&str> = Vec::new();
        for row in &rows {
            if !groups.contains(&group(row.name)) {
                groups.push(group(row.name));
            }
        }
        for of in groups {
            if !of.is_empty() {
                self.put(format_args!("<h3>{}</h3>\n", code(of)));
            }
            let rows: Vec<_> = rows.iter().filter(|row| group(row.name) == of).collect();
            if let Some(row) = rows.iter().find(|row| !row.head.is_empty()) {
                let head = self.inline(row.head);
                self.put(format_args!("<p>{head}.</p>\n"));
            }
            self.table("parameters", &head, &mut |page| rows.iter().for_each(|row| page.parameter(row)));
        }
    }

    fn parameter<V>(&mut self, row: &Variable<V>) {
        let Cells { name, kind, unit, start, shown, range, paper, is_choice, .. } = Cells::of(row);
        let mut value = if is_choice { link_to_item(&kind, &start) } else { escape(&start) };
        if let Some(unit) = unit
            .split(" (")
            .next()
            .filter(|unit| !unit.is_empty() && !unit.starts_with('(') && row.role() != Role::Calculated)
        {
            value += &format!(" {}", escape(unit));
        }
        if !shown.is_empty() {
            value += &format!(" <small>= {}</small>", escape(&shown));
        }
        if row.role() == Role::Tunable {
            value += " <small class=\"tag\">tunable</small>";
        }
        let paper = if is_choice && !paper.is_empty() { link_to_item(&kind, &paper) } else { escape(&paper) };
        let (meaning, source) = (self.inline(row.description), self.inline(row.source));
        self.row_of(row.name, &[&code(&name), &value, &escape(&range), &paper, &meaning, &source]);
    }

    /// Faults by reaction, the mildest first.
    fn faults(&mut self, ty: &EnumType) {
        self.section("faults", "Faults");
        self.put(format_args!("<p id=\"type-{}\">{}.</p>\n", ty.name, escape(ty.description)));
        for reaction in ty.reactions {
            let is_of = |(item, _): &(&Item, i32)| item.reaction == reaction.name;
            let items: Vec<_> = ty.items.iter().zip(1..).filter(is_of).collect();
            if items.is_empty() {
                continue;
            }
            let (does, acknowledge) = (self.inline(reaction.description), self.inline(reaction.acknowledge));
            self.put(format_args!(
                "<h3>{}</h3>\n<p>Reaction: {does}. Acknowledge: {acknowledge}.</p>\n",
                code(reaction.name)
            ));
            self.table("faults", &["Number", "Fault", "Cause", "Detected when", "Remedy"], &mut |page| {
                for (item, number) in &items {
                    let (cause, detection) = (page.inline(item.description), page.inline(item.detection));
                    let cells = [number.to_string(), code(item.name), cause, detection, page.inline(item.hint)];
                    page.row_of(&format!("{}-{}", ty.name, item.name), &cells.each_ref().map(String::as_str));
                }
            });
        }
    }

    /// All enumerations but the faults.
    fn enumerations<V>(&mut self, table: &[Variable<V>]) {
        for ty in used_types(table).into_iter().filter(|ty| ty.reactions.is_empty()) {
            self.section(&format!("type-{}", ty.name), &format!("Enumeration {}", code(ty.name)));
            let description = self.inline(ty.description);
            self.put(format_args!("<p>{description}.</p>\n"));
            let has_remedies = ty.items.iter().any(|item| !item.hint.is_empty());
            let head: &[&str] =
                if has_remedies { &["Number", "Item", "Meaning", "Remedy"] } else { &["Number", "Item", "Meaning"] };
            self.table("items", head, &mut |page| page.items(ty, has_remedies));
        }
    }

    fn items(&mut self, ty: &EnumType, has_remedies: bool) {
        for (item, number) in ty.items.iter().zip(1..) {
            let number = format!("{number}");
            let (name, meaning, hint) = (code(item.name), self.inline(item.description), self.inline(item.hint));
            let cells = [number.as_str(), &name, &meaning, &hint];
            self.row_of(&format!("{}-{}", ty.name, item.name), if has_remedies { &cells } else { &cells[..3] });
        }
    }

    fn section(&mut self, id: &str, title: &str) {
        self.put(format_args!("<h2 id=\"{id}\">{title}</h2>\n"));
    }

    fn table(&mut self, class: &str, head: &[&str], rows: &mut dyn FnMut(&mut Self)) {
        self.put(format_args!("<table class=\"declared {class}\">\n<tr><th>{}</th></tr>\n", head.join("</th><th>")));
        rows(self);
        self.text += "</table>\n";
    }

    fn row(&mut self, cells: &[&str]) {
        self.put(format_args!("<tr><td>{}</td></tr>\n", cells.join("</td><td>")));
    }

    /// A row that links lead to.
    #[inline(never)]
    fn row_of(&mut self, id: &str, cells: &[&str]) {
        self.put(format_args!("<tr id=\"{id}\"><td>{}</td></tr>\n", cells.join("</td><td>")));
    }

    /// A text of the declaration: text between backticks is code, and links to the variable of that name.
    #[inline(never)]
    fn inline(&self, text: &str) -> String {
        let parts = text.split('`').enumerate().map(|(i, part)| match self.names.contains(&part) {
            _ if i % 2 == 0 => escape(part),
            true => format!("<a href=\"#{part}\">{}</a>", code(part)),
            false => code(part),
        });
        parts.collect()
    }

    // here and below: the page is made once, in every FMU, so small code is worth more than fast code
    #[inline(never)]
    fn put(&mut self, text: std::fmt::Arguments) {
        self.text.write_fmt(text).expect("writing to a String");
    }
}

/// A name in camel case that may be broken between its words.
fn breakable(name: &str) -> String {
    let capital = |c: char| if c.is_uppercase() { format!("<wbr/>{c}") } else { escape(c.encode_utf8(&mut [0; 4])) };
    name.chars().map(capital).collect()
}

fn is_parameter(role: Role) -> bool {
    role.is_parameter() || role == Role::Calculated
}

/// A time with a unit in which it is not a small fraction.
fn shown(time: f64) -> String {
    let (factor, unit) =
        [(1.0, "s"), (1e3, "ms")].into_iter().find(|(factor, _)| time * factor >= 1.0).unwrap_or((1e6, "us"));
    format!("{} {unit}", number(time * factor))
}

fn group(name: &str) -> &str {
    name.rsplit_once('.').map_or("", |(group, _)| group)
}

#[inline(never)]
fn code(text: &str) -> String {
    // long names may be broken after their parts
    format!("<code>{}</code>", escape(text).replace('.', ".<wbr/>").replace('_', "_<wbr/>"))
}

fn link_to_type(name: &str) -> String {
    format!("<a href=\"#type-{name}\">{name}</a>")
}

fn link_to_item(ty: &str, item: &str) -> String {
    format!("<a href=\"#{ty}-{item}\">{item}</a>")
}
