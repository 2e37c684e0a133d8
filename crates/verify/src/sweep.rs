//! Distances along one segment, continuously: between rows, joints move on straight lines.
//!
//! Every pair of shapes keeps a lease: having measured that two shapes are `d` apart, they cannot
//! touch before one has travelled `d` against the other, nor come within `r` before `d - r`. Travel is
//! bounded by the joints between them: |Δq| times the largest distance of the body from the joint's
//! axis, taken at the middle of the interval and widened by what the joints nearer to the body may
//! add. When a lease runs out it is measured again; when an interval is longer than the lease, the
//! interval is halved, until the bodies move by less than 0.05 mm. What distances matter, a [`Seek`]
//! says: [`touch`] looks for overlaps, [`clearance`](crate::clearance) for the least distance.

pub(crate) mod touch;

use crate::case::{Case, Track};
use crate::error::CannotJudge;
use crate::gap::Gap;
use crate::model::JointKind;
use crate::push::Slide;
use crate::shapes::{Piece, piece_gap};
use clearway_plan::Budget;
use parry3d_f64::math::{Pose, Vector};
use std::collections::HashMap;

/// Halving stops when no point travels farther than this, metres.
const FINE: f64 = 5e-5;
/// How far beyond what is needed to look, so that leases last.
const LOOK_AHEAD: f64 = 0.05;
/// Stands for a joint in the chain of what is pushed.
const PUSH: usize = usize::MAX;

/// A shape that moves.
pub(crate) struct Mover<'a> {
    pub piece: &'a Piece,
    pub motion: Motion<'a>,
}

/// How a shape's owner moves.
#[derive(Clone, Copy)]
pub(crate) enum Motion<'a> {
    /// With a link; the owner's pose in it is the identity for the link's own shapes.
    Link { link: usize, link_from_owner: Pose },
    /// Pushed along a line.
    Slide(&'a Slide),
}

#[derive(Clone)]
pub(crate) enum Other<'a> {
    Still { piece: &'a Piece, world_from_owner: Pose },
    Mover(usize),
}

#[derive(Clone)]
pub(crate) struct Pair<'a> {
    pub first: usize,
    pub second: Other<'a>,
    /// Which finding this pair counts to.
    pub subject: usize,
}

/// An instant of a segment.
#[derive(Clone, Copy, Debug)]
pub(crate) struct When {
    /// The row before.
    pub row: usize,
    /// Between that row and the next, 0 to 1.
    pub fraction: f64,
}

/// What is looked for. Pairs go by their number.
pub(crate) trait Seek {
    /// The pair matters where it is nearer than this, metres; −∞: nowhere.
    fn below(&self, pair: usize) -> f64;
    /// An exact distance; `owner` is that of the first shape, in the world.
    fn met(&mut self, pair: usize, gap: Gap, when: When, owner: &Pose);
    /// Enough is known about the pair: only rows are looked at from here on.
    fn done(&self, pair: usize) -> bool;
    /// Whether the pair matters at all with the first shape's owner here.
    fn counts(&self, pair: usize, owner: &Pose) -> bool;
}

/// How many joints above each of a pair, counted from its end, move it against the other.
struct Between {
    first_joints: usize,
    second_joints: usize,
}

/// What a look at a pair came to.
struct Look {
    /// A lower bound of the distance if it is not exact.
    gap: Gap,
    exact: bool,
    /// The first shape's, in the world.
    owner: Pose,
}

pub(crate) struct Sweep<'a> {
    case: &'a Case,
    track: &'a Track<'a>,
    movers: &'a [Mover<'a>],
    /// By mover: joints above it, nearest first.
    chains: Vec<Vec<usize>>,
    /// By row, empty while not asked for.
    at_rows: Vec<Vec<Pose>>,
    /// Within one interval, by the bits of the fraction.
    between: HashMap<u64, Vec<Pose>>,
    pub distances: usize,
}

impl<'a> Sweep<'a> {
    pub fn new(case: &'a Case, track: &'a Track<'a>, movers: &'a [Mover<'a>]) -> Self {
        let chain = |mover: &Mover| match mover.motion {
            Motion::Link { link, .. } => case.model.moving_joints_above(link),
            Motion::Slide(_) => vec![PUSH],
        };
        let chains = movers.iter().map(chain).collect();
        let at_rows = vec![Vec::new(); track.postures.len()];
        Self { case, track, movers, chains, at_rows, between: HashMap::new(), distances: 0 }
    }

    /// From the first row to the last, for all that is looked for.
    pub fn run(&mut self, pairs: &[Pair<'a>], seeks: &mut [&mut dyn Seek], budget: &Budget) -> Result<(), CannotJudge> {
        let joints: Vec<Between> = pairs.iter().map(|pair| self.joints_between(pair)).collect();
        // By pair, for each that looks: nothing happens until the travels sum to this.
        let mut leases: Vec<f64> = Vec::with_capacity(pairs.len() * seeks.len());
        for (index, pair) in pairs.iter().enumerate() {
            budget.check()?;
            for seek in seeks.iter_mut() {
                let matters = seek.below(index) > f64::NEG_INFINITY;
                let mut look =
                    || self.look(pair, index, When { row: 0, fraction: 0.0 }, LOOK_AHEAD, *seek).gap.distance;
                leases.push(if matters { look() } else { f64::INFINITY });
            }
        }
        // By mover and number of joints, how far it has travelled against the link above those.
        let mut travelled: Vec<Vec<f64>> = self.chains.iter().map(|c| vec![0.0; c.len() + 1]).collect();
        let mut travel = travelled.clone();
        for row in 0..self.track.postures.len().saturating_sub(1) {
            budget.check()?;
            self.between.clear();
            self.bound_travel(row, &mut travel);
            for (index, ((pair, joints), leases)) in
                pairs.iter().zip(&joints).zip(leases.chunks_mut(seeks.len())).enumerate()
            {
                let sum = |by_mover: &[Vec<f64>]| {
                    let second = match pair.second {
                        Other::Still { .. } => 0.0,
                        Other::Mover(m) => by_mover[m][joints.second_joints],
                    };
                    by_mover[pair.first][joints.first_joints] + second
                };
                let (before, length) = (sum(&travelled), sum(&travel));
                for (seek, lease) in seeks.iter_mut().zip(leases) {
                    if before + length > *lease - seek.below(index) {
                        *lease = self.renew((index, pair), row, before, length, *seek, budget)?;
                    }
                }
            }
            for (total, step) in travelled.iter_mut().flatten().zip(travel.iter().flatten()) {
                *total += step;
            }
            // Never asked for again.
            self.at_rows[row] = Vec::new();
        }
        Ok(())
    }

    /// Only at every so many rows, and no farther than matters: for a first idea.
    pub fn sample(
        &mut self,
        pairs: &[Pair<'a>],
        every: usize,
        seek: &mut dyn Seek,
        budget: &Budget,
    ) -> Result<(), CannotJudge> {
        for row in (0..self.track.postures.len()).step_by(every) {
            budget.check()?;
            for (index, pair) in pairs.iter().enumerate() {
                if seek.below(index) > f64::NEG_INFINITY {
                    self.look(pair, index, When { row, fraction: 0.0 }, 0.0, seek);
                }
            }
        }
        Ok(())
    }

    /// Measures at the start of the interval, in which the pair moves by at most `length`; returns when
    /// it can touch.
    fn renew(
        &mut self,
        (index, pair): (usize, &Pair<'a>),
        row: usize,
        before: f64,
        length: f64,
        seek: &mut dyn Seek,
        budget: &Budget,
    ) -> Result<f64, CannotJudge> {
        let look = self.look(pair, index, When { row, fraction: 0.0 }, length + LOOK_AHEAD, seek);
        let meets = before + look.gap.distance;
        if before + length <= meets - seek.below(index) {
            return Ok(meets);
        }
        if !seek.done(index)
            && (seek.counts(index, &look.owner) || seek.counts(index, &self.owner(pair.first, row + 1)))
        {
            self.halve((index, pair), row, (0.0, 1.0), length, seek, budget)?;
        }
        // The next interval measures afresh.
        Ok(f64::NEG_INFINITY)
    }

    fn halve(
        &mut self,
        (index, pair): (usize, &Pair<'a>),
        row: usize,
        (low, high): (f64, f64),
        length: f64,
        seek: &mut dyn Seek,
        budget: &Budget,
    ) -> Result<(), CannotJudge> {
        budget.check()?;
        let middle = 0.5 * (low + high);
        let reach = 0.5 * (high - low) * length;
        let look = self.look(pair, index, When { row, fraction: middle }, reach, seek);
        if reach <= look.gap.distance - seek.below(index) || reach < FINE || seek.done(index) {
            return Ok(());
        }
        self.halve((index, pair), row, (low, middle), length, seek, budget)?;
        self.halve((index, pair), row, (middle, high), length, seek, budget)
    }

    /// Measures, if the pair may be within `reach` of mattering, and tells.
    fn look(&mut self, pair: &Pair<'a>, index: usize, when: When, reach: f64, seek: &mut dyn Seek) -> Look {
        let look = self.measure(pair, when, reach + seek.below(index).max(0.0) + FINE);
        if look.exact {
            seek.met(index, look.gap, when, &look.owner);
        }
        look
    }

    /// The signed distance; beyond `reach`, a lower bound of it.
    fn measure(&mut self, pair: &Pair<'a>, when: When, reach: f64) -> Look {
        let movers = self.movers;
        let (first, world_from_first) = (movers[pair.first].piece, self.pose(pair.first, when));
        let (second, world_from_second) = match &pair.second {
            Other::Still { piece, world_from_owner } => (*piece, *world_from_owner),
            Other::Mover(m) => (movers[*m].piece, self.pose(*m, when)),
        };
        let center = world_from_first.transform_point(first.center);
        let between = center - world_from_second.transform_point(second.center);
        let balls = between.length() - first.radius - second.radius;
        let bound =
            |distance: f64| Look { gap: Gap { distance, point: center }, exact: false, owner: world_from_first };
        if balls > reach {
            return bound(balls);
        }
        self.distances += 1;
        match piece_gap(first, &world_from_first, second, &world_from_second, reach) {
            Some(gap) => Look { gap, exact: true, owner: world_from_first },
            None => bound(reach),
        }
    }

    /// Whether, at the start, one of the two is wholly inside the other's mesh.
    fn enclosed(&mut self, pair: &Pair<'a>) -> bool {
        let (movers, start) = (self.movers, When { row: 0, fraction: 0.0 });
        let (first, world_from_first) = (movers[pair.first].piece, self.pose(pair.first, start));
        let (second, world_from_second) = match &pair.second {
            Other::Still { piece, world_from_owner } => (*piece, *world_from_owner),
            Other::Mover(m) => (movers[*m].piece, self.pose(*m, start)),
        };
        first.encloses(&world_from_first, second, &world_from_second)
            || second.encloses(&world_from_second, first, &world_from_first)
    }

    /// A mover's owner at a row.
    fn owner(&mut self, mover: usize, row: usize) -> Pose {
        self.pose(mover, When { row, fraction: 0.0 })
    }

    /// A mover's owner in the world.
    fn pose(&mut self, mover: usize, when: When) -> Pose {
        match self.movers[mover].motion {
            Motion::Link { link, link_from_owner } => self.poses(when)[link] * link_from_owner,
            Motion::Slide(slide) => slide.at(when),
        }
    }

    /// Link poses at a row, or so far on the straight line to the next.
    fn poses(&mut self, When { row, fraction }: When) -> &[Pose] {
        let (case, track) = (self.case, self.track);
        if fraction == 0.0 {
            let poses = &mut self.at_rows[row];
            if poses.is_empty() {
                *poses = case.link_poses(&track.postures[row]);
            }
            return poses;
        }
        self.between.entry(fraction.to_bits()).or_insert_with(|| {
            let ends = track.postures[row].iter().zip(&track.postures[row + 1]);
            let posture: Vec<f64> = ends.map(|(a, b)| a + fraction * (b - a)).collect();
            case.link_poses(&posture)
        })
    }

    /// For every mover, how far its points may travel in the interval after `row`, against the
    /// link above each of its joints.
    fn bound_travel(&mut self, row: usize, travel: &mut [Vec<f64>]) {
        let (case, track, movers) = (self.case, self.track, self.movers);
        let delta: Vec<f64> =
            track.postures[row].iter().zip(&track.postures[row + 1]).map(|(a, b)| (b - a).abs()).collect();
        let chains = std::mem::take(&mut self.chains);
        let poses = self.poses(When { row, fraction: 0.5 });
        for ((mover, chain), out) in movers.iter().zip(&chains).zip(travel) {
            let (link, link_from_owner) = match mover.motion {
                Motion::Link { link, link_from_owner } => (link, link_from_owner),
                Motion::Slide(slide) => {
                    out[1] = slide.ways[row + 1] - slide.ways[row];
                    continue;
                }
            };
            let center = (poses[link] * link_from_owner).transform_point(mover.piece.center);
            let mut half = 0.0;
            for (k, &j) in chain.iter().enumerate() {
                if delta[j] > 0.0 {
                    let joint = &case.model.joints[j];
                    let reach = match joint.kind {
                        JointKind::Prismatic | JointKind::Fixed => 1.0,
                        JointKind::Revolute | JointKind::Continuous => {
                            let frame = &poses[joint.child];
                            let from_axis = (center - frame.translation).cross(frame.rotation * joint.axis);
                            from_axis.length() + mover.piece.radius + half
                        }
                    };
                    half += 0.5 * delta[j] * reach;
                }
                out[k + 1] = 2.0 * half;
            }
        }
        self.chains = chains;
    }

    fn joints_between(&self, pair: &Pair<'a>) -> Between {
        let first = &self.chains[pair.first];
        let (first_joints, second_joints) = match pair.second {
            Other::Still { .. } => (first.len(), 0),
            Other::Mover(m) => {
                let second = &self.chains[m];
                let shared = first.iter().rev().zip(second.iter().rev()).take_while(|(a, b)| a == b).count();
                (first.len() - shared, second.len() - shared)
            }
        };
        Between { first_joints, second_joints }
    }
}

/// A point in the world, for messages.
pub(crate) fn point(p: Vector) -> String {
    format!("({:.4}, {:.4}, {:.4}) m", p.x, p.y, p.z)
}

#[cfg(test)]
mod tests;
