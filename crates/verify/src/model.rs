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
        joints.len() <= 1
            || moving == 0
            || (moving == 1 && between.into_iter().all(|l| self.links[*l].pieces.is_empty()))
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::meshes::Meshes;
    use crate::urdf;
    use rand::{RngExt, SeedableRng};
    use rand_xoshiro::Xoshiro256PlusPlus;
    use std::path::Path;

    pub(crate) fn model(text: &str) -> Model {
        urdf::read(text, &mut Meshes::new(&[], Path::new(""))).expect("a URDF")
    }

    const TREE: &str = r#"<robot name="tree">
      <link name="base"><collision><geometry><sphere radius="0.1"/></geometry></collision></link>
      <joint name="j1" type="revolute"><parent link="base"/><child link="a"/><origin xyz="0.1 0.2 0.3" rpy="0.3 -0.7 1.1"/>
        <axis xyz="0.6 0 0.8"/><limit lower="-3" upper="3" velocity="1" effort="1"/></joint>
      <link name="a"><collision><geometry><sphere radius="0.1"/></geometry></collision></link>
      <joint name="j2" type="continuous"><parent link="a"/><child link="b"/><origin xyz="0 0.5 0" rpy="1.5 0 0"/><axis xyz="0 1 0"/></joint>
      <link name="b"/>
      <joint name="f" type="fixed"><parent link="b"/><child link="c"/><origin xyz="0.05 0 0.4" rpy="0 0.4 0"/></joint>
      <link name="c"><collision><geometry><sphere radius="0.1"/></geometry></collision></link>
      <joint name="j3" type="prismatic"><parent link="c"/><child link="d"/><origin rpy="0 0 2"/><axis xyz="0 0 2"/>
        <limit lower="-1" upper="1" velocity="1" effort="1"/></joint>
      <link name="d"><collision><geometry><sphere radius="0.1"/></geometry></collision></link>
      <joint name="j4" type="revolute"><parent link="c"/><child link="e"/><origin xyz="1 0 0"/><axis xyz="1 0 0"/>
        <limit lower="-3" upper="3" velocity="1" effort="1"/><mimic joint="j1" multiplier="-0.5" offset="0.2"/></joint>
      <link name="e"/>
    </robot>"#;

    #[test]
    fn agrees_with_k() {
        let model = model(TREE);
        let file = tempfile::Builder::new().suffix(".urdf").tempfile().expect("a file");
        std::fs::write(file.path(), TREE).expect("written");
        let chain = k::Chain::<f64>::from_urdf_file(file.path()).expect("a URDF");
        let mut random = Xoshiro256PlusPlus::seed_from_u64(4);
        let root = Pose::IDENTITY;
        for _ in 0..200 {
            let mut posture = vec![0.0; model.joints.len()];
            for name in ["j1", "j2", "j3"] {
                let value = random.random_range(-1.0..1.0);
                posture[model.joint(name).expect("a joint")] = value;
                chain.find(name).expect("a joint").set_joint_position_unchecked(value);
            }
            model.follow(&mut posture);
            let follower = posture[model.joint("j4").expect("a joint")];
            chain.find("j4").expect("a joint").set_joint_position_unchecked(follower);
            chain.update_transforms();
            let mut poses = Vec::new();
            model.link_poses(&root, &posture, &mut poses);
            for (link, pose) in model.links.iter().zip(&poses) {
                let theirs = chain.find_link(&link.name).and_then(|n| n.world_transform()).expect("a pose");
                let q = theirs.rotation.quaternion();
                let turn = pose.rotation.dot(Rotation::from_xyzw(q.i, q.j, q.k, q.w)).abs();
                let away = (pose.translation - Vector::from_array(theirs.translation.vector.into())).length();
                assert!(away < 1e-12 && 1.0 - turn < 1e-12, "{}: {away} {turn}", link.name);
            }
        }
    }

    #[test]
    fn mimics_follow_their_leader() {
        let model = model(TREE);
        let mut posture = vec![0.0; model.joints.len()];
        posture[model.joint("j1").expect("a joint")] = 1.0;
        model.follow(&mut posture);
        assert!((posture[model.joint("j4").expect("a joint")] + 0.3).abs() < 1e-15);
    }

    #[test]
    fn adjacent_links() {
        let model = model(TREE);
        let adjacent =
            |a: &str, b: &str| model.adjacent(model.link(a).expect("a link"), model.link(b).expect("a link"));
        assert!(adjacent("base", "a"), "a joint joins them");
        assert!(adjacent("a", "c"), "b between has no shape, and f is fixed");
        assert!(adjacent("c", "d"));
        assert!(adjacent("b", "c"), "nothing between them moves");
        assert!(!adjacent("base", "c"), "a is between");
        assert!(!adjacent("a", "d"), "c is between");
        assert!(!adjacent("d", "e"), "two joints between them move");
    }
}
