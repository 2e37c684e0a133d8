//! The room that a plan's motions keep.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Measured by the verifier between what moves (the robot's links, what is held or pushed) and all that stands
/// still. What is gripped, let go of or pushed does not count against the hand, nor does what carries an object
/// while it is within 3 cm of where it stood or is put, nor neighbours that are nearer there from the beginning.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Clearance {
    /// By the scene, metres.
    pub asked: f64,
    /// The least there is, metres; nothing comes nearer than `up_to` if it is missing.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub least: Option<Least>,
    /// Larger distances are not looked for, metres.
    pub up_to: f64,
}

/// Where the least room is.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Least {
    /// Metres.
    pub distance: f64,
    /// From 0.
    pub step: usize,
    pub segment: usize,
    /// Seconds from the plan's start.
    pub time: f64,
    /// What moves, and what it comes near, in words: `link left_finger`, `object o3`, `fixture shelf_floor`.
    pub between: [String; 2],
    /// World.
    pub at: [f64; 3],
}
