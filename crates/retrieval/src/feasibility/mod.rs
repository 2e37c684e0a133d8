//! Section IV-D: what the robot itself can do. Whether an object can be picked once certain others are
//! gone, what would have to go first, and the motions.
//!
//! Task planners differ in which objects they ask about, and in what order; they share these answers.
//! What was found out about an object's ways is kept: removal is monotone.

mod journey;
mod pushes;
mod stops;

pub use journey::{Journey, NoMotion};
pub use pushes::NoPush;

use crate::barriers::Barriers;
use crate::bound::{DOUBT, Prover};
use crate::carry;
use crate::floor::Floor;
use crate::grasps::declared;
use crate::mobile::{self, Base};
use crate::order::WaysIn;
use crate::place;
use crate::push;
use crate::roadmap::Roadmap;
use crate::stand::{Stand, Tools};
use crate::trace;
use crate::ways::{self, Explorer, Stage, Way, Ways};
use clearway_collision::{CollisionModel, Contact, Moment, Scratch, Touch, World};
use clearway_geometry::{Pose, Vec2};
use clearway_motion::{Posture, Trees};
use clearway_plan::plan_file::{LowerBound, PlanFile};
use clearway_plan::{Budget, ObjectId, ObjectSet, Stop};
use clearway_robot::{InverseKinematics, Placement, Robot};
use clearway_scene::Scene;
use serde_json::json;
use std::sync::Arc;

/// The scene cannot be planned for at all.
#[derive(Clone, Debug)]
pub enum Unfit {
    /// The start posture touches these.
    StartInCollision(Vec<Contact>),
    /// The start posture is nearer to these than the clearance asked for.
    StartTooNear(Vec<Contact>),
    /// The start names no such joint, or lies outside its limits.
    BadStart(String),
    /// There is no place, or none that could hold the object, whatever stands there.
    NoPlace(String),
    /// Nothing can be seen with the camera.
    Camera(String),
    /// The base does not fit into the region it may drive in.
    Region(String),
    /// Such a scene is not planned for with a base that drives.
    Drives(String),
}

/// One way to an object: from which stand, and which of the ways there.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Taking {
    pub stand: usize,
    pub way: usize,
}

/// What the robot can do in one scene.
pub struct Feasibility {
    pub(crate) scene: Scene,
    pub(crate) floor: Floor,
    pub(crate) inverse: InverseKinematics,
    pub(crate) settings: ways::Settings,
    pub(crate) carrying: carry::Settings,
    pub(crate) pushing: push::Settings,
    /// Of the arm.
    start: Posture,
    /// Where the robot stands, or could: the start first. A base that does not drive has no other.
    pub(crate) stands: Vec<Stand>,
    /// What drives it from one to the other.
    pub(crate) base: Option<Box<Base>>,
    pub(crate) scratch: Scratch,
    pub(crate) trees: Trees,
    /// Whether the arm goes home after the target.
    homing: bool,
}

/// What a search came to.
#[derive(Clone, Debug)]
pub enum Ending {
    /// These were carried, in this order; the target is last.
    Solved(Vec<ObjectId>),
    /// Proved: the target is never taken, nor are these, of which some stand in each of its ways.
    Impossible(ObjectSet),
    /// Nothing is proved; without a reason the search had nothing left to try.
    Stopped(Option<Stop>),
}

impl Feasibility {
    pub fn new(
        scene: Scene,
        model: Arc<CollisionModel>,
        settings: ways::Settings,
        carrying: carry::Settings,
        pushing: push::Settings,
        mobile: mobile::Settings,
    ) -> Result<Self, Unfit> {
        let (settings, carrying) =
            (settings.with_clearance(scene.clearance()), carrying.with_clearance(scene.clearance()));
        let mut posture = start_posture(&scene, &model.robot)?;
        let (base, placement, world) = match &model.standing {
            None => (None, Placement::default(), World::new(model, &scene)),
            Some(standing) => {
                let start: Placement = std::array::from_fn(|i| posture[i]);
                posture.drain(..start.len());
                let base = Base::new(&scene, model.clone(), standing, start, mobile)?;
                let there = Scene { base: base.world_from_root(start), ..scene.clone() };
                (Some(Box::new(base)), start, World::new(standing.model.clone(), &there))
            }
        };
        let robot = world.model.robot.clone();
        let inverse = InverseKinematics::new(&robot, &world.model.kinematics);
        // What is hard to reach from one stop is easily reached from another.
        let drives = base.as_ref().is_some_and(|base| base.settings.drives);
        let inverse = if drives { inverse.without_slivers() } else { inverse };
        let floor = floor(&scene, &robot, base.is_some());
        let stands = vec![Stand::new(placement, world)];
        let (scratch, trees) = (Scratch::default(), Trees::default());
        let new = Self {
            scene,
            floor,
            inverse,
            settings,
            carrying,
            pushing,
            start: posture,
            stands,
            base,
            scratch,
            trees,
            homing: true,
        };
        new.start_is_free(&new.start)?;
        let scene = &new.scene;
        if scene.places.is_empty() {
            return Err(Unfit::NoPlace("the scene has no `place` to put things on".to_owned()));
        }
        let target = &scene.objects[scene.target.index()];
        if !place::fits_somewhere(&target.solid, &target.pose, &scene.places) {
            return Err(Unfit::NoPlace(format!("no `place` is large enough for the target `{}`", target.id)));
        }
        Ok(new)
    }

    pub fn scene(&self) -> &Scene {
        &self.scene
    }

    /// The whole robot, a mobile base included.
    pub fn robot(&self) -> &Arc<Robot> {
        &self.model().robot
    }

    pub(crate) fn model(&self) -> &Arc<CollisionModel> {
        self.base.as_ref().map_or(&self.stands[0].world.model, |base| &base.model)
    }

    /// The scene from above.
    pub fn floor(&self) -> &Floor {
        &self.floor
    }

    /// Where the arm's root link is at the start, seen from above, in the scene's frame.
    pub fn base(&self) -> Vec2 {
        self.stands[0].world.world_from_root.translation.truncate()
    }

    /// The arm is here now; a mobile base, whose joints come first, too.
    pub fn set_start(&mut self, start: Posture) -> Result<(), Unfit> {
        let mut start = start;
        if let Some(base) = &mut self.base {
            let placement: Placement = std::array::from_fn(|i| start[i]);
            start.drain(..placement.len());
            if placement != self.stands[0].placement {
                base.start = placement;
                base.chosen = false;
                self.stands.truncate(1);
                self.stands[0] = stand_at(&self.scene, &self.stands[0].world.model, base, placement);
            }
        }
        self.start_is_free(&start)?;
        self.start = start;
        Ok(())
    }

    /// Whether the arm goes home after the target; it does unless told otherwise.
    pub fn set_homing(&mut self, homing: bool) {
        self.homing = homing;
    }

    /// Everything anew but the robot and where it stands.
    pub fn set_scene(&mut self, scene: Scene) {
        self.stands.truncate(1);
        self.stands[0].world.set_scene(&scene);
        self.stands[0].ways = vec![None; scene.objects.len()];
        self.settings.loosely = false;
        self.floor = floor(&scene, self.robot(), self.base.is_some());
        if let Some(base) = &mut self.base {
            base.set_scene(&scene);
        }
        self.scene = scene;
    }

    /// Another object is wanted.
    pub(crate) fn retarget(&mut self, target: ObjectId) {
        self.scene.target = target;
        self.floor = floor(&self.scene, self.robot(), self.base.is_some());
        if let Some(base) = &mut self.base {
            base.chosen = false;
            self.stands.truncate(1);
        }
    }

    fn start_is_free(&self, start: &Posture) -> Result<(), Unfit> {
        const MARGIN: f64 = 1e-5;
        let contacts = |margin: f64| match &self.base {
            Some(base) => base.contacts(&self.stands[0].placement, start, margin),
            None => {
                let moment = Moment::new(ObjectSet::first(self.scene.objects.len()), self.robot().hand.open(), 0.0);
                self.stands[0].world.contacts(&self.scene, start, &moment, margin)
            }
        };
        let found = contacts(MARGIN);
        if !found.is_empty() {
            return Err(Unfit::StartInCollision(found));
        }
        // The robot itself may be nearer to itself.
        let mut near = if self.scene.clearance() > 0.0 { contacts(self.carrying.final_margin) } else { Vec::new() };
        near.retain(|contact| contact.is_with_scene());
        if near.is_empty() { Ok(()) } else { Err(Unfit::StartTooNear(near)) }
    }

    /// Whether there is a way to an object with `removed` gone.
    pub fn can_pick(&mut self, object: ObjectId, removed: &ObjectSet, budget: &Budget) -> Result<bool, Stop> {
        Ok(!self.free_ways(object, removed, 1, budget)?.is_empty())
    }

    /// Ways that are free once `removed` is gone, as many as `most`, the best first; from another stand only
    /// if there is none from those before it.
    pub(crate) fn free_ways(
        &mut self,
        object: ObjectId,
        removed: &ObjectSet,
        most: usize,
        budget: &Budget,
    ) -> Result<Vec<Taking>, Stop> {
        for stand in 0..self.stands.len() {
            let free = self.free_ways_from(stand, object, removed, most, budget)?;
            if !free.is_empty() {
                return Ok(free);
            }
        }
        Ok(Vec::new())
    }

    /// The same from one stand.
    fn free_ways_from(
        &mut self,
        stand: usize,
        object: ObjectId,
        removed: &ObjectSet,
        most: usize,
        budget: &Budget,
    ) -> Result<Vec<Taking>, Stop> {
        let ways = self.look(stand, object, budget, |explorer, ways, scratch| {
            explorer.free_ways(object, ways, removed, most, scratch, budget)
        })?;
        Ok(ways.into_iter().map(|way| Taking { stand, way }).collect())
    }

    /// What stands in the way of an object, each set one way in, from whichever stand; not those of more than
    /// `most`.
    pub fn minimal_sets(&mut self, object: ObjectId, most: usize, budget: &Budget) -> Result<Vec<ObjectSet>, Stop> {
        let mut all = Vec::new();
        for stand in 0..self.stands.len() {
            let sets = self.minimal_sets_from(stand, object, most, budget)?;
            let open = sets.iter().any(ObjectSet::is_empty);
            all.extend(sets);
            // With one that nothing stands in, no other matters.
            if open {
                break;
            }
        }
        Ok(ObjectSet::minimal(all))
    }

    /// The same from one stand.
    pub(crate) fn minimal_sets_from(
        &mut self,
        stand: usize,
        object: ObjectId,
        most: usize,
        budget: &Budget,
    ) -> Result<Vec<ObjectSet>, Stop> {
        self.look(stand, object, budget, |explorer, ways, scratch| {
            explorer.minimal_sets(object, ways, most, scratch, budget)
        })
    }

    /// Of the ways that more than `most` objects stand in, and that were not looked into for that, how
    /// many stand in the least blocked, or more.
    pub(crate) fn least_beyond(&self, object: ObjectId, most: usize) -> Option<usize> {
        let unfinished = self.all_ways(object).flat_map(|w| &w.ways).filter(|w| w.stage < Stage::Exact);
        unfinished.map(|w| w.blocked_by.len()).filter(|&n| n > most).min()
    }

    /// Forgets ways along which no motion was found.
    pub fn drop_failed(&mut self) {
        self.stands.iter_mut().flat_map(|s| s.ways.iter_mut().flatten()).for_each(Ways::drop_failed);
    }

    /// From now on objects may turn or slip in the hand: what was found out of ways is forgotten. False where no grasp
    /// was left out for that.
    pub(crate) fn hold_loosely(&mut self) -> bool {
        let all = || self.stands.iter().flat_map(|s| s.ways.iter().flatten());
        if self.settings.loosely || all().all(|ways| ways.counts.askew == 0) {
            return false;
        }
        self.set_loosely(true)
    }

    /// Whether that changes anything; if so, where the robot could stand is chosen anew, too.
    pub(crate) fn set_loosely(&mut self, loosely: bool) -> bool {
        if self.settings.loosely == loosely {
            return false;
        }
        self.settings.loosely = loosely;
        if let Some(base) = &mut self.base {
            base.chosen = false;
            self.stands.truncate(1);
        }
        self.stands.iter_mut().for_each(|s| s.ways.fill(None));
        true
    }

    /// All ways to all objects, routes known by now included: what an exact answer can be about.
    pub fn frozen(&mut self, budget: &Budget) -> Result<WaysIn, Stop> {
        let all = 0..self.scene.objects.len() as u16;
        all.map(|i| self.minimal_sets(ObjectId(i), ObjectSet::CAPACITY, budget)).collect()
    }

    /// Looks into all ways of the objects that came up: whoever is told that there is no plan wants to
    /// know what stands in the way.
    pub(crate) fn look_at_all(&mut self) {
        let budget = Budget::unlimited();
        for stand in 0..self.stands.len() {
            let known = |index: &usize| self.stands[stand].ways[*index].is_some();
            for index in (0..self.scene.objects.len()).filter(known).collect::<Vec<_>>() {
                // Without a limit nothing stops it.
                let _ = self.minimal_sets_from(stand, ObjectId(index as u16), ObjectSet::CAPACITY, &budget);
            }
        }
    }

    /// Adds ways along the roadmap's routes out for an object, as far as there are any.
    pub(crate) fn add_routes(&mut self, object: ObjectId, removed: &ObjectSet, roadmap: &Roadmap) -> bool {
        let Self { stands, floor, scene, .. } = self;
        let at = scene.objects[object.index()].pose.translation.truncate();
        let mut added = false;
        for Stand { world, ways, .. } in stands {
            let Some(ways) = ways[object.index()].as_mut() else { continue };
            let standoff = world.model.robot.grasps.standoff;
            added |= ways.add_routes(&world.poses[object.index()], |back| {
                // Straight until the hand is clear of where the object stood; the roadmap leads on.
                let turned = (world.world_from_root.rotation * back.extend(0.0)).truncate();
                let drawn = turned * standoff;
                let route = roadmap.route(floor, at + drawn, &removed.with(object))?;
                Some(Arc::new([Vec2::ZERO].into_iter().chain(route.iter().map(|p| *p - at)).collect()))
            });
        }
        added
    }

    /// What is known of an object's ways, by stand.
    pub(crate) fn all_ways(&self, object: ObjectId) -> impl Iterator<Item = &Ways> {
        self.stands.iter().filter_map(move |s| s.ways[object.index()].as_ref())
    }

    /// Whether there is no way to an object among those known.
    pub(crate) fn no_way_is_known(&self, object: ObjectId) -> bool {
        self.all_ways(object).all(|ways| ways.ways.is_empty())
    }

    /// Whether anything is known of an object's ways.
    pub(crate) fn looked_into(&self, object: ObjectId) -> bool {
        self.all_ways(object).next().is_some()
    }

    pub(crate) fn way(&self, object: ObjectId, taking: Taking) -> Option<&Way> {
        self.stands[taking.stand].ways[object.index()].as_ref()?.ways.get(taking.way)
    }

    /// Looks into an object's ways from a stand.
    fn look<T>(
        &mut self,
        stand: usize,
        object: ObjectId,
        budget: &Budget,
        into: impl FnOnce(&Explorer, &mut Ways, &mut Scratch) -> Result<T, Stop>,
    ) -> Result<T, Stop> {
        let Self { inverse, floor, settings, scratch, .. } = self;
        self.stands[stand].look(object, Tools { inverse, floor, settings, scratch }, budget, into)
    }

    /// Whether every declared grasp fails for a reason that removing objects cannot mend, by a
    /// complete inverse kinematics, and without the margins that the search keeps.
    fn proved_out_of_reach(&mut self, object: ObjectId, budget: &Budget) -> Result<bool, Stop> {
        let Stand { world, ways, .. } = &self.stands[0];
        if ways[object.index()].is_none() {
            return Ok(false);
        }
        // Those that are not firm as well.
        let grasps: Vec<Pose> =
            declared(world, object).into_iter().filter_map(|(_, grasp)| Some(grasp?.object_from_tool)).collect();
        // With grasps left, finding no posture proves something only if every posture is found, and from
        // everywhere that the base could be.
        if !grasps.is_empty() && (!self.inverse.complete() || self.base.is_some()) {
            return Ok(false);
        }
        let mut moment = Moment::new(ObjectSet::EMPTY, world.model.robot.hand.open(), 0.0);
        moment.gripping = Some(object);
        for object_from_tool in grasps {
            budget.check()?;
            let at = world.poses[object.index()] * object_from_tool;
            for posture in self.inverse.solve(&at, &world.model.robot.home) {
                if world.touched(&posture, &moment, &mut self.scratch) != Touch::Fixed {
                    return Ok(false);
                }
            }
        }
        Ok(true)
    }

    /// Objects that certainly are never taken over the declared grasps, whatever goes first, `object` among them; none
    /// where that is not proved. Without the margins that the search keeps.
    pub fn proved_stuck(&mut self, object: ObjectId, budget: &Budget) -> Result<ObjectSet, Stop> {
        if self.no_way_is_known(object) && self.proved_out_of_reach(object, budget)? {
            return Ok(ObjectSet::of(object));
        }
        let Self { inverse, scene, .. } = self;
        if self.base.is_some() || scene.file.camera.is_some() {
            return Ok(ObjectSet::EMPTY);
        }
        let settings = ways::Settings { margin: DOUBT, held_margin: DOUBT, ..self.settings.clone() };
        let (world, barriers) = (&self.stands[0].world, Barriers::default());
        Prover { world, inverse, settings: &settings, names: &scene.names, barriers: &barriers }.stuck(object, budget)
    }

    /// A lower bound on the removals of every plan over the declared grasps; `removed`: those of a plan.
    pub(crate) fn lower_bound(&self, removed: usize, budget: &Budget) -> LowerBound {
        let Self { inverse, settings, scene, .. } = self;
        let world = &self.stands[0].world;
        // Out of time there is still the target. A plan below the barriers' bound leans farther than they allow for.
        let barriers = Barriers::find(scene, budget).ok().filter(|b| b.bound() <= removed).unwrap_or_default();
        let geometric = barriers.bound();
        // A base that drives has branches from everywhere.
        if geometric < removed && self.base.is_none() {
            let prover = Prover { world, inverse, settings, names: &scene.names, barriers: &barriers };
            if let Some(bound) =
                prover.bound(scene.target, removed, budget).ok().flatten().filter(|b| b.removed > geometric)
            {
                return LowerBound { removed: bound.removed, kind: "grasps".to_owned(), proof: json!(bound.proof) };
            }
        }
        LowerBound { removed: geometric, kind: "geometric".to_owned(), proof: json!(barriers.proof) }
    }

    /// What a task planner came to, written down; timing and statistics are the caller's.
    pub fn plan_file(&mut self, ending: &Ending, journey: Journey, budget: &Budget) -> PlanFile {
        match ending {
            Ending::Solved(objects) => {
                let mut plan = trace::solved(self, objects, journey);
                // Of a scene that is partly observed nothing of the kind is known.
                plan.lower_bound = self.scene.hidden.is_empty().then(|| self.lower_bound(objects.len(), budget));
                plan
            }
            Ending::Impossible(_) | Ending::Stopped(_) => {
                self.look_at_all();
                trace::unsolved(self, ending, journey.obstruction)
            }
        }
    }
}

/// The scene from above; a base that drives gets to all sides of it.
fn floor(scene: &Scene, robot: &Robot, drives: bool) -> Floor {
    let mut floor = Floor::new(scene, robot);
    if drives && scene.file.workspace.is_none() {
        floor.open_all_round();
    }
    floor
}

/// What a robot with a mobile base is at a placement.
fn stand_at(scene: &Scene, model: &Arc<CollisionModel>, base: &Base, placement: Placement) -> Stand {
    let there = Scene { base: base.world_from_root(placement), ..scene.clone() };
    Stand::new(placement, World::new(model.clone(), &there))
}

fn start_posture(scene: &Scene, robot: &Robot) -> Result<Posture, Unfit> {
    let mut posture = robot.home.clone();
    let Some(start) = &scene.file.robot.start else { return Ok(posture) };
    let names = robot.arm_names();
    for (name, &value) in start {
        let Some(i) = names.iter().position(|n| n == name) else {
            return Err(Unfit::BadStart(format!(
                "robot.start names `{name}`, which is no joint of the arm; its joints are {}",
                names.join(", ")
            )));
        };
        if !(value >= robot.lower[i] && value <= robot.upper[i]) {
            return Err(Unfit::BadStart(format!(
                "robot.start has {name} = {value}, outside its limits {}..{}",
                robot.lower[i], robot.upper[i]
            )));
        }
        posture[i] = value;
    }
    Ok(posture)
}
