//! Tables in JSON files that text parameters name, read once at initialization.

use std::path::Path;

use control_blocks::{FileParameter, ParameterError, require};
use serde::de::DeserializeOwned;

/// Largest file that is read, bytes.
const BYTES_MAX: u64 = 16 << 20;

/// The file of a text parameter, and the name of its content.
#[derive(Clone, Copy, Debug)]
pub struct Table<'a> {
    /// The file.
    pub file: FileParameter<'a>,
    /// Name of the required content, for the error message: "a tool path".
    pub content: &'static str,
}

impl Table<'_> {
    /// Reads the file; `resources` is the folder of that name in the FMU.
    ///
    /// # Errors
    /// When there is no such file, it is too large, or it is not JSON of this type: with line and column.
    pub fn read<T: DeserializeOwned>(&self, resources: Option<&Path>) -> Result<T, ParameterError> {
        let bytes = self.file.read(resources, BYTES_MAX)?;
        serde_json::from_slice(&bytes).map_err(|error| self.wrong(&error.to_string()))
    }

    /// The error that says what of the content is wrong.
    fn wrong(&self, what: &str) -> ParameterError {
        self.file.wrong(format!("{}: {what}", self.content))
    }

    /// Checks that `value` of the field `field` lies in `low` to `high`.
    ///
    /// # Errors
    /// Names field, value and limits.
    pub fn within(
        &self,
        field: impl FnOnce() -> String,
        value: f64,
        low: f64,
        high: f64,
    ) -> Result<(), ParameterError> {
        require(value >= low && value <= high, || {
            self.wrong(&format!("`{}` is `{value}`, limits `{low}` to `{high}`", field()))
        })
    }

    /// Checks that the field `field` has `count` entries.
    ///
    /// # Errors
    /// Names field, its number of entries and the right one.
    pub fn count(&self, field: impl FnOnce() -> String, found: usize, count: usize) -> Result<(), ParameterError> {
        require(found == count, || self.wrong(&format!("`{}` has `{found}` entries, must have `{count}`", field())))
    }
}

#[cfg(test)]
pub(crate) mod tests {
    use super::*;
    use std::fmt::Debug;

    /// Calls `read` with a folder of resources in which the file `name` has this text. An error is returned as its
    /// message.
    pub fn with_resource<T>(
        name: &str,
        text: &str,
        read: impl FnOnce(&Path) -> Result<T, ParameterError>,
    ) -> Result<T, String> {
        let folder = tempfile::tempdir().unwrap();
        std::fs::write(folder.path().join(name), text).unwrap();
        read(folder.path()).map_err(|error| error.to_string())
    }

    /// `read` rejects each text with a message that starts with `start`, contains its part, and has a hint.
    pub fn assert_refusals<T: Debug>(read: impl Fn(&str) -> Result<T, String>, start: &str, cases: &[(String, &str)]) {
        for (text, part) in cases {
            let message = read(text).unwrap_err();
            assert!(message.starts_with(start) && message.contains(part), "{message}");
            assert!(message.contains("hint: write {"), "{message}");
        }
    }

    fn read(text: &str) -> Result<[f64; 3], String> {
        let file = FileParameter { name: "path.file", file: "table.json", hint: "write three numbers" };
        with_resource("table.json", text, |folder| Table { file, content: "three numbers" }.read(Some(folder)))
    }

    #[test]
    fn what_is_no_such_table_says_why_and_where() {
        assert_eq!(read("[1, 2.5, -3e2]"), Ok([1.0, 2.5, -300.0]));
        let message = read("[1,\n 2, \"x\"]").unwrap_err();
        assert!(message.starts_with("parameter `path.file` is `table.json`, must be three numbers: "), "{message}");
        assert!(message.contains("invalid type: string \"x\", expected f64 at line 2 column 7"), "{message}");
        assert!(message.contains("hint: write three numbers"), "{message}");
    }

    #[test]
    fn numbers_that_json_does_not_have_are_rejected() {
        for text in
            ["[1, 2, NaN]", "[1, 2, 1e999]", "[1, 2]", "[1, 2, 3, 4]", "[1, 2, 3] 4", "", "[1, 2, null]", "\u{0}"]
        {
            let message = read(text).unwrap_err();
            assert!(message.contains("must be three numbers: ") && message.contains(" at line 1 column"), "{message}");
        }
    }
}
