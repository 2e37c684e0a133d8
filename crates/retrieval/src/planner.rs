//! Algorithm 1: roadmap, retrieval graph and feasibility checks, interleaved under a rising
//! exploration limit.
//!
//! A [`Planner`] is a session: it owns the scene and what was learned about it, so that a changed
//! scene is planned for again without starting from nothing.

use crate::carry;
use crate::direct::{Direct, Directly};
use crate::feasibility::{Ending, Feasibility, Journey, NoMotion, Taking, Unfit};
use crate::graph::{RetrievalGraph, Search, Sequence};
use crate::mobile;
use crate::order::most_in_way;
use crate::push::{self, Pushes};
use crate::roadmap::{self, Roadmap};
use crate::trace;
use crate::ways;
use clearway_collision::CollisionModel;
use clearway_motion::Posture;
use clearway_plan::event::Observer;
use clearway_plan::plan_file::{PlanFile, Stats};
use clearway_plan::{Budget, Event, ObjectId, ObjectSet, Stop};
use clearway_robot::Robot;
use clearway_scene::Scene;
use rand::SeedableRng;
use rand_xoshiro::Xoshiro256PlusPlus;
use std::sync::Arc;
use std::time::Instant;

/// The exploration limit of the first round (section VI-B).
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
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
    pub push: push::Settings,
    pub mobile: mobile::Settings,
    /// Only the roadmap's ways to the target, not the arm's own; failures give the smallest
    /// blocking set only; sequences are taken as they are.
    pub as_in_paper: bool,
}

impl Settings {
    /// What the paper did, as far as it says.
    pub fn paper() -> Self {
        let push = push::Settings { when: Pushes::Never, ..push::Settings::default() };
        Self { search: Search::Greedy, roadmap: roadmap::Settings::paper(), push, as_in_paper: true, ..Self::default() }
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
    /// Only plans that remove at most so many, the target included; looked for more thoroughly, and with firm holds
    /// only, where an object has any.
    pub most_removals: Option<usize>,
}

impl Request {
    pub fn new(seed: u64, budget: Budget) -> Self {
        Self { seed, budget, most_removals: None }
    }
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
    arm: Feasibility,
    settings: Settings,
    roadmap: Roadmap,
    graph: RetrievalGraph,
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
        let arm = Feasibility::new(
            scene,
            model,
            settings.ways.clone(),
            settings.carry.clone(),
            settings.push.clone(),
            settings.mobile.clone(),
        )?;
        let (roadmap, graph) = (Roadmap::new(&arm.floor), new_graph(&arm.scene));
        Ok(Self { arm, settings, roadmap, graph })
    }

    pub fn scene(&self) -> &Scene {
        &self.arm.scene
    }

    pub fn robot(&self) -> &Arc<Robot> {
        self.arm.robot()
    }

    /// What the robot can do in this scene, as far as it was found out.
    pub fn feasibility(&mut self) -> &mut Feasibility {
        &mut self.arm
    }

    /// Takes a change in. What was learned is kept where it still holds: all of it when only the
    /// arm moved, the roadmap's samples and the robot's own tables when objects did.
    pub fn update(&mut self, delta: SceneDelta) -> Result<(), Unfit> {
        match delta {
            SceneDelta::Posture(posture) => self.arm.set_start(posture)?,
            SceneDelta::Scene(scene) => {
                self.arm.set_scene(*scene);
                self.begin_anew();
            }
        }
        Ok(())
    }

    /// Another object is wanted. What is known of reaching each one stays.
    pub(crate) fn retarget(&mut self, target: ObjectId) {
        self.arm.retarget(target);
        self.begin_anew();
    }

    /// A roadmap and a graph for the scene as it is.
    fn begin_anew(&mut self) {
        self.roadmap = Roadmap::new(&self.arm.floor);
        self.graph = new_graph(&self.arm.scene);
    }

    /// Plans, at first with firm holds only. Everything random comes from the request's seed.
    pub fn plan(&mut self, request: &Request, observer: &mut dyn Observer) -> Answer {
        let began = Instant::now();
        if self.arm.set_loosely(false) {
            self.begin_anew();
        }
        let mut run = Run {
            random_roadmap: Xoshiro256PlusPlus::seed_from_u64(request.seed ^ 0x526f_6164),
            journey: Journey::new(request.seed),
            most_removals: request.most_removals,
            budget: request.budget.clone(),
            stats: Stats::default(),
            observer,
        };
        let mut outcome = self.search_or_stop(&mut run);
        if let Ok(Ok(sequence)) = &outcome
            && let Some(better) = self.from_the_start(sequence.objects.len(), request.seed, &mut run)
        {
            outcome = Ok(Ok(better));
        }
        let total = began.elapsed();
        let Run { journey, mut stats, .. } = run;
        let timing = journey.timing(total);
        stats.roadmap_nodes = self.roadmap.nodes.len();
        stats.retrieval_nodes = self.graph.len();
        stats.samples = self.roadmap.samples;
        stats.grasps_tried =
            self.arm.stands.iter().flat_map(|s| s.ways.iter().flatten()).map(|w| w.counts.total()).sum();
        let (ending, sequence, stopped) = match outcome {
            Ok(Ok(sequence)) => (Ending::Solved(sequence.objects.clone()), Some(sequence), None),
            Ok(Err(stuck)) => (Ending::Impossible(stuck), None, None),
            Err(stop) => (Ending::Stopped(Some(stop)), None, Some(stop)),
        };
        let mut plan = self.arm.plan_file(&ending, journey, &request.budget);
        plan.trace = Some(trace::trace(&self.arm, &self.roadmap, &self.graph, sequence.as_ref()));
        plan.seed = request.seed;
        plan.timing = timing;
        plan.stats = stats;
        Answer { plan, stopped }
    }

    /// Where motions were not found, and the base drives, a shorter sequence may be left that the robot can take from
    /// where it stands: driving is not to cost removals.
    fn from_the_start(&mut self, removed: usize, seed: u64, run: &mut Run) -> Option<Sequence> {
        if self.arm.stands.len() == 1 || run.stats.sequences_tried <= 1 || removed <= 1 {
            return None;
        }
        let others = self.arm.stands.split_off(1);
        self.arm.drop_failed();
        let (roadmap, graph) = (self.roadmap.clone(), self.graph.clone());
        self.begin_anew();
        let mut again = Run {
            random_roadmap: Xoshiro256PlusPlus::seed_from_u64(seed ^ 0x526f_6164),
            journey: Journey::new(seed),
            most_removals: Some(removed - 1),
            budget: run.budget.clone(),
            stats: run.stats.clone(),
            observer: &mut *run.observer,
        };
        let found = self.search_or_stop(&mut again).ok().and_then(Result::ok);
        let Run { mut journey, stats, .. } = again;
        self.arm.stands.extend(others);
        match found {
            Some(_) => {
                std::mem::swap(&mut run.journey, &mut journey);
                run.stats = stats;
            }
            None => (self.roadmap, self.graph) = (roadmap, graph),
        }
        run.journey.took_as_well(&journey);
        found
    }

    /// The sequence whose motions the journey then holds, or, when it is proved that there is none, the objects that are
    /// never taken, the target among them.
    fn search_or_stop(&mut self, run: &mut Run) -> Result<Result<Sequence, ObjectSet>, Stop> {
        let target = self.arm.scene.target;
        let count = self.arm.scene.objects.len();
        run.budget.check()?;
        self.arm.choose_stops();
        let mut proof_tried = false;
        if self.arm.minimal_sets(target, 0, &run.budget)?.is_empty() && self.arm.no_way_is_known(target) {
            let stuck = self.arm.proved_stuck(target, &run.budget)?;
            if !stuck.is_empty() {
                return Ok(Err(stuck));
            }
            proof_tried = true;
        }
        let first = match self.settings.first_limit {
            FirstLimit::One => 1,
            FirstLimit::GraspCover => {
                1 + self.arm.minimal_sets(target, count, &run.budget)?.iter().map(ObjectSet::len).min().unwrap_or(0)
            }
            FirstLimit::All => count,
        };
        let most = run.most_removals.unwrap_or(count).min(count);
        let mut limit = first.min(most);
        let mut direct = Direct::new(count, target, run.most_removals);
        loop {
            run.budget.iteration()?;
            run.stats.iterations += 1;
            run.stats.exploration_limit = limit;
            // The arm's own ways may do; then the roadmap need not grow.
            if !self.settings.as_in_paper {
                match self.search_directly(&mut direct, &mut limit, run)? {
                    Ok(sequence) => return Ok(Ok(sequence)),
                    // As long as there may be more of these, long ones along the roadmap are not asked for.
                    Err(Some(next)) if limit >= LONG && next <= most => {
                        limit = next;
                        continue;
                    }
                    // None of any length: there may be no other either.
                    Err(None) if !proof_tried && run.most_removals.is_none() => {
                        proof_tried = true;
                        let stuck = self.arm.proved_stuck(target, &run.budget)?;
                        if !stuck.is_empty() {
                            return Ok(Err(stuck));
                        }
                    }
                    Err(_) => {}
                }
            }
            self.look_up_to(limit, &direct, &run.budget)?;
            self.roadmap.expand(
                &self.arm.floor,
                limit,
                &self.settings.roadmap,
                &mut run.random_roadmap,
                &run.budget,
            )?;
            let (clusters, edges) = self.roadmap.clusters();
            // Clusters come in the order of their first nodes; x_s and x_g are nodes 0 and 1, alone.
            self.graph.set_clusters(clusters, &edges, 0, 1);
            run.observer.event(Event::Iteration {
                exploration_limit: limit,
                roadmap_nodes: self.roadmap.nodes.len(),
                retrieval_nodes: self.graph.len(),
            });
            if let Some(sequence) = self.check_all(limit, run)? {
                return Ok(Ok(sequence));
            }
            if limit < most {
                limit += 1;
                continue;
            }
            if run.most_removals.is_some() {
                return Err(Stop::Iterations);
            }
            // Everything known has failed at the widest limit. From the beginning, then: with looser holds, where any
            // were left out, and as other motions may be found.
            if self.arm.hold_loosely() {
                self.begin_anew();
                run.journey.carried.clear();
                self.arm.choose_stops();
            }
            self.graph.forget();
            direct = Direct::new(count, target, None);
            limit = 1;
        }
    }

    /// The fewest objects along the arm's own ways; where there are none, the next limit at which there
    /// may be some.
    fn search_directly(
        &mut self,
        direct: &mut Direct,
        limit: &mut usize,
        run: &mut Run,
    ) -> Result<Result<Sequence, Option<usize>>, Stop> {
        let mut in_vain: Option<Vec<ObjectId>> = None;
        loop {
            let objects = match direct.search(&mut self.arm, limit, &run.budget)? {
                Directly::Objects(objects) => objects,
                Directly::Nothing { next } => return Ok(Err(next)),
            };
            run.stats.exploration_limit = *limit;
            run.stats.sequences_tried += 1;
            run.observer.event(Event::Sequence { objects: self.name_all(&objects) });
            let tried = objects.clone();
            let sequence = Sequence { objects, nodes: Vec::new(), distance: 0.0 };
            match self.check(sequence, *limit, run)? {
                Ok(sequence) => return Ok(Ok(sequence)),
                // With nothing to blame, chance may have been: it is asked once more.
                Err(failure) if failure.blamed.is_empty() && in_vain.as_ref() != Some(&tried) => in_vain = Some(tried),
                Err(failure) => direct.failed(failure),
            }
        }
    }

    /// Tells the graph the sets that a raised limit lets count: ways that more objects stand in are
    /// not looked into before.
    fn look_up_to(&mut self, limit: usize, direct: &Direct, budget: &Budget) -> Result<(), Stop> {
        let target = self.arm.scene.target;
        if !self.settings.as_in_paper {
            let sets = self.arm.minimal_sets(target, most_in_way(limit, true), budget)?;
            self.graph.add_direct(&sets);
            let mut objects: ObjectSet = self.graph.complete().into_iter().chain(direct.looked_into()).collect();
            objects.remove(target);
            for object in objects.iter() {
                let sets = self.arm.minimal_sets(object, most_in_way(limit, false), budget)?;
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
            if let Ok(sequence) = self.check(sequence, limit, run)? {
                return Ok(Some(sequence));
            }
        }
        Ok(None)
    }

    /// Feasibility check of a sequence. On failure the graph has learned something.
    fn check(&mut self, sequence: Sequence, limit: usize, run: &mut Run) -> Result<Result<Sequence, NoMotion>, Stop> {
        let mut removed = ObjectSet::EMPTY;
        let mut needs: Vec<(ObjectId, ObjectSet)> = Vec::new();
        for &object in &sequence.objects {
            let Some(first) = self.first_free_way(object, &removed, &run.budget)? else {
                let is_target = object == self.arm.scene.target;
                let most = if self.settings.as_in_paper {
                    self.arm.scene.objects.len()
                } else {
                    most_in_way(limit, is_target)
                };
                let mut sets = self.arm.minimal_sets(object, most, &run.budget)?;
                if self.settings.as_in_paper {
                    sets.truncate(1);
                }
                // The roadmap is the target's: with other objects gone it may show it other routes.
                let complete = !is_target;
                self.blocked(object, removed, &sets, complete, run);
                return Ok(Err(NoMotion { object, removed, blamed: sets }));
            };
            needs.push((object, self.arm.way(object, first).map_or(ObjectSet::EMPTY, |w| w.blocked_by)));
            removed.insert(object);
        }
        // What none of the ways chosen needs may stay, unless its staying has failed already.
        let needed = needed(&needs);
        let sequence = if !self.settings.as_in_paper && self.graph.allows_all(&needed) {
            Sequence { objects: needed, ..sequence }
        } else {
            sequence
        };
        let observer = &mut *run.observer;
        let taken = |name: &str| observer.event(Event::Taken { object: name.to_owned() });
        match self.arm.carry(&sequence.objects, &mut run.journey, &run.budget, taken)? {
            Ok(()) => Ok(Ok(sequence)),
            Err(failure) => {
                self.blocked(failure.object, failure.removed, &failure.blamed, false, run);
                Ok(Err(failure))
            }
        }
    }

    /// A way that is free once `removed` is gone: straight out, or along the roadmap's route.
    fn first_free_way(
        &mut self,
        object: ObjectId,
        removed: &ObjectSet,
        budget: &Budget,
    ) -> Result<Option<Taking>, Stop> {
        let free = self.arm.free_ways(object, removed, 1, budget)?;
        Ok(match free.first() {
            Some(first) => Some(*first),
            // The roadmap may show a way round what still stands.
            None if self.arm.add_routes(object, removed, &self.roadmap) => {
                self.arm.free_ways(object, removed, 1, budget)?.first().copied()
            }
            None => None,
        })
    }

    fn blocked(&mut self, object: ObjectId, removed: ObjectSet, sets: &[ObjectSet], complete: bool, run: &mut Run) {
        let names = &self.arm.scene.names;
        run.observer.event(Event::Blocked {
            object: names[object.index()].clone(),
            removed_before: removed.names(names),
            blocked_by: sets.iter().map(|s| s.difference(removed).names(names)).collect(),
        });
        self.graph.add_failure(object, removed, sets, complete);
    }

    fn name_all(&self, objects: &[ObjectId]) -> Vec<String> {
        objects.iter().map(|o| self.arm.scene.names[o.index()].clone()).collect()
    }
}

/// Sequences of more objects are looked for along the arm's own ways first: with more the roadmap takes
/// too long.
const LONG: usize = 6;

/// What one call of [`Planner::plan`] carries along.
struct Run<'a> {
    random_roadmap: Xoshiro256PlusPlus,
    journey: Journey,
    most_removals: Option<usize>,
    budget: Budget,
    stats: Stats,
    observer: &'a mut dyn Observer,
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
