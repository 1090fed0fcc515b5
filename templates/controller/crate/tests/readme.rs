//! The README holds the tables of the interface.

use fmu___name__::__Name__;

#[test]
fn the_tables_are_those_of_the_interface() {
    fmi2_export::assert_readme::<__Name__>(concat!(env!("CARGO_MANIFEST_DIR"), "/README.md"));
}
