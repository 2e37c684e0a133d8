//! The two algorithms of PDDLStream (Garrett, Lozano-Pérez and Kaelbling, 2020): focused and incremental.

use crate::engine::{Answer, Engine};
use crate::facts::{Fact, Value};
use crate::ground::{GroundAction, Grounder, Task, TooManyAlternatives};
use crate::hope::{Hope, Hopes};
use crate::pddl::Goal;
use crate::relevance;
use crate::store::{Hoping, Instance, Store};
use clearway_plan::{Budget, ObjectSet, Stop};
use std::collections::{HashMap, HashSet};

/// How streams and symbols take turns.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Algorithm {
    /// A plan with values not found yet first; then the streams that it needs.
    #[default]
    Focused,
    /// All streams first, once each, then once more; a plan with what they found.
    Incremental,
}

/// A plan that was carried out.
#[derive(Clone, Debug)]
pub struct Solution {
    /// In order: which action of the domain, and its arguments.
    pub actions: Vec<(usize, Vec<Value>)>,
}

/// Why there is no plan.
#[derive(Clone, Debug, PartialEq)]
pub enum NoPlan {
    /// Proved: not even if every stream gave whatever is asked of it.
    Impossible,
    /// Proved: one of these has to be moved, and none ever can be. In all ways to it stands one of the others.
    Stuck {
        needed: ObjectSet,
        others: ObjectSet,
    },
    /// No plan was found even if every stream gave whatever is asked of it, but the engine gave up, saying this.
    Hopeless(String),
    /// No stream has anything more to give.
    Exhausted,
    Stopped(Stop),
    TooMany(TooManyAlternatives),
    /// The engine gave up.
    Engine(String),
}

impl From<Stop> for NoPlan {
    fn from(stop: Stop) -> Self {
        Self::Stopped(stop)
    }
}

/// How much was done.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Counts {
    /// Of the symbolic engine.
    pub engine_calls: usize,
    /// Of streams with outputs.
    pub stream_calls: usize,
    /// How often all streams were asked again.
    pub rounds: usize,
    pub motions_failed: usize,
}

/// One search.
pub struct Search<'s, 'a> {
    pub store: &'s mut Store<'a>,
    pub engine: &'s dyn Engine,
    /// What holds at first, of what changes.
    pub state: &'s [Fact],
    pub goal: &'s Goal,
    pub budget: &'s Budget,
    /// How often all streams may be asked again, and how many motions may fail, before it is given up.
    pub patience: Option<Patience>,
    pub counts: Counts,
    /// Nothing was found yet, by streams or by the engine.
    first_try: bool,
    /// What the engine said when it gave up.
    unproved: Option<String>,
    /// More could have been hoped for than was, the last time.
    cut: bool,
}

/// When a search gives up that could go on.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Patience {
    pub rounds: usize,
    pub motions: usize,
}

/// A plan of an engine, and what it was made with.
struct Sketch {
    task: Task,
    plan: Vec<usize>,
    hopes: Hopes,
}

/// A stream with fluents that failed so often rests for good.
const MOTIONS_TRIED: usize = 3;

/// States that the engine looks at before it gives up, and with actions that do not seem to matter.
const STATES: usize = 30_000;
const THOROUGH_STATES: usize = 2_000;

impl<'s, 'a> Search<'s, 'a> {
    pub fn new(
        store: &'s mut Store<'a>,
        engine: &'s dyn Engine,
        state: &'s [Fact],
        goal: &'s Goal,
        budget: &'s Budget,
    ) -> Self {
        Self {
            store,
            engine,
            state,
            goal,
            budget,
            patience: None,
            counts: Counts::default(),
            first_try: true,
            unproved: None,
            cut: false,
        }
    }

    pub fn run(&mut self, algorithm: Algorithm) -> Result<Solution, NoPlan> {
        match algorithm {
            Algorithm::Focused => self.focused(),
            Algorithm::Incremental => self.incremental(),
        }
    }

    fn focused(&mut self) -> Result<Solution, NoPlan> {
        // At first, and when nothing else is left, all actions count.
        let mut thorough = true;
        loop {
            self.budget.iteration()?;
            self.store.instantiate();
            let Some(sketch) = self.sketch(true, thorough)? else {
                if self.first_try && !self.cut {
                    return Err(self.unproved.take().map_or(NoPlan::Impossible, NoPlan::Hopeless));
                }
                if !self.gave_up() && self.ask_again()? {
                    continue;
                }
                if thorough || self.gave_up() {
                    return Err(NoPlan::Exhausted);
                }
                thorough = true;
                continue;
            };
            if self.gave_up() {
                return Err(NoPlan::Exhausted);
            }
            (thorough, self.first_try) = (false, false);
            let facts: Vec<Fact> = sketch.plan.iter().flat_map(|a| sketch.task.actions[*a].relies_on.clone()).collect();
            let needed = sketch.hopes.needed(self.store, &facts);
            let missing: Vec<usize> =
                needed.into_iter().filter(|h| !self.store.is_fluent(sketch.hopes.hopes[*h].stream)).collect();
            if !missing.is_empty() {
                self.find(&sketch, &missing)?;
            } else if let Some(solution) = self.carry_out(&sketch)? {
                return Ok(solution);
            }
        }
    }

    fn incremental(&mut self) -> Result<Solution, NoPlan> {
        for level in 1.. {
            // Every instance is asked so often, those made of what others found as well.
            loop {
                self.budget.iteration()?;
                self.store.instantiate();
                let due = |i: &usize| {
                    let instance = &self.store.instances[*i];
                    instance.asked < level && !instance.exhausted && !self.store.is_fluent(instance.stream)
                };
                let due: Vec<usize> = (0..self.store.instances.len()).filter(due).collect();
                if due.is_empty() {
                    break;
                }
                for instance in due {
                    self.budget.check()?;
                    self.counts.stream_calls += 1;
                    self.store.ask(instance)?;
                }
            }
            while let Some(sketch) = self.sketch(false, true)? {
                self.budget.iteration()?;
                if let Some(solution) = self.carry_out(&sketch)? {
                    return Ok(solution);
                }
                if self.gave_up() {
                    return Err(NoPlan::Exhausted);
                }
            }
            // A motion that no plan asked for has nothing to give by itself.
            let may_give = |i: &Instance| !i.exhausted && (i.rests || !self.store.is_fluent(i.stream));
            let more = self.store.instances.iter().any(may_give);
            self.retry_motions();
            if self.gave_up() || !more {
                break;
            }
        }
        Err(NoPlan::Exhausted)
    }

    /// A plan with what is known and, with `all`, what is hoped for; `None`: there is none. `thorough`: among all
    /// actions, not only those that seem to matter.
    fn sketch(&mut self, all: bool, thorough: bool) -> Result<Option<Sketch>, NoPlan> {
        let hopes = Hopes::of(self.store, all, self.budget)?;
        self.cut = hopes.cut;
        let values = self.store.values.clone();
        let (facts, optimistic) = (hopes.facts.clone(), hopes.optimistic.clone());
        let grounder = Grounder::new(self.store.domain).within(self.budget);
        let mut hoping = Hoping { store: &mut *self.store, facts, optimistic };
        let task = grounder.task(&values, self.state, &mut hoping, self.goal).map_err(|e| self.too_many(e))?;
        let (few, kept) = relevance::with_only(&task, &relevance::relevant(&task));
        let mut answer = self.solve(&few, STATES)?;
        if let Some(plan) = &mut answer {
            plan.iter_mut().for_each(|a| *a = kept[*a]);
        } else if thorough && kept.len() < task.actions.len() {
            answer = self.solve(&task, THOROUGH_STATES)?;
        }
        Ok(answer.map(|plan| Sketch { task, plan, hopes }))
    }

    /// Why grounding ended: time was up, or there was too much of something.
    fn too_many(&self, error: TooManyAlternatives) -> NoPlan {
        self.budget.check().err().map_or(NoPlan::TooMany(error), NoPlan::Stopped)
    }

    /// A plan; `None`: there is none, or the engine gave up, and what it said is kept.
    fn solve(&mut self, task: &Task, states: usize) -> Result<Option<Vec<usize>>, Stop> {
        self.counts.engine_calls += 1;
        match self.engine.solve(task, states, self.budget) {
            Answer::Plan(plan) => Ok(Some(plan)),
            Answer::Unsolvable => Ok(None),
            Answer::GaveUp(why) => {
                self.budget.check()?;
                self.unproved = Some(why);
                Ok(None)
            }
        }
    }

    /// Asks the streams behind some hopes, in order, as long as they give and the plan still does with what they
    /// gave.
    fn find(&mut self, sketch: &Sketch, missing: &[usize]) -> Result<(), NoPlan> {
        let mut found: HashMap<Value, Value> = HashMap::new();
        for hope in missing {
            self.budget.check()?;
            let hope = &sketch.hopes.hopes[*hope];
            let inputs = hope.inputs.iter().map(|v| found.get(v).copied().unwrap_or(*v)).collect();
            let instance = self.store.instance(hope.stream, inputs);
            if self.store.instances[instance].rests || self.store.instances[instance].exhausted {
                return Ok(());
            }
            self.counts.stream_calls += 1;
            let Some(outputs) = self.store.ask(instance)? else { return Ok(()) };
            found.extend(hope.outputs.iter().copied().zip(outputs));
            if !self.still_does(sketch, &found)? {
                return Ok(());
            }
        }
        Ok(())
    }

    /// Whether a plan still reaches the goal with what was found in place of what was hoped for.
    fn still_does(&mut self, sketch: &Sketch, found: &HashMap<Value, Value>) -> Result<bool, NoPlan> {
        let Sketch { task, plan, hopes } = sketch;
        let values = self.store.values.clone();
        let is = |value: &Value| found.get(value).copied().unwrap_or(*value);
        let replaced = |fact: &Fact| Fact { predicate: fact.predicate, values: fact.values.iter().map(is).collect() };
        let mut facts = self.store.facts.clone();
        hopes.facts().for_each(|fact| {
            facts.insert(replaced(fact));
        });
        let optimistic = hopes.optimistic.iter().filter(|v| !found.contains_key(v)).copied().collect();
        let actions: Vec<(usize, Vec<Value>)> =
            plan.iter().map(|a| (task.actions[*a].action, task.actions[*a].values.iter().map(is).collect())).collect();
        let grounder = Grounder::new(self.store.domain).within(self.budget);
        let mut hoping = Hoping { store: &mut *self.store, facts, optimistic };
        grounder.does(&actions, &values, self.state, &mut hoping, self.goal).map_err(|e| self.too_many(e))
    }

    /// Asks the streams with fluents that a plan needs, each in its state. The first that fails rests; so does the
    /// last if the plan cannot end with it.
    fn carry_out(&mut self, sketch: &Sketch) -> Result<Option<Solution>, Stop> {
        let Sketch { task, plan, hopes } = sketch;
        self.store.procedures.begin();
        let mut state: HashSet<usize> = task.init.iter().copied().collect();
        let mut last = None;
        for index in plan {
            let action: &GroundAction = &task.actions[*index];
            for hope in action.relies_on.iter().filter_map(|fact| hopes.behind(fact)) {
                self.budget.check()?;
                let hope = &hopes.hopes[hope];
                let stream = &self.store.streams[hope.stream];
                let mut atoms: Vec<usize> = state.iter().copied().collect();
                atoms.sort_unstable();
                let now: Vec<Fact> = atoms
                    .into_iter()
                    .map(|a| task.atoms[a].clone())
                    .filter(|f| stream.fluents.contains(&f.predicate))
                    .collect();
                if !self.store.procedures.in_state(stream, &hope.inputs, &now)? {
                    self.motion_failed(hope);
                    return Ok(None);
                }
                last = Some(hope);
            }
            state = task.after(&state, action);
        }
        if !self.store.procedures.end()? {
            if let Some(hope) = last {
                self.motion_failed(hope);
            }
            return Ok(None);
        }
        let actions = plan.iter().map(|a| (task.actions[*a].action, task.actions[*a].values.clone())).collect();
        Ok(Some(Solution { actions }))
    }

    fn motion_failed(&mut self, hope: &Hope) {
        self.counts.motions_failed += 1;
        let instance = self.store.instance(hope.stream, hope.inputs.clone());
        let failed = &mut self.store.instances[instance];
        failed.asked += 1;
        failed.rests = true;
        failed.exhausted = failed.asked >= MOTIONS_TRIED;
    }

    fn gave_up(&self) -> bool {
        let Counts { rounds, motions_failed, .. } = self.counts;
        self.patience.is_some_and(|most| rounds >= most.rounds || motions_failed >= most.motions)
    }

    /// Every stream that was asked is asked once more, and motions that failed may be tried again; false when
    /// nothing came of it. Streams are quick beside the engine, which has fewer hopes to weigh this way. Where not all is
    /// hoped for that could be, streams that were not asked are asked as well: hopes begin at what they find.
    fn ask_again(&mut self) -> Result<bool, Stop> {
        let mut any = self.retry_motions();
        for index in 0..self.store.instances.len() {
            let instance = &self.store.instances[index];
            let due = instance.rests || self.cut;
            if due && !instance.exhausted && !self.store.is_fluent(instance.stream) {
                self.budget.check()?;
                self.counts.stream_calls += 1;
                any |= self.store.ask(index)?.is_some();
            }
        }
        Ok(any)
    }

    /// Motions that failed may be tried again; false when there are none.
    fn retry_motions(&mut self) -> bool {
        self.counts.rounds += 1;
        let mut any = false;
        for instance in self.store.instances.iter_mut().filter(|i| i.rests && !i.exhausted) {
            if !self.store.streams[instance.stream].fluents.is_empty() {
                (instance.rests, any) = (false, true);
            }
        }
        any
    }
}
