//! Goals in PDDL, planned and verified.

use crate::outcome::{Outcome, verified};
use clearway_plan::Stop;
use clearway_plan::plan_file::Status;
use clearway_retrieval::Request;
use clearway_retrieval::handling::Handling;
use clearway_symbolic::problem::{Asked, solve};
use std::path::Path;

/// Plans with symbols and streams, and verifies. Mesh files are named relative to `directory` in the plan.
pub fn solve_goal(handling: &mut Handling, asked: &Asked, request: &Request, directory: &Path) -> Outcome {
    let answer = solve(handling, asked, request.seed, &request.budget);
    let stopped = answer.stopped.or((answer.plan.status == Status::OutOfBudget).then_some(Stop::Iterations));
    verified(answer.plan, stopped, request, directory)
}
