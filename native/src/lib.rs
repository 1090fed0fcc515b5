//! Python module `machining_native`: native code of the plants and of the engine of the harness.
//!
//! Both exchange circuits, so both must be in one library.

#![forbid(unsafe_code)]
#![cfg(feature = "extension-module")]

/// Elements of the MuJoCo plants, circuits of them, and the stepper of closed loops.
#[pyo3::pymodule]
mod machining_native {
    #[pymodule_export]
    use cosim_engine::python::PyStepper;
    #[pymodule_export]
    use plants::python::cutting::{chip, deburring, edge, edge_length, flute, plunge, touch_probe, turned_part};
    #[pymodule_export]
    use plants::python::drive::{current_loop, induction_spindle, motion_board, pulse_drive, rotation, thrust};
    #[pymodule_export]
    use plants::python::friction::{bristle, foot, rolling_friction};
    #[pymodule_export]
    use plants::python::polishing::{rubbing, tangent_plane, wear};
    #[pymodule_export]
    use plants::python::signal::{
        coloured_noise, harmonics, integrator, latch, limit, lookup, low_pass, peak, product, slew, summing_junction,
    };
    #[pymodule_export]
    use plants::python::table::{outline, tip, turntable, wrench};
    #[pymodule_export]
    use plants::python::{Cell, PyCircuit, PyElement};
}
