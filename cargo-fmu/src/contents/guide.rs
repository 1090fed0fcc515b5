//! The README of a package and what follows it as the guide in the documentation page of its FMU.

use std::fmt::Write as _;
use std::ops::Range;

use pulldown_cmark::{CodeBlockKind, CowStr, Event, HeadingLevel, Options, Parser, Tag, TagEnd, html};

use super::chapters::slug;
use super::markup::escaped;
use super::sources::Outside;
use super::state_chart;

/// Where the page of `fmi2-export` takes a guide, and the links to its sections.
const PLACE: &str = "<!-- guide -->\n";
const CONTENTS: &str = "<!-- contents of the guide -->\n";

/// What a chart of states calls the beginning.
const BEGIN: &str = "begin";

/// The heading of a section that the page has of its own.
const TABLES: &str = "<!-- variables:";

/// What the names of its sections begin with in the page.
const ID: &str = "guide-";

/// The page with the guide in it, whose states lead to those of the page, without what it tells of things `outside`; a page
/// without a place for it stays as it is.
pub fn insert(page: &str, markdown: &str, outside: &Outside) -> String {
    let sections = sections(&written(markdown, outside), page);
    let links = sections.iter().filter(|section| !section.title.is_empty());
    let links = links.map(|section| format!("<a href=\"#{}\">{}</a>\n", section.id, section.title)).collect::<String>();
    let bodies = sections.iter().map(|section| section.html.as_str()).collect::<String>();
    page.replacen(PLACE, &bodies, 1).replacen(CONTENTS, &links, 1)
}

/// A heading of the second order and what follows it; the first section has no heading.
struct Section {
    id: String,
    title: String,
    html: String,
}

/// The Markdown without what it tells of things outside, and the sections that hold the tables of the declaration; links to
/// sections of it lead to them.
fn written(markdown: &str, outside: &Outside) -> String {
    let is_kept = |part: &&str| !part.contains(TABLES);
    let text = format!("\n{markdown}");
    let parts: Vec<_> = text.split("\n## ").filter(is_kept).collect();
    let slugs: Vec<_> = parts.iter().skip(1).filter_map(|part| part.lines().next()).map(slug).collect();
    outside.left_out(&led_inside(&parts.join("\n## "), &slugs))
}

/// Links to sections of these names, in whichever file they stood, as links inside the page.
fn led_inside(markdown: &str, slugs: &[String]) -> String {
    let mut parts = markdown.split("](");
    let mut led = parts.next().unwrap_or_default().to_owned();
    for part in parts {
        let target = part.split(')').next().unwrap_or_default();
        let section = target.split_once('#').filter(|(file, _)| !file.contains("://")).map(|(_, section)| section);
        led += match section.filter(|section| slugs.iter().any(|slug| slug == section)) {
            Some(section) => format!("](#{ID}{section}{}", &part[target.len()..]),
            None => format!("]({part}"),
        }
        .as_str();
    }
    led
}

fn sections(markdown: &str, page: &str) -> Vec<Section> {
    let events: Vec<_> = Parser::new_ext(markdown, Options::ENABLE_TABLES).collect();
    let begins = |event: &Event| matches!(event, Event::Start(Tag::Heading { level: HeadingLevel::H2, .. }));
    let mut starts: Vec<_> = (0..events.len()).filter(|i| begins(&events[*i])).collect();
    starts.insert(0, 0);
    starts.dedup();
    let ends = starts[1..].iter().copied().chain([events.len()]);
    let ranges: Vec<Range<usize>> = starts.iter().zip(ends).map(|(start, end)| *start..end).collect();
    ranges.into_iter().map(|range| section(&events[range], page)).collect()
}

fn section(events: &[Event], page: &str) -> Section {
    let heading = events.iter().take_while(|event| !matches!(event, Event::End(TagEnd::Heading(HeadingLevel::H2))));
    let is_headed = matches!(events.first(), Some(Event::Start(Tag::Heading { level: HeadingLevel::H2, .. })));
    let title: String = if is_headed { heading.map(text).collect() } else { String::new() };
    let id = format!("{ID}{}", slug(&title));
    let mut html = String::new();
    let body = if is_headed {
        _ = writeln!(html, "<h2 id=\"{id}\">{}</h2>", escaped(&title));
        events.iter().position(|event| matches!(event, Event::End(TagEnd::Heading(_)))).map_or(0, |end| end + 1)
    } else {
        0
    };
    html::push_html(&mut html, adapted(&events[body..], page).into_iter());
    Section { id, title: escaped(&title), html }
}

/// Links that lead out of the FMU become plain text, tables may be scrolled, and a chart of states becomes a picture and a
/// table; another chart stays the code that it is.
fn adapted<'a>(events: &[Event<'a>], page: &str) -> Vec<Event<'a>> {
    let mut adapted = Vec::new();
    let mut chart = None;
    let mut unlinked = Vec::new();
    for (i, event) in events.iter().enumerate() {
        match event {
            Event::Start(Tag::CodeBlock(CodeBlockKind::Fenced(kind)))
                if &**kind == "mermaid"
                    && events.get(i + 1).is_some_and(|line| text(line).trim_start().starts_with("stateDiagram")) =>
            {
                chart = Some(String::new())
            }
            Event::End(TagEnd::CodeBlock) if chart.is_some() => {
                let table = transitions(&chart.take().unwrap_or_default(), page);
                adapted.push(Event::Html(CowStr::from(table)));
            }
            Event::Text(text) if chart.is_some() => chart.iter_mut().for_each(|chart| chart.push_str(text)),
            Event::Start(Tag::Link { dest_url, .. }) => {
                let stays = dest_url.contains("://") || dest_url.starts_with(&format!("#{ID}"));
                unlinked.push(!stays);
                if stays {
                    adapted.push(event.clone());
                }
            }
            Event::End(TagEnd::Link) if unlinked.pop() == Some(true) => {}
            Event::Start(Tag::Table(_)) => {
                adapted.extend([Event::Html("<div class=\"scroll\">".into()), event.clone()])
            }
            Event::End(TagEnd::Table) => adapted.extend([event.clone(), Event::Html("</div>\n".into())]),
            // a picture beside the README is not inside the FMU, and a comment is for who writes it
            Event::Start(Tag::Image { .. }) | Event::End(TagEnd::Image) | Event::Html(_) | Event::InlineHtml(_) => {}
            event => adapted.push(event.clone()),
        }
    }
    adapted
}

/// The transitions of a state diagram of Mermaid as a picture and a table, and its notes.
fn transitions(chart: &str, page: &str) -> String {
    let mut html =
        "<table class=\"declared chart\">\n<tr><th>Number</th><th>From</th><th>To</th><th>When</th></tr>\n".to_owned();
    let (mut notes, mut ways) = (String::new(), Vec::new());
    for line in chart.lines().map(str::trim) {
        if let Some((from, rest)) = line.split_once("-->") {
            let (to, when) = rest.split_once(':').unwrap_or((rest, ""));
            let state = |name: &str| match name.trim() {
                "[*]" => BEGIN.to_owned(),
                name if page.contains(&format!("id=\"State-{}\"", escaped(name))) => {
                    format!("<a href=\"#State-{0}\">{0}</a>", escaped(name))
                }
                name => escaped(name),
            };
            let name = |name: &str| if name.trim() == "[*]" { BEGIN.to_owned() } else { name.trim().to_owned() };
            ways.push((name(from), name(to)));
            _ = writeln!(
                html,
                "<tr><td>{}</td><td>{}</td><td>{}</td><td>{}</td></tr>",
                ways.len(),
                state(from),
                state(to),
                escaped(when.trim())
            );
        } else if let Some((of, note)) = line.strip_prefix("note ").and_then(|note| note.split_once(':')) {
            let of = of.rsplit(' ').next().unwrap_or_default();
            _ = writeln!(notes, "<p>{}: {}.</p>", escaped(of), escaped(note.trim()));
        }
    }
    state_chart::write(&ways, BEGIN, page) + &html + "</table>\n" + &notes
}

fn text<'a>(event: &'a Event) -> &'a str {
    match event {
        Event::Text(text) | Event::Code(text) => text,
        _ => "",
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const README: &str = "A *spring*, [measured](../docs/x.md), see [FMI](https://fmi-standard.org).\n\n\
        ## How `it` works\n\n```mermaid\nstateDiagram-v2\n    [*] --> Idle\n    Idle --> Run: a < b\n    \
        note right of Run: slow\n```\n\n| a | b |\n|---|---|\n| 1 | `x` |\n\n\
        ## Variables\n\n<!-- variables: made -->\n| n |\n|---|\n| y |\n<!-- end -->\n\n## Limits\n\nNone.\n";

    #[test]
    fn the_readme_stands_in_its_place_without_title_and_tables() {
        let page =
            insert("<nav><!-- contents of the guide -->\n</nav>\n<!-- guide -->\nend", README, &Outside::default());
        assert!(page.starts_with(
            "<nav><a href=\"#guide-how-it-works\">How it works</a>\n<a href=\"#guide-limits\">Limits</a>\n</nav>\n<p>A <em>"
        ));
        assert!(page.ends_with("<h2 id=\"guide-limits\">Limits</h2>\n<p>None.</p>\nend"));
        assert!(!page.contains("Variables") && !page.contains("spring</h1>") && !page.contains("<!--"));
        assert!(page.contains("<div class=\"scroll\"><table>") && page.contains("<code>x</code>"));
    }

    #[test]
    fn only_links_to_the_net_stay_links() {
        let page = insert(PLACE, README, &Outside::default());
        assert!(page.contains("</em>, measured, see <a href=\"https://fmi-standard.org\">FMI</a>"), "{page}");
    }

    #[test]
    fn a_link_to_a_section_that_is_there_leads_to_it() {
        let text = "See [x](../a.md#how-it-works), [y](#other).\n\n## How it works\n\nSo.\n";
        let page = insert(PLACE, text, &Outside::default());
        assert!(page.starts_with("<p>See <a href=\"#guide-how-it-works\">x</a>, y.</p>"), "{page}");
    }

    #[test]
    fn a_chart_of_states_is_a_picture_and_a_table_of_transitions() {
        let page = insert(&format!("{PLACE}<td id=\"State-Idle\"/>"), README, &Outside::default());
        assert!(
            page.contains("<tr><td>1</td><td>begin</td><td><a href=\"#State-Idle\">Idle</a></td><td></td></tr>"),
            "{page}"
        );
        // a state that the page does not hold leads nowhere
        assert!(page.contains("<td>Run</td><td>a &lt; b</td></tr>") && page.contains("<p>Run: slow.</p>"), "{page}");
    }

    #[test]
    fn a_chart_that_is_none_of_states_stays_code() {
        let page = insert(PLACE, "```mermaid\nflowchart LR\n    a --> b\n```\n", &Outside::default());
        assert!(page.contains("<code class=\"language-mermaid\">flowchart LR\n    a --&gt; b\n</code>"), "{page}");
        assert!(!page.contains("<table"), "{page}");
    }

    #[test]
    fn a_page_without_a_place_stays() {
        assert_eq!(insert("<p/>", README, &Outside::default()), "<p/>");
    }
}
