//! Fast Downward as a program of its own, for comparison: PyPI's `up-fast-downward` carries it.

use super::text::{self, Text};
use super::{Answer, Engine, at_once};
use crate::ground::Task;
use clearway_plan::Budget;
use std::path::PathBuf;
use std::process::{Command, Stdio};
use std::time::Duration;

/// The driver script of Fast Downward, run by Python.
#[derive(Clone, Debug)]
pub struct FastDownward {
    pub python: PathBuf,
    pub driver: PathBuf,
}

/// Seconds it may take where nothing else limits it, and between looks at whether it is done.
const MOST_SECONDS: u64 = 600;
const POLL: Duration = Duration::from_millis(5);

/// What the driver returns for a problem proved to have no plan: by the translator, by the search.
const UNSOLVABLE: [i32; 2] = [10, 11];

impl Engine for FastDownward {
    fn name(&self) -> &'static str {
        "fast-downward"
    }

    fn solve(&self, task: &Task, _: usize, budget: &Budget) -> Answer {
        if let Some(answer) = at_once(task) {
            return answer;
        }
        self.run(task, budget).unwrap_or_else(|error| Answer::GaveUp(format!("{}: {error}", self.driver.display())))
    }
}

impl FastDownward {
    fn run(&self, task: &Task, budget: &Budget) -> std::io::Result<Answer> {
        let directory = tempfile::tempdir()?;
        let Text { domain, problem } = Text::of(task);
        std::fs::write(directory.path().join("domain.pddl"), domain)?;
        std::fs::write(directory.path().join("problem.pddl"), problem)?;
        let left = budget.remaining().map_or(MOST_SECONDS, |left| left.as_secs() + 1);
        let mut running = Command::new(&self.python)
            .arg(std::path::absolute(&self.driver)?)
            .args(["--overall-time-limit", &left.to_string()])
            .args(["--plan-file", "plan", "domain.pddl", "problem.pddl", "--search", "astar(lmcut())"])
            .current_dir(directory.path())
            .stdout(Stdio::null())
            .stderr(Stdio::null())
            .spawn()?;
        let ended = loop {
            if let Some(ended) = running.try_wait()? {
                break ended;
            }
            if budget.check().is_err() {
                // Its own time limit ends what it started.
                running.kill()?;
                running.wait()?;
                return Ok(Answer::GaveUp("stopped".to_owned()));
            }
            std::thread::sleep(POLL);
        };
        let Ok(plan) = std::fs::read_to_string(directory.path().join("plan")) else {
            return Ok(match ended.code() {
                Some(code) if UNSOLVABLE.contains(&code) => Answer::Unsolvable,
                code => Answer::GaveUp(format!("ended with {code:?} and without a plan")),
            });
        };
        let steps = plan.lines().filter(|l| !l.starts_with(';') && !l.trim().is_empty());
        let actions: Option<Vec<usize>> = steps.map(text::action).collect();
        Ok(actions.map_or_else(|| Answer::GaveUp("a plan in other words than asked".to_owned()), Answer::Plan))
    }
}
