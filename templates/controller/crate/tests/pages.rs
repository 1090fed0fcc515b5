//! The pages hold the tables of the interface.

use fmu___name__::controller::Controller;

#[test]
fn the_pages_hold_the_tables_of_the_interface() {
    fmi2_export::assert_pages::<Controller>(env!("CARGO_MANIFEST_DIR"));
}
