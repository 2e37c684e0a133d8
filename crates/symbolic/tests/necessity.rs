//! What is said to have to be moved, against all states that there can be.
#![allow(clippy::unwrap_used)]

use clearway_symbolic::domain;
use clearway_symbolic::necessity::{Known, Necessity, Stands};
use clearway_symbolic::pddl::{Atom, Constant, Domain, Formula, Goal, PredicateId, Term, TypeId, Variable};
use rand::{RngExt, SeedableRng};
use rand_xoshiro::Xoshiro256PlusPlus;
use std::path::Path;

const ITEMS: [&str; 3] = ["a", "b", "c"];
const SUPPORTS: [&str; 5] = ["tray", "shelf", "a", "b", "c"];

fn things(domain: &Domain) -> Vec<Constant> {
    let of = |name: &str| domain.types.named(name).unwrap();
    let constant = |name: &str, of: TypeId| Constant { name: name.to_owned(), of };
    let items = ITEMS.iter().map(|name| constant(name, of("item")));
    items.chain([constant("tray", of("place")), constant("shelf", of("shelf"))]).collect()
}

/// `b` stands on `a`, the others on the shelf.
fn necessity(domain: &Domain) -> Necessity<'_> {
    let supports = [("a", "shelf"), ("b", "a"), ("c", "shelf")];
    Necessity {
        domain,
        things: things(domain),
        open: vec![domain.types.named("pose").unwrap()],
        on: domain.predicate("On").unwrap(),
        in_place: domain.predicate("InPlace"),
        hand_empty: domain.predicate("HandEmpty"),
        supports: supports.map(|(above, below)| (above.to_owned(), below.to_owned())).to_vec(),
    }
}

fn read(domain: &Domain, text: &str) -> Goal {
    Goal::read(Path::new("goal"), text, domain, &things(domain)).unwrap()
}

#[test]
fn what_has_to_be_moved() {
    let domain = domain();
    let necessity = necessity(&domain);
    let cases: [(&str, &[&str]); 11] = [
        ("(On a tray)", &["a"]),
        ("(On a shelf)", &[]),
        ("(and (On a tray) (On b tray))", &["a", "b"]),
        ("(or (On a tray) (On b tray))", &[]),
        ("(forall (?o - item) (On ?o tray))", &["a", "b", "c"]),
        ("(exists (?o - item) (On ?o tray))", &[]),
        ("(forall (?o - item) (imply (On ?o shelf) (= ?o c)))", &["a"]),
        ("(Clear a)", &["b"]),
        ("(not (InPlace c))", &["c"]),
        ("(and (HandEmpty) (forall (?o - item) (or (= ?o b) (not (InPlace ?o)))))", &["a", "c"]),
        ("(and (not (On c shelf)) (exists (?p - pose) (AtPose c ?p)))", &["c"]),
    ];
    for (goal, needed) in cases {
        let read = read(&domain, goal);
        let found: Vec<&str> = ITEMS.into_iter().filter(|item| necessity.forbids(&read, &[item])).collect();
        assert_eq!(found, needed, "{goal}");
    }
    let either = read(&domain, "(or (On a tray) (On b tray))");
    assert!(necessity.forbids(&either, &["a", "b"]) && !necessity.forbids(&either, &["a", "c"]));
}

#[test]
fn where_everything_is_known_the_goal_is() {
    let domain = domain();
    let necessity = necessity(&domain);
    let known = Known::from([("a", Stands::AtFirst), ("b", Stands::On(vec!["tray"])), ("c", Stands::On(vec!["a"]))]);
    for (goal, holds) in [
        ("(and (On b tray) (On c a) (On a shelf))", Some(true)),
        ("(InPlace a)", Some(true)),
        ("(or (InPlace b) (InPlace c))", Some(false)),
        ("(Clear b)", Some(true)),
        ("(Clear a)", Some(false)),
        ("(exists (?p - place) (and (On b ?p) (not (On c ?p))))", Some(true)),
        ("(exists (?p - pose) (AtPose a ?p))", None),
    ] {
        assert_eq!(necessity.value(&read(&domain, goal), &known), holds, "{goal}");
    }
}

/// On what each item is; `None`: on nothing, as in the hand.
type State = [Option<usize>; 3];

fn holds(goal: &Formula, slots: &mut Vec<Option<usize>>, things: &[Constant], types: &Domain, state: &State) -> bool {
    let index = |term: &Term, slots: &[Option<usize>]| match term {
        Term::Constant(name) => things.iter().position(|t| t.name == *name).unwrap(),
        Term::Variable(slot) => slots[*slot].unwrap(),
    };
    match goal {
        Formula::And(parts) => parts.iter().all(|p| holds(p, slots, things, types, state)),
        Formula::Or(parts) => parts.iter().any(|p| holds(p, slots, things, types, state)),
        Formula::Not(inner) => !holds(inner, slots, things, types, state),
        Formula::Equal(a, b) => index(a, slots) == index(b, slots),
        Formula::Atom(atom) => {
            let (above, below) = (index(&atom.terms[0], slots), index(&atom.terms[1], slots));
            let on = state.get(above).copied().flatten().map(|s| SUPPORTS[s]);
            on == Some(things[below].name.as_str())
        }
        Formula::Forall(variables, body) | Formula::Exists(variables, body) => {
            let all = matches!(goal, Formula::Forall(..));
            let Variable { slot, of, .. } = variables[0];
            let mut each =
                (0..things.len()).filter(|i| types.types.is(things[*i].of, of)).collect::<Vec<_>>().into_iter();
            let mut with = |thing: usize| {
                slots[slot] = Some(thing);
                holds(body, slots, things, types, state)
            };
            if all { each.all(&mut with) } else { each.any(&mut with) }
        }
    }
}

fn drawn(random: &mut Xoshiro256PlusPlus, domain: &Domain, on: PredicateId, depth: usize, slots: usize) -> Formula {
    let item = domain.types.named("item").unwrap();
    let term = |random: &mut Xoshiro256PlusPlus, names: &[&str]| {
        let variable = slots > 0 && random.random_bool(0.5);
        match variable {
            true => Term::Variable(random.random_range(0..slots)),
            false => Term::Constant(names[random.random_range(0..names.len())].to_owned()),
        }
    };
    let deeper = |random: &mut Xoshiro256PlusPlus, slots| drawn(random, domain, on, depth - 1, slots);
    let variable = || vec![Variable { slot: slots, of: item, name: format!("?v{slots}") }];
    match random.random_range(if depth == 0 { 5..7 } else { 0..7 }) {
        0 => Formula::And((0..random.random_range(0..3)).map(|_| deeper(random, slots)).collect()),
        1 => Formula::Or((0..random.random_range(0..3)).map(|_| deeper(random, slots)).collect()),
        2 => Formula::Not(Box::new(deeper(random, slots))),
        3 => Formula::Forall(variable(), Box::new(deeper(random, slots + 1))),
        4 => Formula::Exists(variable(), Box::new(deeper(random, slots + 1))),
        5 => Formula::Equal(term(random, &ITEMS), term(random, &ITEMS)),
        _ => Formula::Atom(Atom { predicate: on, terms: vec![term(random, &ITEMS), term(random, &SUPPORTS)] }),
    }
}

#[test]
fn no_state_holds_where_it_is_said_that_none_does() {
    let domain = domain();
    let (necessity, things) = (necessity(&domain), things(&domain));
    let on = necessity.on;
    let mut random = Xoshiro256PlusPlus::seed_from_u64(1);
    let first: State = [Some(1), Some(2), Some(1)];
    let choices: Vec<Option<usize>> = (0..SUPPORTS.len()).map(Some).chain([None]).collect();
    let (mut said, mut missed) = (0, 0);
    for _ in 0..4000 {
        let formula = drawn(&mut random, &domain, on, 4, 0);
        let goal = Goal { slots: 5, formula, text: String::new() };
        let unmoved: Vec<usize> = (0..3).filter(|_| random.random_bool(0.5)).collect();
        let names: Vec<&str> = unmoved.iter().map(|i| ITEMS[*i]).collect();
        let forbidden = necessity.forbids(&goal, &names);
        let mut any = false;
        for a in &choices {
            for b in &choices {
                for c in &choices {
                    let mut state = [*a, *b, *c];
                    unmoved.iter().for_each(|i| state[*i] = first[*i]);
                    any |= holds(&goal.formula, &mut vec![None; 5], &things, &domain, &state);
                }
            }
        }
        assert!(!(forbidden && any), "{:?} with {names:?} unmoved", goal.formula);
        said += usize::from(forbidden);
        missed += usize::from(!forbidden && !any);
    }
    // It need not find all, but most.
    assert!(said > 500 && missed * 4 < said, "{said} said, {missed} missed");
}
