//! For any inputs all outputs are finite and within their limits.

use fmu_polish::axes::Axes;
use fmu_polish::interface::{Input, Output, Parameters, State};
use rand::{RngExt, SeedableRng};

use crate::robot::Build;
use crate::run::Loop;

/// Everything that an output holds.
fn finite(output: &Output) -> bool {
    let axes = |a: Axes| a.x.is_finite() && a.y.is_finite() && a.z.is_finite();
    let (v, e, m) = (output.velocity, output.error, output.misalignment);
    let scalars = [
        v.x,
        v.y,
        v.z,
        v.normal,
        v.tangential,
        v.position,
        v.stick_slip,
        output.force.measured,
        output.force.setpoint,
        output.force.error,
        e.tangential,
        e.lateral,
        e.normal,
        m.rx,
        m.ry,
        m.rz,
        output.progress,
        output.stiffness_estimate,
    ];
    let vectors = [output.desired, output.normal, output.tangent, m.shift];
    vectors.into_iter().all(axes) && scalars.iter().all(|x| x.is_finite())
}

/// Finite, not too fast, not too many pulses.
fn check(p: &Parameters, output: &Output) {
    assert!(finite(output), "{output:?}");
    let (v, pulses) = (output.velocity, output.pulses);
    let speed = (v.x * v.x + v.y * v.y + v.z * v.z).sqrt();
    assert!(speed <= p.velocity_max * (1.0 + 1e-12), "{speed} m/s");
    let maximum = (p.velocity_max * p.sample_period / p.pulses_size) as i32 + 1;
    assert!([pulses.x, pulses.y, pulses.z].iter().all(|count| count.abs() <= maximum));
}

#[test]
fn bad_inputs_in_a_commission_never_give_a_wild_output() {
    let mut p = Parameters::START;
    p.commission.apply = true;
    let mut run = Loop::new(&p, Build::NOMINAL, 72);
    let mut random = rand_pcg::Pcg64Mcg::seed_from_u64(73);
    let wild = [f64::NAN, f64::INFINITY, -1e308, 1e3, -1e3, 0.0, 1e-3, -2.0];
    let (mut seen, mut measured) = ([0; 10], 0);
    for k in 0..150_000 {
        let calm = (k / 30_000) % 2 == 0;
        let [rare, off] = [0.005, 0.001].map(|ratio| !calm && random.random_bool(ratio));
        let (value, which) = (wild[random.random_range(0..wild.len())], random.random_range(0..4));
        run.step_with(|input: &mut Input| {
            (input.enable, input.commission, input.reset_fault) =
                (off && which == 0, !off && k % 25_000 > 10, k % 50 == 0);
            let fields = [&mut input.position.x, &mut input.position.z, &mut input.force.x, &mut input.force.z];
            if let (true, Some(field)) = (rare, fields.into_iter().nth(which)) {
                *field = value;
            }
        });
        check(&p, &run.output);
        let m = &run.output.measured;
        assert!(m.stiffness.is_finite() && m.drive_gain.is_finite() && m.sensor_rotation.is_finite(), "{m:?}");
        seen[run.output.state as usize] += 1;
        measured += u32::from(m.valid);
    }
    assert!(seen[State::Commission as usize] > 0 && seen[State::Fault as usize] > 0 && measured > 0, "{seen:?}");
}

#[test]
fn bad_inputs_never_give_a_wild_output() {
    let p = Parameters::START;
    let mut run = Loop::new(&p, Build::NOMINAL, 70);
    let mut random = rand_pcg::Pcg64Mcg::seed_from_u64(71);
    let wild = [f64::NAN, f64::INFINITY, -1e308, 1e3, -1e3, 1e5, 0.0, 5e-324, 1e-3, -2.0];
    let mut seen = [0; 9];
    for k in 0..200_000 {
        let calm = (k / 5000) % 2 == 0;
        let pick = |random: &mut rand_pcg::Pcg64Mcg| wild[random.random_range(0..wild.len())];
        let rare = !calm && random.random_bool(0.01);
        let reset = random.random_bool(0.5);
        let off = random.random_bool(0.002);
        let value = pick(&mut random);
        let which = random.random_range(0..8);
        run.step_with(|input: &mut Input| {
            input.enable = !off;
            input.reset_fault = reset;
            if rare {
                input.estop = which == 7;
                let fields = [
                    &mut input.position.x,
                    &mut input.position.y,
                    &mut input.position.z,
                    &mut input.force.x,
                    &mut input.force.z,
                    &mut input.feed_override,
                    &mut input.force_override,
                ];
                if let Some(field) = fields.into_iter().nth(which) {
                    *field = value;
                }
            }
        });
        seen[run.output.state as usize] += 1;
        check(&p, &run.output);
    }
    assert!(seen[State::Fault as usize] > 0 && seen[State::Approach as usize] > 0, "{seen:?}");
}

/// Inputs that prevent the end of a cycle, by the sample.
type Hindrance = fn(&mut Input, u32);

#[test]
fn every_cycle_ends_within_its_time_and_rests_after_the_retract() {
    let hindrances: [Hindrance; 10] = [
        |input, _| input.feed_override = 0.0,
        |input, _| input.feed_override = 1e-3,
        |input, _| input.force_override = 0.0,
        |input, k| input.force_override = if (k / 300).is_multiple_of(2) { 0.0 } else { 2.0 },
        |input, k| input.force.z = if k.is_multiple_of(2) { f64::NAN } else { input.force.z },
        |input, k| input.position.x = if k.is_multiple_of(2) { f64::NAN } else { input.position.x },
        |input, k| input.force.z = if k.is_multiple_of(3) { 0.178 } else { 0.0 },
        |input, k| input.force.z = if k.is_multiple_of(3) { 2.178 } else { 2.0 },
        |input, k| input.enable = (k / 40).is_multiple_of(2),
        |input, _| input.enable = false,
    ];
    let mut p = Parameters::START;
    p.feed.velocity = 0.01;
    let out = p.retract.distance / p.retract.velocity;
    for (i, hinder) in hindrances.into_iter().enumerate() {
        for from in [State::Idle, State::Approach, State::Settle, State::Follow, State::Unload, State::Retract] {
            let mut run = Loop::new(&p, Build::NOMINAL, 82);
            (0..2).for_each(|_| run.step());
            let limit = run.time() + run.output.numbers.time_limit;
            assert!(run.run_to(from, limit), "{i} {from:?}");
            let (mut rest, mut counts) = (None, run.output.counts);
            // until it has rested for 50 samples, or the zero was not taken in 200
            for k in 0.. {
                run.step_with(|input| hinder(input, k));
                if run.output.state.moving() || (run.output.state == State::Idle && k < 200) {
                    assert!(run.time() <= limit + 2e-3, "{i} {from:?}: {:?}", run.output);
                    rest = None;
                } else if run.time() > *rest.get_or_insert(run.time() + out + 0.01) {
                    assert_eq!(run.output.counts, counts, "{i} {from:?}");
                    if run.time() > rest.unwrap() + 0.05 {
                        break;
                    }
                }
                counts = run.output.counts;
            }
        }
    }
}

#[test]
fn extreme_parameters_stay_finite() {
    let changes: [fn(&mut Parameters); 8] = [
        |p| p.impedance.mass = 0.01,
        |p| p.impedance.mass = 150.0,
        |p| p.force.integral_time = 0.018,
        |p| p.stick_slip.half_period = 99,
        |p| p.stick_slip.ratio = 20.0,
        |p| p.ripple_gain = 20.0,
        |p| (p.impedance.gain, p.impedance.adaptive) = (0.0, true),
        |p| p.feed.turn_rate_max = 1.0,
    ];
    for (i, change) in changes.into_iter().enumerate() {
        let mut p = Parameters::START;
        change(&mut p);
        let mut run = Loop::new(&p, Build::NOMINAL, 80);
        for _ in 0..8000 {
            run.step();
            assert!(finite(&run.output), "case {i}: {:?}", run.output);
        }
    }
}
