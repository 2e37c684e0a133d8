//! The robot, the fixtures and the objects, made ready for collision checks.

use crate::lanes::{Obstacles, Piece, Relative, link_owner, owner_link};
use crate::model::{CollisionModel, TAGS_PER_LINK};
use crate::moment::{Close, Held};
use crate::obstacle::{MovingPart, Obstacle, PlacedPart};
use crate::quick::pieces;
use clearway_geometry::distance::distance;
use clearway_geometry::{Convex, Pose, Solid, Vec3};
use clearway_plan::{ObjectId, ObjectSet};
use clearway_scene::{Scene, Support};
use std::sync::Arc;

/// Everything that stays the same over a planning session.
#[derive(Clone, Debug)]
pub struct World {
    pub model: Arc<CollisionModel>,
    pub world_from_root: Pose,
    pub root_from_world: Pose,
    pub fixtures: Vec<Obstacle>,
    /// By object id, where the scene has them.
    pub objects: Vec<Obstacle>,
    pub solids: Vec<Arc<Solid>>,
    /// By object id: what it hides, where that still counts while the hand holds it.
    pub unseen: Vec<Option<Arc<Obstacle>>>,
    /// By object id: its parts, as a hand carries them.
    pub carried: Vec<Arc<Vec<MovingPart>>>,
    /// By object id: what rests on it, at least in part, and would fall.
    pub loads: Vec<ObjectSet>,
    /// `root_from_object`, where the scene has them.
    pub poses: Vec<Pose>,
    /// By object id: what is nearer to it, where the scene has it, than the clearance asked for.
    pub close: Vec<Arc<Close>>,
    /// By part of the kernel's body, as masks: what it never touches whatever the posture, and links that it
    /// is not checked against.
    pub(crate) never: Arc<Vec<Vec<u16>>>,
    /// By object id: what carries it where the scene has it.
    pub carriers: Vec<(Vec<usize>, ObjectSet)>,
    /// Fixtures, then objects where the scene has them, for the kernel.
    pub(crate) obstacles: Arc<Obstacles>,
}

/// Whose an obstacle is, of those that the kernel knows: numbered fixtures first, then objects where
/// the scene has them, then what was put down elsewhere, in the moment's order.
#[derive(Clone, Copy)]
pub(crate) enum Owner {
    Fixture(usize),
    Standing(ObjectId),
    Placed(usize),
}

/// Links moved by no more joints than this are checked for fixtures that they never touch …
const MOVED_BY_FEW: u32 = 2;
/// … of no more parts than this, with at least this much room, metres: more than any margin asked.
const MOST_PROVED: usize = 16;
const MOST_BOXES: usize = 100;
const NEVER_MARGIN: f64 = 0.003;

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

impl World {
    pub fn new(model: Arc<CollisionModel>, scene: &Scene) -> Self {
        let world_from_root = scene.base;
        let mut world = Self {
            model,
            world_from_root,
            root_from_world: world_from_root.inverse(),
            fixtures: Vec::new(),
            objects: Vec::new(),
            solids: Vec::new(),
            unseen: Vec::new(),
            carried: Vec::new(),
            loads: Vec::new(),
            poses: Vec::new(),
            close: Vec::new(),
            never: Arc::default(),
            carriers: Vec::new(),
            obstacles: Arc::default(),
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
        // What an object hides is not to be touched as long as it stands, like the object itself.
        let hidden = |index: usize| scene.hidden.iter().filter(move |h| h.behind.index() == index);
        self.objects = (0..)
            .zip(&scene.objects)
            .map(|(index, o)| {
                let object_from_world = o.pose.inverse();
                let mut parts = o.solid.parts.clone();
                let space = hidden(index).flat_map(|h| &h.space.parts);
                parts.extend(space.map(|(pose, convex)| (object_from_world * *pose, convex.clone())));
                place(&Solid { parts }, &o.pose)
            })
            .collect();
        self.unseen = (0..scene.objects.len())
            .map(|index| {
                let parts: Vec<(Pose, Convex)> = hidden(index).flat_map(|h| h.beyond.parts.iter().cloned()).collect();
                (!parts.is_empty()).then(|| Arc::new(place(&Solid { parts }, &Pose::IDENTITY)))
            })
            .collect();
        self.solids = scene.objects.iter().map(|o| o.solid.clone()).collect();
        let tag = self.model.links.len() * TAGS_PER_LINK;
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
        let ids = (0..self.objects.len()).map(|i| ObjectId(i as u16));
        self.carriers = ids.map(|id| self.below(id, &self.poses[id.index()])).collect();
        self.close = (0..self.objects.len()).map(|i| Arc::new(self.nearer(i, scene.clearance()))).collect();
        let all = self.fixtures.iter().chain(&self.objects).enumerate();
        self.obstacles =
            Arc::new(Obstacles::new(all.flat_map(|(i, o)| pieces(o, i)).chain(self.still_links()).collect()));
        self.never = Arc::new(self.never());
    }

    /// The links that stand still, where the kernel asks them as obstacles.
    fn still_links(&self) -> Vec<Piece> {
        let kinematics = &self.model.kinematics;
        let mut frames = Vec::new();
        kinematics.frames(&vec![0.0; kinematics.arm_joints], 0.0, &mut frames);
        let links = (0..frames.len()).filter(|l| self.model.kernel.still.is_some() && kinematics.is_still(*l));
        links.flat_map(|l| Piece::of_solid(&self.model.robot.links[l].collision, &frames[l], link_owner(l))).collect()
    }

    fn never(&self) -> Vec<Vec<u16>> {
        let Self { model, .. } = self;
        let near = |link: usize| (1..=MOVED_BY_FEW).contains(&model.kinematics.moved_by[link].count_ones());
        let apart: Vec<Vec<usize>> =
            (0..model.links.len()).map(|link| if near(link) { self.never_touched(link) } else { Vec::new() }).collect();
        let mask = |link: usize| {
            let mut mask = Vec::new();
            let unchecked = |other: usize| {
                !model.kernel.still.as_ref().is_some_and(|still| still.contains(&(link.min(other), link.max(other))))
            };
            self.obstacles.mask(
                |owner| owner_link(owner).map_or_else(|| apart[link].contains(&(owner as usize)), unchecked),
                &mut mask,
            );
            mask
        };
        let masks: Vec<Vec<u16>> = (0..model.links.len()).map(mask).collect();
        model.kernel.body.parts.iter().map(|part| masks[part.link].clone()).collect()
    }

    pub(crate) fn owner(&self, number: usize) -> Owner {
        match number.checked_sub(self.fixtures.len()) {
            None => Owner::Fixture(number),
            Some(object) if object < self.objects.len() => Owner::Standing(ObjectId(object as u16)),
            Some(past) => Owner::Placed(past - self.objects.len()),
        }
    }

    /// The fixtures that keep clear of a link in all postures, by proof.
    fn never_touched(&self, link: usize) -> Vec<usize> {
        let relative = Relative::new(&self.model.group, 0, link);
        let own = &self.model.robot.links[link].collision;
        let clear = |f: &Obstacle| {
            f.parts.len() <= MOST_PROVED && relative.always_apart(&f.solid(), own, NEVER_MARGIN, MOST_BOXES)
        };
        (0..self.fixtures.len()).filter(|&i| clear(&self.fixtures[i])).collect()
    }

    /// An object placed somewhere else, `root_from_object`.
    pub fn placed(&self, object: ObjectId, root_from_object: &Pose) -> Arc<Obstacle> {
        let tag = self.objects[object.index()].parts.first().map_or(0, |p| p.tag);
        Arc::new(Obstacle::new(&self.solids[object.index()], root_from_object, tag))
    }

    /// The same, its upright cylinders wider by `room` all round.
    pub fn placed_with_room(&self, object: ObjectId, root_from_object: &Pose, room: f64) -> Arc<Obstacle> {
        let wider = |(pose, convex): &(Pose, Convex)| match convex {
            Convex::Cylinder { radius, half } => (*pose, Convex::Cylinder { radius: radius + room, half: *half }),
            other => (*pose, other.clone()),
        };
        let solid = Solid { parts: self.solids[object.index()].parts.iter().map(wider).collect() };
        let tag = self.objects[object.index()].parts.first().map_or(0, |p| p.tag);
        Arc::new(Obstacle::new(&solid, root_from_object, tag))
    }

    /// An object in the hand, gripped at `object_from_tool`; nothing carries it.
    pub fn in_hand(&self, object: ObjectId, object_from_tool: &Pose) -> Held {
        Held {
            object,
            parts: self.carried[object.index()].clone(),
            tool_from_object: object_from_tool.inverse(),
            fixtures_below: Vec::new(),
            objects_below: ObjectSet::EMPTY,
            close: self.close[object.index()].clone(),
            kernel: None,
        }
    }

    /// What is nearer to an object, where the scene has it, than `clearance`; nothing for no clearance.
    fn nearer(&self, object: usize, clearance: f64) -> Close {
        /// Kept off what is measured, metres.
        const ROUNDING: f64 = 5e-5;
        let placed = self.placed(ObjectId(object as u16), &self.poses[object]);
        let room = |other: &Obstacle| {
            let near = other.near_bound(placed.bound.centre, placed.bound.radius, clearance);
            let apart =
                |p: &PlacedPart, o: &PlacedPart| distance(&p.convex, &p.root_from_part, &o.convex, &o.root_from_part);
            let to = |o: &PlacedPart| placed.parts.iter().map(|p| apart(p, o)).fold(f64::INFINITY, f64::min);
            let gap = near.then(|| other.parts.iter().map(to).fold(f64::INFINITY, f64::min));
            gap.filter(|gap| *gap < clearance).map(|gap| (gap - ROUNDING).max(0.0))
        };
        if clearance <= 0.0 {
            return Close::default();
        }
        Close {
            fixtures: self
                .fixtures
                .iter()
                .enumerate()
                .filter_map(|(i, f)| Some((i, room(f)?)))
                .filter(|(i, _)| !self.carriers[object].0.contains(i))
                .collect(),
            objects: (0..self.objects.len())
                .filter(|o| *o != object)
                .filter_map(|o| Some((ObjectId(o as u16), room(&self.objects[o])?)))
                .collect(),
        }
    }

    /// Among what was put down, what an object hides: a moment in which it is in hand.
    pub fn with_unseen(
        &self,
        mut placed: Vec<(ObjectId, Arc<Obstacle>)>,
        object: ObjectId,
    ) -> Vec<(ObjectId, Arc<Obstacle>)> {
        placed.extend(self.unseen[object.index()].iter().map(|unseen| (object, unseen.clone())));
        placed
    }

    /// The fixtures and objects, where the scene has them, that carry an object at rest at `root_from_object`.
    pub fn below(&self, object: ObjectId, root_from_object: &Pose) -> (Vec<usize>, ObjectSet) {
        let carries = |other: &Obstacle| self.carries(other, object, root_from_object);
        let fixtures = (0..self.fixtures.len()).filter(|&i| carries(&self.fixtures[i])).collect();
        let objects = (0..self.objects.len())
            .filter(|&i| i != object.index() && carries(&self.objects[i]))
            .map(|i| ObjectId(i as u16))
            .collect();
        (fixtures, objects)
    }

    /// Whether something carries an object at rest: it is touched there, but no longer when the object is raised
    /// by a little.
    pub fn carries(&self, other: &Obstacle, object: ObjectId, root_from_object: &Pose) -> bool {
        /// What is this near may carry it, metres.
        const NEAR: f64 = 0.002;
        const RAISED: f64 = 2.0 * NEAR + 0.001;
        let raised = Pose::new(root_from_object.rotation, root_from_object.translation + self.up() * RAISED);
        let bound = self.objects[object.index()].bound;
        let centre = root_from_object.point(self.poses[object.index()].inverse_point(bound.centre));
        let touches = |pose: &Pose| {
            self.solids[object.index()]
                .parts
                .iter()
                .any(|(part, convex)| other.parts.iter().any(|p| p.near_convex(convex, &(*pose * *part), NEAR)))
        };
        other.near_bound(centre, bound.radius + RAISED, NEAR) && touches(root_from_object) && !touches(&raised)
    }

    /// The world's up, in the root frame.
    pub fn up(&self) -> Vec3 {
        self.root_from_world.rotation * Vec3::Z
    }
}
