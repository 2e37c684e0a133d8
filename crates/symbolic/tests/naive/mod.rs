//! What a domain means, by definition: every binding is tried, every formula evaluated on a set of facts.

use clearway_symbolic::facts::{Fact, Slots, Value, Values};
use clearway_symbolic::pddl::{Atom, Domain, Formula, Goal, PredicateId, Term, Variable};
use std::collections::{BTreeSet, HashSet};

/// The facts that hold, of predicates that actions change.
pub type State = BTreeSet<Fact>;

/// An action with values for its parameters.
pub type Step = (usize, Vec<Value>);

pub struct Naive<'a> {
    pub domain: &'a Domain,
    pub values: &'a Values,
    /// Whether a fact holds that no action changes; of some it hangs on the state all the same.
    pub known: &'a dyn Fn(&Fact, &State) -> bool,
}

/// What actions change.
pub fn fluents(domain: &Domain) -> HashSet<PredicateId> {
    domain.actions.iter().flat_map(|a| a.effects.iter().map(|e| e.atom.predicate)).collect()
}

/// Every way to give some free variables values of their types.
pub fn bindings(domain: &Domain, values: &Values, variables: &[Variable], slots: &Slots) -> Vec<Slots> {
    let mut all = vec![slots.clone()];
    for variable in variables {
        let with = |slots: Slots| {
            let of_type = values.all_of(&domain.types, variable.of);
            of_type.map(move |value| {
                let mut slots = slots.clone();
                slots[variable.slot] = Some(value);
                slots
            })
        };
        all = all.into_iter().flat_map(with).collect();
    }
    all
}

impl Naive<'_> {
    fn value(&self, term: &Term, slots: &Slots) -> Value {
        match term {
            Term::Variable(slot) => slots[*slot].unwrap(),
            Term::Constant(name) => self.values.named(name).unwrap(),
        }
    }

    fn fact(&self, atom: &Atom, slots: &Slots) -> Fact {
        Fact { predicate: atom.predicate, values: atom.terms.iter().map(|t| self.value(t, slots)).collect() }
    }

    pub fn holds(&self, formula: &Formula, slots: &Slots, state: &State) -> bool {
        let bound = |variables: &[Variable]| bindings(self.domain, self.values, variables, slots);
        match formula {
            Formula::And(parts) => parts.iter().all(|p| self.holds(p, slots, state)),
            Formula::Or(parts) => parts.iter().any(|p| self.holds(p, slots, state)),
            Formula::Not(inner) => !self.holds(inner, slots, state),
            Formula::Forall(variables, body) => bound(variables).iter().all(|slots| self.holds(body, slots, state)),
            Formula::Exists(variables, body) => bound(variables).iter().any(|slots| self.holds(body, slots, state)),
            Formula::Equal(a, b) => self.value(a, slots) == self.value(b, slots),
            Formula::Atom(atom) => self.is_so(&self.fact(atom, slots), state),
        }
    }

    fn is_so(&self, fact: &Fact, state: &State) -> bool {
        if let Some(derived) = self.domain.derived.iter().find(|d| d.predicate == fact.predicate) {
            let mut slots = vec![None; derived.slots];
            derived.parameters.iter().zip(&fact.values).for_each(|(p, value)| slots[p.slot] = Some(*value));
            return self.holds(&derived.body, &slots, state);
        }
        state.contains(fact) || (self.known)(fact, state)
    }

    /// The state after an action; `None`: it cannot be done.
    pub fn after(&self, (action, values): &Step, state: &State) -> Option<State> {
        let action = &self.domain.actions[*action];
        let mut slots = vec![None; action.slots];
        action.parameters.iter().zip(values).for_each(|(p, value)| slots[p.slot] = Some(*value));
        if !self.holds(&action.precondition, &slots, state) {
            return None;
        }
        let (mut adds, mut deletes) = (State::new(), State::new());
        for effect in &action.effects {
            for slots in bindings(self.domain, self.values, &effect.variables, &slots) {
                if self.holds(&effect.condition, &slots, state) {
                    let changed = if effect.adds { &mut adds } else { &mut deletes };
                    changed.insert(self.fact(&effect.atom, &slots));
                }
            }
        }
        Some(state.difference(&deletes).chain(&adds).cloned().collect())
    }

    /// Every action with every value of the right type for its parameters.
    pub fn all_steps(&self) -> Vec<Step> {
        let mut all = Vec::new();
        for (index, action) in self.domain.actions.iter().enumerate() {
            for slots in bindings(self.domain, self.values, &action.parameters, &vec![None; action.slots]) {
                all.push((index, action.parameters.iter().filter_map(|p| slots[p.slot]).collect()));
            }
        }
        all
    }

    pub fn meets(&self, goal: &Goal, state: &State) -> bool {
        self.holds(&goal.formula, &vec![None; goal.slots], state)
    }

    /// Whether actions, one after the other, can be done and lead to the goal.
    pub fn does(&self, steps: &[Step], from: &State, goal: &Goal) -> bool {
        let end = steps.iter().try_fold(from.clone(), |state, step| self.after(step, &state));
        end.is_some_and(|end| self.meets(goal, &end))
    }

    /// The states that can be reached, those nearest first, so many at most.
    pub fn reachable(&self, from: &State, most: usize) -> Vec<State> {
        let steps = self.all_steps();
        let mut seen: HashSet<State> = HashSet::from([from.clone()]);
        let mut reached = vec![from.clone()];
        let mut next = 0;
        while next < reached.len() {
            for step in &steps {
                let after = self.after(step, &reached[next]).filter(|a| reached.len() < most && !seen.contains(a));
                if let Some(after) = after {
                    seen.insert(after.clone());
                    reached.push(after);
                }
            }
            next += 1;
        }
        reached
    }
}
