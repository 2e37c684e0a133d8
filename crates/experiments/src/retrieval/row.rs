//! One run of one planner on one scene, as it is kept.

use crate::Machine;
use serde::{Deserialize, Serialize};

/// A JSON line. Counts of removals include the target; times in seconds.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Row {
    /// `known`, `graphs`, `peers`, `large`, `optimal`, `occlusion`, `mobile` or `stacked`.
    pub experiment: String,
    /// `clearway`, `paper`, `traversability`, `shortest_path`, `brute_force`, `exact`, `farthest`, `largest`, `all_known`,
    /// `fixed_base`, `streams`, `streams_incremental` or `sequences`.
    pub planner: String,
    pub objects: usize,
    /// Of the exploration limit: `1`, `grasp` or `all`.
    pub first_limit: String,
    /// What the scene was drawn with, and its SHA-256.
    pub least_removals: usize,
    pub scene_seed: u64,
    pub scene: String,
    /// What was planned with.
    pub seed: u64,
    /// `solved`, `out_of_budget`, `impossible`, or `refused` by the verifier.
    pub status: String,
    /// The verifier's: `valid`, `violations`, or `none` without a plan.
    pub verdict: String,
    /// |O_r|; without a plan, 0.
    pub removed: usize,
    pub order: Vec<String>,
    /// At least so many are needed, and by what kind of proof.
    pub bound: usize,
    pub bound_kind: String,
    /// The fewest over the frozen set of ways, where that was found out.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub optimum: Option<usize>,
    pub iterations: u64,
    pub sequences: u64,
    pub samples: usize,
    pub roadmap_nodes: usize,
    pub retrieval_nodes: usize,
    /// How long the robot moves.
    pub motion: f64,
    /// Of `graphs`: how both grew.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub growth: Vec<Growth>,
    /// Of `mobile`: how often the base drives from one stop to another.
    #[serde(default)]
    pub base_moves: usize,
    /// Of `occlusion`: planning before each action.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub actions: Vec<f64>,
    pub timing: Timing,
    pub version: String,
    pub machine: Machine,
}

/// What tells a run from all others of its experiment.
pub type Key = (String, usize, usize, String, u64, u64);

impl Row {
    pub fn key(&self) -> Key {
        let Self { planner, objects, least_removals, first_limit, scene_seed, seed, .. } = self.clone();
        (planner, objects, least_removals, first_limit, scene_seed, seed)
    }
}

/// After an iteration of Algorithm 1.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Growth {
    pub exploration_limit: usize,
    pub roadmap_nodes: usize,
    pub retrieval_nodes: usize,
}

/// What differs from run to run.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Timing {
    /// To a complete timed plan: task planning and motion planning.
    pub total: f64,
    pub task: f64,
    pub motion: f64,
    /// Lower bound and verification.
    pub judged: f64,
}
