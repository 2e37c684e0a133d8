//! What a robot is: its tree of links and joints, the chain that is planned for, its hand.
//!
//! A [`Robot`] that exists is sound. Its links form one tree; every number is finite (but for the
//! limits of continuous joints); every mesh was found and has volume; every name in the robot file
//! and the SRDF means something. [`Robot::load`] makes it out of a robot file, a URDF, an SRDF and
//! meshes, or says what is wrong and where.
//!
//! SI units. Poses are named `outer_from_inner`; a link's frame is its parent joint's, as in URDF.
//! Visual shapes, inertias and transmissions are not read. Postures are `kinematics`' affair.

mod arm;
mod builtin;
mod element;
mod grasps;
mod hand;
mod limits;
mod load;
mod model;
mod planar_base;
mod roots;
mod shapes;
mod srdf;
mod tree;
mod urdf;

pub use builtin::NAMES as BUILT_IN;
pub use hand::Hand;
pub use load::{describe_urdf, disabled_pairs};
pub use model::{CollisionKind, Joint, JointKind, Link, MeshSource, Mimic, Model};

use clearway_plan::RobotFile;
use clearway_plan::robot_file::Grasps;
use std::collections::{BTreeMap, BTreeSet};

/// A robot to plan for.
#[derive(Clone, Debug)]
pub struct Robot {
    /// The URDF's.
    pub name: String,
    /// The model planned for, verbatim, with the joints of a planar base if they were added.
    pub urdf_text: String,
    /// Parents before children: the root is first.
    pub links: Vec<Link>,
    /// The joint of each link but the root, in the order of `links`.
    pub joints: Vec<Joint>,
    /// The joints planned for, as indices into `joints`: a planar base's, then those that move
    /// between `base` and `tip`, from the base outwards.
    pub arm: Vec<usize>,
    /// Links, as indices into `links`.
    pub base: usize,
    pub tip: usize,
    /// x, y, yaw of a planar base, as indices into `joints`; the first three of `arm`.
    pub planar_base: Option<[usize; 3]>,
    /// The values of the movable joints that are neither the arm's nor the hand's and mimic none.
    pub fixed: BTreeMap<String, f64>,
    /// From here on, one entry per joint of `arm`. The resting posture.
    pub home: Vec<f64>,
    /// rad/s² or m/s².
    pub acceleration: Vec<f64>,
    /// rad/s³ or m/s³.
    pub jerk: Vec<f64>,
    /// rad/s or m/s.
    pub velocity: Vec<f64>,
    /// Minus infinity for a continuous joint.
    pub lower: Vec<f64>,
    /// Infinity for a continuous joint.
    pub upper: Vec<f64>,
    pub hand: Hand,
    /// `kind` is `List` exactly if `list` is not empty.
    pub grasps: Grasps,
    /// What the SRDF says need not be checked: links `(a, b)` with `a < b`.
    pub disabled_pairs: BTreeSet<(usize, usize)>,
    /// The SRDF's: name → joint → value.
    pub named_states: BTreeMap<String, BTreeMap<String, f64>>,
    /// The files that collision shapes came from, in the order met.
    pub meshes: Vec<MeshSource>,
    /// As written.
    pub file: RobotFile,
}

impl Robot {
    /// The link of this name.
    pub fn link(&self, name: &str) -> Option<usize> {
        self.links.iter().position(|l| l.name == name)
    }

    /// The joint of this name.
    pub fn joint(&self, name: &str) -> Option<usize> {
        self.joints.iter().position(|j| j.name == name)
    }

    /// Whether the link is part of what is mounted, and so may meet what it stands on: the root, or,
    /// where that has no shape, the links fixed to it.
    pub fn mounted(&self, link: usize) -> bool {
        let mut at = link;
        while let Some(joint) = self.links[at].parent_joint.map(|j| &self.joints[j]) {
            if joint.kind != JointKind::Fixed || !self.links[joint.parent].collision.parts.is_empty() {
                return false;
            }
            at = joint.parent;
        }
        true
    }

    /// The same robot with its planar base held at zero: the arm alone is planned for, and whoever asks says
    /// where the base stands. `None` where the base does not drive.
    pub fn standing(&self) -> Option<Robot> {
        let base = self.planar_base?;
        let mut robot = self.clone();
        for joint in base {
            robot.fixed.insert(self.joints[joint].name.clone(), 0.0);
        }
        robot.arm.drain(..base.len());
        for values in [
            &mut robot.home,
            &mut robot.acceleration,
            &mut robot.jerk,
            &mut robot.velocity,
            &mut robot.lower,
            &mut robot.upper,
        ] {
            values.drain(..base.len());
        }
        robot.planar_base = None;
        Some(robot)
    }

    /// The names of the joints planned for, in order.
    pub fn arm_names(&self) -> Vec<&str> {
        self.arm.iter().map(|&j| self.joints[j].name.as_str()).collect()
    }
}
