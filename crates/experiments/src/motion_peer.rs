//! Another planner's rows on the same problems, and how ours compare.

use crate::motion::Row;
use crate::statistics::{mean, median, quantile};
use clearway_files::{FileError, Limits, json, read_text};
use serde::{Deserialize, Serialize};
use std::collections::HashMap;
use std::path::Path;

#[derive(Debug, Deserialize)]
struct File {
    #[serde(default)]
    what: String,
    rows: Vec<PeerRow>,
}

/// Times in microseconds, cost in radians of joint distance.
#[derive(Clone, Debug, Deserialize)]
struct PeerRow {
    set: String,
    index: usize,
    #[serde(default)]
    solved: bool,
    plan_us: Option<f64>,
    simplify_us: Option<f64>,
    cost: Option<f64>,
}

/// A peer's result on each problem.
#[derive(Clone, Debug)]
pub struct Peer {
    /// In its own words.
    what: String,
    /// Plan, simplify, cost; of the problems that it solved.
    solved: HashMap<(String, usize), (f64, f64, f64)>,
}

/// Over the problems that both solved.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Comparison {
    pub peer: String,
    pub solved_by_peer: usize,
    pub solved_by_both: usize,
    /// Of plan + simplify, ours to the peer's, problem by problem.
    pub median_ratio: Option<f64>,
    /// Our p95 of planning to the peer's.
    pub plan_p95_ratio: Option<f64>,
    pub mean_cost: Option<f64>,
    pub peer_mean_cost: Option<f64>,
}

impl Peer {
    /// Reads `{what, rows: [{set, index, solved, plan_us, simplify_us, cost}]}`.
    pub fn read(path: &Path) -> Result<Peer, FileError> {
        let file: File = json::from_str(path, &read_text(path, &Limits::PLAN)?)?;
        let mut solved = HashMap::new();
        for row in file.rows.into_iter().filter(|r| r.solved) {
            let (Some(plan), Some(simplify), Some(cost)) = (row.plan_us, row.simplify_us, row.cost) else {
                return Err(FileError::new(
                    path,
                    format!("the solved problem {} of set `{}` lacks a figure", row.index, row.set),
                )
                .expected("`plan_us`, `simplify_us` and `cost`"));
            };
            if !(plan + simplify > 0.0) {
                return Err(FileError::new(
                    path,
                    format!("problem {} of set `{}` took {} µs", row.index, row.set, plan + simplify),
                )
                .expected("more than 0"));
            }
            solved.insert((row.set, row.index), (plan, simplify, cost));
        }
        if solved.is_empty() {
            return Err(FileError::new(path, "no problem that the peer solved").expected("rows with `solved: true`"));
        }
        Ok(Peer { what: file.what, solved })
    }

    pub fn compare(&self, rows: &[Row]) -> Comparison {
        let (mut ratios, mut ours, mut theirs) = (Vec::new(), Vec::new(), Vec::new());
        let (mut cost, mut peer_cost) = (Vec::new(), Vec::new());
        for row in rows.iter().filter(|r| r.solved) {
            let Some((plan, simplify, at)) = self.solved.get(&(row.set.clone(), row.index)) else { continue };
            ratios.push((row.plan_us + row.simplify_us) / (plan + simplify));
            ours.push(row.plan_us);
            theirs.push(*plan);
            cost.extend(row.cost);
            peer_cost.push(*at);
        }
        Comparison {
            peer: self.what.clone(),
            solved_by_peer: self.solved.len(),
            solved_by_both: ratios.len(),
            median_ratio: median(&ratios),
            plan_p95_ratio: quantile(&ours, 0.95).zip(quantile(&theirs, 0.95)).map(|(ours, theirs)| ours / theirs),
            mean_cost: mean(&cost),
            peer_mean_cost: mean(&peer_cost),
        }
    }
}
