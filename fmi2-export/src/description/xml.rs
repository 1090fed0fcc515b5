//! A writer for small XML documents: indented elements with escaped attributes.

use std::fmt::Write;

/// Text under construction.
pub struct Writer {
    text: String,
    open: Vec<&'static str>,
}

impl Writer {
    pub fn new(head: &str) -> Self {
        Self { text: format!("{head}\n"), open: Vec::new() }
    }

    /// Opens an element that gets children.
    pub fn open(&mut self, name: &'static str, attributes: &[(&str, &str)]) {
        self.tag(name, attributes, ">");
        self.open.push(name);
    }

    /// Closes the innermost open element.
    pub fn close(&mut self) {
        if let Some(name) = self.open.pop() {
            self.line(&format!("</{name}>"));
        }
    }

    /// An element without content.
    pub fn empty(&mut self, name: &'static str, attributes: &[(&str, &str)]) {
        self.tag(name, attributes, "/>");
    }

    /// The whole text; every element has been closed.
    pub fn finish(mut self) -> String {
        while !self.open.is_empty() {
            self.close();
        }
        self.text
    }

    fn tag(&mut self, name: &str, attributes: &[(&str, &str)], end: &str) {
        let mut tag = format!("<{name}");
        for (key, value) in attributes {
            write!(tag, " {key}=\"{}\"", escape(value)).expect("writing to a String");
        }
        self.line(&(tag + end));
    }

    fn line(&mut self, line: &str) {
        writeln!(self.text, "{:indent$}{line}", "", indent = 2 * self.open.len()).expect("writing to a String");
    }
}

/// A text, escaped for the content of an element and for an attribute.
#[inline(never)]
pub fn escape(text: &str) -> String {
    let mut out = String::with_capacity(text.len());
    for c in text.chars() {
        match c {
            '&' => out.push_str("&amp;"),
            '<' => out.push_str("&lt;"),
            '>' => out.push_str("&gt;"),
            '"' => out.push_str("&quot;"),
            // raw ones in an attribute are blanks to a reader
            '\n' => out.push_str("&#10;"),
            '\r' => out.push_str("&#13;"),
            '\t' => out.push_str("&#9;"),
            c => out.push(c),
        }
    }
    out
}

/// A Real as XML Schema writes it: the shortest text that reads back to the same number.
pub fn real(value: f64) -> String {
    format!("{value:?}")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn nested_elements_are_indented_closed_and_escaped() {
        let mut xml = Writer::new("<?xml?>");
        xml.open("a", &[("k", "1 < 2 & \"x\"")]);
        xml.empty("b", &[]);
        assert_eq!(xml.finish(), "<?xml?>\n<a k=\"1 &lt; 2 &amp; &quot;x&quot;\">\n  <b/>\n</a>\n");
    }

    #[test]
    fn line_ends_and_tabs_survive_a_reader() {
        assert_eq!(escape("a\tb\r\nc"), "a&#9;b&#13;&#10;c");
    }

    #[test]
    fn reals_read_back() {
        for value in [1e-9, 0.1, 1e300, -2.5e-7, 100.0] {
            assert_eq!(real(value).parse::<f64>(), Ok(value));
        }
    }
}
