//! Ferroplan against a search through every state.
#![allow(clippy::unwrap_used)]

mod tasks;

use clearway_plan::Budget;
use clearway_symbolic::engine::{Answer, Engine, Ferroplan};
use clearway_symbolic::ground::Task;
use std::collections::BTreeMap;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use tasks::{Draw, action, does, shortest, task, told};

const STATES: usize = 30_000;

fn solve(engine: &Ferroplan, task: &Task) -> Answer {
    engine.solve(task, STATES, &Budget::unlimited())
}

/// Compares the answer for a task with the truth; the length of the plan.
#[track_caller]
fn agree(engine: &Ferroplan, task: &Task) -> Option<usize> {
    let (plan, states) = shortest(task);
    match solve(engine, task) {
        Answer::Plan(found) => {
            assert!(does(task, &found), "{found:?} does not do in {}", told(task));
            let least = plan.unwrap().len();
            if states <= engine.optimal_nodes {
                assert_eq!(found.len(), least, "{found:?} in {}", told(task));
            }
            Some(found.len())
        }
        Answer::Unsolvable => {
            assert_eq!(plan, None, "{}", told(task));
            None
        }
        Answer::GaveUp(why) => panic!("gave up: {why}; {plan:?} does in {}", told(task)),
    }
}

#[test]
fn plans_do_and_are_shortest_and_there_is_none_only_where_there_is_none() {
    let mut draw = Draw::new(1);
    let mut lengths: BTreeMap<Option<usize>, usize> = BTreeMap::new();
    for _ in 0..1500 {
        let atoms = 1 + draw.below(10);
        let task = draw.task(atoms);
        *lengths.entry(agree(&Ferroplan::default(), &task)).or_default() += 1;
    }
    let long: usize = lengths.iter().filter(|(length, _)| **length >= Some(4)).map(|(_, n)| n).sum();
    assert!(long > 100 && lengths[&None] > 200 && lengths[&Some(0)] > 50 && lengths[&Some(1)] > 50, "{lengths:?}");
}

#[test]
fn some_plan_is_found_where_the_fewest_actions_are_given_up() {
    let engine = Ferroplan { optimal_nodes: 1, ..Ferroplan::default() };
    let mut draw = Draw::new(2);
    let mut longer = 0;
    for _ in 0..500 {
        let task = draw.task(8);
        let (plan, _) = shortest(&task);
        match (plan, solve(&engine, &task)) {
            (Some(plan), Answer::Plan(found)) => {
                assert!(does(&task, &found), "{found:?} does not do in {}", told(&task));
                longer += usize::from(plan.len() > 3);
            }
            (None, Answer::Unsolvable | Answer::GaveUp(_)) => {}
            (plan, answer) => panic!("{answer:?}, and not {plan:?}, in {}", told(&task)),
        }
    }
    assert!(longer > 50, "{longer}");
}

#[test]
fn the_nearest_of_several_goals_is_reached() {
    let chain = (0..4).map(|i| action(if i == 0 { &[] } else { &[(0, true)] }, &[i], &[])).collect();
    let near = task(4, chain, vec![vec![(1, true), (2, true), (3, true)], vec![(3, true), (1, false)]]);
    assert_eq!(solve(&Ferroplan::default(), &near), Answer::Plan(vec![0, 3]));
}

#[test]
fn a_goal_that_holds_at_first_needs_no_action() {
    let hold = |goal| solve(&Ferroplan::default(), &task(2, vec![action(&[], &[0], &[])], goal));
    assert_eq!(hold(vec![vec![(0, true)], vec![(1, false)]]), Answer::Plan(Vec::new()));
    assert_eq!(hold(vec![vec![]]), Answer::Plan(Vec::new()));
    assert_eq!(solve(&Ferroplan::default(), &task(1, vec![], vec![vec![(0, false)]])), Answer::Plan(Vec::new()));
}

#[test]
fn without_actions_or_goals_there_is_no_plan() {
    assert_eq!(solve(&Ferroplan::default(), &task(1, vec![], vec![vec![(0, true)]])), Answer::Unsolvable);
    assert_eq!(solve(&Ferroplan::default(), &task(1, vec![action(&[], &[0], &[])], vec![])), Answer::Unsolvable);
}

#[test]
fn what_must_not_hold_is_undone_first() {
    // A light that burns, a lamp to be changed in the dark.
    let dark = |init: &[usize]| {
        let actions = vec![action(&[(0, false)], &[1], &[]), action(&[], &[], &[0]), action(&[(0, false)], &[0], &[])];
        Task { init: init.to_vec(), ..task(2, actions, vec![vec![(0, true), (1, true)]]) }
    };
    assert_eq!(solve(&Ferroplan::default(), &dark(&[0])), Answer::Plan(vec![1, 0, 2]));
    assert_eq!(solve(&Ferroplan::default(), &dark(&[])), Answer::Plan(vec![0, 2]));
}

#[test]
fn an_action_that_changes_nothing_does_no_harm() {
    let idle = task(1, vec![action(&[], &[], &[]), action(&[(0, false)], &[0], &[])], vec![vec![(0, true)]]);
    assert_eq!(solve(&Ferroplan::default(), &idle), Answer::Plan(vec![1]));
    let stuck = task(1, vec![action(&[], &[], &[])], vec![vec![(0, true)]]);
    assert_eq!(solve(&Ferroplan::default(), &stuck), Answer::Unsolvable);
}

#[test]
fn the_same_task_has_the_same_plan() {
    let mut draw = Draw::new(3);
    for _ in 0..50 {
        let task = draw.task(9);
        assert_eq!(solve(&Ferroplan::default(), &task), solve(&Ferroplan::default(), &task));
    }
}

/// A counter: bit after bit is set when all before it are, which clears those. A plan has `2^bits - 1` actions.
fn counter(bits: usize) -> Task {
    let set = |bit: usize| {
        let lower: Vec<usize> = (0..bit).collect();
        let all: Vec<(usize, bool)> = lower.iter().map(|i| (*i, true)).chain([(bit, false)]).collect();
        action(&all, &[bit], &lower)
    };
    task(bits, (0..bits).map(set).collect(), vec![(0..bits).map(|i| (i, true)).collect()])
}

#[test]
fn long_plans_are_counted_out() {
    assert_eq!(agree(&Ferroplan::default(), &counter(7)), Some(127));
}

#[test]
fn a_cancelled_search_ends() {
    let cancelled = Budget::unlimited().with_cancel(Arc::new(AtomicBool::new(true)));
    assert_ne!(Ferroplan::default().solve(&counter(18), usize::MAX, &cancelled), Answer::Unsolvable);
    let flag = Arc::new(AtomicBool::new(false));
    let budget = Budget::unlimited().with_cancel(flag.clone());
    std::thread::scope(|scope| {
        let search = scope.spawn(|| Ferroplan::default().solve(&counter(26), STATES, &budget));
        flag.store(true, Ordering::Relaxed);
        assert_ne!(search.join().unwrap(), Answer::Unsolvable);
    });
}

#[test]
fn a_search_of_few_states_gives_up_or_is_right() {
    let mut draw = Draw::new(4);
    for _ in 0..300 {
        let task = draw.task(8);
        match Ferroplan::default().solve(&task, 1, &Budget::unlimited()) {
            Answer::Plan(plan) => assert!(does(&task, &plan), "{}", told(&task)),
            Answer::Unsolvable => assert_eq!(shortest(&task).0, None, "{}", told(&task)),
            Answer::GaveUp(_) => {}
        }
    }
}
