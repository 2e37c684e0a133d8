//! What has to be moved for a goal: whether it cannot hold as long as some objects stand where they stand, whatever
//! becomes of all others.
//!
//! The goal is looked at with three values (Kleene's): what an object is on is known as long as it is not moved,
//! all else may be or not. For the built-in domain, in which only motions change what an object is on.

use crate::pddl::{Atom, Constant, Domain, Formula, Goal, PredicateId, Term, TypeId, Variable};

/// Instances of quantifiers that are looked at; with more nothing is said.
const MOST_INSTANCES: usize = 100_000;

/// A scene as goals speak of it.
pub struct Necessity<'a> {
    pub domain: &'a Domain,
    /// All that the scene names.
    pub things: Vec<Constant>,
    /// Types of what only streams find: there may be any of those.
    pub open: Vec<TypeId>,
    pub on: PredicateId,
    /// What each object is on at first.
    pub supports: Vec<(String, String)>,
}

/// What variables stand for, by slot.
type Slots<'n> = Vec<Option<&'n str>>;

impl Necessity<'_> {
    /// Whether the goal does not hold as long as none of these objects is moved.
    pub fn forbids(&self, goal: &Goal, unmoved: &[&str]) -> bool {
        let mut room = MOST_INSTANCES;
        self.holds(&goal.formula, &mut vec![None; goal.slots], unmoved, &mut room) == Some(false)
    }

    /// Nothing where it depends on more.
    fn holds<'n>(
        &'n self,
        formula: &'n Formula,
        slots: &mut Slots<'n>,
        unmoved: &[&str],
        room: &mut usize,
    ) -> Option<bool> {
        match formula {
            Formula::And(parts) => all(parts.iter().map(|part| self.holds(part, slots, unmoved, room))),
            Formula::Or(parts) => not(all(parts.iter().map(|part| not(self.holds(part, slots, unmoved, room))))),
            Formula::Not(inner) => not(self.holds(inner, slots, unmoved, room)),
            Formula::Forall(variables, body) => self.for_all(variables, body, true, slots, unmoved, room),
            Formula::Exists(variables, body) => not(self.for_all(variables, body, false, slots, unmoved, room)),
            Formula::Equal(a, b) => Some(named(a, slots)? == named(b, slots)?),
            Formula::Atom(atom) => self.atom(atom, slots, unmoved, room),
        }
    }

    fn atom<'n>(&'n self, atom: &'n Atom, slots: &Slots<'n>, unmoved: &[&str], room: &mut usize) -> Option<bool> {
        if let Some(derived) = self.domain.derived.iter().find(|d| d.predicate == atom.predicate) {
            let mut inner = vec![None; derived.slots];
            for (parameter, term) in derived.parameters.iter().zip(&atom.terms) {
                inner[parameter.slot] = named(term, slots);
            }
            return self.holds(&derived.body, &mut inner, unmoved, room);
        }
        match atom.terms.as_slice() {
            [above, below] if atom.predicate == self.on => {
                let (above, below) = (named(above, slots)?, named(below, slots)?);
                let on = || self.supports.iter().any(|(object, on)| object == above && on == below);
                unmoved.contains(&above).then(on)
            }
            _ => None,
        }
    }

    /// Whether the body, or its negation, holds for all that the variables may stand for.
    fn for_all<'n>(
        &'n self,
        variables: &'n [Variable],
        body: &'n Formula,
        plain: bool,
        slots: &mut Slots<'n>,
        unmoved: &[&str],
        room: &mut usize,
    ) -> Option<bool> {
        let Some((first, rest)) = variables.split_first() else {
            let holds = self.holds(body, slots, unmoved, room);
            return if plain { holds } else { not(holds) };
        };
        let types = &self.domain.types;
        if self.open.iter().any(|open| types.is(*open, first.of) || types.is(first.of, *open)) {
            slots[first.slot] = None;
            // There may be none of them.
            return self.for_all(rest, body, plain, slots, unmoved, room).filter(|holds| *holds);
        }
        let mut unknown = false;
        for thing in self.things.iter().chain(&self.domain.constants).filter(|thing| types.is(thing.of, first.of)) {
            *room = room.checked_sub(1)?;
            slots[first.slot] = Some(&thing.name);
            match self.for_all(rest, body, plain, slots, unmoved, room) {
                Some(false) => return Some(false),
                Some(true) => {}
                None => unknown = true,
            }
        }
        (!unknown).then_some(true)
    }
}

fn named<'n>(term: &'n Term, slots: &Slots<'n>) -> Option<&'n str> {
    match term {
        Term::Variable(slot) => slots[*slot],
        Term::Constant(name) => Some(name),
    }
}

fn not(holds: Option<bool>) -> Option<bool> {
    holds.map(|holds| !holds)
}

fn all(parts: impl Iterator<Item = Option<bool>>) -> Option<bool> {
    let mut holds = Some(true);
    for part in parts {
        match part {
            Some(false) => return Some(false),
            Some(true) => {}
            None => holds = None,
        }
    }
    holds
}
