//! The robot alone, made ready for collision checks: the same in every scene, so made once.

use crate::lanes::{Kernel, Settings as BodySettings};
use crate::obstacle::MovingPart;
use crate::query::SELF_MARGIN;
use crate::world::moving_parts;
use clearway_geometry::{Convex, Solid};
use clearway_robot::{Group, JointKind, Kinematics, Reachability, Robot, Sphere, bounding_sphere, cover};
use std::sync::Arc;

/// A link's shapes, in its own frame.
#[derive(Clone, Debug)]
pub struct LinkBody {
    pub parts: Vec<MovingPart>,
    /// They cover the link. Asked first where its parts are costly; empty where they are not.
    pub spheres: Vec<Sphere>,
    pub bound: Sphere,
    /// One of the hand's links, which may touch what they grip.
    pub hand: bool,
    /// Moved by no joint that is planned for.
    pub still: bool,
    /// Moved by the hand's own joint.
    pub turns: bool,
}

/// A robot, its links covered by spheres, and the pairs of links that could meet.
#[derive(Clone, Debug)]
pub struct CollisionModel {
    pub robot: Arc<Robot>,
    pub kinematics: Kinematics,
    /// By link index; `None` for links without shape.
    pub links: Vec<Option<LinkBody>>,
    /// Pairs of links that are checked against each other.
    pub pairs: Vec<(usize, usize)>,
    /// Pairs that are not, by name, for the plan file.
    pub unchecked: Vec<[String; 2]>,
    /// By link, then arm joint: how far from the joint's axis any point of the link can be, metres
    /// (for a sliding joint 1); 0 when the joint does not move the link.
    pub link_reach: Vec<Vec<f64>>,
    /// The same for the tool's frame alone.
    pub tool_reach: Vec<f64>,
    /// The robot's joints as a group.
    pub group: Group,
    /// Its links covered by spheres, for quick answers. Of a robot that drives it knows nothing of links that
    /// touch each other: it is asked about drives alone, in which the arm is still.
    pub kernel: Arc<Kernel>,
    /// For a base that drives: the robot while it stands.
    pub standing: Option<Arc<Standing>>,
}

/// A robot whose base drives, at a stop: its base is its root, and only its arm moves.
#[derive(Clone, Debug)]
pub struct Standing {
    pub model: Arc<CollisionModel>,
    pub reachability: Reachability,
}

/// A hull of more corners than this is asked only where spheres that cover it are near.
const COSTLY: usize = 24;
/// Parts of one link have neighbouring tags; tags only choose slots, so more parts do no harm.
pub(crate) const TAGS_PER_LINK: usize = 16;
/// Width of the cells that links are covered with, metres: hand finely, arm coarsely.
const ARM_CELL: f64 = 0.08;
const HAND_CELL: f64 = 0.03;
/// The same for the kernel's spheres, which stand for the link.
const KERNEL_ARM_CELL: f64 = 0.04;
const KERNEL_HAND_CELL: f64 = 0.008;
const KERNEL_HELD_CELL: f64 = 0.02;

impl CollisionModel {
    pub fn new(robot: Arc<Robot>) -> Self {
        let kinematics = Kinematics::new(&robot);
        let links: Vec<Option<LinkBody>> = robot
            .links
            .iter()
            .enumerate()
            .map(|(index, link)| {
                let hand = robot.hand.links.contains(&index);
                let spheres = cover(&link.collision, if hand { HAND_CELL } else { ARM_CELL });
                let costly =
                    link.collision.parts.iter().any(|(_, c)| matches!(c, Convex::Hull(h) if h.points.len() > COSTLY));
                (!spheres.is_empty()).then(|| LinkBody {
                    parts: moving_parts(&link.collision, index * TAGS_PER_LINK),
                    bound: bounding_sphere(&spheres),
                    spheres: if costly { spheres } else { Vec::new() },
                    hand,
                    still: kinematics.is_still(index),
                    turns: kinematics.moved_by_hand[index],
                })
            })
            .collect();
        let standing = robot.standing().map(|standing| {
            let model = Arc::new(CollisionModel::new(Arc::new(standing)));
            let reachability = Reachability::of(&model.kinematics, &model.robot.lower, &model.robot.upper);
            Arc::new(Standing { model, reachability })
        });
        // Where the base carries all that has a shape, links are to each other as if it stood.
        let carried = |l: usize| links[l].is_none() || kinematics.moved_by[l] & 1 == 1;
        let same = standing.as_ref().map(|s| &s.model).filter(|_| (0..links.len()).all(carried));
        let (pairs, unchecked) = match same {
            Some(same) => (same.pairs.clone(), same.unchecked.clone()),
            None => crate::pairs::checked_pairs(&robot, &kinematics),
        };
        let link_reach = (0..links.len())
            .map(|l| {
                reach(
                    &robot,
                    &kinematics,
                    l,
                    links[l].as_ref().map_or(0.0, |b| b.bound.centre.length() + b.bound.radius),
                )
            })
            .collect();
        let tool_reach = reach(&robot, &kinematics, robot.hand.frame, 0.0);
        let group = Group::from(&*robot);
        // While it drives the arm is still: links that keep clear as it begins keep clear.
        let checked = if same.is_some() { &[][..] } else { &pairs[..] };
        let kernel = Arc::new(kernel(&robot, &group, checked));
        Self { robot, kinematics, links, pairs, unchecked, link_reach, tool_reach, group, kernel, standing }
    }

    /// The kernel of the robot with something in its hand: parts in the tool's frame.
    pub fn holding(&self, held: &Solid) -> Arc<Kernel> {
        let hand: Vec<usize> =
            (0..self.links.len()).filter(|&l| self.links[l].as_ref().is_some_and(|l| l.hand)).collect();
        let spheres = cover(held, KERNEL_HELD_CELL);
        let body = self.kernel.body.with_attached(
            &self.group,
            self.kinematics.tool,
            (held, &spheres),
            &hand,
            &BodySettings { still_aside: self.kernel.still.is_some(), ..body_settings() },
        );
        Arc::new(self.kernel.with_body(body))
    }

    /// The index by which suspects name what is held.
    pub fn held_index(&self) -> usize {
        self.links.len()
    }
}

fn body_settings() -> BodySettings {
    BodySettings { self_margin: SELF_MARGIN, still_aside: true, ..BodySettings::default() }
}

/// The links' spheres, made ready for the kernel.
fn kernel(robot: &Robot, group: &Group, pairs: &[(usize, usize)]) -> Kernel {
    let links = robot.links.len();
    let width = |link: usize| if robot.hand.links.contains(&link) { KERNEL_HAND_CELL } else { KERNEL_ARM_CELL };
    let spheres: Vec<Vec<Sphere>> =
        robot.links.iter().enumerate().map(|(i, l)| cover(&l.collision, width(i))).collect();
    let all = (0..links).flat_map(|a| (a + 1..links).map(move |b| (a, b)));
    Kernel::of_covers(group, &spheres, all.filter(|pair| !pairs.contains(pair)).collect(), &body_settings())
}

/// For each arm joint that moves `link`: the chain's lengths from the joint to the link, added up,
/// and the link's `own` extent. No point of the link is farther from the joint's axis.
fn reach(robot: &Robot, kinematics: &Kinematics, link: usize, own: f64) -> Vec<f64> {
    let mut reach = vec![0.0; kinematics.arm_joints];
    let mut length = own;
    let mut at = link;
    while let Some(joint) = robot.links[at].parent_joint {
        let up = &robot.joints[joint];
        if let Some(j) = robot.arm.iter().position(|&a| a == joint) {
            reach[j] = if up.kind == JointKind::Prismatic { 1.0 } else { length };
        }
        length += up.parent_from_joint.translation.length();
        if up.kind == JointKind::Prismatic {
            length += up.lower.abs().max(up.upper.abs());
        }
        at = up.parent;
    }
    reach
}
