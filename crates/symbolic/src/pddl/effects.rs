//! The effects of an action, written out: one atom each, with its condition and its variables.

use super::ast::{Effect, Formula, PredicateId, Variable};
use super::formula::{RESERVED, Reader};
use super::sexpr::{Place, Sexpr};
use super::unsupported;
use clearway_files::{FileError, quoted};
use std::collections::{HashMap, HashSet};

/// Conditions are copied to each of the effects that stand under them: so many parts of formulas in a domain at most.
pub(super) const ROOM: usize = 200_000;

/// Reads `at`. No effect may be on one of `derived`; `room` is what of [`ROOM`] is left.
pub(super) fn effects<'t>(
    reader: &mut Reader<'_, '_, 't>,
    derived: &HashSet<PredicateId>,
    room: &mut usize,
    at: &Sexpr<'t>,
) -> Result<Vec<Effect>, FileError> {
    let mut all = Effects {
        reader,
        derived,
        room,
        conditions: Vec::new(),
        variables: Vec::new(),
        weight: 1,
        effects: Vec::new(),
        places: Vec::new(),
    };
    all.read(at)?;
    all.check()?;
    Ok(all.effects)
}

struct Effects<'r, 'd, 'n, 't> {
    reader: &'r mut Reader<'d, 'n, 't>,
    derived: &'r HashSet<PredicateId>,
    room: &'r mut usize,
    /// What the effects that are read now stand under, and how much it takes to copy it.
    conditions: Vec<Formula>,
    variables: Vec<Variable>,
    weight: usize,
    effects: Vec<Effect>,
    /// Of each effect.
    places: Vec<Place>,
}

impl<'t> Effects<'_, '_, '_, 't> {
    fn read(&mut self, at: &Sexpr<'t>) -> Result<(), FileError> {
        let source = self.reader.names.source;
        let (head, rest) = match at.list() {
            Some([]) => return Ok(()),
            Some([head, rest @ ..]) => (head, rest),
            None => return Err(self.reader.no_list(at, "an effect")),
        };
        match (head.name().map(str::to_ascii_lowercase).as_deref(), rest) {
            (Some("and"), _) => rest.iter().try_for_each(|part| self.read(part)),
            (Some("not"), [atom]) => self.effect(atom, false),
            (Some("when"), [condition, effect]) => {
                let condition = self.reader.formula(condition)?;
                let weight = size(&condition);
                self.conditions.push(condition);
                self.weight += weight;
                self.read(effect)?;
                self.weight -= weight;
                self.conditions.pop();
                Ok(())
            }
            (Some("forall"), [variables, effect]) => {
                let variables = self.reader.quantify(variables)?;
                let outside = self.variables.len();
                self.variables.extend(variables.iter().cloned());
                self.weight += variables.len();
                self.read(effect)?;
                self.weight -= variables.len();
                self.variables.truncate(outside);
                self.reader.release(&variables);
                Ok(())
            }
            (Some(word @ ("not" | "when" | "forall")), _) => {
                let error = source.error(at.place, format!("{} of {} parts", quoted(word), rest.len()));
                Err(error.expected(match word {
                    "not" => "`(not atom)`",
                    "when" => "`(when condition effect)`",
                    _ => "`(forall (?a ?b - type …) effect)`",
                }))
            }
            (Some(word @ ("or" | "imply" | "exists" | "=")), _) => Err(self.no_effect(at, word)),
            _ => self.effect(at, true),
        }
    }

    fn effect(&mut self, at: &Sexpr<'t>, adds: bool) -> Result<(), FileError> {
        let source = self.reader.names.source;
        let head = at.head().unwrap_or_default();
        if RESERVED.iter().any(|w| head.eq_ignore_ascii_case(w)) {
            return Err(self.no_effect(at, head).expected("an atom"));
        }
        if let (Some(why), None) = (unsupported::word(head), self.reader.names.known_predicate(head)) {
            return Err(unsupported::error(source, at.place, head, why));
        }
        let atom = self.reader.atom(at)?;
        if self.derived.contains(&atom.predicate) {
            let error = source.error(at.place, format!("{} is derived, so no action can change it", quoted(head)));
            return Err(error.help("change what it is derived from"));
        }
        let Some(room) = self.room.checked_sub(self.weight) else {
            let error = source.error(at.place, "too many effects under conditions too large");
            return Err(error.help("make a derived predicate of the condition"));
        };
        *self.room = room;
        let condition = match &self.conditions[..] {
            [] => Formula::TRUE,
            [one] => one.clone(),
            several => Formula::And(several.to_vec()),
        };
        self.effects.push(Effect { variables: self.variables.clone(), condition, atom, adds });
        self.places.push(at.place);
        Ok(())
    }

    fn no_effect(&self, at: &Sexpr, word: &str) -> FileError {
        let error = self.reader.names.source.error(at.place, format!("{} cannot be an effect here", quoted(word)));
        error.help("effects are atoms, `(not atom)`, `(and …)`, `(when condition effect)` and `(forall (…) effect)`")
    }

    /// That nothing is both added and deleted under the same condition.
    fn check(&self) -> Result<(), FileError> {
        let mut seen: HashMap<_, (bool, Place)> = HashMap::new();
        for (effect, &place) in self.effects.iter().zip(&self.places) {
            let &mut (adds, (line, column)) =
                seen.entry((&effect.condition, &effect.atom)).or_insert((effect.adds, place));
            if adds != effect.adds {
                let names = self.reader.names;
                let name = quoted(&names.predicates[effect.atom.predicate.0].name);
                let (now, before) = if effect.adds { ("adds", "deletes") } else { ("deletes", "adds") };
                let source = names.source;
                let error = source.error(place, format!("this {now} the atom of {name} that {line}:{column} {before}"));
                return Err(error.help("leave out one of the two"));
            }
        }
        Ok(())
    }
}

/// How much it takes to copy a formula.
fn size(formula: &Formula) -> usize {
    1 + match formula {
        Formula::And(parts) | Formula::Or(parts) => parts.iter().map(size).sum(),
        Formula::Not(body) => size(body),
        Formula::Forall(variables, body) | Formula::Exists(variables, body) => variables.len() + size(body),
        Formula::Atom(atom) => atom.terms.len(),
        Formula::Equal(..) => 2,
    }
}
