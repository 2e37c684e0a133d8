//! A user's own robot: URDF with a mesh, SRDF and robot file in a directory.

mod support;

use clearway_geometry::{Convex, Vec3};
use clearway_plan::robot_file::GraspKind;
use clearway_robot::description::{CollisionKind, describe_urdf};
use clearway_robot::report::{report, report_model};
use clearway_robot::{JointKind, Robot};
use std::fs;
use support::{FILE, SRDF, URDF, load_from, stl, with, written};

#[test]
fn loads_with_defaults_filled_in() {
    let directory = written(FILE, URDF, SRDF);
    let robot = load_from(directory.path()).expect("the small robot");
    assert_eq!(robot.name, "small");
    assert_eq!(robot.urdf_text, URDF);
    assert_eq!(robot.arm_names(), ["turn", "lift"]);
    assert_eq!((robot.lower[0], robot.upper[0]), (f64::NEG_INFINITY, f64::INFINITY));
    assert_eq!(robot.home, [0.5, 0.1]); // the second: the limit nearest to 0
    assert_eq!(robot.acceleration, [3.0, 8.0]);
    assert_eq!(robot.jerk, [50.0, 50.0]);
    assert_eq!(robot.velocity, [1.0, 0.2]);
    assert_eq!(robot.fixed.iter().map(|(n, v)| (n.as_str(), *v)).collect::<Vec<_>>(), [("camera_tilt", 0.2)]);
    let turn = &robot.joints[robot.arm[0]];
    assert_eq!((turn.kind, turn.axis), (JointKind::Continuous, Vec3::Z));
    assert_eq!(robot.links[robot.hand.frame].name, "tool");
    assert_eq!(robot.hand.opening, [(0.0, 0.0), (0.04, 0.08)]);
    let pair = (robot.link("base").expect("base"), robot.link("left_finger").expect("a finger"));
    assert!(robot.disabled_pairs.contains(&pair) && robot.disabled_pairs.len() == 1);
    assert_eq!(robot.named_states["up"]["lift"], 0.4);

    let arm = &robot.links[robot.link("arm").expect("arm")];
    assert_eq!(arm.collision_kinds, [(CollisionKind::Mesh("meshes/arm.stl".to_owned()), 1)]);
    let (low, high) = arm.collision.aabb(clearway_geometry::Pose::IDENTITY);
    assert!(low.length() < 1e-6 && (high - Vec3::new(0.05, 0.1, 0.2)).length() < 1e-6, "{low} {high}");
    assert!(matches!(arm.collision.parts[0].1, Convex::Hull(_)));
    assert_eq!(robot.meshes.len(), 1);
    assert_eq!(robot.meshes[0].sha256.len(), 64);
    assert!(report(&robot).contains("mesh arm.stl as 1 convex part"));
}

#[test]
fn meshes_come_from_packages_and_by_file_uris() {
    let elsewhere = tempfile::tempdir().expect("a temporary directory");
    fs::write(elsewhere.path().join("part.stl"), stl([0.1, 0.1, 0.1])).expect("a mesh");
    let at = elsewhere.path().display();
    let urdf = with(URDF, "meshes/arm.stl", "package://parts-1/part.stl");
    let declared = with(FILE, "packages: {}", &format!("packages: {{parts-1: \"{at}\"}}"));
    load_from(written(&declared, &urdf, SRDF).path()).expect("declared in the file");
    let directory = written(FILE, &urdf, SRDF);
    let packages = [("parts-1".to_owned(), elsewhere.path().to_owned())];
    Robot::load("robot.yaml", directory.path(), &packages).expect("declared by the caller");
    let error = load_from(directory.path()).expect_err("not declared").to_string();
    assert!(error.contains("small.urdf:7:") && error.contains("--package parts-1=DIRECTORY"), "{error}");

    let uri = format!("file://{at}/part.stl");
    let urdf = with(URDF, "meshes/arm.stl", &uri);
    load_from(written(&declared, &urdf, SRDF).path()).expect("inside a declared package");
    let error = load_from(written(FILE, &urdf, SRDF).path()).expect_err("outside").to_string();
    assert!(error.contains("leaves the robot's directory"), "{error}");

    // A relative package, and a robot file that is not at its root.
    let directory = written(FILE, URDF, SRDF);
    fs::create_dir(directory.path().join("config")).expect("a directory");
    let file = with(&with(FILE, "packages: {}", "packages: {small: ..}"), "urdf: small", "urdf: ../small");
    let file = with(&file, "srdf: small.srdf", "srdf: package://small/small.srdf");
    fs::write(directory.path().join("config/robot.yaml"), file).expect("a robot file");
    Robot::load("config/robot.yaml", directory.path(), &[]).expect("a package above the robot file");
}

/// Flat faces that share no corner enclose a box only together.
#[test]
fn loose_faces_are_not_dropped() {
    let directory = written(FILE, URDF, SRDF);
    let mut bytes = stl([0.1, 0.1, 0.1]);
    // Two whole boxes are a mesh of two parts; pull the second's faces apart by turns.
    let second = stl([0.1, 0.1, 0.1]);
    for (i, triangle) in second[84..].chunks(50).enumerate() {
        let mut triangle = triangle.to_vec();
        for corner in 0..3 {
            let x = 12 + 12 * corner;
            let moved = f32::from_le_bytes([triangle[x], triangle[x + 1], triangle[x + 2], triangle[x + 3]])
                + 1.0
                + 1e-4 * i as f32;
            triangle[x..x + 4].copy_from_slice(&moved.to_le_bytes());
        }
        bytes.extend(triangle);
    }
    bytes[80..84].copy_from_slice(&24_u32.to_le_bytes());
    fs::write(directory.path().join("meshes/arm.stl"), bytes).expect("a mesh");
    let robot = load_from(directory.path()).expect("the small robot");
    let arm = &robot.links[robot.link("arm").expect("arm")];
    assert_eq!(arm.collision.parts.len(), 2);
    let (_, high) = arm.collision.aabb(clearway_geometry::Pose::IDENTITY);
    assert!((0.55..0.551).contains(&high.x), "{high}");
}

#[test]
fn a_planar_base_is_added_above_the_root() {
    let file =
        with(FILE, "mobile: none", "mobile: {planar: {joints: [base_x, base_y, base_yaw], velocity: [0.5, 0.4, 0.8]}}");
    let directory = written(&file, URDF, SRDF);
    let robot = load_from(directory.path()).expect("a robot that drives");
    assert_eq!(robot.arm_names(), ["base_x", "base_y", "base_yaw", "turn", "lift"]);
    assert_eq!(robot.planar_base, Some([robot.arm[0], robot.arm[1], robot.arm[2]]));
    assert_eq!(robot.velocity, [0.5, 0.4, 0.8, 1.0, 0.2]);
    assert_eq!(robot.home, [0.0, 0.0, 0.0, 0.5, 0.1]);
    assert_eq!(robot.links[0].name, "base_x_zero");
    assert!(robot.urdf_text.contains("base_yaw") && robot.urdf_text.trim_end().ends_with("</robot>"));
    // The text that goes into plans is a URDF with the same joints, so it is not added to again.
    let again = written(&file, &robot.urdf_text, SRDF);
    let robot_again = load_from(again.path()).expect("the same robot");
    assert_eq!(robot_again.urdf_text, robot.urdf_text);
    assert_eq!(robot_again.arm_names(), robot.arm_names());
    assert!(report(&robot).contains("the first three drive the base"));
}

#[test]
fn suction_and_listed_grasps() {
    let hand = FILE.split("hand:").nth(1).and_then(|s| s.split("grasps:").next()).expect("the hand's lines");
    let cup = "\n  kind: {suction: {radius: 0.02}}\n  frame: tool\n  links: [wrist]\n";
    let file = with(FILE, hand, cup);
    let file = with(
        &file,
        "{kind: side, yaws: 12, heights: [0.5], standoff: 0.1}",
        "{list: [{position: [0, 0, 0.1], rpy: [3.1416, 0, 0]}]}",
    );
    let robot = load_from(written(&file, URDF, SRDF).path()).expect("a robot with a cup");
    assert_eq!(robot.hand.joint, None);
    assert_eq!(robot.grasps.kind, GraspKind::List);
    assert!(robot.fixed.contains_key("left"));
    assert!(report(&robot).contains("suction cup, radius 20 mm"));
}

#[test]
fn a_bare_urdf_is_described() {
    let directory = written(FILE, URDF, SRDF);
    let model = describe_urdf(&directory.path().join("small.urdf"), &[]).expect("the model");
    let text = report_model(&model);
    assert!(text.contains("root link base") && text.contains("follows: right = 1 × left"), "{text}");
}

#[test]
fn what_is_mounted_is_the_first_shape_below_the_root() {
    let mounted = |urdf: &str| {
        let directory = written(FILE, urdf, SRDF);
        let robot = load_from(directory.path()).expect("the small robot");
        let links: Vec<String> =
            (0..robot.links.len()).filter(|&l| robot.mounted(l)).map(|l| robot.links[l].name.clone()).collect();
        links
    };
    assert_eq!(mounted(URDF), ["base"]);
    let world = "<robot name=\"small\">\n  <link name=\"world\"/>\n  <joint name=\"floor\" type=\"fixed\">\
                 <parent link=\"world\"/><child link=\"base\"/></joint>";
    assert_eq!(mounted(&with(URDF, "<robot name=\"small\">", world)), ["world", "base"]);
}
