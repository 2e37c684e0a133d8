//! A scene as a symbolic planner sees it, a goal for it, and the plan that comes of it.
//!
//! With sequences, the join of section V-C: the objects by which what the goal names can be had are all that
//! may be moved, everything else stands fast. What is found impossible among those goes back to where the
//! sequences come from. When none is left, all objects may be moved.

use crate::arm::Arm;
use crate::engine::Engine;
use crate::needs::Needs;
use crate::pddl::{Atom, Domain, Formula, Goal, Stream, Term};
use crate::search::{Algorithm, Counts, NoPlan, Patience, Search};
use crate::store::Store;
use crate::telling::{Begun, begin};
use clearway_plan::plan_file::{PlanFile, Stats, Timing};
use clearway_plan::{Budget, ObjectId, ObjectSet, Stop};
use clearway_retrieval::candidates::Candidates;
use clearway_retrieval::carry::Carried;
use clearway_retrieval::handling::Handling;
use clearway_scene::Scene;
use std::time::{Duration, Instant};

/// What is asked for, and how it is planned.
pub struct Asked<'a> {
    pub domain: &'a Domain,
    pub streams: &'a [Stream],
    pub goal: &'a Goal,
    /// It is only to have the target: what else goes is put on a place for good, as in other retrievals.
    pub retrieval: bool,
    pub algorithm: Algorithm,
    pub engine: &'a dyn Engine,
    /// Only objects of candidate removal sequences may be moved, as long as that leads anywhere.
    pub sequences: bool,
    /// What removals alone reach is not planned with symbols.
    pub removals: bool,
}

/// What came of it; the plan is not yet verified.
#[derive(Clone, Debug)]
pub struct Answer {
    pub plan: PlanFile,
    /// What stopped the search, if something did.
    pub stopped: Option<Stop>,
    pub counts: Counts,
    /// How many objects could be moved in the end.
    pub movable: usize,
    /// How many sets of movable objects were tried.
    pub tries: usize,
}

/// The goal of a retrieval: the target on any place.
pub fn retrieval(domain: &Domain, scene: &Scene) -> Option<Goal> {
    let predicate = domain.predicate("On")?;
    let target = &scene.names[scene.target.index()];
    let on = |place: &str| {
        Formula::Atom(Atom { predicate, terms: vec![Term::Constant(target.clone()), Term::Constant(place.to_owned())] })
    };
    let formula = Formula::Or(scene.places.iter().map(|p| on(&p.id)).collect());
    Some(Goal { slots: 0, formula, text: format!("to have `{target}`") })
}

/// Among the objects of a sequence a search gives up before it has asked every stream for all it has.
const PATIENCE: Patience = Patience { rounds: 2, motions: 5 };

/// Plans and carries out.
pub fn solve(handling: &mut Handling, asked: &Asked, seed: u64, budget: &Budget) -> Answer {
    let began = Instant::now();
    // What is held was not put down: steps end with an empty hand.
    let goal = with_empty_hand(asked.goal, asked.domain);
    let asked = &Asked { goal: &goal, ..*asked };
    let mut run = Run {
        handling,
        asked,
        budget,
        counts: Counts::default(),
        moving: Duration::ZERO,
        tries: 0,
        movable: 0,
        without_way: ObjectSet::EMPTY,
    };
    let ended = run.run();
    let Run { handling, counts, moving, tries, movable, without_way, .. } = run;
    let total = began.elapsed();
    let timing = Timing {
        total: total.as_secs_f64(),
        task: total.saturating_sub(moving).as_secs_f64(),
        motion: moving.as_secs_f64(),
    };
    let goal = Some(asked.goal.text.as_str()).filter(|_| !asked.retrieval);
    let (plan, stopped) = match ended {
        // Nothing to do is a plan, too, but not one that has the target.
        Ok(carried) if carried.is_empty() => (handling.plan_file(carried, Some(&asked.goal.text), timing, seed), None),
        Ok(carried) => (handling.plan_file(carried, goal, timing, seed), None),
        Err(no_plan) => {
            let stopped = match no_plan {
                NoPlan::Stopped(stop) => Some(stop),
                _ => None,
            };
            let mut why = told(handling, &no_plan, &asked.goal.text);
            let proved = matches!(no_plan, NoPlan::Stuck { .. });
            if !proved && !without_way.is_empty() {
                let names = quoted(handling.scene(), without_way);
                why += &format!(" No grasp that was tried leads to what has to be moved for it: {names}.");
            }
            (handling.no_plan(why, proved, goal, timing, seed), stopped)
        }
    };
    let stats = Stats {
        iterations: counts.engine_calls,
        samples: counts.stream_calls,
        sequences_tried: tries,
        ..Stats::default()
    };
    Answer { plan: PlanFile { stats, ..plan }, stopped, counts, movable, tries }
}

fn told(handling: &Handling, no_plan: &NoPlan, goal: &str) -> String {
    match no_plan {
        NoPlan::Stuck { needed, others } => {
            let names = quoted(handling.scene(), *needed);
            let why = match needed.iter().next() {
                Some(object) if needed.len() == 1 => {
                    format!("{names} has to be moved for it. {}", handling.never_taken(object, *others))
                }
                _ => format!(
                    "one of {names} has to be moved for it, and no declared grasp of any of these can be reached, whatever goes first."
                ),
            };
            format!("The goal {goal} cannot be reached: {why}")
        }
        // Hopes merge what a stream may find, so that this is no proof.
        NoPlan::Impossible => format!(
            "No plan reaches the goal {goal}, even if every grasp, pose and motion asked for could be had: does it contradict itself? Nothing is proved."
        ),
        NoPlan::Hopeless(why) => format!(
            "No plan for the goal {goal} was found, even if every grasp, pose and motion asked for could be had; the symbolic engine gave up: {why}. Nothing is proved."
        ),
        NoPlan::Exhausted => format!(
            "Everything that the streams found was tried, and the goal {goal} was not reached; nothing is proved."
        ),
        NoPlan::Stopped(Stop::Cancelled) => format!("Interrupted before the goal {goal} was reached."),
        NoPlan::Stopped(Stop::Iterations) => {
            format!("The iterations allowed were spent before the goal {goal} was reached; nothing is proved.")
        }
        NoPlan::Stopped(Stop::Deadline) => {
            format!("The time allowed was spent before the goal {goal} was reached; nothing is proved.")
        }
        NoPlan::TooMany(crate::ground::TooManyAlternatives { of }) => {
            format!(
                "There are too many alternatives in {of}: write it with fewer `or`, `exists` and conditional effects."
            )
        }
        NoPlan::Engine(why) => format!("The symbolic engine gave up on the goal {goal}: {why}."),
    }
}

fn quoted(scene: &Scene, objects: ObjectSet) -> String {
    objects.names(&scene.names).iter().map(|name| format!("`{name}`")).collect::<Vec<_>>().join(", ")
}

struct Run<'a> {
    handling: &'a mut Handling,
    asked: &'a Asked<'a>,
    budget: &'a Budget,
    counts: Counts,
    moving: Duration,
    tries: usize,
    movable: usize,
    /// What has to be moved for the goal, and to which no way was found.
    without_way: ObjectSet,
}

/// What a try with some objects movable teaches when it fails.
struct Learned {
    no_plan: NoPlan,
    /// By object: the sets of which one would have to go.
    blamed: Vec<(ObjectId, Vec<ObjectSet>)>,
}

impl Run<'_> {
    fn run(&mut self) -> Result<Vec<Carried>, NoPlan> {
        let all = self.handling.scene().all();
        let needs = Needs::of(self.asked, self.handling, self.budget)?;
        if self.asked.removals
            && let Some((carried, moving)) = needs.by_removals(self.handling, self.budget)?
        {
            self.moving += moving;
            self.movable = carried.len();
            return Ok(carried);
        }
        self.without_way = needs.without_way(self.handling, self.budget)?;
        needs.prove_of(self.without_way, self.handling, self.budget)?;
        if self.asked.sequences {
            let wanted = self.named();
            let arm = self.handling.arm();
            let mut candidates: Vec<Candidates> = wanted.iter().map(|o| Candidates::new(arm, o)).collect();
            let mut before = ObjectSet::EMPTY;
            loop {
                let mut sequences = Vec::new();
                for candidates in &mut candidates {
                    sequences.push(candidates.best(self.handling.arm(), self.budget)?);
                }
                let Some(sequences) = sequences.into_iter().collect::<Option<Vec<Vec<ObjectId>>>>() else { break };
                let movable: ObjectSet = sequences.iter().flatten().copied().collect();
                if movable == before || movable == all {
                    break;
                }
                before = movable;
                match self.with(movable, Some(PATIENCE))? {
                    Ok(carried) => return Ok(carried),
                    // More objects to move will not mend a goal that cannot be.
                    Err(Learned { no_plan: NoPlan::Impossible | NoPlan::Hopeless(_), .. }) => break,
                    Err(learned) => {
                        for (candidates, sequence) in candidates.iter_mut().zip(&sequences) {
                            learned.tell(candidates, sequence);
                        }
                    }
                }
            }
        }
        // What follows may take long; not so where no objects are told apart from the start.
        if self.asked.sequences {
            needs.prove(self.handling, self.budget)?;
        }
        self.with(all, None)?.map_err(|learned| learned.no_plan)
    }

    /// The objects that the goal names.
    fn named(&self) -> ObjectSet {
        let mut names = Vec::new();
        constants_of(&self.asked.goal.formula, &mut names);
        names.into_iter().filter_map(|name| self.handling.scene().object(name)).collect()
    }

    /// Plans with only these objects movable. `Err`: stopped.
    fn with(
        &mut self,
        movable: ObjectSet,
        patience: Option<Patience>,
    ) -> Result<Result<Vec<Carried>, Learned>, NoPlan> {
        self.tries += 1;
        self.movable = movable.len();
        let Asked { domain, streams, goal, algorithm, engine, .. } = *self.asked;
        let fixed = self.handling.scene().all().difference(movable);
        // Having the target says nothing of what stands fast; other goals may be about everything.
        let told = if self.asked.retrieval { movable } else { self.handling.scene().all() };
        let mut arm = Arm::new(self.handling, fixed, self.budget);
        let Begun { values, facts, state } =
            begin(domain, goal, &mut arm, told, self.asked.retrieval).map_err(NoPlan::Engine)?;
        let mut store = Store::new(domain, streams, values, facts, &mut arm);
        let mut search = Search::new(&mut store, engine, &state, goal, self.budget);
        search.patience = patience;
        search.counts = Counts { rounds: 0, motions_failed: 0, ..self.counts };
        let found = search.run(algorithm);
        self.counts = search.counts;
        self.moving += arm.moving;
        match found {
            Ok(solution) => {
                let carried = arm.into_carried();
                if carried.is_empty() && !solution.actions.is_empty() {
                    let why = "its plan asks for no motions: which action needs `plan-motion`?".to_owned();
                    return Err(NoPlan::Engine(why));
                }
                Ok(Ok(carried))
            }
            Err(NoPlan::Stopped(stop)) => Err(NoPlan::Stopped(stop)),
            Err(no_plan) => {
                let blamed = movable.iter().filter_map(|o| Some((o, arm.blamed(o)?))).collect();
                Ok(Err(Learned { no_plan, blamed }))
            }
        }
    }
}

impl Learned {
    /// What a sequence's failure means for the next one.
    fn tell(&self, candidates: &mut Candidates, sequence: &[ObjectId]) {
        let mut removed = ObjectSet::EMPTY;
        for object in sequence {
            if let Some((_, sets)) = self.blamed.iter().find(|(o, _)| o == object) {
                return candidates.failed(*object, removed, sets);
            }
            removed.insert(*object);
        }
        if let Some((target, others)) = sequence.split_last() {
            candidates.failed(*target, others.iter().copied().collect(), &[]);
        }
    }
}

/// A goal, and nothing in the hand.
fn with_empty_hand(goal: &Goal, domain: &Domain) -> Goal {
    let empty = domain.predicate("HandEmpty").map(|predicate| Formula::Atom(Atom { predicate, terms: Vec::new() }));
    let formula = Formula::And([goal.formula.clone()].into_iter().chain(empty).collect());
    Goal { formula, ..goal.clone() }
}

/// Names of constants in a formula.
fn constants_of<'f>(formula: &'f Formula, names: &mut Vec<&'f str>) {
    let mut terms = |terms: &'f [Term]| {
        names.extend(terms.iter().filter_map(|t| match t {
            Term::Constant(name) => Some(name.as_str()),
            Term::Variable(_) => None,
        }));
    };
    match formula {
        Formula::And(parts) | Formula::Or(parts) => parts.iter().for_each(|p| constants_of(p, names)),
        Formula::Not(inner) | Formula::Forall(_, inner) | Formula::Exists(_, inner) => constants_of(inner, names),
        Formula::Atom(atom) => terms(&atom.terms),
        // That something is, or is not, this one asks nothing of it.
        Formula::Equal(..) => {}
    }
}
