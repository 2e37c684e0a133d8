//! Algorithm 1: roadmap, retrieval graph and feasibility checks, interleaved under a rising
//! exploration limit.
//!
//! A [`Planner`] is a session: it owns the scene and what was learned about it, so that a changed
//! scene is planned for again without starting from nothing.

use crate::bound::Prover;
use crate::carry::{self, Carried, Carrier, Situation};
use crate::floor::Floor;
use crate::graph::{RetrievalGraph, Search, Sequence};
use crate::place;
use crate::roadmap::{self, Roadmap};
use crate::trace;
use crate::ways::{self, Explorer, Ways};
use clearway_collision::{CollisionModel, Contact, Moment, Scratch, Touch, World};
use clearway_geometry::Vec2;
use clearway_motion::{Posture, Trees};
use clearway_plan::event::Observer;
use clearway_plan::plan_file::{LowerBound, PlanFile, Stats, Status, Timing};
use clearway_plan::{Budget, Event, ObjectId, ObjectSet, Stop};
use clearway_robot::{InverseKinematics, Robot};
use clearway_scene::Scene;
use rand::SeedableRng;
use rand_xoshiro::Xoshiro256PlusPlus;
use serde_json::json;
use std::sync::Arc;
use std::time::{Duration, Instant};

/// The exploration limit of the first round (section VI-B).
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum FirstLimit {
    /// 1: fewest removals.
    #[default]
    One,
    /// |n_g.NodeCol| of the arm: the fewest objects in the way of grasping the target directly,
    /// and one for the target.
    GraspCover,
    /// |O|: every sequence is allowed from the start.
    All,
}

/// What a session does; the defaults are what measures best.
#[derive(Clone, Debug, Default)]
pub struct Settings {
    pub first_limit: FirstLimit,
    pub search: Search,
    pub roadmap: roadmap::Settings,
    pub ways: ways::Settings,
    pub carry: carry::Settings,
    /// Only the roadmap's ways to the target, not the arm's own; failures give the smallest
    /// blocking set only; sequences are taken as they are.
    pub as_in_paper: bool,
}

impl Settings {
    /// What the paper did, as far as it says.
    pub fn paper() -> Self {
        Self { search: Search::Greedy, roadmap: roadmap::Settings::paper(), as_in_paper: true, ..Self::default() }
    }

    pub fn validate(&self) -> Result<(), String> {
        self.roadmap.validate().map_err(|e| format!("roadmap: {e}"))?;
        self.carry.rrt.validate().map_err(|e| format!("rrt: {e}"))
    }
}

/// What a plan is asked for with.
#[derive(Clone, Debug)]
pub struct Request {
    pub seed: u64,
    pub budget: Budget,
}

/// The scene cannot be planned for at all.
#[derive(Clone, Debug)]
pub enum Unfit {
    /// The start posture touches these.
    StartInCollision(Vec<Contact>),
    /// The start names no such joint, or lies outside its limits.
    BadStart(String),
    /// There is no place, or none that could hold the object, whatever stands there.
    NoPlace(String),
}

/// A session's answer; the plan is not yet verified.
#[derive(Clone, Debug)]
pub struct Answer {
    pub plan: PlanFile,
    /// What stopped the search, when `status` is `out_of_budget`.
    pub stopped: Option<Stop>,
}

/// One planning session.
pub struct Planner {
    scene: Scene,
    world: World,
    inverse: InverseKinematics,
    settings: Settings,
    start: Posture,
    floor: Floor,
    roadmap: Roadmap,
    graph: RetrievalGraph,
    /// By object; what was found out about reaching it.
    ways: Vec<Option<Ways>>,
    /// Objects for which ways that end among the clutter are good enough.
    partial_ways: ObjectSet,
    scratch: Scratch,
    trees: Trees,
}

/// A change of the scene, as a camera or a failed pick may tell.
#[derive(Clone, Debug)]
pub enum SceneDelta {
    /// The whole scene anew: objects moved, appeared, vanished. Robot and base stay.
    Scene(Box<Scene>),
    /// The arm is here now.
    Posture(Posture),
}

impl Planner {
    pub fn new(scene: Scene, robot: Arc<Robot>, settings: Settings) -> Result<Self, Unfit> {
        Self::with_model(scene, Arc::new(CollisionModel::new(robot)), settings)
    }

    /// A session for one of several scenes with the same robot, which is made ready only once.
    pub fn with_model(scene: Scene, model: Arc<CollisionModel>, settings: Settings) -> Result<Self, Unfit> {
        let world = World::new(model, &scene);
        let robot = world.model.robot.clone();
        let inverse = InverseKinematics::new(&robot, &world.model.kinematics);
        let start = start_posture(&scene, &robot)?;
        let moment = Moment::new(ObjectSet::first(scene.objects.len()), robot.hand.open(), 0.0);
        let contacts = world.contacts(&scene, &start, &moment, 1e-5);
        if !contacts.is_empty() {
            return Err(Unfit::StartInCollision(contacts));
        }
        if scene.places.is_empty() {
            return Err(Unfit::NoPlace("the scene has no `place` to put things on".to_owned()));
        }
        let target = &scene.objects[scene.target.index()];
        if !place::fits_somewhere(&target.solid, &target.pose, &scene.places) {
            return Err(Unfit::NoPlace(format!("no `place` is large enough for the target `{}`", target.id)));
        }
        let floor = Floor::new(&scene, &robot);
        let roadmap = Roadmap::new(&floor);
        let graph = new_graph(&scene);
        let ways = vec![None; scene.objects.len()];
        Ok(Self { scene, world, inverse, settings, start, floor, roadmap, graph, ways, partial_ways: ObjectSet::EMPTY, scratch: Scratch::default(), trees: Trees::default() })
    }

    pub fn scene(&self) -> &Scene {
        &self.scene
    }

    pub fn robot(&self) -> &Arc<Robot> {
        &self.world.model.robot
    }

    /// Takes a change in. What was learned is kept where it still holds: all of it when only the
    /// arm moved, the roadmap's samples and the robot's own tables when objects did.
    pub fn update(&mut self, delta: SceneDelta) -> Result<(), Unfit> {
        match delta {
            SceneDelta::Posture(posture) => {
                let moment = Moment::new(ObjectSet::first(self.scene.objects.len()), self.world.model.robot.hand.open(), 0.0);
                let contacts = self.world.contacts(&self.scene, &posture, &moment, 1e-5);
                if !contacts.is_empty() {
                    return Err(Unfit::StartInCollision(contacts));
                }
                self.start = posture;
            }
            SceneDelta::Scene(scene) => {
                self.world.set_scene(&scene);
                self.floor = Floor::new(&scene, &self.world.model.robot);
                self.roadmap = Roadmap::new(&self.floor);
                self.graph = new_graph(&scene);
                self.ways = vec![None; scene.objects.len()];
                self.partial_ways = ObjectSet::EMPTY;
                self.scene = *scene;
            }
        }
        Ok(())
    }

    /// Plans. Everything random comes from the request's seed.
    pub fn plan(&mut self, request: &Request, observer: &mut dyn Observer) -> Answer {
        let began = Instant::now();
        let mut run = Run {
            random_roadmap: Xoshiro256PlusPlus::seed_from_u64(request.seed ^ 0x526f_6164),
            random_motion: Xoshiro256PlusPlus::seed_from_u64(request.seed ^ 0x4d6f_7665),
            budget: request.budget.clone(),
            stats: Stats::default(),
            motion_time: Duration::ZERO,
            carried: Vec::new(),
            last_obstruction: None,
            observer,
        };
        let outcome = self.search(&mut run);
        let total = began.elapsed();
        let timing = Timing {
            total: total.as_secs_f64(),
            task: total.saturating_sub(run.motion_time).as_secs_f64(),
            motion: run.motion_time.as_secs_f64(),
        };
        let mut stats = run.stats;
        stats.roadmap_nodes = self.roadmap.nodes.len();
        stats.retrieval_nodes = self.graph.len();
        stats.samples = self.roadmap.samples;
        stats.grasps_tried = self.ways.iter().flatten().map(|w| w.counts.total()).sum();
        let (status, stopped, sequence) = match outcome {
            Outcome::Solved(sequence) => (Status::Solved, None, Some(sequence)),
            Outcome::Impossible => (Status::Impossible, None, None),
            Outcome::Stopped(stop) => (Status::OutOfBudget, Some(stop), None),
        };
        if status != Status::Solved {
            self.look_at_all();
        }
        let view = trace::View {
            scene: &self.scene,
            world: &self.world,
            floor: &self.floor,
            roadmap: &self.roadmap,
            graph: &self.graph,
            ways: &self.ways,
        };
        let carried = if status == Status::Solved { run.carried } else { Vec::new() };
        let mut plan = trace::plan_file(&view, status, sequence.as_ref(), carried, run.last_obstruction, stopped);
        plan.seed = request.seed;
        plan.timing = timing;
        plan.stats = stats;
        if status == Status::Solved {
            plan.lower_bound = Some(self.lower_bound(plan.removed.len(), &request.budget));
        }
        Answer { plan, stopped }
    }

    /// A lower bound on the removals of every plan over the declared grasps; `removed`: those of a plan.
    fn lower_bound(&self, removed: usize, budget: &Budget) -> LowerBound {
        let Self { world, inverse, settings, scene, .. } = self;
        let prover = Prover { world, inverse, settings: &settings.ways, names: &scene.names };
        // Out of time there is still the target.
        match prover.bound(scene.target, removed, budget).ok().flatten().filter(|bound| bound.removed > 1) {
            Some(bound) => LowerBound { removed: bound.removed, kind: "grasps".to_owned(), proof: json!(bound.proof) },
            None => LowerBound { removed: 1, kind: "geometric".to_owned(), proof: json!({ "barriers": [] }) },
        }
    }

    fn search(&mut self, run: &mut Run) -> Outcome {
        match self.search_or_stop(run) {
            Ok(outcome) => outcome,
            Err(stop) => Outcome::Stopped(stop),
        }
    }

    fn search_or_stop(&mut self, run: &mut Run) -> Result<Outcome, Stop> {
        let target = self.scene.target;
        let count = self.scene.objects.len();
        run.budget.check()?;
        let budget = &run.budget;
        self.look(target, budget, |explorer, ways, scratch| explorer.see_all(target, ways, scratch, budget))?;
        if self.ways_of(target).is_some_and(|w| w.ways.is_empty()) && self.proved_out_of_reach(target, run)? {
            return Ok(Outcome::Impossible);
        }
        let mut limit = match self.settings.first_limit {
            FirstLimit::One => 1,
            FirstLimit::GraspCover => 1 + self.minimal_sets(target, count, &run.budget)?.iter().map(ObjectSet::len).min().unwrap_or(0),
            FirstLimit::All => count,
        };
        loop {
            run.budget.iteration()?;
            run.stats.iterations += 1;
            run.stats.exploration_limit = limit;
            self.look_up_to(limit, &run.budget)?;
            // What is known may do; then the roadmap need not grow.
            if !self.settings.as_in_paper
                && let Some(sequence) = self.check_all(limit, run)?
            {
                return Ok(Outcome::Solved(sequence));
            }
            self.roadmap.expand(&self.floor, limit, &self.settings.roadmap, &mut run.random_roadmap, &run.budget)?;
            let (clusters, edges) = self.roadmap.clusters();
            // Clusters come in the order of their first nodes; x_s and x_g are nodes 0 and 1, alone.
            self.graph.set_clusters(clusters, &edges, 0, 1);
            run.observer.event(Event::Iteration {
                exploration_limit: limit,
                roadmap_nodes: self.roadmap.nodes.len(),
                retrieval_nodes: self.graph.len(),
            });
            if let Some(sequence) = self.check_all(limit, run)? {
                return Ok(Outcome::Solved(sequence));
            }
            if limit < count {
                limit += 1;
                continue;
            }
            // Everything known has failed at the widest limit. From the beginning, then: other
            // motions may be found, also from where a way ends among the clutter.
            self.partial_ways = ObjectSet::first(count);
            self.graph.forget();
            limit = 1;
        }
    }

    /// Looks into all ways of the objects that came up: whoever is told that there is no plan wants to
    /// know what stands in the way.
    fn look_at_all(&mut self) {
        let budget = Budget::unlimited();
        for index in (0..self.ways.len()).filter(|&i| self.ways[i].is_some()).collect::<Vec<_>>() {
            // Without a limit nothing stops it.
            let _ = self.minimal_sets(ObjectId(index as u16), ObjectSet::CAPACITY, &budget);
        }
    }

    /// Tells the graph the sets that a raised limit lets count: ways that more objects stand in are
    /// not looked into before.
    fn look_up_to(&mut self, limit: usize, budget: &Budget) -> Result<(), Stop> {
        let target = self.scene.target;
        if !self.settings.as_in_paper {
            self.allow_partial(target, budget)?;
            let direct = self.minimal_sets(target, most_in_way(limit, true), budget)?;
            self.graph.add_direct(&direct);
            for object in self.graph.complete() {
                let sets = self.minimal_sets(object, most_in_way(limit, false), budget)?;
                self.graph.add_ways(object, &sets);
            }
        }
        Ok(())
    }

    /// "We repeat … until no sequence satisfies |O_r| ≤ L" (section IV-D).
    fn check_all(&mut self, limit: usize, run: &mut Run) -> Result<Option<Sequence>, Stop> {
        while let Some(sequence) = self.graph.best_sequence(limit, self.settings.search) {
            run.budget.check()?;
            run.stats.sequences_tried += 1;
            run.observer.event(Event::Sequence { objects: self.name_all(&sequence.objects) });
            if let Some(sequence) = self.check(sequence, limit, run)? {
                return Ok(Some(sequence));
            }
        }
        Ok(None)
    }

    /// Feasibility check of a sequence. On failure the graph has learned something.
    fn check(&mut self, sequence: Sequence, limit: usize, run: &mut Run) -> Result<Option<Sequence>, Stop> {
        let mut removed = ObjectSet::EMPTY;
        let mut needs: Vec<(ObjectId, ObjectSet)> = Vec::new();
        for &object in &sequence.objects {
            let mut free = self.first_free_way(object, &removed, &run.budget)?;
            if free.is_none() && self.allow_partial(object, &run.budget)? {
                free = self.first_free_way(object, &removed, &run.budget)?;
            }
            let Some(first) = free else {
                let is_target = object == self.scene.target;
                let most = if self.settings.as_in_paper { self.scene.objects.len() } else { most_in_way(limit, is_target) };
                let mut sets = self.minimal_sets(object, most, &run.budget)?;
                if self.settings.as_in_paper {
                    sets.truncate(1);
                }
                // The roadmap is the target's: with other objects gone it may show it other routes.
                let complete = !is_target;
                self.blocked(object, removed, &sets, complete, run);
                return Ok(None);
            };
            needs.push((object, self.ways_of(object).map_or(ObjectSet::EMPTY, |w| w.ways[first].blocked_by)));
            removed.insert(object);
        }
        // What none of the ways chosen needs may stay, unless its staying has failed already.
        let needed = needed(&needs);
        let sequence = if !self.settings.as_in_paper && self.graph.allows_all(&needed) {
            Sequence { objects: needed, ..sequence }
        } else {
            sequence
        };
        let began = Instant::now();
        let carried = self.carry(&sequence, run);
        run.motion_time += began.elapsed();
        Ok(carried?.then_some(sequence))
    }

    /// A way that is free once `removed` is gone: straight out, or along the roadmap's route.
    fn first_free_way(&mut self, object: ObjectId, removed: &ObjectSet, budget: &Budget) -> Result<Option<usize>, Stop> {
        let free = self.free_ways(object, removed, 1, budget)?;
        Ok(match free.first() {
            Some(first) => Some(*first),
            // The roadmap may show a way round what still stands.
            None if self.add_routes(object, removed) => self.free_ways(object, removed, 1, budget)?.first().copied(),
            None => None,
        })
    }

    /// Lets ways to an object end among the clutter when no other lead to it, whatever is removed.
    fn allow_partial(&mut self, object: ObjectId, budget: &Budget) -> Result<bool, Stop> {
        if self.settings.as_in_paper
            || self.partial_ways.contains(object)
            || self.look(object, budget, |explorer, ways, scratch| explorer.any_clear(object, ways, scratch, budget))?
        {
            return Ok(false);
        }
        self.partial_ways.insert(object);
        Ok(true)
    }

    /// Adds ways along the roadmap's routes out for an object, as far as there are any.
    fn add_routes(&mut self, object: ObjectId, removed: &ObjectSet) -> bool {
        let Self { world, floor, roadmap, ways, .. } = self;
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

    /// Plans the motions of a sequence whose objects can all be picked. Steps already planned for
    /// the same beginning are kept.
    fn carry(&mut self, sequence: &Sequence, run: &mut Run) -> Result<bool, Stop> {
        let names = &self.scene.names;
        let mut kept = run.carried.iter().zip(&sequence.objects).take_while(|(c, o)| c.step.object == names[o.index()]).count();
        // The last of the kept steps went home; in a longer sequence it would not.
        kept = kept.min(sequence.objects.len().saturating_sub(1));
        run.carried.truncate(kept);
        let mut situation = match run.carried.last() {
            Some(carried) => carried.after.clone(),
            None => Situation {
                posture: self.start.clone(),
                standing: ObjectSet::first(self.scene.objects.len()),
                placed: Vec::new(),
            },
        };
        for (i, &object) in sequence.objects.iter().enumerate().skip(kept) {
            let removed: ObjectSet = sequence.objects[..i].iter().copied().collect();
            let last = i + 1 == sequence.objects.len();
            match self.carry_one(object, &removed, &situation, last, run)? {
                Ok(carried) => {
                    situation = carried.after.clone();
                    run.observer.event(Event::Taken { object: self.scene.names[object.index()].clone() });
                    run.carried.push(*carried);
                }
                Err(blamed) => {
                    // Rid of what stood in the way, one of the ways tried may do.
                    let sets: Vec<ObjectSet> = blamed.into_iter().map(|b| b.union(removed)).collect();
                    self.blocked(object, removed, &sets, false, run);
                    return Ok(false);
                }
            }
        }
        Ok(true)
    }

    /// One object's motion along one of its free ways; on failure what was blamed.
    #[allow(clippy::type_complexity)]
    fn carry_one(
        &mut self,
        object: ObjectId,
        removed: &ObjectSet,
        situation: &Situation,
        last: bool,
        run: &mut Run,
    ) -> Result<Result<Box<Carried>, Vec<ObjectSet>>, Stop> {
        const WAYS_TRIED: usize = 5;
        let mut blamed = Vec::new();
        for tried in 0..WAYS_TRIED {
            // Those that failed least come first.
            let candidates = self.free_ways(object, removed, tried + 1, &run.budget)?;
            let Some(ways) = self.ways[object.index()].as_mut() else { break };
            let (Some(&index), true) = (candidates.first(), candidates.len() > tried) else { break };
            let mut carrier = Carrier {
                world: &self.world,
                scene: &self.scene,
                inverse: &self.inverse,
                settings: &self.settings.carry,
                random: &mut run.random_motion,
                budget: &run.budget,
                trees: &mut self.trees,
            };
            let way = &ways.ways[index];
            match carrier.take(object, &ways.grasps[way.grasp], way, situation, last)? {
                Ok(carried) => return Ok(Ok(Box::new(carried))),
                Err(obstruction) => {
                    ways.ways[index].failures += 1;
                    run.last_obstruction = Some((object, obstruction.what));
                    if !obstruction.blamed.is_empty() {
                        blamed.push(obstruction.blamed);
                    }
                }
            }
        }
        Ok(Err(ObjectSet::minimal(blamed)))
    }

    fn blocked(&mut self, object: ObjectId, removed: ObjectSet, sets: &[ObjectSet], complete: bool, run: &mut Run) {
        let names = &self.scene.names;
        run.observer.event(Event::Blocked {
            object: names[object.index()].clone(),
            removed_before: removed.names(names),
            blocked_by: sets.iter().map(|s| s.difference(removed).names(names)).collect(),
        });
        self.graph.add_failure(object, removed, sets, complete);
    }

    fn name_all(&self, objects: &[ObjectId]) -> Vec<String> {
        objects.iter().map(|o| self.scene.names[o.index()].clone()).collect()
    }

    fn ways_of(&self, object: ObjectId) -> Option<&Ways> {
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
            settings: &self.settings.ways,
            partial: self.partial_ways.contains(object),
        };
        let ways = match &mut self.ways[object.index()] {
            Some(ways) => ways,
            none => none.insert(explorer.explore(object, budget)?),
        };
        into(&explorer, ways, &mut self.scratch)
    }

    fn free_ways(&mut self, object: ObjectId, removed: &ObjectSet, most: usize, budget: &Budget) -> Result<Vec<usize>, Stop> {
        self.look(object, budget, |explorer, ways, scratch| explorer.free_ways(object, ways, removed, most, scratch, budget))
    }

    fn minimal_sets(&mut self, object: ObjectId, most: usize, budget: &Budget) -> Result<Vec<ObjectSet>, Stop> {
        self.look(object, budget, |explorer, ways, scratch| explorer.minimal_sets(object, ways, most, scratch, budget))
    }

    /// Whether every declared grasp fails for a reason that removing objects cannot mend, by a
    /// complete inverse kinematics, and without the margins that the search keeps.
    fn proved_out_of_reach(&mut self, object: ObjectId, run: &Run) -> Result<bool, Stop> {
        let Some(ways) = self.ways_of(object) else { return Ok(false) };
        // With grasps left, finding no posture proves something only if every posture is found.
        if !ways.grasps.is_empty() && !self.inverse.complete() {
            return Ok(false);
        }
        let mut moment = Moment::new(ObjectSet::EMPTY, self.world.model.robot.hand.open(), 0.0);
        moment.gripping = Some(object);
        let grasps: Vec<_> = ways.grasps.iter().map(|g| g.object_from_tool).collect();
        for object_from_tool in grasps {
            run.budget.check()?;
            let at = self.world.poses[object.index()] * object_from_tool;
            for posture in self.inverse.solve(&at, &self.world.model.robot.home) {
                if self.world.touched(&posture, &moment, &mut self.scratch) != Touch::Fixed {
                    return Ok(false);
                }
            }
        }
        Ok(true)
    }
}

/// How many objects may stand in the way of an object in a sequence of at most `limit`: all but
/// itself, and the target.
fn most_in_way(limit: usize, is_target: bool) -> usize {
    limit.saturating_sub(if is_target { 1 } else { 2 })
}

/// What one call of [`Planner::plan`] carries along.
struct Run<'a> {
    random_roadmap: Xoshiro256PlusPlus,
    random_motion: Xoshiro256PlusPlus,
    budget: Budget,
    stats: Stats,
    motion_time: Duration,
    carried: Vec<Carried>,
    last_obstruction: Option<(ObjectId, &'static str)>,
    observer: &'a mut dyn Observer,
}

enum Outcome {
    Solved(Sequence),
    Impossible,
    Stopped(Stop),
}

fn new_graph(scene: &Scene) -> RetrievalGraph {
    let positions = scene.objects.iter().map(|o| o.pose.translation.truncate().to_array()).collect();
    RetrievalGraph::new(scene.target, positions)
}

/// The objects without which the target (the last) could not be had along the ways chosen: what
/// stands in the target's way, in theirs, and so on. Order is kept.
fn needed(sequence: &[(ObjectId, ObjectSet)]) -> Vec<ObjectId> {
    let mut needed = ObjectSet::EMPTY;
    if let Some((target, _)) = sequence.last() {
        needed.insert(*target);
    }
    for (object, blocked_by) in sequence.iter().rev() {
        if needed.contains(*object) {
            needed = needed.union(*blocked_by);
        }
    }
    sequence.iter().map(|(o, _)| *o).filter(|o| needed.contains(*o)).collect()
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
