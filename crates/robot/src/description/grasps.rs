//! The preset grasps, checked. What they are at an object is the planner's affair.

use clearway_files::{FileError, Located};
use clearway_plan::RobotFile;
use clearway_plan::robot_file::{GraspKind, Grasps};

/// Listed poses; heights. Each is tried at every object.
const MOST: usize = 1000;

pub fn check(file: &Located<RobotFile>) -> Result<Grasps, FileError> {
    let grasps = &file.value.grasps;
    let wrong = |key: &str, found: String| file.error(&["grasps", key], found);
    if !(1..=360).contains(&grasps.yaws) {
        return Err(wrong("yaws", format!("{} directions", grasps.yaws)).expected("1 to 360"));
    }
    if grasps.heights.is_empty() || grasps.heights.len() > MOST {
        return Err(wrong("heights", format!("{} heights", grasps.heights.len())).expected(format!("1 to {MOST}")));
    }
    for (i, &height) in grasps.heights.iter().enumerate() {
        if !(height > 0.0 && height < 1.0) {
            return Err(file
                .error(&["grasps", "heights", &i.to_string()], format!("the height {height}"))
                .expected("a fraction of the object's height, between 0 and 1"));
        }
    }
    if !(grasps.standoff > 0.0 && grasps.standoff <= 2.0) {
        return Err(wrong("standoff", format!("{}", grasps.standoff)).expected("metres, greater than 0 and at most 2"));
    }
    if grasps.kind == GraspKind::List && grasps.list.is_empty() {
        return Err(wrong("list", "`kind: list` without poses".to_owned())
            .expected("`list:` of poses of the hand's frame in the object's")
            .help("add `list: [{position: [0, 0, 0.1], rpy: [3.1416, 0, 0]}, …]`, or say `kind: side`"));
    }
    if grasps.list.len() > MOST {
        return Err(wrong("list", format!("{} poses", grasps.list.len())).expected(format!("at most {MOST}")));
    }
    for (i, pose) in grasps.list.iter().enumerate() {
        let index = i.to_string();
        let keys = ["grasps", "list", index.as_str()];
        let numbers = pose.position.iter().chain(pose.rpy.iter().flatten()).chain(pose.quaternion.iter().flatten());
        if !numbers.clone().all(|x| x.abs() <= 1e3) {
            return Err(file.error(&keys, "a pose out of range").expected("finite numbers, in metres and radians"));
        }
        if pose.rpy.is_some() && pose.quaternion.is_some() {
            return Err(file.error(&keys, "both `rpy` and `quaternion`").expected("one of the two"));
        }
        if let Some(q) = pose.quaternion
            && (q.iter().map(|x| x * x).sum::<f64>().sqrt() - 1.0).abs() > 1e-3
        {
            return Err(file.error(&keys, format!("the quaternion {q:?}")).expected("[x, y, z, w] of length 1"));
        }
    }
    // A list says by itself what it is.
    let kind = if grasps.list.is_empty() { GraspKind::Side } else { GraspKind::List };
    Ok(Grasps { kind, ..grasps.clone() })
}
