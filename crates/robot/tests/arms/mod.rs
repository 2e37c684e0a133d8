//! Arms written out as URDFs, each with a suction cup as its hand, and loaded as a user's would be;
//! postures of them.

// Each test takes what it needs.
#![allow(dead_code)]

use clearway_geometry::{Pose, Vec3};
use clearway_robot::Robot;
use rand::RngExt;
use std::fs;

pub type Random = rand_xoshiro::Xoshiro256PlusPlus;

/// A posture within the limits; of a joint that turns without end, within half a turn either way.
pub fn posture(robot: &Robot, random: &mut Random) -> Vec<f64> {
    let end = |limit: f64| if limit.is_finite() { limit } else { std::f64::consts::PI.copysign(limit) };
    robot.lower.iter().zip(&robot.upper).map(|(&low, &high)| random.random_range(end(low)..end(high))).collect()
}

/// Metres and radians between two poses, the larger of the two.
pub fn apart(a: &Pose, b: &Pose) -> f64 {
    // For small angles: half the length of R − Rᵀ's axis is accurate where an arc cosine is not.
    let r = a.rotation.transpose() * b.rotation;
    let axis = Vec3::new(r.y_axis.z - r.z_axis.y, r.z_axis.x - r.x_axis.z, r.x_axis.y - r.y_axis.x) / 2.0;
    let trace = r.x_axis.x + r.y_axis.y + r.z_axis.z;
    let angle = axis.length().atan2((trace - 1.0) / 2.0);
    angle.max((a.translation - b.translation).length())
}

/// Whether a posture is within the limits.
pub fn inside(robot: &Robot, q: &[f64]) -> bool {
    q.iter().zip(&robot.lower).zip(&robot.upper).all(|((q, l), u)| q >= l && q <= u)
}

/// One joint of a chain: where it is in the link before (metres, radians), and its axis there.
pub struct Joint {
    /// `revolute`, `continuous` (limits are then not looked at) or `prismatic`.
    pub kind: &'static str,
    pub xyz: [f64; 3],
    pub rpy: [f64; 3],
    pub axis: [f64; 3],
    pub limits: [f64; 2],
}

/// A chain of joints. `root` is the pose of the first link in the root link, `tool` that of
/// the cup in the last link, each `xyz` and `rpy`.
pub fn chain(root: ([f64; 3], [f64; 3]), joints: &[Joint], tool: ([f64; 3], [f64; 3])) -> Robot {
    let row = |v: [f64; 3]| format!("{} {} {}", v[0], v[1], v[2]);
    let origin = |(xyz, rpy): ([f64; 3], [f64; 3])| format!("<origin xyz=\"{}\" rpy=\"{}\"/>", row(xyz), row(rpy));
    let fixed = |name: &str, parent: &str, child: &str, pose| {
        format!(
            "<joint name=\"{name}\" type=\"fixed\"><parent link=\"{parent}\"/><child link=\"{child}\"/>{}</joint>\n",
            origin(pose)
        )
    };
    let mut urdf = "<robot name=\"chain\">\n<link name=\"root\"/><link name=\"l0\"/>\n".to_owned();
    urdf += &fixed("mount", "root", "l0", root);
    for (i, j) in joints.iter().enumerate() {
        urdf += &format!(
            "<link name=\"l{}\"/><joint name=\"j{}\" type=\"{}\"><parent link=\"l{i}\"/><child link=\"l{}\"/>{}\
             <axis xyz=\"{}\"/><limit lower=\"{}\" upper=\"{}\" velocity=\"2\" effort=\"1\"/></joint>\n",
            i + 1,
            i + 1,
            j.kind,
            i + 1,
            origin((j.xyz, j.rpy)),
            row(j.axis),
            j.limits[0],
            j.limits[1],
        );
    }
    urdf += "<link name=\"cup\"><collision><geometry><sphere radius=\"0.01\"/></geometry></collision></link>\n";
    urdf += &fixed("hold", &format!("l{}", joints.len()), "cup", tool);
    urdf += "</robot>\n";
    let file = format!(
        "format: clearway-robot/1\nurdf: chain.urdf\narm: {{base: l0, tip: l{}}}\n\
         hand: {{kind: {{suction: {{radius: 0.02}}}}, frame: cup, links: [cup]}}\n",
        joints.len()
    );
    let directory = tempfile::tempdir().expect("a temporary directory");
    fs::write(directory.path().join("chain.urdf"), urdf).expect("a URDF");
    fs::write(directory.path().join("robot.yaml"), file).expect("a robot file");
    Robot::load("robot.yaml", directory.path(), &[]).unwrap_or_else(|e| panic!("{e}"))
}

/// A UR5 with its official lengths (metres). `signs` turns axes round; `root` is its mount.
pub fn ur5(signs: [f64; 6], root: ([f64; 3], [f64; 3])) -> Robot {
    use std::f64::consts::{FRAC_PI_2, PI};
    const Y: [f64; 3] = [0.0, 1.0, 0.0];
    const Z: [f64; 3] = [0.0, 0.0, 1.0];
    let joint = |i: usize, xyz, pitch, axis: [f64; 3], limit: f64| Joint {
        kind: "revolute",
        xyz,
        rpy: [0.0, pitch, 0.0],
        axis: axis.map(|a| a * signs[i]),
        limits: [-limit, limit],
    };
    let joints = [
        joint(0, [0.0, 0.0, 0.089159], 0.0, Z, 2.0 * PI),
        joint(1, [0.0, 0.13585, 0.0], FRAC_PI_2, Y, 2.0 * PI),
        joint(2, [0.0, -0.1197, 0.425], 0.0, Y, PI),
        joint(3, [0.0, 0.0, 0.39225], FRAC_PI_2, Y, 2.0 * PI),
        joint(4, [0.0, 0.093, 0.0], 0.0, Z, 2.0 * PI),
        joint(5, [0.0, 0.0, 0.09465], 0.0, Y, 2.0 * PI),
    ];
    chain(root, &joints, ([0.01, 0.0823, -0.02], [0.2, -0.4, FRAC_PI_2]))
}

/// Along z of the joint before, turned by `roll` about x: how Franka and UFactory write their arms.
fn rolled(xyz: [f64; 3], roll: f64, limits: [f64; 2]) -> Joint {
    Joint { kind: "revolute", xyz, rpy: [roll, 0.0, 0.0], axis: [0.0, 0.0, 1.0], limits }
}

/// The joints of a Panda, as published.
pub fn panda_joints() -> [Joint; 7] {
    use std::f64::consts::FRAC_PI_2;
    let wide = [-2.8973, 2.8973];
    [
        rolled([0.0, 0.0, 0.333], 0.0, wide),
        rolled([0.0, 0.0, 0.0], -FRAC_PI_2, [-1.7628, 1.7628]),
        rolled([0.0, -0.316, 0.0], FRAC_PI_2, wide),
        rolled([0.0825, 0.0, 0.0], FRAC_PI_2, [-3.0718, -0.0698]),
        rolled([-0.0825, 0.384, 0.0], -FRAC_PI_2, wide),
        rolled([0.0, 0.0, 0.0], FRAC_PI_2, [-0.0175, 3.7525]),
        rolled([0.088, 0.0, 0.0], FRAC_PI_2, wide),
    ]
}

/// Its flange and hand.
pub const PANDA_TOOL: ([f64; 3], [f64; 3]) = ([0.0, 0.0, 0.2104], [0.0, 0.0, -std::f64::consts::FRAC_PI_4]);

pub fn panda() -> Robot {
    chain(([0.0; 3], [0.0; 3]), &panda_joints(), PANDA_TOOL)
}

/// A UFactory xArm 7: a Panda's build with other lengths and wider limits; roll angles rounded as in
/// its maker's URDF.
pub fn xarm7() -> Robot {
    use std::f64::consts::{FRAC_PI_2, TAU};
    let round = [-TAU, TAU];
    let quarter = (FRAC_PI_2 * 1e4).round() / 1e4;
    let joints = [
        rolled([0.0, 0.0, 0.267], 0.0, round),
        rolled([0.0, 0.0, 0.0], -quarter, [-2.059, 2.0944]),
        rolled([0.0, -0.293, 0.0], quarter, round),
        rolled([0.0525, 0.0, 0.0], quarter, [-0.19198, 3.927]),
        rolled([0.0775, -0.3425, 0.0], quarter, round),
        rolled([0.0, 0.0, 0.0], quarter, [-1.69297, std::f64::consts::PI]),
        rolled([0.076, 0.097, 0.0], -quarter, round),
    ];
    chain(([0.0; 3], [0.0; 3]), &joints, ([0.0, 0.0, 0.15], [0.0; 3]))
}

/// A KUKA LBR iiwa 14: three joints each at the shoulder and the wrist, all axes in one plane at zero.
pub fn iiwa() -> Robot {
    const Y: [f64; 3] = [0.0, 1.0, 0.0];
    const Z: [f64; 3] = [0.0, 0.0, 1.0];
    let joint = |z, axis, degrees: f64| {
        let limit = degrees.to_radians();
        Joint { kind: "revolute", xyz: [0.0, 0.0, z], rpy: [0.0; 3], axis, limits: [-limit, limit] }
    };
    let joints = [
        joint(0.1575, Z, 170.0),
        joint(0.2025, Y, 120.0),
        joint(0.2045, Z, 170.0),
        joint(0.2155, [0.0, -1.0, 0.0], 120.0),
        joint(0.1845, Z, 170.0),
        joint(0.2155, Y, 120.0),
        joint(0.081, Z, 175.0),
    ];
    chain(([0.0; 3], [0.0; 3]), &joints, ([0.0, 0.0, 0.1], [0.0; 3]))
}

/// A PR2's left arm, from its shoulder, with the cup where the gripper's tool is: the last three axes
/// meet, and the second and third; the first passes beside. The rolls turn without end.
pub fn pr2() -> Robot {
    const X: [f64; 3] = [1.0, 0.0, 0.0];
    const Y: [f64; 3] = [0.0, 1.0, 0.0];
    const Z: [f64; 3] = [0.0, 0.0, 1.0];
    let turns = |x, axis, limits| Joint { kind: "revolute", xyz: [x, 0.0, 0.0], rpy: [0.0; 3], axis, limits };
    let rolls = |x| Joint { kind: "continuous", ..turns(x, X, [0.0; 2]) };
    let joints = [
        turns(0.0, Z, [-0.714601836603, 2.2853981634]),
        turns(0.1, Y, [-0.5236, 1.3963]),
        turns(0.0, X, [-0.8, 3.9]),
        turns(0.4, Y, [-2.3213, 0.0]),
        rolls(0.0),
        turns(0.321, Y, [-2.094, 0.0]),
        rolls(0.0),
    ];
    chain(([-0.05, 0.188, 0.79], [0.0; 3]), &joints, ([0.18, 0.0, 0.0], [0.0; 3]))
}

/// Of a PR2's build with everything else random: lengths, offsets of the first axis and the elbow's,
/// angles between axes, mount, tool and limits.
pub fn like_pr2(random: &mut Random) -> Robot {
    use clearway_geometry::Mat3;
    use std::f64::consts::{FRAC_PI_2, PI};
    let mut within = |size: f64| random.random_range(-size..size);
    let mut joints: [Joint; 7] = std::array::from_fn(|i| {
        // The axis, z, is turned by 50° to 130° about x from the one before.
        let rpy = [FRAC_PI_2.copysign(within(1.0)) + within(0.7), 0.0, 0.0];
        // Joints 3, 6 and 7 are somewhere on axes that meet the one before where that joint is.
        let z = Mat3::from_axis_angle(Vec3::X, rpy[0]) * Vec3::Z;
        let xyz = match i {
            2 | 5 | 6 => (z * within(0.1)).to_array(),
            3 | 4 => [within(0.3), within(0.3), within(0.3)],
            _ => [within(0.2), within(0.2), within(0.2)],
        };
        let (middle, half) = (within(1.0), 1.2 + within(0.8));
        Joint { kind: "revolute", xyz, rpy, axis: [0.0, 0.0, 1.0], limits: [middle - half, middle + half] }
    });
    // Joint 6 was moved along its axis; the seventh passes where the fifth and sixth meet.
    let along = Vec3::from_array(joints[5].xyz).dot(Mat3::from_axis_angle(Vec3::X, joints[5].rpy[0]) * Vec3::Z);
    joints[6].xyz[2] -= along;
    let mut pose = || ([within(0.3), within(0.3), within(0.3)], [within(PI), within(1.5), within(PI)]);
    chain(pose(), &joints, pose())
}

/// A Fetch: a torso that slides, and seven joints with an offset at the shoulder.
pub fn fetch() -> Robot {
    use std::f64::consts::PI;
    const X: [f64; 3] = [1.0, 0.0, 0.0];
    const Y: [f64; 3] = [0.0, 1.0, 0.0];
    const Z: [f64; 3] = [0.0, 0.0, 1.0];
    let turns = |xyz, axis, limits| Joint { kind: "revolute", xyz, rpy: [0.0; 3], axis, limits };
    let joints = [
        Joint { kind: "prismatic", xyz: [-0.087, 0.0, 0.378], rpy: [0.0; 3], axis: Z, limits: [0.0, 0.386] },
        turns([0.1195, 0.0, 0.3486], Z, [-1.6056, 1.6056]),
        turns([0.117, 0.0, 0.06], Y, [-1.221, 1.518]),
        turns([0.219, 0.0, 0.0], X, [-PI, PI]),
        turns([0.133, 0.0, 0.0], Y, [-2.251, 2.251]),
        turns([0.197, 0.0, 0.0], X, [-PI, PI]),
        turns([0.1245, 0.0, 0.0], Y, [-2.16, 2.16]),
        turns([0.1385, 0.0, 0.0], X, [-PI, PI]),
    ];
    chain(([0.0; 3], [0.0; 3]), &joints, ([0.166, 0.0, 0.0], [0.0; 3]))
}

/// A Kinova Jaco 2 with six joints and a wrist whose axes do not meet.
pub fn jaco() -> Robot {
    use std::f64::consts::{FRAC_PI_2, PI};
    let joint = |xyz, rpy, limits| Joint { kind: "revolute", xyz, rpy, axis: [0.0, 0.0, 1.0], limits };
    let round = [-2.0 * PI, 2.0 * PI];
    let joints = [
        joint([0.0, 0.0, 0.15675], [0.0, PI, 0.0], round),
        joint([0.0, 0.0016, -0.11875], [-FRAC_PI_2, 0.0, PI], [0.82, 5.46]),
        joint([0.0, -0.41, 0.0], [0.0, PI, 0.0], [0.33, 5.95]),
        joint([0.0, 0.2073, -0.0114], [-FRAC_PI_2, 0.0, PI], round),
        joint([0.0, 0.0, -0.10375], [FRAC_PI_2, 0.0, PI], [0.52, 5.76]),
        joint([0.0, 0.10375, 0.0], [-FRAC_PI_2, 0.0, PI], round),
    ];
    chain(([0.0; 3], [0.0; 3]), &joints, ([0.0, 0.0, -0.16], [PI, 0.0, 0.0]))
}
