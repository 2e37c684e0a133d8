//! `clearway bench known` and the like: the paper's experiments, a row per run.

use super::output::tell;
use super::rows::{Rows, interrupted};
use super::summary::Progress;
use crate::cli::BenchRetrievalArgs;
use crate::exit::{Exit, Failure};
use crate::interrupt;
use clearway::Budget;
use clearway_experiments::retrieval::experiment::Case;
use clearway_experiments::retrieval::row::{Key, Row};
use clearway_experiments::retrieval::run::{Bench, NoRow};
use clearway_experiments::retrieval::{Experiment, runner};
use serde_json::json;
use std::collections::HashSet;
use std::time::Instant;

pub fn run(experiment: Experiment, args: &BenchRetrievalArgs) -> Result<Exit, Failure> {
    let time_limit = args.time_limit.unwrap_or(experiment.time_limit(args.quick));
    let settings = json!({
        "experiment": experiment.name(),
        "quick": args.quick,
        "time_limit": time_limit,
        "version": env!("CARGO_PKG_VERSION"),
    });
    let (mut rows, earlier) = match (&args.out, args.resume) {
        (None, _) => (Rows::on_stdout(), Vec::new()),
        (Some(directory), false) => (Rows::begin(directory, experiment.name(), &settings)?, Vec::new()),
        (Some(directory), true) => Rows::resume::<Row>(directory, experiment.name(), &settings)?,
    };
    let bench = Bench::new(experiment, time_limit, Budget::unlimited().with_cancel(interrupt::flag()));
    let all = experiment.cases(args.quick);
    let done: HashSet<Key> = earlier.iter().map(Row::key).collect();
    let open = |case: &&Case| !done.contains(&bench.named(case).key());
    let cases: Vec<Case> = all.iter().filter(open).copied().collect();
    let mut progress = Progress::new(args.out.is_some());
    let (began, mut count) = (Instant::now(), 0);
    let mut refused = 0;
    let outcome = runner::run_all(&bench, &cases, args.jobs as usize, |row| {
        rows.push(&row)?;
        refused += usize::from(row.status == "refused");
        count += 1;
        let left = began.elapsed().as_secs_f64() / count as f64 * (cases.len() - count) as f64;
        progress.line(&format!(
            "{} of {}: {} objects, scene {}, {}; {} left",
            all.len() - cases.len() + count,
            all.len(),
            row.objects,
            row.scene_seed,
            row.planner,
            duration(left),
        ));
        Ok::<(), Failure>(())
    });
    progress.clear();
    outcome?;
    let directory = args.out.as_ref().map(|d| format!("; `clearway bench report {}` makes the tables", d.display()));
    tell(&format!("{}: {} runs, {} of them now{}", experiment.name(), all.len(), count, directory.unwrap_or_default()));
    if refused > 0 {
        return Err(Failure::internal(format!(
            "the verifier refused {refused} of the plans; their rows say `refused`"
        )));
    }
    Ok(Exit::Done)
}

impl From<NoRow> for Failure {
    fn from(error: NoRow) -> Self {
        match error {
            NoRow::Stopped => interrupted(),
            NoRow::Internal(why) => Self::internal(why),
        }
    }
}

fn duration(seconds: f64) -> String {
    let seconds = seconds.round() as u64;
    match (seconds / 3600, seconds / 60 % 60, seconds % 60) {
        (0, 0, s) => format!("{s} s"),
        (0, m, s) => format!("{m} min {s} s"),
        (h, m, _) => format!("{h} h {m} min"),
    }
}
