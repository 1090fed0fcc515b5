//! The state `Commission`: what it finds on robots that nobody has measured, and what it keeps to.

use fmu_polish::interface::{Fault, Parameters, State};
use rand::{RngExt, SeedableRng};

use crate::robot::Build;
use crate::run::Loop;

#[test]
fn trial() {
    for seed in 700..708 {
        let mut random = rand_pcg::Pcg64Mcg::seed_from_u64(seed);
        let mut near = |x: f64| x * random.random_range(0.7..1.3);
        let mut build = Build {
            stiffness: near(178e3),
            lateral: near(209e3),
            friction: near(0.2),
            drive_friction: near(2.0),
            drive_gain: near(1.0),
            feedforward: near(0.75),
            ..Build::NOMINAL
        };
        build.late = (seed % 2) as usize;
        build.turned = near(1.0) - 1.0;
        if seed == 700 {
            build = Build::NOMINAL;
            build.drive_friction = 0.0;
        }
        if seed == 701 {
            build = Build::NOMINAL;
        }
        if seed == 702 {
            build = Build::NOMINAL;
            build.drive_friction = 0.5;
        }
        let mut p = Parameters::START;
        p.commission.apply = true;
        let mut run = Loop::new(&p, build, seed);
        run.input.enable = false;
        (0..50).for_each(|_| run.step());
        run.input.commission = true;
        run.step();
        let mut most: f64 = 0.0;
        while run.output.state == State::Commission {
            run.step();
            most = most.max(run.robot.normal_force);
        }
        let m = run.output.measured;
        println!("{:?} {:?} t={} most={most} {build:?}", run.output.state, run.output.fault, run.time());
        println!(
            "  k {:.0}+-{:.0} / {:.0}  lat {:.0}+-{:.0}/{:.0} mu {:.4}+-{:.4}/{:.4}",
            m.stiffness,
            m.stiffness_deviation,
            build.stiffness,
            m.lateral_stiffness,
            m.lateral_stiffness_deviation,
            build.lateral,
            m.friction,
            m.friction_deviation,
            build.friction
        );
        println!(
            "  g {:.3}+-{:.3}/{:.3} ff {:.3}+-{:.3}/{:.3} d {:.3}+-{:.3}/{} rot {:.4}+-{:.4}/{:.4} {} {}",
            m.drive_gain,
            m.drive_gain_deviation,
            build.drive_gain,
            m.feedforward,
            m.feedforward_deviation,
            build.feedforward,
            m.io_delay,
            m.io_delay_deviation,
            1 + build.late,
            m.sensor_rotation,
            m.sensor_rotation_deviation,
            build.turned,
            m.sensor_direction_y,
            m.sensor_direction_z
        );
        println!("  {:?}", run.parameters.stick_slip.velocity);
    }
}
