//! Reads domains.

use super::ast::{Action, Constant, Domain, Formula, Predicate, PredicateId};
use super::derived::derived;
use super::effects;
use super::formula::{RESERVED, Reader};
use super::lists::{define, items, properties, section, typed, variables};
use super::names::{Names, Once, given, unknown};
use super::sexpr::{self, Place, Sexpr, Source};
use super::types::types;
use clearway_files::{FileError, Limits, quoted, read_text};
use std::collections::HashSet;
use std::path::Path;

const REQUIREMENTS: [&str; 11] = [
    ":strips",
    ":typing",
    ":negative-preconditions",
    ":disjunctive-preconditions",
    ":equality",
    ":existential-preconditions",
    ":universal-preconditions",
    ":quantified-preconditions",
    ":conditional-effects",
    ":derived-predicates",
    ":adl",
];

const SECTIONS: [&str; 6] = [":requirements", ":types", ":constants", ":predicates", ":derived", ":action"];

impl Domain {
    pub fn load(path: &Path) -> Result<Domain, FileError> {
        Self::read(path, &read_text(path, &Limits::DOCUMENT)?)
    }

    /// Reads `text`, of which `path` is the name for messages. The sections may stand in any order.
    pub fn read(path: &Path, text: &str) -> Result<Domain, FileError> {
        let source = Source { path };
        let whole = sexpr::read(source, text)?;
        let (name, rest) = define(source, &whole, "domain")?;
        let name = given(source, name, "a domain")?.to_owned();
        let sections = sections(source, rest)?;
        requirements(source, sections.requirements)?;
        let types = types(source, sections.types)?;
        let names = Names::new(source, &types, &[], []);
        let constants = constants(&names, sections.constants)?;
        let predicates = predicates(&names, sections.predicates)?;
        let names = Names::new(source, &types, &predicates, &constants);
        let derived = derived(&names, &sections.derived)?;
        let actions = actions(&names, &derived.iter().map(|d| d.predicate).collect(), &sections.actions)?;
        Ok(Domain { name, types, constants, predicates, derived, actions })
    }
}

#[derive(Default)]
struct Sections<'s, 't> {
    requirements: &'s [Sexpr<'t>],
    types: &'s [Sexpr<'t>],
    constants: &'s [Sexpr<'t>],
    predicates: &'s [Sexpr<'t>],
    derived: Vec<(Place, &'s [Sexpr<'t>])>,
    actions: Vec<(Place, &'s [Sexpr<'t>])>,
}

fn sections<'s, 't>(source: Source, all: &'s [Sexpr<'t>]) -> Result<Sections<'s, 't>, FileError> {
    let mut sections = Sections::default();
    let mut once = Once::new("section");
    for at in all {
        let (keyword, rest) = section(source, at, &SECTIONS)?;
        match keyword {
            ":derived" => sections.derived.push((at.place, rest)),
            ":action" => sections.actions.push((at.place, rest)),
            _ => {
                once.check(source, keyword, at.place)?;
                match keyword {
                    ":requirements" => sections.requirements = rest,
                    ":types" => sections.types = rest,
                    ":constants" => sections.constants = rest,
                    _ => sections.predicates = rest,
                }
            }
        }
    }
    Ok(sections)
}

/// That all that is required is supported. What is used need not be required.
pub(super) fn requirements(source: Source, all: &[Sexpr]) -> Result<(), FileError> {
    for at in all {
        if !REQUIREMENTS.iter().any(|r| at.is(r)) {
            let name = at.to_string();
            return Err(unknown(source, at.place, "requirement", &name, REQUIREMENTS.into_iter(), "leave it out"));
        }
    }
    Ok(())
}

fn constants(names: &Names, all: &[Sexpr]) -> Result<Vec<Constant>, FileError> {
    let mut once = Once::new("constant");
    let constants = typed(names.source, all)?.into_iter().map(|typed| {
        let name = given(names.source, typed.at, "a constant")?;
        once.check(names.source, name, typed.at.place)?;
        Ok(Constant { name: name.to_owned(), of: names.type_of(typed.of)? })
    });
    constants.collect()
}

fn predicates(names: &Names, all: &[Sexpr]) -> Result<Vec<Predicate>, FileError> {
    let source = names.source;
    let mut once = Once::new("predicate");
    let predicates = all.iter().map(|at| {
        let Some([name, parameters @ ..]) = at.list() else {
            return Err(source.error(at.place, at.quoted()).expected("`(predicate ?a - type …)`"));
        };
        if let Some(word) = RESERVED.iter().find(|w| name.is(w)) {
            let error = source.error(name.place, format!("{} is no name for a predicate", quoted(word)));
            return Err(error.help(match *word {
                "=" => "`(= a b)` can be used everywhere without declaring it: leave it out",
                _ => "choose another name",
            }));
        }
        let name_of = given(source, name, "a predicate")?;
        once.check(source, name_of, name.place)?;
        let parameters = variables(source, parameters)?.into_iter().map(|(_, typed)| names.type_of(typed.of));
        Ok(Predicate { name: name_of.to_owned(), parameters: parameters.collect::<Result<_, _>>()? })
    });
    predicates.collect()
}

fn actions(names: &Names, derived: &HashSet<PredicateId>, all: &[(Place, &[Sexpr])]) -> Result<Vec<Action>, FileError> {
    let source = names.source;
    let mut once = Once::new("action");
    let mut room = effects::ROOM;
    let actions = all.iter().map(|&(place, parts)| {
        let [name, rest @ ..] = parts else {
            return Err(source.error(place, "an action without a name").expected("`(:action name …)`"));
        };
        let name_of = given(source, name, "an action")?;
        once.check(source, name_of, name.place)?;
        let [parameters, precondition, effect] = properties(source, rest, [":parameters", ":precondition", ":effect"])?;
        let mut reader = Reader::new(names);
        let parameters = reader.variables(items(source, parameters, "variables")?)?;
        let precondition = precondition.map_or(Ok(Formula::TRUE), |at| reader.formula(at))?;
        let effects = match effect {
            Some(at) => effects::effects(&mut reader, derived, &mut room, at)?,
            None => Vec::new(),
        };
        Ok(Action { name: name_of.to_owned(), parameters, slots: reader.slots, precondition, effects })
    });
    actions.collect()
}
