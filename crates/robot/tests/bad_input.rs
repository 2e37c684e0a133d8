//! Broken robots: each error says where, what was found, and what to do.

mod support;

use clearway_robot::Robot;
use std::fs;
use std::path::Path;
use support::{FILE, SRDF, URDF, load_from, stl, with, written};

fn error(file: &str, urdf: &str, srdf: &str) -> String {
    let directory = written(file, urdf, srdf);
    let error = load_from(directory.path()).expect_err("a broken robot").to_string();
    error.replace(&directory.path().canonicalize().expect("a directory").display().to_string(), "DIR")
}

/// `(what to replace, by what, what the error says)`.
#[test]
fn broken_urdfs() {
    let cases = [
        (
            "<link name=\"camera\"/>",
            "<link name=\"camera\"/><link name=\"lost\"/>",
            "small.urdf:30:24: 2 root links, `base` and `lost`",
        ),
        (
            "<parent link=\"base\"/><child link=\"arm\"/>",
            "<parent link=\"tool\"/><child link=\"arm\"/>",
            "part of a loop",
        ),
        (
            "<parent link=\"base\"/><child link=\"camera\"/>",
            "<parent link=\"base\"/><child link=\"arm\"/>",
            "child of two joints",
        ),
        ("<link name=\"camera\"/>", "<link name=\"camera\"/><link name=\"arm\"/>", "a second link named `arm`"),
        ("joint name=\"mount\"", "joint name=\"turn\"", "small.urdf:13:10: a second joint named `turn`"),
        ("<parent link=\"arm\"/>", "<parent link=\"amr\"/>", "did you mean `arm`?"),
        (
            "<child link=\"wrist\"/>",
            "<child link=\"nothing_such\"/>",
            "the child link `nothing_such`, which does not exist",
        ),
        ("<child link=\"wrist\"/>", "", "joint `lift` without <child>"),
        ("<limit lower=\"0.2\" upper=\"1.0\" velocity=\"1\" effort=\"1\"/>", "", "joint `camera_tilt` has no limits"),
        ("lower=\"0.1\" upper=\"0.5\"", "", "joint `lift` has no limits"),
        ("lower=\"0.1\" upper=\"0.5\"", "lower=\"0.5\" upper=\"0.1\"", "help: swap the two"),
        ("lower=\"0.1\"", "lower=\"nan\"", "small.urdf:10:66: `lower` is `nan`, expected a finite number"),
        ("lower=\"0.1\"", "lower=\"-inf\"", "`lower` is `-inf`"),
        ("lower=\"0.1\"", "lower=\"0,1\"", "`lower` is `0,1`"),
        ("upper=\"0.5\"", "upper=\"1e300\"", "`upper` is `1e300`"),
        ("xyz=\"0 0 0.1\"", "xyz=\"0 0\"", "`xyz` is `0 0`, expected 3 finite numbers"),
        ("xyz=\"0 0 0.1\"", "xyz=\"0 0 0.1 0\"", "expected 3 finite numbers"),
        ("axis xyz=\"0 0 2\"", "axis xyz=\"0 0 0\"", "the axis of joint `turn` has no direction"),
        ("box size=\"0.2 0.2 0.1\"", "box size=\"0.2 -0.2 0.1\"", "sizes greater than 0"),
        ("sphere radius=\"0.01\"", "sphere radius=\"0\"", "sizes greater than 0"),
        ("sphere radius=\"0.01\"", "sphere", "<sphere> without `radius`"),
        ("<sphere radius=\"0.01\"/>", "<cone radius=\"0.01\"/>", "`right_finger` has the shape <cone>"),
        ("<sphere radius=\"0.01\"/>", "", "a <collision> of link `right_finger` without a shape"),
        ("scale=\"0.5 1 1\"", "scale=\"0.5 0 1\"", "a scale of 0"),
        ("velocity=\"0.2\"", "velocity=\"0\"", "joint `lift` of the arm has the velocity limit 0"),
        ("velocity=\"0.2\"", "velocity=\"-1\"", "the velocity limit of joint `lift` is -1"),
        ("velocity=\"0.2\"", "", "joint `lift` of the arm has no velocity limit"),
        ("mimic joint=\"left\"", "mimic joint=\"lefty\"", "did you mean `left`?"),
        ("mimic joint=\"left\"", "mimic joint=\"right\"", "joint `right` mimics itself"),
        ("mimic joint=\"left\"", "mimic joint=\"mount\"", "mimics `mount`, which is fixed"),
        (
            "<axis xyz=\"0 0 1\"/>",
            "<axis xyz=\"0 0 1\"/><mimic joint=\"turn\"/>",
            "joint `lift` of the arm mimics another",
        ),
        ("type=\"continuous\"", "type=\"floating\"", "is of type `floating`"),
        ("type=\"continuous\"", "type=\"planar\"", "mobile: {planar"),
        ("type=\"continuous\"", "type=\"continous\"", "did you mean `continuous`?"),
        ("meshes/arm.stl", "meshes/leg.stl", "no such file"),
        ("meshes/arm.stl", "../arm.stl", "leaves the robot's directory"),
        ("meshes/arm.stl", "file:///etc/passwd", "leaves the robot's directory"),
        ("meshes/arm.stl", "http://example.org/arm.stl", "neither a file nor in a package"),
        ("meshes/arm.stl", "package://nowhere/arm.stl", "the package `nowhere` is not declared"),
        ("<robot name", "<model name", "not well-formed XML"),
        ("<link name=\"camera\"/>", "<link/>", "<link> without `name`"),
        ("<link name=\"camera\"/>", "<link name=\"\"/>", "`name` is empty"),
    ];
    for (from, to, told) in cases {
        let error = error(FILE, &with(URDF, from, to), SRDF);
        assert!(error.contains(told), "for {to} wanted {told}, got\n{error}");
        assert!(error.contains("small.urdf:"), "no place in\n{error}");
    }
    assert!(error(FILE, "<robot name='r'/>", SRDF).contains("a robot without links"));
    assert!(error(FILE, "<sdf/>", SRDF).contains("the outermost element is <sdf>, expected <robot>"));
    let xacro = with(URDF, "<robot name", "<robot xmlns:xacro=\"http://www.ros.org/wiki/xacro\" name");
    let xacro = with(&xacro, "</robot>", "<xacro:include filename='x'/></robot>");
    assert!(error(FILE, &xacro, SRDF).contains("expand it first"));
}

#[test]
fn hostile_urdfs_are_refused_at_once() {
    let deep = format!("<robot>{}{}</robot>", "<a>".repeat(200_000), "</a>".repeat(200_000));
    assert!(error(FILE, &deep, SRDF).contains("nested more than"));
    let many: String = (0..2500).map(|i| format!("<link name=\"l{i}\"/>")).collect();
    assert!(error(FILE, &with(URDF, "</robot>", &format!("{many}</robot>")), SRDF).contains("at most 2000"));
    let chain: String = (0..1900)
        .map(|i| {
            let parent = if i == 0 { "camera".to_owned() } else { format!("c{}", i - 1) };
            format!("<link name=\"c{i}\"/><joint name=\"j{i}\" type=\"fixed\"><parent link=\"{parent}\"/><child link=\"c{i}\"/></joint>")
        })
        .collect();
    let long = written(FILE, &with(URDF, "</robot>", &format!("{chain}</robot>")), SRDF);
    load_from(long.path()).expect("a long chain is no error");
}

#[test]
fn broken_robot_files() {
    let cases = [
        (
            "clearway-robot/1",
            "clearway-robot/9",
            "robot.yaml:1:9: the format `clearway-robot/9`, expected `clearway-robot/1`",
        ),
        ("jerk:", "jrek:", "unknown key `jrek`"),
        ("urdf: small.urdf", "urdf: smal.urdf", "robot.yaml:2:7: DIR/smal.urdf: no such file"),
        ("urdf: small.urdf", "urdf: ../../etc/passwd", "leaves the robot's directory"),
        ("srdf: small.srdf", "srdf: other.srdf", "robot.yaml:3:7:"),
        ("packages: {}", "packages: {parts: nowhere}", "robot.yaml:4:19:"),
        ("tip: wrist}", "tip: wirst}", "robot.yaml:5:24: the URDF has no link `wirst`\n  help: did you mean `wrist`?"),
        ("base: base, tip: wrist", "base: wrist, tip: base", "swap the two"),
        ("base: base, tip: wrist", "base: camera, tip: wrist", "does not hang from `camera`"),
        ("base: base, tip: wrist", "base: wrist, tip: tool", "no joint moves between"),
        (
            "fixed: {}",
            "fixed: {camera_tilt: 2.0}",
            "2 for joint `camera_tilt`, expected a value within its limits, 0.2 to 1 radians",
        ),
        ("fixed: {}", "fixed: {camera_tilt: .nan}", "NaN for joint"),
        ("fixed: {}", "fixed: {camera: 0.5}", "the URDF has no joint `camera`"),
        ("fixed: {}", "fixed: {turn: 0.5}", "give its resting value under `home`"),
        ("fixed: {}", "fixed: {left: 0.0}", "opens the hand"),
        ("fixed: {}", "fixed: {right: 0.0}", "follows another"),
        ("fixed: {}", "fixed: {mount: 0.0}", "does not move"),
        ("home: {turn: 0.5}", "home: {lift: 0.6}", "robot.yaml:7:14: 0.6 for joint `lift`"),
        ("home: {turn: 0.5}", "home: {trun: 0.5}", "did you mean `turn`?"),
        ("home: {turn: 0.5}", "home: {camera_tilt: 0.5}", "under `fixed`"),
        ("acceleration: {turn: 3.0}", "acceleration: -1", "the limit -1"),
        ("acceleration: {turn: 3.0}", "acceleration: {turn: -3.0}", "the limit -3"),
        ("acceleration: {turn: 3.0}", "acceleration: {left: 3.0}", "not one of the arm's"),
        ("frame: tool", "frame: toll", "did you mean `tool`?"),
        ("frame: tool", "frame: base", "not carried by the arm's last joint"),
        ("frame: tool", "frame: left_finger", "moves as the hand opens"),
        ("joint: left", "joint: right", "follows another by <mimic>"),
        ("joint: left", "joint: turn", "is one of the arm's"),
        ("joint: left", "joint: mount", "does not move"),
        ("  joint: left\n", "", "a parallel hand without `joint`"),
        ("links: [left_finger, right_finger, wrist]", "links: []", "no links"),
        (
            "links: [left_finger, right_finger, wrist]",
            "links: [left_finger, lef_finger]",
            "robot.yaml:14:24: the URDF has no link `lef_finger`",
        ),
        ("links: [left_finger, right_finger, wrist]", "links: [wrist, wrist]", "listed twice"),
        ("links: [left_finger, right_finger, wrist]", "links: [wrist, camera]", "not carried"),
        ("base_radius: 0.05", "base_radius: -0.05", "-0.05, expected metres"),
        ("finger_thickness: 0.01", "finger_thickness: .nan", "NaN, expected metres"),
        ("\"0.04\": 0.08", "\"0.05\": 0.08", "0.05 for joint `left`, expected a value within its limits"),
        ("\"0.04\": 0.08", "\"wide\": 0.08", "the key `wide`"),
        ("\"0.04\": 0.08", "\"0.04\": .nan", "a gap of NaN"),
        ("\"0.04\": 0.08", "\"0.04\": 0.08, \"0.02\": 0.09", "only rises, or only falls"),
        ("\"0.04\": 0.08", "\"0\": 0.08", "two gaps"),
        (", \"0.04\": 0.08", "", "1 entries"),
        ("yaws: 12", "yaws: 0", "0 directions, expected 1 to 360"),
        ("yaws: 12", "yaws: 1000000000", "expected 1 to 360"),
        ("heights: [0.5]", "heights: [0.5, 1.0]", "robot.yaml:17:47: the height 1"),
        ("heights: [0.5]", "heights: []", "0 heights"),
        ("standoff: 0.1", "standoff: 0", "metres, greater than 0"),
        ("kind: side", "kind: list", "without poses"),
        ("kind: side", "list: [{quaternion: [0, 0, 0, 0]}]", "of length 1"),
        ("kind: side", "list: [{quaternion: [0, 0, 0, 1], rpy: [0, 0, 0]}]", "both `rpy` and `quaternion`"),
        ("kind: side", "list: [{position: [0, .inf, 0]}]", "out of range"),
        ("kind: parallel", "kind: {suction: {radius: 0.02}}", "`joint` for a suction cup"),
        ("kind: parallel", "kind: {suction: {radius: -1}}", "a cup of radius -1"),
        ("mobile: none", "mobile: {planar: {joints: [x, y, x], velocity: [1, 1, 1]}}", "three different names"),
        ("mobile: none", "mobile: {planar: {joints: [x, y, z], velocity: [1, 0, 1]}}", "the velocity limit 0"),
        ("mobile: none", "mobile: {planar: {joints: [turn, y, z], velocity: [1, 1, 1]}}", "has 1 of the three joints"),
        ("mobile: none", "mobile: {planar: {joints: [turn, lift, left], velocity: [1, 1, 1]}}", "have other kinds"),
        ("mobile: none", "mobile: {planar: {joints: [left, lift, turn], velocity: [1, 1, 1]}}", "do not carry the arm"),
    ];
    for (from, to, told) in cases {
        let error = error(&with(FILE, from, to), URDF, SRDF);
        assert!(error.contains(told), "for {to} wanted {told}, got\n{error}");
        assert!(error.contains("robot.yaml:"), "no place in\n{error}");
    }
}

#[test]
fn broken_srdfs() {
    let cases = [
        (
            "link1=\"left_finger\"",
            "link1=\"left_fingr\"",
            "small.srdf:4:23: the URDF has no link `left_fingr`\n  help: did you mean",
        ),
        ("link2=\"base\"", "", "<disable_collisions> without `link2`"),
        ("link2=\"base\"", "link2=\"left_finger\"", "paired with itself"),
        ("name=\"lift\" value", "name=\"lfit\" value", "the URDF has no joint `lfit`"),
        ("value=\"0.4\"", "value=\"high\"", "`value` is `high`"),
        ("</robot>", "", "not well-formed XML"),
    ];
    for (from, to, told) in cases {
        let error = error(FILE, URDF, &with(SRDF, from, to));
        assert!(error.contains(told), "for {to} wanted {told}, got\n{error}");
    }
}

#[test]
fn broken_meshes() {
    for (bytes, told) in [
        (stl([0.1, 0.1, 0.1])[..300].to_vec(), "cut off"),
        (stl([0.1, 0.1, 0.0]), "is flat"),
        (stl([0.1, 0.1, f32::NAN]), "finite coordinates"),
        (Vec::new(), "cut off"),
    ] {
        let directory = written(FILE, URDF, SRDF);
        fs::write(directory.path().join("meshes/arm.stl"), bytes).expect("a mesh");
        let error = load_from(directory.path()).expect_err("a broken mesh").to_string();
        assert!(error.contains(told) && error.contains("small.urdf:7:"), "wanted {told}, got\n{error}");
    }
}

#[test]
fn what_is_no_robot_file() {
    let load = |model: &str| Robot::load(model, Path::new("."), &[]).expect_err("no robot").to_string();
    assert!(load("ur10_ag59").contains("did you mean `ur10_ag95`?"), "{}", load("ur10_ag59"));
    assert!(load("nowhere/robot.yaml").contains("no such file"));
    assert!(load(".").contains("is a directory"));
    let directory = written(FILE, URDF, SRDF);
    let error = Robot::load("small.urdf", directory.path(), &[]).expect_err("a URDF").to_string();
    assert!(error.contains("expected a robot file"), "{error}");
}
