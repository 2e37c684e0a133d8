//! Where every object ended, against where the plan says.

use crate::bodies::Object;
use crate::outcome::End;
use crate::settings::Settings;
use parry3d_f64::math::{Pose, Vector};

/// Degrees: more is fallen.
const LIES: f64 = 45.0;
/// Metres: so much lower is fallen.
const LOWER: f64 = 0.05;

/// Where an object should be in the end.
pub(crate) struct Expected {
    pub pose: Pose,
    pub moved: bool,
}

pub(crate) fn end(id: &str, object: &Object, expected: &Expected, found: Pose, settings: &Settings) -> End {
    let away = found.translation - expected.pose.translation;
    let level = away.x.hypot(away.y);
    let up = |pose: &Pose| pose.rotation * (expected.pose.rotation.inverse() * Vector::Z);
    // A ball may roll in its place.
    let round = object.shapes.iter().all(|s| s.shape.as_ball().is_some());
    let tilt = if round { 0.0 } else { up(&found).dot(Vector::Z).clamp(-1.0, 1.0).acos().to_degrees() };
    let tolerance = if expected.moved { settings.moved } else { settings.unmoved };
    let fallen = tilt > LIES || away.z < -LOWER;
    End {
        object: id.to_owned(),
        moved: expected.moved,
        expected: expected.pose.translation.to_array(),
        found: found.translation.to_array(),
        level,
        distance: away.length(),
        tilt,
        fallen,
        // Written so that NaN is elsewhere too.
        elsewhere: fallen || !(away.length() <= tolerance.position && tilt <= tolerance.tilt),
        mass: object.mass,
        friction: object.friction,
        assumed: object.assumed,
    }
}
