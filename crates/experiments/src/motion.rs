//! Motion planning benchmarks: RRT-Connect and simplification over many problems, least of several
//! repeats, one thread.

use crate::motion_problems::{Problem, Problems};
use clearway_motion::{MotionPlanner, MotionSettings, Surroundings, Trees};
use clearway_plan::{Budget, Stop};
use serde::Serialize;
use std::time::Duration;

/// How to run.
#[derive(Clone, Debug)]
pub struct Settings {
    pub planner: MotionSettings,
    pub repeats: usize,
    /// Per attempt, seconds.
    pub time_limit: f64,
    /// Over all of it.
    pub budget: Budget,
}

impl Default for Settings {
    fn default() -> Self {
        Self { planner: MotionSettings::default(), repeats: 9, time_limit: 10.0, budget: Budget::unlimited() }
    }
}

/// One problem's result. Times in microseconds, costs in radians of joint distance.
#[derive(Clone, Debug, Serialize)]
pub struct Row {
    pub set: String,
    pub index: usize,
    pub solved: bool,
    pub plan_us: f64,
    pub simplify_us: f64,
    pub initial_cost: Option<f64>,
    pub cost: Option<f64>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub why: Option<String>,
    pub path: Vec<Vec<f64>>,
}

/// Plans one problem `repeats` times; the least times are kept. Only what ends the whole run is a
/// [`Stop`]: a problem's own time limit leaves it unsolved.
pub fn run(planner: &MotionPlanner, problem: &Problem, settings: &Settings, trees: &mut Trees) -> Result<Row, Stop> {
    let around = Surroundings::new(problem.obstacles.clone());
    let refusal = |what: &str, q: &[f64]| planner.refusal(q, &around, 0.0).map(|why| format!("{what}: {why}"));
    let mut row = Row {
        set: problem.set.clone(),
        index: problem.index,
        solved: false,
        plan_us: 0.0,
        simplify_us: 0.0,
        initial_cost: None,
        cost: None,
        why: refusal("start", &problem.start),
        path: Vec::new(),
    };
    let mut goals = Vec::new();
    let mut refused = None;
    for goal in &problem.goals {
        match refusal("goal", goal) {
            Some(why) => refused = refused.or(Some(why)),
            None => goals.push(goal.clone()),
        }
    }
    if goals.is_empty() {
        row.why = row.why.or(refused);
    }
    if row.why.is_some() {
        return Ok(row);
    }
    let mut space = planner.space(&around, &settings.planner);
    (row.plan_us, row.simplify_us) = (f64::INFINITY, f64::INFINITY);
    for _ in 0..settings.repeats.max(1) {
        let budget = settings.budget.clone().with_time(Duration::from_secs_f64(settings.time_limit));
        let found = planner.plan(&mut space, &problem.start, &goals, &settings.planner, trees, &budget);
        let solution = match found {
            Ok(Some(solution)) => solution,
            Err(Stop::Cancelled) => return Err(Stop::Cancelled),
            // A clock that struck once on a busy machine takes nothing away from what was found.
            _ if row.solved => break,
            not_found => {
                (row.plan_us, row.simplify_us) = (0.0, 0.0);
                row.why = Some(match not_found {
                    Err(_) => format!("no path found within {} s", settings.time_limit),
                    Ok(_) => format!("no path found with {} samples", settings.planner.rrt.iterations),
                });
                return Ok(row);
            }
        };
        row.plan_us = row.plan_us.min(solution.plan.as_secs_f64() * 1e6);
        row.simplify_us = row.simplify_us.min(solution.simplify.as_secs_f64() * 1e6);
        row.solved = true;
        row.initial_cost = Some(solution.initial_cost);
        row.cost = Some(solution.cost);
        row.path = solution.path;
    }
    Ok(row)
}

/// Runs all problems, a row at a time, up to a stop.
pub fn run_all(planner: &MotionPlanner, problems: &Problems, settings: &Settings, mut each: impl FnMut(&Row)) {
    let mut trees = Trees::default();
    for problem in &problems.problems {
        let Ok(row) = run(planner, problem, settings, &mut trees) else { return };
        each(&row);
    }
}
