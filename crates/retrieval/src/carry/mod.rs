//! The whole motion for one object (section IV-D): to it, grip, out, to a free spot, let go, back.
//!
//! Three curves from rest to rest: transit and approach; transfer; retreat (and, for the last
//! object, home). The hand is along one of the object's [`ways`](crate::ways) while among the
//! clutter; between there and the tray the arm is free to move (RRT-Connect). Every row of the
//! result has been checked again with what was there at that time.

pub(crate) mod motions;
pub mod push;
pub(crate) mod put_down;
pub mod relocate;
mod segments;

use crate::grasps::Grasp;
use crate::mobile::bring::{Brought, Elsewhere};
use crate::ways::Way;
use clearway_collision::{Held, Moment, Obstacle, Touch, World};
use clearway_geometry::Pose;
use clearway_motion::{Limits, Path, Posture, RrtSettings, SimplifySettings, Timed, Trees};
use clearway_plan::plan_file::{Action, Segment, Step};
use clearway_plan::{Budget, ObjectId, ObjectSet, Stop};
use clearway_robot::InverseKinematics;
use clearway_scene::Scene;
use motions::AtEnds;
use rand::Rng;
use std::collections::BTreeMap;
use std::sync::Arc;

/// How motions are made.
#[derive(Clone, Debug)]
pub struct Settings {
    pub rrt: RrtSettings,
    /// Part of the samples drawn near start and goals rather than from all postures.
    pub near: f64,
    pub simplify: SimplifySettings,
    /// Random cuts tried per motion.
    pub shortcuts: usize,
    /// Room kept from everything while the arm moves freely, metres.
    pub margin: f64,
    /// Between checked postures no point moves farther, metres: while planning, and at the end.
    /// Passing edge over edge, bodies that keep a room at both ends of a step may come closer in
    /// between by half of it: half of the final step is within the room kept and the 0.1 mm that
    /// counts as touching.
    pub step: f64,
    pub final_step: f64,
    /// Room that the finished rows keep, metres: the robot, and what it holds.
    pub final_margin: f64,
    pub final_held_margin: f64,
    /// Rows are at most this far apart, seconds.
    pub row: f64,
    /// How far above its spot an object is before it is lowered, metres, in steps of.
    pub lower_from: f64,
    pub lower_step: f64,
    /// What is held counts as resting up to this height above where it stood, metres.
    pub resting: f64,
    /// Spots for which a motion is tried before giving up.
    pub spots: usize,
    /// How far what is held may lean while it is carried, where that can be had: radians.
    pub lean: f64,
    /// Samples for a level motion before any motion will do, and upright postures to guide it.
    pub level_iterations: usize,
    pub guides: usize,
    /// Seconds for the hand to close or open, at least.
    pub grip_time: f64,
    /// The places on which an object may be put down, by their indices; all of them for those that are not named.
    pub only_on: BTreeMap<ObjectId, Vec<usize>>,
}

impl Default for Settings {
    fn default() -> Self {
        Self {
            rrt: RrtSettings::default(),
            near: 0.75,
            simplify: SimplifySettings::default(),
            shortcuts: 12,
            margin: 0.002,
            step: 0.01,
            final_step: 0.0004,
            final_margin: 0.0004,
            final_held_margin: 0.0001,
            row: 0.016,
            lower_from: 0.06,
            lower_step: 0.02,
            resting: 0.008,
            spots: 4,
            lean: 0.13,
            level_iterations: 250,
            guides: 60,
            grip_time: 0.3,
            only_on: BTreeMap::new(),
        }
    }
}

impl Settings {
    /// With so much room kept from everything, metres.
    #[must_use]
    pub fn with_clearance(self, clearance: f64) -> Self {
        Self {
            margin: clearance + self.margin,
            final_margin: clearance + self.final_margin,
            final_held_margin: clearance + self.final_held_margin,
            lower_from: self.lower_from.max(3.0 * clearance),
            lower_step: self.lower_step.max(1.5 * clearance),
            resting: self.resting.max(1.1 * clearance + 0.001),
            ..self
        }
    }
}

/// What is the case before a step.
#[derive(Clone, Debug)]
pub struct Situation {
    /// Which of the stands the robot is at.
    pub stand: usize,
    /// The values of a mobile base's joints there, turns included; none for a base that does not drive.
    pub base: Vec<f64>,
    /// Of the arm.
    pub posture: Posture,
    pub standing: ObjectSet,
    /// World from object.
    pub placed: Vec<(ObjectId, Pose)>,
    /// Those of them that were pushed there, and how far from there they may be, metres.
    pub pushed: Vec<(ObjectId, f64)>,
}

impl Situation {
    /// What was put down, as it is for a robot in this world.
    pub(crate) fn placed(&self, world: &World) -> Vec<(ObjectId, Arc<Obstacle>)> {
        let there = |object: ObjectId, pose: &Pose| match self.pushed.iter().find(|(pushed, _)| *pushed == object) {
            Some((_, room)) => world.placed_with_room(object, pose, *room),
            None => world.placed(object, pose),
        };
        self.placed.iter().map(|(object, pose)| (*object, there(*object, &(world.root_from_world * *pose)))).collect()
    }
}

/// A step carried out.
#[derive(Clone, Debug)]
pub struct Carried {
    pub step: Step,
    pub after: Situation,
    /// What stood in the way of the way taken, before anything was removed.
    pub way_blocked_by: ObjectSet,
    /// It may turn or slip in the hand.
    pub loosely: bool,
}

/// Why a way could not be carried out.
#[derive(Clone, Debug)]
pub struct Obstruction {
    pub what: &'static str,
    /// Standing objects that the arm would have to pass through; empty when nothing is known.
    pub blamed: ObjectSet,
    /// It was given up as too slow: there may be a motion.
    pub slower: bool,
}

/// Everything a motion is planned with.
pub struct Carrier<'a, R: Rng> {
    pub world: &'a World,
    /// As in a [`Situation`]: they go before the arm's in every row.
    pub base: Vec<f64>,
    /// Motions keep to these values of the joints.
    pub within: Option<(&'a [f64], &'a [f64])>,
    pub scene: &'a Scene,
    pub inverse: &'a InverseKinematics,
    pub settings: &'a Settings,
    pub random: &'a mut R,
    pub budget: &'a Budget,
    pub trees: &'a mut Trees,
    /// A step that surely takes as long is given up, seconds.
    pub quicker_than: f64,
}

pub(crate) type Attempt<T> = Result<Result<T, Obstruction>, Stop>;

/// `?` for an attempt: passes an obstruction on as a value.
macro_rules! attempt {
    ($e:expr) => {
        match $e? {
            Ok(value) => value,
            Err(obstruction) => return Ok(Err(obstruction)),
        }
    };
}
pub(crate) use attempt;

impl<R: Rng> Carrier<'_, R> {
    /// Takes an object along a way, puts it down, and comes back; home as well after the last. Where there is
    /// no spot within reach, it is brought to one `elsewhere`, if the base drives.
    pub fn take(
        &mut self,
        object: ObjectId,
        grasp: &Grasp,
        way: &Way,
        before: &Situation,
        last: bool,
        elsewhere: Option<&Elsewhere>,
    ) -> Attempt<Carried> {
        let world = self.world;
        let there = attempt!(self.come(object, grasp, way, before));
        let left = self.quicker_than - there.duration() - 2.0 * self.settings.grip_time;
        if left <= 0.0 {
            return too_slow();
        }
        // Out with it and to a spot, here or elsewhere.
        let mut carrying =
            Moment::new(before.standing.difference(ObjectSet::of(object)), grasp.closed, self.settings.margin);
        carrying.placed = world.with_unseen(before.placed(world), object);
        let Brought { across, placement, stand, base } =
            match (self.place(object, grasp, &way.postures, &carrying, left)?, elsewhere) {
                (Ok(placement), _) => {
                    let mut path = way.postures.clone();
                    path.extend(placement.transfer.iter().skip(1).cloned());
                    path.extend(placement.lower.iter().skip(1).cloned());
                    let moment = self.ready_to_carry(object, &carrying, &placement.held);
                    let timed = attempt!(self.timed(
                        &moment,
                        &path,
                        AtEnds::Resting { within: self.settings.lower_from },
                        "the transfer"
                    ));
                    Brought {
                        across: vec![self.widened(timed)],
                        placement,
                        stand: before.stand,
                        base: self.base.clone(),
                    }
                }
                (Err(obstruction), None) => return Ok(Err(obstruction)),
                (Err(obstruction), _) if obstruction.slower => return Ok(Err(obstruction)),
                (Err(_), Some(elsewhere)) => attempt!(self.bring(elsewhere, object, grasp, way, before, &carrying)),
            };

        let mut after = before.clone();
        after.standing.remove(object);
        (after.stand, after.base) = (stand, base.clone());
        let mut there_now = match elsewhere.filter(|_| stand != before.stand) {
            Some(elsewhere) => self.at(&elsewhere.stands[stand], base),
            None => self.same(),
        };
        let world_from_object = there_now.world.world_from_root * placement.pose;
        after.placed.push((object, world_from_object));
        let leaving = attempt!(there_now.leave(object, grasp, &mut after, placement.back, last));
        let mut segments = self.taking_segments(object, grasp, there, across);
        segments.extend(leaving);
        let step = self.step(object, segments, &world_from_object);
        Ok(Ok(Carried { step, after, way_blocked_by: way.blocked_by, loosely: !grasp.firm }))
    }

    /// To an object: free to its way's outer end, then along it; the hand can close there.
    fn come(&mut self, object: ObjectId, grasp: &Grasp, way: &Way, before: &Situation) -> Attempt<Timed> {
        let (there, approach) = attempt!(self.approach(object, way, before));
        match self.hand_turning(&way.postures[0], &approach, grasp.closed) {
            Touch::FREE => Ok(Ok(there)),
            Touch::Objects(touched) => obstructed("closing the hand", touched),
            Touch::Fixed => obstructed("closing the hand", ObjectSet::EMPTY),
        }
    }

    /// To an object with the hand open, and the moment in which it is there.
    fn approach(&mut self, object: ObjectId, way: &Way, before: &Situation) -> Attempt<(Timed, Moment)> {
        let world = self.world;
        let Some(entry) = way.postures.last() else { return obstructed("the way is empty", ObjectSet::EMPTY) };
        let mut free = Moment::new(before.standing, world.model.robot.hand.open(), self.settings.margin);
        free.placed = before.placed(world);
        let mut there = attempt!(self.free_motion(
            &free,
            &before.posture,
            std::slice::from_ref(entry),
            "the motion to where the hand goes in"
        ));
        there.extend(way.postures.iter().rev().skip(1).cloned());
        let mut approach = free;
        approach.gripping = Some(object);
        if world.unseen[object.index()].is_some() {
            // The hand goes round it: what it hides begins behind it.
            approach.standing.remove(object);
            approach.placed.push((object, world.placed(object, &world.poses[object.index()])));
            approach.placed = world.with_unseen(approach.placed, object);
        }
        approach.margin = self.settings.final_margin;
        let there = attempt!(self.timed(&approach, &there, AtEnds::Coming, "the approach"));
        Ok(Ok((there, approach)))
    }

    /// Lets go of an object that was put down, as `after` has it, and goes back along a path from there; home as
    /// well after the last. `after` is then as it is in the end.
    fn leave(
        &mut self,
        object: ObjectId,
        grasp: &Grasp,
        after: &mut Situation,
        back: Path,
        last: bool,
    ) -> Attempt<Vec<Segment>> {
        let Some(let_go) = back.first().cloned() else { return obstructed("the way back is empty", ObjectSet::EMPTY) };
        let back = attempt!(self.withdraw(object, after, back, last));
        Ok(Ok(self.leaving_segments(&let_go, grasp, back)))
    }

    /// The same with the hand open already.
    fn withdraw(&mut self, object: ObjectId, after: &mut Situation, back: Path, last: bool) -> Attempt<Timed> {
        let world = self.world;
        let leaving = self.leaving(object, after);
        let Some(end) = back.last().cloned() else { return obstructed("the way back is empty", ObjectSet::EMPTY) };
        let mut back = back;
        if last {
            let mut home = leaving.clone();
            home.gripping = None;
            home.margin = self.settings.margin;
            let rest = attempt!(self.free_motion(
                &home,
                &end,
                std::slice::from_ref(&world.model.robot.home),
                "the motion home"
            ));
            back.extend(rest.into_iter().skip(1));
        }
        let back = attempt!(self.timed(&leaving, &back, AtEnds::Going, "the retreat"));
        after.posture = back.positions.last().cloned().unwrap_or(end);
        Ok(Ok(back))
    }

    /// The moment in which the open hand leaves an object that was put down, or is about to.
    fn leaving(&self, object: ObjectId, after: &Situation) -> Moment {
        let world = self.world;
        let mut leaving = Moment::new(after.standing, world.model.robot.hand.open(), self.settings.final_margin);
        leaving.placed = world.with_unseen(after.placed(world), object);
        leaving.gripping = Some(object);
        leaving
    }

    /// The robot's limits, for motions that take so many times as long.
    fn limits(&self, slower: f64) -> Limits {
        let robot = &self.world.model.robot;
        Limits {
            velocity: robot.velocity.iter().map(|v| v / slower).collect(),
            acceleration: robot.acceleration.iter().map(|a| a / slower.powi(2)).collect(),
            jerk: robot.jerk.iter().map(|j| j / slower.powi(3)).collect(),
        }
    }

    fn step(&self, object: ObjectId, segments: Vec<Segment>, world_from_object: &Pose) -> Step {
        let object = self.scene.names[object.index()].clone();
        Step { object, action: Action::PickPlace, segments, placed: segments::written(world_from_object), push: None }
    }

    /// The moment in which an object is carried from where it stood: what carried it may be touched as long as
    /// it rests.
    pub(crate) fn ready_to_carry(&self, object: ObjectId, carrying: &Moment, held: &Held) -> Moment {
        let (fixtures, objects) = self.world.carriers[object.index()].clone();
        let mut held = held.clone();
        held.fixtures_below.extend(fixtures);
        held.objects_below = held.objects_below.union(objects);
        self.finished(Moment { held: Some(held), ..carrying.clone() })
    }

    /// A moment with the room that finished rows keep.
    fn finished(&self, moment: Moment) -> Moment {
        let Settings { final_margin: margin, final_held_margin: held_margin, .. } = *self.settings;
        Moment { margin, held_margin, ..moment }
    }

    /// The same, as another borrower.
    pub(crate) fn same(&mut self) -> Carrier<'_, R> {
        Carrier {
            world: self.world,
            base: self.base.clone(),
            within: self.within,
            scene: self.scene,
            inverse: self.inverse,
            settings: self.settings,
            random: &mut *self.random,
            budget: self.budget,
            trees: &mut *self.trees,
            quicker_than: self.quicker_than,
        }
    }
}

pub(crate) fn too_slow<T>() -> Attempt<T> {
    Ok(Err(Obstruction { what: "it takes too long", blamed: ObjectSet::EMPTY, slower: true }))
}

pub(crate) fn obstructed<T>(what: &'static str, blamed: ObjectSet) -> Attempt<T> {
    Ok(Err(Obstruction { what, blamed, slower: false }))
}
