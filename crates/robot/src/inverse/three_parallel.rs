//! Closed-form inverse kinematics for six turning joints of which the second, third and fourth
//! are parallel and the last two meet: UR3 to UR30, and any URDF of that build.
//!
//! The axes are read off the URDF at the zero posture (product of exponentials), so no table of
//! dimensions is needed. With h₂ the common direction: its component of the position gives q₁,
//! its component of the last axis q₅, then q₆, the sum q₂+q₃+q₄, q₃ by the law of cosines, q₂, q₄.

use super::Posture;
use super::subproblems::{TurnToHeight, meeting_point, turn_onto};
use crate::Robot;
use crate::kinematics::Kinematics;
use clearway_geometry::{Mat3, Pose, Vec3};

/// The arm's axes at the zero posture, in the root frame.
#[derive(Clone, Debug)]
pub struct ThreeParallel {
    /// Unit directions.
    axis: [Vec3; 6],
    /// +1 or −1: joints 3 and 4 against joint 2.
    sign: [f64; 2],
    /// From the root to axis 1, then from axis to axis; the last two share their point.
    step: [Vec3; 5],
    /// The tool seen from the point where the last two axes meet, at the zero posture.
    zero_tool: Pose,
}

impl ThreeParallel {
    /// The closed form for this arm, when it is built that way.
    pub fn of(robot: &Robot, kinematics: &Kinematics) -> Option<Self> {
        if kinematics.arm_joints != 6 || kinematics.moved_by_hand[kinematics.tool] {
            return None;
        }
        let mut frames = Vec::new();
        kinematics.frames(&[0.0; 6], 0.0, &mut frames);
        let mut axes = Vec::new();
        kinematics.axes(&frames, &mut axes);
        if axes.iter().any(|a| a.slides) || robot.arm.len() != 6 {
            return None;
        }
        let direction = |i: usize| axes[i].direction;
        let parallel = |a: Vec3, b: Vec3| a.cross(b).length() < 1e-6;
        if !parallel(direction(1), direction(2))
            || !parallel(direction(1), direction(3))
            || parallel(direction(0), direction(1))
        {
            return None;
        }
        let meeting = meeting_point(axes[4].origin, direction(4), axes[5].origin, direction(5), 1e-6)?;
        let axis: [Vec3; 6] = std::array::from_fn(direction);
        let sign = [axis[1].dot(axis[2]).signum(), axis[1].dot(axis[3]).signum()];
        let at = |i: usize| axes[i].origin;
        let step = [at(0), at(1) - at(0), at(2) - at(1), at(3) - at(2), meeting - at(3)];
        let tool = frames[kinematics.tool];
        let zero_tool = Pose::new(tool.rotation, tool.translation - meeting);
        Some(Self { axis, sign, step, zero_tool })
    }

    /// Up to eight postures, joints in (−2π, 2π), limits not considered.
    pub fn solve(&self, root_from_tool: &Pose) -> Vec<Posture> {
        let [h1, h2, _, _, h5, h6] = self.axis;
        let [p1, p12, p23, p34, p45] = self.step;
        // Rotation of the last link and position of the wrist's meeting point.
        let turned = root_from_tool.rotation * self.zero_tool.rotation.transpose();
        let wrist = root_from_tool.translation - turned * self.zero_tool.translation - p1;
        let mut found = Vec::with_capacity(8);
        let along = h2.dot(p12 + p23 + p34 + p45);
        // h₂ · rot(h₁, −q₁) wrist = along
        let Some(firsts) = TurnToHeight::new(h2, -h1, wrist).to(along) else { return found };
        for q1 in firsts.map(|turn| turn.angle()) {
            let back1 = Mat3::from_axis_angle(h1, -q1);
            let rest = back1 * turned;
            let Some(fifths) = TurnToHeight::new(h2, h5, h6).to(h2.dot(rest * h6)) else { continue };
            for q5 in fifths.map(|turn| turn.angle()) {
                let r5 = Mat3::from_axis_angle(h5, q5);
                let seen = r5.transpose() * h2;
                let q6 = turn_onto(-h6, seen, rest.transpose() * h2);
                let r6 = Mat3::from_axis_angle(h6, q6);
                let r234 = rest * r6.transpose() * r5.transpose();
                let across = h2.any_orthonormal_vector();
                let sum = turn_onto(h2, across, r234 * across);
                let reach = back1 * wrist - p12 - r234 * p45;
                let wanted = (reach.length_squared() - p23.length_squared() - p34.length_squared()) / 2.0;
                let Some(elbows) = TurnToHeight::new(p23, h2, p34).to(wanted) else { continue };
                for turn3 in elbows.map(|turn| turn.angle()) {
                    let bent = p23 + Mat3::from_axis_angle(h2, turn3) * p34;
                    let q2 = turn_onto(h2, bent, reach);
                    let turn4 = sum - q2 - turn3;
                    found.push(vec![q1, q2, self.sign[0] * turn3, self.sign[1] * turn4, q5, q6]);
                }
            }
        }
        found
    }
}
