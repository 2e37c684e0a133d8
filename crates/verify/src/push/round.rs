//! Upright round bodies: cylinders, one on the other about one vertical axis.

use crate::shapes::{Piece, cylinder_along_z};
use parry3d_f64::math::{Pose, Vector};

/// How far cylinders may be off their common axis, and off the height of the foot, metres.
const SAME_AXIS: f64 = 1e-4;
/// How far they may lean, radians.
const UPRIGHT: f64 = 0.01;

/// A round body where it stands before the push.
pub(super) struct Round {
    cylinders: Vec<Upright>,
    /// Radius of the face on which it stands.
    pub foot: f64,
    /// Lowest and highest z.
    pub bottom: f64,
    pub top: f64,
}

struct Upright {
    /// World.
    middle: Vector,
    radius: f64,
    half_height: f64,
}

impl Round {
    /// Or why the body is none.
    pub fn of(pieces: &[Piece], at: &Pose) -> Result<Self, String> {
        let mut cylinders: Vec<Upright> = Vec::new();
        for piece in pieces {
            let pose = *at * piece.pose;
            if piece.shape.as_ball().is_some() {
                return Err("it may roll".to_owned());
            }
            let Some(cylinder) = piece.shape.as_cylinder() else { return Err("it is not round".to_owned()) };
            let lean = (pose.rotation * Vector::Y).cross(Vector::Z).length();
            if lean > UPRIGHT {
                return Err("it does not stand upright".to_owned());
            }
            let (middle, radius, half_height) = (pose.translation, cylinder.radius, cylinder.half_height);
            if cylinders.iter().any(|c| (c.middle - middle).truncate().length() > SAME_AXIS) {
                return Err("its parts have no common axis".to_owned());
            }
            cylinders.push(Upright { middle, radius, half_height });
        }
        let bottom = cylinders.iter().map(|c| c.middle.z - c.half_height).fold(f64::INFINITY, f64::min);
        let top = cylinders.iter().map(|c| c.middle.z + c.half_height).fold(f64::NEG_INFINITY, f64::max);
        let feet = cylinders.iter().filter(|c| c.middle.z - c.half_height <= bottom + SAME_AXIS);
        let foot = feet.map(|c| c.radius).fold(0.0, f64::max);
        Ok(Self { cylinders, foot, bottom, top })
    }

    /// What of it is higher than `height` above its bottom, in the world.
    pub fn above(&self, height: f64) -> Vec<Piece> {
        let cut = |c: &Upright| {
            let top = c.middle.z + c.half_height;
            let low = (self.bottom + height).max(c.middle.z - c.half_height);
            (top > low).then(|| {
                let (turn, shape) = cylinder_along_z(c.radius, top - low);
                let middle = Vector::new(c.middle.x, c.middle.y, f64::midpoint(top, low));
                Piece::new(Pose::from_translation(middle) * turn, shape)
            })
        };
        self.cylinders.iter().filter_map(cut).collect()
    }
}
