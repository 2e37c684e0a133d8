//! Section IV-D: what the robot itself can do. Whether an object can be picked once certain others are
//! gone, what would have to go first, and the motions.
//!
//! Task planners differ in which objects they ask about, and in what order; they share these answers.
//! What was found out about an object's ways is kept: removal is monotone.

use crate::barriers::Barriers;
use crate::bound::Prover;
use crate::carry::{self, Carried, Carrier, Obstruction, Situation};
use crate::floor::Floor;
use crate::mobile::bring::Elsewhere;
use crate::mobile::itinerary::{Errand, Visit};
use crate::mobile::{self, Base, Served};
use crate::order::WaysIn;
use crate::place;
use crate::roadmap::Roadmap;
use crate::stand::{Stand, Tools};
use crate::trace;
use crate::ways::{self, Explorer, Stage, Way, Ways};
use clearway_collision::{CollisionModel, Contact, Moment, Scratch, Touch, World};
use clearway_geometry::Vec2;
use clearway_motion::{Posture, Trees};
use clearway_plan::plan_file::{LowerBound, PlanFile, Segment, SideWhy, Timing};
use clearway_plan::{Budget, ObjectId, ObjectSet, Stop};
use clearway_robot::{InverseKinematics, Placement, Robot};
use clearway_scene::Scene;
use rand::SeedableRng;
use rand_xoshiro::Xoshiro256PlusPlus;
use serde_json::json;
use std::sync::Arc;
use std::time::{Duration, Instant};

/// The scene cannot be planned for at all.
#[derive(Clone, Debug)]
pub enum Unfit {
    /// The start posture touches these.
    StartInCollision(Vec<Contact>),
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

/// Motions planned so far, and what they are planned with.
pub struct Journey {
    random: Xoshiro256PlusPlus,
    pub(crate) carried: Vec<Carried>,
    /// The last motion that could not be had.
    pub(crate) obstruction: Option<(ObjectId, &'static str)>,
    /// Spent on motions.
    spent: Duration,
}

impl Journey {
    pub fn new(seed: u64) -> Self {
        let random = Xoshiro256PlusPlus::seed_from_u64(seed ^ 0x4d6f_7665);
        Self { random, carried: Vec::new(), obstruction: None, spent: Duration::ZERO }
    }

    /// Counts the time that motions of another journey took.
    pub fn took_as_well(&mut self, other: &Self) {
        self.spent += other.spent;
    }

    /// Of planning that took so long in all.
    pub fn timing(&self, total: Duration) -> Timing {
        Timing {
            total: total.as_secs_f64(),
            task: total.saturating_sub(self.spent).as_secs_f64(),
            motion: self.spent.as_secs_f64(),
        }
    }
}

/// What a search came to.
#[derive(Clone, Debug)]
pub enum Ending {
    /// These were carried, in this order; the target is last.
    Solved(Vec<ObjectId>),
    /// Proved.
    Impossible,
    /// Nothing is proved; without a reason the search had nothing left to try.
    Stopped(Option<Stop>),
}

/// An object that could be picked, but no motion was found.
#[derive(Clone, Debug)]
pub struct NoMotion {
    pub object: ObjectId,
    pub removed: ObjectSet,
    /// Each with `removed`: rid of all of one, one of the ways tried may do.
    pub blamed: Vec<ObjectSet>,
}

/// What carries objects at a stand; a macro, for it borrows only some of the fields.
macro_rules! carrier {
    ($self:ident, $stand:expr, $before:ident, $journey:ident, $budget:ident) => {
        Carrier {
            world: &$self.stands[$stand].world,
            base: $before.base.clone(),
            within: None,
            scene: &$self.scene,
            inverse: &$self.inverse,
            settings: &$self.carrying,
            random: &mut $journey.random,
            budget: $budget,
            trees: &mut $self.trees,
        }
    };
}

impl Feasibility {
    pub fn new(
        scene: Scene,
        model: Arc<CollisionModel>,
        settings: ways::Settings,
        carrying: carry::Settings,
        mobile: mobile::Settings,
    ) -> Result<Self, Unfit> {
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
        let new = Self { scene, floor, inverse, settings, carrying, start: posture, stands, base, scratch, trees, homing: true };
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
        let contacts = match &self.base {
            Some(base) => base.contacts(&self.stands[0].placement, start, MARGIN),
            None => {
                let moment = Moment::new(ObjectSet::first(self.scene.objects.len()), self.robot().hand.open(), 0.0);
                self.stands[0].world.contacts(&self.scene, start, &moment, MARGIN)
            }
        };
        if contacts.is_empty() { Ok(()) } else { Err(Unfit::StartInCollision(contacts)) }
    }

    /// Where a mobile base could stand round the target, where stops were chosen.
    pub(crate) fn sides(&self) -> Vec<SideWhy> {
        let chosen = self.base.as_ref().filter(|base| base.chosen);
        let Some((base, standing)) = chosen.and_then(|base| Some((base, base.model.standing.as_ref()?))) else { return Vec::new() };
        let served = Served::of(&self.scene, &self.stands[0].world);
        base.sides(&standing.model.robot.home, &served, &standing.reachability)
    }

    /// Chooses the stops of a mobile base, if it has not been done.
    pub(crate) fn choose_stops(&mut self) {
        let Some(base) = self.base.as_mut().filter(|base| !base.chosen && base.settings.drives) else { return };
        let Some(standing) = base.model.standing.clone() else { return };
        base.chosen = true;
        let served = Served::of(&self.scene, &self.stands[0].world);
        let home = &standing.model.robot.home;
        let (stops, sides) = mobile::choose(base, &self.scene, &served, &standing.reachability, home);
        base.sides = sides;
        for placement in stops {
            self.stands.push(stand_at(&self.scene, &standing.model, base, placement));
        }
        for stand in &mut self.stands {
            stand.spots = served.spots(&standing.reachability, &stand.world.world_from_root);
        }
    }

    /// Whether there is a way to an object with `removed` gone.
    pub fn can_pick(&mut self, object: ObjectId, removed: &ObjectSet, budget: &Budget) -> Result<bool, Stop> {
        Ok(!self.free_ways(object, removed, 1, budget)?.is_empty())
    }

    /// Ways that are free once `removed` is gone, as many as `most`, the best first; from another stand only
    /// if there is none from those before it.
    pub(crate) fn free_ways(&mut self, object: ObjectId, removed: &ObjectSet, most: usize, budget: &Budget) -> Result<Vec<Taking>, Stop> {
        for stand in 0..self.stands.len() {
            let free = self.free_ways_from(stand, object, removed, most, budget)?;
            if !free.is_empty() {
                return Ok(free);
            }
        }
        Ok(Vec::new())
    }

    /// The same from one stand.
    fn free_ways_from(&mut self, stand: usize, object: ObjectId, removed: &ObjectSet, most: usize, budget: &Budget) -> Result<Vec<Taking>, Stop> {
        let ways = self.look(stand, object, budget, |explorer, ways, scratch| explorer.free_ways(object, ways, removed, most, scratch, budget))?;
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
    pub(crate) fn minimal_sets_from(&mut self, stand: usize, object: ObjectId, most: usize, budget: &Budget) -> Result<Vec<ObjectSet>, Stop> {
        self.look(stand, object, budget, |explorer, ways, scratch| explorer.minimal_sets(object, ways, most, scratch, budget))
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
    pub(crate) fn proved_out_of_reach(&mut self, object: ObjectId, budget: &Budget) -> Result<bool, Stop> {
        let Stand { world, ways, .. } = &self.stands[0];
        let Some(ways) = &ways[object.index()] else { return Ok(false) };
        // With grasps left, finding no posture proves something only if every posture is found, and from
        // everywhere that the base could be.
        if !ways.grasps.is_empty() && (!self.inverse.complete() || self.base.is_some()) {
            return Ok(false);
        }
        let mut moment = Moment::new(ObjectSet::EMPTY, world.model.robot.hand.open(), 0.0);
        moment.gripping = Some(object);
        let grasps: Vec<_> = ways.grasps.iter().map(|g| g.object_from_tool).collect();
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

    /// Plans the motions for objects that can all be picked in this order, steps of the journey that
    /// begin alike kept; `taken` hears of each new one.
    pub fn carry(
        &mut self,
        objects: &[ObjectId],
        journey: &mut Journey,
        budget: &Budget,
        mut taken: impl FnMut(&str),
    ) -> Result<Result<(), NoMotion>, Stop> {
        let names = self.scene.names.clone();
        let kept = journey.carried.iter().zip(objects).take_while(|(c, o)| c.step.object == names[o.index()]).count();
        journey.carried.truncate(kept);
        let stops = self.stops_for(objects, journey, budget)?;
        for (i, &object) in objects.iter().enumerate().skip(kept) {
            let removed: ObjectSet = objects[..i].iter().copied().collect();
            let began = Instant::now();
            let fallen = self.scene.fallen(self.scene.all().difference(removed.with(object)));
            if !fallen.is_empty() {
                journey.obstruction = Some((object, "taking it from under what would fall"));
                return Ok(Err(NoMotion { object, removed, blamed: vec![fallen.union(removed)] }));
            }
            let carried = self.carry_one(object, &removed, stops[i - kept], journey, budget);
            journey.spent += began.elapsed();
            match carried? {
                Ok(carried) => {
                    taken(&names[object.index()]);
                    journey.carried.push(carried);
                }
                Err(blamed) => {
                    // Rid of what stood in the way, one of the ways tried may do.
                    let blamed = blamed.into_iter().map(|b| b.union(removed)).collect();
                    return Ok(Err(NoMotion { object, removed, blamed }));
                }
            }
        }
        Ok(Ok(()))
    }

    fn situation(&self, journey: &Journey) -> Situation {
        journey.carried.last().map_or_else(|| self.start_situation(), |carried| carried.after.clone())
    }

    /// How things are before anything is done.
    pub(crate) fn start_situation(&self) -> Situation {
        Situation {
            stand: 0,
            base: self.base.as_ref().map_or(Vec::new(), |base| base.start.to_vec()),
            posture: self.start.clone(),
            standing: self.scene.all(),
            placed: Vec::new(),
        }
    }

    /// From which stands the rest of a sequence is best taken, in that order: with the fewest moves of the
    /// base, and then the least driving.
    fn stops_for(&mut self, objects: &[ObjectId], journey: &Journey, budget: &Budget) -> Result<Vec<usize>, Stop> {
        let kept = journey.carried.len();
        let left = &objects[kept..];
        if self.stands.len() == 1 {
            return Ok(vec![0; left.len()]);
        }
        let mut ways: Vec<WaysIn> = vec![vec![Vec::new(); self.scene.objects.len()]; self.stands.len()];
        let mut removed: ObjectSet = objects[..kept].iter().copied().collect();
        for &object in left {
            for (stand, ways) in ways.iter_mut().enumerate() {
                if !self.free_ways_from(stand, object, &removed, 1, budget)?.is_empty() {
                    ways[object.index()].push(removed);
                }
            }
            removed.insert(object);
        }
        let allowed = vec![vec![ObjectSet::EMPTY]; self.scene.objects.len()];
        let gone = objects[..kept].iter().copied().collect();
        let visits = self.errand(&ways, &allowed, left.iter().copied().collect(), gone, self.situation(journey).stand, left.last().copied(), budget)?;
        let stop = |object: &ObjectId| visits.iter().flatten().find(|v| v.object == *object).map_or(0, |v| v.stop);
        Ok(left.iter().map(stop).collect())
    }

    /// The cheapest order of some objects, from several stands.
    #[allow(clippy::too_many_arguments)]
    fn errand(
        &self,
        ways: &[WaysIn],
        allowed: &WaysIn,
        objects: ObjectSet,
        gone: ObjectSet,
        start: usize,
        target: Option<ObjectId>,
        budget: &Budget,
    ) -> Result<Option<Vec<Visit>>, Stop> {
        let (Some(base), Some(target)) = (&self.base, target) else { return Ok(None) };
        let seconds = |a: &Stand, b: &Stand| base.seconds(&a.placement, &b.placement);
        let drives: Vec<Vec<f64>> = self.stands.iter().map(|a| self.stands.iter().map(|b| seconds(a, b)).collect()).collect();
        let puts: Vec<usize> = (0..self.stands.len()).map(|s| self.put_down_at(s).first().copied().unwrap_or(s)).collect();
        let weights = base.weights;
        Errand { ways, allowed, drives: &drives, puts: &puts, target, objects, gone, start, weights }.cheapest(budget)
    }

    /// Where what is taken at a stand may be put down: there if it has a place in reach, then the nearest ones.
    fn put_down_at(&self, stand: usize) -> Vec<usize> {
        let Some(base) = &self.base else { return vec![stand] };
        let from = &self.stands[stand];
        let mut order: Vec<usize> = (0..self.stands.len()).filter(|&s| self.stands[s].spots > 0.0).collect();
        order.sort_by(|&a, &b| {
            let seconds = |s: usize| if s == stand { -1.0 } else { base.seconds(&from.placement, &self.stands[s].placement) };
            seconds(a).total_cmp(&seconds(b))
        });
        order
    }

    /// The cheapest order in which the objects of a set, or others known as well, lead to the target.
    pub(crate) fn itinerary(&mut self, allowed: &WaysIn, set: &ObjectSet, budget: &Budget) -> Result<Option<Vec<ObjectId>>, Stop> {
        if self.stands.len() == 1 {
            return Ok(None);
        }
        let mut ways: Vec<WaysIn> = vec![vec![Vec::new(); self.scene.objects.len()]; self.stands.len()];
        for object in set.iter() {
            for (stand, ways) in ways.iter_mut().enumerate() {
                let sets = self.minimal_sets_from(stand, object, set.len(), budget)?;
                ways[object.index()] = sets;
            }
        }
        let visits = self.errand(&ways, allowed, *set, ObjectSet::EMPTY, 0, Some(self.scene.target), budget)?;
        Ok(visits.map(|visits| visits.into_iter().map(|v| v.object).collect()))
    }

    /// One object's motion along one of its free ways, from a stand if it can be; on failure what was blamed.
    fn carry_one(
        &mut self,
        object: ObjectId,
        removed: &ObjectSet,
        stop: usize,
        journey: &mut Journey,
        budget: &Budget,
    ) -> Result<Result<Carried, Vec<ObjectSet>>, Stop> {
        let before = self.situation(journey);
        let mut stops = vec![stop];
        if self.stands.len() > 1 {
            let others = (0..self.stands.len()).filter(|&s| s != stop);
            stops.extend(others.filter(|&s| self.stands[s].ways[object.index()].is_some()));
        }
        let mut blamed = Vec::new();
        for stop in stops {
            match self.carry_from(stop, object, removed, &before, journey, budget)? {
                Ok(carried) => return Ok(Ok(carried)),
                Err(sets) => blamed.extend(sets),
            }
        }
        Ok(Err(ObjectSet::minimal(blamed)))
    }

    /// The same from one stand, to which a mobile base drives if it is not there.
    fn carry_from(
        &mut self,
        stop: usize,
        object: ObjectId,
        removed: &ObjectSet,
        before: &Situation,
        journey: &mut Journey,
        budget: &Budget,
    ) -> Result<Result<Carried, Vec<ObjectSet>>, Stop> {
        const WAYS_TRIED: usize = 5;
        // The target comes last; then the arm goes home.
        let last = self.homing && object == self.scene.target;
        let mut blamed = Vec::new();
        if self.free_ways_from(stop, object, removed, 1, budget)?.is_empty() {
            return Ok(Err(blamed));
        }
        let mut driven = Vec::new();
        let mut before = before.clone();
        if stop != before.stand {
            match self.drive_to(stop, &before, journey, budget)? {
                Ok((segments, there)) => (driven, before) = (segments, there),
                Err(obstruction) => {
                    journey.obstruction = Some((object, obstruction.what));
                    return Ok(Err(Some(obstruction.blamed).filter(|b| !b.is_empty()).into_iter().collect()));
                }
            }
        }
        for tried in 0..WAYS_TRIED {
            // Those that failed least come first.
            let candidates = self.free_ways_from(stop, object, removed, tried + 1, budget)?;
            let (Some(&Taking { way: index, .. }), true) = (candidates.first(), candidates.len() > tried) else { break };
            let order = self.put_down_at(stop).into_iter().filter(|&s| s != stop).collect();
            let Some(ways) = self.stands[stop].ways[object.index()].take() else { break };
            let elsewhere = self.base.as_deref().filter(|base| base.settings.drives).map(|base| Elsewhere { base, stands: &self.stands, order });
            let mut carrier = carrier!(self, stop, before, journey, budget);
            let way = &ways.ways[index];
            let taken = carrier.take(object, &ways.grasps[way.grasp], way, &before, last, elsewhere.as_ref());
            let ways = self.stands[stop].ways[object.index()].insert(ways);
            match taken? {
                Ok(mut carried) => {
                    ways.ways[index].failures = 0;
                    carried.step.segments.splice(0..0, driven);
                    return Ok(Ok(carried));
                }
                Err(obstruction) => {
                    ways.ways[index].failures += 1;
                    journey.obstruction = Some((object, obstruction.what));
                    if !obstruction.blamed.is_empty() {
                        blamed.push(obstruction.blamed);
                    }
                }
            }
        }
        Ok(Err(blamed))
    }

    /// To another stand, the arm at rest.
    #[allow(clippy::type_complexity)]
    fn drive_to(
        &mut self,
        stop: usize,
        before: &Situation,
        journey: &mut Journey,
        budget: &Budget,
    ) -> Result<Result<(Vec<Segment>, Situation), Obstruction>, Stop> {
        let Some(base) = &self.base else { return Ok(Ok((Vec::new(), before.clone()))) };
        let mut carrier = carrier!(self, before.stand, before, journey, budget);
        let mut segments = match carrier.tuck(before)? {
            Ok(segments) => segments,
            Err(obstruction) => return Ok(Err(obstruction)),
        };
        let home = self.stands[stop].world.model.robot.home.clone();
        match base.drive(&mut carrier, before, &self.stands[stop].placement, &home, None)? {
            Ok(drive) => {
                let base = drive.positions.last().map_or(Vec::new(), |row| row[..before.base.len()].to_vec());
                carrier.base.clear();
                segments.push(carrier.transit(drive));
                Ok(Ok((segments, Situation { stand: stop, base, posture: home, ..before.clone() })))
            }
            Err(obstruction) => Ok(Err(obstruction)),
        }
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
            if let Some(bound) = prover.bound(scene.target, removed, budget).ok().flatten().filter(|b| b.removed > geometric) {
                return LowerBound { removed: bound.removed, kind: "grasps".to_owned(), proof: json!(bound.proof) };
            }
        }
        LowerBound { removed: geometric, kind: "geometric".to_owned(), proof: json!(barriers.proof) }
    }

    /// What a task planner came to, written down; timing and statistics are the caller's.
    pub fn plan_file(&mut self, ending: &Ending, journey: Journey, budget: &Budget) -> PlanFile {
        match ending {
            Ending::Solved(objects) => {
                let mut plan = trace::solved(self, objects, journey.carried);
                // Of a scene that is partly observed nothing of the kind is known.
                plan.lower_bound = self.scene.hidden.is_empty().then(|| self.lower_bound(objects.len(), budget));
                plan
            }
            Ending::Impossible | Ending::Stopped(_) => {
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
