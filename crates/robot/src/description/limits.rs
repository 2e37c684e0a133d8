//! What is known of each joint: the arm's home and limits, and the values of the joints held still.

use super::load::Context;
use super::model::JointKind;
use clearway_files::{FileError, quoted};
use clearway_plan::robot_file::{Limits, Mobile, PerJoint};
use std::collections::BTreeMap;

/// One entry per joint of the arm.
pub struct PerArmJoint {
    pub home: Vec<f64>,
    pub acceleration: Vec<f64>,
    pub jerk: Vec<f64>,
    pub velocity: Vec<f64>,
    pub lower: Vec<f64>,
    pub upper: Vec<f64>,
}

impl PerArmJoint {
    pub fn check(context: &Context, arm: &[usize]) -> Result<Self, FileError> {
        let file = &context.file.value;
        let joints = &context.model.joints;
        for (name, &value) in &file.home {
            let joint = context.joint(&["home", name], name)?;
            if !arm.contains(&joint) {
                return Err(context
                    .file
                    .error(&["home", name], format!("joint {} is not one of the arm's", quoted(name)))
                    .help("joints outside the arm get their values under `fixed`"));
            }
            context.within(&["home", name], joint, value)?;
        }
        let mut velocity: Vec<f64> = Vec::with_capacity(arm.len());
        for (i, &j) in arm.iter().enumerate() {
            let of_base = match &file.mobile {
                Mobile::Planar { velocity, .. } => velocity.get(i).copied(),
                Mobile::None => None,
            };
            let value = of_base.unwrap_or(joints[j].velocity);
            if !(value > 0.0 && value.is_finite()) {
                let found = if value == f64::INFINITY {
                    "no velocity limit".to_owned()
                } else {
                    format!("the velocity limit {value}")
                };
                return Err(context
                    .joint_error(j, "limit", format!("joint {} of the arm has {found}", quoted(&joints[j].name)))
                    .expected("a number greater than 0, in rad/s or m/s")
                    .help("write it into the joint's <limit>: `velocity=\"…\"`"));
            }
            velocity.push(value);
        }
        let default = Limits::default();
        Ok(Self {
            home: arm.iter().map(|&j| file.home.get(&joints[j].name).copied().unwrap_or(joints[j].rest())).collect(),
            acceleration: per_joint(context, arm, "acceleration", &file.limits.acceleration, &default.acceleration)?,
            jerk: per_joint(context, arm, "jerk", &file.limits.jerk, &default.jerk)?,
            velocity,
            lower: arm.iter().map(|&j| joints[j].lower).collect(),
            upper: arm.iter().map(|&j| joints[j].upper).collect(),
        })
    }
}

/// One value for all joints, or one by joint, those not named getting the default.
fn per_joint(
    context: &Context,
    arm: &[usize],
    key: &str,
    given: &PerJoint,
    default: &PerJoint,
) -> Result<Vec<f64>, FileError> {
    let positive = |keys: &[&str], value: f64| {
        if value > 0.0 && value.is_finite() {
            Ok(())
        } else {
            Err(context.file.error(keys, format!("the limit {value}")).expected("a number greater than 0"))
        }
    };
    match given {
        PerJoint::All(value) => {
            positive(&["limits", key], *value)?;
            Ok(vec![*value; arm.len()])
        }
        PerJoint::ByJoint(values) => {
            for (name, &value) in values {
                let joint = context.joint(&["limits", key, name], name)?;
                if !arm.contains(&joint) {
                    return Err(context
                        .file
                        .error(&["limits", key, name], format!("joint {} is not one of the arm's", quoted(name)))
                        .help("delete the entry: only the arm's joints are timed"));
                }
                positive(&["limits", key, name], value)?;
            }
            let usual = match default {
                PerJoint::All(value) => *value,
                PerJoint::ByJoint(_) => f64::NAN,
            };
            Ok(arm.iter().map(|&j| values.get(&context.model.joints[j].name).copied().unwrap_or(usual)).collect())
        }
    }
}

impl Context<'_> {
    /// The joints that stand still while planning, and their values.
    pub fn fixed(&self, arm: &[usize], hand: Option<usize>) -> Result<BTreeMap<String, f64>, FileError> {
        let given = &self.file.value.fixed;
        let joints = &self.model.joints;
        for (name, &value) in given {
            let keys = ["fixed", name.as_str()];
            let joint = self.joint(&keys, name)?;
            let wrong =
                |why: &str, help: &str| Err(self.file.error(&keys, format!("joint {} {why}", quoted(name))).help(help));
            if arm.contains(&joint) {
                return wrong("is one of the arm's", "give its resting value under `home`");
            }
            if hand == Some(joint) {
                return wrong("opens the hand", "delete the entry: it opens and closes as planned");
            }
            if joints[joint].mimic.is_some() {
                return wrong("follows another", "give the value of the joint that it mimics");
            }
            if !joints[joint].moves() {
                return wrong("does not move", "delete the entry");
            }
            self.within(&keys, joint, value)?;
        }
        let still = (0..joints.len())
            .filter(|&j| joints[j].moves() && joints[j].mimic.is_none() && !arm.contains(&j) && hand != Some(j));
        Ok(still
            .map(|j| (joints[j].name.clone(), given.get(&joints[j].name).copied().unwrap_or(joints[j].rest())))
            .collect())
    }

    /// Whether a value that the robot file gives at `keys` is within the joint's limits.
    pub fn within(&self, keys: &[&str], joint: usize, value: f64) -> Result<(), FileError> {
        let joint = &self.model.joints[joint];
        if !value.is_finite() {
            return Err(self
                .file
                .error(keys, format!("{value} for joint {}", quoted(&joint.name)))
                .expected("a finite number"));
        }
        if joint.allows(value) {
            return Ok(());
        }
        let unit = if joint.kind == JointKind::Prismatic { "metres" } else { "radians" };
        Err(self
            .file
            .error(keys, format!("{value} for joint {}", quoted(&joint.name)))
            .expected(format!("a value within its limits, {} to {} {unit}", joint.lower, joint.upper)))
    }
}
