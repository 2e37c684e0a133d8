//! The crate `ferroplan`, in process: fewest actions as long as that is quickly proved, then its FF search.

use super::text::{self, Text};
use super::{Answer, Engine, at_once};
use crate::ground::Task;
use clearway_plan::{Budget, Stop};
use ferroplan::{Mode, Options};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering::Relaxed};
use std::time::Duration;

#[derive(Clone, Copy, Debug)]
pub struct Ferroplan {
    /// States looked at before the fewest actions are given up for some.
    pub optimal_states: usize,
}

impl Default for Ferroplan {
    fn default() -> Self {
        Self { optimal_states: 800 }
    }
}

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
        let Text { domain, problem } = Text::of(task);
        let wall_ms = budget.remaining().map(|left| left.as_millis() as u64 + 1);
        let mut said = String::new();
        for (mode, states) in [(Mode::Optimal, self.optimal_states.min(states)), (Mode::Ff, states)] {
            let options = Options { mode, threads: 1, max_evaluated: Some(states), wall_ms, should_continue: Some(go_on.clone()), ..Options::default() };
            let solution = match ferroplan::solve(&domain, &problem, &options) {
                Ok(solution) => solution,
                Err(error) => return Answer::GaveUp(format!("{error:?}")),
            };
            if let Some(plan) = solution.plan.filter(|_| solution.solved) {
                let actions: Option<Vec<usize>> = plan.steps.iter().map(|s| text::action(&s.action)).collect();
                return actions.map_or_else(|| Answer::GaveUp("a plan in other words than asked".to_owned()), Answer::Plan);
            }
            said = solution.notes.join("; ");
            if said.contains("PROVEN UNSOLVABLE") || said.contains("unsolvable at grounding") {
                return Answer::Unsolvable;
            }
        }
        Answer::GaveUp(said)
    }
}
