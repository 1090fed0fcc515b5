use super::*;
use control_blocks::Reaction;

const GOOD: Reading = Reading {
    position: Some(0.0),
    spindle_speed: 0.0,
    enabled: true,
    begin: false,
    commission: false,
    begin_commission: false,
    calibrate: false,
    begin_calibration: false,
    reset: false,
    found: false,
    invalid: 0,
    lost: 0,
    loss: Loss::Invalid,
    late: None,
    alive: true,
    whole: 0,
    spindle_lost: 0,
};
const LOST: Reading = Reading { position: None, lost: 100, ..GOOD };
const NOISE: ThresholdOutput = ThresholdOutput { sigma: 1.0, ..ThresholdOutput::START };

fn symptoms(reading: &Reading) -> Symptoms<'_> {
    Symptoms {
        reading,
        long_step: false,
        frozen_at_rest: false,
        steady_spindle: true,
        limited: 0,
        reversals: 0,
        oscillations: 0,
        diverged: 0,
        overloaded: 0,
        bent: false,
        gain_ratio: Some(1.0),
        evaluated: true,
        travelled: false,
        learned: Some(NOISE),
        learning: false,
        residual_force: Some(0.0),
        guarded: false,
        rejected: false,
        calibration_rejected: false,
        late: false,
    }
}

#[test]
fn each_limit_is_the_last_value_without_a_fault() {
    let mut p = Parameters::START;
    (p.limits.lost_samples, p.limits.saturated_time, p.limits.slope_sigma_max) = (7, 9e-4, 1.0);
    (p.limits.drive_gain_ratio, p.limits.residual_force) = (0.4, 0.3);
    type Set = fn(&mut Reading, &mut Symptoms, f64);
    let found = |set: Set, value: f64| {
        let (mut reading, mut all) = (GOOD, symptoms(&GOOD));
        set(&mut reading, &mut all, value);
        find(&p, &Symptoms { reading: &reading, ..all })
    };
    let limits: [(Set, f64, f64, Fault); 18] = [
        (|r, _, x| r.lost = x as u32, 7.0, 8.0, Fault::PositionLost),
        (|r, _, x| (r.lost, r.loss) = (x as u32, Loss::Jumps), 7.0, 8.0, Fault::PositionJump),
        (|r, _, x| (r.lost, r.loss, r.late) = (x as u32, Loss::Jumps, Some(4)), 7.0, 8.0, Fault::PositionDelayed),
        (|r, _, x| (r.lost, r.loss) = (x as u32, Loss::Frozen), 7.0, 8.0, Fault::PositionFrozen),
        (|r, _, x| r.spindle_lost = x as u32, 7.0, 8.0, Fault::SpindleJump),
        (|r, _, x| r.invalid = x as u32, 7.0, 8.0, Fault::SpindleLost),
        (|_, s, x| s.limited = x as u32, 9.0, 10.0, Fault::Saturation),
        (|_, s, x| s.reversals = x as u32, 5.0, 6.0, Fault::Oscillation),
        (|_, s, x| s.oscillations = x as u32, 5.0, 6.0, Fault::Oscillation),
        (|_, s, x| s.diverged = x as u32, 2.0, 3.0, Fault::FollowingError),
        (|_, s, x| s.overloaded = x as u32, 2.0, 3.0, Fault::Overload),
        (|_, s, x| s.gain_ratio = Some(x), 0.4, 0.39, Fault::WeakDrive),
        (|_, s, x| s.gain_ratio = Some(x), 0.4, -0.21, Fault::DriveSign),
        (|_, s, x| s.residual_force = Some(x), -0.3, -0.31, Fault::ContactRejected),
        (|_, s, x| s.guarded = x > 0.5, 0.0, 1.0, Fault::LateContact),
        (|_, s, x| s.rejected = x > 0.5, 0.0, 1.0, Fault::CommissionRejected),
        (|_, s, x| s.calibration_rejected = x > 0.5, 0.0, 1.0, Fault::CalibrationRejected),
        (|_, s, x| s.learned = Some(ThresholdOutput { sigma: x, ..NOISE }), 1.0, 1.1, Fault::LearnRejected),
    ];
    for (set, last, first, fault) in limits {
        assert_eq!((found(set, last), found(set, first)), (None, Some(fault)));
    }
}

#[test]
fn the_ratio_of_the_commanded_force_names_the_cause() {
    let p = Parameters::START;
    let named = |ratio, evaluated| {
        let all = Symptoms { gain_ratio: ratio, evaluated, diverged: 3, ..symptoms(&GOOD) };
        find(&p, &all)
    };
    assert_eq!(named(Some(1.0), false), Some(Fault::FollowingError));
    assert_eq!(named(None, false), Some(Fault::FollowingError));
    assert_eq!(named(Some(0.5), false), Some(Fault::FollowingError));
    assert_eq!(named(Some(0.3), false), Some(Fault::WeakDrive));
    assert_eq!(named(Some(-0.2), false), Some(Fault::WeakDrive));
    assert_eq!(named(Some(-0.9), false), Some(Fault::DriveSign));
    // a ratio alone is no fault until it is to be evaluated
    let ratio = |evaluated| find(&p, &Symptoms { gain_ratio: Some(0.1), evaluated, ..symptoms(&GOOD) });
    assert_eq!((ratio(false), ratio(true)), (None, Some(Fault::WeakDrive)));
    // where the drive pushes the wrong way, the position is not used either
    let jumps = Reading { position: None, lost: 9, loss: Loss::Jumps, ..GOOD };
    let jump = |ratio| find(&p, &Symptoms { gain_ratio: Some(ratio), evaluated: false, ..symptoms(&jumps) });
    assert_eq!((jump(0.1), jump(-0.3)), (Some(Fault::PositionJump), Some(Fault::DriveSign)));
    // jumps that no force explains are no force, whatever the drive seems to do
    let overload =
        |bent, ratio| find(&p, &Symptoms { bent, gain_ratio: Some(ratio), overloaded: 3, ..symptoms(&GOOD) });
    assert_eq!([false, true].map(|bent| overload(bent, 1.0)), [Some(Fault::Overload), Some(Fault::PositionJump)]);
    assert_eq!([false, true].map(|bent| overload(bent, 0.1)), [Some(Fault::WeakDrive), Some(Fault::PositionJump)]);
    // an oscillating loop has a drive that responds
    let oscillations =
        |ratio| find(&p, &Symptoms { gain_ratio: Some(ratio), evaluated: false, reversals: 9, ..symptoms(&GOOD) });
    assert_eq!((oscillations(0.3), oscillations(-0.3)), (Some(Fault::Oscillation), Some(Fault::DriveSign)));
}

#[test]
fn the_most_severe_fault_is_named() {
    let p = Parameters::START;
    let reading = Reading { loss: Loss::Frozen, spindle_lost: 100, ..LOST };
    let all = Symptoms {
        frozen_at_rest: false,
        limited: 100,
        reversals: 9,
        diverged: 9,
        overloaded: 9,
        travelled: true,
        learned: Some(ThresholdOutput::START),
        learning: true,
        residual_force: Some(9.0),
        guarded: true,
        late: true,
        ..symptoms(&reading)
    };
    assert_eq!(find(&p, &Symptoms { long_step: true, ..all }), Some(Fault::LongStep));
    assert_eq!(find(&p, &all), Some(Fault::PositionFrozen));
    assert_eq!(find(&p, &Symptoms { reading: &GOOD, ..all }), Some(Fault::Oscillation));
    let nonsense = Reading { invalid: 4, spindle_lost: 4, ..GOOD };
    assert_eq!(find(&p, &symptoms(&nonsense)), Some(Fault::SpindleLost));
    assert_eq!(find(&p, &symptoms(&Reading { invalid: 4, ..LOST })), Some(Fault::PositionLost));
    assert_eq!(
        find(&p, &Symptoms { reading: &GOOD, late: true, travelled: true, ..symptoms(&GOOD) }),
        Some(Fault::TravelLimit)
    );
}

#[test]
fn the_drive_goes_off_where_the_position_or_the_drive_cannot_be_trusted() {
    let ends = |end: Reaction| Fault::ALL.iter().filter(move |fault| fault.reaction() == end).count();
    assert_eq!([Reaction::Retract, Reaction::Stop, Reaction::DriveOff].map(ends), [7, 4, 11]);
    assert_eq!(Fault::PositionFrozen.reaction(), Reaction::DriveOff);
    assert_eq!(Fault::TravelLimit.reaction(), Reaction::Retract);
}
