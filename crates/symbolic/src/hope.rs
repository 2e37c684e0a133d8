//! Optimism: every stream that may still give something is taken to give it, as values with a `#`, and so
//! are the streams that those would be inputs of.

use crate::facts::{Fact, Facts, Value};
use crate::store::Store;
use std::collections::{HashMap, HashSet};

/// Streams that feed on each other's outputs are followed so far.
const DEPTH: usize = 8;

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
}

impl Hopes {
    /// With `all`, streams that only could be asked are hoped for too; else only those with fluents, which are
    /// asked in a plan.
    pub fn of(store: &mut Store, all: bool) -> Self {
        let mut hopes =
            Self { facts: store.facts.clone(), optimistic: HashSet::new(), hopes: Vec::new(), by_fact: HashMap::new() };
        for instance in 0..store.instances.len() {
            let known = &store.instances[instance];
            let fluent = store.is_fluent(known.stream);
            if !known.rests && !known.exhausted && (fluent || all) {
                let (stream, inputs) = (known.stream, known.inputs.clone());
                hopes.add(store, stream, inputs, fluent);
            }
        }
        let mut hoped: HashSet<(usize, Vec<Value>)> = HashSet::new();
        for _ in 0..if all { DEPTH } else { 0 } {
            let before = hopes.hopes.len();
            for stream in (0..store.streams.len()).filter(|s| !store.is_test(*s)).collect::<Vec<_>>() {
                for inputs in store.inputs_among(stream, &hopes.facts, &hopes.optimistic) {
                    let open = inputs.iter().any(|v| hopes.optimistic.contains(v));
                    if open && hoped.insert((stream, inputs.clone())) {
                        hopes.add(store, stream, inputs, false);
                    }
                }
            }
            if hopes.hopes.len() == before {
                break;
            }
        }
        hopes
    }

    fn add(&mut self, store: &mut Store, stream: usize, inputs: Vec<Value>, found: bool) {
        let declared = &store.streams[stream];
        let mut outputs = Vec::new();
        for output in &declared.outputs {
            let name =
                format!("{}#{}{}", crate::arm::GENERATED, &output.name[1..], self.optimistic.len() + self.hopes.len());
            let value = store.values.add(&format!("{name}-{}", store.domain.types.names[output.of.0]), output.of);
            if !found {
                self.optimistic.insert(value);
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
