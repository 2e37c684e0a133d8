//! What `clearway motion` answers: a path and a trajectory along it, or why there is none.

use serde::{Deserialize, Serialize};

pub const FORMAT: &str = "clearway-path/1";

/// Postures are rows, a column per name in `joints`; radians or metres, seconds.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct MotionAnswer {
    /// `clearway-path/1`.
    pub format: String,
    pub status: MotionStatus,
    pub seed: u64,
    /// The URDF's name.
    pub robot: String,
    pub joints: Vec<String>,
    /// Which of the problem's goals was reached, from 0.
    pub goal: Option<usize>,
    /// Straight lines between these rows are free; the first is the start, the last the goal.
    pub path: Vec<Vec<f64>>,
    /// The sum of the Euclidean joint distances along the path, and along the first path found.
    pub cost: Option<f64>,
    pub initial_cost: Option<f64>,
    /// From rest to rest within the limits. Corners of the path are rounded where that is free.
    pub trajectory: Option<Trajectory>,
    pub timing: MotionTiming,
    /// Why there is no path; why there is a path, but no trajectory; what was passed over.
    pub why: Vec<String>,
}

#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum MotionStatus {
    Solved,
    #[default]
    OutOfBudget,
}

/// Rows in time, at most 0.02 s apart, straight lines between them.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Trajectory {
    pub times: Vec<f64>,
    pub positions: Vec<Vec<f64>>,
}

/// Seconds on the wall clock.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct MotionTiming {
    /// From the problem's text to a planner among its obstacles.
    pub load: f64,
    pub plan: f64,
    pub simplify: f64,
    /// Rounding corners and timing.
    pub trajectory: f64,
}
