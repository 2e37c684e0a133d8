//! Inverse kinematics on random reachable poses: how many are answered, with how many postures, how
//! fast; and how far straight lines of the tool can be followed.
//!
//! `cargo bench -p clearway-robot --bench inverse [-- ROBOT…]`: built-in names or robot files.

use clearway_geometry::{Pose, Vec3};
use clearway_robot::inverse::SphericalShoulder;
use clearway_robot::{InverseKinematics, Kinematics, Robot, description::BUILT_IN};
use rand::{RngExt, SeedableRng};
use rand_xoshiro::Xoshiro256PlusPlus;
use std::f64::consts::PI;
use std::path::Path;
use std::time::{Duration, Instant};

const POSES: usize = 2000;
/// A line is this many steps of this length, metres.
const STEPS: usize = 15;
const STEP: f64 = 0.02;

fn main() {
    let mut names: Vec<String> = std::env::args().skip(1).filter(|a| !a.starts_with('-')).collect();
    if names.is_empty() {
        names = BUILT_IN.map(str::to_owned).to_vec();
    }
    println!(
        "{:>9} {:>10} {:>10} {:>12} {:>14} {:>16} {:>12}  robot",
        "answered", "postures", "µs", "slowest µs", "line steps", "µs a step", "none, µs"
    );
    for name in names {
        let robot = Robot::load(&name, Path::new("."), &[]).unwrap_or_else(|e| panic!("{e}"));
        measure(&name, &robot);
    }
}

fn measure(name: &str, robot: &Robot) {
    let kinematics = Kinematics::new(robot);
    let inverse = InverseKinematics::new(robot, &kinematics);
    let mut random = Xoshiro256PlusPlus::seed_from_u64(1);
    let (mut answered, mut postures, mut steps, mut wanted_steps) = (0, 0, 0, 0);
    let (mut solving, mut slowest, mut following, mut refusing) =
        (Duration::ZERO, Duration::ZERO, Duration::ZERO, Duration::ZERO);
    for _ in 0..POSES {
        let q: Vec<f64> = (0..robot.arm.len())
            .map(|j| random.random_range(robot.lower[j].max(-PI)..robot.upper[j].min(PI)))
            .collect();
        let wanted = kinematics.tool(&q, 0.0);
        let began = Instant::now();
        let found = inverse.solve(&wanted, &robot.home);
        let took = began.elapsed();
        (solving, slowest) = (solving + took, slowest.max(took));
        answered += usize::from(!found.is_empty());
        postures += found.len();

        let along =
            Vec3::new(random.random_range(-1.0..1.0), random.random_range(-1.0..1.0), random.random_range(-1.0..1.0))
                .normalize_or_zero();
        let mut trail = vec![q];
        let began = Instant::now();
        for i in 1..=STEPS {
            wanted_steps += 1;
            let target = Pose::new(wanted.rotation, wanted.translation + along * (STEP * i as f64));
            let Some(next) = inverse.follow(&target, &trail, 0.5) else { break };
            steps += 1;
            trail.push(next);
        }
        following += began.elapsed();

        // Too high for any, wherever its base drives.
        let beyond = Pose::new(wanted.rotation, wanted.translation + Vec3::Z * 50.0);
        let began = Instant::now();
        assert!(inverse.solve(&beyond, &robot.home).is_empty(), "{name}: an answer out of reach");
        refusing += began.elapsed();
    }
    if let Some(closed) = SphericalShoulder::of(robot, &kinematics) {
        one_value(robot, &kinematics, &closed);
    }
    let each = |t: Duration, n: usize| t.as_secs_f64() * 1e6 / n.max(1) as f64;
    println!(
        "{:>8.2}% {:>10.1} {:>10.1} {:>12.0} {:>13.1}% {:>16.2} {:>12.1}  {name}: {}",
        answered as f64 * 100.0 / POSES as f64,
        postures as f64 / answered.max(1) as f64,
        each(solving, POSES),
        slowest.as_secs_f64() * 1e6,
        steps as f64 * 100.0 / wanted_steps as f64,
        each(following, steps),
        each(refusing, POSES),
        inverse.describe(),
    );
}

/// The closed form at one value of the swept joint.
fn one_value(robot: &Robot, kinematics: &Kinematics, closed: &SphericalShoulder) {
    let mut random = Xoshiro256PlusPlus::seed_from_u64(2);
    let postures: Vec<Vec<f64>> = (0..POSES)
        .map(|_| {
            robot.lower.iter().zip(&robot.upper).map(|(&l, &u)| random.random_range(l.max(-PI)..u.min(PI))).collect()
        })
        .collect();
    let poses: Vec<Pose> = postures.iter().map(|q| kinematics.tool(q, 0.0)).collect();
    const ROUNDS: usize = 20;
    let mut branches = 0;
    let began = Instant::now();
    for _ in 0..ROUNDS {
        for (pose, q) in poses.iter().zip(&postures) {
            closed.solve_at(&closed.wanted(pose), &closed.at(q[closed.swept()]), |_| branches += 1);
        }
    }
    let each = began.elapsed().as_secs_f64() * 1e6 / (ROUNDS * POSES) as f64;
    println!("one value of the swept joint: {each:.2} µs, {:.2} branches", branches as f64 / (ROUNDS * POSES) as f64);
}
