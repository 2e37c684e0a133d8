//! Whether a goal contradicts itself: no state at all is as it says.
//!
//! It is written out over all that is known, and its alternatives are tried one by one until one holds no atom
//! together with its negation. What is too large is taken for sound. So is a "there is" over things that may come
//! to be later: of type `object`, or of a type that nothing known is of. Knows nothing of what predicates mean.

use super::ast::{Atom, Formula, PredicateId, Term, TypeId, Types, Variable};
use super::formula::leaves;
use super::names::Names;
use super::sexpr::Place;
use clearway_files::{FileError, quoted};
use std::collections::HashMap;
use std::rc::Rc;

/// A quantifier is written out so many times at most.
const MAX_INSTANCES: usize = 4096;
/// Parts of what is written out.
const MAX_PARTS: usize = 200_000;
const MAX_ALTERNATIVES: usize = 4096;
const MAX_STEPS: usize = 2_000_000;

/// What is wrong with the goal `formula`, whose atoms and equations stand at `places`.
pub(super) fn find(names: &Names, formula: &Formula, slots: usize, places: &[Place], at: Place) -> Option<FileError> {
    let mut writer = Writer {
        names,
        places,
        leaf: 0,
        room: MAX_PARTS,
        things: vec![0; slots],
        of_type: HashMap::new(),
        closed: HashMap::new(),
        ids: HashMap::new(),
        atoms: Vec::new(),
    };
    let part = writer.part(formula, true);
    let closed = try_all(&part, writer.atoms.len())?;
    let source = names.source;
    let many = closed.alternatives > 1;
    let whole = if many {
        "every alternative of the goal contradicts itself, the first by"
    } else {
        "the goal contradicts itself:"
    };
    Some(match closed.why {
        Some(Why::Pair { atom, mut first, mut second }) => {
            if first.1 > second.1 {
                (first, second) = (second, first);
            }
            let shown = |holds| {
                let atom = &writer.atoms[atom];
                quoted(&if holds { atom.clone() } else { format!("(not {atom})") })
            };
            let (line, column) = first.1;
            let pair = format!("{} here and {} at {line}:{column}", shown(second.0), shown(first.0));
            source.error(second.1, format!("{whole} {pair}")).help("leave out one of the two")
        }
        Some(Why::Never { equation, place }) => {
            let error = source.error(place, format!("{whole} {}, which never holds", quoted(&equation)));
            error.help("different names are different things")
        }
        None => source.error(at, "the goal never holds").help("an `(or)` of nothing is false"),
    })
}

/// A part of the goal, without variables, quantifiers and negations of more than atoms.
enum Part {
    All(Vec<Part>),
    Any(Vec<Part>),
    Literal { atom: usize, holds: bool, place: Place },
    Never { equation: String, place: Place },
}

const TRUE: Part = Part::All(Vec::new());

/// Of alternatives, those that never hold are left out where there are others.
fn joined(mut parts: Vec<Part>, all: bool) -> Part {
    if all {
        return Part::All(parts);
    }
    let never = |part: &Part| matches!(part, Part::Never { .. });
    if !parts.iter().all(never) {
        parts.retain(|part| !never(part));
    }
    Part::Any(parts)
}

struct Writer<'d, 'n> {
    names: &'n Names<'d>,
    places: &'n [Place],
    /// Which of the places is next.
    leaf: usize,
    room: usize,
    /// What each slot stands for.
    things: Vec<usize>,
    of_type: HashMap<TypeId, Rc<[usize]>>,
    /// Whether all that is of the type is known.
    closed: HashMap<TypeId, bool>,
    ids: HashMap<(PredicateId, Vec<usize>), usize>,
    /// As they are shown.
    atoms: Vec<String>,
}

impl Writer<'_, '_> {
    /// Where it is not written out, it is true: less is asked for, so nothing sound is refused.
    fn part(&mut self, formula: &Formula, holds: bool) -> Part {
        if self.room == 0 {
            self.leaf += leaves(formula);
            return TRUE;
        }
        self.room -= 1;
        match formula {
            Formula::And(parts) | Formula::Or(parts) => {
                let all = matches!(formula, Formula::And(_)) == holds;
                let parts = parts.iter().map(|part| self.part(part, holds)).collect();
                joined(parts, all)
            }
            Formula::Not(body) => self.part(body, !holds),
            Formula::Forall(variables, body) => self.quantified(variables, body, holds, holds),
            Formula::Exists(variables, body) => self.quantified(variables, body, !holds, holds),
            Formula::Atom(atom) => {
                let place = self.next_place();
                Part::Literal { atom: self.atom(atom), holds, place }
            }
            Formula::Equal(a, b) => {
                let place = self.next_place();
                let (Some(a), Some(b)) = (self.thing(a), self.thing(b)) else { return TRUE };
                if (a == b) == holds {
                    return TRUE;
                }
                let [a, b] = [a, b].map(|t| &self.names.things[t].name);
                let equation = if holds { format!("(= {a} {b})") } else { format!("(not (= {a} {b}))") };
                Part::Never { equation, place }
            }
        }
    }

    fn next_place(&mut self) -> Place {
        self.leaf += 1;
        self.places.get(self.leaf - 1).copied().unwrap_or((1, 1))
    }

    fn thing(&self, term: &Term) -> Option<usize> {
        match term {
            Term::Variable(slot) => Some(self.things[*slot]),
            Term::Constant(name) => self.names.thing(name),
        }
    }

    fn atom(&mut self, atom: &Atom) -> usize {
        let things: Vec<usize> = atom.terms.iter().filter_map(|term| self.thing(term)).collect();
        let names = self.names;
        let atoms = &mut self.atoms;
        *self.ids.entry((atom.predicate, things)).or_insert_with_key(|(predicate, things)| {
            let mut shown = format!("({}", names.predicates[predicate.0].name);
            for &thing in things {
                shown += " ";
                shown += &names.things[thing].name;
            }
            atoms.push(shown + ")");
            atoms.len() - 1
        })
    }

    /// The body for all the things that the variables may be, joined by "and" if `all`, else by "or".
    fn quantified(&mut self, variables: &[Variable], body: &Formula, all: bool, holds: bool) -> Part {
        let start = self.leaf;
        let end = start + leaves(body);
        // Counted even where it is not written out, for it was looked at.
        self.room = self.room.saturating_sub(end - start);
        let extents: Vec<Rc<[usize]>> = variables.iter().map(|v| self.of_type(v.of)).collect();
        let instances = extents.iter().fold(1_usize, |n, extent| n.saturating_mul(extent.len()));
        if instances > MAX_INSTANCES || !(all || variables.iter().all(|v| self.is_closed(v.of))) {
            self.leaf = end;
            return TRUE;
        }
        let mut parts = Vec::with_capacity(instances);
        for mut instance in 0..instances {
            if self.room == 0 {
                self.leaf = end;
                return TRUE;
            }
            for (variable, extent) in variables.iter().zip(&extents) {
                self.things[variable.slot] = extent[instance % extent.len()];
                instance /= extent.len();
            }
            self.leaf = start;
            parts.push(self.part(body, holds));
        }
        self.leaf = end;
        joined(parts, all)
    }

    fn of_type(&mut self, of: TypeId) -> Rc<[usize]> {
        let names = self.names;
        let these = || (0..names.things.len()).filter(|&i| names.types.is(names.things[i].of, of)).collect();
        self.of_type.entry(of).or_insert_with(these).clone()
    }

    /// Whether something of each kind of this type is known.
    fn is_closed(&mut self, of: TypeId) -> bool {
        if let Some(&closed) = self.closed.get(&of) {
            return closed;
        }
        let types = self.names.types;
        let kinds = (0..types.names.len()).map(TypeId).filter(|&t| types.is(t, of));
        let lowest: Vec<TypeId> = kinds.filter(|t| !types.parents.contains(&Some(*t))).collect();
        let closed = of != Types::OBJECT && lowest.into_iter().all(|t| !self.of_type(t).is_empty());
        self.closed.insert(of, closed);
        closed
    }
}

enum Why {
    /// Whether each of the two asks for the atom, and where.
    Pair {
        atom: usize,
        first: (bool, Place),
        second: (bool, Place),
    },
    Never {
        equation: String,
        place: Place,
    },
}

struct Closed {
    alternatives: usize,
    /// Why the first one failed; `None` if there are none.
    why: Option<Why>,
}

/// Alternatives to come back to.
struct Choice<'p> {
    rest: &'p [Part],
    /// The choices that then remain.
    later: Option<usize>,
    tasks: usize,
    decided: usize,
}

/// Lists of parts, which share their ends: each part with where in `tasks` the next one is.
struct Tasks<'p>(Vec<(&'p Part, Option<usize>)>);

impl<'p> Tasks<'p> {
    fn push(&mut self, list: &mut Option<usize>, part: &'p Part) {
        self.0.push((part, *list));
        *list = Some(self.0.len() - 1);
    }

    fn pop(&self, list: &mut Option<usize>) -> Option<&'p Part> {
        let (part, next) = self.0[(*list)?];
        *list = next;
        Some(part)
    }
}

/// Tries the alternatives; `None` if one is consistent or there are too many.
fn try_all(goal: &Part, atoms: usize) -> Option<Closed> {
    let mut values: Vec<Option<(bool, Place)>> = vec![None; atoms];
    let mut decided: Vec<usize> = Vec::new();
    let mut tasks = Tasks(Vec::new());
    // What leaves no choice is done first.
    let (mut now, mut later) = (None, None);
    tasks.push(&mut now, goal);
    let mut choices: Vec<Choice> = Vec::new();
    let mut closed = Closed { alternatives: 0, why: None };
    let mut steps = MAX_STEPS;
    loop {
        // Nothing left: this alternative is consistent.
        let part = match tasks.pop(&mut now) {
            Some(part) => part,
            None => tasks.pop(&mut later)?,
        };
        steps = steps.checked_sub(match part {
            Part::All(parts) | Part::Any(parts) => 1 + parts.len(),
            _ => 1,
        })?;
        let why = match part {
            Part::All(parts) => {
                for part in parts.iter().rev() {
                    tasks.push(if matches!(part, Part::Any(_)) { &mut later } else { &mut now }, part);
                }
                continue;
            }
            Part::Any(parts) => {
                let holds = |part: &Part| match part {
                    Part::Literal { atom, holds, .. } => values[*atom].is_some_and(|(value, _)| value == *holds),
                    _ => false,
                };
                if parts.iter().any(holds) {
                    continue;
                }
                choices.push(Choice { rest: parts, later, tasks: tasks.0.len(), decided: decided.len() });
                None
            }
            Part::Literal { atom, holds, place } => match values[*atom] {
                None => {
                    values[*atom] = Some((*holds, *place));
                    decided.push(*atom);
                    continue;
                }
                Some((before, _)) if before == *holds => continue,
                Some(first) => Some(Why::Pair { atom: *atom, first, second: (*holds, *place) }),
            },
            Part::Never { equation, place } => Some(Why::Never { equation: equation.clone(), place: *place }),
        };
        if why.is_some() {
            closed.alternatives += 1;
            closed.why = closed.why.or(why);
        }
        if closed.alternatives > MAX_ALTERNATIVES {
            return None;
        }
        // On to the next alternative.
        loop {
            let Some(choice) = choices.last_mut() else { return Some(closed) };
            if let [first, rest @ ..] = choice.rest {
                choice.rest = rest;
                for atom in decided.drain(choice.decided..) {
                    values[atom] = None;
                }
                tasks.0.truncate(choice.tasks);
                (now, later) = (None, choice.later);
                tasks.push(&mut now, first);
                break;
            }
            choices.pop();
        }
    }
}
