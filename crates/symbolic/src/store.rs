//! Streams at work: which were asked with which inputs, what they found, what is known by it.
//!
//! Tests are asked when the grounder wants to know, and remembered. A stream with `:fluents` is taken to
//! succeed until it was asked in the state of a plan and did not.

use crate::facts::{Fact, Facts, Slots, Value, Values, instantiate};
use crate::ground::Known;
use crate::pddl::{Atom, Domain, PredicateId, Stream, Term};
use clearway_plan::Stop;
use std::collections::{HashMap, HashSet};

/// What streams do; inputs are of their domains.
pub trait Procedures {
    /// The next outputs for these inputs, as new values; `None`: there are no more.
    fn next(&mut self, stream: &Stream, inputs: &[Value], values: &mut Values) -> Result<Option<Vec<Value>>, Stop>;
    /// Whether there are no outputs for these inputs, told without looking for any.
    fn none(&self, stream: &Stream, inputs: &[Value]) -> bool;
    /// Of a stream without outputs.
    fn test(&mut self, stream: &Stream, inputs: &[Value]) -> bool;
    /// A plan is about to be carried out from the beginning.
    fn begin(&mut self);
    /// Of a stream with fluents: whether it succeeds where these facts of them hold. Asked in the order of a
    /// plan, about one step after the other.
    fn in_state(&mut self, stream: &Stream, inputs: &[Value], state: &[Fact]) -> Result<bool, Stop>;
    /// The plan is carried out; false when it cannot be left at that.
    fn end(&mut self) -> Result<bool, Stop>;
}

/// A stream with inputs that are all real.
#[derive(Clone, Debug)]
pub struct Instance {
    pub stream: usize,
    pub inputs: Vec<Value>,
    /// How often it was asked.
    pub asked: usize,
    /// It has no more to give.
    pub exhausted: bool,
    /// Not to be asked again for now.
    pub rests: bool,
}

/// Everything that streams have shown.
pub struct Store<'a> {
    pub domain: &'a Domain,
    pub streams: &'a [Stream],
    pub values: Values,
    /// Static.
    pub facts: Facts,
    pub instances: Vec<Instance>,
    index: HashMap<(usize, Vec<Value>), usize>,
    /// By predicate: the tests that decide it, with the atom that they certify.
    tests: HashMap<PredicateId, Vec<(usize, &'a Atom)>>,
    tested: HashMap<Fact, bool>,
    pub procedures: &'a mut dyn Procedures,
}

impl<'a> Store<'a> {
    pub fn new(
        domain: &'a Domain,
        streams: &'a [Stream],
        values: Values,
        facts: Facts,
        procedures: &'a mut dyn Procedures,
    ) -> Self {
        let mut tests: HashMap<PredicateId, Vec<(usize, &Atom)>> = HashMap::new();
        for (index, stream) in streams.iter().enumerate().filter(|(_, s)| s.outputs.is_empty() && s.fluents.is_empty())
        {
            for atom in &stream.certified {
                tests.entry(atom.predicate).or_default().push((index, atom));
            }
        }
        Self {
            domain,
            streams,
            values,
            facts,
            instances: Vec::new(),
            index: HashMap::new(),
            tests,
            tested: HashMap::new(),
            procedures,
        }
    }

    pub fn is_test(&self, stream: usize) -> bool {
        self.streams[stream].outputs.is_empty() && self.streams[stream].fluents.is_empty()
    }

    pub fn is_fluent(&self, stream: usize) -> bool {
        !self.streams[stream].fluents.is_empty()
    }

    /// The instance of a stream with real inputs, new or known.
    pub fn instance(&mut self, stream: usize, inputs: Vec<Value>) -> usize {
        let (index, instances) = (&mut self.index, &mut self.instances);
        let (streams, procedures) = (self.streams, &*self.procedures);
        *index.entry((stream, inputs)).or_insert_with_key(|(stream, inputs)| {
            let exhausted = procedures.none(&streams[*stream], inputs);
            instances.push(Instance { stream: *stream, inputs: inputs.clone(), asked: 0, exhausted, rests: false });
            instances.len() - 1
        })
    }

    /// All inputs for which a stream's domain holds among some facts.
    pub fn inputs_among(&mut self, stream: usize, facts: &Facts, optimistic: &HashSet<Value>) -> Vec<Vec<Value>> {
        let declared: &'a Stream = &self.streams[stream];
        let (tested, listed): (Vec<&Atom>, Vec<&Atom>) =
            declared.domain.iter().partition(|a| self.tests.contains_key(&a.predicate));
        let mut slots: Slots = vec![None; declared.inputs.len() + declared.outputs.len()];
        let mut found: Vec<Slots> = Vec::new();
        let (domain, values) = (self.domain, &self.values);
        facts.each_match(&listed, &mut slots, values, &mut |slots| {
            // Inputs that no fact of the domain names are any of their type.
            let mut open = vec![slots.clone()];
            for input in &declared.inputs {
                let types = &domain.types;
                open = open
                    .into_iter()
                    .flat_map(|slots| -> Vec<Slots> {
                        match slots[input.slot] {
                            Some(value) => {
                                if types.is(values.of(value), input.of) {
                                    vec![slots]
                                } else {
                                    Vec::new()
                                }
                            }
                            None => {
                                let all = values.all_of(types, input.of);
                                all.map(|value| {
                                    let mut slots = slots.clone();
                                    slots[input.slot] = Some(value);
                                    slots
                                })
                                .collect()
                            }
                        }
                    })
                    .collect();
            }
            found.append(&mut open);
        });
        let mut inputs = Vec::new();
        for slots in found {
            let passes = tested
                .iter()
                .all(|atom| instantiate(atom, &slots, &self.values).is_some_and(|fact| self.passes(&fact, optimistic)));
            if passes {
                inputs.push(declared.inputs.iter().filter_map(|i| slots[i.slot]).collect());
            }
        }
        inputs
    }

    /// Makes instances for all inputs that are known by now.
    pub fn instantiate(&mut self) {
        let none = HashSet::new();
        for stream in (0..self.streams.len()).filter(|s| !self.is_test(*s)).collect::<Vec<_>>() {
            let facts = std::mem::take(&mut self.facts);
            let inputs = self.inputs_among(stream, &facts, &none);
            self.facts = facts;
            for inputs in inputs {
                self.instance(stream, inputs);
            }
        }
    }

    /// The facts that a stream certifies of inputs and outputs.
    pub fn certified(&self, stream: usize, inputs: &[Value], outputs: &[Value]) -> Vec<Fact> {
        let slots: Slots = inputs.iter().chain(outputs).map(|v| Some(*v)).collect();
        self.streams[stream].certified.iter().filter_map(|atom| instantiate(atom, &slots, &self.values)).collect()
    }

    /// Facts of the domain of a stream with these inputs.
    pub fn required(&self, stream: usize, inputs: &[Value]) -> Vec<Fact> {
        let mut slots: Slots = inputs.iter().map(|v| Some(*v)).collect();
        slots.resize(inputs.len() + self.streams[stream].outputs.len(), None);
        self.streams[stream].domain.iter().filter_map(|atom| instantiate(atom, &slots, &self.values)).collect()
    }

    /// Asks an instance for its next outputs and takes in what they certify.
    pub fn ask(&mut self, instance: usize) -> Result<Option<Vec<Value>>, Stop> {
        let Instance { stream, ref inputs, .. } = self.instances[instance];
        let inputs = inputs.clone();
        let found = self.procedures.next(&self.streams[stream], &inputs, &mut self.values)?;
        let asked = &mut self.instances[instance];
        asked.asked += 1;
        asked.rests = true;
        match &found {
            Some(outputs) => {
                for fact in self.certified(stream, &inputs, outputs) {
                    self.facts.insert(fact);
                }
            }
            None => asked.exhausted = true,
        }
        Ok(found)
    }

    /// Whether a fact that tests decide holds; of values not found yet it may.
    pub fn passes(&mut self, fact: &Fact, optimistic: &HashSet<Value>) -> bool {
        if fact.values.iter().any(|v| optimistic.contains(v)) {
            return true;
        }
        if let Some(known) = self.tested.get(fact) {
            return *known;
        }
        let deciding = self.tests.get(&fact.predicate).cloned().unwrap_or_default();
        let passes =
            self.facts.contains(fact) || deciding.into_iter().any(|(stream, atom)| self.test_by(stream, atom, fact));
        self.tested.insert(fact.clone(), passes);
        passes
    }

    /// Whether a test certifies a fact.
    fn test_by(&mut self, stream: usize, atom: &Atom, fact: &Fact) -> bool {
        let declared = &self.streams[stream];
        let mut slots: Slots = vec![None; declared.inputs.len()];
        for (term, value) in atom.terms.iter().zip(&fact.values) {
            match term {
                Term::Variable(slot) if slots[*slot].is_none_or(|v| v == *value) => slots[*slot] = Some(*value),
                Term::Constant(name) if self.values.named(name) == Some(*value) => {}
                _ => return false,
            }
        }
        let Some(inputs) = slots.iter().copied().collect::<Option<Vec<Value>>>() else { return false };
        self.required(stream, &inputs).iter().all(|f| self.facts.contains(f) || self.tests.contains_key(&f.predicate))
            && self.procedures.test(&self.streams[stream], &inputs)
    }
}

/// Facts, real and hoped for, with the tests of a [`Store`].
pub struct Hoping<'s, 'a> {
    pub store: &'s mut Store<'a>,
    pub facts: Facts,
    /// Values not found yet.
    pub optimistic: HashSet<Value>,
}

impl Known for Hoping<'_, '_> {
    fn facts(&self) -> &Facts {
        &self.facts
    }

    fn is_tested(&self, predicate: PredicateId) -> bool {
        self.store.tests.contains_key(&predicate)
    }

    fn test(&mut self, fact: &Fact, _: &Values) -> bool {
        self.store.passes(fact, &self.optimistic)
    }
}
