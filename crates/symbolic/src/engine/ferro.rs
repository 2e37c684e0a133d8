//! The crate `ferroplan`, in process: fewest actions as long as that is quickly proved, then its FF search.

use super::text::{self, Text};
use super::{Answer, Engine, at_once};
use crate::ground::Task;
use clearway_plan::{Budget, Stop};
use ferroplan::ground::{self, Outcome};
use ferroplan::{Mode, Options, optimal, parser};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering::Relaxed};
use std::time::Duration;

#[derive(Clone, Copy, Debug)]
pub struct Ferroplan {
    /// Nodes of A\* before the fewest actions are given up for some.
    pub optimal_nodes: usize,
    /// At most so many nodes times actions.
    pub optimal_work: usize,
}

impl Default for Ferroplan {
    fn default() -> Self {
        Self { optimal_nodes: 4_000, optimal_work: 400_000 }
    }
}

/// Nodes looked at for the fewest actions however large a task is.
const FEW_NODES: usize = 50;
/// How long it may take until a cancelled search ends: milliseconds.
const POLL: Duration = Duration::from_millis(20);

impl Engine for Ferroplan {
    fn name(&self) -> &'static str {
        "ferroplan"
    }

    fn solve(&self, task: &Task, states: usize, budget: &Budget) -> Answer {
        if let Some(answer) = at_once(task) {
            return answer;
        }
        let go_on = Arc::new(AtomicBool::new(true));
        std::thread::scope(|scope| {
            let watch = scope.spawn(|| {
                // Until the search is done, or is to be.
                while go_on.load(Relaxed) {
                    std::thread::park_timeout(POLL);
                    if budget.check() == Err(Stop::Cancelled) {
                        go_on.store(false, Relaxed);
                    }
                }
            });
            let answer = self.search(task, states, budget, &go_on);
            go_on.store(false, Relaxed);
            watch.thread().unpark();
            answer
        })
    }
}

impl Ferroplan {
    fn search(&self, task: &Task, states: usize, budget: &Budget, go_on: &Arc<AtomicBool>) -> Answer {
        let text = Text::of(task);
        // The larger the task, the longer a node takes.
        let nodes = (self.optimal_work / task.actions.len().max(1)).max(FEW_NODES).min(self.optimal_nodes).min(states);
        match fewest(&text, nodes) {
            Ok(Answer::GaveUp(_)) => {}
            Ok(answer) => return answer,
            Err(error) => return Answer::GaveUp(error),
        }
        let wall_ms = budget.remaining().map(|left| left.as_millis() as u64 + 1);
        let should_continue = Some(go_on.clone());
        let options = Options {
            mode: Mode::Ff,
            threads: 1,
            max_evaluated: Some(states),
            wall_ms,
            should_continue,
            ..Options::default()
        };
        let solution = match ferroplan::solve(&text.domain, &text.problem, &options) {
            Ok(solution) => solution,
            Err(error) => return Answer::GaveUp(format!("{error:?}")),
        };
        match solution.plan.filter(|_| solution.solved) {
            Some(plan) => named(plan.steps.iter().map(|s| s.action.as_str())),
            None if solution.notes.iter().any(|n| n.contains("unsolvable at grounding")) => Answer::Unsolvable,
            None => Answer::GaveUp(format!("none found among {} states", solution.statistics.evaluated_states)),
        }
    }
}

/// A plan of the fewest actions, or the proof that there is none, within so many nodes: the crate's A\*, which its
/// outer interface bounds by the clock alone.
fn fewest(text: &Text, nodes: usize) -> Result<Answer, String> {
    let domain = parser::parse_domain(&text.domain).map_err(|e| format!("{e:?}"))?;
    let problem = parser::parse_problem(&text.problem).map_err(|e| format!("{e:?}"))?;
    let task = match ground::ground(&domain, &problem, 1) {
        Outcome::Task(task) => task,
        Outcome::GoalFalse(_) => return Ok(Answer::Unsolvable),
        _ => return Ok(Answer::GaveUp(String::new())),
    };
    let found = optimal::solve(&task, None, nodes, None);
    Ok(match (found.ops, found.proven) {
        (Some(ops), true) => {
            named(ops.iter().map(|op| task.op_display[*op].as_str()).filter(|name| *name != GOAL_REACHED))
        }
        (None, true) => Answer::Unsolvable,
        _ => Answer::GaveUp(String::new()),
    })
}

/// An action that the crate adds for goals with alternatives.
const GOAL_REACHED: &str = "REACH-GOAL";

fn named<'n>(names: impl Iterator<Item = &'n str>) -> Answer {
    let actions: Option<Vec<usize>> = names.map(text::action).collect();
    actions.map_or_else(|| Answer::GaveUp("a plan in other words than asked".to_owned()), Answer::Plan)
}
