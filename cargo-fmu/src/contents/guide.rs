//! The texts of a package in the documentation page of its FMU: an example of use, the guide, the results.

use std::fmt::Write as _;
use std::ops::Range;

use pulldown_cmark::{CodeBlockKind, CowStr, Event, HeadingLevel, Options, Parser, Tag, TagEnd, html};

use super::chapters::{Chapters, GENERATED, QuickStart, slug};
use super::markup::escaped;
use super::sources::Outside;
use super::state_chart;

/// Where the page of `fmi2-export` takes texts, and the links to their sections.
const PLATFORMS: &str = "<!-- platforms -->";
const QUICK_START: [&str; 2] = ["<!-- quick start -->\n", "<!-- contents of the quick start -->\n"];
const GUIDE: [&str; 2] = ["<!-- guide -->\n", "<!-- contents of the guide -->\n"];
const RESULTS: [&str; 2] = ["<!-- results -->\n", "<!-- contents of the results -->\n"];

/// Name of the plot of the example next to the page.
pub const PLOT: &str = "run.svg";

/// The first state in a chart of states.
const BEGIN: &str = "begin";

/// Mark after what is generated from the declaration, which the page shows itself.
const END: &str = "<!-- end of ";

/// Title of the text before the first heading.
const INTRODUCTION: &str = "Description";

/// Prefix of the section names in the page.
const ID: &str = "guide-";

/// The page with the texts in it, whose states link to those of the page, without mentions of things `outside`; a page
/// without places for them stays as it is.
pub fn insert(page: &str, chapters: &Chapters, platforms: &[&str], outside: &Outside) -> String {
    let of = format!(", {}", platforms.join(", "));
    let page = page.replacen(PLATFORMS, if platforms.is_empty() { "" } else { &of }, 1);
    let (html, link) = chapters.quick_start.as_ref().map_or_else(Default::default, quick_start);
    let page = page.replacen(QUICK_START[0], &html, 1).replacen(QUICK_START[1], &link, 1);
    let page = insert_sections(&page, GUIDE, &chapters.guide, outside);
    insert_sections(&page, RESULTS, &chapters.results, outside)
}

fn insert_sections(page: &str, [place, contents]: [&str; 2], markdown: &str, outside: &Outside) -> String {
    let sections = sections(&written(markdown, outside), page);
    let links = sections.iter().filter(|section| !section.title.is_empty());
    let links = links.map(|section| format!("<a href=\"#{}\">{}</a>\n", section.id, section.title)).collect::<String>();
    let bodies = sections.iter().map(|section| section.html.as_str()).collect::<String>();
    page.replacen(place, &bodies, 1).replacen(contents, &links, 1)
}

/// The example as a section, and the link to it.
fn quick_start(QuickStart { name, program, plot }: &QuickStart) -> (String, String) {
    let mut html = format!(
        "<h2 id=\"quick-start\">Quick start</h2>\n<p>This program closes a loop around the FMU with \
         <a href=\"https://github.com/CATIA-Systems/FMPy\">FMPy</a>. It is next to this page: \
         <code>python {} FILE.fmu</code>.</p>\n<pre><code>{}</code></pre>\n",
        escaped(name),
        escaped(program.trim_end())
    );
    if plot.is_some() {
        _ = writeln!(html, "<p><img src=\"{PLOT}\" alt=\"Result of the quick start\"/></p>");
    }
    (html, "<a href=\"#quick-start\">Quick start</a>\n".to_owned())
}

/// A heading of the second order and what follows it; the first section has no heading.
struct Section {
    id: String,
    title: String,
    html: String,
}

/// The Markdown without mentions of things outside and without what is generated from the declaration; links to sections
/// of it lead to them.
fn written(markdown: &str, outside: &Outside) -> String {
    let text = format!("\n{}", by_hand(markdown));
    let parts: Vec<_> = text.split("\n## ").collect();
    let slugs: Vec<_> = parts.iter().skip(1).filter_map(|part| part.lines().next()).map(slug).collect();
    outside.left_out(&led_inside(&text, &slugs))
}

/// The Markdown without generated parts.
fn by_hand(markdown: &str) -> String {
    let mut kept = String::new();
    let mut is_generated = false;
    for line in markdown.lines() {
        if line.ends_with(GENERATED) {
            is_generated = true;
        } else if line.starts_with(END) {
            is_generated = false;
        } else if !is_generated {
            kept += line;
            kept.push('\n');
        }
    }
    kept
}

/// Links to sections of these names, in any file, as links inside the page.
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
    let end = events.iter().position(|event| matches!(event, Event::End(TagEnd::Heading(HeadingLevel::H2))));
    let is_headed = matches!(events.first(), Some(Event::Start(Tag::Heading { level: HeadingLevel::H2, .. })));
    let (heading, body) = events.split_at(end.filter(|_| is_headed).map_or(0, |end| end + 1));
    let mut text = String::new();
    html::push_html(&mut text, adapted(body, page).into_iter());
    let title = match is_headed {
        true => heading.iter().map(self::text).collect(),
        false if text.trim().is_empty() => String::new(),
        false => INTRODUCTION.to_owned(),
    };
    let (id, title) = (format!("{ID}{}", slug(&title)), escaped(&title));
    let heading = if title.is_empty() { String::new() } else { format!("<h2 id=\"{id}\">{title}</h2>\n") };
    Section { html: heading + &text, id, title }
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
        ## Variables\n\n<!-- variables: generated from the interface -->\n| n |\n|---|\n| y |\n<!-- end of variables -->\n\n## Limits\n\nNone.\n";

    fn shown(page: &str, markdown: &str) -> String {
        let chapters = Chapters { guide: markdown.to_owned(), ..Chapters::default() };
        insert(page, &chapters, &[], &Outside::default())
    }

    #[test]
    fn an_example_is_shown_with_its_plot_and_results_come_last() {
        let quick_start = |plot| {
            let program = "if a < b:\n    run()\n".to_owned();
            Some(QuickStart { name: "run.py".to_owned(), program, plot })
        };
        let page = [PLATFORMS, QUICK_START[1], QUICK_START[0], RESULTS[0]].concat();
        let results = "\n\n## Results\n\nGood.\n".to_owned();
        let chapters = Chapters { quick_start: quick_start(Some("<svg/>".to_owned())), guide: String::new(), results };
        let found = insert(&page, &chapters, &["linux64", "win64"], &Outside::default());
        assert!(found.starts_with(", linux64, win64<a href=\"#quick-start\">Quick start</a>\n<h2"), "{found}");
        assert!(
            found.contains("<code>python run.py FILE.fmu</code>") && found.contains("if a &lt; b:\n    run()</code>")
        );
        assert!(found.ends_with("<img src=\"run.svg\" alt=\"Result of the quick start\"/></p>\n<h2 id=\"guide-results\">Results</h2>\n<p>Good.</p>\n"), "{found}");
        let without = Chapters { quick_start: quick_start(None), ..chapters };
        assert!(!insert(&page, &without, &[], &Outside::default()).contains("<img"));
        assert_eq!(insert(&page, &Chapters::default(), &[], &Outside::default()), "");
    }

    #[test]
    fn the_readme_stands_in_its_place_without_title_and_tables() {
        let page = shown("<nav><!-- contents of the guide -->\n</nav>\n<!-- guide -->\nend", README);
        assert!(page.starts_with(
            "<nav><a href=\"#guide-description\">Description</a>\n<a href=\"#guide-how-it-works\">How it works</a>\n\
             <a href=\"#guide-limits\">Limits</a>\n</nav>\n<h2 id=\"guide-description\">Description</h2>\n<p>A <em>"
        ));
        assert!(page.ends_with("<h2 id=\"guide-limits\">Limits</h2>\n<p>None.</p>\nend"));
        assert!(!page.contains("Variables") && !page.contains("spring</h1>") && !page.contains("<!--"));
        assert!(page.contains("<div class=\"scroll\"><table>") && page.contains("<code>x</code>"));
    }

    #[test]
    fn only_links_to_the_net_stay_links() {
        let page = shown(GUIDE[0], README);
        assert!(page.contains("</em>, measured, see <a href=\"https://fmi-standard.org\">FMI</a>"), "{page}");
    }

    #[test]
    fn a_link_to_a_section_that_is_there_leads_to_it() {
        let text = "See [x](../a.md#how-it-works), [y](#other).\n\n## How it works\n\nSo.\n";
        let page = shown(GUIDE[0], text);
        assert!(page.contains("</h2>\n<p>See <a href=\"#guide-how-it-works\">x</a>, y.</p>"), "{page}");
    }

    #[test]
    fn a_chart_of_states_is_a_picture_and_a_table_of_transitions() {
        let page = shown(&format!("{}<td id=\"State-Idle\"/>", GUIDE[0]), README);
        assert!(
            page.contains("<tr><td>1</td><td>begin</td><td><a href=\"#State-Idle\">Idle</a></td><td></td></tr>"),
            "{page}"
        );
        // a state that the page does not hold leads nowhere
        assert!(page.contains("<td>Run</td><td>a &lt; b</td></tr>") && page.contains("<p>Run: slow.</p>"), "{page}");
    }

    #[test]
    fn a_chart_that_is_none_of_states_stays_code() {
        let page = shown(GUIDE[0], "```mermaid\nflowchart LR\n    a --> b\n```\n");
        assert!(page.contains("<code class=\"language-mermaid\">flowchart LR\n    a --&gt; b\n</code>"), "{page}");
        assert!(!page.contains("<table"), "{page}");
    }

    #[test]
    fn a_page_without_a_place_stays() {
        assert_eq!(shown("<p/>", README), "<p/>");
    }
}
