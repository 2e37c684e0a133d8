//! Links next to each other, with a table in place of spheres.
//!
//! The spheres of near neighbours often touch where the links do not: a kernel that knew nothing else
//! would call most postures doubtful. How two links with one or two joints between them lie depends
//! on those joints alone. So the distance of their shapes is measured over a grid of the joints'
//! values; what the joints can move a link by bounds it in between.

use super::body::reach_of_link;
use super::exact::spheres_touch;
use clearway_geometry::distance::closer_than_along;
use clearway_geometry::{Pose, Vec3};
use clearway_robot::{Group, LinkStep, Motion, Sphere};
use std::f64::consts::{PI, TAU};
use std::ops::Range;

/// Cells along each joint, and of these as many measured at once where the links are far apart.
const CELLS: usize = 96;
const COARSE: usize = 8;
/// Farther apart than this, metres, is measured coarsely.
const FAR: f64 = 0.01;
/// Joints between two links, at most.
const MOST_JOINTS: u32 = 2;
/// Spheres that touch in at least this part of the postures are better replaced by a table …
const OFTEN: f64 = 0.25;
/// … and so many postures say so.
const SAMPLES: usize = 128;
/// A motion is followed in steps no shorter than this clearance, metres.
const LEAST: f64 = 2e-4;

/// A joint between two links.
#[derive(Clone, Debug)]
struct Axis {
    variable: usize,
    low: f64,
    /// Width of a cell, rad or m.
    cell: f64,
    /// More than a turn: values are counted round.
    round: bool,
    /// No point of either link is moved farther by a unit of the joint, against the other.
    reach: f64,
}

impl Axis {
    fn cells(&self) -> usize {
        if self.cell > 0.0 { CELLS } else { 1 }
    }

    fn middle(&self, cell: usize) -> f64 {
        self.low + self.cell * (cell as f64 + 0.5)
    }

    /// The cell of a value, and how far the value is from its middle.
    #[inline]
    fn find(&self, value: f64) -> (usize, f64) {
        if self.cell == 0.0 {
            return (0, 0.0);
        }
        let value = if self.round { value - TAU * ((value - self.low) / TAU).floor() } else { value };
        let cell = (((value - self.low) / self.cell) as usize).min(CELLS - 1);
        (cell, (value - self.middle(cell)).abs())
    }
}

/// Two links, and how far apart they are.
#[derive(Clone, Debug)]
pub struct Neighbours {
    pub a: usize,
    pub b: usize,
    axes: Vec<Axis>,
    /// By cell of the first joint, then of the second: the links' distance in its middle is no less,
    /// metres; 0 where they touch.
    clearance: Vec<f32>,
}

/// The pairs of links, of those not in `unchecked`, that are better asked by a table. `spheres` cover
/// the links.
pub fn find(group: &Group, spheres: &[Vec<Sphere>], unchecked: &[(usize, usize)]) -> Vec<Neighbours> {
    let links = group.links.len();
    let kinematics = &group.kinematics;
    let all = (0..links).flat_map(|a| (a + 1..links).map(move |b| (a, b)));
    let near = |&(a, b): &(usize, usize)| {
        let between = kinematics.moved_by[a] ^ kinematics.moved_by[b];
        let arm = between >> kinematics.arm_joints == 0 && kinematics.moved_by_hand[a] == kinematics.moved_by_hand[b];
        let shaped = !spheres[a].is_empty() && !spheres[b].is_empty();
        shaped && arm && (1..=MOST_JOINTS).contains(&between.count_ones()) && !unchecked.contains(&(a, b))
    };
    let mut pairs: Vec<((usize, usize), usize)> = all.filter(near).map(|pair| (pair, 0)).collect();
    let mut frames = Vec::new();
    for sample in 0..SAMPLES {
        kinematics.frames(&group.spread(sample), group.hand[0], &mut frames);
        for ((a, b), count) in &mut pairs {
            *count += usize::from(spheres_touch(&spheres[*a], &frames[*a], &spheres[*b], &frames[*b]));
        }
    }
    let often = |(_, count): &((usize, usize), usize)| *count as f64 >= OFTEN * SAMPLES as f64;
    pairs.into_iter().filter(often).map(|((a, b), _)| Neighbours::new(group, a, b)).collect()
}

impl Neighbours {
    fn new(group: &Group, a: usize, b: usize) -> Neighbours {
        let between = group.kinematics.moved_by[a] ^ group.kinematics.moved_by[b];
        let reach = [a, b].map(|link| reach_of_link(group, link));
        let axis = |variable: usize| {
            let (low, high) = group.range(variable);
            // More than a turn shows nothing new, where the joint turns one to one.
            let turns = |step: &LinkStep| match step.motion {
                Motion::Turn { source, .. } => source.variable != variable || source.multiplier.abs() == 1.0,
                Motion::Slide { source, .. } => source.variable != variable,
                Motion::Still => true,
            };
            let endless = !group.lower[variable].is_finite() || !group.upper[variable].is_finite();
            let round = (endless || high - low > TAU) && group.kinematics.steps().iter().all(turns);
            let (low, high) = if round { (-PI, PI) } else { (low, high) };
            Axis { variable, low, cell: (high - low) / CELLS as f64, round, reach: reach[0][variable].max(reach[1][variable]) }
        };
        let axes: Vec<Axis> = (0..group.lower.len()).filter(|v| between >> v & 1 == 1).map(axis).collect();
        let rows = axes[0].cells();
        let columns = axes.get(1).map_or(1, Axis::cells);
        let mut neighbours = Neighbours { a, b, axes, clearance: vec![f32::NEG_INFINITY; rows * columns] };
        let middles: Vec<f64> = (0..group.lower.len()).map(|j| (group.range(j).0 + group.range(j).1) / 2.0).collect();
        let pairs = group.links[a].collision.parts.len() * group.links[b].collision.parts.len();
        let mut measure = Measure { group, a, b, q: middles, frames: Vec::new(), directions: vec![Vec3::ZERO; pairs], kept: 0 };
        for i in (0..rows).step_by(COARSE) {
            for j in (0..columns).step_by(COARSE) {
                neighbours.fill(&mut measure, i..(i + COARSE).min(rows), j..(j + COARSE).min(columns));
            }
        }
        neighbours
    }

    /// Measures a block of cells: in its middle if that is far, else in each cell's.
    fn fill(&mut self, measure: &mut Measure, rows: Range<usize>, columns: Range<usize>) {
        let count = self.axes.get(1).map_or(1, Axis::cells);
        let at = |axis: &Axis, range: &Range<usize>| axis.low + axis.cell * (range.start + range.end) as f64 / 2.0;
        let middle = [at(&self.axes[0], &rows), self.axes.get(1).map_or(0.0, |axis| at(axis, &columns))];
        let apart = measure.room(&self.axes, middle);
        for i in rows {
            for j in columns.clone() {
                let here = [self.axes[0].middle(i), self.axes.get(1).map_or(0.0, |axis| axis.middle(j))];
                let moved: f64 = self.axes.iter().zip(here).zip(middle).map(|((axis, h), m)| axis.reach * (h - m).abs()).sum();
                let known = apart - moved;
                let clearance = if known > FAR { known } else { measure.room(&self.axes, here) };
                self.clearance[i * count + j] = clearance as f32;
            }
        }
    }

    /// No less than the links' distance in a configuration, metres; negative or zero where that says
    /// nothing. `value` by joint.
    #[inline]
    pub fn clearance(&self, value: impl Fn(usize) -> f64) -> f64 {
        let (mut index, mut moved) = (0, 0.0);
        for axis in &self.axes {
            let (cell, off) = axis.find(value(axis.variable));
            index = index * axis.cells() + cell;
            moved += off * axis.reach;
        }
        f64::from(self.clearance[index]) - moved
    }

    /// How far joints that change by so much move one link against the other, at most.
    pub fn moved(&self, by: impl Fn(usize) -> f64) -> f64 {
        self.axes.iter().map(|axis| by(axis.variable).abs() * axis.reach).sum()
    }

    /// Whether the links keep more than `margin` along a straight motion, for all the table knows.
    pub fn motion_clear(&self, a: &[f64], b: &[f64], margin: f64) -> bool {
        let length = self.moved(|j| b[j] - a[j]);
        let mut t = 0.0;
        loop {
            let room = self.clearance(|j| a[j] + (b[j] - a[j]) * t) - margin;
            if room < LEAST {
                return false;
            }
            if room >= length * (1.0 - t) {
                return true;
            }
            t += room / length;
        }
    }
}

/// Rooms told apart, metres: a boolean question with the last answer's direction in mind is far
/// cheaper than a distance.
const ROOMS: [f64; 14] =
    [0.0008, 0.0015, 0.0025, 0.0035, 0.005, 0.007, 0.01, 0.014, 0.02, 0.03, 0.045, 0.07, 0.12, 0.25];

/// Measures the room between two links.
struct Measure<'a> {
    group: &'a Group,
    a: usize,
    b: usize,
    q: Vec<f64>,
    frames: Vec<Pose>,
    /// By pair of parts: what last told them apart.
    directions: Vec<Vec3>,
    /// How many of [`ROOMS`] were kept last.
    kept: usize,
}

impl Measure<'_> {
    /// The greatest of [`ROOMS`] that the links keep, else 0.
    fn room(&mut self, axes: &[Axis], values: [f64; 2]) -> f64 {
        for (axis, value) in axes.iter().zip(values) {
            self.q[axis.variable] = value;
        }
        self.group.kinematics.frames(&self.q, self.group.hand[0], &mut self.frames);
        // From what the last cell kept, up or down.
        let mut kept = self.kept;
        if kept == 0 || self.keeps(ROOMS[kept - 1]) {
            while kept < ROOMS.len() && self.keeps(ROOMS[kept]) {
                kept += 1;
            }
        } else {
            kept -= 1;
            while kept > 0 && !self.keeps(ROOMS[kept - 1]) {
                kept -= 1;
            }
        }
        self.kept = kept;
        if kept == 0 { 0.0 } else { ROOMS[kept - 1] }
    }

    fn keeps(&mut self, room: f64) -> bool {
        let (own, others) = (&self.group.links[self.a].collision.parts, &self.group.links[self.b].collision.parts);
        let (from_a, from_b) = (self.frames[self.a], self.frames[self.b]);
        let mut pair = 0;
        for (pose, convex) in own {
            let pose = from_a * *pose;
            for (other_pose, other) in others {
                let other_pose = from_b * *other_pose;
                if closer_than_along(convex, &pose, other, &other_pose, room, &mut self.directions[pair]) {
                    return false;
                }
                pair += 1;
            }
        }
        true
    }
}
