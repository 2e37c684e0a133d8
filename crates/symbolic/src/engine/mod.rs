//! Symbolic engines: a task without variables in, a plan out.

mod fast_downward;
mod ferro;
mod text;

pub use fast_downward::FastDownward;
pub use ferro::Ferroplan;

use crate::ground::Task;
use clearway_plan::Budget;

/// What an engine came to.
#[derive(Clone, Debug, PartialEq)]
pub enum Answer {
    /// Indices of [`Task::actions`].
    Plan(Vec<usize>),
    /// Proved: there is none.
    Unsolvable,
    /// It gave up.
    GaveUp(String),
}

/// Plans with atoms.
pub trait Engine {
    fn name(&self) -> &'static str;
    /// `states`: how many are looked at before it gives up, as far as the engine can be told.
    fn solve(&self, task: &Task, states: usize, budget: &Budget) -> Answer;
}

/// What needs no engine: a goal that holds at first, or one that never can.
fn at_once(task: &Task) -> Option<Answer> {
    let init = task.init.iter().copied().collect();
    if task.goal.iter().any(|g| task.holds(&init, g)) {
        return Some(Answer::Plan(Vec::new()));
    }
    (task.goal.is_empty() || task.actions.is_empty()).then_some(Answer::Unsolvable)
}
