//! Where two links keep clear of each other: a grid over the joints between them is filled block by block.

use super::body::reach_of_part;
use super::neighbours::{Axis, CELLS};
use clearway_geometry::distance::closer_than_along;
use clearway_geometry::{Convex, Pose, Vec3};
use clearway_robot::{Group, Kinematics, Motion};
use std::ops::Range;

/// A block of cells is given up where the links touch in its middle, and nothing in it moves farther from
/// there: metres.
const SMALL: f64 = 0.004;

/// The nearest link that two hang from, or one of them; `None` where a joint that moves both moves them
/// against each other, too: others may mimic it.
pub(super) fn shared(kinematics: &Kinematics, a: usize, b: usize) -> Option<usize> {
    let shared = nearest_above(kinematics, a, b)?;
    let hand = |l: usize| kinematics.moved_by_hand[l];
    let arm = kinematics.moved_by[a] & kinematics.moved_by[b] == kinematics.moved_by[shared];
    (arm && (hand(a) && hand(b)) == hand(shared)).then_some(shared)
}

/// A link and what it hangs from, up to the root.
fn above(kinematics: &Kinematics, link: usize) -> impl Iterator<Item = usize> {
    std::iter::successors(Some(link), |&l| (l != 0).then(|| kinematics.steps()[l].parent))
}

/// The nearest link that two hang from, or one of them.
fn nearest_above(kinematics: &Kinematics, a: usize, b: usize) -> Option<usize> {
    above(kinematics, a).find(|l| above(kinematics, b).any(|other| other == *l))
}

/// The link below the only joint that a variable moves between two links.
fn only_joint(kinematics: &Kinematics, shared: usize, links: [usize; 2], variable: usize) -> Option<usize> {
    let moves = |l: &usize| match kinematics.steps()[*l].motion {
        Motion::Turn { source, .. } | Motion::Slide { source, .. } => source.variable == variable,
        Motion::Still => false,
    };
    let between = |link: usize| above(kinematics, link).take_while(|l| *l != shared).filter(moves);
    let mut joints = links.into_iter().flat_map(between);
    joints.next().filter(|_| joints.next().is_none())
}

/// Whether nothing moves between two links.
fn rigid(kinematics: &Kinematics, a: usize, b: usize) -> bool {
    let still = |l: &usize| matches!(kinematics.steps()[*l].motion, Motion::Still);
    let Some(shared) = nearest_above(kinematics, a, b) else { return false };
    [a, b].into_iter().all(|link| above(kinematics, link).take_while(|l| *l != shared).all(|l| still(&l)))
}

/// Whether a part of a link is round about the axis of the joint above `joint`, which that link carries: then
/// turning the joint brings it no nearer to anything beyond.
fn turns_alike(group: &Group, joint: usize, link: usize, part: usize) -> bool {
    /// Metres, and radians.
    const EXACT: f64 = 1e-6;
    let kinematics = &group.kinematics;
    let step = &kinematics.steps()[joint];
    let Motion::Turn { axis, .. } = step.motion else { return false };
    // The axis is the same line in the frames on either side of the joint.
    let Some(beside) = [step.parent, joint].into_iter().find(|side| rigid(kinematics, link, *side)) else {
        return false;
    };
    let Some(shared) = shared(kinematics, link, beside) else { return false };
    let seen = |l: usize| kinematics.seen_from(shared, l, &vec![0.0; kinematics.arm_joints], 0.0);
    let beside_from_joint = if beside == joint { Pose::IDENTITY } else { step.parent_from_joint };
    let link_from_joint = seen(link).inverse() * seen(beside) * beside_from_joint;
    let (pose, convex) = &group.links[link].collision.parts[part];
    let axis = (link_from_joint.rotation * axis).normalize();
    let off = (pose.translation - link_from_joint.translation).reject_from_normalized(axis).length();
    let along = pose.rotation.z_axis.cross(axis).length();
    match convex {
        Convex::Sphere { .. } => off < EXACT,
        Convex::Cylinder { .. } | Convex::Capsule { .. } => off < EXACT && along < EXACT,
        Convex::Box { .. } | Convex::Hull(_) => false,
    }
}

/// Finds out about a block of cells: at once if it is clear, else in halves.
pub(super) fn fill(
    clear: &mut [bool],
    measure: &mut Measure,
    axes: &[Axis],
    rows: Range<usize>,
    columns: Range<usize>,
) {
    let count = clear.len() / CELLS;
    match measure.look(axes, [&rows, &columns]) {
        Look::Clear => rows.for_each(|row| clear[row * count..][columns.clone()].fill(true)),
        Look::Touching => {}
        Look::Near => {
            let half = |range: &Range<usize>| range.start + range.len() / 2;
            let (moves, others) = (measure.most(axes, 0, rows.len()), measure.most(axes, 1, columns.len()));
            if rows.len() > 1 && (moves >= others || columns.len() == 1) {
                let half = half(&rows);
                fill(clear, measure, axes, rows.start..half, columns.clone());
                fill(clear, measure, axes, half..rows.end, columns);
            } else if columns.len() > 1 {
                let half = half(&columns);
                fill(clear, measure, axes, rows.clone(), columns.start..half);
                fill(clear, measure, axes, rows, half..columns.end);
            }
        }
    }
}

/// What a block of cells is.
enum Look {
    Clear,
    /// Some of it may be clear.
    Near,
    /// Hardly any of it is.
    Touching,
}

/// Two parts, one of each link.
struct Parts {
    own: usize,
    other: usize,
    /// How far a unit of each variable moves one against the other.
    reach: Vec<f64>,
    /// What last told them apart.
    direction: Vec3,
}

/// Looks at two links in a block of cells.
pub(super) struct Measure<'a> {
    group: &'a Group,
    shared: usize,
    a: usize,
    b: usize,
    margin: f64,
    q: Vec<f64>,
    /// Values of the hand's joint, each standing for those up to `half_hand` from it.
    hands: Vec<f64>,
    half_hand: f64,
    /// Those that were near last come first.
    parts: Vec<Parts>,
}

impl<'a> Measure<'a> {
    pub fn new(
        group: &'a Group,
        a: usize,
        b: usize,
        margin: f64,
        [low, high]: [f64; 2],
        pieces: usize,
    ) -> Option<Measure<'a>> {
        let half_hand = if high.is_finite() { (high - low) / pieces as f64 / 2.0 } else { 0.0 };
        let count = |link: usize| group.links[link].collision.parts.len();
        let reaches = |link: usize| (0..count(link)).map(|part| reach_of_part(group, link, part)).collect::<Vec<_>>();
        let (own, others) = (reaches(a), reaches(b));
        let pairs = (0..count(a)).flat_map(|i| (0..count(b)).map(move |j| (i, j)));
        let shared = shared(&group.kinematics, a, b)?;
        let parts = |(i, j): (usize, usize)| {
            let mut reach: Vec<f64> = own[i].iter().zip(&others[j]).map(|(x, y)| x.max(*y)).collect();
            for (variable, reach) in reach.iter_mut().enumerate().filter(|(_, reach)| **reach > 0.0) {
                let Some(joint) = only_joint(&group.kinematics, shared, [a, b], variable) else { continue };
                if turns_alike(group, joint, a, i) || turns_alike(group, joint, b, j) {
                    *reach = 0.0;
                }
            }
            Parts { own: i, other: j, reach, direction: Vec3::ZERO }
        };
        Some(Measure {
            group,
            shared,
            a,
            b,
            margin,
            q: (0..group.lower.len()).map(|j| f64::midpoint(group.range(j).0, group.range(j).1)).collect(),
            hands: (0..pieces)
                .map(|i| if low.is_finite() { low + half_hand * (2 * i + 1) as f64 } else { group.hand[0] })
                .collect(),
            half_hand,
            parts: pairs.map(parts).collect(),
        })
    }

    /// The most that a joint moves any two parts against each other within so many cells.
    fn most(&self, axes: &[Axis], axis: usize, cells: usize) -> f64 {
        let Some(axis) = axes.get(axis) else { return 0.0 };
        self.parts.iter().map(|p| p.reach[axis.variable]).fold(0.0, f64::max) * axis.cell * cells as f64
    }

    fn look(&mut self, axes: &[Axis], cells: [&Range<usize>; 2]) -> Look {
        for (axis, cells) in axes.iter().zip(cells) {
            self.q[axis.variable] = axis.low + axis.cell * (cells.start + cells.end) as f64 / 2.0;
        }
        let kinematics = &self.group.kinematics;
        let part = |link: usize, part: usize| &self.group.links[link].collision.parts[part];
        for hand in &self.hands {
            let seen = |link: usize| kinematics.seen_from(self.shared, link, &self.q, *hand);
            let (from_a, from_b) = (seen(self.a), seen(self.b));
            for index in 0..self.parts.len() {
                let pair = &mut self.parts[index];
                let ((own, convex), (others, other)) = (part(self.a, pair.own), part(self.b, pair.other));
                let (own, others) = (from_a * *own, from_b * *others);
                let half = |(axis, cells): (&Axis, &Range<usize>)| {
                    pair.reach[axis.variable] * axis.cell * cells.len() as f64 / 2.0
                };
                let moved = self.half_hand * pair.reach[self.q.len()] + axes.iter().zip(cells).map(half).sum::<f64>();
                let apart =
                    own.translation.distance(others.translation) - convex.bounding_radius() - other.bounding_radius();
                let mut near = |room: f64| {
                    apart < room && closer_than_along(convex, &own, other, &others, room, &mut pair.direction)
                };
                if near(self.margin + moved) {
                    let look = if moved < SMALL && near(self.margin) { Look::Touching } else { Look::Near };
                    self.parts[..=index].rotate_right(1);
                    return look;
                }
            }
        }
        Look::Clear
    }
}
