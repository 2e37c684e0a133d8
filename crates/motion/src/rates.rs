//! How fast joints may move, get faster, and get faster at getting faster.

use crate::Limits;
use clearway_files::{FileError, closest, quoted};
use clearway_plan::motion_file::MotionLimits;
use clearway_plan::robot_file::PerJoint;
use clearway_robot::{Group, Robot};
use clearway_scene::Bodies;

/// rad/s³ or m/s³, a robot file's default.
const USUAL_JERK: f64 = 80.0;

/// What a problem says, else what the robot file says; in words why there are none.
pub fn read(
    bodies: &Bodies,
    group: &Group,
    robot: Option<&Robot>,
    given: Option<&MotionLimits>,
) -> Result<Result<Limits, String>, FileError> {
    let read = |key: &str, limit: &PerJoint, usual: Option<&Vec<f64>>| per_joint(bodies, group, key, limit, usual);
    let (acceleration, jerk) = match (given, robot) {
        (None, None) => {
            return Ok(Err(
                "no trajectory: a URDF has no limits of acceleration; give `limits: {acceleration: …}`".to_owned()
            ));
        }
        (None, Some(robot)) => (robot.acceleration.clone(), robot.jerk.clone()),
        (Some(limits), robot) => {
            let jerk = match &limits.jerk {
                Some(jerk) => read("jerk", jerk, robot.map(|r| &r.jerk))?,
                None => robot.map_or(vec![USUAL_JERK; group.names.len()], |r| r.jerk.clone()),
            };
            (read("acceleration", &limits.acceleration, robot.map(|r| &r.acceleration))?, jerk)
        }
    };
    if let Some(j) = group.velocity.iter().position(|v| !(*v > 0.0 && v.is_finite())) {
        let found = if group.velocity[j] == f64::INFINITY { "none".to_owned() } else { group.velocity[j].to_string() };
        return Ok(Err(format!(
            "no trajectory: the URDF's velocity limit of joint {} is {found}",
            quoted(&group.names[j])
        )));
    }
    Ok(Ok(Limits { velocity: group.velocity.clone(), acceleration, jerk }))
}

/// One number for all joints, or one by joint, those not named having the usual one.
fn per_joint(
    bodies: &Bodies,
    group: &Group,
    key: &str,
    given: &PerJoint,
    usual: Option<&Vec<f64>>,
) -> Result<Vec<f64>, FileError> {
    let positive = |keys: &str, value: f64| {
        if value > 0.0 && value.is_finite() {
            return Ok(value);
        }
        Err(bodies.error(keys, format!("the limit {value}")).expected("a finite number greater than 0"))
    };
    let keys = format!("limits.{key}");
    match given {
        PerJoint::All(value) => Ok(vec![positive(&keys, *value)?; group.names.len()]),
        PerJoint::ByJoint(values) => {
            for name in values.keys().filter(|n| !group.names.contains(n)) {
                let error =
                    bodies.error(&format!("{keys}.{name}"), format!("joint {} is not planned for", quoted(name)));
                return Err(match closest(name, group.names.iter().map(String::as_str)) {
                    Some(near) => error.help(format!("did you mean `{near}`?")),
                    None => error.help("delete the entry"),
                });
            }
            let one = |(j, name): (usize, &String)| match (values.get(name), usual) {
                (Some(value), _) => positive(&format!("{keys}.{name}"), *value),
                (None, Some(usual)) => Ok(usual[j]),
                (None, None) => Err(bodies
                    .error(&keys, format!("no limit for joint {}", quoted(name)))
                    .help("give one by joint for all of them, or one number")),
            };
            group.names.iter().enumerate().map(one).collect()
        }
    }
}
