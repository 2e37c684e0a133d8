//! Seven joints with a spherical wrist, in closed form from the tool's end: against forward kinematics,
//! and against descent from seeds.

mod arms;

use arms::{Joint, Random, apart, inside, posture};
use clearway_geometry::{Pose, Vec3};
use clearway_robot::inverse::SphericalShoulder;
use clearway_robot::{InverseKinematics, Kinematics, Robot};
use rand::{RngExt, SeedableRng};
use std::f64::consts::{PI, TAU};

fn all() -> Vec<(String, Robot)> {
    let mut random = Random::seed_from_u64(11);
    let mut all = vec![("pr2".to_owned(), arms::pr2())];
    all.extend((0..20).map(|i| (format!("like a pr2, {i}"), arms::like_pr2(&mut random))));
    all
}

/// The same but for whole turns.
fn same(a: &[f64], b: &[f64], within: f64) -> bool {
    a.iter().zip(b).all(|(a, b)| ((a - b + PI).rem_euclid(TAU) - PI).abs() < within)
}

/// Within the limits but for whole turns.
fn allowed(robot: &Robot, q: &[f64]) -> bool {
    let turned = |q: f64, low: f64| if low.is_finite() { low + (q - low + 1e-8).rem_euclid(TAU) - 1e-8 } else { q };
    q.iter().zip(&robot.lower).zip(&robot.upper).all(|((&q, &l), &u)| turned(q, l) <= u + 1e-8)
}

#[test]
fn planted_postures_come_back() {
    for (name, robot) in all() {
        let kinematics = Kinematics::new(&robot);
        let closed = SphericalShoulder::of(&robot, &kinematics).expect("a spherical wrist");
        assert!(closed.at_wrist() && closed.swept() == 0);
        let mut random = Random::seed_from_u64(4);
        let (mut branches, mut missed, mut off, mut worst) = (0, 0, 0, 0.0_f64);
        const POSES: usize = 1_000;
        for _ in 0..POSES {
            let q = posture(&robot, &mut random);
            let wanted = kinematics.tool(&q, 0.0);
            let mut found = Vec::new();
            closed.solve_at(&closed.wanted(&wanted), &closed.at(q[0]), |f| found.push(f));
            assert!(found.len() <= 8);
            branches += found.len();
            missed += usize::from(!found.iter().any(|f| same(f, &q, 1e-5)));
            for f in &found {
                assert_eq!(f[0], q[0]);
                assert!(allowed(&robot, f), "{name}: {f:?}");
                let miss = apart(&kinematics.tool(f, 0.0), &wanted);
                off += usize::from(miss > 1e-9);
                worst = worst.max(miss);
            }
        }
        println!(
            "{name}: {branches} branches of {POSES} poses, {missed} missed, {off} off by more than 1e-9, worst {worst:.1e}"
        );
        assert!(missed == 0 && off * 1_000 <= branches && worst <= 1e-6, "{name}: {missed}, {off}, {worst:e}");
    }
}

#[test]
fn solutions_over_the_sweep_are_sound_and_hardly_a_pose_is_missed() {
    for (name, robot) in all() {
        let kinematics = Kinematics::new(&robot);
        let inverse = InverseKinematics::new(&robot, &kinematics);
        let numeric = InverseKinematics::numeric(&robot, &kinematics);
        assert!(inverse.describe().contains("spherical wrist") && !inverse.complete(), "{name}");
        let mut random = Random::seed_from_u64(6);
        let (mut answered, mut by_descent, mut postures, mut worst) = (0, 0, 0, 0.0_f64);
        const POSES: usize = 200;
        for _ in 0..POSES {
            let q = posture(&robot, &mut random);
            let wanted = kinematics.tool(&q, 0.0);
            // Not near the planted posture.
            let found = inverse.solve(&wanted, &robot.home);
            (answered, postures) = (answered + usize::from(!found.is_empty()), postures + found.len());
            by_descent += usize::from(!numeric.solve(&wanted, &robot.home).is_empty());
            for (i, f) in found.iter().enumerate() {
                worst = worst.max(apart(&kinematics.tool(f, 0.0), &wanted));
                assert!(inside(&robot, f), "{name}: {f:?}");
                assert!(found[..i].iter().all(|g| !same(f, g, 1e-3)), "{name}: twice {f:?}");
            }
            let found = inverse.solve(&wanted, &q);
            assert!(found.first().is_some_and(|f| same(f, &q, 1e-5)), "{name}: {q:?} is not the first of {found:?}");
            let beyond = Pose::new(wanted.rotation, wanted.translation + Vec3::new(3.0, 2.0, -2.0));
            assert!(inverse.solve(&beyond, &q).is_empty());
        }
        println!(
            "{name}: {answered} of {POSES} answered, by descent {by_descent}, {:.1} postures each, worst {worst:.1e}",
            postures as f64 / answered as f64
        );
        assert!(worst <= 1e-9, "{name}: {worst:e}");
        // The random arms' limits, some as narrow as 50°, leave windows between the values that are tried.
        let least = if name == "pr2" { by_descent } else { POSES * 9 / 10 };
        assert!(answered >= least, "{name}: {answered}, by descent {by_descent}");
    }
}

#[test]
fn lines_are_followed_within_limits() {
    let robot = arms::pr2();
    let kinematics = Kinematics::new(&robot);
    let inverse = InverseKinematics::new(&robot, &kinematics);
    let mut random = Random::seed_from_u64(7);
    let (mut followed, mut given_up) = (0, 0);
    for _ in 0..300 {
        let mut trail = vec![posture(&robot, &mut random)];
        let start = kinematics.tool(&trail[0], 0.0);
        let along = Vec3::from_array(std::array::from_fn(|_| random.random_range(-1.0..1.0))).normalize();
        for i in 1..=10 {
            let target = Pose::new(start.rotation, start.translation + along * (0.01 * f64::from(i)));
            let q = trail[trail.len() - 1].clone();
            let near = |f: &Vec<f64>| f.iter().zip(&q).all(|(a, b)| (a - b).abs() <= 0.5);
            let Some(next) = inverse.follow(&target, &trail, 0.5) else {
                given_up += usize::from(inverse.solve(&target, &q).iter().any(near));
                break;
            };
            assert!(apart(&kinematics.tool(&next, 0.0), &target) <= 2e-6);
            assert!(inside(&robot, &next) && near(&next));
            followed += 1;
            trail.push(next);
        }
    }
    println!("{followed} of 3000 steps followed, {given_up} lines ended with a posture near");
    assert!(followed > 2_200 && given_up <= 3, "{followed}, {given_up}");
}

#[test]
fn detection_goes_by_geometry() {
    let form = |robot: &Robot| SphericalShoulder::of(robot, &Kinematics::new(robot)).map(|c| c.at_wrist());
    assert_eq!(form(&arms::pr2()), Some(true));
    // Spherical at both ends: seen from the root as before.
    assert_eq!(form(&arms::iiwa()), Some(false));
    assert_eq!(form(&arms::panda()), Some(false));
    // A tenth of a millimetre, and axes no longer meet.
    for (moved, meets) in [(0, true), (1, true), (2, false), (3, true), (4, true), (5, false), (6, false)] {
        let turns = |x, axis| Joint { kind: "revolute", xyz: [x, 0.0, 0.0], rpy: [0.0; 3], axis, limits: [-1.0, 1.0] };
        let (x, y, z) = ([1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]);
        let mut joints =
            [turns(0.0, z), turns(0.1, y), turns(0.0, x), turns(0.4, y), turns(0.0, x), turns(0.321, y), turns(0.0, x)];
        joints[moved].xyz[2] += 1e-4;
        let robot = arms::chain(([0.0; 3], [0.0; 3]), &joints, ([0.18, 0.0, 0.0], [0.0; 3]));
        assert_eq!(form(&robot), meets.then_some(true), "joint {}", moved + 1);
    }
}
