//! The grasps that a robot file declares, as poses of the tool in an object's frame: written afresh.

use crate::shapes::{Piece, extent, pose_from};
use clearway_plan::robot_file::{GraspKind, Grasps};
use parry3d_f64::math::{Pose, Rotation, Vector};
use std::f64::consts::{PI, TAU};

/// An object deeper than this is held with the finger tips, too, [`PAD`] behind its front, one with a box in it sooner:
/// metres.
const DEEP: f64 = 0.09;
const DEEP_BOX: f64 = 0.06;
const PAD: f64 = 0.02;
/// How far from upright a box's side may be: the sine of the angle.
const UPRIGHT: f64 = 0.01;
/// What is deep by rounding alone is not, metres.
const ROUNDING: f64 = 1e-6;
/// Directions closer than this are one, radians.
const SAME: f64 = 1e-6;

/// The poses for a parallel hand round an object that stands at `world_from_object`, in the order of the
/// file. `flips`: whether the hand may be upside down, too.
pub(super) fn declared(grasps: &Grasps, pieces: &[Piece], world_from_object: &Pose, flips: bool) -> Option<Vec<Pose>> {
    if grasps.kind == GraspKind::List || !grasps.list.is_empty() {
        return grasps.list.iter().map(|keys| pose_from(keys.position, keys.rpy, keys.quaternion)).collect();
    }
    let mut poses = Vec::new();
    let deeper = if pieces.iter().any(|p| p.shape.as_cuboid().is_some()) { DEEP_BOX } else { DEEP };
    let yaws = yaws(pieces, world_from_object, grasps.yaws);
    for &height in &grasps.heights {
        for yaw in &yaws {
            // Seen along the way that the hand points: x across, y up, z forward.
            let turn = Rotation::from_rotation_z(*yaw);
            let world_from_hand = Pose::from_rotation(turn * Rotation::from_xyzw(0.5, 0.5, 0.5, 0.5));
            let (low, high) = extent(pieces, &world_from_hand.inv_mul(world_from_object));
            let middle = (low + high) / 2.0;
            let up = low.y + height * (high.y - low.y);
            let deep = (high.z - low.z > deeper + ROUNDING).then_some(low.z + PAD);
            for forward in [Some(middle.z), deep].into_iter().flatten() {
                let at = Pose::from_translation(Vector::new(middle.x, up, forward));
                poses.push(world_from_object.inv_mul(&(world_from_hand * at)));
            }
        }
    }
    if flips {
        let flip = Pose::from_rotation(Rotation::from_rotation_z(PI));
        let flipped: Vec<Pose> = poses.iter().map(|p| *p * flip).collect();
        poses.extend(flipped);
    }
    Some(poses)
}

/// Where the hand points: evenly spread, and straight at every upright side of a box, unless that is there already.
fn yaws(pieces: &[Piece], world_from_object: &Pose, count: usize) -> Vec<f64> {
    let mut yaws: Vec<f64> = (0..count).map(|i| TAU * i as f64 / count as f64).collect();
    for piece in pieces.iter().filter(|p| p.shape.as_cuboid().is_some()) {
        let turn = world_from_object.rotation * piece.pose.rotation;
        for axis in [Vector::X, Vector::Y, Vector::Z] {
            for outwards in [turn * axis, turn * -axis] {
                if outwards.z.abs() >= UPRIGHT {
                    continue;
                }
                let yaw = (-outwards.y).atan2(-outwards.x);
                let apart = |other: &f64| (yaw - other).rem_euclid(TAU).min((other - yaw).rem_euclid(TAU));
                if yaws.iter().all(|other| apart(other) >= SAME) {
                    yaws.push(yaw);
                }
            }
        }
    }
    yaws
}
