//! The crate `ferroplan`, in process: fewest actions as long as that is quickly proved, then its FF search.

use super::text::{self, Text};
use super::{Answer, Engine, at_once};
use crate::ground::Task;
use clearway_plan::Budget;
use ferroplan::{Mode, Options};

#[derive(Clone, Copy, Debug)]
pub struct Ferroplan {
    /// States looked at before the fewest actions are given up for some.
    pub optimal_states: usize,
    /// States looked at before all is given up.
    pub states: usize,
}

impl Default for Ferroplan {
    fn default() -> Self {
        Self { optimal_states: 3_000, states: 300_000 }
    }
}

impl Engine for Ferroplan {
    fn name(&self) -> &'static str {
        "ferroplan"
    }

    fn solve(&self, task: &Task, budget: &Budget) -> Answer {
        if let Some(answer) = at_once(task) {
            return answer;
        }
        let Text { domain, problem } = Text::of(task);
        let wall_ms = budget.remaining().map(|left| left.as_millis() as u64 + 1);
        let mut said = String::new();
        for (mode, states) in [(Mode::Optimal, self.optimal_states), (Mode::Ff, self.states)] {
            let options = Options { mode, threads: 1, max_evaluated: Some(states), wall_ms, ..Options::default() };
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
