//! The pages of the crate hold the tables of the interface.

#[test]
fn the_pages_hold_the_tables_of_the_interface() {
    fmi2_export::assert_pages::<fmu_polish::controller::Controller>(env!("CARGO_MANIFEST_DIR"));
}
