//! Arms written out as URDFs, each with a suction cup as its hand, and loaded as a user's would be.

use clearway_robot::Robot;
use std::fs;

/// One joint of a chain: where it is in the link before (metres, radians), and its axis there.
pub struct Turning {
    pub xyz: [f64; 3],
    pub rpy: [f64; 3],
    pub axis: [f64; 3],
    pub limits: [f64; 2],
}

/// A chain of turning joints. `root` is the pose of the first link in the root link, `tool` that of
/// the cup in the last link, each `xyz` and `rpy`.
pub fn chain(root: ([f64; 3], [f64; 3]), joints: &[Turning], tool: ([f64; 3], [f64; 3])) -> Robot {
    let row = |v: [f64; 3]| format!("{} {} {}", v[0], v[1], v[2]);
    let origin = |(xyz, rpy): ([f64; 3], [f64; 3])| format!("<origin xyz=\"{}\" rpy=\"{}\"/>", row(xyz), row(rpy));
    let fixed = |name: &str, parent: &str, child: &str, pose| {
        format!("<joint name=\"{name}\" type=\"fixed\"><parent link=\"{parent}\"/><child link=\"{child}\"/>{}</joint>\n", origin(pose))
    };
    let mut urdf = "<robot name=\"chain\">\n<link name=\"root\"/><link name=\"l0\"/>\n".to_owned();
    urdf += &fixed("mount", "root", "l0", root);
    for (i, j) in joints.iter().enumerate() {
        urdf += &format!(
            "<link name=\"l{}\"/><joint name=\"j{}\" type=\"revolute\"><parent link=\"l{i}\"/><child link=\"l{}\"/>{}\
             <axis xyz=\"{}\"/><limit lower=\"{}\" upper=\"{}\" velocity=\"2\" effort=\"1\"/></joint>\n",
            i + 1,
            i + 1,
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
    let joint = |i: usize, xyz, pitch, axis: [f64; 3], limit: f64| Turning {
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

/// A Panda: seven joints, so infinitely many postures for a pose.
pub fn panda() -> Robot {
    use std::f64::consts::FRAC_PI_2;
    let joint = |xyz, roll, limits| Turning { xyz, rpy: [roll, 0.0, 0.0], axis: [0.0, 0.0, 1.0], limits };
    let wide = [-2.8973, 2.8973];
    let joints = [
        joint([0.0, 0.0, 0.333], 0.0, wide),
        joint([0.0, 0.0, 0.0], -FRAC_PI_2, [-1.7628, 1.7628]),
        joint([0.0, -0.316, 0.0], FRAC_PI_2, wide),
        joint([0.0825, 0.0, 0.0], FRAC_PI_2, [-3.0718, -0.0698]),
        joint([-0.0825, 0.384, 0.0], -FRAC_PI_2, wide),
        joint([0.0, 0.0, 0.0], FRAC_PI_2, [-0.0175, 3.7525]),
        joint([0.088, 0.0, 0.0], FRAC_PI_2, wide),
    ];
    chain(([0.0; 3], [0.0; 3]), &joints, ([0.0, 0.0, 0.21], [0.0, 0.0, 0.785]))
}
