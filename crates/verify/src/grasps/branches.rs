//! Every posture of six turning joints that brings the tool to a pose, where the second, third and
//! fourth axis are parallel and the last two meet: written afresh from the model, all in the world.
//!
//! With *h* the common direction and *W* the point where the last axes meet: turning about axes along
//! *h* changes no component along *h*, which leaves one equation for the first angle and one for the
//! fifth; both have two answers. The sixth angle and the sum of the three parallel ones follow from the
//! directions; the rest is a triangle.

use crate::case::Case;
use parry3d_f64::math::{Pose, Rotation, Vector};
use std::f64::consts::TAU;

/// Lines are the same, or parallel, up to this (metres, radians).
const SAME: f64 = 1e-6;
/// An answer brings the tool this near, metres; nearer than rounding at the edge of reach.
const HIT: f64 = 1e-6;

/// The axes at the zero posture.
pub(super) struct Arm<'a> {
    case: &'a Case,
    columns: &'a [usize],
    tool: usize,
    /// Values of all other joints.
    rest: Vec<f64>,
    axes: [(Vector, Vector); 6],
    wrist: Vector,
    tool_at_zero: Pose,
    /// Whether joints 3 and 4 turn the other way than joint 2: ±1.
    signs: [f64; 2],
}

impl<'a> Arm<'a> {
    /// `None` for an arm of another build.
    pub fn new(case: &'a Case, columns: &'a [usize], tool: usize, rest: Vec<f64>) -> Option<Self> {
        if columns.len() != 6 || case.model.moving_joints_above(tool).len() != 6 {
            return None;
        }
        let mut zero = rest.clone();
        columns.iter().for_each(|&c| zero[c] = 0.0);
        let poses = case.link_poses(&zero);
        let axis = |&column: &usize| {
            let joint = &case.model.joints[column];
            let at = poses[joint.parent] * joint.parent_from_joint;
            (at.translation, (at.rotation * joint.axis).normalize())
        };
        let axes: Vec<(Vector, Vector)> = columns.iter().map(axis).collect();
        let axes: [(Vector, Vector); 6] = axes.try_into().ok()?;
        let turns = |&c: &usize| {
            let kind = case.model.joints[c].kind;
            matches!(kind, crate::model::JointKind::Revolute | crate::model::JointKind::Continuous)
        };
        let h = axes[1].1;
        let parallel = |i: usize| h.cross(axes[i].1).length() < SAME;
        if !columns.iter().all(turns) || !parallel(2) || !parallel(3) || parallel(0) {
            return None;
        }
        let wrist = meeting(axes[4], axes[5])?;
        let signs = [h.dot(axes[2].1).signum(), h.dot(axes[3].1).signum()];
        Some(Self { case, columns, tool, rest, axes, wrist, tool_at_zero: poses[tool], signs })
    }

    /// Where the tool is.
    pub fn tool(&self, posture: &[f64]) -> Pose {
        self.case.link_poses(&self.whole(posture))[self.tool]
    }

    /// A value for every joint of the model.
    pub fn whole(&self, posture: &[f64]) -> Vec<f64> {
        let mut whole = self.rest.clone();
        self.columns.iter().zip(posture).for_each(|(&c, q)| whole[c] = *q);
        self.case.model.follow(&mut whole);
        whole
    }

    /// All postures within the joints' limits that bring the tool to a pose in the world, each joint
    /// nearest to `near` of the turns that its limits allow.
    pub fn postures(&self, world_from_tool: &Pose, near: &[f64]) -> Vec<Vec<f64>> {
        let [(p1, a1), (p2, h), (p3, _), (p4, _), (_, a5), (_, a6)] = self.axes;
        let moved = *world_from_tool * self.tool_at_zero.inverse();
        let (turned, wrist) = (moved.rotation, moved.transform_point(self.wrist));
        let mut found = Vec::new();
        // h · rot(a1, −q1)(W − p1) = h · (W₀ − p1)
        for q1 in angles(h, -a1, wrist - p1, h.dot(self.wrist - p1)) {
            let back = about(a1, -q1);
            let rest = back * turned;
            // h · rot(a5, q5) a6 = h · rest a6
            for q5 in angles(h, a5, a6, h.dot(rest * a6)) {
                let fifth = about(a5, q5);
                let q6 = turn(a6, rest.inverse() * h, fifth.inverse() * h);
                let three = rest * about(a6, -q6) * fifth.inverse();
                let across = h.any_orthonormal_vector();
                let sum = turn(h, across, three * across);
                let reach = back * (wrist - p1) + p1 - p2 - three * (self.wrist - p4);
                let (upper, fore, reach) = (off(p3 - p2, h), off(p4 - p3, h), off(reach, h));
                let wanted = (reach.length_squared() - upper.length_squared() - fore.length_squared()) / 2.0;
                for t3 in angles(upper, h, fore, wanted) {
                    let q2 = turn(h, upper + about(h, t3) * fore, reach);
                    let t4 = sum - q2 - t3;
                    found.push(vec![q1, q2, self.signs[0] * t3, self.signs[1] * t4, q5, q6]);
                }
            }
        }
        found.retain_mut(|q| self.within(q, near) && self.hits(q, world_from_tool));
        found
    }

    fn hits(&self, posture: &[f64], world_from_tool: &Pose) -> bool {
        let at = self.tool(posture);
        (at.translation - world_from_tool.translation).length() < HIT && turn_between(&at, world_from_tool) < HIT
    }

    /// Turns joints by whole turns into their limits, towards `near`; false where that cannot be.
    fn within(&self, posture: &mut [f64], near: &[f64]) -> bool {
        posture.iter_mut().zip(near).zip(self.columns).all(|((q, near), &column)| {
            let nearest = *q + TAU * ((near - *q) / TAU).round();
            let allowed = |v: &f64| {
                self.case.model.joints[column].range.is_none_or(|(low, high)| *v >= low - 1e-9 && *v <= high + 1e-9)
            };
            let turns = [0.0, -TAU, TAU, -2.0 * TAU, 2.0 * TAU];
            turns.map(|t| nearest + t).into_iter().find(allowed).map(|v| *q = v).is_some()
        })
    }
}

/// The angle between two orientations.
pub(super) fn turn_between(a: &Pose, b: &Pose) -> f64 {
    let off = a.rotation.inverse() * b.rotation;
    2.0 * Vector::new(off.x, off.y, off.z).length().min(1.0).asin()
}

fn about(axis: Vector, angle: f64) -> Rotation {
    Rotation::from_axis_angle(axis, angle)
}

/// What of a vector is across a direction.
fn off(v: Vector, direction: Vector) -> Vector {
    v - direction * direction.dot(v)
}

/// The angle about `axis` that turns `from` to `to`, as seen along the axis.
fn turn(axis: Vector, from: Vector, to: Vector) -> f64 {
    let (from, to) = (off(from, axis), off(to, axis));
    axis.dot(from.cross(to)).atan2(from.dot(to))
}

/// The angles x with `along · rot(axis, x) v = height`.
fn angles(along: Vector, axis: Vector, v: Vector, height: f64) -> Vec<f64> {
    let (axial, across) = (axis * axis.dot(v), off(v, axis));
    let (a, b) = (along.dot(across), along.dot(axis.cross(across)));
    let (size, wanted) = (a.hypot(b), height - along.dot(axial));
    // At the edge of reach rounding decides; what misses shows afterwards.
    if size < 1e-12 || wanted.abs() > size * (1.0 + 1e-9) {
        return Vec::new();
    }
    let (middle, half) = (b.atan2(a), (wanted / size).clamp(-1.0, 1.0).acos());
    vec![middle + half, middle - half]
}

/// Where two lines meet, if they do.
fn meeting((p, a): (Vector, Vector), (q, b): (Vector, Vector)) -> Option<Vector> {
    let normal = a.cross(b);
    if normal.length() < SAME {
        return None;
    }
    let along = (q - p).cross(b).dot(normal) / normal.length_squared();
    let point = p + a * along;
    (off(point - q, b).length() < SAME).then_some(point)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::meshes::Meshes;
    use crate::urdf;
    use rand::{RngExt, SeedableRng};
    use rand_xoshiro::Xoshiro256PlusPlus;
    use std::path::Path;

    fn case() -> Case {
        let text = include_str!("../../../../robots/ur10_ag95/ur10_ag95.urdf");
        let model = urdf::read(text, &mut Meshes::new(&[], Path::new(""))).expect("a URDF");
        let world_from_root = Pose::from_parts(Vector::new(0.3, -0.2, 0.5), about(Vector::Z, 0.7));
        Case { model, world_from_root, fixtures: Vec::new(), objects: Vec::new(), places: Vec::new() }
    }

    #[test]
    fn every_posture_is_among_those_found_where_it_leads() {
        let case = case();
        let names = ["shoulder_pan", "shoulder_lift", "elbow", "wrist_1", "wrist_2", "wrist_3"];
        let columns = names.map(|n| case.model.joint(&format!("{n}_joint")).expect("a joint"));
        let tool = case.model.link("grasp_center").expect("the tool");
        let arm = Arm::new(&case, &columns, tool, vec![0.0; case.model.joints.len()]).expect("three parallel axes");
        let mut random = Xoshiro256PlusPlus::seed_from_u64(8);
        let mut found = 0;
        for _ in 0..2000 {
            let posture: Vec<f64> = (0..6).map(|_| random.random_range(-3.1..3.1)).collect();
            let all = arm.postures(&arm.tool(&posture), &posture);
            let same = |q: &Vec<f64>| q.iter().zip(&posture).all(|(a, b)| (a - b).abs() < 1e-5);
            assert!(all.iter().any(same), "{posture:?}");
            assert!(all.len() <= 8);
            found += all.len();
        }
        assert!(found > 6000, "{found}");
        let far = Pose::from_translation(Vector::new(3.0, 0.0, 0.0));
        assert!(arm.postures(&far, &[0.0; 6]).is_empty());
        let swapped = [columns[0], columns[1], columns[2], columns[3], columns[5], columns[4]];
        let other = Arm::new(&case, &swapped, tool, vec![0.0; case.model.joints.len()]);
        assert!(
            other.is_none_or(|arm| arm.postures(&arm.tool(&[0.3; 6]), &[0.3; 6]).is_empty()),
            "columns out of order"
        );
    }
}
