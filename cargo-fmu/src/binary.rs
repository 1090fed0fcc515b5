//! Asks a built library for the files it describes itself with.

use std::ffi::{CStr, CString, c_char};
use std::path::Path;

use anyhow::{Context, Result, ensure};
use libloading::Library;

type ExportFile = unsafe extern "C" fn(*const c_char) -> *const c_char;

/// The files that the library carries, such as `modelDescription.xml`: path inside the FMU and text.
///
/// The binary itself is asked, so that description and code cannot disagree.
///
/// # Errors
/// When the library cannot be loaded or lists no `modelDescription.xml`.
pub fn files(library: &Path) -> Result<Vec<(String, String)>> {
    let shown = library.display();
    // SAFETY: the library was built a moment ago from the caller's own sources; its constructors may run, as its build
    // script did.
    let library = unsafe { Library::new(library) }.with_context(|| format!("cannot load `{shown}`"))?;
    // SAFETY: `fmi2-export` defines the function with this signature.
    let export_file = unsafe { library.get::<ExportFile>(b"fmi2_export_file\0") }
        .with_context(|| format!("`{shown}` does not export `fmi2_export_file`"))?;

    let list = ask(*export_file, "").with_context(|| format!("`{shown}` lists no files"))?;
    let paths: Vec<_> = list.lines().filter(|path| !path.is_empty()).map(str::to_owned).collect();
    ensure!(paths.iter().any(|path| path == "modelDescription.xml"), "`{shown}` lists no `modelDescription.xml`");
    let text = |path: String| {
        let text =
            ask(*export_file, &path).with_context(|| format!("`{shown}` lists `{path}` but does not hold it"))?;
        Ok((path, text))
    };
    paths.into_iter().map(text).collect()
}

fn ask(export_file: ExportFile, path: &str) -> Option<String> {
    let path = CString::new(path).ok()?;
    // SAFETY: `path` is a C string; the answer is NULL or a C string that lives as long as the library.
    unsafe {
        let text = export_file(path.as_ptr());
        (!text.is_null()).then(|| CStr::from_ptr(text).to_string_lossy().into_owned())
    }
}
