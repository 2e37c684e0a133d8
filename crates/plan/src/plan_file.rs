//! The plan file: `clearway-plan/1`. Whole: a checker needs nothing else but the meshes it names.
//! Written strictly, read leniently: unknown keys are ignored, and `null` is as good as a key that
//! is not there wherever it need not be.

use crate::clearance::Clearance;
use crate::number_or::{NumberOr, number_or};
use crate::push::Push;
use crate::robot_file::Grasps;
use crate::scene_file::{Assumed, SceneFile};
use schemars::JsonSchema;
use serde::{Deserialize, Deserializer, Serialize};
use std::collections::BTreeMap;

pub const FORMAT: &str = "clearway-plan/1";

fn null_is_default<'de, D: Deserializer<'de>, T: Deserialize<'de> + Default>(deserializer: D) -> Result<T, D::Error> {
    Ok(Option::deserialize(deserializer)?.unwrap_or_default())
}

/// A plan, or the account of why there is none.
#[derive(Clone, Debug, Serialize, Deserialize, JsonSchema)]
pub struct PlanFile {
    /// `clearway-plan/1`.
    pub format: String,
    pub status: Status,
    pub seed: u64,
    /// The scene file's content, defaults filled in, supports snapped.
    pub scene: SceneFile,
    /// What was filled in for want of better knowledge.
    #[serde(default, skip_serializing_if = "Assumed::is_nothing", deserialize_with = "null_is_default")]
    pub assumed: Assumed,
    pub robot: PlannedRobot,
    /// The objects removed, in order; the target is the last.
    #[serde(default, deserialize_with = "null_is_default")]
    pub removed: Vec<String>,
    /// What was asked for, in PDDL, if it is not to have the target: then any object may be moved, more than once,
    /// and left on whatever carries it; `removed` has each object by its last step.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub goal: Option<String>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub lower_bound: Option<LowerBound>,
    #[serde(default, deserialize_with = "null_is_default")]
    pub steps: Vec<Step>,
    /// For a partly observed scene: what was known before each step.
    #[serde(default, skip_serializing_if = "Vec::is_empty", deserialize_with = "null_is_default")]
    pub known: Vec<Known>,
    /// The room that the motions keep.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub clearance: Option<Clearance>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub trace: Option<Trace>,
    #[serde(default, deserialize_with = "null_is_default")]
    pub timing: Timing,
    #[serde(default, deserialize_with = "null_is_default")]
    pub stats: Stats,
    #[serde(default, deserialize_with = "null_is_default")]
    pub why: Why,
}

impl PlanFile {
    /// Seconds of motion.
    pub fn duration(&self) -> f64 {
        self.steps.iter().map(Step::duration).fold(0.0, |sum, step| sum + step)
    }

    /// Where a mobile base drives, in order: between stops, whatever is stopped at in between.
    pub fn drives(&self) -> Vec<Drive> {
        let column = |name: &String| self.robot.joints.iter().position(|j| j == name);
        let columns: Option<Vec<usize>> = self.robot.base_joints.iter().map(column).collect();
        let Some(&[x, y, yaw]) = columns.as_deref() else { return Vec::new() };
        let mut drives = Vec::new();
        for (index, step) in self.steps.iter().enumerate() {
            for segment in &step.segments {
                let at = |row: Option<&Vec<f64>>| {
                    let value = |i: usize| row.and_then(|r| r.get(i)).copied().unwrap_or_default();
                    [value(x), value(y), value(yaw)]
                };
                let (from, to) = (at(segment.positions.first()), at(segment.positions.last()));
                if from != to {
                    let seconds = segment.times.last().copied().unwrap_or_default();
                    drives.push(Drive { step: index, from, to, seconds, carrying: segment.attached.is_some() });
                }
            }
        }
        drives
    }

    /// A file for a scene that has no plan; everything but the scene is empty.
    pub fn unsolved(scene: SceneFile) -> Self {
        Self {
            format: FORMAT.to_owned(),
            status: Status::OutOfBudget,
            seed: 0,
            scene,
            assumed: Assumed::default(),
            robot: PlannedRobot::default(),
            removed: Vec::new(),
            goal: None,
            lower_bound: None,
            steps: Vec::new(),
            known: Vec::new(),
            clearance: None,
            trace: None,
            timing: Timing::default(),
            stats: Stats::default(),
            why: Why::default(),
        }
    }
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Status {
    Solved,
    /// Proved: no plan exists over the declared grasps.
    Impossible,
    /// The budget was spent; nothing is proved.
    OutOfBudget,
}

/// A mobile base's way from one stop to another: values of its joints.
#[derive(Clone, Debug, PartialEq)]
pub struct Drive {
    /// From 0.
    pub step: usize,
    pub from: [f64; 3],
    pub to: [f64; 3],
    pub seconds: f64,
    /// With the object in hand.
    pub carrying: bool,
}

/// The robot as planned for.
#[derive(Clone, Debug, Default, Serialize, Deserialize, JsonSchema)]
pub struct PlannedRobot {
    /// The whole URDF, as text.
    pub urdf: String,
    /// The columns of every segment's `positions`.
    pub joints: Vec<String>,
    /// Those of them that drive a mobile base: x, y, yaw.
    #[serde(default, skip_serializing_if = "Vec::is_empty", deserialize_with = "null_is_default")]
    pub base_joints: Vec<String>,
    /// The link that `pose_in_tool` is seen from.
    pub tool: String,
    /// Joints not in `joints`, held at these values.
    #[serde(default, deserialize_with = "null_is_default")]
    pub fixed: BTreeMap<String, f64>,
    #[serde(default, deserialize_with = "null_is_default")]
    pub home: BTreeMap<String, f64>,
    pub limits: JointLimits,
    pub hand: PlannedHand,
    /// The preset grasps, as the robot file declares them.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub grasps: Option<Grasps>,
    /// Link pairs that are not checked: adjacent, of the hand, or (nearly) always touching.
    #[serde(default, deserialize_with = "null_is_default")]
    pub unchecked_pairs: Vec<[String; 2]>,
    #[serde(default, deserialize_with = "null_is_default")]
    pub meshes: Vec<MeshFile>,
}

/// By joint name: rad/s, rad/s² and rad/s³; m/s, m/s² and m/s³ for joints that slide.
#[derive(Clone, Debug, Default, Serialize, Deserialize, JsonSchema)]
pub struct JointLimits {
    pub velocity: BTreeMap<String, f64>,
    pub acceleration: BTreeMap<String, f64>,
    /// Missing if the plan promises nothing about jerk.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub jerk: Option<BTreeMap<String, f64>>,
}

#[derive(Clone, Debug, Default, Serialize, Deserialize, JsonSchema)]
pub struct PlannedHand {
    /// `parallel` or `suction`.
    pub kind: String,
    pub frame: String,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub joint: Option<String>,
    /// Joint value → gap between the pads, metres.
    #[serde(default, deserialize_with = "null_is_default")]
    pub opening: BTreeMap<String, f64>,
    pub links: Vec<String>,
    pub base_radius: f64,
    pub finger_thickness: f64,
    /// The cup's radius, metres; suction only.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub radius: Option<f64>,
}

/// A mesh that the URDF or the scene names.
#[derive(Clone, Debug, Serialize, Deserialize, JsonSchema)]
pub struct MeshFile {
    /// As written in the URDF or the scene.
    pub uri: String,
    /// Relative to the plan file.
    pub file: String,
    pub sha256: String,
}

/// One object taken (or pushed) and put away.
#[derive(Clone, Debug, Serialize, Deserialize, JsonSchema)]
pub struct Step {
    pub object: String,
    pub action: Action,
    pub segments: Vec<Segment>,
    pub placed: PlacedPose,
    /// Of a step that pushes.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub push: Option<Push>,
}

impl Step {
    /// Seconds of motion.
    pub fn duration(&self) -> f64 {
        // Nothing adds up to -0.
        self.segments.iter().filter_map(|s| s.times.last()).fold(0.0, |sum, last| sum + last)
    }
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Action {
    PickPlace,
    Push,
}

/// A motion with one purpose. Rows are joint positions; straight lines in between.
#[derive(Clone, Debug, Serialize, Deserialize, JsonSchema)]
pub struct Segment {
    pub kind: SegmentKind,
    /// Seconds from the segment's start, rising from 0, at most 0.02 apart.
    pub times: Vec<f64>,
    /// A row per time, a column per joint.
    pub positions: Vec<Vec<f64>>,
    /// Gripper joint → value, or a value per row. Others follow by `<mimic>`.
    #[serde(default, deserialize_with = "null_is_default")]
    pub gripper: BTreeMap<String, GripperValue>,
    /// Given exactly while the hand holds the object.
    pub attached: Option<Attached>,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum SegmentKind {
    Transit,
    Approach,
    Grasp,
    Transfer,
    Release,
    Retreat,
    Push,
}

#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
#[serde(untagged)]
pub enum GripperValue {
    Held(f64),
    Rows(Vec<f64>),
}

impl<'de> Deserialize<'de> for GripperValue {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        Ok(match number_or(deserializer, "a number, or a list with one per row")? {
            NumberOr::Number(value) => Self::Held(value),
            NumberOr::Other(values) => Self::Rows(values),
        })
    }
}

#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Attached {
    pub object: String,
    pub tool: String,
    pub pose_in_tool: PlacedPose,
}

/// A pose as plans write it; the quaternion is `[x, y, z, w]`.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct PlacedPose {
    pub position: [f64; 3],
    pub quaternion: [f64; 4],
}

/// What was known before a step: the camera looked as the objects stood then.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Known {
    /// From 0.
    pub step: usize,
    /// All objects seen by then, those put down elsewhere included.
    pub seen: Vec<String>,
    /// Those of them that came into view since the step before.
    pub new: Vec<String>,
    /// What this step is a part of taking: the target, or an object to look behind.
    pub taking: String,
    /// Of the places where the target could stand, not in view as yet, the part to be looked at with that
    /// object gone; once the target is seen there are none.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub chance: Option<f64>,
    /// Seconds of planning.
    pub planning: f64,
}

/// How many removals every plan needs, the target included, and what proves it.
#[derive(Clone, Debug, Serialize, Deserialize, JsonSchema)]
pub struct LowerBound {
    pub removed: usize,
    /// `geometric`, `grasps` or `roadmap`.
    pub kind: String,
    /// For `grasps` a [`crate::proof::GraspsProof`].
    pub proof: serde_json::Value,
}

/// What the planner built, for the viewer and for figures.
#[derive(Clone, Debug, Default, Serialize, Deserialize, JsonSchema)]
pub struct Trace {
    pub roadmap: RoadmapTrace,
    pub retrieval_graph: GraphTrace,
}

#[derive(Clone, Debug, Default, Serialize, Deserialize, JsonSchema)]
pub struct RoadmapTrace {
    /// Footprint radius r_b of the target with the gripper, metres.
    pub footprint_radius: f64,
    /// World x and y. Node 0 is x_s, node 1 is x_g.
    pub nodes: Vec<[f64; 2]>,
    pub edges: Vec<[usize; 2]>,
    /// Col(x), one per node.
    pub collisions: Vec<Vec<String>>,
    /// The nodes of the path taken, from x_s to x_g.
    pub path: Vec<usize>,
}

#[derive(Clone, Debug, Default, Serialize, Deserialize, JsonSchema)]
pub struct GraphTrace {
    pub nodes: Vec<GraphNodeTrace>,
    pub edges: Vec<[usize; 2]>,
    /// The nodes of the best path, from n_s to n_g.
    pub path: Vec<usize>,
}

#[derive(Clone, Debug, Default, Serialize, Deserialize, JsonSchema)]
pub struct GraphNodeTrace {
    /// NodeCol.
    pub collisions: Vec<String>,
    /// How many roadmap nodes it clusters; 0 for a node made from a failure.
    pub roadmap_nodes: usize,
    /// Mean of its roadmap nodes, world x and y; of the object for a node made from a failure.
    pub position: [f64; 2],
    /// For a node made from a failed feasibility check: the object that could not be taken.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub blocks: Option<String>,
}

/// Wall-clock seconds of planning alone.
#[derive(Clone, Debug, Default, Serialize, Deserialize, JsonSchema)]
pub struct Timing {
    pub total: f64,
    pub task: f64,
    pub motion: f64,
}

#[derive(Clone, Debug, Default, Serialize, Deserialize, JsonSchema)]
pub struct Stats {
    /// Rounds of Algorithm 1; calls of the symbolic engine, where symbols and streams planned.
    pub iterations: usize,
    /// *L* of the last round.
    pub exploration_limit: usize,
    pub roadmap_nodes: usize,
    pub retrieval_nodes: usize,
    /// Of the roadmap; calls of streams, where those planned.
    pub samples: usize,
    pub sequences_tried: usize,
    /// Grasp postures looked at.
    #[serde(default, deserialize_with = "null_is_default")]
    pub grasps_tried: usize,
}

/// Why these objects, in this order; for a failure, what stood in the way.
#[derive(Clone, Debug, Default, Serialize, Deserialize, JsonSchema)]
pub struct Why {
    /// The verdict in a sentence.
    #[serde(default, deserialize_with = "null_is_default")]
    pub summary: String,
    #[serde(default, deserialize_with = "null_is_default")]
    pub objects: Vec<ObjectWhy>,
    /// For a failure with a mobile base: the sides from which the target could be reached.
    #[serde(default, deserialize_with = "null_is_default", skip_serializing_if = "Vec::is_empty")]
    pub sides: Vec<SideWhy>,
}

/// Where a mobile base would have to stand to reach the target from one side.
#[derive(Clone, Debug, Default, Serialize, Deserialize, JsonSchema)]
pub struct SideWhy {
    /// The direction from the target, from the world's x to the left, radians.
    pub bearing: f64,
    /// Placements drawn there, and those of them at which the robot can stand.
    pub tried: usize,
    pub free: usize,
    /// What the robot meets at the others, the most frequent first.
    pub blocked_by: Vec<String>,
}

/// What was learned about taking one object.
#[derive(Clone, Debug, Default, Serialize, Deserialize, JsonSchema)]
pub struct ObjectWhy {
    pub object: String,
    /// In the order of removal, from 1; 0 when it was not removed.
    #[serde(default, deserialize_with = "null_is_default")]
    pub order: usize,
    /// What this object stood in the way of, in words.
    #[serde(default, deserialize_with = "null_is_default")]
    pub reason: String,
    /// The objects that could not be had, or the target not brought out, while it stood.
    #[serde(default, deserialize_with = "null_is_default")]
    pub blocked: Vec<String>,
    /// Each set is one way in: all of its objects have to go first.
    #[serde(default, deserialize_with = "null_is_default")]
    pub blocked_by: Vec<Vec<String>>,
    /// How it was pushed, or why it was picked rather than pushed.
    #[serde(default, deserialize_with = "null_is_default", skip_serializing_if = "String::is_empty")]
    pub push: String,
    /// It is not held firmly: it may turn or slip in the hand.
    #[serde(default, deserialize_with = "null_is_default", skip_serializing_if = "std::ops::Not::not")]
    pub held_loosely: bool,
    /// Grasps looked at, by what became of them.
    #[serde(default, deserialize_with = "null_is_default")]
    pub grasps: Vec<GraspCount>,
}

/// So many grasp postures ended this way.
#[derive(Clone, Debug, Default, Serialize, Deserialize, JsonSchema)]
pub struct GraspCount {
    pub outcome: String,
    pub count: usize,
}
