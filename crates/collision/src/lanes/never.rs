//! Which spheres of two links can never meet, by proof.
//!
//! Only the joints between the two links matter. Their box of values is halved, widest movement
//! first; at a box's middle a pair of spheres whose gap is wider than what any value in the box
//! could move them is apart in the whole box. Pairs that are apart in every box are never checked
//! again. When the work grows too large the pairs left are taken to be able to meet.
//!
//! Whole links are treated in the same way with their exact shapes: spheres of neighbouring links
//! often overlap where the links never do.

use clearway_geometry::distance::closer_than;
use clearway_geometry::{Convex, Mat3, Pose, Solid, Vec3};
use clearway_robot::{Group, Motion, Sphere};
use std::f64::consts::{PI, TAU};

/// Boxes looked at for the spheres of one pair of links.
const MOST_BOXES: usize = 128;
const MOST_LINK_JOINTS: usize = 2;
/// With more joints between two links than this, no box is small soon.
const MOST_JOINTS: usize = 3;

/// The motion of link `b` as seen from link `a`.
#[derive(Clone, Debug)]
pub struct Relative {
    /// From `a` to `b`: constant poses with motions after them. `None` if the one does not hang from the other.
    steps: Option<Vec<(Pose, Motion)>>,
    /// By step that moves: the range of its value.
    ranges: Vec<(f64, f64)>,
}

impl Relative {
    pub fn new(group: &Group, a: usize, b: usize) -> Relative {
        let mut steps = Vec::new();
        let mut ranges = Vec::new();
        let mut at = b;
        let mut to = Pose::IDENTITY;
        while at != a && at != 0 {
            let step = &group.kinematics.steps()[at];
            match step.motion {
                Motion::Still => to = step.parent_from_joint * to,
                Motion::Turn { source, .. } | Motion::Slide { source, .. } => {
                    steps.push((to, step.motion));
                    to = step.parent_from_joint;
                    let value = |v: f64| source.multiplier * v + source.offset;
                    let (low, high) = group.range(source.variable);
                    let (low, high) = (value(low), value(high));
                    let (low, high) = (low.min(high), low.max(high));
                    // More than a turn shows nothing new.
                    let turns = matches!(step.motion, Motion::Turn { .. }) && high - low > TAU;
                    ranges.push(if turns { (-PI, PI) } else { (low, high) });
                }
            }
            at = step.parent;
        }
        steps.push((to, Motion::Still));
        let found = at == a && ranges.len() <= MOST_JOINTS && ranges.iter().all(|r| r.0.is_finite() && r.1.is_finite());
        Relative { steps: found.then_some(steps), ranges }
    }

    /// Whether two links, given by their shapes, keep `margin` for all values of the joints between,
    /// shown with no more than `most` boxes.
    pub fn always_apart(&self, a: &Solid, b: &Solid, margin: f64, most: usize) -> bool {
        if self.steps.is_none() || self.ranges.len() > MOST_LINK_JOINTS || a.parts.is_empty() || b.parts.is_empty() {
            return false;
        }
        let mut ranges = self.ranges.clone();
        if self.turns_in_place(a)
            && let Some(last) = ranges.last_mut()
        {
            *last = (last.0, last.0);
        }
        let mut boxes = vec![ranges];
        let mut looked = 0;
        while let Some(ranges) = boxes.pop() {
            looked += 1;
            if looked > most {
                return false;
            }
            let mut contribution = vec![0.0_f64; ranges.len()];
            let mut apart = true;
            let joints = self.middle(&ranges);
            for (pose, part) in &b.parts {
                let (at, moved) = placed(&joints, *pose, part.bounding_radius(), &mut contribution);
                for (pose_a, part_a) in &a.parts {
                    if closer_than(part_a, pose_a, part, &at, margin + moved) {
                        apart = false;
                        if closer_than(part_a, pose_a, part, &at, margin) {
                            return false;
                        }
                    }
                }
            }
            if apart {
                continue;
            }
            let Some((left, right)) = halved(&ranges, &contribution) else { return false };
            boxes.extend([left, right]);
        }
        true
    }

    /// Whether all of `a` is round about the axis of the joint nearest to it, whose value then does
    /// not matter.
    fn turns_in_place(&self, a: &Solid) -> bool {
        let Some([.., (_, Motion::Turn { axis, .. }), (to_a, Motion::Still)]) = self.steps.as_deref() else {
            return false;
        };
        let (origin, axis) = (to_a.translation, (to_a.rotation * *axis).normalize());
        a.parts.iter().all(|(pose, part)| {
            let round = match part {
                Convex::Sphere { .. } => true,
                Convex::Capsule { .. } | Convex::Cylinder { .. } => pose.rotation.z_axis.cross(axis).length() < 1e-9,
                Convex::Box { .. } | Convex::Hull(_) => false,
            };
            round && (pose.translation - origin).reject_from_normalized(axis).length() < 1e-9
        })
    }

    /// The joints at the middle of a box.
    fn middle(&self, ranges: &[(f64, f64)]) -> Vec<Placed> {
        let steps = self.steps.iter().flatten().enumerate();
        let place = |(index, (before, motion)): (usize, &(Pose, Motion))| {
            let (low, high) = ranges.get(index).copied().unwrap_or_default();
            let (middle, half) = ((low + high) / 2.0, (high - low) / 2.0);
            match motion {
                Motion::Turn { axis, .. } => {
                    let axis = axis.normalize();
                    let turn = Pose::new(Mat3::from_axis_angle(axis, middle), Vec3::ZERO);
                    Placed { before: *before, after: turn, axis: Some(axis), half }
                }
                Motion::Slide { axis, .. } => {
                    Placed { before: *before, after: Pose::from_translation(*axis * middle), axis: None, half }
                }
                Motion::Still => Placed { before: *before, after: Pose::IDENTITY, axis: None, half: 0.0 },
            }
        };
        steps.map(place).collect()
    }

    /// By sphere of `a`: the spheres of `b` that it could meet. Spheres are in the links' frames.
    pub fn could_meet(&self, a: &[Sphere], b: &[Sphere], margin: f64) -> Vec<Vec<bool>> {
        let mut meet = vec![vec![false; b.len()]; a.len()];
        let all: Vec<(u16, u16)> = (0..a.len()).flat_map(|i| (0..b.len()).map(move |j| (i as u16, j as u16))).collect();
        let mut search = Search { relative: self, a, b, margin, meet: &mut meet, boxes: 0 };
        match &self.steps {
            Some(_) => search.divide(&self.ranges.clone(), all),
            None => search.keep(&all),
        }
        meet
    }
}

/// A joint at some value: what comes before it, what it does, and how far its value may yet be off.
struct Placed {
    before: Pose,
    after: Pose,
    /// Of a joint that turns.
    axis: Option<Vec3>,
    half: f64,
}

/// Where a pose of link `b` is, and how far a ball about it could be moved by any other value in
/// the box; each joint's part in that is noted.
fn placed(joints: &[Placed], pose: Pose, radius: f64, contribution: &mut [f64]) -> (Pose, f64) {
    let (mut at, mut moved) = (pose, 0.0);
    for (index, joint) in joints.iter().enumerate() {
        at = joint.before * at;
        // What lies farther out may have moved already, away from the axis.
        let far = joint.axis.map_or(1.0, |axis| at.translation.reject_from_normalized(axis).length() + radius + moved);
        if let Some(most) = contribution.get_mut(index) {
            *most = most.max(joint.half * far);
        }
        moved += joint.half * far;
        at = joint.after * at;
    }
    (at, moved)
}

struct Search<'a> {
    relative: &'a Relative,
    a: &'a [Sphere],
    b: &'a [Sphere],
    margin: f64,
    meet: &'a mut [Vec<bool>],
    boxes: usize,
}

impl Search<'_> {
    fn keep(&mut self, pairs: &[(u16, u16)]) {
        for (i, j) in pairs {
            self.meet[*i as usize][*j as usize] = true;
        }
    }

    fn divide(&mut self, ranges: &[(f64, f64)], pairs: Vec<(u16, u16)>) {
        self.boxes += 1;
        if self.boxes > MOST_BOXES {
            return self.keep(&pairs);
        }
        // At the middle: each sphere of b seen from a, and how far the box could move it.
        let mut contribution = vec![0.0_f64; ranges.len()];
        let joints = self.relative.middle(ranges);
        let placed: Vec<(Vec3, f64)> = self
            .b
            .iter()
            .map(|s| {
                let (at, moved) = placed(&joints, Pose::from_translation(s.centre), 0.0, &mut contribution);
                (at.translation, moved)
            })
            .collect();
        let mut met = Vec::new();
        let left: Vec<(u16, u16)> = pairs
            .into_iter()
            .filter(|&(i, j)| {
                if self.meet[i as usize][j as usize] {
                    return false;
                }
                let (sa, (p, moved)) = (&self.a[i as usize], placed[j as usize]);
                let gap = sa.centre.distance(p) - sa.radius - self.b[j as usize].radius - self.margin;
                if gap <= 0.0 {
                    met.push((i, j));
                }
                gap > 0.0 && gap <= moved
            })
            .collect();
        self.keep(&met);
        if left.is_empty() {
            return;
        }
        let Some((lower, upper)) = halved(ranges, &contribution) else { return self.keep(&left) };
        self.divide(&lower, left.clone());
        self.divide(&upper, left);
    }
}

/// A box cut in two where that tells most; `None` when it is too small to be worth it.
#[allow(clippy::type_complexity)]
fn halved(ranges: &[(f64, f64)], contribution: &[f64]) -> Option<(Vec<(f64, f64)>, Vec<(f64, f64)>)> {
    let widest = (0..ranges.len()).max_by(|&x, &y| contribution[x].total_cmp(&contribution[y]))?;
    if contribution[widest] < 1e-3 {
        return None;
    }
    let (low, high) = ranges[widest];
    let (mut lower, mut upper) = (ranges.to_vec(), ranges.to_vec());
    lower[widest].1 = (low + high) / 2.0;
    upper[widest].0 = (low + high) / 2.0;
    Some((lower, upper))
}
