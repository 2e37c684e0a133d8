//! Planned, verified, and only then called solved.

use crate::written::with_meshes_relative_to;
use clearway_plan::PlanFile;
use clearway_plan::event::{Observer, Silent};
use clearway_plan::plan_file::Status;
use clearway_plan::{Budget, Stop};
use clearway_retrieval::{Planner, Request};
use clearway_verify::{Rejected, VerifiedPlan, accept};
use std::path::Path;
use std::time::{Duration, Instant};

/// How a request ended.
#[derive(Debug)]
pub enum Outcome {
    /// A whole plan that the verifier has passed.
    Solved(Box<VerifiedPlan>),
    /// Proved: there is no plan over the declared grasps. The file holds why.
    Impossible(Box<PlanFile>),
    /// The budget was spent; nothing is proved. The file holds what stood in the way.
    OutOfBudget(Box<PlanFile>, Stop),
    /// The verifier refused the plan: an error of ours.
    Refused(Box<Rejected>),
}

/// Plans and verifies. Mesh files are named relative to `directory` in the plan.
pub fn solve(planner: &mut Planner, request: &Request, directory: &Path, observer: &mut dyn Observer) -> Outcome {
    let answer = planner.plan(request, observer);
    verified(answer.plan, answer.stopped, request, directory)
}

/// What a planner came to, its plan verified if it has one.
pub(crate) fn verified(plan: PlanFile, stopped: Option<Stop>, request: &Request, directory: &Path) -> Outcome {
    let plan = with_meshes_relative_to(plan, directory);
    match (plan.status, stopped) {
        (Status::Solved, _) => {
            // The deadline is the planner's: a plan found in time is judged to the end.
            let budget = request.budget.without_deadline();
            let scene = plan.scene.clone();
            match accept(plan, directory, &budget) {
                Ok(verified) => Outcome::Solved(Box::new(verified)),
                Err(Rejected::Unjudged(clearway_verify::CannotJudge::Stopped(stop))) => {
                    let mut plan = PlanFile::unsolved(scene);
                    plan.why.summary = "Interrupted while the plan found was being verified.".to_owned();
                    Outcome::OutOfBudget(Box::new(plan), stop)
                }
                Err(rejected) => Outcome::Refused(Box::new(rejected)),
            }
        }
        (Status::Impossible, _) => Outcome::Impossible(Box::new(plan)),
        (Status::OutOfBudget, stop) => Outcome::OutOfBudget(Box::new(plan), stop.unwrap_or(Stop::Deadline)),
    }
}

/// Spends more time on a better plan: fewer removals, until there are as few as its lower bound says are
/// needed or none are found, and then, with other seeds, shorter motion. All are verified; the best is kept.
pub fn improve(
    planner: &mut Planner,
    first: Box<VerifiedPlan>,
    request: &Request,
    spend: Duration,
    directory: &Path,
) -> Box<VerifiedPlan> {
    let until = Instant::now() + spend;
    let mut best = first;
    let mut seed = request.seed;
    let mut fewest = false;
    loop {
        let removed = best.plan().removed.len();
        fewest |= removed <= 1 || best.plan().lower_bound.as_ref().is_some_and(|bound| bound.removed >= removed);
        seed = seed.wrapping_add(1);
        let left = until.saturating_duration_since(Instant::now());
        let budget: Budget = request.budget.without_deadline().with_time(left);
        if left.is_zero() || budget.check().is_err() {
            return best;
        }
        let most_removals = Some(if fewest { removed } else { removed - 1 });
        match solve(planner, &Request { seed, budget, most_removals }, directory, &mut Silent) {
            Outcome::Solved(plan) if !fewest || plan.plan().duration() < best.plan().duration() => best = plan,
            Outcome::Solved(_) => {}
            _ => fewest = true,
        }
    }
}
