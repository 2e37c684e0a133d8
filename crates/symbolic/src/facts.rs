//! What is known to hold: atoms over values, and all ways to match atoms with variables against them.

use crate::pddl::{Atom, PredicateId, Term, TypeId, Types};
use std::collections::HashMap;

/// Something that actions and streams are about: an object of the scene, or what a stream found.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct Value(pub u32);

impl Value {
    pub fn index(self) -> usize {
        self.0 as usize
    }
}

/// All values, with their names and types.
#[derive(Clone, Debug, Default)]
pub struct Values {
    names: Vec<String>,
    types: Vec<TypeId>,
    by_name: HashMap<String, Value>,
}

impl Values {
    /// A new value, or the one that has this name.
    pub fn add(&mut self, name: &str, of: TypeId) -> Value {
        if let Some(known) = self.by_name.get(name) {
            return *known;
        }
        let value = Value(self.names.len() as u32);
        self.names.push(name.to_owned());
        self.types.push(of);
        self.by_name.insert(name.to_owned(), value);
        value
    }

    pub fn name(&self, value: Value) -> &str {
        &self.names[value.index()]
    }

    pub fn named(&self, name: &str) -> Option<Value> {
        self.by_name.get(name).copied()
    }

    pub fn of(&self, value: Value) -> TypeId {
        self.types[value.index()]
    }

    pub fn all_of<'a>(&'a self, types: &'a Types, wanted: TypeId) -> impl Iterator<Item = Value> + 'a {
        (0..self.names.len()).filter(move |i| types.is(self.types[*i], wanted)).map(|i| Value(i as u32))
    }
}

/// A predicate of values.
#[derive(Clone, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct Fact {
    pub predicate: PredicateId,
    pub values: Vec<Value>,
}

/// What variables stand for, by slot.
pub type Slots = Vec<Option<Value>>;

/// What a term stands for, as far as it is bound.
pub fn value_of(term: &Term, slots: &Slots, values: &Values) -> Option<Value> {
    match term {
        Term::Variable(slot) => slots[*slot],
        Term::Constant(name) => values.named(name),
    }
}

/// The fact that an atom is, its variables all bound.
pub fn instantiate(atom: &Atom, slots: &Slots, values: &Values) -> Option<Fact> {
    let values = atom.terms.iter().map(|t| value_of(t, slots, values)).collect::<Option<Vec<Value>>>()?;
    Some(Fact { predicate: atom.predicate, values })
}

/// A set of facts, in the order in which they came.
#[derive(Clone, Debug, Default)]
pub struct Facts {
    known: HashMap<Fact, usize>,
    list: Vec<Fact>,
    /// By predicate, and by predicate, argument and its value.
    of: HashMap<PredicateId, Vec<usize>>,
    with: HashMap<(PredicateId, usize, Value), Vec<usize>>,
}

impl Facts {
    /// False when it was known.
    pub fn insert(&mut self, fact: Fact) -> bool {
        if self.known.contains_key(&fact) {
            return false;
        }
        let index = self.list.len();
        self.of.entry(fact.predicate).or_default().push(index);
        for (place, value) in fact.values.iter().enumerate() {
            self.with.entry((fact.predicate, place, *value)).or_default().push(index);
        }
        self.known.insert(fact.clone(), index);
        self.list.push(fact);
        true
    }

    pub fn contains(&self, fact: &Fact) -> bool {
        self.known.contains_key(fact)
    }

    pub fn len(&self) -> usize {
        self.list.len()
    }

    pub fn is_empty(&self) -> bool {
        self.list.is_empty()
    }

    pub fn iter(&self) -> impl Iterator<Item = &Fact> {
        self.list.iter()
    }

    /// The facts that an atom could be, given what is bound: the shortest list known to hold them all.
    fn candidates(&self, atom: &Atom, slots: &Slots, values: &Values) -> &[usize] {
        let all = self.of.get(&atom.predicate).map_or(&[][..], Vec::as_slice);
        let bound =
            atom.terms.iter().enumerate().filter_map(|(place, term)| Some((place, value_of(term, slots, values)?)));
        let lists =
            bound.map(|(place, value)| self.with.get(&(atom.predicate, place, value)).map_or(&[][..], Vec::as_slice));
        lists.fold(all, |best, list| if list.len() < best.len() { list } else { best })
    }

    /// Calls `found` with every binding of the free variables for which all atoms hold. Types are not looked
    /// at: facts are of the right ones.
    pub fn each_match(&self, atoms: &[&Atom], slots: &mut Slots, values: &Values, found: &mut dyn FnMut(&mut Slots)) {
        let fewest = (0..atoms.len()).min_by_key(|i| self.candidates(atoms[*i], slots, values).len());
        let Some(first) = fewest else { return found(slots) };
        let atom = atoms[first];
        let rest: Vec<&Atom> = atoms.iter().enumerate().filter(|(i, _)| *i != first).map(|(_, a)| *a).collect();
        for &index in self.candidates(atom, slots, values) {
            let fact = &self.list[index];
            let mut bound = Vec::new();
            let matches =
                atom.terms.iter().zip(&fact.values).all(|(term, value)| match value_of(term, slots, values) {
                    Some(known) => known == *value,
                    None => match term {
                        Term::Variable(slot) => {
                            slots[*slot] = Some(*value);
                            bound.push(*slot);
                            true
                        }
                        Term::Constant(_) => false,
                    },
                });
            if matches {
                self.each_match(&rest, slots, values, found);
            }
            for slot in bound {
                slots[slot] = None;
            }
        }
    }
}
