//! Forward kinematics against the crate `k`, inverse kinematics against forward kinematics.

mod arms;

use arms::{Random, apart, posture};
use clearway_geometry::{Pose, Vec3};
use clearway_robot::{InverseKinematics, Kinematics, Robot};
use rand::{RngExt, SeedableRng};
use std::f64::consts::{PI, TAU};
use std::path::Path;

fn ur10() -> Robot {
    Robot::load("ur10_ag95", Path::new("."), &[]).expect("the built-in robot")
}

#[test]
fn forward_kinematics_are_those_of_k() {
    let robot = ur10();
    let ours = Kinematics::new(&robot);
    let file = tempfile::Builder::new().suffix(".urdf").tempfile().expect("a temporary file");
    std::fs::write(file.path(), &robot.urdf_text).expect("written");
    let theirs = k::Chain::<f64>::from_urdf_file(file.path()).expect("a URDF");
    let lead = &robot.joints[robot.hand.joint.expect("a parallel hand")];
    let mut random = Random::seed_from_u64(1);
    let (mut frames, mut worst) = (Vec::new(), (0.0_f64, ""));
    for _ in 0..10_000 {
        let q = posture(&robot, &mut random);
        let opening = random.random_range(lead.lower..lead.upper);
        ours.frames(&q, opening, &mut frames);
        let set =
            |name: &str, value| theirs.find(name).expect("a joint").set_joint_position(value).expect("within limits");
        for (name, &value) in robot.arm_names().iter().zip(&q) {
            set(name, value);
        }
        set(&lead.name, opening);
        theirs.update_transforms();
        for (link, frame) in robot.links.iter().zip(&frames) {
            let pose = theirs.find_link(&link.name).and_then(|n| n.world_transform()).expect("a pose");
            let (p, r) = (pose.translation.vector, pose.rotation.quaternion());
            let pose = Pose::from_quaternion([r.i, r.j, r.k, r.w], Vec3::new(p.x, p.y, p.z));
            let off = apart(frame, &pose);
            if off > worst.0 {
                worst = (off, &link.name);
            }
        }
    }
    println!("worst of 10000 postures: {:.1e} at {}", worst.0, worst.1);
    assert!(worst.0 <= 1e-9, "{worst:?}");
}

/// How near an arm built like a UR is to a singularity: wrist, elbow (sines), or the wrist's centre
/// over the shoulder's axis (metres).
fn from_singular(kinematics: &Kinematics, q: &[f64]) -> f64 {
    let (mut frames, mut axes) = (Vec::new(), Vec::new());
    kinematics.frames(q, 0.0, &mut frames);
    kinematics.axes(&frames, &mut axes);
    let across = axes[0].direction.cross(axes[1].direction);
    let over = (axes[5].origin - axes[0].origin).dot(across).abs();
    q[4].sin().abs().min(q[2].sin().abs()).min(over)
}

/// Every posture comes back among the answers, and every answer brings the tool back.
fn closed_form(name: &str, robot: &Robot) {
    let kinematics = Kinematics::new(robot);
    let inverse = InverseKinematics::new(robot, &kinematics);
    assert!(inverse.complete(), "{name}: {}", inverse.describe());
    let mut random = Random::seed_from_u64(2);
    let (mut tried, mut branches, mut worst, mut lost) = (0, 0, 0.0_f64, Vec::new());
    while tried < 2_000 {
        let q = posture(robot, &mut random);
        if from_singular(&kinematics, &q) < 1e-3 {
            continue;
        }
        tried += 1;
        let wanted = kinematics.tool(&q, 0.0);
        let near = posture(robot, &mut random);
        let found = inverse.solve(&wanted, &near);
        branches += found.len();
        for answer in &found {
            worst = worst.max(apart(&kinematics.tool(answer, 0.0), &wanted));
            for (j, v) in answer.iter().enumerate() {
                assert!((robot.lower[j]..=robot.upper[j]).contains(v), "{name}: joint {j} at {v}");
            }
        }
        let same = |a: &f64, b: &f64| ((a - b + PI).rem_euclid(TAU) - PI).abs() < 1e-5;
        if !found.iter().any(|answer| answer.iter().zip(&q).all(|(a, b)| same(a, b))) {
            lost.push(q);
        }
    }
    println!(
        "{name}: {tried} poses, {:.2} branches each, worst {worst:.1e}, {} lost",
        branches as f64 / f64::from(tried),
        lost.len()
    );
    assert!(lost.is_empty(), "{name}: {} of {tried} lost, the first {:?}", lost.len(), lost[0]);
    assert!(worst <= 1e-9, "{name}: {worst:e}");
}

#[test]
fn closed_form_of_the_ur10() {
    closed_form("ur10_ag95", &ur10());
}

#[test]
fn closed_form_whatever_the_signs_of_the_axes() {
    let straight = ([0.0; 3], [0.0; 3]);
    closed_form("ur5", &arms::ur5([1.0; 6], straight));
    closed_form("ur5, all axes turned round", &arms::ur5([-1.0; 6], straight));
    closed_form("ur5, elbow turned round", &arms::ur5([1.0, 1.0, -1.0, 1.0, 1.0, 1.0], straight));
    closed_form("ur5, some axes turned round", &arms::ur5([-1.0, 1.0, 1.0, -1.0, -1.0, 1.0], straight));
}

#[test]
fn closed_form_on_a_tilted_base() {
    closed_form("ur5 on a slope", &arms::ur5([1.0; 6], ([0.3, -0.2, 0.7], [0.4, -0.9, 2.1])));
    closed_form(
        "ur5 from the ceiling",
        &arms::ur5([1.0, -1.0, 1.0, 1.0, 1.0, -1.0], ([0.0, 0.0, 2.0], [PI, 0.0, 0.0])),
    );
}

/// Chains that no closed form fits: poses of random postures are answered, soundly.
#[test]
fn numeric_answers_bring_the_tool_back() {
    let mut shifted = arms::panda_joints();
    shifted[5].xyz[0] = 0.01;
    let shifted = arms::chain(([0.0; 3], [0.0; 3]), &shifted, arms::PANDA_TOOL);
    for (name, robot) in [("a panda with another wrist", shifted), ("fetch", arms::fetch()), ("jaco", arms::jaco())] {
        let kinematics = Kinematics::new(&robot);
        let inverse = InverseKinematics::new(&robot, &kinematics);
        assert!(!inverse.complete() && inverse.describe().contains("numeric"));
        let mut random = Random::seed_from_u64(3);
        let (mut answered, mut answers, mut worst) = (0, 0, 0.0_f64);
        const POSES: usize = 300;
        for _ in 0..POSES {
            let wanted = kinematics.tool(&posture(&robot, &mut random), 0.0);
            let found = inverse.solve(&wanted, &robot.home);
            answered += usize::from(!found.is_empty());
            answers += found.len();
            for answer in &found {
                worst = worst.max(apart(&kinematics.tool(answer, 0.0), &wanted));
                assert!(arms::inside(&robot, answer), "{name}: {answer:?}");
            }
        }
        println!(
            "{name}: {answered} of {POSES} poses answered, {:.1} postures each, worst {worst:.1e}",
            answers as f64 / answered as f64
        );
        assert!(worst <= 2e-9, "{name}: {worst:e}");
        assert!(answered * 100 >= POSES * 99, "{name}: only {answered} of {POSES} poses answered");
    }
}
