//! What a motion benchmark's rows come to, for programs and for people.

use crate::Machine;
use crate::motion::{Row, Settings};
use crate::motion_peer::{Comparison, Peer};
use crate::motion_problems::Cylinders;
use crate::statistics::{mean, median, quantile};
use clearway_motion::MotionPlanner;
use serde::Serialize;
use std::fmt;
use std::time::Duration;

/// Over the problems solved; microseconds.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Times {
    pub median: Option<f64>,
    pub mean: Option<f64>,
    pub p95: Option<f64>,
}

impl Times {
    fn of(values: &[f64]) -> Self {
        Self { median: median(values), mean: mean(values), p95: quantile(values, 0.95) }
    }
}

#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Summary {
    pub robot: String,
    pub joints: Vec<String>,
    pub spheres: usize,
    /// What cylinders counted as.
    pub obstacles: String,
    pub range: f64,
    pub checks_per_rad: f64,
    pub repeats: usize,
    pub solved: usize,
    pub total: usize,
    pub plan_us: Times,
    pub simplify_us: Times,
    /// Means over the problems solved, before and after simplification.
    pub initial_cost: Option<f64>,
    pub cost: Option<f64>,
    /// From the URDF to a planner that can be asked.
    pub load_ms: f64,
    /// The instructions that the kernel chose.
    pub level: String,
    pub machine: Machine,
    pub version: String,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub peer: Option<Comparison>,
}

impl Summary {
    pub fn of(
        rows: &[Row],
        planner: &MotionPlanner,
        settings: &Settings,
        cylinders: Cylinders,
        load: Duration,
        peer: Option<&Peer>,
    ) -> Self {
        let solved: Vec<&Row> = rows.iter().filter(|r| r.solved).collect();
        let all = |figure: fn(&Row) -> Option<f64>| solved.iter().filter_map(|r| figure(r)).collect::<Vec<f64>>();
        let level = format!("{:?}", planner.kernel.level);
        Self {
            robot: planner.group.robot.clone(),
            joints: planner.group.names.clone(),
            spheres: planner.spheres.iter().map(Vec::len).sum(),
            obstacles: cylinders.describe().to_owned(),
            range: settings.planner.rrt.range,
            checks_per_rad: settings.planner.checks_per_rad,
            repeats: settings.repeats,
            solved: solved.len(),
            total: rows.len(),
            plan_us: Times::of(&all(|r| Some(r.plan_us))),
            simplify_us: Times::of(&all(|r| Some(r.simplify_us))),
            initial_cost: mean(&all(|r| r.initial_cost)),
            cost: mean(&all(|r| r.cost)),
            load_ms: load.as_secs_f64() * 1e3,
            level: level.split(['(', ' ']).next().unwrap_or_default().to_owned(),
            machine: Machine::this(),
            version: env!("CARGO_PKG_VERSION").to_owned(),
            peer: peer.map(|p| p.compare(rows)),
        }
    }
}

/// A figure, or a dash where there is none.
struct Figure(Option<f64>, usize);

impl fmt::Display for Figure {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        match self.0 {
            Some(value) => write!(f, "{value:.*}", self.1),
            None => f.write_str("–"),
        }
    }
}

impl fmt::Display for Summary {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        let Self { robot, spheres, solved, total, .. } = self;
        writeln!(f, "{robot}: {} joints, {spheres} spheres; {}", self.joints.len(), self.obstacles)?;
        writeln!(f, "solved      {solved} of {total}")?;
        for (name, times) in [("plan", &self.plan_us), ("simplify", &self.simplify_us)] {
            let [median, mean, p95] = [times.median, times.mean, times.p95].map(|t| Figure(t, 1));
            writeln!(f, "{name:<10}  {median} µs median, {mean} mean, {p95} p95")?;
        }
        writeln!(
            f,
            "cost        {} before, {} after simplification (means)",
            Figure(self.initial_cost, 3),
            Figure(self.cost, 3)
        )?;
        writeln!(f, "ready       {:.1} ms after the URDF was named", self.load_ms)?;
        if let Some(peer) = &self.peer {
            let both = peer.solved_by_both;
            writeln!(
                f,
                "peer        {both} solved by both; plan + simplify {} of its time (median of ratios)",
                Figure(peer.median_ratio, 3)
            )?;
            writeln!(
                f,
                "            planning p95 {} of its; cost {} to its {}",
                Figure(peer.plan_p95_ratio, 3),
                Figure(peer.mean_cost, 3),
                Figure(peer.peer_mean_cost, 3)
            )?;
        }
        let repeats = self.repeats;
        writeln!(
            f,
            "least of {repeats}, one thread, {}, {} ({} cores), version {}",
            self.level, self.machine.cpu, self.machine.cores, self.version
        )
    }
}
