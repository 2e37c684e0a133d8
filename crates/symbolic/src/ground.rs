//! A domain over what is known, without variables: what a symbolic engine plans with.
//!
//! Predicates that no action changes are static: they are decided here, by facts, or by tests asked only where
//! it matters, and do not reach the engine. Actions are instantiated only where their static preconditions
//! hold, and as far as what changes can come to hold at all.

use crate::facts::{Fact, Facts, Slots, Value, Values, instantiate, value_of};
use crate::pddl::{Action, Atom, Derived, Domain, Formula, Goal, PredicateId, Term, Variable};
use clearway_plan::Budget;
use std::collections::{BTreeMap, HashMap, HashSet};

/// An atom of a [`Task`], and whether it holds.
pub type Literal = (usize, bool);

/// An action of which every parameter is a value.
#[derive(Clone, Debug, PartialEq)]
pub struct GroundAction {
    /// Which of [`Domain::actions`].
    pub action: usize,
    pub values: Vec<Value>,
    pub precondition: Vec<Literal>,
    pub adds: Vec<usize>,
    pub deletes: Vec<usize>,
    /// Static facts without which it would not be.
    pub relies_on: Vec<Fact>,
}

/// A planning problem over atoms.
#[derive(Clone, Debug, Default)]
pub struct Task {
    pub atoms: Vec<Fact>,
    /// The atoms that hold at first.
    pub init: Vec<usize>,
    pub actions: Vec<GroundAction>,
    /// All of one of these.
    pub goal: Vec<Vec<Literal>>,
}

/// What static predicates hold.
pub trait Known {
    fn facts(&self) -> &Facts;
    /// Whether tests decide a predicate.
    fn is_tested(&self, predicate: PredicateId) -> bool;
    /// Whether a fact holds, of a predicate that tests decide.
    fn test(&mut self, fact: &Fact, values: &Values) -> bool;
}

/// More alternatives than anyone means to write down.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct TooManyAlternatives {
    /// The action's name, or `the goal`.
    pub of: String,
}

/// Alternatives of one precondition, and values of variables that nothing static binds.
const MOST_ALTERNATIVES: usize = 512;
const MOST_BINDINGS: usize = 100_000;

/// Disjunction of conjunctions.
type Dnf = Vec<Vec<(Fact, bool)>>;

/// An action not yet told in atoms.
struct Raw {
    action: usize,
    values: Vec<Value>,
    precondition: Vec<(Fact, bool)>,
    adds: Vec<Fact>,
    deletes: Vec<Fact>,
    relies_on: Vec<Fact>,
}

/// A domain, looked at for grounding.
pub struct Grounder<'a> {
    pub domain: &'a Domain,
    /// Those that actions change.
    fluent: HashSet<PredicateId>,
    derived: HashMap<PredicateId, &'a Derived>,
    /// When this is spent grounding ends with an error.
    budget: Budget,
}

impl<'a> Grounder<'a> {
    pub fn new(domain: &'a Domain) -> Self {
        let fluent = domain.actions.iter().flat_map(|a| a.effects.iter().map(|e| e.atom.predicate)).collect();
        let derived = domain.derived.iter().map(|d| (d.predicate, d)).collect();
        Self { domain, fluent, derived, budget: Budget::unlimited() }
    }

    #[must_use]
    pub fn within(self, budget: &Budget) -> Self {
        Self { budget: budget.clone(), ..self }
    }

    /// An error when time is up: whoever set the budget knows that it is not about alternatives.
    fn check(&self, of: &str) -> Result<(), TooManyAlternatives> {
        self.budget.check().map_err(|_| TooManyAlternatives { of: of.to_owned() })
    }

    /// Whether variables that nothing binds have more values together than anyone means to try.
    fn too_many(&self, variables: &[Variable], bound: &[&Atom], values: &Values) -> bool {
        let is_bound = |v: &&Variable| {
            bound.iter().any(|a| a.terms.iter().any(|t| matches!(t, Term::Variable(slot) if *slot == v.slot)))
        };
        let free = variables.iter().filter(|v| !is_bound(v));
        let counts = free.map(|v| values.all_of(&self.domain.types, v.of).count());
        counts.fold(1usize, usize::saturating_mul) > MOST_BINDINGS
    }

    pub fn is_fluent(&self, predicate: PredicateId) -> bool {
        self.fluent.contains(&predicate)
    }

    /// The task in which `state` holds at first.
    pub fn task(
        &self,
        values: &Values,
        state: &[Fact],
        known: &mut dyn Known,
        goal: &Goal,
    ) -> Result<Task, TooManyAlternatives> {
        let mut pool = known.facts().clone();
        state.iter().for_each(|fact| {
            pool.insert(fact.clone());
        });
        let mut raw: Vec<Raw> = Vec::new();
        let mut seen: HashSet<(usize, Vec<Value>)> = HashSet::new();
        loop {
            let before = pool.len();
            for (index, action) in self.domain.actions.iter().enumerate() {
                let mut bindings = Vec::new();
                self.bindings(action, values, &pool, known, &mut bindings)?;
                for slots in bindings {
                    self.check(&action.name)?;
                    let parameters: Vec<Value> = action.parameters.iter().filter_map(|p| slots[p.slot]).collect();
                    if !seen.insert((index, parameters.clone())) {
                        continue;
                    }
                    let mut asking = Asking { grounder: self, values, pool: &pool, known: &mut *known };
                    raw.extend(asking.instances(index, action, slots, &parameters)?);
                }
            }
            for action in &raw {
                action.adds.iter().for_each(|fact| {
                    pool.insert(fact.clone());
                });
            }
            if pool.len() == before {
                break;
            }
        }
        let slots = vec![None; goal.slots];
        let mut asking = Asking { grounder: self, values, pool: &pool, known };
        let goal = asking
            .holds(&goal.formula, &slots, true)
            .ok_or_else(|| TooManyAlternatives { of: "the goal".to_owned() })?;
        Ok(self.in_atoms(&pool, state, raw, goal))
    }

    /// Whether some actions, one after the other, can be done from `state` on and reach the goal.
    pub fn does(
        &self,
        actions: &[(usize, Vec<Value>)],
        values: &Values,
        state: &[Fact],
        known: &mut dyn Known,
        goal: &Goal,
    ) -> Result<bool, TooManyAlternatives> {
        let pool = known.facts().clone();
        let mut asking = Asking { grounder: self, values, pool: &pool, known };
        let mut state: HashSet<Fact> = state.iter().cloned().collect();
        let met = |state: &HashSet<Fact>, literals: &[(Fact, bool)]| {
            literals.iter().all(|(fact, holds)| state.contains(fact) == *holds)
        };
        for (index, parameters) in actions {
            let action = &self.domain.actions[*index];
            let mut slots: Slots = vec![None; action.slots];
            action.parameters.iter().zip(parameters).for_each(|(p, value)| slots[p.slot] = Some(*value));
            let instances = asking.instances(*index, action, slots, parameters)?;
            let Some(instance) = instances.into_iter().find(|i| met(&state, &i.precondition)) else { return Ok(false) };
            instance.deletes.iter().for_each(|fact| {
                state.remove(fact);
            });
            state.extend(instance.adds);
        }
        let slots = vec![None; goal.slots];
        let goal = asking
            .holds(&goal.formula, &slots, true)
            .ok_or_else(|| TooManyAlternatives { of: "the goal".to_owned() })?;
        Ok(goal.iter().any(|literals| met(&state, literals)))
    }

    /// The bindings of an action's parameters for which the atoms that it needs could hold.
    fn bindings(
        &self,
        action: &Action,
        values: &Values,
        pool: &Facts,
        known: &dyn Known,
        found: &mut Vec<Slots>,
    ) -> Result<(), TooManyAlternatives> {
        let mut atoms = Vec::new();
        needed_atoms(&action.precondition, &mut atoms);
        let listed = |atom: &&Atom| !self.derived.contains_key(&atom.predicate) && !known.is_tested(atom.predicate);
        let atoms: Vec<&Atom> = atoms.into_iter().filter(listed).collect();
        if self.too_many(&action.parameters, &atoms, values) {
            return Err(TooManyAlternatives { of: action.name.clone() });
        }
        let mut slots: Slots = vec![None; action.slots];
        pool.each_match(&atoms, &mut slots, values, &mut |slots| {
            self.each_typed(&action.parameters, slots, values, &mut |slots| found.push(slots.clone()));
        });
        Ok(())
    }

    /// Calls `each` with every value of the right type for those of some variables that are free; bound ones
    /// must be of their types.
    fn each_typed(&self, variables: &[Variable], slots: &mut Slots, values: &Values, each: &mut dyn FnMut(&mut Slots)) {
        let Some((first, rest)) = variables.split_first() else { return each(slots) };
        let types = &self.domain.types;
        match slots[first.slot] {
            Some(value) => {
                if types.is(values.of(value), first.of) {
                    self.each_typed(rest, slots, values, each);
                }
            }
            None => {
                for value in values.all_of(types, first.of) {
                    slots[first.slot] = Some(value);
                    self.each_typed(rest, slots, values, each);
                }
                slots[first.slot] = None;
            }
        }
    }

    /// Numbers the atoms that can come to hold; others are false for ever.
    fn in_atoms(&self, pool: &Facts, state: &[Fact], raw: Vec<Raw>, goal: Dnf) -> Task {
        let atoms: Vec<Fact> = pool.iter().filter(|f| self.is_fluent(f.predicate)).cloned().collect();
        let number: HashMap<&Fact, usize> = atoms.iter().enumerate().map(|(i, f)| (f, i)).collect();
        let literals = |facts: Vec<(Fact, bool)>| -> Option<Vec<Literal>> {
            let mut all: BTreeMap<usize, bool> = BTreeMap::new();
            for (fact, holds) in facts {
                match number.get(&fact) {
                    Some(&atom) => {
                        if *all.entry(atom).or_insert(holds) != holds {
                            return None;
                        }
                    }
                    None if holds => return None,
                    None => {}
                }
            }
            Some(all.into_iter().collect())
        };
        let numbers = |facts: Vec<Fact>| -> Vec<usize> {
            let mut numbers: Vec<usize> = facts.iter().filter_map(|f| number.get(f).copied()).collect();
            numbers.sort_unstable();
            numbers.dedup();
            numbers
        };
        let actions = raw.into_iter().filter_map(|raw| {
            let precondition = literals(raw.precondition)?;
            let adds = numbers(raw.adds);
            // What is added is not deleted.
            let deletes = numbers(raw.deletes).into_iter().filter(|d| !adds.contains(d)).collect();
            Some(GroundAction {
                action: raw.action,
                values: raw.values,
                precondition,
                adds,
                deletes,
                relies_on: raw.relies_on,
            })
        });
        let actions = actions.collect();
        let init = state.iter().filter_map(|f| number.get(f).copied()).collect();
        let goal = goal.into_iter().filter_map(literals).collect();
        Task { atoms: atoms.clone(), init, actions, goal }
    }
}

impl Task {
    /// The atoms that hold after an action.
    pub fn after(&self, state: &HashSet<usize>, action: &GroundAction) -> HashSet<usize> {
        let mut after = state.clone();
        action.deletes.iter().for_each(|d| {
            after.remove(d);
        });
        after.extend(&action.adds);
        after
    }

    pub fn holds(&self, state: &HashSet<usize>, literals: &[Literal]) -> bool {
        literals.iter().all(|(atom, holds)| state.contains(atom) == *holds)
    }
}

/// The atoms that a formula needs whatever else, as far as it says so plainly.
fn needed_atoms<'f>(formula: &'f Formula, atoms: &mut Vec<&'f Atom>) {
    match formula {
        Formula::Atom(atom) => atoms.push(atom),
        Formula::And(parts) => parts.iter().for_each(|p| needed_atoms(p, atoms)),
        _ => {}
    }
}

/// Formulas, asked about bindings.
struct Asking<'a, 'k> {
    grounder: &'a Grounder<'a>,
    values: &'a Values,
    pool: &'a Facts,
    known: &'k mut dyn Known,
}

impl Asking<'_, '_> {
    /// The instances of an action with all its parameters bound: one for each way in which it can be had.
    fn instances(
        &mut self,
        index: usize,
        action: &Action,
        mut slots: Slots,
        parameters: &[Value],
    ) -> Result<Vec<Raw>, TooManyAlternatives> {
        let too_many = || TooManyAlternatives { of: action.name.clone() };
        let alternatives = self.holds(&action.precondition, &slots, true).ok_or_else(too_many)?;
        if alternatives.is_empty() {
            return Ok(Vec::new());
        }
        let mut relies_on = Vec::new();
        let mut needed = Vec::new();
        needed_atoms(&action.precondition, &mut needed);
        for atom in needed.into_iter().filter(|a| !self.grounder.is_fluent(a.predicate)) {
            relies_on.extend(instantiate(atom, &slots, self.values));
        }
        // Under a condition or not: each condition that hangs on the state doubles the instances.
        let mut instances: Vec<(Vec<(Fact, bool)>, Vec<Fact>, Vec<Fact>)> =
            alternatives.into_iter().map(|precondition| (precondition, Vec::new(), Vec::new())).collect();
        for effect in &action.effects {
            let mut bound = Vec::new();
            let grounder = self.grounder;
            grounder.each_typed(&effect.variables, &mut slots, self.values, &mut |slots| bound.push(slots.clone()));
            for slots in bound {
                let Some(fact) = instantiate(&effect.atom, &slots, self.values) else { continue };
                let when = self.holds(&effect.condition, &slots, true).ok_or_else(too_many)?;
                if when.is_empty() {
                    continue;
                }
                let otherwise = match when.iter().any(Vec::is_empty) {
                    true => Vec::new(),
                    false => self.holds(&effect.condition, &slots, false).ok_or_else(too_many)?,
                };
                let mut next = Vec::new();
                for (precondition, adds, deletes) in &instances {
                    for more in &when {
                        let (mut adds, mut deletes) = (adds.clone(), deletes.clone());
                        if effect.adds {
                            adds.push(fact.clone())
                        } else {
                            deletes.push(fact.clone())
                        }
                        next.push((and(precondition, more), adds, deletes));
                    }
                    next.extend(otherwise.iter().map(|more| (and(precondition, more), adds.clone(), deletes.clone())));
                }
                if next.len() > MOST_ALTERNATIVES {
                    return Err(too_many());
                }
                instances = next;
            }
        }
        let raw = instances.into_iter().map(|(precondition, adds, deletes)| Raw {
            action: index,
            values: parameters.to_vec(),
            precondition,
            adds,
            deletes,
            relies_on: relies_on.clone(),
        });
        Ok(raw.collect())
    }

    /// When a formula, or its negation, holds; `None`: in too many ways.
    fn holds(&mut self, formula: &Formula, slots: &Slots, wanted: bool) -> Option<Dnf> {
        match (formula, wanted) {
            (Formula::Not(inner), _) => self.holds(inner, slots, !wanted),
            (Formula::And(parts), true) | (Formula::Or(parts), false) => {
                self.all(&mut parts.iter().map(|p| (p, slots.clone())), wanted)
            }
            (Formula::And(parts), false) | (Formula::Or(parts), true) => {
                self.any(&mut parts.iter().map(|p| (p, slots.clone())), wanted)
            }
            (Formula::Forall(variables, body), true) | (Formula::Exists(variables, body), false) => {
                let bindings = self.quantified(variables, body, slots, wanted)?;
                self.all(&mut bindings.into_iter().map(|slots| (&**body, slots)), wanted)
            }
            (Formula::Forall(variables, body), false) | (Formula::Exists(variables, body), true) => {
                let bindings = self.quantified(variables, body, slots, !wanted)?;
                self.any(&mut bindings.into_iter().map(|slots| (&**body, slots)), wanted)
            }
            (Formula::Equal(a, b), _) => {
                let equal = value_of(a, slots, self.values) == value_of(b, slots, self.values);
                Some(constant(equal == wanted))
            }
            (Formula::Atom(atom), _) => self.atom(atom, slots, wanted),
        }
    }

    fn atom(&mut self, atom: &Atom, slots: &Slots, wanted: bool) -> Option<Dnf> {
        if let Some(derived) = self.grounder.derived.get(&atom.predicate).copied() {
            let mut inner: Slots = vec![None; derived.slots];
            for (parameter, term) in derived.parameters.iter().zip(&atom.terms) {
                inner[parameter.slot] = value_of(term, slots, self.values);
            }
            return self.holds(&derived.body, &inner, wanted);
        }
        // A name that no value has can be in no fact.
        let Some(fact) = instantiate(atom, slots, self.values) else { return Some(constant(!wanted)) };
        if self.grounder.is_fluent(fact.predicate) {
            return Some(vec![vec![(fact, wanted)]]);
        }
        let holds = match self.known.is_tested(fact.predicate) {
            true => self.known.test(&fact, self.values),
            false => self.pool.contains(&fact),
        };
        Some(constant(holds == wanted))
    }

    /// The bindings of quantified variables that matter: where the body says "if this static fact holds" only
    /// those for which it does. `universal`: the body is asked for all of them.
    fn quantified(&self, variables: &[Variable], body: &Formula, slots: &Slots, universal: bool) -> Option<Vec<Slots>> {
        let mut guards = Vec::new();
        if universal {
            antecedents(body, &mut guards)
        } else {
            needed_atoms(body, &mut guards)
        }
        let grounder = self.grounder;
        let listed = |a: &&Atom| {
            !grounder.is_fluent(a.predicate)
                && !grounder.derived.contains_key(&a.predicate)
                && !self.known.is_tested(a.predicate)
        };
        let guards: Vec<&Atom> = guards.into_iter().filter(listed).collect();
        if grounder.too_many(variables, &guards, self.values) {
            return None;
        }
        let mut slots = slots.clone();
        variables.iter().for_each(|v| slots[v.slot] = None);
        let mut found = Vec::new();
        self.pool.each_match(&guards, &mut slots, self.values, &mut |slots| {
            self.grounder.each_typed(variables, slots, self.values, &mut |slots| found.push(slots.clone()));
        });
        Some(found)
    }

    fn all<'f>(&mut self, parts: &mut dyn Iterator<Item = (&'f Formula, Slots)>, wanted: bool) -> Option<Dnf> {
        let mut product: Dnf = constant(true);
        for (part, slots) in parts {
            let next = self.holds(part, &slots, wanted)?;
            if next.is_empty() {
                return Some(next);
            }
            if next.iter().any(Vec::is_empty) {
                continue;
            }
            if product.len() * next.len() > MOST_ALTERNATIVES {
                return None;
            }
            product = product.iter().flat_map(|a| next.iter().map(|b| and(a, b))).collect();
        }
        Some(product)
    }

    fn any<'f>(&mut self, parts: &mut dyn Iterator<Item = (&'f Formula, Slots)>, wanted: bool) -> Option<Dnf> {
        let mut sum: Dnf = Vec::new();
        for (part, slots) in parts {
            let next = self.holds(part, &slots, wanted)?;
            if next.iter().any(Vec::is_empty) {
                return Some(constant(true));
            }
            sum.extend(next);
            if sum.len() > MOST_ALTERNATIVES {
                return None;
            }
        }
        Some(sum)
    }
}

/// Atoms of which one that does not hold makes a formula true: `a` of `(imply a …)`.
fn antecedents<'f>(formula: &'f Formula, atoms: &mut Vec<&'f Atom>) {
    let Formula::Or(parts) = formula else { return };
    for part in parts {
        if let Formula::Not(inner) = part {
            needed_atoms(inner, atoms);
        }
    }
}

fn constant(holds: bool) -> Dnf {
    if holds { vec![Vec::new()] } else { Vec::new() }
}

fn and(a: &[(Fact, bool)], b: &[(Fact, bool)]) -> Vec<(Fact, bool)> {
    let mut both = a.to_vec();
    both.extend(b.iter().filter(|l| !a.contains(l)).cloned());
    both
}
