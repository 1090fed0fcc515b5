//! The README holds the tables of the interface.

#[test]
fn the_readme_holds_the_variables() {
    fmi2_export::assert_readme::<fmu_deburr::controller::Controller>(concat!(env!("CARGO_MANIFEST_DIR"), "/README.md"));
}
