//! The chain that is planned for, found in the tree.

use super::load::Context;
use super::model::{Joint, JointKind};
use clearway_files::{FileError, closest, quoted};
use clearway_geometry::Vec3;
use clearway_plan::robot_file::Mobile;

/// Joints planned for: more than any arm has, so few that sets of them fit a word.
const MOST: usize = 32;

pub struct Chain {
    pub base: usize,
    pub tip: usize,
    /// A planar base's joints, then the arm's, from the base outwards.
    pub arm: Vec<usize>,
    pub planar_base: Option<[usize; 3]>,
}

impl Chain {
    pub fn find(context: &Context) -> Result<Self, FileError> {
        let Context { file, model, .. } = context;
        let ends = &file.value.arm;
        let base = context.link(&["arm", "base"], &ends.base)?;
        let tip = context.link(&["arm", "tip"], &ends.tip)?;
        let Some(chain) = context.joints_between(base, tip) else {
            let error = file.error(
                &["arm", "tip"],
                format!("link {} does not hang from {}", quoted(&ends.tip), quoted(&ends.base)),
            );
            return Err(if context.joints_between(tip, base).is_some() {
                error.help("the arm is given from its tip to its base: swap the two")
            } else {
                error.help("name two links of one chain, the base the one nearer to the URDF's root")
            });
        };
        let mut arm: Vec<usize> = chain.into_iter().filter(|&j| model.joints[j].moves()).collect();
        if arm.is_empty() {
            return Err(file
                .error(&["arm"], format!("no joint moves between {} and {}", quoted(&ends.base), quoted(&ends.tip)))
                .help("name the links at the two ends of the arm"));
        }
        if let Some(&j) = arm.iter().find(|&&j| model.joints[j].mimic.is_some()) {
            return Err(context
                .joint_error(j, "mimic", format!("joint {} of the arm mimics another", quoted(&model.joints[j].name)))
                .expected("joints that move on their own between `arm.base` and `arm.tip`")
                .help("delete its <mimic>, or end the arm before it"));
        }
        let planar_base = match &file.value.mobile {
            Mobile::None => None,
            Mobile::Planar { joints, .. } => Some(planar_base(context, joints, base)?),
        };
        if let Some(joints) = planar_base {
            arm.retain(|j| !joints.contains(j));
            arm.splice(0..0, joints);
        }
        if arm.len() > MOST {
            return Err(file
                .error(&["arm"], format!("{} joints", arm.len()))
                .expected(format!("at most {MOST} joints in the arm")));
        }
        Ok(Self { base, tip, arm, planar_base })
    }
}

/// The base's three joints: two that slide and one that turns, above the arm, in this order.
fn planar_base(context: &Context, names: &[String; 3], arm_base: usize) -> Result<[usize; 3], FileError> {
    let keys = ["mobile", "planar", "joints"];
    let mut joints = [0; 3];
    for (joint, name) in joints.iter_mut().zip(names) {
        *joint = context.joint(&keys, name)?;
    }
    let kinds = joints.map(|j| context.model.joints[j].kind);
    let turns = matches!(kinds[2], JointKind::Revolute | JointKind::Continuous);
    if kinds[0] != JointKind::Prismatic || kinds[1] != JointKind::Prismatic || !turns {
        return Err(context
            .file
            .error(&keys, "the base's joints have other kinds")
            .expected("two prismatic joints, and one that turns"));
    }
    let above: Vec<usize> = context.joints_between(0, arm_base).unwrap_or_default();
    let above: Vec<usize> = above.into_iter().filter(|&j| context.model.joints[j].moves()).collect();
    if above.iter().filter(|j| joints.contains(j)).copied().ne(joints) {
        return Err(context
            .file
            .error(&keys, "the base's joints do not carry the arm in this order")
            .expected("x, y and yaw, one above the other, between the URDF's root and `arm.base`"));
    }
    // Where the base stands is said by the joints' values themselves.
    let mut parent = 0;
    for (joint, axis) in joints.into_iter().zip([Vec3::X, Vec3::Y, Vec3::Z]) {
        let Joint { name, parent_from_joint: at, axis: along, child, parent: link, .. } = &context.model.joints[joint];
        let straight = at.rotation.x_axis.dot(Vec3::X) > 1.0 - 1e-9 && at.rotation.y_axis.dot(Vec3::Y) > 1.0 - 1e-9;
        if *link != parent || !straight || at.translation.length() > 1e-9 || along.normalize().dot(axis) < 1.0 - 1e-9 {
            let found = format!("joint {} of the base has an offset, or another axis", quoted(name));
            return Err(context
                .file
                .error(&keys, found)
                .expected(
                    "joints along x, along y and about z, each on the one before, the first on the root, at its origin",
                )
                .help(
                    "delete them from the URDF to have them added, or move the offset to a fixed joint above the yaw",
                ));
        }
        parent = *child;
    }
    Ok(joints)
}

impl Context<'_> {
    /// The link that the robot file names at `keys`.
    pub fn link(&self, keys: &[&str], name: &str) -> Result<usize, FileError> {
        let links = &self.model.links;
        links.iter().position(|l| l.name == name).ok_or_else(|| {
            let error = self.file.error(keys, format!("the URDF has no link {}", quoted(name)));
            match closest(name, links.iter().map(|l| l.name.as_str())) {
                Some(near) => error.help(format!("did you mean `{near}`?")),
                None => error.help("`clearway robot FILE.urdf` lists the links"),
            }
        })
    }

    /// The joint that the robot file names at `keys`.
    pub fn joint(&self, keys: &[&str], name: &str) -> Result<usize, FileError> {
        let joints = &self.model.joints;
        joints.iter().position(|j| j.name == name).ok_or_else(|| {
            let error = self.file.error(keys, format!("the URDF has no joint {}", quoted(name)));
            match closest(name, joints.iter().map(|j| j.name.as_str())) {
                Some(near) => error.help(format!("did you mean `{near}`?")),
                None => error.help("`clearway robot FILE.urdf` lists the joints"),
            }
        })
    }

    /// An error that points into the URDF: at a child element of a joint, or at the joint.
    pub fn joint_error(&self, joint: usize, element: &str, found: String) -> FileError {
        let name = &self.model.joints[joint].name;
        match self.urdf.joints.iter().find(|j| j.name == name) {
            Some(raw) => self.source.wrong(super::element::child(raw.node, element).unwrap_or(raw.node), found),
            None => FileError::new(self.source.path, found),
        }
    }

    /// The joints from one link down to another, or none if the second does not hang from the first.
    pub fn joints_between(&self, from: usize, to: usize) -> Option<Vec<usize>> {
        let mut joints = Vec::new();
        let mut at = to;
        while at != from {
            let joint = self.model.links[at].parent_joint?;
            joints.push(joint);
            at = self.model.joints[joint].parent;
        }
        joints.reverse();
        Some(joints)
    }
}
