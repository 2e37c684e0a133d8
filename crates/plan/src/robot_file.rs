//! The robot file, as written: `clearway-robot/1`. What it means is checked by `clearway-robot`.

use crate::number_or::{NumberOr, number_or};
use crate::scene_file::PoseKeys;
use schemars::JsonSchema;
use serde::{Deserialize, Deserializer, Serialize};
use std::collections::BTreeMap;

pub const FORMAT: &str = "clearway-robot/1";

/// A URDF, and what it does not say: the chain to plan for, the hand, the grasps.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct RobotFile {
    /// `clearway-robot/1`.
    pub format: String,
    /// The URDF, relative to this file.
    pub urdf: String,
    /// An SRDF, relative to this file: pairs never checked, named states.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub srdf: Option<String>,
    /// For `package://` in the URDF: name → directory, relative to this file.
    #[serde(default, skip_serializing_if = "BTreeMap::is_empty")]
    pub packages: BTreeMap<String, String>,
    pub arm: Arm,
    /// Other joints, held at these values.
    #[serde(default, skip_serializing_if = "BTreeMap::is_empty")]
    pub fixed: BTreeMap<String, f64>,
    /// The resting posture: joint → value. Default: 0, or the limit nearest to it.
    #[serde(default)]
    pub home: BTreeMap<String, f64>,
    #[serde(default)]
    pub limits: Limits,
    pub hand: Hand,
    #[serde(default)]
    pub grasps: Grasps,
    /// Default: none.
    #[serde(default)]
    pub mobile: Mobile,
}

/// The chain that is planned for: from link `base` to link `tip`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Arm {
    pub base: String,
    pub tip: String,
}

/// What URDF has no word for: acceleration (rad/s², m/s²) and jerk (rad/s³, m/s³).
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Limits {
    #[serde(default = "default_acceleration")]
    pub acceleration: PerJoint,
    #[serde(default = "default_jerk")]
    pub jerk: PerJoint,
}

impl Default for Limits {
    fn default() -> Self {
        Self { acceleration: default_acceleration(), jerk: default_jerk() }
    }
}

fn default_acceleration() -> PerJoint {
    PerJoint::All(8.0)
}

fn default_jerk() -> PerJoint {
    PerJoint::All(80.0)
}

/// One number for all joints, or one by joint.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
#[serde(untagged)]
pub enum PerJoint {
    All(f64),
    ByJoint(BTreeMap<String, f64>),
}

impl<'de> Deserialize<'de> for PerJoint {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        Ok(match number_or(deserializer, "a number for all joints, or a mapping from joint to number")? {
            NumberOr::Number(value) => Self::All(value),
            NumberOr::Other(values) => Self::ByJoint(values),
        })
    }
}

/// What grips.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Hand {
    pub kind: HandKind,
    /// A link of the URDF. Parallel: midway between the finger pads; z points at the object, x is
    /// the way the fingers close. Suction: the cup's centre, z out of the cup.
    pub frame: String,
    /// The joint that opens a parallel hand; others follow by `<mimic>`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub joint: Option<String>,
    /// Joint value → gap between the pads (metres).
    #[serde(default, skip_serializing_if = "BTreeMap::is_empty")]
    pub opening: BTreeMap<String, f64>,
    /// The only links that may touch what is gripped.
    pub links: Vec<String>,
    /// r_base of Appendix B: half the length of the hand's base, metres.
    #[serde(default)]
    pub base_radius: f64,
    /// r_f of Appendix B, metres.
    #[serde(default)]
    pub finger_thickness: f64,
}

#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum HandKind {
    /// Two fingers that close along the frame's x.
    Parallel,
    /// A cup of this radius, metres.
    Suction { radius: f64 },
}

/// The preset grasps: rings round the object, or a list.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Grasps {
    #[serde(default)]
    pub kind: GraspKind,
    /// How many directions round the object, evenly spread; boxes are taken square to their sides as well.
    #[serde(default = "default_yaws")]
    pub yaws: usize,
    /// Fractions of the object's height.
    #[serde(default = "default_heights")]
    pub heights: Vec<f64>,
    /// How far before the grasp the straight approach begins, metres.
    #[serde(default = "default_standoff")]
    pub standoff: f64,
    /// Poses of the hand's frame in the object's frame; instead of the rings.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub list: Vec<PoseKeys>,
}

impl Default for Grasps {
    fn default() -> Self {
        Self {
            kind: GraspKind::Side,
            yaws: default_yaws(),
            heights: default_heights(),
            standoff: default_standoff(),
            list: Vec::new(),
        }
    }
}

#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum GraspKind {
    /// The hand comes level, from the side.
    #[default]
    Side,
    /// The poses under `list`.
    List,
}

fn default_yaws() -> usize {
    24
}

fn default_heights() -> Vec<f64> {
    vec![0.35, 0.5, 0.65]
}

fn default_standoff() -> f64 {
    0.10
}

/// Whether the base drives.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Mobile {
    #[default]
    None,
    /// x, y, yaw of the base; joints that the URDF lacks are added above its root.
    Planar { joints: [String; 3], velocity: [f64; 3] },
}
