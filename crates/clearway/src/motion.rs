//! A motion problem planned, simplified and timed.

use clearway_motion::{MotionProblem, Trees, time_path};
use clearway_plan::motion_answer::{FORMAT, MotionAnswer, MotionStatus, MotionTiming, Trajectory};
use clearway_plan::{Budget, Stop};
use std::time::Instant;

/// How a motion request ended; the answer says why there is no path, if there is none.
#[derive(Debug)]
pub enum MotionOutcome {
    Solved(MotionAnswer),
    OutOfBudget(MotionAnswer),
    Cancelled,
}

/// Plans from the start to any of the goals. The same seed gives the same path, where no clock
/// strikes.
pub fn plan_motion(problem: &MotionProblem, seed: u64, budget: &Budget) -> MotionOutcome {
    let MotionProblem { planner, around, start, goals, .. } = problem;
    let mut settings = problem.settings.clone();
    // Neighbouring seeds begin far from each other in the sequence.
    settings.skip = (seed.wrapping_mul(0x9e37_79b9_7f4a_7c15) >> 33) as u32;
    let mut answer = MotionAnswer {
        format: FORMAT.to_owned(),
        seed,
        robot: planner.group.robot.clone(),
        joints: planner.group.names.clone(),
        why: problem.passed_over.clone(),
        ..MotionAnswer::default()
    };
    let mut space = planner.space(around, &settings);
    let began = Instant::now();
    let found = planner.plan(&mut space, start, goals, &settings, &mut Trees::default(), budget);
    let solution = match found {
        Ok(Some(solution)) => solution,
        Err(Stop::Cancelled) => return MotionOutcome::Cancelled,
        not_found => {
            answer.timing.plan = began.elapsed().as_secs_f64();
            let spent = match not_found {
                Ok(_) => format!("{} samples were drawn", settings.rrt.iterations),
                Err(_) => format!("the time was up after {:.1} s", answer.timing.plan),
            };
            let goals = if goals.len() == 1 { "the goal".to_owned() } else { format!("any of {} goals", goals.len()) };
            answer.why.insert(0, format!("no way from the start to {goals} was found: {spent}; nothing is proved"));
            return MotionOutcome::OutOfBudget(answer);
        }
    };
    answer.status = MotionStatus::Solved;
    answer.timing = MotionTiming {
        plan: solution.plan.as_secs_f64(),
        simplify: solution.simplify.as_secs_f64(),
        ..MotionTiming::default()
    };
    answer.goal = goals.iter().position(|g| Some(g) == solution.path.last()).map(|i| problem.goal_numbers[i]);
    (answer.cost, answer.initial_cost) = (Some(solution.cost), Some(solution.initial_cost));
    match &problem.limits {
        Err(why) => answer.why.push(why.clone()),
        Ok(limits) => {
            let began = Instant::now();
            // The deadline was the search's: a path found in time is timed to the end.
            match time_path(&mut space, &solution.path, limits, &budget.without_deadline()) {
                Err(_) => return MotionOutcome::Cancelled,
                Ok(timed) => answer.trajectory = Some(Trajectory { times: timed.times, positions: timed.positions }),
            }
            answer.timing.trajectory = began.elapsed().as_secs_f64();
        }
    }
    answer.path = solution.path;
    MotionOutcome::Solved(answer)
}
