//! Joints by other names: drivers put a prefix before them, or call another make of arm's the same way.

use crate::ExportError;
use clearway_plan::PlanFile;
use std::collections::HashSet;

/// Joints whose names begin with `old` begin with `new` instead, in the rows and for the gripper; an empty `old`
/// puts `new` before all names. The URDF stays as it is, so this is not for exports that carry it.
pub fn rename_joints(plan: &mut PlanFile, old: &str, new: &str) -> Result<(), ExportError> {
    let mut found = false;
    let mut renamed = |name: &str| match name.strip_prefix(old) {
        Some(rest) => {
            found = true;
            format!("{new}{rest}")
        }
        None => name.to_owned(),
    };
    let robot = &mut plan.robot;
    for name in robot.joints.iter_mut().chain(&mut robot.hand.joint) {
        *name = renamed(name);
    }
    let distinct: HashSet<&String> = robot.joints.iter().chain(&robot.hand.joint).collect();
    if distinct.len() < robot.joints.len() + usize::from(robot.hand.joint.is_some()) {
        return Err(ExportError::SameName { old: old.to_owned(), new: new.to_owned() });
    }
    for segment in plan.steps.iter_mut().flat_map(|step| &mut step.segments) {
        let gripper = std::mem::take(&mut segment.gripper);
        segment.gripper = gripper.into_iter().map(|(name, value)| (renamed(&name), value)).collect();
    }
    if found { Ok(()) } else { Err(ExportError::NoSuchName { old: old.to_owned() }) }
}
