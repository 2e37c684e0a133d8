//! A toy with everything that its streams can ever give: an oracle for searches.

use super::Toy;
use crate::naive::{Naive, State, Step};
use clearway_symbolic::facts::{Fact, Facts, Slots, Value, Values, instantiate};
use clearway_symbolic::pddl::{PredicateId, Stream};
use std::collections::{HashMap, HashSet};

pub struct All<'t> {
    toy: &'t Toy,
    values: Values,
    facts: Facts,
    /// Facts that hang on the state, with what they come from.
    in_state: HashMap<Fact, (usize, Vec<Value>)>,
    tests: HashMap<PredicateId, usize>,
    state: State,
}

/// A name that no stream gives.
const MADE: &str = "made";

impl<'t> All<'t> {
    /// Asks every stream for all that it has. Streams must come to an end.
    pub fn of(toy: &'t Toy) -> Self {
        let values = toy.values();
        let (facts, state) = toy.first(&values);
        let is_test = |s: &&Stream| s.outputs.is_empty() && s.fluents.is_empty();
        let all = toy.streams.iter().enumerate().filter(|(_, s)| is_test(s));
        let tests = all.map(|(i, s)| (s.certified[0].predicate, i)).collect();
        let mut all = Self { toy, values, facts, in_state: HashMap::new(), tests, state: state.into_iter().collect() };
        let mut done: HashSet<(usize, Vec<Value>)> = HashSet::new();
        loop {
            let before = done.len();
            for (index, stream) in toy.streams.iter().enumerate().filter(|(_, s)| !is_test(s)) {
                for inputs in all.inputs(stream) {
                    if done.insert((index, inputs.clone())) {
                        all.exhaust(index, &inputs);
                    }
                }
            }
            if done.len() == before {
                return all;
            }
        }
    }

    fn inputs(&self, stream: &Stream) -> Vec<Vec<Value>> {
        let free = vec![None; stream.inputs.len() + stream.outputs.len()];
        let all = crate::naive::bindings(&self.toy.domain, &self.values, &stream.inputs, &free);
        let holds = |slots: &Slots| {
            stream.domain.iter().all(|a| self.is_so(&instantiate(a, slots, &self.values).unwrap(), &State::new()))
        };
        all.into_iter().filter(holds).map(|slots| slots.into_iter().flatten().collect()).collect()
    }

    fn exhaust(&mut self, index: usize, inputs: &[Value]) {
        let stream = &self.toy.streams[index];
        let names: Vec<String> = inputs.iter().map(|v| self.values.name(*v).to_owned()).collect();
        let names: Vec<&str> = names.iter().map(String::as_str).collect();
        for call in 0.. {
            let outputs = match stream.fluents.is_empty() {
                true => (self.toy.rules.gives)(&stream.name, &names, call),
                false => (call == 0)
                    .then(|| vec![format!("{MADE}-{}-{}", stream.name, names.join("-")); stream.outputs.len()]),
            };
            let Some(outputs) = outputs else { break };
            let outputs = outputs.iter().zip(&stream.outputs).map(|(name, o)| self.values.add(name, o.of));
            let slots: Slots = inputs.iter().copied().chain(outputs).map(Some).collect();
            for atom in &stream.certified {
                let fact = instantiate(atom, &slots, &self.values).unwrap();
                if stream.fluents.is_empty() {
                    self.facts.insert(fact);
                } else {
                    self.in_state.insert(fact, (index, inputs.to_vec()));
                }
            }
        }
    }

    fn names(&self, values: &[Value]) -> Vec<&str> {
        values.iter().map(|v| self.values.name(*v)).collect()
    }

    fn is_so(&self, fact: &Fact, state: &State) -> bool {
        if let Some(test) = self.tests.get(&fact.predicate) {
            // Tests certify of their inputs, in order.
            return (self.toy.rules.passes)(&self.toy.streams[*test].name, &self.names(&fact.values));
        }
        if let Some((stream, inputs)) = self.in_state.get(fact) {
            let stream = &self.toy.streams[*stream];
            let told = |f: &Fact| {
                format!("{} {}", self.toy.domain.predicates[f.predicate.0].name, self.names(&f.values).join(" "))
                    .trim()
                    .to_owned()
            };
            let now: Vec<String> = state.iter().filter(|f| stream.fluents.contains(&f.predicate)).map(told).collect();
            return (self.toy.rules.succeeds)(&stream.name, &self.names(inputs), &now);
        }
        self.facts.contains(fact)
    }

    fn naively<T>(&self, asked: impl FnOnce(&Naive) -> T) -> T {
        let known = |fact: &Fact, state: &State| self.is_so(fact, state);
        asked(&Naive { domain: &self.toy.domain, values: &self.values, known: &known })
    }

    /// Whether some plan reaches the goal.
    pub fn solvable(&self) -> bool {
        const MOST: usize = 20_000;
        self.naively(|naive| {
            let states = naive.reachable(&self.state, MOST);
            assert!(states.len() < MOST);
            states.iter().any(|state| naive.meets(&self.toy.goal, state))
        })
    }

    /// Whether a plan, told in names, does.
    pub fn does(&self, plan: &[(usize, Vec<String>)]) -> bool {
        let value = |name: &String| self.values.named(name);
        let steps: Option<Vec<Step>> = plan
            .iter()
            .map(|(action, names)| Some((*action, names.iter().map(value).collect::<Option<_>>()?)))
            .collect();
        steps.is_some_and(|steps| self.naively(|naive| naive.does(&steps, &self.state, &self.toy.goal)))
    }
}
