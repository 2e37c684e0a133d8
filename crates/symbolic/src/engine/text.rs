//! A task as PDDL text without variables: atoms `f0`, `f1` …, actions `a0`, `a1` …

use crate::ground::{Literal, Task};
use std::fmt::Write;

pub(super) struct Text {
    pub domain: String,
    pub problem: String,
}

impl Text {
    pub fn of(task: &Task) -> Self {
        let mut domain =
            String::from("(define (domain task) (:requirements :strips :negative-preconditions)\n(:predicates");
        for atom in 0..task.atoms.len() {
            let _ = write!(domain, " (f{atom})");
        }
        domain.push_str(")\n");
        for (index, action) in task.actions.iter().enumerate() {
            let _ = write!(domain, "(:action a{index} :parameters () :precondition ");
            conjunction(&action.precondition, &mut domain);
            domain.push_str(" :effect (and");
            for atom in &action.adds {
                let _ = write!(domain, " (f{atom})");
            }
            for atom in &action.deletes {
                let _ = write!(domain, " (not (f{atom}))");
            }
            domain.push_str("))\n");
        }
        domain.push(')');
        let mut problem = String::from("(define (problem task) (:domain task) (:init");
        for atom in &task.init {
            let _ = write!(problem, " (f{atom})");
        }
        problem.push_str(") (:goal ");
        match task.goal.as_slice() {
            [goal] => conjunction(goal, &mut problem),
            goals => {
                problem.push_str("(or");
                goals.iter().for_each(|goal| {
                    problem.push(' ');
                    conjunction(goal, &mut problem);
                });
                problem.push(')');
            }
        }
        problem.push_str("))");
        Self { domain, problem }
    }
}

fn conjunction(literals: &[Literal], text: &mut String) {
    text.push_str("(and");
    for (atom, holds) in literals {
        let _ = if *holds { write!(text, " (f{atom})") } else { write!(text, " (not (f{atom}))") };
    }
    text.push(')');
}

/// Which action a name of a plan means.
pub(super) fn action(name: &str) -> Option<usize> {
    name.trim().trim_matches(['(', ')']).trim().get(1..)?.parse().ok()
}
