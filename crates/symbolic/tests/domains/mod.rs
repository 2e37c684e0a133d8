//! Small domains drawn at random, written as PDDL.

use clearway_symbolic::facts::{Fact, Values};
use clearway_symbolic::pddl::{Constant, Domain, Goal, PredicateId};
use rand::{RngExt, SeedableRng};
use rand_xoshiro::Xoshiro256PlusPlus;
use std::fmt::Write;
use std::path::Path;

const HEAD: &str = "(define (domain drawn)
  (:requirements :adl :derived-predicates)
  (:types thing spot - object  box ball - thing)
  (:constants b1 - box  l1 - ball  s1 - spot)
  (:predicates (At ?t - thing ?s - spot) (Full ?s - spot) (Hot ?t - thing) (Idle)
    (Link ?a ?b - spot) (Heavy ?b - box) (Fits ?t - thing ?s - spot) (Dry ?s - spot)
    (Empty ?s - spot) (Calm ?t - thing))";

/// By number of predicate; those from `FITS` on are tested, from `EMPTY` on derived.
const PARAMETERS: [(&str, &[&str]); 10] = [
    ("At", &["thing", "spot"]),
    ("Full", &["spot"]),
    ("Hot", &["thing"]),
    ("Idle", &[]),
    ("Link", &["spot", "spot"]),
    ("Heavy", &["box"]),
    ("Fits", &["thing", "spot"]),
    ("Dry", &["spot"]),
    ("Empty", &["spot"]),
    ("Calm", &["thing"]),
];
const CHANGED: usize = 4;
const FITS: usize = 6;
pub const TESTED: [PredicateId; 2] = [PredicateId(FITS), PredicateId(FITS + 1)];
const EMPTY: usize = 8;

const OBJECTS: [(&str, &str); 5] = [("b1", "box"), ("b2", "box"), ("l1", "ball"), ("s1", "spot"), ("s2", "spot")];
const TYPES: [&str; 5] = ["thing", "spot", "box", "ball", "object"];

fn is(what: &str, wanted: &str) -> bool {
    what == wanted || wanted == "object" || wanted == "thing" && (what == "box" || what == "ball")
}

/// A domain, what there is, and a goal.
pub struct Drawn {
    pub text: String,
    pub domain: Domain,
    pub values: Values,
    pub goal: Goal,
    /// All facts of the right types, those of derived predicates left out.
    pub possible: Vec<Fact>,
}

/// What atoms may be about, with types.
type Scope = Vec<(String, &'static str)>;

pub struct Draw {
    random: Xoshiro256PlusPlus,
    names: usize,
}

impl Draw {
    pub fn new(seed: u64) -> Self {
        Self { random: Xoshiro256PlusPlus::seed_from_u64(seed), names: 0 }
    }

    pub fn below(&mut self, end: usize) -> usize {
        self.random.random_range(0..end)
    }

    pub fn one<'t, T>(&mut self, of: &'t [T]) -> &'t T {
        &of[self.below(of.len())]
    }

    pub fn in_ten(&mut self, times: usize) -> bool {
        self.below(10) < times
    }

    /// Draws until what was drawn can be read: goals, and effects, must not contradict themselves.
    pub fn domain(&mut self) -> Drawn {
        loop {
            let text = self.text();
            let Ok(domain) = Domain::read(Path::new("drawn"), &text) else { continue };
            let known =
                OBJECTS.map(|(name, of)| Constant { name: name.to_owned(), of: domain.types.named(of).unwrap() });
            let goal = self.formula(2, &mut constants(), true);
            let Ok(goal) = Goal::read(Path::new("goal"), &goal, &domain, &known) else { continue };
            let mut values = Values::default();
            known.iter().for_each(|c| {
                values.add(&c.name, c.of);
            });
            let possible = possible(&domain, &values);
            return Drawn { text, domain, values, goal, possible };
        }
    }

    fn text(&mut self) -> String {
        let mut text = HEAD.to_owned();
        for (name, of) in &PARAMETERS[EMPTY..] {
            let mut scope = constants();
            scope.push(("?d".to_owned(), of[0]));
            let body = self.formula(2, &mut scope, false);
            let _ = write!(text, "\n  (:derived ({name} ?d - {}) {body})", of[0]);
        }
        for action in 0..4 {
            let mut scope = constants();
            let mut parameters = String::new();
            for parameter in 0..self.below(3) {
                let of = *self.one(&TYPES[..4]);
                let _ = write!(parameters, " ?p{parameter} - {of}");
                scope.push((format!("?p{parameter}"), of));
            }
            let depth = self.below(3);
            let needs = if self.in_ten(1) { "()".to_owned() } else { self.formula(depth, &mut scope, true) };
            let effects: Vec<String> = (0..2 + self.below(2)).map(|_| self.effect(&mut scope)).collect();
            let effects = effects.join(" ");
            let _ = write!(
                text,
                "\n  (:action a{action} :parameters ({parameters}) :precondition {needs} :effect (and {effects}))"
            );
        }
        text + ")"
    }

    /// With new variables in scope: how they are declared, and what comes of `inside`.
    fn quantified(&mut self, scope: &mut Scope, inside: impl FnOnce(&mut Self, &mut Scope) -> String) -> String {
        let outside = scope.clone();
        let mut declared = String::new();
        for _ in 0..if self.in_ten(2) { 2 } else { 1 } {
            let of = *self.one(&TYPES);
            // Now and then a name that is in use: it then means the inner variable.
            let used = self.one(scope).0.clone();
            let hides = self.in_ten(2) && used.starts_with('?') && !declared.contains(&used);
            self.names += 1;
            let name = if hides { used } else { format!("?v{}", self.names) };
            let _ = write!(declared, " {name} - {of}");
            scope.retain(|(known, _)| *known != name);
            scope.push((name, of));
        }
        let body = inside(self, scope);
        *scope = outside;
        format!("({declared}) {body}")
    }

    fn formula(&mut self, depth: usize, scope: &mut Scope, derived: bool) -> String {
        let inner = |draw: &mut Self, scope: &mut Scope| draw.formula(depth - 1, scope, derived);
        match if depth == 0 { 0 } else { self.below(10) } {
            0..4 => self.literal(scope, derived),
            4 => format!("(not {})", inner(self, scope)),
            5 => format!("(and {} {})", inner(self, scope), inner(self, scope)),
            6 => format!("(or {} {})", inner(self, scope), inner(self, scope)),
            7 => format!("(imply {} {})", inner(self, scope), inner(self, scope)),
            8 => format!("(forall {})", self.quantified(scope, inner)),
            _ => format!("(exists {})", self.quantified(scope, inner)),
        }
    }

    fn literal(&mut self, scope: &Scope, derived: bool) -> String {
        let atom = match self.in_ten(1) {
            true => format!("(= {} {})", self.one(scope).0, self.one(scope).0),
            false => {
                let (name, of) = PARAMETERS[self.below(if derived { PARAMETERS.len() } else { EMPTY })];
                self.atom(name, of, scope)
            }
        };
        if self.in_ten(3) { format!("(not {atom})") } else { atom }
    }

    /// Of a thing it may be asked what is asked of boxes alone; what is derived is asked only of what it is for.
    fn atom(&mut self, name: &str, of: &[&str], scope: &Scope) -> String {
        let strict = PARAMETERS[EMPTY..].iter().any(|(derived, _)| *derived == name);
        let mut atom = format!("({name}");
        for wanted in of {
            let fits = |what: &str| is(what, wanted) || !strict && is(wanted, what);
            let fitting: Vec<&String> = scope.iter().filter(|(_, what)| fits(what)).map(|(name, _)| name).collect();
            // What is quantified or a parameter rather than a constant.
            let newest = fitting.len() - if self.in_ten(7) { 1 } else { 1 + self.below(fitting.len()) };
            let _ = write!(atom, " {}", fitting[newest]);
        }
        atom + ")"
    }

    fn effect(&mut self, scope: &mut Scope) -> String {
        let simple = |draw: &mut Self, scope: &mut Scope| {
            let (name, of) = PARAMETERS[draw.below(CHANGED)];
            let atom = draw.atom(name, of, scope);
            if draw.in_ten(5) { format!("(not {atom})") } else { atom }
        };
        let conditional = |draw: &mut Self, scope: &mut Scope| {
            let condition = draw.formula(1, scope, true);
            format!("(when {condition} {})", simple(draw, scope))
        };
        match self.below(10) {
            0..6 => simple(self, scope),
            6..8 => conditional(self, scope),
            8 => format!("(forall {})", self.quantified(scope, simple)),
            _ => format!("(forall {})", self.quantified(scope, conditional)),
        }
    }
}

fn constants() -> Scope {
    [("b1", "box"), ("l1", "ball"), ("s1", "spot")].map(|(name, of)| (name.to_owned(), of)).to_vec()
}

fn possible(domain: &Domain, values: &Values) -> Vec<Fact> {
    let mut all = Vec::new();
    for (predicate, declared) in domain.predicates.iter().enumerate().take(EMPTY) {
        let mut tuples = vec![Vec::new()];
        for of in &declared.parameters {
            let longer =
                |tuple: Vec<_>| values.all_of(&domain.types, *of).map(move |v| [tuple.clone(), vec![v]].concat());
            tuples = tuples.into_iter().flat_map(longer).collect();
        }
        all.extend(tuples.into_iter().map(|values| Fact { predicate: PredicateId(predicate), values }));
    }
    all
}
