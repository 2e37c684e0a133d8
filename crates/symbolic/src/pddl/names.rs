//! What the names in a text stand for, and what to say of those that stand for nothing.

use super::ast::{Constant, Predicate, PredicateId, TypeId, Types};
use super::sexpr::{Place, Sexpr, Source};
use clearway_files::{FileError, closest, quoted};
use std::collections::HashMap;

/// So many are listed in a message, and so many looked at for one that may be meant.
const LISTED: usize = 12;
const CONSIDERED: usize = 10_000;

/// The types, predicates and things that may be named.
pub(super) struct Names<'d> {
    pub source: Source<'d>,
    pub types: &'d Types,
    pub predicates: &'d [Predicate],
    pub things: Vec<&'d Constant>,
    type_ids: HashMap<&'d str, TypeId>,
    predicate_ids: HashMap<&'d str, PredicateId>,
    thing_ids: HashMap<&'d str, usize>,
}

impl<'d> Names<'d> {
    /// Of things with the same name the first counts.
    pub fn new(
        source: Source<'d>,
        types: &'d Types,
        predicates: &'d [Predicate],
        things: impl IntoIterator<Item = &'d Constant>,
    ) -> Self {
        let type_ids = types.names.iter().enumerate().map(|(i, name)| (name.as_str(), TypeId(i))).collect();
        let predicate_ids = predicates.iter().enumerate().map(|(i, p)| (p.name.as_str(), PredicateId(i))).collect();
        let mut thing_ids = HashMap::new();
        let mut different = Vec::new();
        for thing in things {
            thing_ids.entry(thing.name.as_str()).or_insert_with(|| {
                different.push(thing);
                different.len() - 1
            });
        }
        Self { source, types, predicates, things: different, type_ids, predicate_ids, thing_ids }
    }

    /// The type that is meant by what follows a `-`; `object` where nothing does.
    pub fn type_of(&self, of: Option<&Sexpr>) -> Result<TypeId, FileError> {
        let Some(of) = of else { return Ok(Types::OBJECT) };
        let name = type_name(self.source, of)?;
        self.type_ids.get(name).copied().ok_or_else(|| {
            let known = self.types.names.iter().map(String::as_str);
            unknown(self.source, of.place, "type", name, known, "declare it in `(:types …)`")
        })
    }

    pub fn predicate(&self, name: &str, place: Place) -> Result<PredicateId, FileError> {
        self.known_predicate(name).ok_or_else(|| {
            if let Some(why) = super::unsupported::word(name) {
                return super::unsupported::error(self.source, place, name, why);
            }
            let known = self.predicates.iter().map(|p| p.name.as_str());
            unknown(self.source, place, "predicate", name, known, "declare it in `(:predicates …)` of the domain")
        })
    }

    pub fn known_predicate(&self, name: &str) -> Option<PredicateId> {
        self.predicate_ids.get(name).copied()
    }

    /// Which of [`Names::things`].
    pub fn thing(&self, name: &str) -> Option<usize> {
        self.thing_ids.get(name).copied()
    }

    /// Whether something can be of both types.
    pub fn fit(&self, a: TypeId, b: TypeId) -> bool {
        self.types.is(a, b) || self.types.is(b, a)
    }

    pub fn type_name(&self, id: TypeId) -> &'d str {
        &self.types.names[id.0]
    }
}

/// The name of a type, whether it is known or not.
pub(super) fn type_name<'t>(source: Source, of: &Sexpr<'t>) -> Result<&'t str, FileError> {
    if of.head().is_some_and(|head| head.eq_ignore_ascii_case("either")) {
        let error = source.error(of.place, "`either` is not supported").expected("the name of one type");
        return Err(error.help("declare a type that is the parent of those"));
    }
    of.name().ok_or_else(|| source.error(of.place, of.quoted()).expected("the name of a type"))
}

/// An error about a name that nothing has.
pub(super) fn unknown<'n>(
    source: Source,
    place: Place,
    what: &str,
    name: &str,
    known: impl Iterator<Item = &'n str> + Clone,
    remedy: &str,
) -> FileError {
    let error = source.error(place, format!("unknown {what} {}", quoted(name)));
    let error = match one_of(known.clone()) {
        Some(list) => error.expected(list),
        None => error,
    };
    match closest(name, known.take(CONSIDERED)) {
        Some(near) => error.help(format!("did you mean {}?", quoted(near))),
        None => error.help(remedy),
    }
}

/// The names in words, as many as one can read.
pub(super) fn one_of<'n>(mut names: impl Iterator<Item = &'n str>) -> Option<String> {
    let first: Vec<String> = names.by_ref().take(LISTED).map(quoted).collect();
    let more = if names.next().is_some() { ", …" } else { "" };
    match &first[..] {
        [] => None,
        [one] => Some(one.clone()),
        _ => Some(format!("one of {}{more}", first.join(", "))),
    }
}

/// Names that may be given once only.
pub(super) struct Once<'t> {
    what: &'static str,
    seen: HashMap<&'t str, Place>,
}

impl<'t> Once<'t> {
    pub fn new(what: &'static str) -> Self {
        Self { what, seen: HashMap::new() }
    }

    pub fn check(&mut self, source: Source, name: &'t str, place: Place) -> Result<(), FileError> {
        match self.seen.insert(name, place) {
            None => Ok(()),
            Some((line, column)) => {
                let error = source.error(place, format!("the {} {} is given twice", self.what, quoted(name)));
                Err(error.help(format!("the first is at {line}:{column}: rename one, or leave it out")))
            }
        }
    }
}

/// A name that a file gives to something, which begins with a letter.
pub(super) fn given<'t>(source: Source, at: &Sexpr<'t>, what: &str) -> Result<&'t str, FileError> {
    match at.name() {
        Some(name) if name.starts_with(|c: char| c.is_alphabetic() || c == '_') => Ok(name),
        Some(name) if name.len() > 1 && name.starts_with('-') => {
            let error = source.error(at.place, quoted(name)).expected(format!("the name of {what}"));
            Err(error.help("put a space after the `-`"))
        }
        _ => {
            Err(source.error(at.place, at.quoted()).expected(format!("the name of {what}, which begins with a letter")))
        }
    }
}
