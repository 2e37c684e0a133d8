//! A planning group: some joints of any URDF, planned for without a robot file, a hand or grasps.
//!
//! Joints are named, in the order in which postures list their values. Joints that are not named
//! stay at 0, or at the limit nearest to it.

use crate::description::{Joint, JointKind, Link, Model, Robot, describe_urdf, disabled_pairs};
use crate::kinematics::{Kinematics, Tree};
use clearway_files::{FileError, closest, quoted};
use clearway_geometry::{Pose, Solid, Vec3};
use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};

/// Joints to plan for: more than any robot has, so few that sets of them fit a word.
const MOST_JOINTS: usize = 32;

/// Links with shapes, and the joints that are planned for.
#[derive(Clone, Debug)]
pub struct Group {
    pub robot: String,
    /// Parents before children: the root is first.
    pub links: Vec<Link>,
    pub joints: Vec<Joint>,
    pub kinematics: Kinematics,
    /// From here on, one entry per joint planned for.
    pub names: Vec<String>,
    /// Minus infinity for a continuous joint.
    pub lower: Vec<f64>,
    pub upper: Vec<f64>,
    /// rad/s or m/s; infinite where the URDF gives none.
    pub velocity: Vec<f64>,
    /// The values that the hand's joint takes, open and closed, where there is a hand.
    pub hand: [f64; 2],
    /// What the SRDF says need not be checked: links `(a, b)` with `a < b`.
    pub disabled_pairs: BTreeSet<(usize, usize)>,
}

/// The point of an additive sequence, which fills a box evenly, by axis.
pub fn spread(sample: usize, ranges: impl Iterator<Item = (f64, f64)>) -> Vec<f64> {
    // A step of the plastic number's kin per axis.
    let part = |axis: usize| (0.5 + (sample + 1) as f64 * (0.754_877_666 + 0.137 * axis as f64).fract()).fract();
    ranges.enumerate().map(|(axis, (low, high))| low + (high - low) * part(axis)).collect()
}

impl Group {
    /// Reads a URDF and, if given, an SRDF. Without `names`, all joints that move on their own are
    /// planned for, in the order of the tree.
    pub fn load(
        urdf: &Path,
        srdf: Option<&Path>,
        names: Option<&[String]>,
        fixed: &BTreeMap<String, f64>,
        packages: &[(String, PathBuf)],
    ) -> Result<Group, FileError> {
        let model = describe_urdf(urdf, packages)?;
        if model.links.iter().all(|l| l.collision.parts.is_empty()) {
            return Err(FileError::new(urdf, "a robot without a single collision shape")
                .expected("<collision> elements: an arm without them would pass through everything")
                .help("use the URDF with collision geometry, or add spheres, boxes or cylinders to its links"));
        }
        let movable = |j: &Joint| j.moves() && j.mimic.is_none();
        let arm: Vec<usize> = match names {
            None => (0..model.joints.len()).filter(|&j| movable(&model.joints[j])).collect(),
            Some(names) => {
                let mut arm = Vec::with_capacity(names.len());
                for name in names {
                    let found = find_joint(urdf, &model, name)?;
                    if arm.contains(&found) {
                        return Err(FileError::new(urdf, format!("joint {} is named twice", quoted(name))));
                    }
                    arm.push(found);
                }
                arm
            }
        };
        if arm.is_empty() || arm.len() > MOST_JOINTS {
            return Err(FileError::new(urdf, format!("{} joints to plan for", arm.len()))
                .expected(format!("1 to {MOST_JOINTS}"))
                .help("name the joints of one group"));
        }
        for (name, value) in fixed {
            let joint = &model.joints[find_joint(urdf, &model, name)?];
            if !value.is_finite() || !joint.allows(*value) {
                return Err(FileError::new(urdf, format!("joint {} held at {value}", quoted(name)))
                    .expected(format!("a value within its limits, {} to {}", joint.lower, joint.upper)));
            }
        }
        let mut held: BTreeMap<String, f64> = model.joints.iter().map(|j| (j.name.clone(), j.rest())).collect();
        held.extend(fixed.iter().map(|(k, v)| (k.clone(), *v)));
        let disabled_pairs = match srdf {
            Some(path) => disabled_pairs(path, &model)?,
            None => BTreeSet::new(),
        };
        let tool = model.links.len() - 1;
        let tree = Tree { links: &model.links, joints: &model.joints, arm: &arm, hand_joint: None, fixed: &held, tool };
        let kinematics = Kinematics::of(&tree);
        let per_joint = |value: fn(&Joint) -> f64| arm.iter().map(|&j| value(&model.joints[j])).collect();
        Ok(Group {
            kinematics,
            names: arm.iter().map(|&j| model.joints[j].name.clone()).collect(),
            lower: per_joint(|j| j.lower),
            upper: per_joint(|j| j.upper),
            velocity: per_joint(|j| j.velocity),
            hand: [0.0; 2],
            disabled_pairs,
            robot: model.name,
            links: model.links,
            joints: model.joints,
        })
    }

    /// The values that a variable takes, the hand's joint being the last: a whole turn for a
    /// continuous joint.
    pub fn range(&self, variable: usize) -> (f64, f64) {
        let pi = std::f64::consts::PI;
        match (self.lower.get(variable), self.upper.get(variable)) {
            (Some(&l), Some(&u)) => (if l.is_finite() { l } else { -pi }, if u.is_finite() { u } else { pi }),
            _ => (self.hand[0].min(self.hand[1]), self.hand[0].max(self.hand[1])),
        }
    }

    /// One of the postures spread evenly over the joints' ranges, the same every time.
    pub fn spread(&self, sample: usize) -> Vec<f64> {
        spread(sample, (0..self.lower.len()).map(|j| self.range(j)))
    }

    /// One more link, the last: something that `link` holds, at `link_from_solid`, and that the
    /// links of `touching` may touch.
    pub fn attach(&mut self, name: &str, link: usize, solid: &Solid, link_from_solid: Pose, touching: &[usize]) {
        // Once a pair is named, neighbours are no longer left out by themselves.
        if self.disabled_pairs.is_empty() {
            let shaped: Vec<usize> =
                (0..self.links.len()).filter(|&l| !self.links[l].collision.parts.is_empty()).collect();
            for &a in &shaped {
                let near = shaped.iter().filter(|&&b| a < b && self.adjacent(a, b));
                let pairs: Vec<_> = near.map(|&b| (a, b)).collect();
                self.disabled_pairs.extend(pairs);
            }
        }
        let added = self.links.len();
        self.joints.push(Joint {
            name: name.to_owned(),
            kind: JointKind::Fixed,
            parent: link,
            child: added,
            parent_from_joint: link_from_solid,
            axis: Vec3::X,
            lower: 0.0,
            upper: 0.0,
            velocity: f64::INFINITY,
            mimic: None,
        });
        self.links.push(Link {
            name: name.to_owned(),
            parent_joint: Some(self.joints.len() - 1),
            collision: solid.clone(),
            collision_kinds: Vec::new(),
        });
        self.kinematics.add_fixed(link, link_from_solid);
        self.disabled_pairs.extend(touching.iter().map(|&l| (l, added)));
    }

    /// Whether one of the links is the other's next shaped ancestor: they touch at their joint.
    pub fn adjacent(&self, a: usize, b: usize) -> bool {
        adjacent(&self.links, &self.joints, a, b)
    }
}

impl From<&Robot> for Group {
    /// The robot's arm, its hand open.
    fn from(robot: &Robot) -> Group {
        Group {
            robot: robot.name.clone(),
            links: robot.links.clone(),
            joints: robot.joints.clone(),
            kinematics: Kinematics::new(robot),
            names: robot.arm_names().into_iter().map(str::to_owned).collect(),
            lower: robot.lower.clone(),
            upper: robot.upper.clone(),
            velocity: robot.velocity.clone(),
            hand: robot.hand.ends(),
            disabled_pairs: robot.disabled_pairs.clone(),
        }
    }
}

/// Whether one of the links is the other's next shaped ancestor.
pub fn adjacent(links: &[Link], joints: &[Joint], a: usize, b: usize) -> bool {
    let above = |link: usize| {
        let mut at = link;
        while let Some(joint) = links[at].parent_joint {
            at = joints[joint].parent;
            if !links[at].collision.parts.is_empty() {
                return Some(at);
            }
        }
        None
    };
    above(a) == Some(b) || above(b) == Some(a)
}

fn find_joint(urdf: &Path, model: &Model, name: &str) -> Result<usize, FileError> {
    let Some(index) = model.joints.iter().position(|j| j.name == *name) else {
        let error = FileError::new(urdf, format!("the URDF has no joint {}", quoted(name)));
        return Err(match closest(name, model.joints.iter().map(|j| j.name.as_str())) {
            Some(near) => error.help(format!("did you mean `{near}`?")),
            None => error.help("name joints as the URDF does"),
        });
    };
    let joint = &model.joints[index];
    if joint.kind == JointKind::Fixed || joint.mimic.is_some() {
        return Err(FileError::new(urdf, format!("joint {} does not move on its own", quoted(name)))
            .expected("revolute, continuous or prismatic joints that mimic none"));
    }
    Ok(index)
}
