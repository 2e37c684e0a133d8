//! Closed-form inverse kinematics for seven turning joints of which the first three meet in a point,
//! the shoulder, and the fifth and sixth in another, the wrist: Panda, FR3, xArm 7, iiwa, and any
//! URDF of that build. The elbow's and the last joint's axes may lie beside those points.
//!
//! The arm has one joint more than a pose needs; a value for the last joint leaves up to eight
//! postures. (He and Liu 2021 solve the Panda so, from its table of dimensions; here the axes are read
//! off the URDF at the zero posture.) With q₇ the sixth link is known, so the wrist's place and the
//! direction of axis 6. The distance from shoulder to wrist gives q₄. What is between then only turns
//! about the line through both, until axes 5 and 6 are at their angle: two ways. The rest is read off:
//! q₅ and q₆ at the wrist, q₂ twice and q₁, q₃ at the shoulder.
//!
//! An arm of which the last three meet, a spherical wrist, and the second and third, like PR2's, is the
//! same chain seen from the tool. With T = e^(ξ₁q₁) … e^(ξ₇q₇) M, the root as the tool sees it is
//! T⁻¹ = e^(−ξ₇′q₇) … e^(−ξ₁′q₁) M⁻¹, where ξ′ are the axes in the tool's frame at the zero posture: the
//! joints in reverse, each about the opposite direction. What is swept is then the first joint.

use super::subproblems::{Range, Turn, TurnToHeight, meeting_point, turn_onto};
use crate::Robot;
use crate::kinematics::Kinematics;
use clearway_geometry::{Mat3, Pose, Vec3};
use std::f64::consts::PI;

/// Axes that pass each other by no more than this meet, metres: URDFs round their angles. What is
/// missed by that is mended afterwards.
const MEET: f64 = 2e-5;

/// The chain's axes at the zero posture, from the end where the shoulder is: in the root frame or,
/// `reversed`, in the tool's.
#[derive(Clone, Debug)]
pub struct SphericalShoulder {
    /// The chain is the arm's seen from its tool: what is the shoulder here is the arm's spherical wrist.
    reversed: bool,
    /// Unit directions.
    axis: [Vec3; 7],
    /// Unit vectors across axes 3 and 6.
    across: [Vec3; 2],
    shoulder: Vec3,
    /// From the shoulder to a point of axis 4, from there to the wrist, from there to one of axis 7.
    step: [Vec3; 3],
    /// The far end's frame, the tool's or, `reversed`, the root's, seen from that point.
    zero_end: Pose,
    ranges: [Range; 7],
    /// How joint 4 sets the distance from shoulder to wrist, and joint 2 the height of axis 3 along axis 1.
    fourth: TurnToHeight,
    second: TurnToHeight,
}

/// Where the far end is to be.
#[derive(Clone, Copy, Debug)]
pub struct Wanted {
    /// The last link's rotation from the zero posture.
    turned: Mat3,
    /// From the shoulder to the point of axis 7.
    last: Vec3,
}

/// A value of the swept joint; the rest as the last link sees it.
#[derive(Clone, Copy, Debug)]
pub struct Swept {
    pub value: f64,
    to_last: Vec3,
    axis6: Vec3,
    across6: Vec3,
}

/// A joint's axis: a point of it and its unit direction.
#[derive(Clone, Copy)]
struct Axis {
    origin: Vec3,
    direction: Vec3,
}

impl SphericalShoulder {
    /// The closed form for this arm, when it is built that way. One that is so from either end is seen
    /// from its root.
    pub fn of(robot: &Robot, kinematics: &Kinematics) -> Option<Self> {
        if kinematics.arm_joints != 7 || kinematics.moved_by_hand[kinematics.tool] {
            return None;
        }
        let (mut frames, mut axes) = (Vec::new(), Vec::new());
        kinematics.frames(&[0.0; 7], 0.0, &mut frames);
        kinematics.axes(&frames, &mut axes);
        if axes.iter().any(|a| a.slides) {
            return None;
        }
        let tool = frames[kinematics.tool];
        let axes: [Axis; 7] = std::array::from_fn(|i| Axis { origin: axes[i].origin, direction: axes[i].direction });
        let mut ranges: [Range; 7] = std::array::from_fn(|i| Range::new(robot.lower[i], robot.upper[i]));
        Self::from_shoulder(&axes, tool, ranges, false).or_else(|| {
            let back = tool.inverse();
            let seen = |a: Axis| Axis { origin: back.point(a.origin), direction: -(back.rotation * a.direction) };
            let mut axes = axes.map(seen);
            axes.reverse();
            ranges.reverse();
            Self::from_shoulder(&axes, back, ranges, true)
        })
    }

    /// Out of the axes, the first next to the shoulder, and the frame at the far end, at the zero posture.
    fn from_shoulder(axes: &[Axis; 7], end: Pose, ranges: [Range; 7], reversed: bool) -> Option<Self> {
        let meet = |i: usize, j: usize| {
            meeting_point(axes[i].origin, axes[i].direction, axes[j].origin, axes[j].direction, MEET)
        };
        let (shoulder, wrist) = (meet(0, 1)?, meet(4, 5)?);
        if (shoulder - axes[2].origin).cross(axes[2].direction).length() > MEET {
            return None;
        }
        let axis = axes.map(|a| a.direction);
        let (elbow, last) = (axes[3].origin, axes[6].origin);
        Some(Self {
            reversed,
            axis,
            across: [axis[2].any_orthonormal_vector(), axis[5].any_orthonormal_vector()],
            shoulder,
            step: [elbow - shoulder, wrist - elbow, last - wrist],
            zero_end: Pose::new(end.rotation, end.translation - last),
            ranges,
            fourth: TurnToHeight::new(elbow - shoulder, axis[3], wrist - elbow),
            second: TurnToHeight::new(axis[0], axis[1], axis[2]),
        })
    }

    /// Whether it is the arm's wrist that is spherical, and not its shoulder.
    pub fn at_wrist(&self) -> bool {
        self.reversed
    }

    /// The joint of whose values each leaves a few postures: the last or, with a spherical wrist, the first.
    pub fn swept(&self) -> usize {
        if self.reversed { 0 } else { 6 }
    }

    /// Whether the last joint turns the tool about its z axis, and is the one that is swept.
    pub fn turns_end_about_z(&self) -> bool {
        let end = &self.zero_end;
        let along = |v: Vec3| v.cross(self.axis[6]).length() < 1e-6;
        !self.reversed && along(end.rotation.z_axis) && along(end.translation)
    }

    /// The values of the swept joint at which shoulder and wrist are nearest to each other, and farthest.
    pub fn extremes(&self, wanted: &Wanted) -> [f64; 2] {
        let nearest = -turn_onto(self.axis[6], self.step[2], wanted.turned.transpose() * wanted.last);
        [nearest, if nearest > 0.0 { nearest - PI } else { nearest + PI }]
    }

    pub fn wanted(&self, root_from_tool: &Pose) -> Wanted {
        let end = if self.reversed { root_from_tool.inverse() } else { *root_from_tool };
        let turned = end.rotation * self.zero_end.rotation.transpose();
        Wanted { turned, last: end.translation - turned * self.zero_end.translation - self.shoulder }
    }

    pub fn at(&self, value: f64) -> Swept {
        let back = Mat3::from_axis_angle(self.axis[6], -value);
        Swept { value, to_last: back * self.step[2], axis6: back * self.axis[5], across6: back * self.across[1] }
    }

    /// Hands `each` the postures, up to eight, that have this value in the swept joint and whose others are
    /// within the joints' limits but for whole turns. None where a whole circle of them is.
    pub fn solve_at(&self, wanted: &Wanted, swept: &Swept, mut each: impl FnMut([f64; 7])) {
        if self.reversed {
            self.solve_from_shoulder(wanted, swept, |mut q| {
                q.reverse();
                each(q);
            });
        } else {
            self.solve_from_shoulder(wanted, swept, each);
        }
    }

    /// The same with joints counted from the shoulder.
    fn solve_from_shoulder(&self, wanted: &Wanted, swept: &Swept, mut each: impl FnMut([f64; 7])) {
        let [h1, _, h3, _, h5, h6, _] = self.axis;
        let [to_elbow, to_wrist, _] = self.step;
        // From the shoulder to the wrist.
        let reach = wanted.last - wanted.turned * swept.to_last;
        let squared = reach.length_squared();
        if squared < 1e-18 {
            return;
        }
        let Some(fourths) = self.fourth.to((squared - to_elbow.length_squared() - to_wrist.length_squared()) / 2.0)
        else {
            return;
        };
        let distance = squared.sqrt();
        let line = reach / distance;
        let axis6 = wanted.turned * swept.axis6;
        // Axis 6 against the line from shoulder to wrist: along it, and across it.
        let along6 = axis6.dot(line);
        let across6 = axis6 - line * along6;
        for fourth in fourths.into_iter().filter(|turn| self.ranges[3].holds(turn)) {
            // The same line and axis 5, as the third link sees them.
            let seen = (to_elbow + fourth.forth(to_wrist)) / distance;
            let axis5 = fourth.forth(h5);
            let along5 = axis5.dot(seen);
            let across5 = axis5 - seen * along5;
            let sizes = across5.length() * across6.length();
            let cosine = (h5.dot(h6) - along5 * along6) / sizes;
            if sizes < 1e-9 || cosine.abs() > 1.0 + 1e-9 {
                continue;
            }
            let sine = (1.0 - cosine * cosine).max(0.0).sqrt();
            let third_from_line = frame(seen, across5).transpose();
            let (u, v) = (across6.normalize(), line.cross(across6).normalize());
            let across6 = wanted.turned * swept.across6;
            for sine in [sine, -sine] {
                let third = frame(line, u * cosine + v * sine) * third_from_line;
                let third_back = third.transpose();
                let fifth = Turn::onto(h5, h6, fourth.back(third_back * axis6));
                if !self.ranges[4].holds(&fifth) {
                    continue;
                }
                let sixth = Turn::onto(h6, self.across[1], fifth.back(fourth.back(third_back * across6)));
                if !self.ranges[5].holds(&sixth) {
                    continue;
                }
                let axis3 = third * h3;
                let across3 = third * self.across[0];
                let Some(seconds) = self.second.to(h1.dot(axis3)) else { continue };
                for second in seconds.into_iter().filter(|turn| self.ranges[1].holds(turn)) {
                    let first = Turn::onto(h1, second.forth(h3), axis3);
                    if !self.ranges[0].holds(&first) {
                        continue;
                    }
                    let third = Turn::onto(h3, self.across[0], second.back(first.back(across3)));
                    if self.ranges[2].holds(&third) {
                        let [q1, q2, q3, q4, q5, q6] =
                            [first, second, third, fourth, fifth, sixth].map(|turn| turn.angle());
                        each([q1, q2, q3, q4, q5, q6, swept.value]);
                    }
                }
            }
        }
    }
}

/// The right-handed frame with x along `x`, of unit length, and y along `y`, across it.
fn frame(x: Vec3, y: Vec3) -> Mat3 {
    let y = y.normalize();
    Mat3::from_cols(x, y, x.cross(y))
}
