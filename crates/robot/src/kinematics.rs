//! Forward kinematics: where every link is, for a posture of the arm and an opening of the hand.
//!
//! Frames are given in the URDF's root link. The tree is flattened once; a call costs one
//! rotation and one product of transforms per moving link, and allocates nothing.

use crate::description::{Joint, JointKind, Link, Robot};
use clearway_geometry::{Mat3, Pose, Vec3};
use std::collections::BTreeMap;

/// What moves a joint: `value = multiplier · variable + offset`. Variables are the arm's joints
/// in order, then the hand's.
#[derive(Clone, Copy, Debug)]
pub struct Source {
    pub variable: usize,
    pub multiplier: f64,
    pub offset: f64,
}

/// What a joint does, its axis in the joint's frame.
#[derive(Clone, Copy, Debug)]
pub enum Motion {
    Still,
    Turn { axis: Vec3, source: Source },
    Slide { axis: Vec3, source: Source },
}

/// How a link hangs from its parent.
#[derive(Clone, Debug)]
pub struct LinkStep {
    pub parent: usize,
    /// Fixed part; joints held at a value are folded into it.
    pub parent_from_joint: Pose,
    pub motion: Motion,
}

/// A tree of links, and which of its joints are variables.
#[derive(Clone, Copy, Debug)]
pub struct Tree<'a> {
    pub links: &'a [Link],
    pub joints: &'a [Joint],
    /// Indices into `joints`: the variables, in order.
    pub arm: &'a [usize],
    /// One more variable, the hand's.
    pub hand_joint: Option<usize>,
    /// Where the other joints are held; 0 where nothing is said.
    pub fixed: &'a BTreeMap<String, f64>,
    /// The link whose frame is the tool.
    pub tool: usize,
}

/// A robot's tree, flattened for speed.
#[derive(Clone, Debug)]
pub struct Kinematics {
    pub(crate) steps: Vec<LinkStep>,
    /// How many joints the arm has.
    pub arm_joints: usize,
    /// The link whose frame is the tool.
    pub tool: usize,
    /// By link: which arm joints move it, as a bit mask.
    pub moved_by: Vec<u64>,
    /// By link: whether the hand's joint moves it against the tool.
    pub moved_by_hand: Vec<bool>,
}

/// One arm joint in the root frame at some posture.
#[derive(Clone, Copy, Debug)]
pub struct JointAxis {
    pub origin: Vec3,
    pub direction: Vec3,
    pub slides: bool,
}

impl Kinematics {
    pub fn new(robot: &Robot) -> Self {
        Self::of(&Tree {
            links: &robot.links,
            joints: &robot.joints,
            arm: &robot.arm,
            hand_joint: robot.hand.joint,
            fixed: &robot.fixed,
            tool: robot.hand.frame,
        })
    }

    pub fn of(robot: &Tree) -> Self {
        let arm_joints = robot.arm.len();
        let mut steps = Vec::with_capacity(robot.links.len());
        let mut moved_by = vec![0u64; robot.links.len()];
        let mut moved_by_hand = vec![false; robot.links.len()];
        for (index, link) in robot.links.iter().enumerate() {
            let Some(joint_index) = link.parent_joint else {
                steps.push(LinkStep { parent: index, parent_from_joint: Pose::IDENTITY, motion: Motion::Still });
                continue;
            };
            let joint = &robot.joints[joint_index];
            moved_by[index] = moved_by[joint.parent];
            moved_by_hand[index] = moved_by_hand[joint.parent];
            let (leader, multiplier, offset) = lead(robot.joints, joint_index);
            let variable = robot
                .arm
                .iter()
                .position(|&j| j == leader)
                .or_else(|| (robot.hand_joint == Some(leader)).then_some(arm_joints));
            let mut parent_from_joint = joint.parent_from_joint;
            let motion = match (joint.kind, variable) {
                (JointKind::Fixed, _) => Motion::Still,
                (kind, Some(variable)) => {
                    if variable == arm_joints {
                        moved_by_hand[index] = true;
                    } else {
                        moved_by[index] |= 1 << variable;
                    }
                    let source = Source { variable, multiplier, offset };
                    match kind {
                        JointKind::Prismatic => Motion::Slide { axis: joint.axis, source },
                        _ => Motion::Turn { axis: joint.axis, source },
                    }
                }
                (kind, None) => {
                    let held = robot.fixed.get(&robot.joints[leader].name).copied().unwrap_or(0.0);
                    let value = multiplier * held + offset;
                    parent_from_joint = parent_from_joint
                        * match kind {
                            JointKind::Prismatic => Pose::from_translation(joint.axis * value),
                            _ => Pose::new(Mat3::from_axis_angle(joint.axis, value), Vec3::ZERO),
                        };
                    Motion::Still
                }
            };
            steps.push(LinkStep { parent: joint.parent, parent_from_joint, motion });
        }
        Self { steps, arm_joints, tool: robot.tool, moved_by, moved_by_hand }
    }

    /// Whether no joint moves a link.
    pub fn is_still(&self, link: usize) -> bool {
        self.moved_by[link] == 0 && !self.moved_by_hand[link]
    }

    /// One more link, the last, that does not move against `parent`.
    pub fn add_fixed(&mut self, parent: usize, parent_from_link: Pose) {
        self.steps.push(LinkStep { parent, parent_from_joint: parent_from_link, motion: Motion::Still });
        self.moved_by.push(self.moved_by[parent]);
        self.moved_by_hand.push(self.moved_by_hand[parent]);
    }

    /// By link: how it hangs from its parent; parents before children, the root's entry is not used.
    pub fn steps(&self) -> &[LinkStep] {
        &self.steps
    }

    /// Writes the frame of every link, `root_from_link`, into `frames`.
    #[inline]
    pub fn frames(&self, posture: &[f64], hand: f64, frames: &mut Vec<Pose>) {
        frames.clear();
        frames.reserve(self.steps.len());
        for (index, step) in self.steps.iter().enumerate() {
            if index == 0 {
                frames.push(Pose::IDENTITY);
                continue;
            }
            let joint = frames[step.parent] * step.parent_from_joint;
            let value = |s: &Source| s.multiplier * posture.get(s.variable).copied().unwrap_or(hand) + s.offset;
            frames.push(match &step.motion {
                Motion::Still => joint,
                Motion::Turn { axis, source } => {
                    Pose::new(joint.rotation * Mat3::from_axis_angle(*axis, value(source)), joint.translation)
                }
                Motion::Slide { axis, source } => Pose::new(joint.rotation, joint.point(*axis * value(source))),
            });
        }
    }

    /// `ancestor_from_link`: one link's place alone, seen from a link above it or itself.
    pub fn seen_from(&self, ancestor: usize, link: usize, posture: &[f64], hand: f64) -> Pose {
        let mut pose = Pose::IDENTITY;
        let mut at = link;
        while at != ancestor && at != 0 {
            let step = &self.steps[at];
            let value = |s: &Source| s.multiplier * posture.get(s.variable).copied().unwrap_or(hand) + s.offset;
            let moved = match &step.motion {
                Motion::Still => pose,
                Motion::Turn { axis, source } => {
                    Pose::new(Mat3::from_axis_angle(*axis, value(source)), Vec3::ZERO) * pose
                }
                Motion::Slide { axis, source } => Pose::new(pose.rotation, pose.translation + *axis * value(source)),
            };
            pose = step.parent_from_joint * moved;
            at = step.parent;
        }
        pose
    }

    /// `root_from_tool`.
    pub fn tool(&self, posture: &[f64], hand: f64) -> Pose {
        let mut frames = Vec::new();
        self.frames(posture, hand, &mut frames);
        frames[self.tool]
    }

    /// The arm joints' axes, in the root frame, out of the frames of a posture.
    pub fn axes(&self, frames: &[Pose], out: &mut Vec<JointAxis>) {
        out.clear();
        out.resize(self.arm_joints, JointAxis { origin: Vec3::ZERO, direction: Vec3::Z, slides: false });
        for (index, step) in self.steps.iter().enumerate() {
            let (axis, source, slides) = match step.motion {
                Motion::Turn { axis, source } => (axis, source, false),
                Motion::Slide { axis, source } => (axis, source, true),
                Motion::Still => continue,
            };
            // A joint's own link, not those that mimic it.
            if source.variable < self.arm_joints && source.multiplier == 1.0 && source.offset == 0.0 {
                out[source.variable] =
                    JointAxis { origin: frames[index].translation, direction: frames[index].rotation * axis, slides };
            }
        }
    }
}

/// The joint that leads `joint` through its chain of mimics, with `value = multiplier · lead + offset`.
fn lead(joints: &[Joint], joint: usize) -> (usize, f64, f64) {
    let (mut at, mut multiplier, mut offset) = (joint, 1.0, 0.0);
    while let Some(mimic) = &joints[at].mimic {
        offset += multiplier * mimic.offset;
        multiplier *= mimic.multiplier;
        at = mimic.joint;
    }
    (at, multiplier, offset)
}
