//! Procedures that look up what they give, and watch how they are asked.

pub mod all;

use clearway_plan::{Budget, Stop};
use clearway_symbolic::engine::Ferroplan;
use clearway_symbolic::facts::{Fact, Facts, Slots, Value, Values, instantiate};
use clearway_symbolic::pddl::{Constant, Domain, Goal, Provided, Stream};
use clearway_symbolic::search::{Algorithm, Counts, NoPlan, Patience, Search};
use clearway_symbolic::store::{Procedures, Store};
use std::collections::HashMap;
use std::path::Path;

/// What streams give, by their names and the names of their inputs.
pub struct Rules {
    /// The outputs of a call, counted from 0.
    pub gives: Box<dyn Fn(&str, &[&str], usize) -> Option<Vec<String>>>,
    pub passes: Box<dyn Fn(&str, &[&str]) -> bool>,
    /// With the facts of the stream's fluents that hold, told as `At 3`.
    pub succeeds: Box<dyn Fn(&str, &[&str], &[String]) -> bool>,
    /// Whether a plan can be left at that.
    pub ends: bool,
}

impl Rules {
    /// Streams that give nothing, tests that accept all.
    pub fn new() -> Self {
        Self {
            gives: Box::new(|_, _, _| None),
            passes: Box::new(|_, _| true),
            succeeds: Box::new(|_, _, _| true),
            ends: true,
        }
    }
}

/// A domain with streams, and a problem.
pub struct Toy {
    pub domain: Domain,
    pub streams: Vec<Stream>,
    pub goal: Goal,
    pub objects: Vec<Constant>,
    /// What holds at first, as PDDL: `(At zero)`, one after the other.
    pub init: String,
    pub rules: Rules,
}

impl Toy {
    /// Objects are `name type` pairs; procedures are provided as they are declared.
    pub fn new(
        domain: &str,
        streams: &str,
        provided: &[Provided],
        objects: &[(&str, &str)],
        init: &str,
        goal: &str,
        rules: Rules,
    ) -> Self {
        let domain = Domain::read(Path::new("domain"), domain).unwrap();
        let streams = Stream::read_all(Path::new("streams"), streams, &domain, provided).unwrap();
        let constant =
            |(name, of): &(&str, &str)| Constant { name: (*name).to_owned(), of: domain.types.named(of).unwrap() };
        let objects: Vec<Constant> = objects.iter().map(constant).collect();
        let goal = Goal::read(Path::new("goal"), goal, &domain, &objects).unwrap();
        Self { domain, streams, goal, objects, init: init.to_owned(), rules }
    }

    pub fn values(&self) -> Values {
        let mut values = Values::default();
        self.domain.constants.iter().chain(&self.objects).for_each(|c| {
            values.add(&c.name, c.of);
        });
        values
    }

    /// What holds at first: what no action changes, and what actions change.
    pub fn first(&self, values: &Values) -> (Facts, Vec<Fact>) {
        let changed = crate::naive::fluents(&self.domain);
        let (mut facts, mut state) = (Facts::default(), Vec::new());
        for atom in self.init.split(['(', ')']).filter(|a| !a.trim().is_empty()) {
            let mut words = atom.split_whitespace();
            let predicate = self.domain.predicate(words.next().unwrap()).unwrap();
            let fact = Fact { predicate, values: words.map(|w| values.named(w).unwrap()).collect() };
            if changed.contains(&predicate) {
                state.push(fact);
            } else {
                facts.insert(fact);
            }
        }
        (facts, state)
    }

    pub fn run(&self, algorithm: Algorithm) -> Run {
        self.run_within(algorithm, &Budget::unlimited(), None)
    }

    pub fn run_within(&self, algorithm: Algorithm, budget: &Budget, patience: Option<Patience>) -> Run {
        let values = self.values();
        let (facts, state) = self.first(&values);
        let mut watched =
            Watched { toy: self, names: HashMap::new(), facts: facts.clone(), asked: HashMap::new(), log: Vec::new() };
        watched.learn(&values);
        let mut store = Store::new(&self.domain, &self.streams, values, facts, &mut watched);
        let engine = Ferroplan::default();
        let mut search = Search::new(&mut store, &engine, &state, &self.goal, budget);
        search.patience = patience;
        let found = search.run(algorithm);
        let counts = search.counts;
        let told = |(action, values): &(usize, Vec<Value>)| {
            let values: Vec<&str> = values.iter().map(|v| store.values.name(*v)).collect();
            (*action, values.into_iter().map(str::to_owned).collect())
        };
        let plan = found.map(|solution| solution.actions.iter().map(told).collect());
        Run { plan, counts, log: watched.log }
    }
}

/// How a search ended.
#[derive(Debug, PartialEq)]
pub struct Run {
    /// Which action, and the names of its arguments.
    pub plan: Result<Vec<(usize, Vec<String>)>, NoPlan>,
    pub counts: Counts,
    /// What the procedures were asked: `stream input …`.
    pub log: Vec<String>,
}

impl Run {
    /// The plan as `action argument …`, a line for each.
    pub fn told(&self, domain: &Domain) -> Vec<String> {
        let told =
            |(action, values): &(usize, Vec<String>)| format!("{} {}", domain.actions[*action].name, values.join(" "));
        self.plan.as_ref().unwrap().iter().map(told).collect()
    }
}

/// Looks up what is asked for, and insists on being asked about real things for which the stream's domain holds.
struct Watched<'t> {
    toy: &'t Toy,
    names: HashMap<Value, String>,
    facts: Facts,
    asked: HashMap<(String, Vec<Value>), usize>,
    log: Vec<String>,
}

impl Watched<'_> {
    fn learn(&mut self, values: &Values) {
        for constant in self.toy.domain.constants.iter().chain(&self.toy.objects) {
            self.names.insert(values.named(&constant.name).unwrap(), constant.name.clone());
        }
    }

    fn called(&self, stream: &Stream, inputs: &[Value]) -> Vec<&str> {
        let name = |v: &Value| {
            self.names.get(v).unwrap_or_else(|| panic!("{} asked about what is not real", stream.name)).as_str()
        };
        inputs.iter().map(name).collect()
    }

    fn asked(&mut self, stream: &Stream, inputs: &[Value], values: Option<&Values>) -> Vec<String> {
        assert_eq!(inputs.len(), stream.inputs.len());
        let called: Vec<String> = self.called(stream, inputs).into_iter().map(str::to_owned).collect();
        if let Some(values) = values {
            let mut slots: Slots = inputs.iter().map(|v| Some(*v)).collect();
            slots.resize(inputs.len() + stream.outputs.len(), None);
            for needed in stream.domain.iter().map(|a| instantiate(a, &slots, values).unwrap()) {
                let holds = self.facts.contains(&needed) || self.is_tested(&needed);
                assert!(holds, "{} asked about {called:?}, for which its domain does not hold", stream.name);
            }
        }
        self.log.push(format!("{} {}", stream.name, called.join(" ")));
        called
    }

    /// Whether a test certifies a fact; none of the tests here needs what others test.
    fn is_tested(&self, fact: &Fact) -> bool {
        let tests = self.toy.streams.iter().filter(|s| s.outputs.is_empty() && s.fluents.is_empty());
        let mut deciding = tests.filter(|s| s.certified[0].predicate == fact.predicate);
        deciding.any(|s| (self.toy.rules.passes)(&s.name, &self.called(s, &fact.values)))
    }
}

impl Procedures for Watched<'_> {
    fn next(&mut self, stream: &Stream, inputs: &[Value], values: &mut Values) -> Result<Option<Vec<Value>>, Stop> {
        assert!(stream.fluents.is_empty());
        let called = self.asked(stream, inputs, Some(values));
        let asked = self.asked.entry((stream.name.clone(), inputs.to_vec())).or_default();
        let call = *asked;
        *asked += 1;
        let called: Vec<&str> = called.iter().map(String::as_str).collect();
        let Some(names) = (self.toy.rules.gives)(&stream.name, &called, call) else { return Ok(None) };
        assert_eq!(names.len(), stream.outputs.len());
        let outputs: Vec<Value> = names.iter().zip(&stream.outputs).map(|(name, o)| values.add(name, o.of)).collect();
        self.names.extend(outputs.iter().copied().zip(names));
        let slots: Slots = inputs.iter().chain(&outputs).map(|v| Some(*v)).collect();
        for atom in &stream.certified {
            self.facts.insert(instantiate(atom, &slots, values).unwrap());
        }
        Ok(Some(outputs))
    }

    fn none(&self, _: &Stream, _: &[Value]) -> bool {
        false
    }

    fn test(&mut self, stream: &Stream, inputs: &[Value]) -> bool {
        let called = self.asked(stream, inputs, None);
        (self.toy.rules.passes)(&stream.name, &called.iter().map(String::as_str).collect::<Vec<_>>())
    }

    fn begin(&mut self) {
        self.log.push("begin".to_owned());
    }

    fn in_state(&mut self, stream: &Stream, inputs: &[Value], state: &[Fact]) -> Result<bool, Stop> {
        assert!(state.iter().all(|f| stream.fluents.contains(&f.predicate)));
        let called = self.asked(stream, inputs, None);
        let told = |fact: &Fact| {
            let values: Vec<&str> = fact.values.iter().map(|v| self.names[v].as_str()).collect();
            format!("{} {}", self.toy.domain.predicates[fact.predicate.0].name, values.join(" ")).trim().to_owned()
        };
        let state: Vec<String> = state.iter().map(told).collect();
        Ok((self.toy.rules.succeeds)(&stream.name, &called.iter().map(String::as_str).collect::<Vec<_>>(), &state))
    }

    fn end(&mut self) -> Result<bool, Stop> {
        Ok(self.toy.rules.ends)
    }
}
