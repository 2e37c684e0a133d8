//! The robot as a tree of links: forward kinematics, written afresh for the verifier.
//!
//! Links come parents first, link 0 is the root. A posture is one value per joint (radians or
//! metres; 0 for fixed joints), mimic joints included: [`Model::follow`] fills those in.
//! One pass over the tree takes a microsecond or two for an arm with a hand.

use crate::shapes::Piece;
use parry3d_f64::math::{Pose, Rotation, Vector};

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum JointKind {
    Fixed,
    Revolute,
    Continuous,
    Prismatic,
}

/// value = multiplier · value of `joint` + offset.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Mimic {
    pub joint: usize,
    pub multiplier: f64,
    pub offset: f64,
}

pub(crate) struct Joint {
    pub name: String,
    pub kind: JointKind,
    /// Links.
    pub parent: usize,
    pub child: usize,
    pub parent_from_joint: Pose,
    /// Unit length, in the joint's frame.
    pub axis: Vector,
    /// Of a revolute or prismatic joint.
    pub range: Option<(f64, f64)>,
    /// rad/s or m/s, where the URDF gives a positive one.
    pub velocity: Option<f64>,
    pub mimic: Option<Mimic>,
}

impl Joint {
    pub fn moves(&self) -> bool {
        self.kind != JointKind::Fixed
    }
}

pub(crate) struct Link {
    pub name: String,
    /// The joint above; `None` for the root.
    pub joint: Option<usize>,
    pub pieces: Vec<Piece>,
}

pub(crate) struct Model {
    pub links: Vec<Link>,
    pub joints: Vec<Joint>,
}

impl Model {
    pub fn link(&self, name: &str) -> Option<usize> {
        self.links.iter().position(|l| l.name == name)
    }

    pub fn joint(&self, name: &str) -> Option<usize> {
        self.joints.iter().position(|j| j.name == name)
    }

    pub fn parent(&self, link: usize) -> Option<usize> {
        self.links[link].joint.map(|j| self.joints[j].parent)
    }

    /// Gives every mimic joint its value. Mimics of mimics were resolved on reading.
    pub fn follow(&self, posture: &mut [f64]) {
        for (i, joint) in self.joints.iter().enumerate() {
            if let Some(m) = joint.mimic {
                posture[i] = m.multiplier * posture[m.joint] + m.offset;
            }
        }
    }

    /// Every link's pose in the world.
    pub fn link_poses(&self, world_from_root: &Pose, posture: &[f64], poses: &mut Vec<Pose>) {
        poses.clear();
        poses.push(*world_from_root);
        for link in &self.links[1..] {
            let Some(j) = link.joint else { continue };
            let joint = &self.joints[j];
            let moved = match joint.kind {
                JointKind::Fixed => joint.parent_from_joint,
                JointKind::Prismatic => joint.parent_from_joint * Pose::from_translation(joint.axis * posture[j]),
                JointKind::Revolute | JointKind::Continuous => {
                    joint.parent_from_joint * Pose::from_rotation(Rotation::from_axis_angle(joint.axis, posture[j]))
                }
            };
            poses.push(poses[joint.parent] * moved);
        }
    }

    /// The moving joints above a link, nearest first.
    pub fn moving_joints_above(&self, link: usize) -> Vec<usize> {
        let mut above = Vec::new();
        let mut at = link;
        while let Some(j) = self.links[at].joint {
            if self.joints[j].moves() {
                above.push(j);
            }
            at = self.joints[j].parent;
        }
        above
    }

    /// Whether two links count as adjacent: a joint joins them; or no moving joint lies between
    /// them; or every link between them has no shape and at most one joint between them moves.
    pub fn adjacent(&self, a: usize, b: usize) -> bool {
        let up = |from: usize| std::iter::successors(Some(from), |l| self.parent(*l)).collect::<Vec<_>>();
        let (above_a, above_b) = (up(a), up(b));
        let Some(meet) = above_a.iter().find(|l| above_b.contains(l)) else { return false };
        let side = |path: &[usize]| path.iter().copied().take_while(|l| l != meet).collect::<Vec<_>>();
        let (side_a, side_b) = (side(&above_a), side(&above_b));
        let joints: Vec<usize> = side_a.iter().chain(&side_b).filter_map(|l| self.links[*l].joint).collect();
        let moving = joints.iter().filter(|j| self.joints[**j].moves()).count();
        let between = side_a.iter().chain(&side_b).chain([meet]).filter(|l| **l != a && **l != b);
        joints.len() <= 1 || moving == 0 || (moving == 1 && between.into_iter().all(|l| self.links[*l].pieces.is_empty()))
    }

    /// The root, and links fixed to it as long as those above have no shape: what is mounted.
    pub fn mounted(&self, link: usize) -> bool {
        let mut at = link;
        while let Some(j) = self.links[at].joint {
            let parent = self.joints[j].parent;
            if self.joints[j].moves() || !self.links[parent].pieces.is_empty() {
                return false;
            }
            at = parent;
        }
        true
    }
}
