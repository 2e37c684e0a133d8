//! Structure, names: the plan's joints, links and tool against its URDF.

use crate::model::{JointKind, Model};
use crate::report::{Report, ViolationKind};
use clearway_plan::PlanFile;
use std::collections::BTreeSet;

/// The plan's names as indices into the model.
pub(crate) struct Names {
    /// The joint of each column.
    pub columns: Vec<usize>,
    /// Joints that `gripper` gives.
    pub gripper: Vec<usize>,
    /// Joint values where neither rows nor gripper say otherwise.
    pub fixed: Vec<f64>,
    /// By link: listed in `hand.links`.
    pub in_hand: Vec<bool>,
    /// Pairs of links, the smaller index first.
    pub unchecked: BTreeSet<(usize, usize)>,
}

/// `None` when rows cannot be understood; the report says why.
pub(crate) fn resolve(plan: &PlanFile, model: &Model, report: &mut Report) -> Option<Names> {
    let before = report.violations.len();
    let mut bad = |what: String| report.plan(ViolationKind::Joints, what);
    let robot = &plan.robot;
    let mut columns = Vec::new();
    for (i, name) in robot.joints.iter().enumerate() {
        match leading_joint(model, name) {
            Ok(_) if robot.joints[..i].contains(name) => bad(format!("robot.joints names {name} twice")),
            Ok(joint) => columns.push(joint),
            Err(why) => bad(format!("robot.joints names {name}, {why}")),
        }
    }
    let mut gripper_names: BTreeSet<&String> = robot.hand.joint.iter().collect();
    gripper_names.extend(plan.steps.iter().flat_map(|s| &s.segments).flat_map(|s| s.gripper.keys()));
    let mut gripper = Vec::new();
    for name in gripper_names {
        match leading_joint(model, name) {
            Ok(joint) if columns.contains(&joint) => {
                bad(format!("the gripper's joint {name} is also one of robot.joints"))
            }
            // A hand's joint may have a resting value; segments say otherwise.
            Ok(_) if robot.fixed.contains_key(name) && robot.hand.joint.as_ref() != Some(name) => {
                bad(format!("{name} is given as gripper and as fixed"));
            }
            Ok(joint) => gripper.push(joint),
            Err(why) => bad(format!("the gripper's joint is {name}, {why}")),
        }
    }
    let mut fixed = vec![0.0; model.joints.len()];
    for (name, value) in &robot.fixed {
        match leading_joint(model, name) {
            Ok(joint) if columns.contains(&joint) => bad(format!("{name} is one of robot.joints and fixed")),
            Ok(_) if !value.is_finite() => bad(format!("{name} is fixed at {value}; expected a finite number")),
            Ok(joint) => fixed[joint] = *value,
            Err(why) => bad(format!("robot.fixed names {name}, {why}")),
        }
    }
    for (i, joint) in model.joints.iter().enumerate() {
        let free = joint.moves() && joint.mimic.is_none();
        if free && !columns.contains(&i) && !gripper.contains(&i) && !robot.fixed.contains_key(&joint.name) {
            bad(format!("joint {} is neither in robot.joints nor in robot.fixed, nor the gripper's", joint.name));
        }
    }
    let mut in_hand = vec![false; model.links.len()];
    for name in &robot.hand.links {
        match model.link(name) {
            Some(link) => in_hand[link] = true,
            None => bad(format!("hand.links names {name}, a link that the URDF does not have")),
        }
    }
    for (what, name) in [("robot.tool", &robot.tool), ("hand.frame", &robot.hand.frame)] {
        if model.link(name).is_none() {
            bad(format!("{what} is {name:?}, a link that the URDF does not have"));
        }
    }
    let mut unchecked = BTreeSet::new();
    for [a, b] in &robot.unchecked_pairs {
        match (model.link(a), model.link(b)) {
            (Some(a), Some(b)) => {
                unchecked.insert((a.min(b), a.max(b)));
            }
            _ => bad(format!("unchecked_pairs names {a} and {b}; the URDF does not have both")),
        }
    }
    (report.violations.len() == before).then_some(Names { columns, gripper, fixed, in_hand, unchecked })
}

/// A joint that moves and mimics no other; or why it is none, as the end of a sentence.
fn leading_joint(model: &Model, name: &str) -> Result<usize, &'static str> {
    let joint = model.joint(name).ok_or("which the URDF does not have")?;
    match &model.joints[joint] {
        j if j.kind == JointKind::Fixed => Err("which is fixed in the URDF"),
        j if j.mimic.is_some() => Err("which mimics another joint"),
        _ => Ok(joint),
    }
}
