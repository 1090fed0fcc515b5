//! A README without its mentions of source files and of commands that need them, which are not inside an FMU.

use std::path::PathBuf;

/// Endings that identify the name of a source file, in whatever folder it is.
const ENDS: [&str; 2] = [".rs", ".py"];
const MANIFEST: &str = "Cargo.toml";

/// Start of the paths of files that are packed into the FMU.
const PACKED: &str = "resources/";

/// Programs that are run where the sources are.
const COMMANDS: [&str; 2] = ["cargo", "pytest"];

/// Folders and commands of a project that its FMUs do not contain.
#[derive(Default)]
pub struct Outside {
    /// Source folders: a path with a `/` that exists in one of them names a source.
    pub folders: Vec<PathBuf>,
    /// Commands of the project, in addition to `cargo` and `pytest`.
    pub commands: Vec<String>,
}

impl Outside {
    /// The Markdown text without the parentheses, sentences, rows of tables and blocks of code that name sources or run
    /// commands, without sentences that only lead to other files, and without the sections that have nothing else.
    pub fn left_out(&self, markdown: &str) -> String {
        let mut blocks: Vec<String> = Vec::new();
        let mut headings = 0;
        for block in blocks_of(markdown) {
            let kept = if block.contains("```") {
                if self.runs_commands(&block) { String::new() } else { block.clone() }
            } else if block.trim_start().starts_with('|') {
                self.table(&block)
            } else {
                self.paragraph(&block)
            };
            if kept.trim().is_empty() && !block.trim().is_empty() {
                // what led to it leads to nothing
                if let Some(last) = blocks.last_mut().filter(|last| last.ends_with(':')) {
                    last.truncate(last.len() - 1);
                    last.push('.');
                }
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

    /// Whether a text names a source file or a command as code, or only leads to other files.
    fn is_outside(&self, text: &str) -> bool {
        let is_source = |word: &str| {
            let relative = word.contains('/') && !word.starts_with('/') && !word.starts_with(PACKED);
            // files by a pattern lie where their folder does
            let path = word.split('*').next().unwrap_or_default().rsplit_once('/').filter(|_| word.contains('*'));
            let path = path.map_or(word, |(folder, _)| folder);
            let lies = || relative && self.folders.iter().any(|folder| folder.join(path).exists());
            word == MANIFEST || ENDS.iter().any(|end| word.ends_with(end)) || lies()
        };
        let code = |code: &str| self.is_command(code) || code.split_whitespace().any(is_source);
        text.split('`').skip(1).step_by(2).any(code) || is_signpost(text)
    }

    fn is_command(&self, line: &str) -> bool {
        let program = line.split_whitespace().next().unwrap_or_default();
        COMMANDS.contains(&program) || self.commands.iter().any(|command| command == program)
    }

    /// Whether a block of code is one of commands.
    fn runs_commands(&self, block: &str) -> bool {
        block.lines().any(|line| self.is_command(line))
    }

    /// The rows whose first cell names nothing outside; nothing where all rows do.
    fn table(&self, block: &str) -> String {
        let mut rows: Vec<_> = block.lines().collect();
        let body = rows.split_off(rows.len().min(2));
        let had_rows = !body.is_empty();
        let first = |row: &str| self.is_outside(row.trim_start_matches('|').split('|').next().unwrap_or_default());
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
        if !self.is_outside(&text) && !sentences(&text).iter().any(|sentence| self.is_outside(sentence)) {
            return text;
        }
        let mut kept = String::new();
        for item in items(&text) {
            let rest: String = sentences(item).into_iter().filter(|sentence| !self.is_outside(sentence)).collect();
            if !rest.trim().trim_start_matches(|c: char| c.is_ascii_digit() || "-*.".contains(c)).trim().is_empty() {
                kept += &rest;
            }
        }
        kept
    }

    /// A text without the parentheses that name what is outside.
    fn without_parentheses(&self, text: &str) -> String {
        let mut kept = String::new();
        let mut rest = text;
        while let Some(open) = opening(rest) {
            let inside = &rest[open + 2..];
            let Some(close) = closing(inside) else { break };
            kept += &rest[..open];
            if !self.is_outside(&inside[..close]) {
                kept += &rest[open..open + 2 + close + 1];
            }
            rest = &inside[close + 1..];
        }
        kept + rest
    }
}

/// Where a parenthesis begins, with the white space before it.
fn opening(text: &str) -> Option<usize> {
    [" (", "\n("].iter().filter_map(|begin| text.find(begin)).min()
}

/// Where a parenthesis ends whose inside begins here; links in it have parentheses of their own.
fn closing(inside: &str) -> Option<usize> {
    let mut depth = 0;
    inside.char_indices().find_map(|(at, c)| {
        depth += match c {
            '(' => 1,
            ')' => -1,
            _ => 0,
        };
        (depth < 0).then_some(at)
    })
}

/// Whether a text, or the part after its colon, consists of links out of the guide only.
fn is_signpost(text: &str) -> bool {
    let end = text.rsplit_once(':').map(|(_, end)| end).filter(|end| end.trim_start().starts_with('['));
    let (mut rest, mut left, mut links) = (end.unwrap_or(text), String::new(), 0);
    while let Some((before, link)) = rest.split_once('[') {
        let Some((target, after)) = link.split_once("](").and_then(|(_, target)| target.split_once(')')) else { break };
        if target.contains("://") || target.starts_with('#') {
            return false;
        }
        left += before;
        links += 1;
        rest = after;
    }
    left += rest;
    links > 0 && !left.replace("and", "").chars().any(char::is_alphanumeric)
}

/// A text in what blank lines separate; those in code separate nothing.
fn blocks_of(markdown: &str) -> Vec<String> {
    let mut blocks: Vec<String> = Vec::new();
    let mut in_code = false;
    for block in markdown.split("\n\n") {
        match blocks.last_mut().filter(|_| in_code) {
            Some(last) => *last += &format!("\n\n{block}"),
            None => blocks.push(block.to_owned()),
        }
        in_code ^= block.matches("```").count() % 2 == 1;
    }
    blocks
}

fn level(block: &str) -> usize {
    block.trim_start().chars().take_while(|c| *c == '#').count()
}

/// Whether a line begins an item of a list.
fn is_item(line: &str) -> bool {
    let rest = line.trim_start_matches(|c: char| c.is_ascii_digit());
    line.starts_with("- ") || rest.len() < line.len() && rest.starts_with(". ")
}

/// A list in its items; any other text is one.
fn items(text: &str) -> Vec<&str> {
    let starts = text.match_indices('\n').map(|(at, _)| at + 1).filter(|at| is_item(&text[*at..]));
    let mut starts: Vec<_> = starts.collect();
    starts.insert(0, 0);
    let ends = starts[1..].iter().copied().chain([text.len()]);
    starts.iter().zip(ends).map(|(start, end)| &text[*start..end]).collect()
}

/// The sentences of a text with what separates them: a stop that is not in code. After that of an abbreviation, a digit
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
        let text = "The model (`src/law.rs`) is short. Each idea has a file: `src/a.rs`. It ends at 0.5 s (eq. 3).\n\n\
            | file | what |\n|---|---|\n| `src/a.rs` | a |\n\n## Kept\n\n| a |\n|---|\n| b |";
        let wanted = "The model is short. It ends at 0.5 s (eq. 3).\n\n## Kept\n\n| a |\n|---|\n| b |";
        assert_eq!(Outside::default().left_out(text), wanted);
    }

    #[test]
    fn a_sentence_goes_on_behind_an_abbreviation_and_a_scenario_is_no_source() {
        let text = "By eq. 3 of `src/law.rs` it holds, e.g. there. Set `two.toml` and `plant.xml`. See `Cargo.toml`.";
        assert_eq!(Outside::default().left_out(text).trim(), "Set `two.toml` and `plant.xml`.");
    }

    #[test]
    fn what_lies_in_the_project_is_a_source_and_what_does_not_is_none() {
        let here = Outside { folders: vec![PathBuf::from(env!("CARGO_MANIFEST_DIR"))], ..Outside::default() };
        let text =
            "Kept: `plants/reactor.toml`, `src` and `/dev/null`. Gone: `src/contents`. And `src/contents/*.toml`.";
        assert_eq!(here.left_out(text).trim(), "Kept: `plants/reactor.toml`, `src` and `/dev/null`.");
        assert_eq!(Outside::default().left_out(text), text);
    }

    #[test]
    fn any_white_space_ends_a_sentence() {
        assert_eq!(Outside::default().left_out("See `src/a.rs`.\u{a0}Next."), "Next.");
    }

    #[test]
    fn a_section_about_sources_goes_with_its_heading() {
        let text = "## Files\n\nSee `src/lib.rs`.\n\n## Use\n\n### First\n\nSet `x.y`.";
        assert_eq!(Outside::default().left_out(text), "## Use\n\n### First\n\nSet `x.y`.");
    }

    #[test]
    fn commands_go_with_the_block_of_code_and_what_led_to_it_ends() {
        let own = Outside { commands: vec!["cosim".to_owned()], ..Outside::default() };
        let text = "Run `pytest -m full tests/a.py -k b` first. It is `x = 1`:\n\n```\ncosim run a\n\ncosim run b\n```\n\n\
            Or by `cosim list`. End.";
        assert_eq!(own.left_out(text), "It is `x = 1`.\n\nEnd.");
        // another project has other commands
        assert!(Outside::default().left_out(text).contains("cosim run b"));
    }

    #[test]
    fn what_only_leads_to_other_files_goes() {
        let text = "[How](a.md) and [why](../b.md#c).\n\nAs [shown](a.md) it works ([measured](a.md)). All of it:\n[a](a.md), [`b`](b.md). \
            See: [here](#guide-x). The net: [FMI](https://fmi-standard.org).";
        let wanted = "As [shown](a.md) it works. See: [here](#guide-x). The net: [FMI](https://fmi-standard.org).";
        assert_eq!(Outside::default().left_out(text), wanted);
    }

    #[test]
    fn items_with_numbers_are_left_out_whole() {
        let text = "1. **One** is this. Two.\n2. See `src/a.rs`.\n3. Last.";
        assert_eq!(Outside::default().left_out(text), "1. **One** is this. Two.\n3. Last.");
    }

    #[test]
    fn items_of_a_list_stay_without_the_others_and_code_stays() {
        let text = "- one\n- two in `two.rs`\n- three\n\n```\nmake `src/a.rs`.\n\nend.\n```";
        assert_eq!(Outside::default().left_out(text), "- one\n- three\n\n```\nmake `src/a.rs`.\n\nend.\n```");
    }
}
