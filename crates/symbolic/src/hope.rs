//! Optimism: every stream that may still give something is taken to give it, as values with a `#`, and so
//! are the streams that those would be inputs of.
//!
//! Where everything may be put on everything there is no end to it: poses on poses on poses. Then fewer are hoped for
//! that are made of others of their type; what was found takes their place, and hopes begin there anew.

use crate::facts::{Fact, Facts, Value};
use crate::pddl::TypeId;
use crate::store::Store;
use clearway_plan::{Budget, Stop};
use std::collections::{BTreeMap, HashMap, HashSet};

/// Streams that feed on each other's outputs are followed so far.
const DEPTH: usize = 8;
/// Of one type, of which each is made of the one before, so many are hoped for; fewer where there would be too many
/// hopes in all.
const GENERATIONS: [usize; 3] = [DEPTH, 3, 2];
const TOO_MANY: usize = 3_000;
/// Where those are too many as well. What is left out is hoped for when something of what was hoped for was found.
const FEWEST: usize = 1;
const MOST: usize = 20_000;

/// A stream that is hoped to give these outputs.
#[derive(Clone, Debug)]
pub struct Hope {
    pub stream: usize,
    pub inputs: Vec<Value>,
    pub outputs: Vec<Value>,
}

/// What is known, and what is hoped for.
pub struct Hopes {
    pub facts: Facts,
    /// Values not found yet.
    pub optimistic: HashSet<Value>,
    pub hopes: Vec<Hope>,
    /// Which hope a fact comes from that is not known.
    by_fact: HashMap<Fact, usize>,
    /// Of a hoped for value: of how many of each type, each made of the one before, it is made, itself included.
    made_of: HashMap<Value, BTreeMap<TypeId, usize>>,
    /// More could have been hoped for.
    pub cut: bool,
}

impl Hopes {
    /// With `all`, streams that only could be asked are hoped for too; else only those with fluents, which are
    /// asked in a plan.
    pub fn of(store: &mut Store, all: bool, budget: &Budget) -> Result<Self, Stop> {
        if !all {
            return Self::within(store, all, DEPTH, usize::MAX, budget);
        }
        for generations in GENERATIONS {
            let hopes = Self::within(store, all, generations, TOO_MANY, budget)?;
            if hopes.hopes.len() < TOO_MANY {
                return Ok(Self { cut: generations < DEPTH, ..hopes });
            }
        }
        Ok(Self { cut: true, ..Self::within(store, all, FEWEST, MOST, budget)? })
    }

    /// So many generations; as soon as there are so many hopes in all, no more.
    fn within(store: &mut Store, all: bool, generations: usize, most: usize, budget: &Budget) -> Result<Self, Stop> {
        let mut hopes = Self {
            facts: store.facts.clone(),
            optimistic: HashSet::new(),
            hopes: Vec::new(),
            by_fact: HashMap::new(),
            made_of: HashMap::new(),
            cut: false,
        };
        for instance in 0..store.instances.len() {
            let known = &store.instances[instance];
            let fluent = store.is_fluent(known.stream);
            if !known.rests && !known.exhausted && (fluent || all) {
                let (stream, inputs) = (known.stream, known.inputs.clone());
                let made_of = hopes.made_of(store, stream, &inputs);
                hopes.add(store, stream, inputs, made_of, fluent);
            }
        }
        let mut hoped: HashSet<(usize, Vec<Value>)> = HashSet::new();
        for _ in 0..if all { DEPTH } else { 0 } {
            let before = hopes.hopes.len();
            for stream in (0..store.streams.len()).filter(|s| !store.is_test(*s)).collect::<Vec<_>>() {
                budget.check()?;
                for inputs in store.inputs_among(stream, &hopes.facts, &hopes.optimistic) {
                    let open = inputs.iter().any(|v| hopes.optimistic.contains(v));
                    if open && hoped.insert((stream, inputs.clone())) {
                        let made_of = hopes.made_of(store, stream, &inputs);
                        if made_of.values().all(|generation| *generation <= generations) {
                            hopes.add(store, stream, inputs, made_of, false);
                        }
                    }
                    if hopes.hopes.len() >= most {
                        return Ok(hopes);
                    }
                }
            }
            if hopes.hopes.len() == before {
                break;
            }
        }
        Ok(hopes)
    }

    /// What outputs of a stream would be made of, themselves included.
    fn made_of(&self, store: &Store, stream: usize, inputs: &[Value]) -> BTreeMap<TypeId, usize> {
        let mut made_of: BTreeMap<TypeId, usize> = BTreeMap::new();
        for (of, count) in inputs.iter().filter_map(|v| self.made_of.get(v)).flatten() {
            let most = made_of.entry(*of).or_default();
            *most = (*most).max(*count);
        }
        store.streams[stream].outputs.iter().for_each(|output| *made_of.entry(output.of).or_default() += 1);
        made_of
    }

    fn add(
        &mut self,
        store: &mut Store,
        stream: usize,
        inputs: Vec<Value>,
        made_of: BTreeMap<TypeId, usize>,
        found: bool,
    ) {
        let declared = &store.streams[stream];
        let mut outputs = Vec::new();
        for output in &declared.outputs {
            let name =
                format!("{}#{}{}", crate::arm::GENERATED, &output.name[1..], self.optimistic.len() + self.hopes.len());
            let value = store.values.add(&format!("{name}-{}", store.domain.types.names[output.of.0]), output.of);
            if !found {
                self.optimistic.insert(value);
                self.made_of.insert(value, made_of.clone());
            }
            outputs.push(value);
        }
        for fact in store.certified(stream, &inputs, &outputs) {
            if self.facts.insert(fact.clone()) {
                self.by_fact.insert(fact, self.hopes.len());
            }
        }
        self.hopes.push(Hope { stream, inputs, outputs });
    }

    /// The facts that are only hoped for.
    pub fn facts(&self) -> impl Iterator<Item = &Fact> {
        self.facts.iter().filter(|fact| self.by_fact.contains_key(fact))
    }

    /// The hope that a fact comes from; `None`: it is known.
    pub fn behind(&self, fact: &Fact) -> Option<usize> {
        self.by_fact.get(fact).copied()
    }

    /// The hopes that some facts need, each after those that it needs itself.
    pub fn needed(&self, store: &Store, facts: &[Fact]) -> Vec<usize> {
        let mut order = Vec::new();
        facts.iter().for_each(|fact| self.need(store, fact, &mut order));
        order
    }

    fn need(&self, store: &Store, fact: &Fact, order: &mut Vec<usize>) {
        let Some(hope) = self.behind(fact) else { return };
        if order.contains(&hope) {
            return;
        }
        let Hope { stream, inputs, .. } = &self.hopes[hope];
        store.required(*stream, inputs).iter().for_each(|fact| self.need(store, fact, order));
        if !order.contains(&hope) {
            order.push(hope);
        }
    }
}
