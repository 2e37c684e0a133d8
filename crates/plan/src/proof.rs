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
    /// Barriers that the removals have to open as well, weights aside.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub barriers: Option<BarriersProof>,
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

/// Kind `geometric`. Barriers: bodies in a closed chain round the target, each so near the next that the
/// target does not pass between them, whatever carries it. Each has to lose an object. The weights of the
/// barriers that an object is in add up to at most 1, so that the bound is the sum of all weights,
/// rounded up, and one for the target.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct BarriersProof {
    /// What keeps the target from being lifted over them; none without barriers.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub enclosure: Option<Enclosure>,
    pub barriers: Vec<Barrier>,
}

/// The target moves between a floor and a ceiling. Upright, it holds a cylinder of this radius and
/// height about its centre; as long as it leans by no more than `lean`, what is written in docs/lower-bounds.md holds.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Enclosure {
    /// Metres.
    pub radius: f64,
    pub height: f64,
    /// Radians from upright.
    pub lean: f64,
    pub floor: Level,
    pub ceiling: Level,
}

/// A fixture's face.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Level {
    pub fixture: String,
    /// World z, metres.
    pub z: f64,
}

#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Barrier {
    pub weight: f64,
    /// The objects in it: one of these has to go.
    pub objects: Vec<String>,
    /// The closed chain, in order.
    pub chain: Vec<ChainLink>,
}

/// The chain runs past this object or fixture, nearer than the radius to it, from where it left the one
/// before to `to`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct ChainLink {
    pub body: String,
    /// World x and y, metres.
    pub to: [f64; 2],
}
