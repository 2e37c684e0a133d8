//! Links next to each other, with a table in place of spheres.
//!
//! The spheres of near neighbours often touch where the links do not: a kernel that knew nothing else
//! would call most postures doubtful. How two links with one or two joints between them lie depends
//! on those joints alone, and on the hand's where one of them is a finger. So a grid over the joints'
//! values tells where the shapes keep clear: a cell counts as clear if in its middle no two parts are
//! nearer than the joints can bring them within the cell. Of a finger there are two grids, for the
//! open hand and for any that grips.

use super::cells::{Measure, fill, shared};
use super::exact::spheres_touch;
use clearway_robot::{Group, LinkStep, Motion, Sphere};
use std::f64::consts::{PI, TAU};
use std::sync::Arc;

/// Cells along each joint.
pub(super) const CELLS: usize = 256;
/// The values of a hand that grips something, as part of its range; and they are looked at in so many
/// pieces.
const GRIPPING: f64 = 0.9;
const HANDS: usize = 8;
/// Joints between two links, at most, the hand's aside.
const MOST_JOINTS: u32 = 2;
/// Spheres that touch in at least this part of the postures are better replaced by a table …
const OFTEN: f64 = 0.25;
/// … and so many postures say so.
const SAMPLES: usize = 128;

/// A joint between two links.
#[derive(Clone, Debug)]
pub(super) struct Axis {
    pub variable: usize,
    pub low: f64,
    /// Width of a cell, rad or m.
    pub cell: f64,
    /// More than a turn: values are counted round.
    round: bool,
}

impl Axis {
    /// Where a value lies, in cells; counted on beyond the ends where the joint goes round.
    #[inline]
    fn place(&self, value: f64) -> f64 {
        (value - self.low) / self.cell
    }

    /// The cell of a place; `None` outside of the joint's limits.
    #[inline]
    fn cell(&self, place: f64) -> Option<usize> {
        /// In cells: limits are met up to rounding.
        const ROUNDED: f64 = 1e-3;
        let count = CELLS as f64;
        if self.round {
            return Some((place.floor().rem_euclid(count) as usize).min(CELLS - 1));
        }
        (place > -ROUNDED && place < count + ROUNDED).then(|| (place.max(0.0) as usize).min(CELLS - 1))
    }
}

/// Two links, and where they are clear of each other.
#[derive(Clone, Debug)]
pub struct Neighbours {
    pub a: usize,
    pub b: usize,
    axes: Vec<Axis>,
    grids: Arc<[Grid]>,
}

/// Where two links are clear of each other, for some values of the hand.
#[derive(Clone, Debug)]
struct Grid {
    hand: [f64; 2],
    /// By cell of the first joint, then of the second.
    clear: Vec<bool>,
}

/// The pairs of links, of those not in `unchecked`, that are better asked by a table. `spheres` cover
/// the links; closer than `margin` (metres) is touching.
pub fn find(group: &Group, spheres: &[Vec<Sphere>], unchecked: &[(usize, usize)], margin: f64) -> Vec<Neighbours> {
    let links = group.links.len();
    let kinematics = &group.kinematics;
    let all = (0..links).flat_map(|a| (a + 1..links).map(move |b| (a, b)));
    let near = |&(a, b): &(usize, usize)| {
        let between = kinematics.moved_by[a] ^ kinematics.moved_by[b];
        let shaped = !spheres[a].is_empty() && !spheres[b].is_empty();
        shaped
            && (1..=MOST_JOINTS).contains(&between.count_ones())
            && !unchecked.contains(&(a, b))
            && shared(kinematics, a, b).is_some()
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
    pairs.into_iter().filter(often).map(|((a, b), _)| Neighbours::new(group, a, b, margin)).collect()
}

impl Neighbours {
    fn new(group: &Group, a: usize, b: usize, margin: f64) -> Neighbours {
        let between = group.kinematics.moved_by[a] ^ group.kinematics.moved_by[b];
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
            // A joint without any room has cells all the same.
            Axis { variable, low, cell: ((high - low) / CELLS as f64).max(1e-9), round }
        };
        let axes: Vec<Axis> = (0..group.lower.len()).filter(|v| between >> v & 1 == 1).map(axis).collect();
        let columns = if axes.len() > 1 { CELLS } else { 1 };
        let grid = |(hand, pieces): ([f64; 2], usize)| {
            let mut measure = Measure::new(group, a, b, margin, hand, pieces)?;
            let mut clear = vec![false; CELLS * columns];
            fill(&mut clear, &mut measure, &axes, 0..CELLS, 0..columns);
            Some(Grid { hand, clear })
        };
        let [open, closed] = group.hand;
        let hands = if group.kinematics.moved_by_hand[a] == group.kinematics.moved_by_hand[b] {
            vec![([f64::NEG_INFINITY, f64::INFINITY], 1)]
        } else {
            let firm = closed + GRIPPING * (open - closed);
            // The kernel knows the hand's value in f32.
            let about = |a: f64, b: f64| [a.min(b) - 1e-6, a.max(b) + 1e-6];
            vec![(about(open, open), 1), (about(closed, firm), HANDS)]
        };
        let grids = hands.into_iter().filter_map(grid).collect();
        Neighbours { a, b, axes, grids }
    }

    #[inline]
    fn clear_at(&self, grid: &Grid, places: [f64; 2]) -> bool {
        let mut index = 0;
        for (axis, place) in self.axes.iter().zip(places) {
            let Some(cell) = axis.cell(place) else { return false };
            index = index * CELLS + cell;
        }
        grid.clear[index]
    }

    #[inline]
    fn places(&self, value: impl Fn(usize) -> f64) -> [f64; 2] {
        let place = |axis: &Axis| axis.place(value(axis.variable));
        [place(&self.axes[0]), self.axes.get(1).map_or(0.0, place)]
    }

    fn grid(&self, hand: f64) -> Option<&Grid> {
        self.grids.iter().find(|grid| grid.hand[0] <= hand && hand <= grid.hand[1])
    }

    /// Whether the links keep clear in a configuration, for all the table knows. `value` by joint.
    #[inline]
    pub fn clear(&self, hand: f64, value: impl Fn(usize) -> f64) -> bool {
        self.grid(hand).is_some_and(|grid| self.clear_at(grid, self.places(value)))
    }

    /// The same along a straight motion: through all the cells that it crosses.
    pub fn motion_clear(&self, hand: f64, a: &[f64], b: &[f64]) -> bool {
        let Some(grid) = self.grid(hand) else { return false };
        let (from, to) = (self.places(|j| a[j]), self.places(|j| b[j]));
        if !self.clear_at(grid, from) || !self.clear_at(grid, to) {
            return false;
        }
        let by = [to[0] - from[0], to[1] - from[1]];
        // Where the motion next leaves a row, or a column.
        let next =
            |axis: usize, line: f64| if by[axis] == 0.0 { f64::INFINITY } else { (line - from[axis]) / by[axis] };
        let first = |axis: usize| if by[axis] > 0.0 { from[axis].floor() + 1.0 } else { from[axis].ceil() - 1.0 };
        let mut lines = [first(0), first(1)];
        let mut t = 0.0_f64;
        loop {
            let ends = [next(0, lines[0]), next(1, lines[1])];
            let end = ends[0].min(ends[1]);
            if end >= 1.0 {
                return true;
            }
            for axis in 0..2 {
                if ends[axis] <= end {
                    lines[axis] += by[axis].signum();
                }
            }
            t = t.max(end);
            let after = next(0, lines[0]).min(next(1, lines[1])).min(1.0);
            let middle = f64::midpoint(t, after);
            if !self.clear_at(grid, [from[0] + by[0] * middle, from[1] + by[1] * middle]) {
                return false;
            }
        }
    }
}
