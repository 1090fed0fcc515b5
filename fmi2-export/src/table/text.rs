//! Rules for names and texts, as constant functions: a table is checked when it is compiled.

/// Whether XML can hold a text.
pub const fn is_text(text: &str) -> bool {
    is_printable(text, true)
}

/// Whether a text is the same after an XML reader has made it a `normalizedString`.
pub const fn is_line(text: &str) -> bool {
    is_printable(text, false)
}

/// Whether a text has no control characters, but tabs and ends of lines where they are allowed.
const fn is_printable(text: &str, line_ends: bool) -> bool {
    let mut i = 0;
    while i < text.len() {
        let byte = text.as_bytes()[i];
        if byte < b' ' && !(line_ends && matches!(byte, b'\t' | b'\n' | b'\r')) {
            return false;
        }
        i += 1;
    }
    true
}

/// Identifiers joined by dots, as the structured naming convention of FMI 2.0 wants it.
pub const fn is_structured_name(name: &str) -> bool {
    let bytes = name.as_bytes();
    let mut at_start = true;
    let mut i = 0;
    while i < bytes.len() {
        match bytes[i] {
            b'a'..=b'z' | b'A'..=b'Z' | b'_' => at_start = false,
            b'0'..=b'9' if !at_start => (),
            b'.' if !at_start => at_start = true,
            _ => return false,
        }
        i += 1;
    }
    !at_start
}

/// Whether two texts are the same.
pub const fn same(a: &str, b: &str) -> bool {
    let (a, b) = (a.as_bytes(), b.as_bytes());
    if a.len() != b.len() {
        return false;
    }
    let mut i = 0;
    while i < a.len() {
        if a[i] != b[i] {
            return false;
        }
        i += 1;
    }
    true
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_follow_the_structured_convention() {
        for name in ["x", "gains.kp", "_a1.b2"] {
            assert!(is_structured_name(name), "{name}");
        }
        for name in ["", ".", "a.", ".a", "1a", "a b", "a..b", "a-b", "\u{e9}"] {
            assert!(!is_structured_name(name), "{name}");
        }
    }
}
