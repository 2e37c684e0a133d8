//! Section IV-D: what the robot itself can do. Whether an object can be picked once certain others are
//! gone, what would have to go first, and the motions.
//!
//! Task planners differ in which objects they ask about, and in what order; they share these answers.
//! What was found out about an object's ways is kept: removal is monotone.

use crate::barriers::Barriers;
use crate::bound::Prover;
use crate::carry::{self, Carried, Carrier, Situation};
use crate::floor::Floor;
use crate::order::WaysIn;
use crate::place;
use crate::roadmap::Roadmap;
use crate::trace;
use crate::ways::{self, Explorer, Stage, Ways};
use clearway_collision::{CollisionModel, Contact, Moment, Scratch, Touch, World};
use clearway_geometry::Vec2;
use clearway_motion::{Posture, Trees};
use clearway_plan::plan_file::{LowerBound, PlanFile, Timing};
use clearway_plan::{Budget, ObjectId, ObjectSet, Stop};
use clearway_robot::{InverseKinematics, Robot};
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
}

/// What the robot can do in one scene.
pub struct Feasibility {
    pub(crate) scene: Scene,
    pub(crate) world: World,
    pub(crate) floor: Floor,
    inverse: InverseKinematics,
    settings: ways::Settings,
    carrying: carry::Settings,
    start: Posture,
    /// By object; what was found out about reaching it.
    pub(crate) ways: Vec<Option<Ways>>,
    scratch: Scratch,
    trees: Trees,
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

impl Feasibility {
    pub fn new(
        scene: Scene,
        model: Arc<CollisionModel>,
        settings: ways::Settings,
        carrying: carry::Settings,
    ) -> Result<Self, Unfit> {
        let world = World::new(model, &scene);
        let robot = world.model.robot.clone();
        let inverse = InverseKinematics::new(&robot, &world.model.kinematics);
        let start = start_posture(&scene, &robot)?;
        let floor = Floor::new(&scene, &robot);
        let ways = vec![None; scene.objects.len()];
        let (scratch, trees) = (Scratch::default(), Trees::default());
        let new = Self { scene, world, floor, inverse, settings, carrying, start, ways, scratch, trees, homing: true };
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

    pub fn robot(&self) -> &Arc<Robot> {
        &self.world.model.robot
    }

    /// The scene from above.
    pub fn floor(&self) -> &Floor {
        &self.floor
    }

    /// Where the arm's root link is, seen from above, in the scene's frame.
    pub fn base(&self) -> Vec2 {
        self.world.world_from_root.translation.truncate()
    }

    /// The arm is here now.
    pub fn set_start(&mut self, start: Posture) -> Result<(), Unfit> {
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
        self.world.set_scene(&scene);
        self.floor = Floor::new(&scene, &self.world.model.robot);
        self.ways = vec![None; scene.objects.len()];
        self.scene = scene;
    }

    fn start_is_free(&self, start: &Posture) -> Result<(), Unfit> {
        let moment = Moment::new(ObjectSet::first(self.scene.objects.len()), self.robot().hand.open(), 0.0);
        let contacts = self.world.contacts(&self.scene, start, &moment, 1e-5);
        if contacts.is_empty() { Ok(()) } else { Err(Unfit::StartInCollision(contacts)) }
    }

    /// Whether there is a way to an object with `removed` gone.
    pub fn can_pick(&mut self, object: ObjectId, removed: &ObjectSet, budget: &Budget) -> Result<bool, Stop> {
        Ok(!self.free_ways(object, removed, 1, budget)?.is_empty())
    }

    /// Ways that are free once `removed` is gone, as many as `most`, the best first.
    pub(crate) fn free_ways(&mut self, object: ObjectId, removed: &ObjectSet, most: usize, budget: &Budget) -> Result<Vec<usize>, Stop> {
        self.look(object, budget, |explorer, ways, scratch| explorer.free_ways(object, ways, removed, most, scratch, budget))
    }

    /// What stands in the way of an object, each set one way in; not those of more than `most`.
    pub fn minimal_sets(&mut self, object: ObjectId, most: usize, budget: &Budget) -> Result<Vec<ObjectSet>, Stop> {
        self.look(object, budget, |explorer, ways, scratch| explorer.minimal_sets(object, ways, most, scratch, budget))
    }

    /// Of the ways that more than `most` objects stand in, and that were not looked into for that, how
    /// many stand in the least blocked, or more.
    pub(crate) fn least_beyond(&self, object: ObjectId, most: usize) -> Option<usize> {
        let unfinished = self.ways_of(object)?.ways.iter().filter(|w| w.stage < Stage::Exact);
        unfinished.map(|w| w.blocked_by.len()).filter(|&n| n > most).min()
    }

    /// Forgets ways along which no motion was found.
    pub fn drop_failed(&mut self) {
        self.ways.iter_mut().flatten().for_each(Ways::drop_failed);
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
        for index in (0..self.ways.len()).filter(|&i| self.ways[i].is_some()).collect::<Vec<_>>() {
            // Without a limit nothing stops it.
            let _ = self.minimal_sets(ObjectId(index as u16), ObjectSet::CAPACITY, &budget);
        }
    }

    /// Adds ways along the roadmap's routes out for an object, as far as there are any.
    pub(crate) fn add_routes(&mut self, object: ObjectId, removed: &ObjectSet, roadmap: &Roadmap) -> bool {
        let Self { world, floor, ways, .. } = self;
        let Some(ways) = ways[object.index()].as_mut() else { return false };
        let at = self.scene.objects[object.index()].pose.translation.truncate();
        let standoff = world.model.robot.grasps.standoff;
        ways.add_routes(&world.poses[object.index()], |back| {
            // Straight until the hand is clear of where the object stood; the roadmap leads on.
            let turned = (world.world_from_root.rotation * back.extend(0.0)).truncate();
            let drawn = turned * standoff;
            let route = roadmap.route(floor, at + drawn, &removed.with(object))?;
            Some(Arc::new([Vec2::ZERO].into_iter().chain(route.iter().map(|p| *p - at)).collect()))
        })
    }

    pub(crate) fn ways_of(&self, object: ObjectId) -> Option<&Ways> {
        self.ways[object.index()].as_ref()
    }

    /// Looks into an object's ways, which are found first if they were not.
    fn look<T>(
        &mut self,
        object: ObjectId,
        budget: &Budget,
        into: impl FnOnce(&Explorer, &mut Ways, &mut Scratch) -> Result<T, Stop>,
    ) -> Result<T, Stop> {
        let explorer = Explorer {
            world: &self.world,
            inverse: &self.inverse,
            floor: &self.floor,
            settings: &self.settings,
        };
        let ways = match &mut self.ways[object.index()] {
            Some(ways) => ways,
            none => none.insert(explorer.explore(object, budget)?),
        };
        into(&explorer, ways, &mut self.scratch)
    }

    /// Whether every declared grasp fails for a reason that removing objects cannot mend, by a
    /// complete inverse kinematics, and without the margins that the search keeps.
    pub(crate) fn proved_out_of_reach(&mut self, object: ObjectId, budget: &Budget) -> Result<bool, Stop> {
        let Some(ways) = self.ways_of(object) else { return Ok(false) };
        // With grasps left, finding no posture proves something only if every posture is found.
        if !ways.grasps.is_empty() && !self.inverse.complete() {
            return Ok(false);
        }
        let mut moment = Moment::new(ObjectSet::EMPTY, self.world.model.robot.hand.open(), 0.0);
        moment.gripping = Some(object);
        let grasps: Vec<_> = ways.grasps.iter().map(|g| g.object_from_tool).collect();
        for object_from_tool in grasps {
            budget.check()?;
            let at = self.world.poses[object.index()] * object_from_tool;
            for posture in self.inverse.solve(&at, &self.world.model.robot.home) {
                if self.world.touched(&posture, &moment, &mut self.scratch) != Touch::Fixed {
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
        for (i, &object) in objects.iter().enumerate().skip(kept) {
            let removed: ObjectSet = objects[..i].iter().copied().collect();
            let began = Instant::now();
            let carried = self.carry_one(object, &removed, journey, budget);
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

    /// One object's motion along one of its free ways; on failure what was blamed.
    fn carry_one(
        &mut self,
        object: ObjectId,
        removed: &ObjectSet,
        journey: &mut Journey,
        budget: &Budget,
    ) -> Result<Result<Carried, Vec<ObjectSet>>, Stop> {
        const WAYS_TRIED: usize = 5;
        let situation = match journey.carried.last() {
            Some(carried) => carried.after.clone(),
            None => Situation {
                posture: self.start.clone(),
                standing: ObjectSet::first(self.scene.objects.len()),
                placed: Vec::new(),
            },
        };
        // The target comes last; then the arm goes home.
        let last = self.homing && object == self.scene.target;
        let mut blamed = Vec::new();
        for tried in 0..WAYS_TRIED {
            // Those that failed least come first.
            let candidates = self.free_ways(object, removed, tried + 1, budget)?;
            let Some(ways) = self.ways[object.index()].as_mut() else { break };
            let (Some(&index), true) = (candidates.first(), candidates.len() > tried) else { break };
            let mut carrier = Carrier {
                world: &self.world,
                scene: &self.scene,
                inverse: &self.inverse,
                settings: &self.carrying,
                random: &mut journey.random,
                budget,
                trees: &mut self.trees,
            };
            let way = &ways.ways[index];
            match carrier.take(object, &ways.grasps[way.grasp], way, &situation, last)? {
                Ok(carried) => {
                    ways.ways[index].failures = 0;
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
        Ok(Err(ObjectSet::minimal(blamed)))
    }

    /// A lower bound on the removals of every plan over the declared grasps; `removed`: those of a plan.
    pub(crate) fn lower_bound(&self, removed: usize, budget: &Budget) -> LowerBound {
        let Self { world, inverse, settings, scene, .. } = self;
        // Out of time there is still the target. A plan below the barriers' bound leans farther than they allow for.
        let barriers = Barriers::find(scene, budget).ok().filter(|b| b.bound() <= removed).unwrap_or_default();
        let geometric = barriers.bound();
        if geometric < removed {
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
