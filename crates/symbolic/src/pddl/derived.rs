//! Derived predicates: what they are derived from, and that this leads in no circle.

use super::ast::{Derived, Formula, PredicateId};
use super::formula::Reader;
use super::lists::{variables, wrong_number};
use super::names::{Names, Once};
use super::sexpr::{Place, Sexpr};
use clearway_files::{FileError, quoted};
use std::collections::HashMap;

/// Reads what follows each `:derived`.
pub(super) fn derived(names: &Names, all: &[(Place, &[Sexpr])]) -> Result<Vec<Derived>, FileError> {
    let mut once = Once::new("derived predicate");
    let mut places = Vec::new();
    let mut read = Vec::new();
    for &(place, parts) in all {
        let [head, body] = parts else {
            let error = names.source.error(place, format!("`:derived` of {} parts", parts.len()));
            return Err(error.expected("`(:derived (predicate ?a - type …) formula)`"));
        };
        let Some([name, parameters @ ..]) = head.list().filter(|_| head.head().is_some()) else {
            return Err(names.source.error(head.place, head.quoted()).expected("`(predicate ?a - type …)`"));
        };
        let name = name.name().unwrap_or_default();
        let predicate = names.predicate(name, head.place)?;
        once.check(names.source, name, head.place)?;
        let declared = &names.predicates[predicate.0].parameters;
        let typed = variables(names.source, parameters)?;
        if typed.len() != declared.len() {
            return Err(wrong_number(names.source, head.place, &quoted(name), typed.len(), declared.len()));
        }
        let mut reader = Reader::new(names);
        let mut parameters = Vec::new();
        for ((variable, typed), &wanted) in typed.into_iter().zip(declared) {
            // What is not written here is as it was declared.
            let of = if typed.of.is_some() { names.type_of(typed.of)? } else { wanted };
            if !names.fit(of, wanted) {
                let found = format!("{} is of type {}", quoted(variable), quoted(names.type_name(of)));
                let error = names.source.error(typed.at.place, found);
                return Err(error.expected(format!("one of type {}, as declared", quoted(names.type_name(wanted)))));
            }
            parameters.push(reader.bind(variable, of));
        }
        let body = reader.formula(body)?;
        read.push(Derived { predicate, parameters, slots: reader.slots, body });
        places.push(head.place);
    }
    no_circle(names, &read, &places)?;
    Ok(read)
}

fn no_circle(names: &Names, all: &[Derived], places: &[Place]) -> Result<(), FileError> {
    let which: HashMap<PredicateId, usize> = all.iter().enumerate().map(|(i, d)| (d.predicate, i)).collect();
    let needs: Vec<Vec<usize>> = all
        .iter()
        .map(|derived| {
            let mut needed = Vec::new();
            collect(&derived.body, &which, &mut needed);
            needed.sort_unstable();
            needed.dedup();
            needed
        })
        .collect();
    let mut settled = vec![false; all.len()];
    let mut on_path = vec![false; all.len()];
    for start in 0..all.len() {
        // What is being looked into, and how many of its needs were.
        let mut path: Vec<(usize, usize)> = Vec::new();
        let mut next = Some(start).filter(|&s| !settled[s]);
        loop {
            if let Some(at) = next.take() {
                on_path[at] = true;
                path.push((at, 0));
            }
            let Some((at, done)) = path.last_mut() else { break };
            let Some(&needed) = needs[*at].get(*done) else {
                settled[*at] = true;
                on_path[*at] = false;
                path.pop();
                continue;
            };
            *done += 1;
            if on_path[needed] {
                let from = path.iter().position(|&(p, _)| p == needed).unwrap_or(0);
                let circle = path[from..].iter().map(|&(p, _)| p).chain([needed]);
                let circle: Vec<String> = circle.map(|d| quoted(&names.predicates[all[d].predicate.0].name)).collect();
                let error =
                    names.source.error(places[needed], format!("derived from itself: {}", circle.join(" from ")));
                return Err(error.help("a derived predicate cannot depend on itself"));
            }
            next = Some(needed).filter(|&n| !settled[n]);
        }
    }
    Ok(())
}

fn collect(formula: &Formula, which: &HashMap<PredicateId, usize>, needed: &mut Vec<usize>) {
    match formula {
        Formula::And(parts) | Formula::Or(parts) => parts.iter().for_each(|part| collect(part, which, needed)),
        Formula::Not(body) | Formula::Forall(_, body) | Formula::Exists(_, body) => collect(body, which, needed),
        Formula::Atom(atom) => needed.extend(which.get(&atom.predicate)),
        Formula::Equal(..) => (),
    }
}
