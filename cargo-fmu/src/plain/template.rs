//! C code with places to fill, written `@place@`.

use crate::interface::Interface;

/// A template with the placeholders of every file filled, and these.
pub fn fill(template: &str, interface: &Interface, places: &[(&str, &str)]) -> String {
    let identifier = interface.identifier.as_str();
    let capitals = identifier.to_ascii_uppercase();
    // what is filled in last may hold places of the first kind
    let common = [("id", identifier), ("ID", capitals.as_str()), ("guid", interface.guid.as_str())];
    places
        .iter()
        .chain(&common)
        .fold(template.to_owned(), |text, (place, value)| text.replace(&format!("@{place}@"), value))
}

/// A text as the content of a C comment.
pub fn comment(text: &str) -> String {
    text.replace("*/", "* /").replace("/*", "/ *").replace('`', "")
}

/// A text as a C string.
pub fn literal(text: &str) -> String {
    let escaped = |c: char| match c {
        '"' | '\\' => format!("\\{c}"),
        // three digits, so that no digit of the text is read with them
        c if c.is_ascii_control() => format!("\\{:03o}", c as u32),
        c => c.to_string(),
    };
    format!("\"{}\"", text.chars().map(escaped).collect::<String>())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn texts_end_neither_a_comment_nor_a_string() {
        assert_eq!(comment("a */ b /* `c`"), "a * / b / * c");
        assert_eq!(literal("a\"b\\c\n1"), "\"a\\\"b\\\\c\\0121\"");
    }
}
