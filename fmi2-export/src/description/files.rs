//! The generated files of an FMU, made only for packers: importers never ask for them.

use crate::description::{documentation, model_description};
use crate::exported::Exported;
use crate::host::text::c_string;
use crate::table::variable::HAS_FILES;
use std::ffi::{CStr, CString};
use std::sync::OnceLock;

/// The generated files by their paths, and the list of the paths.
pub struct Files(OnceLock<(Vec<(&'static str, CString)>, CString)>);

impl Default for Files {
    fn default() -> Self {
        Self::new()
    }
}

impl Files {
    /// Nothing is made yet.
    pub const fn new() -> Self {
        Self(OnceLock::new())
    }

    /// Text of a file; `""` lists the paths, one per line. None in a library without files.
    pub(crate) fn get<M: Exported>(&self, path: &str) -> Option<&CStr> {
        if !HAS_FILES {
            return None;
        }
        let (texts, list) = self.0.get_or_init(|| {
            let texts = vec![
                ("modelDescription.xml", c_string(model_description::write::<M>())),
                ("documentation/index.html", c_string(documentation::write::<M>())),
            ];
            let list = c_string(texts.iter().map(|(path, _)| *path).collect::<Vec<_>>().join("\n"));
            (texts, list)
        });
        if path.is_empty() {
            return Some(list);
        }
        texts.iter().find(|(name, _)| *name == path).map(|(_, text)| text.as_c_str())
    }
}
