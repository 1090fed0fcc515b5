//! The README holds the tables of the interface.

use fmu___name__::controller::Controller;

#[test]
fn the_tables_are_those_of_the_interface() {
    fmi2_export::assert_readme::<Controller>(concat!(env!("CARGO_MANIFEST_DIR"), "/README.md"));
}
