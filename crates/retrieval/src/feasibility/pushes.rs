//! Whether an object can be pushed aside, out of the way of those that are taken later.

use super::journey::{Journey, carrier};
use super::{Feasibility, Stand};
use crate::carry::push::Shove;
use crate::carry::{Carried, Carrier, Situation};
use crate::grasps::Grasp;
use crate::push::course::Course;
use crate::push::{Contact, Upright};
use crate::ways::{self, Explorer, Way};
use clearway_collision::{LinksAt, Moment, Obstacle, World};
use clearway_geometry::{Pose, Vec3};
use clearway_motion::distance;
use clearway_plan::robot_file::HandKind;
use clearway_plan::{Budget, ObjectId, ObjectSet, Stop};
use clearway_scene::Support;
use std::sync::Arc;

/// Why an object is not pushed, as far as looking for a push came.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum NoPush {
    Drives,
    PartlyObserved,
    Stacked,
    NotUpright,
    NoSide,
    Tips,
    NoRoom,
    InTheWay,
    OutOfReach,
    NoMotion,
    Slower,
}

impl NoPush {
    /// Nothing is pushed in such a scene, whatever it is.
    pub fn is_of_scene(self) -> bool {
        matches!(self, Self::Drives | Self::PartlyObserved)
    }

    pub fn reason(self) -> &'static str {
        match self {
            Self::Drives => "objects are not pushed while the base drives",
            Self::PartlyObserved => "where not all is seen nothing is pushed",
            Self::Stacked => "it stands on another object or carries one",
            Self::NotUpright => "it is no upright cylinder: pushed, it may turn aside",
            Self::NoSide => "the open hand does not get round it, or would not hold it before itself",
            Self::Tips => "the hand does not get low enough: pushed higher, it would tip",
            Self::NoRoom => "there is no room to push it",
            Self::InTheWay => "wherever there is room to push it to, it is in the way of what is taken later",
            Self::OutOfReach => "the arm does not reach along the push",
            Self::NoMotion => "no motion was found for a push",
            Self::Slower => "that takes no longer than pushing it",
        }
    }
}

/// An object is pushed by so little above its bottom at least, metres.
const LOWEST: f64 = 0.01;
/// How far from level a push may be: the sine of the angle.
const LEVEL: f64 = 0.01;
/// Ways in tried for one push.
const WAYS_IN: usize = 2;

/// The hand round the object, and the end of the push.
struct End {
    from: Pose,
    grasp: Grasp,
    direction: Vec3,
    contact: Contact,
    height: f64,
    distance: f64,
}

/// One way of an object to be taken later.
struct Later {
    moment: Moment,
    arm: Vec<LinksAt>,
}

impl Feasibility {
    /// Pushes an object aside, out of the ways of those that are taken `later`, in this order.
    #[allow(clippy::too_many_arguments)]
    pub(super) fn push_aside(
        &mut self,
        stop: usize,
        object: ObjectId,
        removed: &ObjectSet,
        later: &[ObjectId],
        before: &Situation,
        journey: &mut Journey,
        budget: &Budget,
    ) -> Result<Result<Carried, NoPush>, Stop> {
        if self.base.as_ref().is_some_and(|base| base.settings.drives) {
            return Ok(Err(NoPush::Drives));
        }
        if self.scene.file.camera.is_some() {
            return Ok(Err(NoPush::PartlyObserved));
        }
        let thing = &self.scene.objects[object.index()];
        if !matches!(thing.support, Support::Fixture(_)) || !self.scene.loads(object).is_empty() {
            return Ok(Err(NoPush::Stacked));
        }
        let world = &self.stands[stop].world;
        let Some(upright) = Upright::of(&thing.solid, &world.poses[object.index()], world.up()) else {
            return Ok(Err(NoPush::NotUpright));
        };
        let friction = self.scene.file.objects[object.index()].friction.unwrap_or(clearway_plan::scene_file::FRICTION);
        let sides = self.level_grasps(stop, object, removed);
        let later = self.later_ways(stop, object, removed, later, budget)?;
        let tips_at = upright.tips_at(friction);
        let (mut ends, mut reason) = self.ends(stop, object, before, &upright, tips_at, &sides, &later);
        ends.sort_by(|a, b| a.distance.total_cmp(&b.distance));
        ends.truncate(self.pushing.tries);
        for end in &ends {
            budget.check()?;
            let (ways_in, ways_out) = self.ways_round(stop, object, removed, end);
            if ways_in.is_empty() {
                reason = reason.max(NoPush::OutOfReach);
                continue;
            }
            for way_in in ways_in.iter().take(WAYS_IN) {
                let shove = Shove {
                    object,
                    from: end.from,
                    direction: end.direction,
                    free: end.contact.free,
                    distance: end.distance,
                    height: end.height,
                    tips_at,
                    friction,
                    way_in,
                    ways_out: &ways_out,
                };
                match carrier!(self, stop, before, journey, budget).push(&shove, &self.pushing, before)? {
                    Ok(carried) => return Ok(Ok(carried)),
                    Err(_) => reason = reason.max(NoPush::NoMotion),
                }
            }
        }
        Ok(Err(reason))
    }

    /// Tool poses, in the object's frame, from which the object can be grasped level, each direction once.
    fn level_grasps(&self, stop: usize, object: ObjectId, removed: &ObjectSet) -> Vec<Grasp> {
        let Stand { world, ways, .. } = &self.stands[stop];
        let Some(ways) = &ways[object.index()] else { return Vec::new() };
        let home = &world.model.robot.home;
        let mut open: Vec<&Way> = ways.ways.iter().filter(|w| w.blocked_by.is_subset(removed)).collect();
        open.sort_by_cached_key(|w| w.postures.first().map_or(u64::MAX, |q| (distance(q, home) * 1e9) as u64));
        let mut sides: Vec<Grasp> = Vec::new();
        for way in open {
            let grasp = &ways.grasps[way.grasp];
            let forward = |g: &Grasp| world.poses[object.index()].rotation * g.object_from_tool.rotation.z_axis;
            let level = forward(grasp).dot(world.up()).abs() < LEVEL;
            let known = |g: &Grasp| forward(g).dot(forward(grasp)) > 0.999;
            if level && !sides.iter().any(known) {
                sides.push(grasp.clone());
            }
            if sides.len() == self.pushing.sides {
                break;
            }
        }
        sides
    }

    /// For each object to be taken later, some of the ways that are free then.
    fn later_ways(
        &mut self,
        stop: usize,
        object: ObjectId,
        removed: &ObjectSet,
        later: &[ObjectId],
        budget: &Budget,
    ) -> Result<Vec<Vec<Later>>, Stop> {
        let mut gone = removed.with(object);
        let mut all = Vec::new();
        for &other in later {
            let free = self.free_ways_from(stop, other, &gone, self.pushing.later_ways, budget)?;
            let Stand { world, ways, .. } = &self.stands[stop];
            let Some(known) = &ways[other.index()] else { return Ok(Vec::new()) };
            let later = |way: &Way| {
                let moment = ways::moment(world, &self.settings, other, &known.grasps[way.grasp]);
                Later { arm: way.postures.iter().map(|q| world.links_at(q, moment.hand)).collect(), moment }
            };
            all.push(free.iter().map(|taking| later(&known.ways[taking.way])).collect());
            gone.insert(other);
        }
        Ok(all)
    }

    /// From each side and in each direction the nearest end of a push that is in nobody's way; if there is none, why.
    #[allow(clippy::too_many_arguments)]
    fn ends(
        &mut self,
        stop: usize,
        object: ObjectId,
        before: &Situation,
        upright: &Upright,
        tips_at: f64,
        sides: &[Grasp],
        later: &[Vec<Later>],
    ) -> (Vec<End>, NoPush) {
        let Self { stands, scene, pushing, scratch, .. } = self;
        let world = &stands[stop].world;
        let up = world.up();
        let room = pushing.margin_of_error + scene.clearance();
        let placed = before.placed(world);
        let mut standing = before.standing;
        standing.remove(object);
        let course = Course { world, scene, object, standing, placed: &placed, room };
        let (mut ends, mut reason) = (Vec::new(), NoPush::NoSide);
        let mut in_the_way = |there: &Arc<Obstacle>| {
            let mut free = |way: &Later| !way.arm.iter().any(|at| world.meets(at, &way.moment, there, scratch));
            !later.iter().all(|ways| ways.iter().any(&mut free))
        };
        let mut reaches = Reaches {
            world,
            object,
            upright,
            limit: pushing.tipping * tips_at,
            aside: pushing.margin_of_error,
            known: Vec::new(),
        };
        for side in sides {
            for along in directions(&world.model.robot.hand.kind) {
                let Some((from, contact)) = reaches.low_enough(side, along) else { continue };
                reason = reason.max(NoPush::Tips);
                let tool = from.translation.dot(up) - upright.bottom;
                let (height, direction) = (tool + contact.top, from.rotation * along);
                if tool < LOWEST || direction.dot(up).abs() > LEVEL {
                    continue;
                }
                reason = reason.max(NoPush::NoRoom);
                let farthest = course.clear(direction, pushing.farthest);
                let steps = ((farthest - pushing.nearest) / pushing.step).floor();
                let found = (0..)
                    .take_while(|i| f64::from(*i) <= steps)
                    .map(|i| pushing.nearest + f64::from(i) * pushing.step)
                    .find(|d| {
                        reason = reason.max(NoPush::InTheWay);
                        let there =
                            world.placed_with_room(object, &course.pose(direction, *d), pushing.margin_of_error);
                        !in_the_way(&there) && course.carried(direction, *d, upright.radius)
                    });
                ends.extend(found.map(|distance| End {
                    from,
                    grasp: side.clone(),
                    direction,
                    contact,
                    height,
                    distance,
                }));
                if ends.len() >= pushing.ends {
                    return (ends, reason);
                }
            }
        }
        (ends, reason)
    }

    /// Ways for the empty hand in to where the push begins, and out from round the object where it ends.
    fn ways_round(&mut self, stop: usize, object: ObjectId, removed: &ObjectSet, end: &End) -> (Vec<Way>, Vec<Way>) {
        let Self { stands, inverse, floor, settings, scratch, .. } = self;
        let world = &stands[stop].world;
        let pose = world.poses[object.index()];
        let grasp = Grasp { object_from_tool: pose.inverse() * end.from, closed: end.grasp.closed, firm: true };
        let mut ways = |moved_to: Option<Pose>| {
            let explorer = Explorer { world, inverse, floor, settings, moved_to, empty: true };
            let mut ways = explorer.with_grasp(object, &grasp, WAYS_IN, scratch);
            ways.retain(|w| w.blocked_by.is_subset(removed));
            ways
        };
        let ways_in = ways(None);
        if ways_in.is_empty() {
            return (ways_in, Vec::new());
        }
        let ways_out = ways(Some(Pose::new(pose.rotation, pose.translation + end.direction * end.distance)));
        (ways_in, ways_out)
    }
}

/// In the tool's frame: to both sides, with one finger or the other, and ahead; a cup only pushes ahead.
fn directions(hand: &HandKind) -> Vec<Vec3> {
    match hand {
        HandKind::Parallel => vec![Vec3::X, -Vec3::X, Vec3::Z],
        HandKind::Suction { .. } => vec![Vec3::Z],
    }
}

/// How the hand meets an object from its sides.
struct Reaches<'a> {
    world: &'a World,
    object: ObjectId,
    upright: &'a Upright,
    /// The hand pushes no higher than this above the object's bottom.
    limit: f64,
    /// The object may be so far off to a side.
    aside: f64,
    /// From sides that differ by a turn about the object's axis the hand meets it alike: where the object and up were
    /// for the tool, the direction, and what came of it.
    known: Vec<([Vec3; 3], Option<Contact>)>,
}

impl Reaches<'_> {
    /// The hand as high as for the grasp, or lower until it pushes no higher than the limit.
    fn low_enough(&mut self, side: &Grasp, along: Vec3) -> Option<(Pose, Contact)> {
        let (up, pose) = (self.world.up(), self.world.poses[self.object.index()]);
        let mut from = pose * side.object_from_tool;
        let mut contact = self.contact(&from, along)?;
        for _ in 0..3 {
            let above = from.translation.dot(up) - self.upright.bottom + contact.top - self.limit;
            if above <= 1e-9 {
                return Some((from, contact));
            }
            from.translation -= up * above;
            // One cylinder is the same all the way down.
            if self.world.solids[self.object.index()].parts.len() > 1 {
                contact = self.contact(&from, along)?;
            }
        }
        None
    }

    fn contact(&mut self, from: &Pose, along: Vec3) -> Option<Contact> {
        let pose = self.world.poses[self.object.index()];
        let tool_from_object = from.inverse() * pose;
        let up = from.rotation.transpose() * self.world.up();
        // It is upright, the tool level: turns about its axis leave where it is for the tool.
        let asked = [tool_from_object.translation, up, along];
        let known =
            |(known, _): &&([Vec3; 3], Option<Contact>)| known.iter().zip(&asked).all(|(a, b)| a.abs_diff_eq(*b, 1e-9));
        if let Some((_, contact)) = self.known.iter().find(known) {
            return *contact;
        }
        let solid = &self.world.solids[self.object.index()];
        let contact = Contact::of(self.world, solid, &tool_from_object, along, up, self.aside);
        self.known.push((asked, contact));
        contact
    }
}
