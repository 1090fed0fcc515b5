//! A chart of states as SVG: the states below each other, paths forward on the right and back on the left, each with the
//! number of its row in the table of transitions.

use std::fmt::Write as _;

use super::markup::escaped;

/// Height of a state, distance of two, width of a letter and of a small one, and minimum width of a lane for paths.
const HEIGHT: usize = 28;
const ROW: usize = 56;
const LETTER: usize = 9;
const SMALL: usize = 7;
const LANE: usize = 34;

/// Distance of the numbers of a path from its line, and from the next element.
const GAP: usize = 4;

/// A path from state to state, by their indices, with the numbers of its transitions.
struct Way {
    from: usize,
    to: usize,
    numbers: String,
    lane: usize,
}

impl Way {
    fn span(&self) -> (usize, usize) {
        (self.from.min(self.to), self.from.max(self.to))
    }

    fn is_forward(&self) -> bool {
        self.to > self.from
    }

    /// Whether it leads to the next state below: an arrow between the two.
    fn is_step(&self) -> bool {
        self.to == self.from + 1
    }
}

/// The picture of transitions in the order of their numbers, from 1; the state with the name `begin` is where it begins.
/// A state links to its row in the page, if it has one.
pub fn write(transitions: &[(String, String)], begin: &str, page: &str) -> String {
    let mut states: Vec<&str> = Vec::new();
    for name in transitions.iter().flat_map(|(from, to)| [from, to]) {
        if name != begin && !states.contains(&name.as_str()) {
            states.push(name);
        }
    }
    let place = |name: &str| states.iter().position(|state| *state == name);
    let mut ways: Vec<Way> = Vec::new();
    for ((from, to), number) in transitions.iter().zip(1..) {
        let (Some(from), Some(to)) = (place(from), place(to)) else { continue };
        match ways.iter_mut().find(|way| (way.from, way.to) == (from, to)) {
            Some(way) => _ = write!(way.numbers, ", {number}"),
            None => ways.push(Way { from, to, numbers: number.to_string(), lane: 0 }),
        }
    }
    let (right, left) = (lay(&mut ways, true), lay(&mut ways, false));
    let (right_lane, left_lane) = (lane_width(&ways, true), lane_width(&ways, false));
    let widest = states.iter().map(|state| state.chars().count()).max().unwrap_or_default();
    let (x, inside) = ((left + 1) * left_lane, (widest + 3) * LETTER);
    let (width, height) = (x + inside + (right + 1) * right_lane, states.len() * ROW + 30);
    let mut svg = format!(
        "<div class=\"scroll\">\n<svg class=\"block\" width=\"{width}\" viewBox=\"0 0 {width} {height}\" role=\"img\" aria-label=\"States\">\n"
    );
    for (_, to) in transitions.iter().filter(|(from, _)| from == begin) {
        if let Some(to) = place(to) {
            let (x, y) = (x + inside / 2, top(to));
            _ = writeln!(svg, "<circle cx=\"{x}\" cy=\"{}\" r=\"5\" style=\"fill:var(--soft)\"/>", y - 22);
            _ = writeln!(svg, "<line x1=\"{x}\" y1=\"{}\" x2=\"{x}\" y2=\"{}\"/>", y - 17, y - 9);
            svg += &head(x, y, (0, 1));
        }
    }
    for way in &ways {
        svg += &drawn(way, x, inside, if way.is_forward() { right_lane } else { left_lane });
    }
    for (i, state) in states.iter().enumerate() {
        let (y, middle, state) = (top(i), x + inside / 2, escaped(state));
        let label = format!("<text class=\"n\" x=\"{middle}\" y=\"{}\">{state}</text>", y + 19);
        let label = if page.contains(&format!("id=\"State-{state}\"")) {
            format!("<a href=\"#State-{state}\">{label}</a>")
        } else {
            label
        };
        _ = writeln!(svg, "<rect x=\"{x}\" y=\"{y}\" width=\"{inside}\" height=\"{HEIGHT}\" rx=\"13\"/>{label}");
    }
    svg + "</svg>\n</div>\n"
}

/// Puts the ways of a side into lanes, short ones inside, so that none overlap; returns the number of lanes.
fn lay(ways: &mut [Way], forward: bool) -> usize {
    let mut lanes: Vec<Vec<(usize, usize)>> = Vec::new();
    let mut order: Vec<_> = ways.iter_mut().filter(|way| way.is_forward() == forward && !way.is_step()).collect();
    order.sort_by_key(|way| way.span().1 - way.span().0);
    for way in order {
        let (low, high) = way.span();
        let free = |lane: &Vec<(usize, usize)>| lane.iter().all(|(begin, end)| high < *begin || *end < low);
        way.lane = lanes.iter().position(free).unwrap_or(lanes.len());
        if way.lane == lanes.len() {
            lanes.push(Vec::new());
        }
        lanes[way.lane].push((low, high));
    }
    lanes.len()
}

/// Width of the lanes of a side: of its longest label, as the next line or the end of the picture follows.
fn lane_width(ways: &[Way], forward: bool) -> usize {
    let labels = ways.iter().filter(|way| way.is_forward() == forward && !way.is_step());
    let longest = labels.map(|way| way.numbers.len()).max().unwrap_or_default();
    LANE.max(longest * SMALL + 2 * GAP)
}

fn top(state: usize) -> usize {
    30 + state * ROW
}

fn drawn(way: &Way, x: usize, inside: usize, lane: usize) -> String {
    let numbers = &way.numbers;
    if way.is_step() {
        let (middle, from, to) = (x + inside / 2, top(way.from) + HEIGHT, top(way.to));
        let line = format!("<line x1=\"{middle}\" y1=\"{from}\" x2=\"{middle}\" y2=\"{}\"/>\n", to - 9);
        let label = format!("<text class=\"u\" x=\"{}\" y=\"{}\">{numbers}</text>\n", middle + 8, from + 17);
        return line + &head(middle, to, (0, 1)) + &label;
    }
    // ways leave and come in at places of their own
    let (leave, come) = if way.is_forward() { (20, 8) } else { (8, 20) };
    let (from, to) = (top(way.from) + leave, top(way.to) + come);
    let reach = (way.lane + 1) * lane - 8;
    let (edge, bend, label) = if way.is_forward() {
        (x + inside, x + inside + reach, GAP.cast_signed())
    } else {
        (x, x - reach, -GAP.cast_signed())
    };
    let tip = if way.is_forward() { edge + 8 } else { edge - 8 };
    let anchor = if way.is_forward() { "" } else { " text-anchor=\"end\"" };
    let inward = if way.is_forward() { -1 } else { 1 };
    format!(
        "<path d=\"M{edge} {from}C{bend} {from} {bend} {from} {bend} {}L{bend} {}C{bend} {to} {bend} {to} {tip} {to}\" style=\"fill:none;stroke:var(--soft)\"/>\n\
         <text class=\"u\" x=\"{}\" y=\"{}\"{anchor}>{numbers}</text>\n",
        if to > from { from + 14 } else { from - 14 },
        if to > from { to - 14 } else { to + 14 },
        bend.saturating_add_signed(label),
        (from + to) / 2 + 4
    ) + &head(edge, to, (inward, 0))
}

/// The head of an arrow with its tip at a point, in a direction.
fn head(x: usize, y: usize, (dx, dy): (isize, isize)) -> String {
    let at = |along: isize, across: isize| {
        format!("{} {}", x as isize - along * dx + across * dy, y as isize - along * dy + across * dx)
    };
    format!("<path d=\"M{}L{}L{}z\"/>\n", at(0, 0), at(9, 4), at(9, -4))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn chart(transitions: &[(&str, &str)]) -> String {
        let named = transitions.iter().map(|(from, to)| ((*from).to_owned(), (*to).to_owned()));
        write(&named.collect::<Vec<_>>(), "begin", "<td id=\"State-Run\"/>")
    }

    #[test]
    fn every_state_is_there_once_and_every_way_has_its_numbers() {
        let svg = chart(&[("begin", "Idle"), ("Idle", "Run"), ("Run", "Idle"), ("Run", "Idle"), ("Run", "Done")]);
        for state in ["Idle", "Run", "Done"] {
            assert_eq!(svg.matches(&format!(">{state}</text>")).count(), 1, "{svg}");
        }
        assert!(svg.contains(">2</text>") && svg.contains(">3, 4</text>") && svg.contains(">5</text>"), "{svg}");
        // only `Run` has a place in the page
        assert_eq!((svg.matches("<a href").count(), svg.matches("<a href=\"#State-Run\"><text").count()), (1, 1));
        assert_eq!((svg.matches("<circle").count(), svg.matches("<rect").count()), (1, 3));
    }

    #[test]
    fn a_label_ends_before_the_next_line_and_inside_the_picture() {
        let svg = chart(&[
            ("begin", "A"),
            ("A", "B"),
            ("B", "C"),
            ("C", "D"),
            // three ways from C back to A, and two from D, in the lane behind
            ("C", "A"),
            ("C", "A"),
            ("C", "A"),
            ("D", "A"),
            ("D", "A"),
        ]);
        let number = |text: &str| text.parse::<usize>().unwrap();
        let labels = svg.lines().filter(|line| line.contains("text-anchor=\"end\""));
        // numbers are written in 11 px, 6.6 px a letter
        let mut spans: Vec<_> = labels
            .map(|line| {
                let right = number(line.split("x=\"").nth(1).unwrap().split('"').next().unwrap());
                let label = line.split('>').nth(1).unwrap().split('<').next().unwrap();
                (right as f64 - 6.6 * label.len() as f64, right)
            })
            .collect();
        spans.sort_by_key(|(_, right)| *right);
        let [(outer, outer_line), (inner, _)] = spans[..] else { panic!("{svg}") };
        assert!(outer >= 0.0 && inner > (outer_line + GAP) as f64, "{svg}");
    }

    #[test]
    fn ways_that_overlap_have_lanes_of_their_own() {
        let mut ways =
            [(0, 3), (1, 3), (4, 6), (3, 0)].map(|(from, to)| Way { from, to, numbers: String::new(), lane: 9 });
        assert_eq!((lay(&mut ways, true), lay(&mut ways, false)), (2, 1));
        assert_eq!(ways.map(|way| way.lane), [1, 0, 0, 0]);
    }
}
