//! The pages hold the tables of the interface.

#[test]
fn the_tables_are_those_of_the_interface() {
    fmi2_export::assert_pages::<fmu_centering::controller::Controller>(env!("CARGO_MANIFEST_DIR"));
}
