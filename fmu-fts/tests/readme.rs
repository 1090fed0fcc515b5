//! The README holds the tables of the interface.

#[test]
fn the_readme_holds_the_tables_of_the_interface() {
    fmi2_export::assert_readme::<fmu_fts::controller::Controller>(concat!(env!("CARGO_MANIFEST_DIR"), "/README.md"));
}
