//! The motion problem, as written: `clearway-motion/1`. What it means is checked by `clearway-motion`.

use crate::robot_file::PerJoint;
use crate::scene_file::{Body, BoxKeys, CylinderKeys, MeshKeys, Part, PoseKeys, SphereKeys};
use schemars::JsonSchema;
use serde::de::value::{MapAccessDeserializer, SeqAccessDeserializer};
use serde::de::{Deserializer, MapAccess, SeqAccess, Visitor};
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;
use std::fmt;

pub const FORMAT: &str = "clearway-motion/1";

/// Plain motion planning: a robot, obstacles, a start, goals; wanted is a path.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct MotionFile {
    /// `clearway-motion/1`.
    pub format: String,
    pub robot: MotionRobot,
    /// The URDF's root link in the world.
    #[serde(default)]
    pub base: PoseKeys,
    /// What the robot keeps clear of, in the world: a scene file's fixtures.
    #[serde(default)]
    pub obstacles: Vec<Body>,
    /// What the robot holds all the way.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub attached: Option<Attached>,
    pub start: JointValues,
    /// Any one of them is to be reached.
    pub goals: Vec<JointValues>,
    /// Closer than this to an obstacle counts as touching it, metres.
    #[serde(default)]
    pub margin: f64,
    /// Longest new motion of the search, radians of joint distance.
    #[serde(default = "default_range")]
    pub range: f64,
    /// Samples per radian of joint distance, at least; what lies between them is checked as well.
    #[serde(default = "default_checks")]
    pub checks_per_rad: f64,
    /// For the trajectory. Default: the robot file's; without one there is no trajectory.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub limits: Option<MotionLimits>,
}

fn default_range() -> f64 {
    1.0
}

fn default_checks() -> f64 {
    32.0
}

/// Either `model`, or `urdf` and what belongs to it. Paths are relative to this file.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct MotionRobot {
    /// A built-in robot's name, or the path of a robot file: its arm is planned for, its hand open.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub model: Option<String>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub urdf: Option<String>,
    /// Pairs of links never checked.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub srdf: Option<String>,
    /// The joints to plan for, in the order of the postures. Default: all that move on their own.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub joints: Option<Vec<String>>,
    /// Other joints, held at these values. Default: 0, or the limit nearest to it.
    #[serde(default, skip_serializing_if = "BTreeMap::is_empty")]
    pub fixed: BTreeMap<String, f64>,
    /// For `package://` in the URDF: name → directory.
    #[serde(default, skip_serializing_if = "BTreeMap::is_empty")]
    pub packages: BTreeMap<String, String>,
}

/// What a link holds: exactly one shape key, and the pose of the shape's centre in the link.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Attached {
    /// For messages; default: `attached`.
    #[serde(default = "attached")]
    pub id: String,
    /// The link of the URDF that holds it.
    pub link: String,
    /// Links that may touch it, those that do not move against it aside.
    #[serde(default)]
    pub touch_links: Vec<String>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub r#box: Option<BoxKeys>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub cylinder: Option<CylinderKeys>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub sphere: Option<SphereKeys>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub capsule: Option<CylinderKeys>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub mesh: Option<MeshKeys>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub compound: Option<Vec<Part>>,
    #[serde(default)]
    pub position: [f64; 3],
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub rpy: Option<[f64; 3]>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub quaternion: Option<[f64; 4]>,
}

fn attached() -> String {
    "attached".to_owned()
}

impl Attached {
    /// The shape and its pose, the link aside.
    pub fn body(&self) -> Body {
        Body {
            id: self.id.clone(),
            r#box: self.r#box.clone(),
            cylinder: self.cylinder.clone(),
            sphere: self.sphere.clone(),
            capsule: self.capsule.clone(),
            mesh: self.mesh.clone(),
            points: None,
            compound: self.compound.clone(),
            position: self.position,
            rpy: self.rpy,
            quaternion: self.quaternion,
            ..Body::default()
        }
    }
}

/// What URDF has no word for: acceleration (rad/s², m/s²) and jerk (rad/s³, m/s³).
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct MotionLimits {
    pub acceleration: PerJoint,
    /// Default: the robot file's; without one, 80.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub jerk: Option<PerJoint>,
}

/// A value per joint planned for, radians or metres: by name, or a list in the joints' order.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
#[serde(untagged)]
pub enum JointValues {
    ByName(BTreeMap<String, f64>),
    InOrder(Vec<f64>),
}

impl<'de> Deserialize<'de> for JointValues {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        deserializer.deserialize_any(EitherForm)
    }
}

struct EitherForm;

impl<'de> Visitor<'de> for EitherForm {
    type Value = JointValues;

    fn expecting(&self, f: &mut fmt::Formatter) -> fmt::Result {
        f.write_str("a mapping from joint to number, or a list of numbers")
    }

    fn visit_seq<A: SeqAccess<'de>>(self, list: A) -> Result<Self::Value, A::Error> {
        Vec::deserialize(SeqAccessDeserializer::new(list)).map(JointValues::InOrder)
    }

    fn visit_map<A: MapAccess<'de>>(self, mapping: A) -> Result<Self::Value, A::Error> {
        BTreeMap::deserialize(MapAccessDeserializer::new(mapping)).map(JointValues::ByName)
    }
}
