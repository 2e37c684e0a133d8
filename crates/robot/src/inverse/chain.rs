//! The joints between the root and the tool, one after the other: all that inverse kinematics asks
//! of a robot, without the links beside the way.

use crate::kinematics::{Kinematics, Motion};
use clearway_geometry::{Mat3, Pose, Vec3};

/// Joints planned for; `description` allows no more.
const MOST: usize = 32;

/// By joint: how fast the tool moves and turns in the root frame when the joint does.
pub type Jacobian = [(Vec3, Vec3); MOST];

pub const NO_JACOBIAN: Jacobian = [(Vec3::ZERO, Vec3::ZERO); MOST];

#[derive(Clone, Debug)]
pub struct Chain {
    /// How many joints the arm has.
    pub joints: usize,
    moving: Vec<Moving>,
    last_from_tool: Pose,
}

/// A joint on the way, which moves by `multiplier · q[variable] + offset` (mimics have their lead's).
#[derive(Clone, Debug)]
struct Moving {
    /// From the joint before to this one at 0.
    fixed: Pose,
    axis: Vec3,
    slides: bool,
    variable: usize,
    multiplier: f64,
    offset: f64,
}

impl Chain {
    pub fn of(kinematics: &Kinematics) -> Self {
        let mut path = Vec::new();
        let mut link = kinematics.tool;
        while link != 0 {
            path.push(link);
            link = kinematics.steps[link].parent;
        }
        let mut moving = Vec::new();
        let mut fixed = Pose::IDENTITY;
        for step in path.iter().rev().map(|&link| &kinematics.steps[link]) {
            fixed = fixed * step.parent_from_joint;
            let (axis, source, slides) = match step.motion {
                Motion::Turn { axis, source } => (axis, source, false),
                Motion::Slide { axis, source } => (axis, source, true),
                Motion::Still => continue,
            };
            // What the hand's own joint moves stays where it is at 0.
            if source.variable < kinematics.arm_joints {
                let (variable, multiplier, offset) = (source.variable, source.multiplier, source.offset);
                moving.push(Moving { fixed, axis, slides, variable, multiplier, offset });
                fixed = Pose::IDENTITY;
            }
        }
        Self { joints: kinematics.arm_joints, moving, last_from_tool: fixed }
    }

    /// `root_from_tool`, and into the first `joints` entries how it changes.
    pub fn tool(&self, q: &[f64], jacobian: &mut Jacobian) -> Pose {
        let mut at = Pose::IDENTITY;
        let mut axes = [(Vec3::ZERO, Vec3::ZERO); MOST];
        for (joint, axis) in self.moving.iter().zip(&mut axes) {
            at = at * joint.fixed;
            let value = joint.multiplier * q[joint.variable] + joint.offset;
            *axis = (at.translation, at.rotation * joint.axis);
            if joint.slides {
                at.translation += axis.1 * value;
            } else {
                at.rotation *= Mat3::from_axis_angle(joint.axis, value);
            }
        }
        let tool = at * self.last_from_tool;
        jacobian[..self.joints].fill((Vec3::ZERO, Vec3::ZERO));
        for (joint, (origin, direction)) in self.moving.iter().zip(axes) {
            let direction = direction * joint.multiplier;
            let column = &mut jacobian[joint.variable];
            if joint.slides {
                column.0 += direction;
            } else {
                column.0 += direction.cross(tool.translation - origin);
                column.1 += direction;
            }
        }
        tool
    }
}
