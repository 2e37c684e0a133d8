//! The scene file, as written: `clearway-scene/1`. What it means is checked by `clearway-scene`.

use crate::number_or::{NumberOr, number_or};
use clearway_geometry::{Pose, Vec3};
use schemars::JsonSchema;
use serde::{Deserialize, Deserializer, Serialize};
use std::collections::BTreeMap;

pub const FORMAT: &str = "clearway-scene/1";

/// A cluttered scene: a robot, what may not be moved, what may, and the object wanted.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct SceneFile {
    /// `clearway-scene/1`.
    pub format: String,
    #[serde(default, skip_serializing_if = "String::is_empty")]
    pub name: String,
    /// The name other programs know the world frame by.
    #[serde(default = "world")]
    pub frame: String,
    pub robot: RobotPlacement,
    /// What nothing may touch and nobody may move.
    #[serde(default)]
    pub fixtures: Vec<Body>,
    /// What may be moved.
    pub objects: Vec<Body>,
    /// The id of the object wanted.
    pub target: String,
    /// Flat places for what is removed, the target included.
    #[serde(default)]
    pub place: Vec<PlaceArea>,
    /// Where the roadmap samples. Default: the objects' surroundings up to the opening.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub workspace: Option<Rect>,
    /// The target's start configuration x_s outside, world x and y. Default: found.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub exit: Option<[f64; 2]>,
    /// Makes the scene partly observed.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub camera: Option<Camera>,
    /// What a plan with a mobile base costs.
    #[serde(default, skip_serializing_if = "Weights::is_default")]
    pub weights: Weights,
    /// Room that every motion keeps, metres. What stands nearer to an object than this leaves it that much less
    /// when the object is drawn out or put down. Default: 0, which is not to touch.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub clearance: Option<f64>,
    /// Coefficient of friction of objects that give none of their own. Default: 0.4.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub friction: Option<f64>,
}

/// Coefficient of friction where the scene gives none: glass or a tin on wood.
pub const FRICTION: f64 = 0.4;
/// Of objects whose mass is not given, kg/m³ of their shape: bottles and boxes partly filled.
pub const DENSITY: f64 = 500.0;

/// The objects for which the scene file gives no mass or no friction: the defaults above are filled in.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
pub struct Assumed {
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub mass: Vec<String>,
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub friction: Vec<String>,
}

impl Assumed {
    pub fn is_nothing(&self) -> bool {
        self.mass.is_empty() && self.friction.is_empty()
    }
}

/// What a plan with a mobile base costs: the least sum is looked for. By default removals count first,
/// then moves of the base, then time.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Weights {
    /// For each object removed, the target included.
    #[serde(default = "Weights::removal")]
    pub removal: f64,
    /// For each move of the base from one stop to another.
    #[serde(default = "Weights::base_move")]
    pub base_move: f64,
    /// For each second of driving.
    #[serde(default = "Weights::second")]
    pub second: f64,
}

impl Weights {
    fn removal() -> f64 {
        10_000.0
    }

    fn base_move() -> f64 {
        100.0
    }

    fn second() -> f64 {
        1.0
    }

    fn is_default(&self) -> bool {
        *self == Self::default()
    }
}

impl Default for Weights {
    fn default() -> Self {
        Self { removal: Self::removal(), base_move: Self::base_move(), second: Self::second() }
    }
}

fn world() -> String {
    "world".to_owned()
}

/// Which robot, where, and how it starts.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct RobotPlacement {
    /// A built-in robot's name, or the path of a robot file, relative to the scene file.
    pub model: String,
    /// The URDF's root link in the world.
    #[serde(default)]
    pub base: PoseKeys,
    /// Joint values at the start. Default: the robot's `home`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub start: Option<BTreeMap<String, f64>>,
    /// Where a mobile base may drive, in the world.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub region: Option<Rect>,
}

/// A pose: metres; either `rpy` (URDF's fixed axes, radians) or `quaternion` (`[x, y, z, w]`).
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct PoseKeys {
    #[serde(default)]
    pub position: [f64; 3],
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub rpy: Option<[f64; 3]>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub quaternion: Option<[f64; 4]>,
}

impl PoseKeys {
    /// The pose they name; a quaternion wins over `rpy`.
    pub fn pose(&self) -> Pose {
        let position = Vec3::from_array(self.position);
        match self.quaternion {
            Some(quaternion) => Pose::from_quaternion(quaternion, position),
            None => Pose::from_rpy(self.rpy.unwrap_or_default(), position),
        }
    }
}

/// A fixture or an object: an id, exactly one shape key, and the pose of the shape's centre.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Body {
    pub id: String,
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
    /// A point cloud; fixtures only.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub points: Option<PointsKeys>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub compound: Option<Vec<Part>>,
    #[serde(default)]
    pub position: [f64; 3],
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub rpy: Option<[f64; 3]>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub quaternion: Option<[f64; 4]>,
    /// Objects only: kilograms. Default: 500 kg/m³ of its shape.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub mass: Option<f64>,
    /// Objects only: coefficient of friction against whatever it touches; between two objects the larger
    /// one counts. Default: the scene's.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub friction: Option<f64>,
}

/// One shape of a compound, and its pose in the compound.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Part {
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
    #[serde(default)]
    pub position: [f64; 3],
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub rpy: Option<[f64; 3]>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub quaternion: Option<[f64; 4]>,
}

/// Full edge lengths along x, y, z.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct BoxKeys {
    pub size: [f64; 3],
}

/// Along z. A cylinder's height is its full height, a capsule's that of its cylindrical part.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct CylinderKeys {
    pub radius: f64,
    pub height: f64,
}

#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct SphereKeys {
    pub radius: f64,
}

/// An STL, OBJ or DAE file, relative to the scene file; taken as its convex parts.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct MeshKeys {
    pub file: String,
    /// Default: 1 along each axis.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub scale: Option<Scale>,
}

/// One factor, or one per axis.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
#[serde(untagged)]
pub enum Scale {
    Uniform(f64),
    PerAxis([f64; 3]),
}

impl<'de> Deserialize<'de> for Scale {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        Ok(match number_or(deserializer, "a number, or a list of three")? {
            NumberOr::Number(factor) => Self::Uniform(factor),
            NumberOr::Other(factors) => Self::PerAxis(factors),
        })
    }
}

/// A text file of `x y z` lines (metres), or a PLY or XYZ file; each point a ball of `radius`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct PointsKeys {
    pub file: String,
    pub radius: f64,
}

/// A flat rectangle for putting things down; `position` is the centre of its top face.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct PlaceArea {
    pub id: String,
    /// Full lengths along world x and y.
    pub size: [f64; 2],
    pub position: [f64; 3],
}

/// A rectangle in world x and y.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Rect {
    pub min: [f64; 2],
    pub max: [f64; 2],
}

/// A camera with a square picture; `fov` is its full angle, radians, across and up.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Camera {
    pub position: [f64; 3],
    pub look_at: [f64; 3],
    pub fov: f64,
    /// Motions may go through space that was not seen.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub enter_unseen: bool,
}
