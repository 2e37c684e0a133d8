//! `clearway bench motion`: plain motion planning, problem by problem.

use super::output::tell;
use super::rows::{Rows, interrupted};
use super::summary::Progress;
use crate::cli::BenchMotionArgs;
use crate::exit::{Exit, Failure};
use crate::interrupt;
use clearway::{Budget, MotionPlanner};
use clearway_experiments::motion::{self, Settings};
use clearway_experiments::motion_peer::Peer;
use clearway_experiments::motion_problems::{Cylinders, Problems};
use clearway_experiments::motion_summary::Summary;
use clearway_motion::Trees;
use clearway_robot::Group;
use serde_json::json;
use std::time::Instant;

pub fn run(args: &BenchMotionArgs) -> Result<Exit, Failure> {
    let settings = settings(args)?;
    let cylinders = if args.true_cylinders { Cylinders::True } else { Cylinders::Peer };
    let problems = Problems::read(&args.problems, cylinders)?;
    let peer = args.peer.as_deref().map(Peer::read).transpose()?;
    let began = Instant::now();
    let group =
        Group::load(&args.robot, args.srdf.as_deref(), Some(&problems.joints), &Default::default(), &args.package)?;
    let planner = MotionPlanner::new(group);
    let load = began.elapsed();

    let mut out = Rows::open(args.out.as_deref(), "motion")?;
    let mut progress = Progress::new(args.out.is_some());
    let mut trees = Trees::default();
    let mut rows = Vec::with_capacity(problems.problems.len());
    for problem in &problems.problems {
        progress.line(&format!("{} of {}: {} {}", rows.len() + 1, problems.problems.len(), problem.set, problem.index));
        let row = motion::run(&planner, problem, &settings, &mut trees).map_err(|_| interrupted())?;
        out.push(&row)?;
        rows.push(row);
    }
    progress.clear();
    let summary = Summary::of(&rows, &planner, &settings, cylinders, load, peer.as_ref());
    out.finish(&json!({ "summary": summary }))?;
    tell(&summary.to_string());
    Ok(Exit::Done)
}

fn settings(args: &BenchMotionArgs) -> Result<Settings, Failure> {
    let mut settings = Settings {
        repeats: args.repeats as usize,
        time_limit: args.time_limit,
        budget: Budget::unlimited().with_cancel(interrupt::flag()),
        ..Settings::default()
    };
    settings.planner.rrt.range = args.range;
    settings.planner.checks_per_rad = args.checks_per_rad;
    settings.planner.validate().map_err(|why| Failure::bad_input(format!("{why} (--range, --checks-per-rad)")))?;
    Ok(settings)
}
