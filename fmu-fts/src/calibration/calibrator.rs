//! Calibration in place: collects what was cut and what the probe says of it, fits, and keeps the record of the tool.
//!
//! While `calibration_cut` is true the tool cuts the part. Afterwards `probe_capture` stores probe samples: the first at its
//! rising edge and more while the probe moves on; `calibration_solve` fits them. All samples on one flat are averaged:
//! cut and probe the same zone of it, because the arm may drift. A lens was cut before, when the path was followed
//! last, with the correction that it had then.

use std::f64::consts::PI;

use control_blocks::{Edge, NoEstimate};
use serde::{Deserialize, Serialize};

use crate::calibration::cut::{Cut, Moment};
use crate::calibration::flats::{self, ArmEstimate, Flat, FlatAccuracy};
use crate::calibration::form::{self, FormAccuracy, FormReading};
use crate::calibration::store::Store;
use crate::calibration::toroid::{self, ProbeAccuracy, ProbePoint};
use crate::interface::{CalibrationOutput, FormOutput, Input, Mode, Parameters, Status};
use crate::lists::harmonics::HIGHEST;
use crate::path::correction::Correction;
use crate::path::path_table::PathTable;
use crate::path::section::contact;
use crate::reading::bounds::ANGLE_MAX;
use crate::tracking::phasors::Phasors;

/// Samples that can be stored.
const SAMPLES_MAX: usize = 512;
/// Largest travel of the slide at rest while a toroid is cut, m.
const TRAVEL_MAX: f64 = 1e-5;
/// Largest motion of the arm at rest while a flat is cut, rad.
const DEFLECTION_MAX: f64 = 1e-3;
/// No probe reads more, m.
const READING_MAX: f64 = 1e3;

/// Calibration record of the selected tool; a standard deviation is 0 as long as nothing was fitted.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Record {
    /// Arm length and arm zero.
    pub arm: ArmEstimate,
    /// Cross-slide offset x_0, m.
    pub center_offset: f64,
    /// Its standard deviation, m.
    pub center_offset_std: f64,
}

/// The calibration between two samples.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct Calibrator {
    record: Record,
    mode: Mode,
    cut: Cut,
    flats: Store<Flat>,
    /// Samples averaged for the newest flat.
    readings: u32,
    points: Store<ProbePoint>,
    lens: Store<FormReading>,
    correction: Option<Correction>,
    /// correction of the path when a lens was cut last
    cut_with: Option<Correction>,
    /// a lens was fitted in this sample
    lens_fitted: bool,
    form: FormOutput,
    /// Lateral position of the last stored sample, m.
    stored_at: f64,
    cutting: Edge,
    capture: Edge,
    solve: Edge,
    status: Status,
    residual: f64,
}

impl Calibrator {
    /// Nothing collected; the record is that of the parameters.
    pub fn new(p: &Parameters) -> Self {
        let (tool, i) = (&p.tool, p.tool.index());
        let arm = ArmEstimate {
            length: tool.arm_length[i],
            zero: tool.arm_zero[i],
            length_std: tool.arm_length_std[i],
            zero_std: 0.0,
        };
        Self {
            record: Record { arm, center_offset: tool.center_offset[i], center_offset_std: 0.0 },
            mode: Mode::Idle,
            cut: Cut::default(),
            flats: Store::new(SAMPLES_MAX, Flat { arm_angle: 0.0, depth: 0.0 }),
            readings: 0,
            points: Store::new(SAMPLES_MAX, ProbePoint { lateral: 0.0, depth: 0.0 }),
            lens: Store::new(SAMPLES_MAX, FormReading::default()),
            correction: None,
            cut_with: None,
            lens_fitted: false,
            form: FormOutput::START,
            stored_at: 0.0,
            cutting: Edge::default(),
            capture: Edge::default(),
            solve: Edge::default(),
            status: Status::None,
            residual: 0.0,
        }
    }

    /// One sample in a calibration state; `now`: motion of arm and slide, `path`: the path followed last. A change of
    /// the mode restarts.
    pub fn step(&mut self, p: &Parameters, input: &Input, now: Moment, path: &PathTable) {
        if std::mem::replace(&mut self.mode, input.mode) != input.mode {
            self.begin();
        }
        if self.cutting.rises(input.calibration_cut) {
            (self.cut, self.readings) = (Cut::default(), 0);
        }
        if input.calibration_cut {
            self.cut.add(now);
        }
        let rising = self.capture.rises(input.probe_capture);
        // an invalid sample has no travel
        let moved = (input.probe_lateral - self.stored_at).abs() >= p.probe.pitch;
        if rising || (input.probe_capture && moved) {
            self.store(p, input, path);
        }
        let solve = self.solve.rises(input.calibration_solve);
        self.lens_fitted = solve && self.mode == Mode::CalibrateForm;
        if solve {
            self.status = self.fit(p);
        }
    }

    /// Outside of the calibration: the next step restarts.
    pub fn rest(&mut self) {
        self.mode = Mode::Idle;
        self.lens_fitted = false;
    }

    /// A lens is cut from now on, and what is probed later is this one: a path that is joined and left again cuts none.
    pub fn cut_lens(&mut self, path: &PathTable) {
        self.cut_with = path.correction().copied();
    }

    /// How it goes.
    pub fn status(&self) -> Status {
        self.status
    }

    /// Whether a lens was fitted in this sample, well or not.
    pub fn lens_fitted(&self) -> bool {
        self.lens_fitted
    }

    /// Correction for the next path, from the last lens with an accepted fit; none before the first.
    pub fn correction(&self) -> Option<Correction> {
        self.correction
    }

    /// The form of the last lens as outputs; whether the path is corrected, only it knows.
    pub fn form(&self) -> FormOutput {
        self.form
    }

    /// The record as outputs.
    pub fn report(&self) -> CalibrationOutput {
        let Record { arm, center_offset, center_offset_std } = self.record;
        CalibrationOutput {
            status: self.status,
            arm_length: arm.length,
            center_offset,
            arm_zero: arm.zero,
            arm_length_std: arm.length_std,
            center_offset_std,
            arm_zero_std: arm.zero_std,
            residual: self.residual,
            samples: (self.flats.samples().len() + self.points.samples().len() + self.lens.samples().len()) as i32,
        }
    }

    fn begin(&mut self) {
        self.flats.clear();
        self.points.clear();
        self.lens.clear();
        (self.cut, self.readings) = (Cut::default(), 0);
        (self.status, self.residual) = (Status::None, 0.0);
    }

    fn store(&mut self, p: &Parameters, input: &Input, path: &PathTable) {
        let (lateral, depth) = (input.probe_lateral, input.probe_depth);
        let rejected = match input.mode {
            _ if ![lateral, depth].into_iter().all(|reading| is_plausible(reading, READING_MAX)) => {
                Some(Status::InvalidProbe)
            }
            Mode::CalibrateForm => self.keep_lens(p, input, path),
            mode => self.keep(p, mode, ProbePoint { lateral, depth }),
        };
        match rejected {
            Some(status) => self.status = status,
            None => self.stored_at = lateral,
        }
    }

    /// Stores a sample of a part that was cut for it, or reports why not.
    fn keep(&mut self, p: &Parameters, mode: Mode, point: ProbePoint) -> Option<Status> {
        let flat = mode == Mode::CalibrateFlats;
        let Some(cut) = self.cut.mean() else { return Some(Status::NoCut) };
        let still = if flat { self.cut.deflection() <= DEFLECTION_MAX } else { self.cut.travel() <= TRAVEL_MAX };
        if !still {
            return Some(Status::Moved);
        }
        let kept = if flat {
            let arm_angle = cut.arm_angle - wind_up(p, cut.torque);
            self.keep_flat(Flat { arm_angle, depth: point.depth })
        } else {
            self.points.push(point)
        };
        (!kept).then_some(Status::Full)
    }

    /// Stores a sample of a lens, or reports why not.
    fn keep_lens(&mut self, p: &Parameters, input: &Input, path: &PathTable) -> Option<Status> {
        let &Input { probe_lateral: lateral, probe_depth: depth, probe_angle: angle, .. } = input;
        if !is_plausible(angle, ANGLE_MAX) {
            return Some(Status::InvalidProbe);
        }
        // beyond the axis is the surface that was cut half a revolution later
        let (side, angle) = if lateral < 0.0 { (-1.0, angle + PI) } else { (1.0, angle) };
        let radii = [p.tool.nose_radius[p.tool.index()], p.probe.radius];
        let found = contact(path, radii, lateral.abs(), Phasors::new(angle, HIGHEST).from_zero());
        let Some(nominal) = found else { return Some(Status::OutsidePath) };
        let reading = FormReading {
            slide_position: nominal.slide_position,
            angle,
            excess: depth - nominal.depth,
            gain: nominal.gain,
            slope: side * nominal.slope,
        };
        (!self.lens.push(reading)).then_some(Status::Full)
    }

    /// A new flat, or one more reading on the newest.
    fn keep_flat(&mut self, flat: Flat) -> bool {
        match self.flats.last_mut() {
            Some(mean) if self.readings > 0 => {
                self.readings = self.readings.saturating_add(1);
                mean.depth += (flat.depth - mean.depth) / f64::from(self.readings);
                true
            }
            _ => {
                self.readings = 1;
                self.flats.push(flat)
            }
        }
    }

    fn fit(&mut self, p: &Parameters) -> Status {
        let fitted = match self.mode {
            Mode::CalibrateFlats => self.fit_flats(p).map(|()| Status::Solved),
            Mode::CalibrateForm => self.fit_form(p),
            _ => self.fit_toroid(p).map(|()| Status::Solved),
        };
        fitted.unwrap_or_else(Status::from)
    }

    /// A result that is no form error, or is uncertain, corrects nothing.
    fn fit_form(&mut self, p: &Parameters) -> Result<Status, NoEstimate> {
        let accuracy = FormAccuracy { depth: p.probe.depth_std, lateral: p.probe.lateral_std, axis: p.probe.cusp_std };
        let found = form::fit(self.lens.samples(), self.cut_with.as_ref(), &accuracy)?;
        self.form = FormOutput { error: found.error, largest: found.largest, std: found.std, ..self.form };
        self.residual = found.residual;
        Ok(match () {
            () if found.std > p.form.std_max => Status::Uncertain,
            () if found.largest > p.form.depth_max => Status::TooLarge,
            () => {
                self.correction = Some(found.correction);
                Status::Solved
            }
        })
    }

    fn fit_flats(&mut self, p: &Parameters) -> Result<(), NoEstimate> {
        let accuracy = FlatAccuracy { depth: p.probe.depth_std, arm_angle: p.calibration.arm_angle_std };
        let (arm, residual) = flats::fit(self.flats.samples(), &self.record.arm, &accuracy)?;
        (self.record.arm, self.residual) = (arm, residual);
        Ok(())
    }

    fn fit_toroid(&mut self, p: &Parameters) -> Result<(), NoEstimate> {
        let accuracy = ProbeAccuracy { depth: p.probe.depth_std, lateral: p.probe.lateral_std, cusp: p.probe.cusp_std };
        let arc = toroid::fit(self.points.samples(), &accuracy)?;
        let cut = self.cut.mean().ok_or(NoEstimate::TooFew)?;
        let (tool, i) = (&p.tool, p.tool.index());
        let arm = &mut self.record.arm;
        arm.length = arc.radius - tool.nose_radius[i] + p.probe.radius;
        let radii = tool.nose_radius_std[i].hypot(p.probe.radius_std);
        arm.length_std = arc.radius_std.hypot(radii);
        self.record.center_offset = arc.distance + cut.slide_position;
        self.record.center_offset_std = arc.distance_std.hypot(p.probe.lateral_std);
        self.residual = arc.residual;
        Ok(())
    }
}

impl From<NoEstimate> for Status {
    fn from(failure: NoEstimate) -> Self {
        match failure {
            NoEstimate::TooFew => Self::TooFewSamples,
            NoEstimate::NotObservable => Self::NotObservable,
            NoEstimate::NotConverged => Self::NotConverged,
        }
    }
}

/// Whether a sample of the probe or of the spindle (m, rad) is valid.
fn is_plausible(reading: f64, maximum: f64) -> bool {
    reading.abs() <= maximum
}

/// Angle (rad) by which the tool lags the encoder when the arm carries a torque (N.m): the thrust of the cut.
fn wind_up(p: &Parameters, torque: f64) -> f64 {
    let stiffness = p.tip.inertia * p.servo.inertia * p.tip.frequency * p.tip.frequency;
    if stiffness > 0.0 { torque / stiffness } else { 0.0 }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::path::depth_table::DepthTable;
    use crate::path::kinematics::Arm;

    #[test]
    fn all_readings_on_a_flat_are_averaged() {
        let p = Parameters::START;
        let path = PathTable::new(Arm::new(&p), &DepthTable::of_surface(&p).unwrap(), 24);
        let (mut calibrator, mut input) = (Calibrator::new(&p), Input::START);
        input.mode = Mode::CalibrateFlats;
        let flats = [(0.1, [1.0e-3, 1.1e-3, 1.5e-3]), (0.2, [-2.0e-3, -2.3e-3, -2.6e-3])];
        for (arm_angle, depths) in flats {
            let now = Moment { arm_angle, torque: 0.0, slide_position: 0.0 };
            for cut in [true, false] {
                input.calibration_cut = cut;
                calibrator.step(&p, &input, now, &path);
            }
            for (depth, capture) in depths.into_iter().flat_map(|depth| [(depth, true), (depth, false)]) {
                (input.probe_depth, input.probe_capture) = (depth, capture);
                calibrator.step(&p, &input, now, &path);
            }
        }
        let kept = calibrator.flats.samples();
        assert_eq!(kept.len(), flats.len());
        for (flat, (arm_angle, depths)) in kept.iter().zip(flats) {
            let mean = depths.iter().sum::<f64>() / 3.0;
            assert!((flat.arm_angle - arm_angle).abs() < 1e-15 && (flat.depth - mean).abs() < 1e-15, "{flat:?} {mean}");
        }
    }
}
