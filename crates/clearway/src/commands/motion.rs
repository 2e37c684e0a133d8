//! `clearway motion`: plain motion planning.

use super::output::{self, print, tell};
use crate::cli::MotionArgs;
use crate::exit::{Exit, Failure};
use crate::interrupt;
use clearway::{Budget, MotionAnswer, MotionOutcome, MotionProblem, plan_motion};
use std::path::Path;
use std::time::{Duration, Instant};

pub fn run(args: &MotionArgs) -> Result<Exit, Failure> {
    output::check(args.output.as_deref(), &[&args.problem])?;
    let began = Instant::now();
    let problem = MotionProblem::load(&args.problem, &args.package)?;
    let load = began.elapsed().as_secs_f64();
    let budget = Budget::unlimited().with_cancel(interrupt::flag()).with_time(Duration::from_secs_f64(args.time_limit));
    let (mut answer, exit) = match plan_motion(&problem, args.seed, &budget) {
        MotionOutcome::Solved(answer) => (answer, Exit::Done),
        MotionOutcome::OutOfBudget(answer) => (answer, Exit::OutOfBudget),
        MotionOutcome::Cancelled => {
            return Err(Failure { exit: Exit::Interrupted, message: "interrupted; nothing was written".to_owned() });
        }
    };
    answer.timing.load = load;
    let mut json = serde_json::to_vec(&answer).map_err(|e| Failure::internal(format!("the answer is no JSON: {e}")))?;
    json.push(b'\n');
    if let Some(path) = &args.output {
        output::write(path, &json)?;
    }
    let text = text(&answer, args.output.as_deref());
    match (args.json, exit) {
        (true, _) => print(&json)?,
        (false, Exit::Done) => print(&text)?,
        (false, _) => {}
    }
    if exit != Exit::Done {
        tell(&text);
    }
    Ok(exit)
}

/// For people.
fn text(answer: &MotionAnswer, output: Option<&Path>) -> String {
    let mut out = match (answer.cost, answer.initial_cost) {
        (Some(cost), Some(initial)) => {
            format!("solved: {} rows, cost {cost:.3}, {initial:.3} before simplification\n", answer.path.len())
        }
        _ => "no path\n".to_owned(),
    };
    for why in &answer.why {
        out += &format!("  {why}\n");
    }
    let t = &answer.timing;
    out += &format!(
        "  planned in {:.3} ms, simplified in {:.3} ms, ready after {:.1} ms\n",
        t.plan * 1e3,
        t.simplify * 1e3,
        t.load * 1e3
    );
    if let Some(last) = answer.trajectory.as_ref().and_then(|t| t.times.last()) {
        out += &format!("  {last:.2} s of motion, timed in {:.1} ms\n", t.trajectory * 1e3);
    }
    if let Some(path) = output {
        out += &format!("  answer: {}\n", path.display());
    }
    out
}
