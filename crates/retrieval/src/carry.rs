//! The whole motion for one object (section IV-D): to it, grip, out, to a free spot, let go, back.
//!
//! Three curves from rest to rest: transit and approach; transfer; retreat (and, for the last
//! object, home). The hand is along one of the object's [`ways`](crate::ways) while among the
//! clutter; between there and the tray the arm is free to move (RRT-Connect). Every row of the
//! result has been checked again with what was there at that time.

use crate::grasps::Grasp;
use crate::mobile::Base;
use crate::place;
use crate::stand::Stand;
use crate::ways::Way;
use clearway_collision::{Held, Lean, Moment, Obstacle, Scratch, Touch, World};
use clearway_geometry::{Mat3, Pose, Vec2, Vec3};
use clearway_motion::{
    Limits, NearEnds, Path, Posture, RrtSettings, SimplifySettings, Space, Surely, Timed, Trees, connect,
    distance, roundest, shorten, simplify, smooth, time_curve,
};
use clearway_plan::plan_file::{Action, Attached, GripperValue, PlacedPose, Segment, SegmentKind, Step};
use clearway_plan::robot_file::HandKind;
use clearway_plan::{Budget, ObjectId, ObjectSet, Stop};
use clearway_robot::InverseKinematics;
use clearway_scene::Scene;
use rand::{Rng, RngExt};
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
    /// How far above its spot an object is before it is lowered, metres.
    pub lower_from: f64,
    /// Spots for which a motion is tried before giving up.
    pub spots: usize,
    /// How far what is held may lean while it is carried, where that can be had: radians.
    pub lean: f64,
    /// Samples for a level motion before any motion will do, and upright postures to guide it.
    pub level_iterations: usize,
    pub guides: usize,
    /// Seconds for the hand to close or open, at least.
    pub grip_time: f64,
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
            spots: 4,
            lean: 0.13,
            level_iterations: 250,
            guides: 60,
            grip_time: 0.3,
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
}

impl Situation {
    /// What was put down, as it is for a robot in this world.
    pub(crate) fn placed(&self, world: &World) -> Vec<(ObjectId, Arc<Obstacle>)> {
        self.placed.iter().map(|(object, pose)| (*object, world.placed(*object, &(world.root_from_world * *pose)))).collect()
    }
}

/// A step carried out.
#[derive(Clone, Debug)]
pub struct Carried {
    pub step: Step,
    pub after: Situation,
    /// What stood in the way of the way taken, before anything was removed.
    pub way_blocked_by: ObjectSet,
}

/// Why a way could not be carried out.
#[derive(Clone, Debug)]
pub struct Obstruction {
    pub what: &'static str,
    /// Standing objects that the arm would have to pass through; empty when nothing is known.
    pub blamed: ObjectSet,
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
}

/// What is held counts as resting up to this height above where it stood, metres.
const RESTING: f64 = 0.008;

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

/// Other stands that something can be brought to, and what drives there.
pub struct Elsewhere<'a> {
    pub(crate) base: &'a Base,
    pub(crate) stands: &'a [Stand],
    /// Those with places in reach, the best first.
    pub(crate) order: Vec<usize>,
}

/// An object brought to above its spot.
struct Brought {
    /// Rows with the base's values.
    across: Vec<Timed>,
    placement: Placement,
    /// Where the robot is then.
    stand: usize,
    base: Vec<f64>,
}

/// Where an object goes, and how the hand gets there and away.
struct Placement {
    /// root_from_object
    pose: Pose,
    /// From above the spot down to it.
    lower: Path,
    /// From the spot back, the hand open.
    back: Path,
    held: Held,
    /// Free motion from the end of the way to above the spot.
    transfer: Path,
}

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
        let Some(entry) = way.postures.last().cloned() else {
            return obstructed("the way is empty", ObjectSet::EMPTY);
        };
        let open = world.model.robot.hand.open();
        let mut free = Moment::new(before.standing, open, self.settings.margin);
        free.placed = before.placed(world);

        // To the object: free to the way's outer end, then along it.
        let mut there = attempt!(self.free_motion(&free, &before.posture, std::slice::from_ref(&entry), "the motion to where the hand goes in"));
        there.extend(way.postures.iter().rev().skip(1).cloned());
        let mut approach = free.clone();
        approach.gripping = Some(object);
        if world.unseen[object.index()].is_some() {
            // The hand goes round it: what it hides begins behind it.
            approach.standing.remove(object);
            approach.placed.push((object, world.placed(object, &world.poses[object.index()])));
            approach.placed = world.with_unseen(approach.placed, object);
        }
        approach.margin = self.settings.final_margin;
        let there = attempt!(self.timed(&approach, &there, None, "the approach"));
        match self.hand_turning(&way.postures[0], &approach, grasp.closed) {
            Touch::FREE => {}
            Touch::Objects(touched) => return obstructed("closing the hand", touched),
            Touch::Fixed => return obstructed("closing the hand", ObjectSet::EMPTY),
        }

        // Out with it and to a spot, here or elsewhere.
        let mut carrying = Moment::new(before.standing.difference(ObjectSet::of(object)), grasp.closed, self.settings.margin);
        carrying.placed = world.with_unseen(free.placed, object);
        let Brought { across, placement, stand, base } = match (self.place(object, grasp, &entry, &carrying)?, elsewhere) {
            (Ok(placement), _) => {
                let mut path = way.postures.clone();
                path.extend(placement.transfer.iter().skip(1).cloned());
                path.extend(placement.lower.iter().skip(1).cloned());
                let mut moment = self.ready_to_carry(object, &carrying, &placement.held);
                moment.margin = self.settings.final_margin;
                moment.held_margin = self.settings.final_held_margin;
                let timed = attempt!(self.timed(&moment, &path, Some(self.settings.lower_from), "the transfer"));
                Brought { across: vec![self.widened(timed)], placement, stand: before.stand, base: self.base.clone() }
            }
            (Err(obstruction), None) => return Ok(Err(obstruction)),
            (Err(_), Some(elsewhere)) => attempt!(self.bring(elsewhere, object, grasp, way, before, &carrying)),
        };

        // Back, and home.
        let mut after = before.clone();
        after.standing.remove(object);
        (after.stand, after.base) = (stand, base.clone());
        let mut there_now = match elsewhere.filter(|_| stand != before.stand) {
            Some(elsewhere) => self.at(&elsewhere.stands[stand], base.clone()),
            None => self.same(),
        };
        let world = there_now.world;
        let world_from_object = world.world_from_root * placement.pose;
        after.placed.push((object, world_from_object));
        let mut leaving = Moment::new(after.standing, open, there_now.settings.final_margin);
        leaving.placed = world.with_unseen(after.placed(world), object);
        leaving.gripping = Some(object);
        let mut back = placement.back;
        let let_go = across.last().and_then(|t| t.positions.last()).map_or(Posture::new(), |row| row[base.len()..].to_vec());
        let retreat_end = back.last().cloned().unwrap_or_else(|| let_go.clone());
        if last {
            let mut home = leaving.clone();
            home.gripping = None;
            home.margin = there_now.settings.margin;
            let rest = attempt!(there_now.free_motion(&home, &retreat_end, std::slice::from_ref(&world.model.robot.home), "the motion home"));
            back.extend(rest.into_iter().skip(1));
        }
        let back = attempt!(there_now.timed(&leaving, &back, None, "the retreat"));
        after.posture = back.positions.last().cloned().unwrap_or(retreat_end);
        let leaving = there_now.leaving_segments(&let_go, grasp, back);

        let mut segments = self.taking_segments(object, grasp, there, across);
        segments.extend(leaving);
        let placed = written(&world_from_object);
        let step = Step { object: self.scene.names[object.index()].clone(), action: Action::PickPlace, segments, placed };
        Ok(Ok(Carried { step, after, way_blocked_by: way.blocked_by }))
    }

    /// The moment in which an object is carried from where it stood: what carried it may be touched as long as
    /// it rests.
    fn ready_to_carry(&self, object: ObjectId, carrying: &Moment, held: &Held) -> Moment {
        let (fixtures, objects) = self.world.carriers[object.index()].clone();
        let mut held = held.clone();
        held.fixtures_below.extend(fixtures);
        held.objects_below = held.objects_below.union(objects);
        Moment { held: Some(held), ..carrying.clone() }
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
        }
    }

    /// The same at another stand.
    fn at<'b>(&'b mut self, stand: &'b Stand, base: Vec<f64>) -> Carrier<'b, R> {
        Carrier { world: &stand.world, base, ..self.same() }
    }

    /// Brings an object that hangs on to a way's end to another stand, and to above a spot there.
    fn bring(&mut self, elsewhere: &Elsewhere, object: ObjectId, grasp: &Grasp, way: &Way, before: &Situation, carrying: &Moment) -> Attempt<Brought> {
        /// Postures to drive in that are tried, and stands for each.
        const POSTURES: usize = 3;
        const STANDS: usize = 4;
        let world = self.world;
        let mut held = world.in_hand(object, &grasp.object_from_tool);
        held.kernel = Some(world.model.holding(&held.solid()));
        let mut hanging = carrying.clone();
        hanging.held = Some(held.clone());
        let mut failed = Obstruction { what: "no spot is left on the places that the hand can reach with the object", blamed: ObjectSet::EMPTY };
        let entry = way.postures.last().cloned().unwrap_or_default();
        for tucked in self.driving_postures(grasp, &hanging, &entry).into_iter().take(POSTURES) {
            self.budget.check()?;
            let mut out = match self.level_motion(&hanging, &entry, &tucked, "drawing in what is carried")? {
                Ok(out) => out,
                Err(obstruction) => {
                    failed = obstruction;
                    continue;
                }
            };
            for &stand in elsewhere.order.iter().take(STANDS) {
                let there = &elsewhere.stands[stand];
                let mut carrying = Moment::new(carrying.standing, grasp.closed, self.settings.margin);
                carrying.placed = before.placed(&there.world);
                let placement = match self.at(there, Vec::new()).place(object, grasp, &tucked, &carrying)? {
                    Ok(placement) => placement,
                    Err(obstruction) => {
                        failed = obstruction;
                        continue;
                    }
                };
                let drive = match elsewhere.base.drive(self, before, &there.placement, &tucked, Some((object, grasp)))? {
                    Ok(drive) => drive,
                    Err(obstruction) => {
                        failed = obstruction;
                        continue;
                    }
                };
                let mut lifting = self.ready_to_carry(object, &hanging, &held);
                lifting.margin = self.settings.final_margin;
                lifting.held_margin = self.settings.final_held_margin;
                let mut path = way.postures.clone();
                path.extend(out.drain(1..));
                let out = attempt!(self.timed(&lifting, &path, Some(self.settings.lower_from), "the transfer"));
                let out = self.widened(out);
                let mut lowering = carrying.clone();
                lowering.held = Some(placement.held.clone());
                lowering.margin = self.settings.final_margin;
                lowering.held_margin = self.settings.final_held_margin;
                let mut path = placement.transfer.clone();
                path.extend(placement.lower.iter().skip(1).cloned());
                let base: Vec<f64> = drive.positions.last().map_or(Vec::new(), |row| row[..self.base.len()].to_vec());
                let lower_from = Some(self.settings.lower_from);
                let mut other = self.at(there, base.clone());
                let down = attempt!(other.timed(&lowering, &path, lower_from, "the transfer"));
                let down = other.widened(down);
                return Ok(Ok(Brought { across: vec![out, drive, down], placement, stand, base }));
            }
        }
        Ok(Err(failed))
    }

    /// Postures that hold what hangs in the hand upright and near, those that reach out least first.
    fn driving_postures(&self, grasp: &Grasp, hanging: &Moment, entry: &Posture) -> Vec<Posture> {
        const OUT: [f64; 5] = [0.3, 0.4, 0.5, 0.6, 0.75];
        const BEARINGS: usize = 12;
        const RAISED: [f64; 2] = [0.05, 0.2];
        let world = self.world;
        let kinematics = &world.model.kinematics;
        let up = world.up();
        let tool = kinematics.tool(entry, hanging.hand);
        let pointing = tool.rotation.z_axis;
        let height = up * tool.translation.dot(up);
        let mut space = Space::quick(world, hanging, self.settings.step);
        let mut frames = Vec::new();
        let mut found: Vec<(f64, Posture)> = Vec::new();
        for out in OUT {
            for bearing in 0..BEARINGS {
                let bearing = std::f64::consts::TAU * bearing as f64 / BEARINGS as f64;
                let away = world.root_from_world.rotation * Vec3::new(bearing.cos(), bearing.sin(), 0.0);
                for aside in [0.0, 0.8, -0.8] {
                    let pointing_at = pointing.truncate().to_angle();
                    let turn = Mat3::from_axis_angle(up, away.truncate().to_angle() + aside - pointing_at);
                    for raised in RAISED {
                        let at = Pose::new(turn * tool.rotation, height + up * raised + away * out);
                        let near = self.inverse.solve(&at, entry);
                        let off = |q: &Posture| distance(q, entry);
                        let Some(q) = near.into_iter().min_by(|a, b| off(a).total_cmp(&off(b))) else { continue };
                        if !space.free(&q) {
                            continue;
                        }
                        kinematics.frames(&q, hanging.hand, &mut frames);
                        let flat = |p: Vec3| (p - up * p.dot(up)).length();
                        let links = world.model.links.iter().zip(&frames);
                        let arm = links.filter_map(|(l, f)| l.as_ref().map(|l| flat(f.point(l.bound.centre)) + l.bound.radius));
                        let carried = flat((frames[kinematics.tool] * grasp.object_from_tool.inverse()).translation);
                        let held = hanging.held.as_ref().map_or(0.0, Held::radius);
                        found.push((arm.fold(carried + held, f64::max) + 0.02 * distance(&q, entry), q));
                    }
                }
            }
            if found.len() >= 8 {
                break;
            }
        }
        found.sort_by(|a, b| a.0.total_cmp(&b.0));
        found.into_iter().map(|(_, q)| q).collect()
    }

    /// To the resting posture, for a drive.
    pub fn tuck(&mut self, before: &Situation) -> Attempt<Vec<Segment>> {
        let world = self.world;
        let home = &world.model.robot.home;
        if before.posture == *home {
            return Ok(Ok(Vec::new()));
        }
        let mut free = Moment::new(before.standing, world.model.robot.hand.open(), self.settings.margin);
        free.placed = before.placed(world);
        let path = attempt!(self.free_motion(&free, &before.posture, std::slice::from_ref(home), "the motion home, for driving"));
        free.margin = self.settings.final_margin;
        let timed = attempt!(self.timed(&free, &path, None, "the motion home, for driving"));
        Ok(Ok(vec![self.transit(timed)]))
    }

    /// A motion with an open hand that is no approach and no retreat.
    pub fn transit(&self, timed: Timed) -> Segment {
        let open = self.world.model.robot.hand.open();
        segment(SegmentKind::Transit, self.widened(timed), self.gripper(GripperValue::Held(open)), None)
    }

    /// The base's values before the arm's.
    fn widened(&self, mut timed: Timed) -> Timed {
        if !self.base.is_empty() {
            timed.positions.iter_mut().for_each(|row| *row = self.base.iter().chain(row.iter()).copied().collect());
        }
        timed
    }

    /// What the robot touches while its hand turns from where a moment has it to another value: fingers may
    /// swing outwards on their way.
    fn hand_turning(&self, posture: &Posture, moment: &Moment, to: f64) -> Touch {
        const STEPS: usize = 16;
        let mut scratch = Scratch::default();
        let mut touched = ObjectSet::EMPTY;
        for i in 1..=STEPS {
            let hand = moment.hand + (to - moment.hand) * i as f64 / STEPS as f64;
            match self.world.touched(posture, &Moment { hand, ..moment.clone() }, &mut scratch) {
                Touch::Fixed => return Touch::Fixed,
                Touch::Objects(set) => touched = touched.union(set),
            }
        }
        Touch::Objects(touched)
    }

    /// A free motion, shortened. When none is found, a motion that may pass through objects tells
    /// which of them stand in the way.
    pub(crate) fn free_motion(&mut self, moment: &Moment, start: &Posture, goals: &[Posture], what: &'static str) -> Attempt<Path> {
        // Ends may be nearer to things than free motion likes to be; then it has to do with less.
        let mut near = moment.clone();
        let mut space = Space::quick(self.world, moment, self.settings.step).within(self.within);
        if !space.free(start) || !goals.iter().any(|g| space.free(g)) {
            near.margin = self.settings.final_margin;
            near.held_margin = self.settings.final_held_margin;
            space = Space::quick(self.world, &near, self.settings.step).within(self.within);
        }
        if let Some(path) = self.connect(&mut space, start, goals, &[], self.settings.rrt.iterations)? {
            return Ok(Ok(path));
        }
        let mut relaxed = near.clone();
        relaxed.standing = ObjectSet::EMPTY;
        let mut space = Space::quick(self.world, &relaxed, self.settings.step).within(self.within);
        let Some(path) = self.connect(&mut space, start, goals, &[], self.settings.rrt.iterations)? else {
            return obstructed(what, ObjectSet::EMPTY);
        };
        let blamed = Space::quick(self.world, &near, self.settings.step).path_touched(&path).unwrap_or_default();
        obstructed(what, blamed)
    }

    /// A shortened path: among motions that the kernel calls free if there is one, else among all
    /// that are.
    fn connect(
        &mut self,
        space: &mut Space,
        start: &Posture,
        goals: &[Posture],
        guides: &[Posture],
        iterations: usize,
    ) -> Result<Option<Path>, Stop> {
        let rrt = RrtSettings { iterations, ..self.settings.rrt.clone() };
        let mut surely = Surely(space);
        let mut sampler = NearEnds::new(&surely, start, goals, guides, self.settings.near, self.random);
        if let Some(path) = connect(&mut surely, start, goals, &mut sampler, &rrt, self.trees, self.budget)? {
            return Ok(Some(simplify(&mut surely, path, &self.settings.simplify, self.budget)?));
        }
        let mut sampler = NearEnds::new(space, start, goals, guides, self.settings.near, self.random);
        match connect(space, start, goals, &mut sampler, &rrt, self.trees, self.budget)? {
            Some(path) => Ok(Some(shorten(space, path, self.settings.shortcuts, self.random, self.budget)?)),
            None => Ok(None),
        }
    }

    /// Smooths and times a path, and checks every row. `resting_within`: near the path's ends, by
    /// this much of the tool's way, what is held may rest on what carries it.
    pub(crate) fn timed(&mut self, moment: &Moment, path: &Path, resting_within: Option<f64>, what: &'static str) -> Attempt<Timed> {
        let robot = &self.world.model.robot;
        let limits =
            Limits { velocity: robot.velocity.clone(), acceleration: robot.acceleration.clone(), jerk: robot.jerk.clone() };
        let mut lenient = moment.clone();
        lenient.resting = resting_within.is_some();
        let mut strict = Space::quick(self.world, moment, self.settings.final_step);
        let mut resting = Space::quick(self.world, &lenient, self.settings.final_step);
        let mut timed = Timed::default();
        // As round as can be; where that touches something, only as round as is free.
        for careful in [false, true] {
            self.budget.check()?;
            let curve = match careful {
                false => roundest(path),
                true => smooth(&mut Space::quick(self.world, &lenient, self.settings.step), path),
            };
            timed = time_curve(&curve, &limits, self.settings.row);
            let rows = &timed.positions;
            if rows.len() < 2 {
                return obstructed(what, ObjectSet::EMPTY);
            }
            let (from, to) = self.resting_rows(moment, rows, resting_within);
            if resting.rows_free(&rows[..=from]) && strict.rows_free(&rows[from..=to]) && resting.rows_free(&rows[to..]) {
                return Ok(Ok(timed));
            }
        }
        let blamed = resting.path_touched(&timed.positions).unwrap_or_default();
        obstructed(what, blamed)
    }

    /// The rows between which what is held is off what carries it: near both ends of a motion it may
    /// rest, as long as it is no higher than it is lifted there, or lowered.
    fn resting_rows(&self, moment: &Moment, rows: &[Posture], resting_within: Option<f64>) -> (usize, usize) {
        let Some(reach) = resting_within else { return (0, rows.len() - 1) };
        let tool = |q: &Posture| self.world.model.kinematics.tool(q, moment.hand).translation;
        let (first, last) = (tool(&rows[0]), tool(&rows[rows.len() - 1]));
        let low = |q: &Posture, end: Vec3| {
            let off = tool(q) - end;
            off.dot(self.world.up()).abs() < RESTING && off.length() < reach
        };
        let from = rows.iter().position(|q| !low(q, first)).unwrap_or(rows.len() - 1);
        let to = rows.iter().rposition(|q| !low(q, last)).unwrap_or(from).max(from);
        (from, to)
    }

    /// A free motion with the object in hand: level if one is found soon, otherwise any.
    fn level_motion(&mut self, moment: &Moment, start: &Posture, goal: &Posture, what: &'static str) -> Attempt<Path> {
        let world = self.world;
        let up = world.up();
        let (from, to) = (world.model.kinematics.tool(start, moment.hand), world.model.kinematics.tool(goal, moment.hand));
        let level = Moment {
            lean: Some(Lean { axis: from.rotation.transpose() * up, upward: up, least: self.settings.lean.cos() }),
            ..moment.clone()
        };
        let mut space = Space::quick(world, &level, self.settings.step);
        let mut path = None;
        if space.free(start) && space.free(goal) {
            if space.line_free(start, goal) {
                path = Some(vec![start.clone(), goal.clone()]);
            } else {
                // Postures in between that hold the object upright, for the trees to grow towards.
                let (low, high) = (from.translation.min(to.translation) - 0.25, from.translation.max(to.translation) + 0.25);
                let mut guides = Vec::new();
                for _ in 0..self.settings.guides {
                    self.budget.check()?;
                    let mut at = || self.random.random::<f64>();
                    let turn = Mat3::from_axis_angle(up, std::f64::consts::TAU * at());
                    let position = low + (high - low) * Vec3::new(at(), at(), at());
                    let near = self.inverse.solve(&Pose::new(turn * from.rotation, position), start);
                    let off = |q: &Posture| distance(q, start) + distance(q, goal);
                    guides.extend(near.into_iter().min_by(|a, b| off(a).total_cmp(&off(b))));
                }
                path = self.connect(&mut space, start, std::slice::from_ref(goal), &guides, self.settings.level_iterations)?;
            }
        }
        match path {
            Some(path) => Ok(Ok(path)),
            None => self.free_motion(moment, start, std::slice::from_ref(goal), what),
        }
    }

    /// Finds a spot that the hand can reach with the object and leave without it.
    fn place(&mut self, object: ObjectId, grasp: &Grasp, entry: &Posture, carrying: &Moment) -> Attempt<Placement> {
        let world = self.world;
        let scene_pose = world.world_from_root * world.poses[object.index()];
        let base = world.world_from_root.translation.truncate();
        let forward = (scene_pose * grasp.object_from_tool).rotation.z_axis.truncate();
        let mut held = world.in_hand(object, &grasp.object_from_tool);
        held.kernel = Some(world.model.holding(&held.solid()));
        let mut tries = 0;
        let mut blamed = ObjectSet::EMPTY;
        for spot in place::spots(&self.scene.places, base) {
            self.budget.check()?;
            for yaw in yaws(forward, spot.at.truncate() - base) {
                let place = &self.scene.places[spot.place];
                let Some(world_from_object) =
                    place::standing_at(&world.solids[object.index()], &scene_pose, yaw, &spot, place)
                else {
                    continue;
                };
                let pose = world.root_from_world * world_from_object;
                let Some(placement) = self.put_down(&held, grasp, entry, carrying, pose) else { continue };
                let mut moment = carrying.clone();
                moment.held = Some(placement.held.clone());
                tries += 1;
                let above = placement.lower[0].clone();
                match self.level_motion(&moment, entry, &above, "the motion to the place with the object in hand")? {
                    Ok(transfer) => return Ok(Ok(Placement { transfer, ..placement })),
                    Err(obstruction) => blamed = blamed.union(obstruction.blamed),
                }
                if tries >= self.settings.spots {
                    return obstructed("the motion to the place with the object in hand", blamed);
                }
                break;
            }
        }
        if tries > 0 {
            return obstructed("the motion to the place with the object in hand", blamed);
        }
        obstructed("no spot is left on the places that the hand can reach with the object", ObjectSet::EMPTY)
    }

    /// Whether the object can be lowered onto a spot and let go of there.
    fn put_down(&mut self, held: &Held, grasp: &Grasp, entry: &Posture, carrying: &Moment, pose: Pose) -> Option<Placement> {
        const LOWER_STEP: f64 = 0.02;
        const BACK_STEP: f64 = 0.025;
        let world = self.world;
        let object = held.object;
        let placed = world.placed(object, &pose);
        let overlap = |a: &Obstacle, b: &Obstacle| {
            b.near_bound(a.bound.centre, a.bound.radius, 0.0)
                && a.parts.iter().any(|p| b.parts.iter().any(|o| o.near_convex(&p.convex, &p.root_from_part, self.settings.margin)))
        };
        if carrying.placed.iter().any(|(_, o)| overlap(&placed, o)) || carrying.standing.iter().any(|id| overlap(&placed, &world.objects[id.index()])) {
            return None;
        }
        // It comes down from above, clear of all but what will carry it.
        let above = world.placed(object, &Pose::new(pose.rotation, pose.translation + world.up() * LOWER_STEP));
        if world.fixtures.iter().any(|f| overlap(&above, f)) {
            return None;
        }
        let at = pose * grasp.object_from_tool;
        let mut branches = self.inverse.solve(&at, entry);
        branches.sort_by(|a, b| distance(a, entry).total_cmp(&distance(b, entry)));
        if branches.is_empty() {
            return None;
        }
        let (fixtures_below, objects_below) = world.below(object, &pose);
        let held = Held { fixtures_below, objects_below, ..held.clone() };
        let mut resting = carrying.clone();
        resting.held = Some(held.clone());
        resting.resting = true;
        let mut lowering = resting.clone();
        lowering.resting = false;
        let mut leaving = Moment::new(carrying.standing, world.model.robot.hand.open(), self.settings.margin);
        leaving.placed = carrying.placed.clone();
        leaving.placed.push((object, placed));
        leaving.gripping = Some(object);
        let standoff = world.model.robot.grasps.standoff;
        let mut resting = Space::quick(world, &resting, self.settings.step);
        let mut lowering = Space::quick(world, &lowering, self.settings.step);
        let mut leaving = Space::quick(world, &leaving, self.settings.step);
        'branch: for down in branches {
            if !resting.free(&down) {
                continue;
            }
            let mut lower = vec![down.clone()];
            let mut height = 0.0;
            while height < self.settings.lower_from - 1e-9 {
                height += LOWER_STEP;
                let target = Pose::new(at.rotation, at.translation + world.up() * height);
                let Some(q) = self.inverse.follow(&target, &lower, 0.5) else { continue 'branch };
                if !lowering.free(&q) {
                    continue 'branch;
                }
                lower.push(q);
            }
            lower.reverse();
            // Opening, the fingers need room between what stands there already.
            if !leaving.free(&down) || self.hand_turning(&down, leaving.moment, grasp.closed) != Touch::FREE {
                continue;
            }
            let mut back = vec![down];
            let mut out = 0.0;
            while out < standoff - 1e-9 {
                out += BACK_STEP;
                let target = Pose::new(at.rotation, at.translation - at.rotation.z_axis * out);
                let Some(q) = self.inverse.follow(&target, &back, 0.5) else { continue 'branch };
                if !leaving.free(&q) {
                    continue 'branch;
                }
                back.push(q);
            }
            return Some(Placement { pose, lower, back, held, transfer: Path::new() });
        }
        None
    }

    /// To the object, the grasp, and away with it: the rows of `there` are the arm's alone.
    fn taking_segments(&self, object: ObjectId, grasp: &Grasp, there: Timed, across: Vec<Timed>) -> Vec<Segment> {
        let robot = &self.world.model.robot;
        let standoff = robot.grasps.standoff;
        let (open, closed) = (robot.hand.open(), grasp.closed);
        let held = |value: f64| -> BTreeMap<String, GripperValue> { self.gripper(GripperValue::Held(value)) };
        let attached = Attached {
            object: self.scene.names[object.index()].clone(),
            tool: robot.links[robot.hand.frame].name.clone(),
            pose_in_tool: written(&grasp.object_from_tool.inverse()),
        };
        let gripped = there.positions.last().cloned().unwrap_or_default();
        let tool = |q: &Posture| self.world.model.kinematics.tool(q, open).translation;
        let mut segments = Vec::new();
        let begins = there.positions.iter().rposition(|q| tool(q).distance(tool(&gripped)) > standoff);
        let (transit, approach) = split(there, begins);
        segments.extend(transit.map(|t| segment(SegmentKind::Transit, self.widened(t), held(open), None)));
        segments.extend(approach.map(|t| segment(SegmentKind::Approach, self.widened(t), held(open), None)));
        segments.push(self.grip(SegmentKind::Grasp, &gripped, open, closed));
        segments.extend(across.into_iter().map(|t| segment(SegmentKind::Transfer, t, held(closed), Some(attached.clone()))));
        segments
    }

    /// Letting go, and away from it.
    fn leaving_segments(&self, let_go: &Posture, grasp: &Grasp, back: Timed) -> Vec<Segment> {
        let robot = &self.world.model.robot;
        let standoff = robot.grasps.standoff;
        let open = robot.hand.open();
        let tool = |q: &Posture| self.world.model.kinematics.tool(q, open).translation;
        let mut segments = vec![self.grip(SegmentKind::Release, let_go, grasp.closed, open)];
        let ends = back.positions.iter().position(|q| tool(q).distance(tool(let_go)) >= standoff - 1e-6);
        let (retreat, home) = split(back, ends);
        let away = |kind, t| segment(kind, self.widened(t), self.gripper(GripperValue::Held(open)), None);
        segments.extend(retreat.map(|t| away(SegmentKind::Retreat, t)));
        segments.extend(home.map(|t| away(SegmentKind::Transit, t)));
        segments
    }

    /// The arm stands still while the hand's joint goes from one value to another.
    fn grip(&self, kind: SegmentKind, posture: &Posture, from: f64, to: f64) -> Segment {
        let robot = &self.world.model.robot;
        let speed = robot.hand.joint.map_or(f64::INFINITY, |j| robot.joints[j].velocity);
        // A cosine ramp is at its fastest π/2 times its mean.
        let needed = (to - from).abs() / speed * std::f64::consts::FRAC_PI_2 * 1.05;
        let total = needed.max(self.settings.grip_time);
        let count = (total / self.settings.row).ceil() as usize;
        let times: Vec<f64> = (0..=count).map(|i| total * i as f64 / count as f64).collect();
        let ramp = |t: f64| (1.0 - (std::f64::consts::PI * t / total).cos()) / 2.0;
        let mut values: Vec<f64> = times.iter().map(|&t| from + (to - from) * ramp(t)).collect();
        values[0] = from;
        values[count] = to;
        let positions = vec![posture.clone(); times.len()];
        segment(kind, self.widened(Timed { times, positions }), self.gripper(GripperValue::Rows(values)), None)
    }

    fn gripper(&self, value: GripperValue) -> BTreeMap<String, GripperValue> {
        let robot = &self.world.model.robot;
        match (&robot.hand.kind, robot.hand.joint) {
            (HandKind::Parallel, Some(joint)) => BTreeMap::from([(robot.joints[joint].name.clone(), value)]),
            _ => BTreeMap::new(),
        }
    }
}

pub(crate) fn obstructed<T>(what: &'static str, blamed: ObjectSet) -> Attempt<T> {
    Ok(Err(Obstruction { what, blamed }))
}

/// How far the object is turned about the vertical when put down, so that the hand points away
/// from the robot there, or nearly.
fn yaws(forward: Vec2, outward: Vec2) -> impl Iterator<Item = f64> {
    let straight = if forward.length() > 0.1 { forward.angle_to(outward) } else { 0.0 };
    [0.0, 20.0, -20.0, 40.0, -40.0, 65.0, -65.0, 90.0, -90.0, 130.0, -130.0, 180.0f64].into_iter().map(move |d| straight + d.to_radians())
}

fn segment(kind: SegmentKind, timed: Timed, gripper: BTreeMap<String, GripperValue>, attached: Option<Attached>) -> Segment {
    Segment { kind, times: timed.times, positions: timed.positions, gripper, attached }
}

/// Parts a motion at a row, which both halves have; a half without motion is `None`.
fn split(timed: Timed, at: Option<usize>) -> (Option<Timed>, Option<Timed>) {
    let Some(at) = at else { return (None, Some(timed)) };
    if at + 1 >= timed.positions.len() {
        return (Some(timed), None);
    }
    let offset = timed.times[at];
    let late = Timed {
        times: timed.times[at..].iter().map(|t| t - offset).collect(),
        positions: timed.positions[at..].to_vec(),
    };
    if at == 0 {
        return (None, Some(late));
    }
    let early = Timed { times: timed.times[..=at].to_vec(), positions: timed.positions[..=at].to_vec() };
    (Some(early), Some(late))
}

fn written(pose: &Pose) -> PlacedPose {
    let p: Vec3 = pose.translation;
    PlacedPose { position: p.to_array(), quaternion: pose.quaternion() }
}
