//! Python module `plants._native`: one constructor per element, and the circuit that steps them.

use pyo3::prelude::*;

/// Native elements of the MuJoCo plants.
#[pymodule]
mod _native {
    use pyo3::exceptions::PyValueError;
    use pyo3::prelude::*;

    use crate::elements::cutting::{Burr, Deburring, Edge, Flute, Milling, Reaction, Shapes, TurnedPart};
    use crate::elements::drive::{
        CurrentLoop, DriveGains, InductionSpindle, MotionBoard, PulseDrive, RatingPlate, Rotation, Thrust,
    };
    use crate::elements::friction::{Bristle, Foot, RollingFriction, Stribeck};
    use crate::elements::polishing::{Abrasion, Dimple, HeightMap, Mold, Pose, Rubbing, Step, Stroke, TangentPlane};
    use crate::elements::signal::{
        ColouredNoise, Harmonics, Integrator, Latch, Limit, Lookup, LowPass, Peak, Product, Slew, Sum,
    };
    use crate::elements::table::{Outline, Tip, Turntable, Wrench};

    #[pymodule_export]
    use crate::binding::cells::{Cell, PyCircuit, PyElement};
    #[pymodule_export]
    use crate::stepper::binding::PyStepper;

    /// Elasto-plastic friction of a part on a table (N, friction law, m, N/m, N.s/m, break-away share).
    ///
    /// vx, vy, yaw_rate -> fx, fy, torque, all in the frame of the table. The law is static coefficient, kinetic
    /// coefficient and Stribeck speed in m/s.
    #[pyfunction]
    fn bristle(
        load: f64,
        law: (f64, f64, f64),
        radius: f64,
        stiffness: f64,
        damping: f64,
        break_away: f64,
    ) -> PyElement {
        PyElement::new(Bristle::new(load, stribeck(law), radius, stiffness, damping, break_away))
    }

    /// Noise of standard deviation `rms` and correlation time `time` s: normal -> value.
    #[pyfunction]
    fn coloured_noise(rms: f64, time: f64) -> PyElement {
        PyElement::new(ColouredNoise::new(rms, time))
    }

    /// First-order current loop of `bandwidth` rad/s: command, noise -> current, all A.
    #[pyfunction]
    fn current_loop(bandwidth: f64) -> PyElement {
        PyElement::new(CurrentLoop::new(bandwidth))
    }

    /// End mill on a burr of bins from a distance m on: heights and thicknesses m.
    ///
    /// The mill is teeth, radius m, Pa per chip cross-section, N/m of engaged edge, largest chip m. The reaction is
    /// the shares of the tangential force against the travel and outward, and the reach of the tool m.
    /// distance, normal, across, tx, ty, tz, nx, ny, nz, spindle_speed, part -> torque, force, fx, fy, fz, feed,
    /// engagement, finish_low, finish_high, removed, left.
    ///
    /// Raises
    /// ------
    /// ValueError
    ///     Heights and thicknesses differ in number, or the pitch is not positive.
    #[pyfunction]
    fn deburring(
        bins: (f64, f64),
        heights: Vec<f64>,
        thicknesses: Vec<f64>,
        mill: (f64, f64, f64, f64, f64),
        reaction: (f64, f64, f64),
    ) -> PyResult<PyElement> {
        let (from, pitch) = bins;
        let refused = || PyValueError::new_err("a burr needs as many heights as thicknesses, and a positive pitch");
        let burr = Burr::new(from, pitch, heights, thicknesses).ok_or_else(refused)?;
        let (teeth, radius, pressure, edge_force, chip_most) = mill;
        let mill = Milling { teeth, radius, pressure, edge_force, chip_most };
        let (along, outward, reach) = reaction;
        Ok(PyElement::new(Deburring::new(burr, mill, Reaction { along, outward, reach })))
    }

    /// Edge of line, arc, line over a corner of `radius` m: x, y, z -> distance, normal, across, tx, ty, tz, nx, ny, nz.
    ///
    /// Raises
    /// ------
    /// ValueError
    ///     The lines are too short for the radius.
    #[pyfunction]
    fn edge(start: [f64; 3], corner: [f64; 3], end: [f64; 3], radius: f64) -> PyResult<PyElement> {
        Ok(PyElement::new(corner_edge(start, corner, end, radius)?))
    }

    /// Length of such an edge, m.
    ///
    /// Raises
    /// ------
    /// ValueError
    ///     The lines are too short for the radius.
    #[pyfunction]
    fn edge_length(start: [f64; 3], corner: [f64; 3], end: [f64; 3], radius: f64) -> PyResult<f64> {
        Ok(corner_edge(start, corner, end, radius)?.length())
    }

    /// Cutting edge on a tilted tool (m, m, rad): angle -> retreat behind the longest point.
    #[pyfunction]
    fn flute(shortfall: f64, tilt: f64, offset: f64) -> PyElement {
        PyElement::new(Flute::new(shortfall, tilt, offset))
    }

    /// Foot at `place` m on a part that slides, with a friction law: yaw, vx, vy, yaw_rate -> mu_1, mu_2.
    ///
    /// The law is static coefficient, kinetic coefficient and Stribeck speed in m/s.
    #[pyfunction]
    fn foot(place: (f64, f64), law: (f64, f64, f64)) -> PyElement {
        PyElement::new(Foot::new(place, stribeck(law)))
    }

    /// Harmonics 1, 2, ... as (amplitude, phase in rad): angle -> value.
    #[pyfunction]
    fn harmonics(orders: Vec<(f64, f64)>) -> PyElement {
        PyElement::new(Harmonics::new(orders))
    }

    /// Spindle with an induction motor: load -> speed, measured speed, torque of the motor, N.m and rad/s.
    ///
    /// The plate is synchronous and rated speed rad/s, rated power W, breakdown over rated torque, time constant s.
    #[pyfunction]
    fn induction_spindle(plate: (f64, f64, f64, f64, f64), friction: f64, lag: f64) -> PyElement {
        let (synchronous, rated_speed, rated_power, overload, time) = plate;
        let plate = RatingPlate { synchronous, rated_speed, rated_power, overload, time };
        PyElement::new(InductionSpindle::new(plate, friction, lag))
    }

    /// Integral that starts at `start`: value -> integral at the start of the step.
    #[pyfunction]
    fn integrator(start: f64) -> PyElement {
        PyElement::new(Integrator::new(start))
    }

    /// Memory of an event: value -> 1 from the first positive value on, 0 before.
    #[pyfunction]
    fn latch() -> PyElement {
        PyElement::new(Latch::new())
    }

    /// Range in which the plant means something: value -> nothing; the step fails outside.
    #[pyfunction]
    fn limit(quantity: String, unit: String, low: f64, high: f64, hint: String) -> PyElement {
        PyElement::new(Limit::new(quantity, unit, low, high, hint))
    }

    /// Periodic table of one turn, linear between its samples: angle -> value.
    ///
    /// Raises
    /// ------
    /// ValueError
    ///     There is no sample.
    #[pyfunction]
    fn lookup(samples: Vec<f64>) -> PyResult<PyElement> {
        Ok(PyElement::new(table(samples)?))
    }

    /// First-order filter of `bandwidth` rad/s: value -> filtered.
    #[pyfunction]
    fn low_pass(bandwidth: f64) -> PyElement {
        PyElement::new(LowPass::new(bandwidth))
    }

    /// Servo of one axis (N/m, N.s/m, N, s): position_setpoint, velocity_setpoint, position, velocity -> force.
    #[pyfunction]
    fn motion_board(stiffness: f64, damping: f64, force_limit: f64, period: f64) -> PyElement {
        PyElement::new(MotionBoard::new(stiffness, damping, force_limit, period))
    }

    /// Round part with a table of its radius over one turn, m, met by the line y = 0.
    ///
    /// cx, cy, vcx, vcy, orientation, turn_rate -> surface, normal_x, normal_y, vx, vy, phase.
    ///
    /// Raises
    /// ------
    /// ValueError
    ///     There is no sample.
    #[pyfunction]
    fn outline(radius: Vec<f64>) -> PyResult<PyElement> {
        Ok(PyElement::new(Outline::new(table(radius)?)))
    }

    /// Largest value so far: value -> maximum.
    #[pyfunction]
    fn peak() -> PyElement {
        PyElement::new(Peak::new())
    }

    /// Product of two values: a, b -> a b.
    #[pyfunction]
    fn product() -> PyElement {
        PyElement::new(Product::new())
    }

    /// Positioner with pulses of `pulse` m that arrive in `tick` s: pulses, position, velocity -> force, reference.
    ///
    /// The loops are position gain in 1/s, velocity gain in rad/s and its integral in 1/s; feedforward is share and
    /// bandwidth in rad/s; inertia in kg, the largest force in N.
    #[pyfunction]
    fn pulse_drive(
        loops: (f64, f64, f64),
        feedforward: (f64, f64),
        inertia: f64,
        force: f64,
        pulse: f64,
        tick: f64,
    ) -> PyElement {
        let (position, velocity, integral) = loops;
        let (feedforward, smoothing) = feedforward;
        let gains = DriveGains { position, velocity, integral, feedforward, smoothing, inertia, force };
        PyElement::new(PulseDrive::new(gains, pulse, tick))
    }

    /// Friction of balls that roll, `friction` N at most, that turns over `distance` m after a reversal: velocity -> force.
    #[pyfunction]
    fn rolling_friction(friction: f64, distance: f64) -> PyElement {
        PyElement::new(RollingFriction::new(friction, distance))
    }

    /// Shaft that starts at `start` rad: speed -> angle at the start of the step, angle at its end.
    #[pyfunction]
    fn rotation(start: f64) -> PyElement {
        PyElement::new(Rotation::new(start))
    }

    /// Contact that rubs: fx, fy, fz, normal_x, normal_y, normal_z, vx, vy, vz -> load, friction_x, friction_y,
    /// friction_z, speed, slid, rubbed, work.
    #[pyfunction]
    fn rubbing() -> PyElement {
        PyElement::new(Rubbing::new())
    }

    /// Set-point that starts at `start` and changes by `rate` per second at most: target -> value.
    #[pyfunction]
    fn slew(start: f64, rate: f64) -> PyElement {
        PyElement::new(Slew::new(start, rate))
    }

    /// Sum of `terms` inputs: a, b, ... -> sum.
    ///
    /// Raises
    /// ------
    /// ValueError
    ///     More terms than a sum can have.
    #[pyfunction]
    fn summing_junction(terms: usize) -> PyResult<PyElement> {
        let limit = Sum::TERMS_MAX;
        let refused = || PyValueError::new_err(format!("`terms` of a sum: `{terms}`, limit `{limit}`"));
        Ok(PyElement::new(Sum::new(terms).ok_or_else(refused)?))
    }

    /// Plane that touches a mold where it is nearest to a ball: x, y, z, lift -> place, quaternion, normal, contact
    /// point in the frame of the mold, distance.
    ///
    /// The base is curvature of cap and saddle in 1/m; dimples are x, y, depth, sigma and the step place, height, width,
    /// all m; beyond `rim` m there is no mold. It stands at `shift` m, turned by the rotation vector `tilt` rad.
    #[pyfunction]
    fn tangent_plane(
        base: (f64, f64),
        dimples: Vec<(f64, f64, f64, f64)>,
        step: (f64, f64, f64),
        rim: f64,
        shift: [f64; 3],
        tilt: [f64; 3],
    ) -> PyElement {
        let (place, height, width) = step;
        let dimples = dimples.into_iter().map(|(x, y, depth, sigma)| Dimple { x, y, depth, sigma }).collect();
        let mold = Mold::new(base, dimples, Step { place, height, width }, rim);
        PyElement::new(TangentPlane::new(mold, Pose::new(shift, tilt)))
    }

    /// Linear motor (N/A, relative ripple, ripple period m, phase rad): current, position -> force.
    #[pyfunction]
    fn thrust(force_constant: f64, ripple: f64, pitch: f64, phase: f64) -> PyElement {
        PyElement::new(Thrust::new(force_constant, ripple, pitch, phase))
    }

    /// One-sided spring with friction (N, m, N/m, N.s/m, 1) that presses on a surface along the line y = 0.
    ///
    /// tip, tip_speed, surface, normal_x, normal_y, vx, vy -> collapse, force, fx, fy.
    #[pyfunction]
    fn tip(preload: f64, ramp: f64, stiffness: f64, damping: f64, friction: f64) -> PyElement {
        PyElement::new(Tip { preload, ramp, stiffness, damping, friction })
    }

    /// Part that a tool turns and a probe reads, all m:
    /// angle, lateral, depth, cutting, normal, probing, probe -> reading.
    #[pyfunction]
    fn turned_part(tool_radius: f64, probe_radius: f64, part_radius: f64, face: f64, roughness: f64) -> PyElement {
        PyElement::new(TurnedPart::new(Shapes { tool_radius, probe_radius, part_radius, face, roughness }))
    }

    /// Part on a turning table, seen from the room.
    ///
    /// angle, rate, x, y, yaw, vx, vy, yaw_rate, error_x, error_y -> cx, cy, vcx, vcy, orientation, turn_rate,
    /// eccentricity, slip_speed.
    #[pyfunction]
    fn turntable() -> PyElement {
        PyElement::new(Turntable)
    }

    /// Height map of a surface after some strokes of a ball, row by row.
    ///
    /// The grid is place of its first row and column and their distance in m, points are lists of nominal height, true
    /// area and height. Strokes are x, y, z of the contact in m, load in N, distance in m. The abrasion is
    /// depth per pressure and distance in m2/N, modulus in Pa, radius in m, pressure per height in Pa/m.
    ///
    /// Raises
    /// ------
    /// ValueError
    ///     The lists of the map differ in length, or their length is no square.
    #[pyfunction]
    fn wear(
        grid: (f64, f64),
        points: (Vec<f64>, Vec<f64>, Vec<f64>),
        strokes: Vec<(f64, f64, f64, f64, f64)>,
        abrasion: (f64, f64, f64, f64),
    ) -> PyResult<Vec<f64>> {
        let ((start, pitch), (nominal, area, height)) = (grid, points);
        let count = height.len().isqrt();
        if count * count != height.len() || nominal.len() != height.len() || area.len() != height.len() {
            return Err(PyValueError::new_err("a height map is three lists of the same square length"));
        }
        let (preston, modulus, radius, selectivity) = abrasion;
        let abrasion = Abrasion { preston, modulus, radius, selectivity };
        let mut map = HeightMap { start, pitch, count, nominal, area, height };
        let mut patch = Vec::new();
        for (x, y, z, load, distance) in strokes {
            map.rub(&abrasion, &Stroke { centre: [x, y, z], load, distance }, &mut patch);
        }
        Ok(map.height)
    }

    /// Force on a part on a turning table: fx, fy, place, cx, cy, angle -> table, x, y, torque.
    #[pyfunction]
    fn wrench() -> PyElement {
        PyElement::new(Wrench)
    }

    fn corner_edge(start: [f64; 3], corner: [f64; 3], end: [f64; 3], radius: f64) -> PyResult<Edge> {
        let refused = || {
            let hint = "hint: start, corner and end of the edge are too near for it";
            PyValueError::new_err(format!("radius of the corner: `{radius}` m\n{hint}"))
        };
        Edge::new(start, corner, end, radius).ok_or_else(refused)
    }

    fn stribeck((at_rest, kinetic, speed): (f64, f64, f64)) -> Stribeck {
        Stribeck { at_rest, kinetic, speed }
    }

    fn table(samples: Vec<f64>) -> PyResult<Lookup> {
        Lookup::new(samples).ok_or_else(|| PyValueError::new_err("a table needs at least one sample"))
    }
}
