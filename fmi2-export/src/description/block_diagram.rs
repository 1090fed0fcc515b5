//! The block with its ports, as SVG: inputs on the left, outputs on the right, each with its unit; a large group is one
//! port.

use crate::description::cells::{Cells, unit_name};
use crate::description::xml::escape;
use crate::table::variable::{Kind, Role, Variable};
use std::fmt::Write;

/// Distance of two ports, height of the title, length of an arrow, and width of a letter, in the units of the picture.
const ROW: usize = 24;
const HEAD: usize = 44;
const ARROW: usize = 44;
const LETTER: usize = 8;

/// Number of variables of a group that still have ports of their own.
const SINGLE: usize = 4;

/// Legend of the arrows, below the picture.
const LEGEND: &str =
    "<p>Filled arrow: Real. Open arrow: Integer, Boolean or enumeration. Thick arrow: a group of variables.</p>\n";

/// A line with an arrow.
struct Port {
    name: String,
    /// Text after the name: the unit, or the number of variables.
    suffix: String,
    /// Where the row of the variable is, or of the first one of the group.
    row: &'static str,
    /// Styles of the line and of its arrow.
    line: &'static str,
    head: &'static str,
}

/// The picture.
pub fn write<V>(name: &str, table: &[Variable<V>]) -> String {
    let (inputs, outputs) = (ports(table, Role::Input, "inputs"), ports(table, Role::Output, "outputs"));
    let rows = inputs.len().max(outputs.len());
    let widest = |ports: &[Port]| ports.iter().map(Port::letters).max().unwrap_or_default();
    let inside = (widest(&inputs) + widest(&outputs) + 6).max(name.len() + 8) * LETTER;
    let (right, width) = (ARROW + inside, 2 * ARROW + inside);
    let (block, height) = (HEAD + rows * ROW, HEAD + rows * ROW + 2);
    let mut svg = format!(
        "<div class=\"scroll\">\n<svg class=\"block\" width=\"{width}\" viewBox=\"0 0 {width} {height}\" role=\"img\" aria-label=\"Inputs and outputs\">\n\
         <rect x=\"{ARROW}\" y=\"1\" width=\"{inside}\" height=\"{block}\" rx=\"6\"/>\n<text class=\"n\" x=\"{}\" y=\"26\">{}</text>\n",
        width / 2,
        escape(name)
    );
    for (port, y) in inputs.iter().zip((HEAD + ROW / 2..).step_by(ROW)) {
        port.draw(&mut svg, y, [4, ARROW - 10, ARROW], ARROW + 10, "");
    }
    for (port, y) in outputs.iter().zip((HEAD + ROW / 2..).step_by(ROW)) {
        port.draw(&mut svg, y, [right, width - 14, width - 4], right - 10, " class=\"r\"");
    }
    svg + "</svg>\n</div>\n" + LEGEND
}

/// The ports of one side, in the order of the table; a large group has the position of its first variable.
fn ports<V>(table: &[Variable<V>], role: Role, what: &str) -> Vec<Port> {
    let rows: Vec<_> = table.iter().filter(|row| row.role() == role).collect();
    let group = |row: &Variable<V>| row.name.split_once('.').map(|(group, _)| group);
    let (mut ports, mut drawn) = (Vec::new(), Vec::new());
    for row in &rows {
        let members = rows.iter().filter(|other| group(other) == group(row)).count();
        match group(row) {
            Some(group) if members > SINGLE => {
                if !drawn.contains(&group) {
                    drawn.push(group);
                    ports.push(Port {
                        name: format!("{group}.*"),
                        suffix: format!("{members} {what}"),
                        row: row.name,
                        line: " style=\"stroke-width:4\"",
                        head: "",
                    });
                }
            }
            _ => ports.push(Port::of(row)),
        }
    }
    ports
}

impl Port {
    /// The port of a variable.
    fn of<V>(row: &Variable<V>) -> Self {
        let (real, unit) = match &row.kind {
            Kind::Real { real, .. } => (true, unit_name(real)),
            _ => (false, ""),
        };
        let head = if real { "" } else { " style=\"fill:var(--paper);stroke:var(--soft)\"" };
        Self { name: Cells::of(row).name, suffix: unit.to_owned(), row: row.name, line: "", head }
    }

    fn draw(&self, svg: &mut String, y: usize, [from, head, tip]: [usize; 3], x: usize, class: &str) {
        let suffix = match &*self.suffix {
            "" => String::new(),
            suffix => format!(" <tspan class=\"u\">{}</tspan>", escape(suffix)),
        };
        writeln!(
            svg,
            "<line x1=\"{from}\" y1=\"{y}\" x2=\"{head}\" y2=\"{y}\"{}/><path d=\"M{head} {}L{tip} {y}L{head} {}z\"{}/>\
             <a href=\"#{}\"><text{class} x=\"{x}\" y=\"{}\">{}{suffix}</text></a>",
            self.line,
            y - 5,
            y + 5,
            self.head,
            self.row,
            y + 4,
            escape(&self.name)
        )
        .expect("writing to a String");
    }

    /// Letters of a port: its name, a blank and the suffix.
    fn letters(&self) -> usize {
        self.name.chars().count() + 1 + self.suffix.chars().count()
    }
}
