//! What is certain of a goal where only of some objects it is known what they are on: whether it cannot hold as long as
//! some stand where they stand, whatever becomes of all others.
//!
//! The goal is looked at with three values (Kleene's). For the built-in domain, in which only motions change what an
//! object is on.

use crate::pddl::{Atom, Constant, Domain, Formula, Goal, PredicateId, Term, TypeId, Variable};
use std::collections::HashMap;

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
    pub in_place: Option<PredicateId>,
    /// Which holds at the end of every plan.
    pub hand_empty: Option<PredicateId>,
    /// What each object is on at first.
    pub supports: Vec<(String, String)>,
}

/// Where an object is known to be.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Stands<'k> {
    /// Where it stood at first.
    AtFirst,
    /// On these, and not where it stood at first.
    On(Vec<&'k str>),
}

/// By object.
pub type Known<'k> = HashMap<&'k str, Stands<'k>>;

/// What variables stand for, by slot.
type Slots<'n> = Vec<Option<&'n str>>;

impl Necessity<'_> {
    /// Whether the goal does not hold as long as none of these objects is moved.
    pub fn forbids(&self, goal: &Goal, unmoved: &[&str]) -> bool {
        self.value(goal, &unmoved.iter().map(|object| (*object, Stands::AtFirst)).collect()) == Some(false)
    }

    /// Whether the goal holds; nothing where that is not certain.
    pub fn value(&self, goal: &Goal, known: &Known) -> Option<bool> {
        let mut room = MOST_INSTANCES;
        self.holds(&goal.formula, &mut vec![None; goal.slots], known, &mut room)
    }

    /// Nothing where it depends on more.
    fn holds<'n>(
        &'n self,
        formula: &'n Formula,
        slots: &mut Slots<'n>,
        known: &Known,
        room: &mut usize,
    ) -> Option<bool> {
        match formula {
            Formula::And(parts) => all(parts.iter().map(|part| self.holds(part, slots, known, room))),
            Formula::Or(parts) => not(all(parts.iter().map(|part| not(self.holds(part, slots, known, room))))),
            Formula::Not(inner) => not(self.holds(inner, slots, known, room)),
            Formula::Forall(variables, body) => self.for_all(variables, body, true, slots, known, room),
            Formula::Exists(variables, body) => not(self.for_all(variables, body, false, slots, known, room)),
            Formula::Equal(a, b) => Some(named(a, slots)? == named(b, slots)?),
            Formula::Atom(atom) => self.atom(atom, slots, known, room),
        }
    }

    fn atom<'n>(&'n self, atom: &'n Atom, slots: &Slots<'n>, known: &Known, room: &mut usize) -> Option<bool> {
        if self.hand_empty == Some(atom.predicate) {
            return Some(true);
        }
        let terms: Vec<Option<&str>> = atom.terms.iter().map(|term| named(term, slots)).collect();
        if let (true, [Some(object)]) = (self.in_place == Some(atom.predicate), terms.as_slice()) {
            return known.get(object).map(|stands| *stands == Stands::AtFirst);
        }
        if let Some(derived) = self.domain.derived.iter().find(|d| d.predicate == atom.predicate) {
            let mut inner = vec![None; derived.slots];
            for (parameter, term) in derived.parameters.iter().zip(terms) {
                inner[parameter.slot] = term;
            }
            return self.holds(&derived.body, &mut inner, known, room);
        }
        let (true, [Some(above), Some(below)]) = (atom.predicate == self.on, terms.as_slice()) else { return None };
        known.get(above).map(|stands| match stands {
            Stands::AtFirst => self.supports.iter().any(|(object, on)| object == above && on == below),
            Stands::On(supports) => supports.contains(below),
        })
    }

    /// Whether the body, or its negation, holds for all that the variables may stand for.
    fn for_all<'n>(
        &'n self,
        variables: &'n [Variable],
        body: &'n Formula,
        plain: bool,
        slots: &mut Slots<'n>,
        known: &Known,
        room: &mut usize,
    ) -> Option<bool> {
        let Some((first, rest)) = variables.split_first() else {
            let holds = self.holds(body, slots, known, room);
            return if plain { holds } else { not(holds) };
        };
        let types = &self.domain.types;
        if self.open.iter().any(|open| types.is(*open, first.of) || types.is(first.of, *open)) {
            slots[first.slot] = None;
            // There may be none of them.
            return self.for_all(rest, body, plain, slots, known, room).filter(|holds| *holds);
        }
        let mut unknown = false;
        for thing in self.things.iter().chain(&self.domain.constants).filter(|thing| types.is(thing.of, first.of)) {
            *room = room.checked_sub(1)?;
            slots[first.slot] = Some(&thing.name);
            match self.for_all(rest, body, plain, slots, known, room) {
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
