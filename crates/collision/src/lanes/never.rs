//! Which spheres of two links can never meet, by proof.
//!
//! Only the joints between the two links matter. Their box of values is halved, widest movement
//! first; at a box's middle a pair of spheres whose gap is wider than what any value in the box
//! could move them is apart in the whole box. Pairs that are apart in every box are never checked
//! again. When the work grows too large the pairs left are taken to be able to meet.

use super::chain::Seat;
use clearway_geometry::{Mat3, Pose, Vec3};
use clearway_robot::{Group, Motion, Sphere};

/// Boxes looked at for one pair of parts, and pairs of spheres over all boxes.
const MOST_BOXES: usize = 400;
const MOST_WORK: usize = 12_000;
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
                    ranges.push((low.min(high), low.max(high)));
                }
            }
            at = step.parent;
        }
        steps.push((to, Motion::Still));
        let found = at == a && ranges.len() <= MOST_JOINTS && ranges.iter().all(|r| r.0.is_finite() && r.1.is_finite());
        Relative { steps: found.then_some(steps), ranges }
    }

    /// By sphere of `a`: the spheres of `b` that it could meet. Spheres are in the links' chain frames.
    pub fn could_meet(
        &self,
        seats: &[Seat],
        (link_a, a): (usize, &[Sphere]),
        (link_b, b): (usize, &[Sphere]),
        margin: f64,
    ) -> Vec<Vec<usize>> {
        let mut meet = vec![vec![false; b.len()]; a.len()];
        let all: Vec<(u16, u16)> = (0..a.len()).flat_map(|i| (0..b.len()).map(move |j| (i as u16, j as u16))).collect();
        let in_link = |link: usize, s: &Sphere| Sphere { centre: seats[link].frame_from_link.inverse_point(s.centre), radius: s.radius };
        let a: Vec<Sphere> = a.iter().map(|s| in_link(link_a, s)).collect();
        let b: Vec<Sphere> = b.iter().map(|s| in_link(link_b, s)).collect();
        let mut search = Search { relative: self, a: &a, b: &b, margin, meet: &mut meet, boxes: 0, work: 0 };
        match &self.steps {
            Some(_) => search.divide(&self.ranges.clone(), all),
            None => search.keep(&all),
        }
        meet.into_iter().map(|row| row.iter().enumerate().filter(|(_, m)| **m).map(|(j, _)| j).collect()).collect()
    }
}

struct Search<'a> {
    relative: &'a Relative,
    a: &'a [Sphere],
    b: &'a [Sphere],
    margin: f64,
    meet: &'a mut [Vec<bool>],
    boxes: usize,
    work: usize,
}

impl Search<'_> {
    fn keep(&mut self, pairs: &[(u16, u16)]) {
        for (i, j) in pairs {
            self.meet[*i as usize][*j as usize] = true;
        }
    }

    fn divide(&mut self, ranges: &[(f64, f64)], pairs: Vec<(u16, u16)>) {
        self.boxes += 1;
        self.work += pairs.len();
        if self.boxes > MOST_BOXES || self.work > MOST_WORK {
            return self.keep(&pairs);
        }
        // At the middle: each sphere of b seen from a, and how far the box could move it.
        let Some(steps) = &self.relative.steps else { return };
        let mut contribution = vec![0.0_f64; ranges.len()];
        let placed: Vec<(Vec3, f64)> = self
            .b
            .iter()
            .map(|s| {
                let (mut p, mut moved) = (s.centre, 0.0);
                for (index, (before, motion)) in steps.iter().enumerate() {
                    p = before.point(p);
                    let Some((low, high)) = ranges.get(index) else { continue };
                    let (middle, half) = ((low + high) / 2.0, (high - low) / 2.0);
                    match motion {
                        Motion::Turn { axis, .. } => {
                            let axis = axis.normalize();
                            // What lies farther out may have moved already, away from the axis.
                            let by = half * (p.reject_from_normalized(axis).length() + moved);
                            contribution[index] = contribution[index].max(by);
                            moved += by;
                            p = Mat3::from_axis_angle(axis, middle) * p;
                        }
                        Motion::Slide { axis, .. } => {
                            contribution[index] = contribution[index].max(half);
                            moved += half;
                            p += *axis * middle;
                        }
                        Motion::Still => {}
                    }
                }
                (p, moved)
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
        let widest = (0..ranges.len()).max_by(|&x, &y| contribution[x].total_cmp(&contribution[y]));
        let Some(widest) = widest.filter(|&w| contribution[w] > 1e-3) else { return self.keep(&left) };
        let (low, high) = ranges[widest];
        for half in [(low, (low + high) / 2.0), ((low + high) / 2.0, high)] {
            let mut ranges = ranges.to_vec();
            ranges[widest] = half;
            self.divide(&ranges, left.clone());
        }
    }
}
