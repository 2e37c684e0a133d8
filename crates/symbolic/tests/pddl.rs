//! Domains, streams and goals are read as they mean; what is wrong with them is told with its place; nothing hangs.
#![allow(clippy::unwrap_used)]

use clearway_files::FileError;
use clearway_symbolic::pddl::{
    Action, Atom, Constant, Derived, Domain, Effect, Formula, Goal, Predicate, PredicateId, Provided, Stream, Term,
    TypeId, Types, Variable,
};
use proptest::prelude::*;
use std::path::Path;

const TABLE: &str = include_str!("pddl/table.pddl");
const STREAMS: &str = include_str!("pddl/streams.pddl");

const PROVIDED: [Provided; 4] = [
    Provided { name: "sample-grasp", inputs: 1, outputs: 1 },
    Provided { name: "sample-pose", inputs: 2, outputs: 1 },
    Provided { name: "plan-motion", inputs: 2, outputs: 1 },
    Provided { name: "test-clear", inputs: 2, outputs: 0 },
];

fn domain(text: &str) -> Result<Domain, FileError> {
    Domain::read(Path::new("d.pddl"), text)
}

fn streams(text: &str) -> Result<Vec<Stream>, FileError> {
    Stream::read_all(Path::new("s.pddl"), text, &domain(TABLE).unwrap(), &PROVIDED)
}

/// What the scene gives: `o1`, `o7` and the box `b1` are items, `tray` and `shelf` are places.
fn goal(text: &str) -> Result<Goal, FileError> {
    let domain = domain(TABLE).unwrap();
    let known = [("o1", "can"), ("o7", "can"), ("b1", "box"), ("shelf", "place"), ("tray", "place")];
    let known = known.map(|(name, of)| Constant { name: name.to_owned(), of: domain.types.named(of).unwrap() });
    Goal::read(Path::new("g.pddl"), text, &domain, &known)
}

#[track_caller]
fn refused<T: std::fmt::Debug>(result: Result<T, FileError>, place: (usize, usize), words: &[&str]) {
    let error = result.unwrap_err();
    let shown = error.to_string();
    assert_eq!(error.position(), Some(place), "{shown}");
    for word in words {
        assert!(shown.contains(word), "{word:?} is not in: {shown}");
    }
}

fn var(slot: usize, of: usize, name: &str) -> Variable {
    Variable { slot, of: TypeId(of), name: name.to_owned() }
}

fn v(slot: usize) -> Term {
    Term::Variable(slot)
}

fn c(name: &str) -> Term {
    Term::Constant(name.to_owned())
}

fn atom<const N: usize>(predicate: usize, terms: [Term; N]) -> Atom {
    Atom { predicate: PredicateId(predicate), terms: terms.to_vec() }
}

fn is<const N: usize>(predicate: usize, terms: [Term; N]) -> Formula {
    Formula::Atom(atom(predicate, terms))
}

fn not(formula: Formula) -> Formula {
    Formula::Not(Box::new(formula))
}

fn adds(atom: Atom) -> Effect {
    Effect { variables: vec![], condition: Formula::TRUE, atom, adds: true }
}

fn deletes(atom: Atom) -> Effect {
    Effect { adds: false, ..adds(atom) }
}

// The numbers of tests/pddl/table.pddl.
const ITEM: usize = 1;
const PLACE: usize = 4;
const GRASP: usize = 5;
const PATH: usize = 6;
const POSE: usize = 7;
const ON: usize = 0;
const IN_HAND: usize = 1;
const EMPTY: usize = 2;
const AT_POSE: usize = 3;
const MOVED: usize = 4;
const FREE: usize = 10;
const SAFE: usize = 11;

#[test]
fn a_domain_with_everything() {
    let read = domain(TABLE).unwrap();
    assert_eq!(read.name, "table");
    assert_eq!(read.types.names, ["object", "item", "can", "box", "place", "grasp", "path", "pose", "thing"]);
    let parents = [None, Some(8), Some(1), Some(1), Some(8), Some(0), Some(0), Some(0), Some(0)];
    assert_eq!(read.types.parents, parents.map(|p| p.map(TypeId)));
    let constants = [("bin", PLACE), ("me", 0)];
    assert_eq!(read.constants, constants.map(|(name, of)| Constant { name: name.to_owned(), of: TypeId(of) }));
    let predicates: [(&str, &[usize]); 12] = [
        ("On", &[ITEM, PLACE]),
        ("InHand", &[ITEM, GRASP]),
        ("HandEmpty", &[]),
        ("AtPose", &[ITEM, POSE]),
        ("Moved", &[0]),
        ("Item", &[ITEM]),
        ("Grasp", &[ITEM, GRASP]),
        ("Pose", &[ITEM, POSE, PLACE]),
        ("Motion", &[POSE, POSE, PATH]),
        ("Clear", &[PATH, ITEM]),
        ("Free", &[PLACE]),
        ("Safe", &[PATH]),
    ];
    let predicates = predicates
        .map(|(name, of)| Predicate { name: name.to_owned(), parameters: of.iter().map(|&t| TypeId(t)).collect() });
    assert_eq!(read.predicates, predicates);
    let free = Derived {
        predicate: PredicateId(FREE),
        // Its type is that of the declaration.
        parameters: vec![var(0, PLACE, "?p")],
        slots: 2,
        body: not(Formula::Exists(vec![var(1, ITEM, "?i")], Box::new(is(ON, [v(1), v(0)])))),
    };
    let safe = Derived {
        predicate: PredicateId(SAFE),
        parameters: vec![var(0, PATH, "?t")],
        slots: 3,
        body: Formula::Forall(
            vec![var(1, ITEM, "?i"), var(2, PLACE, "?p")],
            Box::new(Formula::Or(vec![
                not(Formula::And(vec![is(ON, [v(1), v(2)]), not(is(FREE, [v(2)]))])),
                is(9, [v(0), v(1)]),
            ])),
        ),
    };
    assert_eq!(read.derived, [free, safe]);
    let pick = Action {
        name: "pick".to_owned(),
        parameters: vec![var(0, ITEM, "?o"), var(1, GRASP, "?g"), var(2, PLACE, "?p"), var(3, 0, "?who")],
        slots: 6,
        precondition: Formula::And(vec![
            is(6, [v(0), v(1)]),
            is(ON, [v(0), v(2)]),
            is(EMPTY, []),
            Formula::Equal(v(3), c("me")),
            not(Formula::Equal(v(2), c("bin"))),
            Formula::Or(vec![not(is(MOVED, [v(0)])), is(FREE, [c("bin")])]),
            Formula::TRUE,
        ]),
        effects: vec![
            adds(atom(IN_HAND, [v(0), v(1)])),
            deletes(atom(EMPTY, [])),
            deletes(atom(ON, [v(0), v(2)])),
            Effect {
                variables: vec![var(4, POSE, "?q")],
                condition: is(AT_POSE, [v(0), v(4)]),
                atom: atom(AT_POSE, [v(0), v(4)]),
                adds: false,
            },
            Effect {
                variables: vec![var(4, POSE, "?q"), var(5, ITEM, "?o")],
                condition: Formula::And(vec![is(AT_POSE, [v(0), v(4)]), is(MOVED, [v(5)])]),
                atom: atom(MOVED, [v(4)]),
                adds: true,
            },
            adds(atom(MOVED, [v(0)])),
        ],
    };
    let wait =
        Action { name: "wait".to_owned(), parameters: vec![], slots: 0, precondition: Formula::TRUE, effects: vec![] };
    assert_eq!(read.actions, [pick, wait]);
}

#[test]
fn a_file_is_as_its_text() {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/pddl/table.pddl");
    assert_eq!(Domain::load(&path).unwrap(), domain(TABLE).unwrap());
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/pddl/streams.pddl");
    let read = Stream::load_all(&path, &domain(TABLE).unwrap(), &PROVIDED).unwrap();
    assert_eq!(read, streams(STREAMS).unwrap());
    assert!(Domain::load(Path::new("tests/none.pddl")).unwrap_err().to_string().contains("no such file"));
}

#[test]
fn untyped_domains_are_of_objects() {
    let read = domain(
        "(DEFINE (Domain d) (:PREDICATES (p ?x) (q)) (:action a :parameters (?x) :precondition () :effect (NOT (p ?x))))",
    )
    .unwrap();
    assert_eq!(read.types, Types { names: vec!["object".to_owned()], parents: vec![None] });
    assert_eq!(read.predicates[0].parameters, [Types::OBJECT]);
    assert_eq!(read.actions[0].parameters, [var(0, 0, "?x")]);
    assert_eq!(read.actions[0].precondition, Formula::TRUE);
    assert_eq!(read.actions[0].effects, [deletes(atom(0, [v(0)]))]);
    // Sections in any order; nothing but a name.
    assert_eq!(
        domain("(define (domain d) (:predicates (p ?x - t)) (:types object t - object))").unwrap().types.names.len(),
        2
    );
    assert_eq!(domain("; d\r\n(define\t(domain d))\n;").unwrap().name, "d");
}

#[test]
fn streams_of_every_form() {
    let read = streams(STREAMS).unwrap();
    let grasp = Stream {
        name: "sample-grasp".to_owned(),
        // Both types are those that the atoms ask for.
        inputs: vec![var(0, ITEM, "?o")],
        outputs: vec![var(1, GRASP, "?g")],
        domain: vec![atom(5, [v(0)])],
        certified: vec![atom(6, [v(0), v(1)])],
        fluents: vec![],
    };
    let pose = Stream {
        name: "sample-pose".to_owned(),
        inputs: vec![var(0, 2, "?o"), var(1, PLACE, "?p")],
        outputs: vec![var(2, POSE, "?q")],
        domain: vec![atom(5, [v(0)])],
        certified: vec![atom(7, [v(0), v(2), v(1)]), atom(7, [v(0), v(2), c("bin")])],
        fluents: vec![],
    };
    let motion = Stream {
        name: "plan-motion".to_owned(),
        inputs: vec![var(0, 0, "?from"), var(1, 0, "?to")],
        outputs: vec![var(2, PATH, "?t")],
        domain: vec![],
        certified: vec![atom(8, [v(0), v(1), v(2)])],
        fluents: vec![PredicateId(AT_POSE), PredicateId(IN_HAND)],
    };
    let test = Stream {
        name: "test-clear".to_owned(),
        inputs: vec![var(0, PATH, "?t"), var(1, ITEM, "?o")],
        outputs: vec![],
        domain: vec![atom(5, [v(1)])],
        certified: vec![atom(9, [v(0), v(1)])],
        fluents: vec![],
    };
    assert_eq!(read, [grasp, pose, motion, test]);
    assert_eq!(streams("(define (stream none))").unwrap(), []);
}

#[test]
fn goals_bare_and_wrapped() {
    let on = is(ON, [c("o7"), c("tray")]);
    let bare = goal(" (On o7 tray) ; there\n").unwrap();
    assert_eq!(bare, Goal { slots: 0, formula: on.clone(), text: "(On o7 tray) ; there".to_owned() });
    for wrapped in [
        "(:goal (On o7 tray))",
        "(define (problem p) (:domain table) (:requirements :strips) (:goal (On o7 tray)))",
        "(define (problem p) (:goal (On o7 tray)) (:domain table))",
    ] {
        let read = goal(wrapped).unwrap();
        assert_eq!((read.slots, read.formula, read.text.as_str()), (0, on.clone(), wrapped));
    }
    let read = goal("(and (On o7 bin) (forall (?o - can) (exists (?p - place) (On ?o ?p))))").unwrap();
    assert_eq!(read.slots, 2);
    assert_eq!(
        read.formula,
        Formula::And(vec![
            is(ON, [c("o7"), c("bin")]),
            Formula::Forall(
                vec![var(0, 2, "?o")],
                Box::new(Formula::Exists(vec![var(1, PLACE, "?p")], Box::new(is(ON, [v(0), v(1)]))))
            ),
        ])
    );
}

#[test]
fn sound_goals_are_not_refused() {
    for text in [
        "()",
        "(and)",
        "(and (On o1 tray) (not (On o7 tray)))",
        "(or (and (HandEmpty) (not (HandEmpty))) (On o1 tray))",
        "(and (or (On o1 tray) (On o1 bin)) (not (On o1 tray)))",
        "(not (and (On o1 tray) (not (On o1 tray))))",
        "(and (imply (On o1 tray) (On o7 tray)) (On o1 tray))",
        "(not (= o1 o7))",
        "(and (= o1 o1) (not (= tray bin)))",
        "(exists (?a ?b - item) (and (On ?a tray) (not (On ?b tray))))",
        "(forall (?a - item) (or (= ?a o1) (not (On ?a tray))))",
        // Grasps come out of streams: none is known, yet there may be one.
        "(exists (?g - grasp) (InHand o1 ?g))",
        "(exists (?x) (and (Moved ?x) (not (= ?x o1)) (not (= ?x o7)) (not (= ?x b1))))",
        "(and (not (Moved o1)) (not (Moved o7)) (not (Moved b1)) (exists (?x) (Moved ?x)))",
        "(not (forall (?g - grasp) (not (InHand o1 ?g))))",
    ] {
        assert_eq!(goal(text).unwrap().text, text);
    }
}

#[test]
fn goals_that_contradict_themselves() {
    for (text, place, words) in [
        (
            "(and (On o7 tray) (HandEmpty) (not (On o7 tray)))",
            (1, 36),
            &["g.pddl:1:36: the goal contradicts itself: `(not (On o7 tray))` here and `(On o7 tray)` at 1:6"][..],
        ),
        ("(and (not (HandEmpty))\n (HandEmpty))", (2, 2), &["`(HandEmpty)` here and `(not (HandEmpty))` at 1:11"]),
        ("(= o1 o7)", (1, 1), &["`(= o1 o7)`, which never holds", "different things"]),
        ("(and (On o7 tray) (not (= o1 o1)))", (1, 24), &["`(not (= o1 o1))`, which never holds"]),
        ("(imply (= o1 o1) (not (= o1 o1)))", (1, 8), &["every alternative"]),
        (
            "(or (and (On o1 tray) (not (On o1 tray))) (and (On o7 bin) (not (On o7 bin))))",
            (1, 28),
            &[
                "every alternative of the goal contradicts itself",
                "the first by `(not (On o1 tray))` here and `(On o1 tray)` at 1:10",
            ],
        ),
        ("(and (or (On o1 tray) (On o7 tray)) (not (On o1 tray)) (not (On o7 tray)))", (1, 42), &["every alternative"]),
        ("(and (forall (?o - item) (On ?o tray)) (not (On b1 tray)))", (1, 45), &["`(On b1 tray)` at 1:26"]),
        ("(and (exists (?o - can) (On ?o tray)) (not (On o1 tray)) (not (On o7 tray)))", (1, 44), &["every"]),
        ("(forall (?a ?b - can) (= ?a ?b))", (1, 23), &["`(= o7 o1)`, which never holds"]),
        ("(and (imply (On o1 bin) (On o7 bin)) (On o1 bin) (not (On o7 bin)))", (1, 38), &["every"]),
        ("(or)", (1, 1), &["the goal never holds"]),
        ("(not ())", (1, 1), &["the goal never holds"]),
    ] {
        refused(goal(text), place, words);
    }
}

#[test]
fn large_goals_are_settled_soon() {
    // 2¹⁰⁰ alternatives, of which none holds.
    let many: String = (0..100).map(|i| format!("(or (Moved o{}) (On o7 tray))", 1 + 6 * (i % 2))).collect();
    refused(goal(&format!("(and {many} (not (Moved o1)) (not (Moved o7)) (not (On o7 tray)))")), (1, 2812), &["every"]);
    // Ten things on nine others, no two on the same: too many to try.
    let domain = domain(TABLE).unwrap();
    let item = |name: String| Constant { name, of: TypeId(ITEM) };
    let place = |name: String| Constant { name, of: TypeId(PLACE) };
    let items = (0..10).map(|i| item(format!("i{i}")));
    let known: Vec<Constant> = items.chain((1..9).map(|i| place(format!("p{i}")))).collect();
    let text = "(and (forall (?i - item) (exists (?p - place) (On ?i ?p)))
        (forall (?i ?j - item ?p - place) (or (= ?i ?j) (not (On ?i ?p)) (not (On ?j ?p)))))";
    assert!(Goal::read(Path::new("g.pddl"), text, &domain, &known).is_ok());
    // Three on two are few enough.
    let known: Vec<Constant> = known.into_iter().skip(7).take(4).collect();
    let error = Goal::read(Path::new("g.pddl"), text, &domain, &known).unwrap_err();
    assert!(error.found().contains("every alternative of the goal contradicts itself"), "{error}");
    let variables: String = (0..24).map(|i| format!("?x{i} ")).collect();
    goal(&format!("(forall ({variables}) (and (Moved ?x0) (not (Moved ?x0))))")).unwrap();
    let nested: String = (0..90).map(|i| format!("(forall (?x{i}) ")).collect();
    goal(&format!("{nested} (Moved ?x0) {}", ")".repeat(90))).unwrap();
}

#[test]
fn effects_are_not_copied_without_end() {
    let many = "(Moved ?x)".repeat(1000);
    let effect = format!("(when (and {many}) (and {many}))");
    let text = format!("(define (domain d) (:predicates (Moved ?x)) (:action a :parameters (?x) :effect {effect}))");
    assert!(domain(&text).unwrap_err().to_string().contains("too many effects"));
}

#[test]
fn parentheses_that_do_not_match() {
    refused(domain(""), (1, 1), &["nothing but space"]);
    refused(domain(" ; a comment"), (1, 1), &["nothing but space"]);
    refused(
        domain("(define (domain d)\n  (:types a b)"),
        (1, 1),
        &["`(define` is not closed", "ends at 2:15, where 1 list is open"],
    );
    refused(domain("(define (domain d)\n  (:types a b"), (2, 3), &["`(:types` is not closed", "2 lists are open"]);
    let unclosed = "(define (domain d)\n (:action a :parameters ()\n (:action b :parameters ()))";
    refused(domain(unclosed), (2, 2), &["`(:action` is not closed", "`)` before `(:action` at 3:2"]);
    refused(domain("(define (domain d)))"), (1, 20), &["`)` closes nothing", "one too many"]);
    refused(domain(")"), (1, 1), &["`)` closes nothing"]);
    refused(domain("(define (domain d))\n (:types a)"), (2, 2), &["`(` after the end of what begins at 1:1"]);
    refused(domain("(define (domain d)) x"), (1, 21), &["`x` after the end"]);
    refused(goal("(On o7 tray) (On o1 tray)"), (1, 14), &["after the end"]);
    refused(domain("(define (domain d) \u{0})"), (1, 20), &["U+0000"]);
    refused(domain("(define (domain é\u{a0}d))"), (1, 18), &["U+00A0"]);
    refused(domain("(define (domain \"d\"))"), (1, 17), &["the character `\"`"]);
    refused(domain(&"(".repeat(200_000)), (1, 101), &["more than 100 lists within each other"]);
    refused(domain(&format!("{}{}", "(".repeat(200_000), ")".repeat(200_000))), (1, 101), &["more than 100"]);
    refused(goal(&"(not ".repeat(200_000)), (1, 501), &["more than 100"]);
    assert!(domain(&format!("({})", "()".repeat(500_000))).unwrap_err().to_string().contains("more than 200000"));
}

/// One line of the sound domain for another.
fn with(text: &str, old: &str, new: &str) -> String {
    assert_eq!(text.matches(old).count(), 1, "{old}");
    text.replace(old, new)
}

#[test]
fn what_is_wrong_with_a_domain() {
    let start = "(define (domain d) (:types item place - thing) (:constants bin - place) (:predicates (On ?i - item ?p - place) (Free))\n";
    for (text, place, words) in [
        // Sections and what they declare.
        (
            "(:requirements :typing :adlx))",
            (2, 24),
            &["unknown requirement `:adlx`", "`:strips`", "did you mean `:adl`?"][..],
        ),
        (
            "(:requirements :durative-actions))",
            (2, 16),
            &["unknown requirement `:durative-actions`", "one of `:strips`"],
        ),
        ("(:functions (total-cost)))", (2, 2), &["`:functions` is not supported", "costs"]),
        ("(:durative-action move))", (2, 2), &["`:durative-action` is not supported", "`(:action …)`"]),
        ("(:actoin a))", (2, 2), &["unknown keyword `:actoin`", "did you mean `:action`?"]),
        (":action a)", (2, 1), &["`:action`", "a list that begins with"]),
        ("(:types a))", (2, 1), &["the section `:types` is given twice", "1:20"]),
        // Actions.
        ("(:action))", (2, 1), &["without a name"]),
        ("(:action ?a))", (2, 10), &["`?a`", "begins with a letter"]),
        ("(:action a)(:action a))", (2, 21), &["the action `a` is given twice", "2:10"]),
        ("(:action a :effects (Free)))", (2, 12), &["unknown keyword `:effects`", "did you mean `:effect`?"]),
        ("(:action a :effect :parameters ()))", (2, 12), &["`:effect` without a value"]),
        ("(:action a :effect (Free) :effect (Free)))", (2, 27), &["`:effect` is given twice"]),
        ("(:action a :duration 3))", (2, 12), &["`:duration` is not supported"]),
        ("(:action a :parameters ?x))", (2, 24), &["`?x`", "variables in parentheses"]),
        // Variables and types.
        ("(:action a :parameters (x)))", (2, 25), &["`x`, expected a variable", "write `?x`"]),
        ("(:action a :parameters (?x ?y ?x)))", (2, 31), &["`?x` is given twice"]),
        ("(:action a :parameters (?x - itme)))", (2, 30), &["unknown type `itme`", "did you mean `item`?"]),
        ("(:action a :parameters (?x -item)))", (2, 28), &["put a space after the `-`"]),
        ("(:action a :parameters (?x -)))", (2, 28), &["no type after `-`"]),
        ("(:action a :parameters (- item)))", (2, 25), &["`-` with no name before it"]),
        ("(:action a :parameters (?x - (either item place))))", (2, 30), &["`either` is not supported"]),
        // Formulas.
        ("(:action a :precondition Free))", (2, 26), &["a formula in parentheses", "did you mean `(Free)`?"]),
        (
            "(:action a :precondition (free)))",
            (2, 27),
            &["unknown predicate `free`, expected one of `On`, `Free`", "`Free`?"],
        ),
        ("(:action a :precondition (On bin)))", (2, 26), &["`On` has 1 argument, expected 2"]),
        ("(:action a :parameters (?x) :precondition (On ?x ?y)))", (2, 50), &["unknown variable `?y`", "`?x`"]),
        ("(:action a :precondition (On ?i bin)))", (2, 30), &["unknown variable `?i`"]),
        (
            "(:action a :parameters (?x) :precondition (On x bin)))",
            (2, 47),
            &["unknown name `x`", "did you mean `?x`?"],
        ),
        (
            "(:action a :parameters (?x) :precondition (On ?x bim)))",
            (2, 50),
            &["unknown name `bim`", "did you mean `bin`?"],
        ),
        (
            "(:action a :precondition (On bin bin)))",
            (2, 30),
            &["`bin` is of type `place`, expected one of type `item`, as argument 1 of `On`"],
        ),
        ("(:action a :parameters (?p - place) :precondition (On ?p ?p)))", (2, 55), &["`?p` is of type `place`"]),
        ("(:action a :precondition (not (Free) (Free))))", (2, 26), &["`not` has 2 arguments, expected 1"]),
        ("(:action a :precondition (imply (Free))))", (2, 26), &["`imply` has 1 argument, expected 2"]),
        ("(:action a :precondition (= bin)))", (2, 26), &["`=` has 1 argument, expected 2"]),
        ("(:action a :precondition (= bin (f bin))))", (2, 33), &["functions are not supported"]),
        ("(:action a :precondition (exists ?x (Free))))", (2, 34), &["variables in parentheses"]),
        ("(:action a :precondition (exists (?x))))", (2, 26), &["`exists` of 1 parts"]),
        ("(:action a :precondition (and (exists (?x) (Free)) (On ?x bin))))", (2, 56), &["unknown variable `?x`"]),
        ("(:action a :precondition (>= (cost) 3)))", (2, 27), &["`>=` is not supported"]),
        ("(:action a :precondition (when (Free) (Free))))", (2, 27), &["`(imply a b)`"]),
        ("(:action a :precondition ((Free) (Free))))", (2, 27), &["the name of a predicate", "`(and …)`"]),
        (
            "(:action a :precondition (and (Free) (:effect (Free)))))",
            (2, 39),
            &["`:effect` within a formula", "missing before it"],
        ),
        // Effects.
        ("(:action a :effect Free))", (2, 20), &["an effect in parentheses", "`(Free)`?"]),
        ("(:action a :effect (or (Free) (Free))))", (2, 20), &["`or` cannot be an effect"]),
        ("(:action a :effect (not (not (Free)))))", (2, 25), &["`not` cannot be an effect here, expected an atom"]),
        ("(:action a :effect (= bin bin)))", (2, 20), &["`=` cannot be an effect"]),
        ("(:action a :effect (and (increase (total-cost) 1))))", (2, 25), &["`increase` is not supported"]),
        ("(:action a :effect (when (Free))))", (2, 20), &["`(when condition effect)`"]),
        (
            "(:action a :effect (and (Free) (not (Free)))))",
            (2, 37),
            &["this deletes the atom of `Free` that 2:25 adds"],
        ),
        (
            "(:action a :parameters (?i) :effect (forall (?p - place) (and (not (On ?i ?p)) (On ?i ?p)))))",
            (2, 80),
            &["this adds the atom of `On` that 2:68 deletes"],
        ),
        // Derived predicates.
        ("(:derived (Free)))", (2, 1), &["`:derived` of 1 parts"]),
        ("(:derived Free (and)))", (2, 11), &["`(predicate ?a - type …)`"]),
        ("(:derived (Fre) (and)))", (2, 11), &["unknown predicate `Fre`", "`Free`?"]),
        ("(:derived (Free ?x) (and)))", (2, 11), &["`Free` has 1 argument, expected 0"]),
        (
            "(:derived (Free) (and)) (:derived (Free) (or)))",
            (2, 35),
            &["derived predicate `Free` is given twice", "2:11"],
        ),
        ("(:derived (On ?i - place ?p) (and)))", (2, 15), &["`?i` is of type `place`, expected one of type `item`"]),
        ("(:derived (Free) (and)) (:action a :effect (Free)))", (2, 44), &["`Free` is derived", "no action"]),
        ("(:derived (Free) (not (Free))))", (2, 11), &["derived from itself: `Free` from `Free`"]),
        ("(:derived (Free) (On ?x bin)))", (2, 22), &["unknown variable `?x`"]),
        (
            "(:derived (Free) (exists (?x) (On ?x bin)))\n(:derived (On ?i ?p) (and (= ?p bin) (not (Free)))))",
            (2, 11),
            &["derived from itself: `Free` from `On` from `Free`"],
        ),
    ] {
        refused(domain(&format!("{start}{text}")), place, words);
    }
}

#[test]
fn what_is_wrong_with_declarations() {
    for (text, place, words) in [
        ("(domain d)", (1, 1), &["`(domain d)`", "`(define (domain name) …)`"][..]),
        ("define", (1, 1), &["`define`"]),
        ("(define (problem p) (:domain d))", (1, 9), &["this defines `problem`", "is this the right file?"]),
        ("(define (domain))", (1, 9), &["`(define (domain name) …)`"]),
        ("(define (domain 7))", (1, 17), &["`7`", "begins with a letter"]),
        ("(define (domain d) (:types a b a))", (1, 32), &["the type `a` is given twice", "1:28"]),
        ("(define (domain d) (:types a - b b - c c - a))", (1, 28), &["a circle of types: `a` - `b` - `c` - `a`"]),
        ("(define (domain d) (:types e - a a - a))", (1, 34), &["a circle of types: `a` - `a`"]),
        ("(define (domain d) (:types object - a))", (1, 37), &["a parent of `object`"]),
        ("(define (domain d) (:types a - (either b c)))", (1, 32), &["`either` is not supported"]),
        ("(define (domain d) (:constants a b - t))", (1, 38), &["unknown type `t`"]),
        ("(define (domain d) (:constants a b a))", (1, 36), &["the constant `a` is given twice"]),
        ("(define (domain d) (:constants ?a))", (1, 32), &["`?a`", "the name of a constant"]),
        ("(define (domain d) (:predicates p))", (1, 33), &["`p`", "`(predicate ?a - type …)`"]),
        ("(define (domain d) (:predicates (p) (p ?x)))", (1, 38), &["the predicate `p` is given twice"]),
        ("(define (domain d) (:predicates (p ?x ?x)))", (1, 39), &["`?x` is given twice"]),
        ("(define (domain d) (:predicates (= ?x ?y)))", (1, 34), &["`=` is no name", "leave it out"]),
        ("(define (domain d) (:predicates (Not ?x)))", (1, 34), &["`not` is no name"]),
        ("(define (domain d) (:predicates (p ?)))", (1, 36), &["`?`", "a variable"]),
    ] {
        refused(domain(text), place, words);
    }
    let many: String = (0..2000).map(|i| format!("t{i} ")).collect();
    assert!(
        domain(&format!("(define (domain d) (:types {many}))")).unwrap_err().to_string().contains("too many types")
    );
    // A long chain of what is derived from what.
    let names: String = (0..20_000).map(|i| format!("(p{i})")).collect();
    let chain: String = (1..20_000).map(|i| format!("(:derived (p{}) (p{i}))", i - 1)).collect();
    let chain = format!("(define (domain d) (:predicates {names}) {chain}");
    assert_eq!(domain(&format!("{chain})")).unwrap().derived.len(), 19_999);
    refused(
        domain(&format!("{chain}\n(:derived (p19999) (p0)))")),
        (1, chain.find("(p0) (p1)").unwrap() + 1),
        &["itself"],
    );
}

#[test]
fn what_is_wrong_with_streams() {
    for (text, place, words) in [
        ("(define (domain table))", (1, 9), &["this defines `domain`", "`(define (stream name) …)`"][..]),
        ("(define (stream s) (:rule r))", (1, 21), &["`:rule` is not supported"]),
        ("(define (stream s) (:steam x))", (1, 21), &["unknown keyword `:steam`", "`:stream`"]),
        ("(define (stream s) (:stream))", (1, 20), &["without a name"]),
        (
            "(define (stream s) (:stream sample-grap :inputs (?o)))",
            (1, 29),
            &[
                "unknown stream `sample-grap`, expected one of `sample-grasp`, `sample-pose`",
                "did you mean `sample-grasp`?",
            ],
        ),
        ("(define (stream s) (:stream test-clear :inputs (?a)))", (1, 48), &["with 1 input, expected 2"]),
        ("(define (stream s) (:stream test-clear))", (1, 29), &["with 0 inputs, expected 2"]),
        (
            "(define (stream s) (:stream test-clear :inputs (?a ?b) :outputs (?c)))",
            (1, 65),
            &["with 1 output, expected 0"],
        ),
        ("(define (stream s) (:stream test-clear :in (?a ?b)))", (1, 40), &["unknown keyword `:in`"]),
        ("(define (stream s) (:stream test-clear :inputs (?a ?a)))", (1, 52), &["`?a` is given twice"]),
        (
            "(define (stream s) (:stream sample-grasp :inputs (?a) :outputs (?a)))",
            (1, 65),
            &["`?a` is an input already"],
        ),
        (
            "(define (stream s)\n(:stream test-clear :inputs (?a ?b))\n(:stream test-clear :inputs (?a ?b)))",
            (3, 10),
            &["the stream `test-clear` is given twice", "2:10"],
        ),
        (
            "(define (stream s) (:stream sample-grasp :inputs (?o) :domain (Items ?o) :outputs (?g)))",
            (1, 64),
            &["`Item`?"],
        ),
        (
            "(define (stream s) (:stream sample-grasp :inputs (?o) :domain (Item ?g) :outputs (?g)))",
            (1, 69),
            &["unknown variable"],
        ),
        (
            "(define (stream s) (:stream sample-grasp :inputs (?o) :domain (not (Item ?o))))",
            (1, 63),
            &["`not` in what", "atoms"],
        ),
        (
            "(define (stream s) (:stream sample-grasp :inputs (?o) :domain (and Item)))",
            (1, 68),
            &["an atom in parentheses"],
        ),
        (
            "(define (stream s) (:stream sample-grasp :inputs (?o - place) :domain (Item ?o)))",
            (1, 77),
            &["of type `place`"],
        ),
        (
            "(define (stream s) (:stream sample-grasp :inputs (?o) :domain (and (Item ?o) (Free ?o))))",
            (1, 84),
            &["`?o` is of type `item`, expected one of type `place`"],
        ),
        (
            "(define (stream s) (:stream sample-grasp :inputs (?o) :outputs (?g) :certified (InHand ?o ?g)))",
            (1, 80),
            &["`InHand` is changed by the action `pick`", "must not be changed by actions"],
        ),
        (
            "(define (stream s) (:stream sample-grasp :inputs (?o) :outputs (?g) :certified (Safe ?g)))",
            (1, 80),
            &["`Safe` is derived"],
        ),
        (
            "(define (stream s) (:stream sample-grasp :inputs (?o) :outputs (?g) :fluents (AtPos)))",
            (1, 79),
            &["unknown predicate `AtPos`", "did you mean `AtPose`?"],
        ),
        ("(define (stream s) (:stream sample-grasp :inputs (?o) :outputs (?g) :fluents (On On)))", (1, 82), &["twice"]),
    ] {
        refused(streams(text), place, words);
    }
    refused(
        streams(&with(STREAMS, "(Item ?o) (and)", "(Item ?o ?p)")),
        (8, 18),
        &["`Item` has 2 arguments, expected 1"],
    );
}

#[test]
fn what_is_wrong_with_goals() {
    for (text, place, words) in [
        ("HandEmpty", (1, 1), &["a formula in parentheses", "`(HandEmpty)`?"][..]),
        ("(On o8 tray)", (1, 5), &["unknown name `o8`, expected one of `o1`, `o7`", "did you mean `o1`?"]),
        ("(On o7 try)", (1, 8), &["did you mean `tray`?"]),
        ("(On tray o7)", (1, 5), &["`tray` is of type `place`, expected one of type `item`"]),
        ("(On ?o tray)", (1, 5), &["unknown variable `?o`"]),
        ("(:goal)", (1, 1), &["no formula"]),
        ("(:goal (HandEmpty) (Free tray))", (1, 20), &["a second formula", "join them"]),
        ("(define (problem p) (:domain table))", (1, 1), &["without its goal"]),
        ("(define (problem p) (:goal (HandEmpty)))", (1, 1), &["without its domain", "`(:domain table)`"]),
        ("(define (problem p) (:domain desk) (:goal (HandEmpty)))", (1, 30), &["the domain `desk`, expected `table`"]),
        (
            "(define (problem p) (:domain table) (:objects o7))",
            (1, 37),
            &["`:objects` in a goal", "the scene file gives"],
        ),
        (
            "(define (problem p) (:domain table) (:init (HandEmpty)))",
            (1, 37),
            &["`:init` in a goal", "the scene file gives"],
        ),
        ("(define (problem p) (:domain table) (:metric minimize))", (1, 38), &["`:metric` is not supported"]),
        ("(define (problem p) (:domain table) (:goal (and)) (:goal (and)))", (1, 51), &["`:goal` is given twice"]),
        ("(define (domain table))", (1, 9), &["this defines `domain`", "`(define (problem name) …)`"]),
    ] {
        refused(goal(text), place, words);
    }
}

/// A text with some pieces of it taken out, doubled or replaced.
fn mutated(text: &str, edits: &[(prop::sample::Index, u8, char)]) -> String {
    let mut all: Vec<char> = text.chars().collect();
    for (at, kind, c) in edits {
        let at = at.index(all.len());
        match kind {
            0 => _ = all.remove(at),
            1 => all.insert(at, *c),
            2 => all[at] = *c,
            3 => all.truncate(at),
            _ => {
                let end = (at + 40).min(all.len());
                all.extend_from_within(at..end);
            }
        }
        if all.is_empty() {
            all.push(*c);
        }
    }
    all.into_iter().collect()
}

fn edits() -> impl Strategy<Value = Vec<(prop::sample::Index, u8, char)>> {
    let c = prop_oneof![4 => prop::sample::select(vec!['(', ')', '?', '-', ':', ' ', '\n', ';', 'a', '=']), 1 => any::<char>()];
    let kind = prop_oneof![10 => 0..3_u8, 1 => 3..5_u8];
    prop::collection::vec((any::<prop::sample::Index>(), kind, c), 1..6)
}

/// Lines are those of the text.
fn told_in(text: &str, error: &FileError) {
    let (line, column) = error.position().unwrap();
    assert!(line >= 1 && column >= 1 && line <= text.matches('\n').count() + 1, "{error}");
}

proptest! {
    #[test]
    fn any_text_is_read_or_refused(text in any::<String>(), near in "[()?:;=a-c \n-]{0,60}") {
        for text in [text, near] {
            domain(&text).map_or_else(|e| told_in(&text, &e), drop);
            streams(&text).map_or_else(|e| told_in(&text, &e), drop);
            goal(&text).map_or_else(|e| told_in(&text, &e), drop);
        }
    }

    #[test]
    fn any_slip_is_read_or_refused(edits in edits()) {
        let text = mutated(TABLE, &edits);
        domain(&text).map_or_else(|e| told_in(&text, &e), drop);
        let text = mutated(STREAMS, &edits);
        streams(&text).map_or_else(|e| told_in(&text, &e), drop);
        let wanted = "(define (problem p) (:domain table) (:goal (and (On o7 tray) (forall (?o - item) (imply (On ?o tray) (or (= ?o o7) (Moved ?o)))))))";
        let text = mutated(wanted, &edits);
        goal(&text).map_or_else(|e| told_in(&text, &e), drop);
    }
}
