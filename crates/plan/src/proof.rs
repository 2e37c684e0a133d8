//! What proves a lower bound: data that a stranger can check.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Kind `grasps`. Who takes an object comes to one of its declared grasps, the hand open, straight along
/// the tool's z over the standoff, and leaves with it the same way, `lift` above. What the robot comes
/// nearer to than `clearance` there, or the object nearer than `held_clearance`, has to be gone before.
/// The bound is the fewest removals, the target's included, that agree with that; objects that are not
/// listed may go at any time.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct GraspsProof {
    /// Metres, all of these.
    pub standoff: f64,
    pub lift: f64,
    pub clearance: f64,
    pub held_clearance: f64,
    /// The hand joint's value on the way.
    pub hand: f64,
    pub objects: Vec<ObjectCase>,
}

/// Every declared grasp of an object, in the order of the robot file: heights, then directions.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct ObjectCase {
    pub object: String,
    pub grasps: Vec<GraspCase>,
}

#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct GraspCase {
    /// Of the tool, in the object's frame.
    pub position: [f64; 3],
    pub quaternion: [f64; 4],
    /// Whether the open hand goes round the object, and the closed one reaches it.
    pub holds: bool,
    /// All postures of the arm that bring the tool there; none are listed where it does not hold.
    pub branches: Vec<Branch>,
}

#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Branch {
    /// At the grasp: a value per joint of the arm.
    pub posture: Vec<f64>,
    /// What is in the way; of many, enough for the bound. `null` where a fixture or the robot itself is,
    /// or the arm does not reach as far back as the standoff: no way at all.
    pub blocked_by: Option<Vec<String>>,
}
