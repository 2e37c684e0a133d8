//! The robot, the fixtures and the objects, made ready for collision checks.

use crate::lanes::{Body, Kernel, Relative, Settings as BodySettings};
use crate::obstacle::{MovingPart, Obstacle};
use crate::query::SELF_MARGIN;
use clearway_geometry::{Convex, Pose, Solid, Vec3};
use clearway_plan::{ObjectId, ObjectSet};
use clearway_robot::{Group, JointKind, Kinematics, Robot, Sphere, bounding_sphere, cover};
use clearway_scene::{Scene, Support};
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
}

/// Everything that stays the same over a planning session.
#[derive(Clone, Debug)]
pub struct World {
    pub robot: Arc<Robot>,
    pub kinematics: Kinematics,
    pub world_from_root: Pose,
    pub root_from_world: Pose,
    /// By link index; `None` for links without shape.
    pub links: Vec<Option<LinkBody>>,
    pub fixtures: Vec<Obstacle>,
    /// By object id, where the scene has them.
    pub objects: Vec<Obstacle>,
    pub solids: Vec<Arc<Solid>>,
    /// By object id: its parts, as a hand carries them.
    pub carried: Vec<Arc<Vec<MovingPart>>>,
    /// By object id: what rests on it, at least in part, and would fall.
    pub loads: Vec<ObjectSet>,
    /// `root_from_object`, where the scene has them.
    pub poses: Vec<Pose>,
    /// Pairs of links that are checked against each other.
    pub pairs: Vec<(usize, usize)>,
    /// Pairs that are not, by name, for the plan file.
    pub unchecked: Vec<[String; 2]>,
    /// By link, then arm joint: how far from the joint's axis any point of the link can be, metres
    /// (for a sliding joint 1); 0 when the joint does not move the link.
    pub link_reach: Vec<Vec<f64>>,
    /// The same for the tool's frame alone.
    pub tool_reach: Vec<f64>,
    /// The robot's joints as a group, and its links covered by spheres, for quick answers.
    pub group: Group,
    pub kernel: Kernel,
    /// By link: fixtures that it never touches, whatever the posture.
    pub apart: Vec<Vec<usize>>,
}

/// A hull of more corners than this is asked only where spheres that cover it are near.
const COSTLY: usize = 24;
/// Links moved by no more joints than this are checked for fixtures that they never touch …
const MOVED_BY_FEW: u32 = 2;
/// … of no more parts than this, with at least this much room, metres: more than any margin asked.
const MOST_PROVED: usize = 16;
const NEVER_MARGIN: f64 = 0.003;
/// Parts of one link have neighbouring tags; tags only choose slots, so more parts do no harm.
const TAGS_PER_LINK: usize = 16;

/// A solid's parts as they move with their body.
pub fn moving_parts(solid: &Solid, tag: usize) -> Vec<MovingPart> {
    let part = |(i, (pose, convex)): (usize, &(Pose, Convex))| MovingPart {
        pose: *pose,
        convex: convex.clone(),
        radius: convex.bounding_radius(),
        tag: tag + i,
    };
    solid.parts.iter().enumerate().map(part).collect()
}

/// Width of the cells that links are covered with, metres: hand finely, arm coarsely.
const ARM_CELL: f64 = 0.08;
const HAND_CELL: f64 = 0.03;
/// The same for the kernel's spheres, which stand for the link.
const KERNEL_ARM_CELL: f64 = 0.04;
const KERNEL_HAND_CELL: f64 = 0.015;

impl World {
    pub fn new(robot: Arc<Robot>, scene: &Scene) -> Self {
        let kinematics = Kinematics::new(&robot);
        let world_from_root = scene.base;
        let root_from_world = world_from_root.inverse();
        let links: Vec<Option<LinkBody>> = robot
            .links
            .iter()
            .enumerate()
            .map(|(index, link)| {
                let hand = robot.hand.links.contains(&index);
                let spheres = cover(&link.collision, if hand { HAND_CELL } else { ARM_CELL });
                let costly = link.collision.parts.iter().any(|(_, c)| matches!(c, Convex::Hull(h) if h.points.len() > COSTLY));
                (!spheres.is_empty()).then(|| LinkBody {
                    parts: moving_parts(&link.collision, index * TAGS_PER_LINK),
                    bound: bounding_sphere(&spheres),
                    spheres: if costly { spheres } else { Vec::new() },
                    hand,
                    still: kinematics.moved_by[index] == 0 && !kinematics.moved_by_hand[index],
                })
            })
            .collect();
        let (pairs, unchecked) = crate::pairs::checked_pairs(&robot, &kinematics);
        let link_reach = (0..links.len())
            .map(|l| reach(&robot, &kinematics, l, links[l].as_ref().map_or(0.0, |b| b.bound.centre.length() + b.bound.radius)))
            .collect();
        let tool_reach = reach(&robot, &kinematics, robot.hand.frame, 0.0);
        let group = Group::from(&*robot);
        let kernel = kernel(&robot, &group, &pairs);
        let mut world = Self {
            group,
            kernel,
            apart: Vec::new(),
            robot,
            kinematics,
            world_from_root,
            root_from_world,
            links,
            fixtures: Vec::new(),
            objects: Vec::new(),
            solids: Vec::new(),
            carried: Vec::new(),
            loads: Vec::new(),
            poses: Vec::new(),
            pairs,
            unchecked,
            link_reach,
            tool_reach,
        };
        world.set_scene(scene);
        world
    }

    /// Takes over fixtures and objects of a changed scene; robot and base stay.
    pub fn set_scene(&mut self, scene: &Scene) {
        let mut tag = 0;
        let mut place = |solid: &Solid, pose: &Pose| {
            tag += solid.parts.len();
            Obstacle::new(solid, &(self.root_from_world * *pose), tag)
        };
        self.fixtures = scene.fixtures.iter().map(|f| place(&f.solid, &f.pose)).collect();
        let near = |link: usize| (1..=MOVED_BY_FEW).contains(&self.kinematics.moved_by[link].count_ones());
        self.apart = (0..self.links.len()).map(|link| if near(link) { self.never_touched(link) } else { Vec::new() }).collect();
        self.objects = scene.objects.iter().map(|o| place(&o.solid, &o.pose)).collect();
        self.solids = scene.objects.iter().map(|o| o.solid.clone()).collect();
        let tag = self.links.len() * TAGS_PER_LINK;
        self.carried = self.solids.iter().map(|s| Arc::new(moving_parts(s, tag))).collect();
        self.loads = vec![ObjectSet::EMPTY; scene.objects.len()];
        for (index, object) in scene.objects.iter().enumerate() {
            if let Support::Objects(below) = &object.support {
                for carrier in below {
                    self.loads[carrier.index()].insert(ObjectId(index as u16));
                }
            }
        }
        self.poses = scene.objects.iter().map(|o| self.root_from_world * o.pose).collect();
    }

    /// The fixtures that keep clear of a link in all postures, by proof.
    fn never_touched(&self, link: usize) -> Vec<usize> {
        let relative = Relative::new(&self.group, 0, link);
        let own = &self.robot.links[link].collision;
        let clear = |f: &Obstacle| {
            let solid = Solid { parts: f.parts.iter().map(|p| (p.root_from_part, p.convex.clone())).collect() };
            f.parts.len() <= MOST_PROVED && relative.always_apart(&solid, own, NEVER_MARGIN)
        };
        (0..self.fixtures.len()).filter(|&i| clear(&self.fixtures[i])).collect()
    }

    /// An object placed somewhere else, `root_from_object`.
    pub fn placed(&self, object: ObjectId, root_from_object: &Pose) -> Arc<Obstacle> {
        let tag = self.objects[object.index()].parts.first().map_or(0, |p| p.tag);
        Arc::new(Obstacle::new(&self.solids[object.index()], root_from_object, tag))
    }

    /// The fixtures and standing objects that carry an object at rest at `root_from_object`: those
    /// it touches there, but no longer when raised by a little.
    pub fn below(&self, object: ObjectId, root_from_object: &Pose, margin: f64) -> (Vec<usize>, ObjectSet) {
        let raised = Pose::new(root_from_object.rotation, root_from_object.translation + self.up() * (2.0 * margin + 0.001));
        let touches = |other: &Obstacle, pose: &Pose| {
            self.solids[object.index()].parts.iter().any(|(part, convex)| {
                other.parts.iter().any(|p| p.near_convex(convex, &(*pose * *part), margin))
            })
        };
        let carries = |other: &Obstacle| touches(other, root_from_object) && !touches(other, &raised);
        let fixtures = (0..self.fixtures.len()).filter(|&i| carries(&self.fixtures[i])).collect();
        let objects = (0..self.objects.len())
            .filter(|&i| i != object.index() && carries(&self.objects[i]))
            .map(|i| ObjectId(i as u16))
            .collect();
        (fixtures, objects)
    }

    /// Whether a link is the root, or fixed to it across links without shape: what it is mounted on
    /// may touch it.
    pub fn mounted(&self, link: usize) -> bool {
        let mut at = link;
        while let Some(joint) = self.robot.links[at].parent_joint {
            let joint = &self.robot.joints[joint];
            if joint.kind != JointKind::Fixed || self.links[joint.parent].is_some() {
                return false;
            }
            at = joint.parent;
        }
        true
    }

    /// The world's up, in the root frame.
    pub fn up(&self) -> Vec3 {
        self.root_from_world.rotation * Vec3::Z
    }
}

/// The links' spheres, made ready for the kernel.
fn kernel(robot: &Robot, group: &Group, pairs: &[(usize, usize)]) -> Kernel {
    let width = |link: usize| if robot.hand.links.contains(&link) { KERNEL_HAND_CELL } else { KERNEL_ARM_CELL };
    let spheres: Vec<Vec<Sphere>> = robot.links.iter().enumerate().map(|(i, l)| cover(&l.collision, width(i))).collect();
    let links = robot.links.len();
    let all = (0..links).flat_map(|a| (a + 1..links).map(move |b| (a, b)));
    let apart = |a: usize, b: usize| {
        Relative::new(group, a, b).always_apart(&robot.links[a].collision, &robot.links[b].collision, SELF_MARGIN)
    };
    let unchecked = all.filter(|&(a, b)| !pairs.contains(&(a, b)) || apart(a, b)).collect();
    let settings = BodySettings { self_margin: SELF_MARGIN, ..BodySettings::default() };
    Kernel::new(Body::new(group, &spheres, unchecked, &settings))
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
