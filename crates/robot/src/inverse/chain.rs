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

/// A joint on the way, which moves along or about its z axis by `multiplier · q[variable] + offset`
/// (mimics have their lead's).
#[derive(Clone, Debug)]
struct Moving {
    /// From the joint before to this one at 0.
    fixed: Pose,
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
                // The joint's frame is turned so that it moves along or about z.
                let (x, y) = axis.any_orthonormal_pair();
                let turned = Pose::new(Mat3::from_cols(x, y, axis), Vec3::ZERO);
                moving.push(Moving { fixed: fixed * turned, slides, variable, multiplier, offset });
                fixed = turned.inverse();
            }
        }
        Self { joints: kinematics.arm_joints, moving, last_from_tool: fixed }
    }

    /// `root_from_tool`, and into the first `joints` entries how it changes.
    pub fn tool(&self, q: &[f64], jacobian: &mut Jacobian) -> Pose {
        let mut at = Pose::IDENTITY;
        jacobian[..self.joints].fill((Vec3::ZERO, Vec3::ZERO));
        for joint in &self.moving {
            at = at * joint.fixed;
            let value = joint.multiplier * q[joint.variable] + joint.offset;
            let axis = at.rotation.z_axis;
            let direction = axis * joint.multiplier;
            let column = &mut jacobian[joint.variable];
            if joint.slides {
                at.translation += axis * value;
                column.0 += direction;
            } else {
                let (sin, cos) = value.sin_cos();
                let (x, y) = (at.rotation.x_axis, at.rotation.y_axis);
                (at.rotation.x_axis, at.rotation.y_axis) = (x * cos + y * sin, y * cos - x * sin);
                // The tool moves by `direction × (tool − origin)`; where the tool is shows at the end.
                column.0 -= direction.cross(at.translation);
                column.1 += direction;
            }
        }
        let tool = at * self.last_from_tool;
        for column in &mut jacobian[..self.joints] {
            column.0 += column.1.cross(tool.translation);
        }
        tool
    }
}
