//! Tasks without variables do what their domains mean: compared with an interpreter that tries everything.
#![allow(clippy::unwrap_used)]

mod domains;
mod naive;

use clearway_symbolic::facts::{Fact, Facts, Value, Values};
use clearway_symbolic::ground::{GroundAction, Grounder, Known, Task, TooManyAlternatives};
use clearway_symbolic::pddl::{Constant, Domain, Goal, PredicateId};
use domains::{Draw, Drawn, TESTED};
use naive::{Naive, State, Step, fluents};
use std::collections::{BTreeMap, BTreeSet, HashMap, HashSet};
use std::path::Path;

/// Static facts, and what tests would find.
#[derive(Clone, Default)]
struct Table {
    facts: Facts,
    tested: HashSet<PredicateId>,
    passes: HashSet<Fact>,
    asked: BTreeSet<Fact>,
}

impl Known for Table {
    fn facts(&self) -> &Facts {
        &self.facts
    }

    fn is_tested(&self, predicate: PredicateId) -> bool {
        self.tested.contains(&predicate)
    }

    fn test(&mut self, fact: &Fact, _: &Values) -> bool {
        assert!(self.is_tested(fact.predicate), "{fact:?} is not for tests");
        self.asked.insert(fact.clone());
        self.passes.contains(fact)
    }
}

impl Table {
    fn holds(&self, fact: &Fact) -> bool {
        self.facts.contains(fact) || self.passes.contains(fact)
    }
}

/// A drawn domain, with what holds at first.
struct Case {
    drawn: Drawn,
    table: Table,
    state: Vec<Fact>,
}

fn case(draw: &mut Draw) -> Case {
    let drawn = draw.domain();
    let changed = fluents(&drawn.domain);
    let mut table = Table { tested: TESTED.into(), ..Table::default() };
    let mut state = Vec::new();
    for fact in &drawn.possible {
        if !draw.in_ten(5) {
            continue;
        }
        if table.is_tested(fact.predicate) {
            table.passes.insert(fact.clone());
        } else if changed.contains(&fact.predicate) {
            state.push(fact.clone());
        } else {
            table.facts.insert(fact.clone());
        }
    }
    Case { drawn, table, state }
}

impl Case {
    fn task(&self) -> Result<Task, TooManyAlternatives> {
        let Drawn { domain, values, goal, .. } = &self.drawn;
        Grounder::new(domain).task(values, &self.state, &mut self.table.clone(), goal)
    }

    fn naively<T>(&self, asked: impl FnOnce(&Naive) -> T) -> T {
        let known = |fact: &Fact, _: &State| self.table.holds(fact);
        asked(&Naive { domain: &self.drawn.domain, values: &self.drawn.values, known: &known })
    }

    fn first(&self) -> State {
        self.state.iter().cloned().collect()
    }
}

/// Draws cases until `look` found something to compare in so many.
fn in_cases(seed: u64, enough: usize, mut look: impl FnMut(&mut Draw, &Case) -> bool) {
    let mut draw = Draw::new(seed);
    let mut looked = 0;
    for _ in 0..20 * enough {
        let case = case(&mut draw);
        looked += usize::from(look(&mut draw, &case));
        if looked == enough {
            return;
        }
    }
    panic!("only {looked} cases of {enough} had anything to compare");
}

/// What a task's actions lead to from a state, each with its action and values.
fn after(task: &Task, numbers: &HashMap<&Fact, usize>, state: &State) -> BTreeSet<(Step, State)> {
    let now: HashSet<usize> = state.iter().map(|fact| numbers[fact]).collect();
    let possible = task.actions.iter().filter(|a| task.holds(&now, &a.precondition));
    let told = |atoms: HashSet<usize>| atoms.into_iter().map(|a| task.atoms[a].clone()).collect();
    possible.map(|a| ((a.action, a.values.clone()), told(task.after(&now, a)))).collect()
}

#[test]
fn tasks_lead_where_their_domains_say_and_no_further() {
    in_cases(1, 300, |_, case| {
        let Ok(task) = case.task() else { return false };
        assert!(task.actions.iter().all(|a| a.deletes.iter().all(|d| !a.adds.contains(d))), "added and deleted");
        let numbers: HashMap<&Fact, usize> = task.atoms.iter().enumerate().map(|(i, f)| (f, i)).collect();
        case.naively(|naive| {
            let states = naive.reachable(&case.first(), 60);
            let steps = naive.all_steps();
            for state in &states {
                let by_definition: BTreeSet<(Step, State)> =
                    steps.iter().filter_map(|step| Some((step.clone(), naive.after(step, state)?))).collect();
                let text = &case.drawn.text;
                assert_eq!(after(&task, &numbers, state), by_definition, "from {state:?} in\n{text}");
                let now: HashSet<usize> = state.iter().map(|fact| numbers[fact]).collect();
                let met = task.goal.iter().any(|g| task.holds(&now, g));
                let goal = &case.drawn.goal;
                assert_eq!(met, naive.meets(goal, state), "{} in {state:?} in\n{text}", goal.text);
            }
            states.len() > 8
        })
    });
}

#[test]
fn sequences_are_done_exactly_when_their_domains_say() {
    let mut reached = BTreeMap::from([(true, 0), (false, 0)]);
    in_cases(2, 500, |draw, case| {
        let Drawn { domain, values, goal, text, .. } = &case.drawn;
        let grounder = Grounder::new(domain);
        case.naively(|naive| {
            let steps = naive.all_steps();
            for _ in 0..10 {
                let mut state = case.first();
                let mut sequence: Vec<Step> = Vec::new();
                for _ in 0..draw.below(5) {
                    // Mostly one that can be done.
                    let possible: Vec<&Step> = steps.iter().filter(|s| naive.after(s, &state).is_some()).collect();
                    let any = possible.is_empty() || draw.in_ten(1);
                    let step = if any { draw.one(&steps) } else { *draw.one(&possible) };
                    state = naive.after(step, &state).unwrap_or(state);
                    sequence.push(step.clone());
                }
                let does = grounder.does(&sequence, values, &case.state, &mut case.table.clone(), goal);
                let Ok(does) = does else { return false };
                assert_eq!(does, naive.does(&sequence, &case.first(), goal), "{sequence:?}, {} in\n{text}", goal.text);
                *reached.entry(does).or_default() += 1;
            }
            true
        })
    });
    assert!(reached.values().all(|n| *n > 300), "{reached:?}");
}

#[test]
fn without_what_it_relies_on_an_action_is_not() {
    in_cases(3, 60, |_, case| {
        let Ok(task) = case.task() else { return false };
        let mut looked = false;
        for action in task.actions.iter().take(20) {
            for needed in action.relies_on.iter().filter(|f| case.table.facts.contains(f)) {
                let mut without = Table { facts: Facts::default(), ..case.table.clone() };
                case.table.facts.iter().filter(|f| *f != needed).for_each(|f| {
                    without.facts.insert(f.clone());
                });
                let Drawn { domain, values, goal, text, .. } = &case.drawn;
                let Ok(less) = Grounder::new(domain).task(values, &case.state, &mut without, goal) else { continue };
                let same = |other: &&GroundAction| (other.action, &other.values) == (action.action, &action.values);
                assert_eq!(less.actions.iter().find(same), None, "without {needed:?} in\n{text}");
                looked = true;
            }
        }
        looked
    });
}

const BLOCKS: &str = "(define (domain blocks)
  (:types block - object)
  (:predicates (On ?a ?b - block) (OnTable ?a - block) (Held ?a - block) (HandEmpty) (Clear ?a - block) (Light ?a - block))
  (:derived (HandEmpty) (forall (?a - block) (not (Held ?a))))
  (:derived (Clear ?a - block) (and (not (Held ?a)) (not (exists (?b - block) (On ?b ?a)))))
  (:action take :parameters (?a - block)
    :precondition (and (Light ?a) (Clear ?a) (HandEmpty))
    :effect (and (Held ?a) (not (OnTable ?a)) (forall (?b - block) (when (On ?a ?b) (not (On ?a ?b))))))
  (:action put-down :parameters (?a - block) :precondition (Held ?a) :effect (and (OnTable ?a) (not (Held ?a))))
  (:action stack :parameters (?a ?b - block)
    :precondition (and (Held ?a) (Clear ?b) (not (= ?a ?b)))
    :effect (and (On ?a ?b) (not (Held ?a)))))";

/// So many blocks on a table, of which the first are light.
fn blocks(count: usize, light: usize, goal: &str) -> (Domain, Values, Vec<Fact>, Table, Goal) {
    let domain = Domain::read(Path::new("blocks"), BLOCKS).unwrap();
    let block = domain.types.named("block").unwrap();
    let mut values = Values::default();
    let all: Vec<Value> = (0..count).map(|i| values.add(&format!("b{i}"), block)).collect();
    let fact = |name: &str, value: Value| Fact { predicate: domain.predicate(name).unwrap(), values: vec![value] };
    let mut table = Table::default();
    all.iter().take(light).for_each(|v| {
        table.facts.insert(fact("Light", *v));
    });
    let state = all.iter().map(|v| fact("OnTable", *v)).collect();
    let known: Vec<Constant> = (0..count).map(|i| Constant { name: format!("b{i}"), of: block }).collect();
    let goal = Goal::read(Path::new("goal"), goal, &domain, &known).unwrap();
    (domain, values, state, table, goal)
}

/// How many states can be reached.
fn states(task: &Task) -> usize {
    let mut seen = BTreeSet::from([task.init.iter().copied().collect::<BTreeSet<usize>>()]);
    let mut open: Vec<BTreeSet<usize>> = seen.iter().cloned().collect();
    while let Some(state) = open.pop() {
        let now: HashSet<usize> = state.iter().copied().collect();
        for action in task.actions.iter().filter(|a| task.holds(&now, &a.precondition)) {
            let after: BTreeSet<usize> = task.after(&now, action).into_iter().collect();
            if seen.insert(after.clone()) {
                open.push(after);
            }
        }
    }
    seen.len()
}

#[test]
fn blocks_can_stand_in_as_many_ways_as_is_known() {
    // Ways in which n things can be piled: 1, 3, 13, 73; with one of them in the hand, those of the others.
    for (count, expected) in [(1, 1 + 1), (2, 3 + 2), (3, 13 + 3 * 3), (4, 73 + 4 * 13)] {
        let (domain, values, state, mut table, goal) = blocks(count, count, "(OnTable b0)");
        let task = Grounder::new(&domain).task(&values, &state, &mut table, &goal).unwrap();
        assert_eq!(states(&task), expected, "{count} blocks");
    }
}

#[test]
fn static_facts_never_reach_the_task() {
    let (domain, values, state, mut table, goal) = blocks(3, 1, "(and (Light b0) (On b0 b1))");
    let task = Grounder::new(&domain).task(&values, &state, &mut table, &goal).unwrap();
    let light = domain.predicate("Light").unwrap();
    assert!(task.atoms.iter().all(|a| a.predicate != light));
    assert!(task.actions.iter().all(|a| a.values[0] == Value(0)), "only the first can be taken");
    assert_eq!(task.goal.len(), 1);
    assert_eq!(task.goal[0].len(), 1);
    // In the hand, on the table, on one of the others.
    assert_eq!(states(&task), 4);
    let (domain, values, state, mut table, goal) = blocks(3, 1, "(and (Light b1) (On b0 b1))");
    let task = Grounder::new(&domain).task(&values, &state, &mut table, &goal).unwrap();
    assert!(task.goal.is_empty(), "b1 is not light, and never will be");
}

#[test]
fn what_cannot_come_to_hold_is_no_goal_and_no_action() {
    let (domain, values, state, mut table, goal) = blocks(2, 0, "(or (On b0 b1) (not (Held b0)))");
    let task = Grounder::new(&domain).task(&values, &state, &mut table, &goal).unwrap();
    assert!(task.actions.is_empty());
    assert_eq!(task.goal, [[]], "nothing can be held");
}

#[test]
fn tests_are_asked_only_where_static_facts_leave_a_choice() {
    let text = "(define (domain d) (:types spot - object)
      (:predicates (Link ?a ?b - spot) (Dry ?s - spot) (At ?s - spot))
      (:action go :parameters (?a ?b - spot) :precondition (and (Dry ?b) (Link ?a ?b) (At ?a))
        :effect (and (At ?b) (not (At ?a)))))";
    let domain = Domain::read(Path::new("d"), text).unwrap();
    let spot = domain.types.named("spot").unwrap();
    let mut values = Values::default();
    let s: Vec<Value> = (0..5).map(|i| values.add(&format!("s{i}"), spot)).collect();
    let fact =
        |name: &str, values: &[Value]| Fact { predicate: domain.predicate(name).unwrap(), values: values.to_vec() };
    let dry = |s: Value| fact("Dry", &[s]);
    let mut table = Table { tested: [domain.predicate("Dry").unwrap()].into(), ..Table::default() };
    [(0, 1), (1, 2), (2, 3), (4, 0)].into_iter().for_each(|(a, b)| {
        table.facts.insert(fact("Link", &[s[a], s[b]]));
    });
    table.passes.insert(dry(s[1]));
    let goal = Goal::read(Path::new("g"), "(At s3)", &domain, &[Constant { name: "s3".to_owned(), of: spot }]).unwrap();
    let task = Grounder::new(&domain).task(&values, &[fact("At", &[s[0]])], &mut table, &goal).unwrap();
    // s2 is not dry: nobody comes to ask about s3; nobody comes to s4 to ask about s0.
    assert_eq!(table.asked, BTreeSet::from([dry(s[1]), dry(s[2])]));
    assert_eq!(task.actions.len(), 1);
    assert_eq!(task.actions[0].values, [s[0], s[1]]);
    assert!(task.goal.is_empty());
}

#[test]
fn too_many_alternatives_are_told_with_whose_they_are() {
    let either: Vec<String> = (0..10).map(|i| format!("(or (On b0 b{}) (OnTable b{}))", i % 3 + 1, i % 4)).collect();
    let (domain, values, state, mut table, goal) = blocks(4, 4, &format!("(and {})", either.join(" ")));
    let told = Grounder::new(&domain).task(&values, &state, &mut table, &goal);
    assert_eq!(told.unwrap_err(), TooManyAlternatives { of: "the goal".to_owned() });
    let wide = "(:action wide :parameters () :effect (Wide)
      :precondition (forall (?a ?b - block) (or (Held ?a) (On ?a ?b) (OnTable ?a))))";
    let text = BLOCKS.replace("(Light ?a - block))", "(Light ?a - block) (Wide))");
    let domain =
        Domain::read(Path::new("blocks"), &text.replace("(:action take", &format!("{wide} (:action take"))).unwrap();
    let (_, values, state, mut table, goal) = blocks(4, 4, "(OnTable b0)");
    let told = Grounder::new(&domain).task(&values, &state, &mut table, &goal);
    assert_eq!(told.unwrap_err(), TooManyAlternatives { of: "wide".to_owned() });
}
