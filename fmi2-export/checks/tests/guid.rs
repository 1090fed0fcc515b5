//! The GUID of a binary can be read without running it, and is that of its model description.

#[path = "../../tests/common/mod.rs"]
mod common;

use common::{Fmu, example};
use object::{Object, ObjectSection, ObjectSymbol};

/// The 36 bytes at the symbol, from the file alone.
fn in_file(name: &str) -> String {
    let bytes = std::fs::read(example(name)).unwrap();
    let file = object::File::parse(&*bytes).unwrap();
    let symbol = file.dynamic_symbols().find(|symbol| symbol.name() == Ok("fmi2_export_guid")).unwrap();
    let section = file.section_by_index(symbol.section_index().unwrap()).unwrap();
    let guid = section.data_range(symbol.address(), 36).unwrap().unwrap();
    String::from_utf8(guid.to_vec()).unwrap()
}

#[test]
#[cfg(target_os = "linux")]
fn the_guid_in_the_file_is_that_of_the_description() {
    let guids = ["probe", "pass_through"].map(|name| {
        assert_eq!(in_file(name), Fmu::load(&example(name)).guid.to_str().unwrap());
        in_file(name)
    });
    assert_ne!(guids[0], guids[1]);
}
