//! The pages of this crate hold what is generated from the interface.

#[test]
fn the_pages_hold_the_generated_parts() {
    fmi2_export::assert_pages::<fmu_deburr::controller::Controller>(env!("CARGO_MANIFEST_DIR"));
}
