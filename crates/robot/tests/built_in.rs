//! The built-in robots load, and their numbers fit together.

use clearway_geometry::{Convex, Mat3, Pose, Vec3};
use clearway_robot::report::report;
use clearway_robot::{JointKind, Robot};
use std::path::Path;

fn ur10() -> Robot {
    Robot::load("ur10_ag95", Path::new("."), &[]).expect("the built-in robot")
}

/// Where a link is in the root's frame, with `value` for each joint that mimics none.
fn root_from(robot: &Robot, link: usize, value: &dyn Fn(usize) -> f64) -> Pose {
    let Some(j) = robot.links[link].parent_joint else { return Pose::IDENTITY };
    let joint = &robot.joints[j];
    let q = match &joint.mimic {
        Some(m) => m.multiplier * value(m.joint) + m.offset,
        None => value(j),
    };
    let moved = match joint.kind {
        JointKind::Fixed => Pose::IDENTITY,
        JointKind::Prismatic => Pose::from_translation(joint.axis * q),
        _ => Pose::new(Mat3::from_axis_angle(joint.axis, q), Vec3::ZERO),
    };
    root_from(robot, joint.parent, value) * joint.parent_from_joint * moved
}

#[test]
fn ur10_ag95_is_what_its_files_say() {
    let robot = ur10();
    assert_eq!(
        robot.arm_names(),
        ["shoulder_pan_joint", "shoulder_lift_joint", "elbow_joint", "wrist_1_joint", "wrist_2_joint", "wrist_3_joint"]
    );
    assert_eq!(robot.links[0].name, "base_link");
    assert!(robot.links.iter().skip(1).all(|l| l.parent_joint.is_some()));
    assert!(robot.joints.iter().all(|j| j.parent < j.child));
    assert_eq!(robot.hand.opening.len(), 14);
    assert_eq!(robot.hand.widest(), 0.095);
    assert_eq!(robot.disabled_pairs.len(), 17);
    assert!(robot.fixed.is_empty() && robot.meshes.is_empty());
    assert_eq!(robot.named_states["home"].len(), 6);
    let text = report(&robot);
    for needle in ["elbow_joint", "grasp_center", "0 to 95 mm", "5 × cylinder", "wrist_3_link – gripper_base_link"] {
        assert!(text.contains(needle), "{needle} is not in\n{text}");
    }
}

#[test]
fn home_holds_the_hand_level_before_the_shelf() {
    let robot = ur10();
    let home = |j: usize| robot.arm.iter().position(|&a| a == j).map_or(0.0, |i| robot.home[i]);
    let hand = root_from(&robot, robot.hand.frame, &home);
    assert!((hand.rotation.z_axis - Vec3::X).length() < 1e-4, "{hand:?}");
    assert!(hand.rotation.x_axis.z.abs() < 1e-4);
    assert!((hand.translation - Vec3::new(0.450, 0.164, 0.550)).length() < 2e-3, "{hand:?}");
}

/// The inner faces of the pads are as far apart as the opening table says, parallel, and midway
/// between them, in z too, is the tool's frame.
#[test]
fn opening_table_is_the_linkage() {
    let robot = ur10();
    let lead = robot.hand.joint.expect("a parallel hand");
    let face = |side: &str, q: f64| {
        let link = robot.link(side).expect("a finger");
        let value = |j: usize| if j == lead { q } else { 0.0 };
        let tool_from_link = root_from(&robot, robot.hand.frame, &value).inverse() * root_from(&robot, link, &value);
        let (pose, convex) = &robot.links[link].collision.parts[0];
        let Convex::Box { half } = convex else { panic!("a box") };
        let centre = (tool_from_link * *pose).translation;
        assert!(tool_from_link.angle_to(&Pose::IDENTITY) < 1e-9);
        assert!(half.y <= 0.04 && centre.x.abs() + half.x <= 0.0595 + 1e-6);
        (centre.x.abs() - half.x, centre.z - half.z..centre.z + half.z)
    };
    let mut worst = 0.0_f64;
    for i in 0..=650 {
        let q = f64::from(i) / 1000.0;
        let ((left, reach), (right, _)) = (face("left_finger", q), face("right_finger", q));
        assert!((left - right).abs() < 1e-9);
        assert!((0.015..0.02).contains(&reach.end) && reach.start < -0.025, "{reach:?}");
        worst = worst.max((left + right - robot.hand.gap_at(q)).abs());
        assert!((robot.hand.joint_at(robot.hand.gap_at(q)) - q).abs() < 1e-9);
    }
    assert!(worst < 2e-5, "{worst}");
}

/// An upright cylinder midway between the pads keeps 5 mm from the palm and the bars, whether the
/// hand has closed on it or is open.
#[test]
fn there_is_room_for_the_object() {
    let robot = ur10();
    let lead = robot.hand.joint.expect("a parallel hand");
    for millimetres in (5..=45).step_by(5) {
        let radius = f64::from(millimetres) / 1000.0;
        for q in [0.0, robot.hand.joint_at(2.0 * radius)] {
            let value = |j: usize| if j == lead { q } else { 0.0 };
            let tool = root_from(&robot, robot.hand.frame, &value);
            for name in ["gripper_base_link", "left_knuckle", "right_knuckle"] {
                let link = robot.link(name).expect("a link");
                let tool_from_link = tool.inverse() * root_from(&robot, link, &value);
                for (pose, convex) in &robot.links[link].collision.parts {
                    for p in convex_corners(convex) {
                        let p = (tool_from_link * *pose).point(p);
                        let distance = p.x.hypot(p.z) - radius;
                        assert!(distance >= 0.005, "{name}: {distance} at radius {radius}, joint {q}");
                    }
                }
            }
        }
    }
}

/// Points all over the sides of a box or cylinder.
fn convex_corners(convex: &Convex) -> Vec<Vec3> {
    let half = match convex {
        Convex::Box { half } => *half,
        Convex::Cylinder { radius, half } => Vec3::new(*radius, *radius, *half),
        other => panic!("{other:?}"),
    };
    let steps = || (-20..=20).map(|i| f64::from(i) / 20.0);
    steps().flat_map(|x| steps().flat_map(move |z| [-1.0, 1.0].map(|y| half * Vec3::new(x, y, z)))).collect()
}

fn panda() -> Robot {
    Robot::load("panda", Path::new("."), &[]).expect("the built-in robot")
}

#[test]
fn panda_is_what_its_files_say() {
    let robot = panda();
    assert_eq!(robot.arm_names(), (1..=7).map(|i| format!("panda_joint{i}")).collect::<Vec<_>>());
    assert_eq!(robot.velocity, [2.175, 2.175, 2.175, 2.175, 2.61, 2.61, 2.61]);
    assert_eq!(robot.acceleration, [15.0, 7.5, 10.0, 12.5, 15.0, 20.0, 20.0]);
    assert_eq!(robot.jerk, [7500.0, 3750.0, 5000.0, 6250.0, 7500.0, 10000.0, 10000.0]);
    assert_eq!(robot.hand.widest(), 0.08);
    assert_eq!(robot.disabled_pairs.len(), 11);
    assert!(robot.fixed.is_empty() && robot.meshes.is_empty());
    assert_eq!(robot.named_states.keys().collect::<Vec<_>>(), ["home", "ready"]);
    for (name, &home) in robot.arm_names().iter().zip(&robot.home) {
        assert_eq!(robot.named_states["home"][*name], home);
    }
    assert!(report(&robot).contains("0 to 80 mm"));
}

#[test]
fn panda_rests_with_the_hand_level() {
    let robot = panda();
    let home = |j: usize| robot.arm.iter().position(|&a| a == j).map_or(0.0, |i| robot.home[i]);
    let hand = root_from(&robot, robot.hand.frame, &home);
    assert!((hand.rotation.z_axis - Vec3::X).length() < 1e-5 && hand.rotation.x_axis.z.abs() < 1e-5, "{hand:?}");
    assert!((hand.translation - Vec3::new(0.429, 0.0, 0.785)).length() < 1e-3, "{hand:?}");
}

/// Both pads are half the gap away from the tool's frame, whatever the opening, and reach beyond it.
#[test]
fn panda_opens_as_its_table_says() {
    let robot = panda();
    let lead = robot.hand.joint.expect("a parallel hand");
    for i in 0..=40 {
        let q = f64::from(i) / 1000.0;
        let value = |j: usize| if j == lead { q } else { 0.0 };
        for (finger, side) in [("panda_leftfinger", 1.0), ("panda_rightfinger", -1.0)] {
            let link = robot.link(finger).expect("a finger");
            let tool_from_link =
                root_from(&robot, robot.hand.frame, &value).inverse() * root_from(&robot, link, &value);
            let (pose, convex) = &robot.links[link].collision.parts[2];
            let Convex::Box { half } = convex else { panic!("a box") };
            let pad = tool_from_link * *pose;
            // The pad's box has y across, which is the tool's x.
            let inner = pad.translation.x.abs() - half.y;
            assert!((2.0 * inner - robot.hand.gap_at(q)).abs() < 1e-9, "{finger} at {q}: {inner}");
            assert!(pad.translation.x * side >= 0.0 && pad.translation.z.abs() < half.z, "{finger}: {pad:?}");
        }
    }
}

fn pr2() -> Robot {
    Robot::load("pr2_left", Path::new("."), &[]).expect("the built-in robot")
}

#[test]
fn pr2_left_is_what_its_files_say() {
    let robot = pr2();
    let names = robot.arm_names();
    assert_eq!(names.len(), 10);
    assert_eq!(names[..4], ["base_x", "base_y", "base_yaw", "l_shoulder_pan_joint"]);
    assert_eq!(names[9], "l_wrist_roll_joint");
    assert!(robot.planar_base.is_some() && robot.meshes.is_empty());
    assert_eq!(robot.velocity, [0.5, 0.5, 0.8, 2.088, 2.082, 3.27, 3.3, 3.6, 3.078, 3.6]);
    assert_eq!(robot.acceleration, [0.5, 0.5, 1.0, 1.0, 1.0, 2.0, 2.0, 2.0, 2.0, 2.0]);
    assert_eq!(robot.fixed.len(), 12);
    assert_eq!(robot.fixed["torso_lift_joint"], 0.3);
    for (name, &home) in names.iter().zip(&robot.home).skip(3) {
        assert_eq!(robot.named_states["home"][*name], home);
    }
    assert!(report(&robot).contains("0 to 92.054 mm"));
}

/// The pads are half the gap away from the tool's frame on either side, and reach beyond it.
#[test]
fn pr2_left_opens_as_its_table_says() {
    let robot = pr2();
    let lead = robot.hand.joint.expect("a parallel hand");
    let at_rest = |j: usize| robot.fixed.get(&robot.joints[j].name).copied().unwrap_or(0.0);
    for i in 0..=50 {
        let gap = robot.hand.widest() * f64::from(i) / 50.0;
        let q = robot.hand.joint_at(gap);
        let value = |j: usize| if j == lead { q } else { at_rest(j) };
        let tool = root_from(&robot, robot.hand.frame, &value);
        for (side, sign) in [("l", 1.0), ("r", -1.0)] {
            let link = robot.link(&format!("l_gripper_{side}_finger_tip_link")).expect("a finger");
            let tool_from_link = tool.inverse() * root_from(&robot, link, &value);
            for (pose, convex) in robot.links[link].collision.parts.iter().skip(2) {
                let Convex::Box { half } = convex else { panic!("a box") };
                let pad = tool_from_link * *pose;
                // The pad's box has y across, which is the tool's x.
                let inner = pad.translation.x * sign - half.y;
                assert!((2.0 * inner - gap).abs() < 1e-4, "{side} at {gap}: {inner}");
            }
            let (pose, convex) = robot.links[link].collision.parts.last().expect("the pad's end");
            let Convex::Box { half } = convex else { panic!("a box") };
            // Its x is along the finger: the tool's z.
            let pad = tool_from_link * *pose;
            assert!(pad.translation.z + half.x > 0.008, "{side} at {gap}: {pad:?}");
        }
    }
}
