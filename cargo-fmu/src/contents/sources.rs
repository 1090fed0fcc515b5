//! A README without what it tells of source files, which are not inside an FMU.

use std::path::PathBuf;

/// What is a source file by its name alone.
const ENDS: [&str; 2] = [".rs", ".py"];
const MANIFEST: &str = "Cargo.toml";

/// What lies here is inside the FMU.
const PACKED: &str = "resources/";

/// The Markdown text without parentheses, sentences and rows of tables that name source files, and without the sections that
/// have nothing else. What lies at a path with a `/` in one of `folders` is a source, too.
pub fn left_out(markdown: &str, folders: &[PathBuf]) -> String {
    Sources { folders }.left_out(markdown)
}

struct Sources<'a> {
    folders: &'a [PathBuf],
}

impl Sources<'_> {
    fn left_out(&self, markdown: &str) -> String {
        let mut blocks: Vec<String> = Vec::new();
        let (mut in_code, mut headings) = (false, 0);
        for block in markdown.split("\n\n") {
            let code = in_code || block.contains("```");
            in_code ^= block.matches("```").count() % 2 == 1;
            let kept = if code {
                block.to_owned()
            } else if block.trim_start().starts_with('|') {
                self.table(block)
            } else {
                self.paragraph(block)
            };
            if kept.trim().is_empty() && !block.trim().is_empty() {
                continue;
            }
            // a heading with nothing below is one of a section that was left out
            if kept.trim_start().starts_with('#') {
                headings += 1;
            } else {
                headings = 0;
            }
            if headings > 1 && level(&kept) <= blocks.last().map_or(0, |last| level(last)) {
                blocks.pop();
            }
            blocks.push(kept);
        }
        blocks.join("\n\n")
    }

    /// Whether a text names a source file, as code.
    fn names_source(&self, text: &str) -> bool {
        let is_source = |code: &str| {
            let relative = code.contains('/') && !code.starts_with('/') && !code.starts_with(PACKED);
            let lies = || relative && self.folders.iter().any(|folder| folder.join(code).exists());
            code == MANIFEST || ENDS.iter().any(|end| code.ends_with(end)) || lies()
        };
        text.split('`').skip(1).step_by(2).any(is_source)
    }

    /// The rows whose first cell names none; nothing where all rows do.
    fn table(&self, block: &str) -> String {
        let mut rows: Vec<_> = block.lines().collect();
        let body = rows.split_off(rows.len().min(2));
        let had_rows = !body.is_empty();
        let first = |row: &str| self.names_source(row.trim_start_matches('|').split('|').next().unwrap_or_default());
        let kept: Vec<_> =
            body.into_iter().filter(|row| !first(row)).map(|row| self.without_parentheses(row)).collect();
        if had_rows && kept.is_empty() {
            return String::new();
        }
        rows.into_iter().map(str::to_owned).chain(kept).collect::<Vec<_>>().join("\n")
    }

    fn paragraph(&self, block: &str) -> String {
        if block.trim_start().starts_with('#') {
            return block.to_owned();
        }
        let text = self.without_parentheses(block);
        if !self.names_source(&text) {
            return text;
        }
        let mut kept = String::new();
        for item in items(&text) {
            let rest: String = sentences(item).into_iter().filter(|sentence| !self.names_source(sentence)).collect();
            if !rest.trim().trim_start_matches(['-', '*']).trim().is_empty() {
                kept += &rest;
            }
        }
        kept
    }

    /// A text without the parentheses that name source files.
    fn without_parentheses(&self, text: &str) -> String {
        let mut kept = String::new();
        let mut rest = text;
        while let Some(open) = rest.find(" (") {
            let inside = &rest[open + 2..];
            let Some(close) = inside.find(')') else { break };
            kept += &rest[..open];
            if !self.names_source(&inside[..close]) {
                kept += &rest[open..open + 2 + close + 1];
            }
            rest = &inside[close + 1..];
        }
        kept + rest
    }
}

fn level(block: &str) -> usize {
    block.trim_start().chars().take_while(|c| *c == '#').count()
}

/// A list in its items; any other text is one.
fn items(text: &str) -> Vec<&str> {
    let mut starts: Vec<_> = text.match_indices("\n- ").map(|(at, _)| at + 1).collect();
    starts.insert(0, 0);
    let ends = starts[1..].iter().copied().chain([text.len()]);
    starts.iter().zip(ends).map(|(start, end)| &text[*start..end]).collect()
}

/// The sentences of a text with what separates them: a stop that code does not hold. Behind that of an abbreviation a digit
/// or a small letter follows.
fn sentences(text: &str) -> Vec<&str> {
    let (mut sentences, mut start, mut in_code) = (Vec::new(), 0, false);
    for (at, byte) in text.bytes().enumerate() {
        in_code ^= byte == b'`';
        if in_code || byte != b'.' {
            continue;
        }
        let rest = &text[at + 1..];
        let next = rest.trim_start().chars().next();
        let goes_on = next.is_some_and(|next| next.is_ascii_digit() || next.is_lowercase());
        if (rest.is_empty() || rest.starts_with(char::is_whitespace)) && !goes_on {
            let end = at + 1 + rest.chars().next().map_or(0, char::len_utf8);
            sentences.push(&text[start..end]);
            start = end;
        }
    }
    sentences.push(&text[start..]);
    sentences
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sentences_parentheses_and_rows_about_sources_go() {
        let text = "The law (`src/law.rs`) is short. Each idea has a file: `src/a.rs`. It ends at 0.5 s (eq. 3).\n\n\
            | file | what |\n|---|---|\n| `src/a.rs` | a |\n\n## Kept\n\n| a |\n|---|\n| b |";
        let wanted = "The law is short. It ends at 0.5 s (eq. 3).\n\n## Kept\n\n| a |\n|---|\n| b |";
        assert_eq!(left_out(text, &[]), wanted);
    }

    #[test]
    fn a_sentence_goes_on_behind_an_abbreviation_and_a_scenario_is_no_source() {
        let text = "By eq. 3 of `src/law.rs` it holds, e.g. there. Set `two.toml` and `plant.xml`. See `Cargo.toml`.";
        assert_eq!(left_out(text, &[]).trim(), "Set `two.toml` and `plant.xml`.");
    }

    #[test]
    fn what_lies_in_the_project_is_a_source_and_what_does_not_is_none() {
        let here = [PathBuf::from(env!("CARGO_MANIFEST_DIR"))];
        let text = "Kept: `plants/reactor.toml`, `src` and `/dev/null`. Gone: `src/contents`.";
        assert_eq!(left_out(text, &here).trim(), "Kept: `plants/reactor.toml`, `src` and `/dev/null`.");
        assert_eq!(left_out(text, &[]), text);
    }

    #[test]
    fn any_white_space_ends_a_sentence() {
        assert_eq!(left_out("See `src/a.rs`.\u{a0}Next.", &[]), "Next.");
    }

    #[test]
    fn a_section_about_sources_goes_with_its_heading() {
        let text = "## Files\n\nSee `src/lib.rs`.\n\n## Use\n\n### First\n\nSet `x.y`.";
        assert_eq!(left_out(text, &[]), "## Use\n\n### First\n\nSet `x.y`.");
    }

    #[test]
    fn items_of_a_list_stay_without_the_others_and_code_stays() {
        let text = "- one\n- two in `two.rs`\n- three\n\n```\ncargo test `src/a.rs`.\n\nend.\n```";
        assert_eq!(left_out(text, &[]), "- one\n- three\n\n```\ncargo test `src/a.rs`.\n\nend.\n```");
    }
}
