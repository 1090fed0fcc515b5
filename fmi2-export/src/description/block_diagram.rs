//! The block with its ports, as SVG: inputs on the left, outputs on the right, each with its unit.

use crate::description::cells::Cells;
use crate::description::xml::escape;
use crate::table::variable::{Kind, Role, Variable};
use std::fmt::Write;

/// Distance of two ports, height of the title, length of an arrow, and width of a letter, in the units of the picture.
const ROW: usize = 24;
const HEAD: usize = 44;
const ARROW: usize = 44;
const LETTER: usize = 8;

/// The picture.
pub fn write<V>(name: &str, table: &[Variable<V>]) -> String {
    let of = |role: Role| table.iter().filter(move |row| row.role() == role);
    let rows = of(Role::Input).count().max(of(Role::Output).count());
    let widest = |role: Role| of(role).map(letters).max().unwrap_or_default();
    let inside = (widest(Role::Input) + widest(Role::Output) + 6).max(name.len() + 8) * LETTER;
    let (right, width) = (ARROW + inside, 2 * ARROW + inside);
    let (block, height) = (HEAD + rows * ROW, HEAD + rows * ROW + 2);
    let mut svg = format!(
        "<div class=\"scroll\">\n<svg class=\"block\" width=\"{width}\" viewBox=\"0 0 {width} {height}\" role=\"img\" aria-label=\"Inputs and outputs\">\n\
         <rect x=\"{ARROW}\" y=\"1\" width=\"{inside}\" height=\"{block}\" rx=\"6\"/>\n<text class=\"n\" x=\"{}\" y=\"26\">{}</text>\n",
        width / 2,
        escape(name)
    );
    for (row, y) in of(Role::Input).zip((HEAD + ROW / 2..).step_by(ROW)) {
        port(&mut svg, row, y, [4, ARROW - 10, ARROW], ARROW + 10, "");
    }
    for (row, y) in of(Role::Output).zip((HEAD + ROW / 2..).step_by(ROW)) {
        port(&mut svg, row, y, [right, width - 14, width - 4], right - 10, " class=\"r\"");
    }
    svg + "</svg>\n</div>\n"
}

/// A line with an arrow, an open one for what is no Real, and the name.
fn port<V>(svg: &mut String, row: &Variable<V>, y: usize, [from, head, tip]: [usize; 3], x: usize, class: &str) {
    let (name, unit) = (Cells::of(row).name, unit(row));
    let unit = if unit.is_empty() { String::new() } else { format!(" <tspan class=\"u\">{}</tspan>", escape(unit)) };
    let fill =
        if matches!(row.kind, Kind::Real { .. }) { "" } else { " style=\"fill:var(--paper);stroke:var(--soft)\"" };
    writeln!(
        svg,
        "<line x1=\"{from}\" y1=\"{y}\" x2=\"{head}\" y2=\"{y}\"/><path d=\"M{head} {}L{tip} {y}L{head} {}z\"{fill}/>\
         <a href=\"#{}\"><text{class} x=\"{x}\" y=\"{}\">{}{unit}</text></a>",
        y - 5,
        y + 5,
        row.name,
        y + 4,
        escape(&name)
    )
    .expect("writing to a String");
}

/// Letters of a port: its name as it is drawn, a blank and the unit.
fn letters<V>(row: &Variable<V>) -> usize {
    Cells::of(row).name.chars().count() + 1 + unit(row).chars().count()
}

fn unit<V>(row: &Variable<V>) -> &'static str {
    match &row.kind {
        Kind::Real { real, .. } => real.unit.map_or("", |unit| unit.name),
        _ => "",
    }
}
