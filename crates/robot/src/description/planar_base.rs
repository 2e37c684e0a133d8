//! A base that drives: three joints above the URDF's root, added to its text if it lacks them.
//!
//! The added links have no shape. The joints' ranges are wide: the scene's `region` says how far
//! the base may drive.

use super::element::{Source, children};
use super::urdf;
use clearway_files::{FileError, Located, quoted, xml};
use clearway_plan::RobotFile;
use clearway_plan::robot_file::Mobile;
use std::collections::HashSet;

/// How far an added joint lets the base drive from its zero, metres.
const FARTHEST: f64 = 100.0;

/// The URDF's text, with the joints of a planar base.
pub fn with_joints(file: &Located<RobotFile>, source: Source, text: &str) -> Result<String, FileError> {
    let Mobile::Planar { joints, velocity } = &file.value.mobile else { return Ok(text.to_owned()) };
    if let Some(wrong) = velocity.iter().find(|&&v| !(v > 0.0 && v.is_finite())) {
        return Err(file
            .error(&["mobile", "planar", "velocity"], format!("the velocity limit {wrong}"))
            .expected("three numbers greater than 0: m/s, m/s, rad/s"));
    }
    let document = xml::parse(source.path, text)?;
    let urdf = urdf::read(source, &document)?;
    let keys = ["mobile", "planar", "joints"];
    for (i, name) in joints.iter().enumerate() {
        let plain = |c: char| c.is_alphanumeric() || "_-./".contains(c);
        if name.is_empty() || !name.chars().all(plain) || joints[..i].contains(name) {
            return Err(file
                .error(&keys, format!("the joint name {}", quoted(name)))
                .expected("three different names, of letters, digits, `_`, `-`, `.` and `/`"));
        }
    }
    match joints.iter().filter(|name| urdf.joints.iter().any(|j| j.name == name.as_str())).count() {
        3 => return Ok(text.to_owned()),
        0 => {}
        found => {
            return Err(file
                .error(&keys, format!("the URDF has {found} of the three joints"))
                .expected("all of them, or none, to have them added"));
        }
    }
    let children_of_joints: HashSet<&str> = urdf.joints.iter().map(|j| j.child).collect();
    let Some(root) = urdf.links.iter().find(|l| !children_of_joints.contains(l.name)) else {
        return Err(
            FileError::new(source.path, "no root link: the joints form a loop").help("a URDF is a tree: open the loop")
        );
    };
    let [x, y, yaw] = joints;
    let [ground, carriage_x, carriage_y] = [format!("{x}_zero"), format!("{x}_carriage"), format!("{y}_carriage")];
    if let Some(taken) = urdf.links.iter().find(|l| [&ground, &carriage_x, &carriage_y].iter().any(|n| *n == l.name)) {
        return Err(file
            .error(&keys, format!("the URDF has a link {} already, which would have to be added", quoted(taken.name)))
            .help("choose other joint names"));
    }
    let link = |name: &str| format!("  <link name=\"{name}\"/>\n");
    let joint = |name: &str, kind: &str, parent: &str, child: &str, axis: &str, limit: String| {
        format!(
            "  <joint name=\"{name}\" type=\"{kind}\">\n    <parent link=\"{parent}\"/>\n    <child link=\"{child}\"/>\n    \
             <axis xyz=\"{axis}\"/>\n    <limit {limit} effort=\"1000\"/>\n  </joint>\n"
        )
    };
    let slide = |v: f64| format!("lower=\"-{FARTHEST}\" upper=\"{FARTHEST}\" velocity=\"{v}\"");
    let added = [
        link(&ground),
        joint(x, "prismatic", &ground, &carriage_x, "1 0 0", slide(velocity[0])),
        link(&carriage_x),
        joint(y, "prismatic", &carriage_x, &carriage_y, "0 1 0", slide(velocity[1])),
        link(&carriage_y),
        joint(yaw, "continuous", &carriage_y, &escaped(root.name), "0 0 1", format!("velocity=\"{}\"", velocity[2])),
    ]
    .concat();
    // Behind the last element, so that places in the user's text stay where they were.
    let robot = document.root_element();
    let end = children(robot, "link").chain(children(robot, "joint")).map(|n| n.range().end).max();
    let Some((before, after)) = end.and_then(|end| text.split_at_checked(end)) else {
        return Err(FileError::new(source.path, "a robot without links"));
    };
    Ok(format!("{before}\n\n  <!-- The base that drives. -->\n{added}{after}"))
}

/// A name out of an attribute, to be written into one.
fn escaped(name: &str) -> String {
    name.replace('&', "&amp;").replace('<', "&lt;").replace('"', "&quot;")
}
