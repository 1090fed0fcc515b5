//! Faults of the tool that cuts, and what is tested in each lap.

use fmu_deburr::interface::{Fault, Mode, Parameters, State};
use fmu_deburr::path::{Block, Pose, ProgrammedPath, Vector};

use crate::robot::Build;
use crate::setup::{Loop, assert_rests_with, running};

/// There and back again, without end.
fn cyclic(p: &Parameters, build: &Build, mode: Mode) -> Loop {
    let pose = |y: f64| Pose { tip: Vector::new(0.75, y, -0.2), axis: Vector::new(0.0, 0.0, -1.0) };
    let blocks = [0.0, 0.1, 0.0].map(pose).windows(2).map(|ends| Block::line(&ends[0], &ends[1]).unwrap()).collect();
    let mut run = Loop::with_path(p, build, ProgrammedPath::new(blocks, 0.1, true, 0.2).unwrap());
    run.step();
    run.input.mode = mode;
    run
}

#[test]
fn every_lap_tests_the_delay_and_the_tool() {
    let mut p = Parameters::START;
    p.lookup.enable = false;
    let cut = |k: usize| if k % 50 < 25 { 1800.0 } else { 1885.0 };
    // the tool cuts up to a lap
    let cases = [(1, 0, Fault::NoCut, 1), (1, 2, Fault::NoCut, 3), (2, usize::MAX, Fault::WrongDelay, 1)];
    for (delay, laps_cut, expected, laps) in cases {
        let mut run = cyclic(&p, &Build { delay, ..Build::NOMINAL }, Mode::Deburr);
        for k in 0..4000 {
            run.input.spindle_speed = if (run.output.path.laps as usize) < laps_cut { cut(k) } else { 1885.0 };
            run.step();
            if run.output.fault != Fault::None {
                break;
            }
        }
        assert_eq!((run.output.fault, run.output.path.laps), (expected, laps), "{delay} {laps_cut}");
    }
}

#[test]
fn a_run_without_a_cut_is_reported_and_the_tool_retracted() {
    let mut run = running(Mode::Deburr);
    let height = run.robot.positions()[1];
    (0..3000).for_each(|_| run.step());
    assert_rests_with(&run, Fault::NoCut);
    assert!(run.output.drive_enable);
    assert!((run.robot.positions()[1] - height - run.parameters.transfer.clearance).abs() < 1e-4);
}

#[test]
fn a_tool_that_stalls_stops_and_leaves_the_part_but_not_in_a_dry_run() {
    for (mode, expected) in [(Mode::Deburr, vec![State::Stop, State::Retract, State::Fault]), (Mode::DryRun, vec![])] {
        let mut run = running(mode);
        let height = run.robot.positions()[1];
        run.input.spindle_speed = 1600.0;
        let mut visited = Vec::new();
        for _ in 0..250 {
            run.step();
            if run.output.state != State::Run {
                visited.push(run.output.state);
            }
        }
        visited.dedup();
        visited.retain(|state| *state != State::Done);
        assert_eq!(visited, expected);
        if mode == Mode::Deburr {
            assert_eq!((run.output.fault, run.output.drive_enable), (Fault::SpindleSlow, true));
            assert!((run.robot.positions()[1] - height - 0.02).abs() < 1e-4);
        }
    }
}

#[test]
fn bad_samples_of_the_tool_do_not_end_a_casting() {
    let mut run = running(Mode::Deburr);
    let speed = run.output.path.speed;
    for bad in [0.0, 900.0, 5000.0] {
        run.input.spindle_speed = bad;
        (0..3).for_each(|_| run.step());
        run.input.spindle_speed = 1885.0;
        (0..3).for_each(|_| run.step());
        assert_eq!((run.output.fault, run.output.path.speed), (Fault::None, speed));
    }
}

#[test]
fn a_long_distance_without_a_cut_is_reported_before_the_end_of_the_path() {
    let mut run = running(Mode::Deburr);
    run.parameters.limits.idle_travel = 0.1;
    let (mut cut, mut detected) = (0.0, None);
    for k in 0..300 {
        run.input.spindle_speed = if k < 20 { 1850.0 } else { 1885.0 };
        run.step();
        let distance = run.output.path.distance;
        cut = if k < 20 { distance } else { cut };
        detected = detected.or((run.output.fault != Fault::None).then_some(distance));
    }
    assert_rests_with(&run, Fault::NoCut);
    // a few samples of 1 mm until the tool is accepted to be idle
    let (travel, idle) = (run.output.numbers.ratio.unwrap(), detected.unwrap() - cut);
    assert!((0.1..0.102).contains(&travel) && (0.1..0.107).contains(&idle), "{travel} {idle}");
}

#[test]
fn in_a_fault_with_live_drives_the_pose_is_held() {
    let mut run = running(Mode::Deburr);
    run.parameters.limits.idle_travel = 0.1;
    (0..500).for_each(|k| {
        run.input.spindle_speed = if k < 20 { 1850.0 } else { 1885.0 };
        run.step();
    });
    assert_rests_with(&run, Fault::NoCut);
    let position = run.robot.positions();
    // drives with an offset of 2 mm/s: they stand where the loop makes up for it
    for _ in 0..300 {
        run.step();
        run.robot.advance(&[2e-3; 6]);
    }
    let moved = (0..6).map(|i| (run.robot.positions()[i] - position[i]).abs()).fold(0.0, f64::max);
    assert!(run.output.drive_enable && (1e-5..5e-4).contains(&moved), "{moved} {:?}", run.output.fault);
}

#[test]
fn a_tool_speed_that_freezes_under_load_is_reported_in_half_a_second_and_the_tool_retracted() {
    let mut p = Parameters::START;
    p.lookup.enable = false;
    for flicker in [0.5, 0.0] {
        let mut run = Loop::new(&p, &Build::NOMINAL);
        run.input.mode = Mode::Deburr;
        let mut cut = 0;
        for k in 0..1000 {
            cut += u32::from(run.output.path.distance > 0.05);
            run.input.spindle_speed = match cut {
                0 => 1885.0 + flicker * [0.0, 1.0, 2.0, 1.0][k % 4],
                _ => 1850.0,
            };
            run.step();
            if run.output.fault != Fault::None {
                break;
            }
        }
        let (fault, samples) = (run.output.fault, cut);
        // one that never flickered may stand
        assert_eq!(fault == Fault::SpindleFrozen, flicker > 0.0, "{fault:?}");
        if flicker > 0.0 {
            assert!((50..=55).contains(&samples), "{samples}");
            let height = run.robot.positions()[1];
            (0..300).for_each(|_| run.step());
            assert_rests_with(&run, Fault::SpindleFrozen);
            assert!(run.output.drive_enable);
            assert!((run.robot.positions()[1] - height - p.transfer.clearance).abs() < 1e-4);
        }
    }
}

#[test]
fn the_second_casting_is_started_with_the_programmed_feed() {
    let mut p = Parameters::START;
    (p.lookup.enable, p.limits.spindle_change) = (false, 0.0);
    let mut run = Loop::new(&p, &Build::NOMINAL);
    for casting in 0..2 {
        run.input.mode = Mode::Idle;
        (0..2).for_each(|_| run.step());
        run.input.mode = Mode::Deburr;
        let mut first = None;
        while run.output.state != State::Done {
            // the tool is overloaded at the end of the path
            run.input.spindle_speed = if run.output.path.distance > 0.2 { 1700.0 } else { 1885.0 };
            run.step();
            if run.output.state == State::Run && run.output.path.distance > 0.02 {
                first = first.or(Some(run.output.path.speed));
            }
        }
        assert!(first.unwrap() > 0.09, "casting {casting}: {first:?}");
    }
}

#[test]
fn the_time_of_a_cyclic_path_starts_again_in_every_lap() {
    let mut p = Parameters::START;
    p.lookup.enable = false;
    // a lap takes 2 s
    p.limits.cycle_time = 8.0;
    let mut run = cyclic(&p, &Build::NOMINAL, Mode::DryRun);
    for _ in 0..3000 {
        run.step();
        assert_eq!(run.output.fault, Fault::None);
    }
    assert!(run.output.path.laps > 8, "{:?}", run.output.path);
}
