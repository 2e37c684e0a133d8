//! Continuous collision checking of one segment: between rows, joints move on straight lines.
//!
//! Every pair of shapes keeps a lease: having measured that two shapes are `d` apart, they cannot
//! touch before one has travelled `d` against the other. Travel is bounded by the joints between
//! them: |Δq| times the largest distance of the body from the joint's axis, taken at the middle of
//! the interval and widened by what the joints nearer to the body may add. When a lease runs out it
//! is measured again; when an interval is longer than the gap, the interval is halved, until the
//! bodies move by less than 0.05 mm. So nothing that overlaps by 0.2 mm for an instant is missed,
//! and nothing that overlaps by less than 0.1 mm is reported.

use crate::case::{Case, Track};
use crate::error::CannotJudge;
use crate::gap::Gap;
use crate::model::JointKind;
use crate::rest::TOUCH;
use crate::shapes::{Piece, piece_gap};
use clearway_plan::Budget;
use parry3d_f64::math::{Pose, Vector};
use std::collections::HashMap;

/// Halving stops when no point travels farther than this, metres.
const FINE: f64 = 5e-5;
/// Overlap that a bound may leave open without a closer look; the rest of 0.1 mm is for
/// inexact distances.
const LEFT_OPEN: f64 = 5e-5;
/// How far beyond what is needed to look, so that leases last.
const LOOK_AHEAD: f64 = 0.05;

/// A shape that moves with a link.
pub(crate) struct Mover<'a> {
    pub piece: &'a Piece,
    pub link: usize,
    /// The shape's owner in the link's frame; the identity for the link's own shapes.
    pub link_from_owner: Pose,
}

pub(crate) enum Other<'a> {
    Still { piece: &'a Piece, world_from_owner: Pose },
    Mover(usize),
}

/// How much overlap is forgiven, and near which owner positions (world) of the first mover.
#[derive(Clone, Default)]
pub(crate) struct Forgiven {
    pub near: Vec<Vector>,
    pub within: f64,
    pub overlap: f64,
}

pub(crate) struct Pair<'a> {
    pub first: usize,
    pub second: Other<'a>,
    /// Which finding this pair counts to.
    pub subject: usize,
    pub forgiven: Option<Forgiven>,
}

/// The deepest overlap found for a subject.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Touch {
    pub subject: usize,
    /// The row before.
    pub row: usize,
    /// Between that row and the next, 0 to 1.
    pub fraction: f64,
    /// Metres.
    pub depth: f64,
    pub point: Vector,
    /// One shape is wholly inside a mesh: the depth says nothing.
    pub enclosed: bool,
}

/// A point in the world, for messages.
pub(crate) fn point(p: Vector) -> String {
    format!("({:.4}, {:.4}, {:.4}) m", p.x, p.y, p.z)
}

struct Lease<'a, 'p> {
    pair: &'p Pair<'a>,
    /// Joints of each side that move it against the other.
    first_joints: usize,
    second_joints: usize,
    /// No touch until the travels sum to this.
    until: f64,
    found: Option<Touch>,
}

pub(crate) struct Sweep<'a> {
    case: &'a Case,
    track: &'a Track<'a>,
    movers: &'a [Mover<'a>],
    /// By mover: joints above it, nearest first.
    chains: Vec<Vec<usize>>,
    at_rows: HashMap<usize, Vec<Pose>>,
    /// Within one interval, by the bits of the fraction.
    between: HashMap<u64, Vec<Pose>>,
    pub distances: usize,
}

impl<'a> Sweep<'a> {
    pub fn new(case: &'a Case, track: &'a Track<'a>, movers: &'a [Mover<'a>]) -> Self {
        let chains = movers.iter().map(|m| case.model.moving_joints_above(m.link)).collect();
        Self { case, track, movers, chains, at_rows: HashMap::new(), between: HashMap::new(), distances: 0 }
    }

    /// The deepest touch of every subject that touches.
    pub fn run(&mut self, pairs: &[Pair<'a>], budget: &Budget) -> Result<Vec<Touch>, CannotJudge> {
        let mut leases: Vec<Lease> = Vec::with_capacity(pairs.len());
        for pair in pairs {
            budget.check()?;
            let (first_joints, second_joints) = self.joints_between(pair);
            let gap = self.measure(pair, 0, 0.0, LOOK_AHEAD);
            let mut lease = Lease { pair, first_joints, second_joints, until: gap.distance + LEFT_OPEN, found: None };
            self.judge(&mut lease, gap, 0, 0.0);
            if lease.found.is_none() && self.enclosed(pair) {
                let depth = gap.distance.abs();
                lease.found = Some(Touch {
                    subject: pair.subject,
                    row: 0,
                    fraction: 0.0,
                    depth,
                    point: gap.point,
                    enclosed: true,
                });
            }
            leases.push(lease);
        }
        // By mover and number of joints, how far it has travelled against the link above those.
        let mut travelled: Vec<Vec<f64>> = self.chains.iter().map(|c| vec![0.0; c.len() + 1]).collect();
        let mut travel = travelled.clone();
        for row in 0..self.track.postures.len().saturating_sub(1) {
            budget.check()?;
            self.between.clear();
            self.bound_travel(row, &mut travel);
            for lease in &mut leases {
                let sum = |by_mover: &[Vec<f64>]| {
                    let second = match lease.pair.second {
                        Other::Still { .. } => 0.0,
                        Other::Mover(m) => by_mover[m][lease.second_joints],
                    };
                    by_mover[lease.pair.first][lease.first_joints] + second
                };
                let (before, length) = (sum(&travelled), sum(&travel));
                if before + length > lease.until {
                    self.renew(lease, row, before, length, budget)?;
                }
            }
            for (total, step) in travelled.iter_mut().flatten().zip(travel.iter().flatten()) {
                *total += step;
            }
        }
        let mut deepest: HashMap<usize, Touch> = HashMap::new();
        for touch in leases.iter().filter_map(|l| l.found) {
            let entry = deepest.entry(touch.subject).or_insert(touch);
            if touch.depth > entry.depth {
                *entry = touch;
            }
        }
        let mut touches: Vec<Touch> = deepest.into_values().collect();
        touches.sort_by_key(|t| t.subject);
        Ok(touches)
    }

    /// Measures at the start of the interval, in which the pair moves by at most `length`.
    fn renew(
        &mut self,
        lease: &mut Lease<'a, '_>,
        row: usize,
        before: f64,
        length: f64,
        budget: &Budget,
    ) -> Result<(), CannotJudge> {
        let gap = self.measure(lease.pair, row, 0.0, length + LOOK_AHEAD);
        self.judge(lease, gap, row, 0.0);
        lease.until = before + gap.distance + LEFT_OPEN;
        if before + length > lease.until {
            if lease.found.is_none() {
                self.halve(lease, row, (0.0, 1.0), length, budget)?;
            }
            // The next interval measures afresh.
            lease.until = f64::NEG_INFINITY;
        }
        Ok(())
    }

    fn halve(
        &mut self,
        lease: &mut Lease<'a, '_>,
        row: usize,
        (low, high): (f64, f64),
        length: f64,
        budget: &Budget,
    ) -> Result<(), CannotJudge> {
        budget.check()?;
        let middle = 0.5 * (low + high);
        let reach = 0.5 * (high - low) * length;
        let gap = self.measure(lease.pair, row, middle, reach);
        self.judge(lease, gap, row, middle);
        if reach - gap.distance <= LEFT_OPEN || reach < FINE || lease.found.is_some() {
            return Ok(());
        }
        self.halve(lease, row, (low, middle), length, budget)?;
        self.halve(lease, row, (middle, high), length, budget)
    }

    fn judge(&mut self, lease: &mut Lease<'a, '_>, gap: Gap, row: usize, fraction: f64) {
        if gap.distance >= -TOUCH {
            return;
        }
        if let Some(forgiven) = &lease.pair.forgiven
            && gap.distance >= -forgiven.overlap
        {
            let mover = &self.movers[lease.pair.first];
            let owner = self.poses(row, fraction)[mover.link] * mover.link_from_owner;
            if forgiven.near.iter().any(|p| (*p - owner.translation).length() <= forgiven.within) {
                return;
            }
        }
        let depth = -gap.distance;
        if lease.found.is_none_or(|f| depth > f.depth) {
            lease.found =
                Some(Touch { subject: lease.pair.subject, row, fraction, depth, point: gap.point, enclosed: false });
        }
    }

    /// The signed distance; beyond `reach`, a lower bound of it.
    fn measure(&mut self, pair: &Pair<'a>, row: usize, fraction: f64, reach: f64) -> Gap {
        let movers = self.movers;
        let poses = self.poses(row, fraction);
        let first = &movers[pair.first];
        let world_from_first = poses[first.link] * first.link_from_owner;
        let (second, world_from_second) = match &pair.second {
            Other::Still { piece, world_from_owner } => (*piece, *world_from_owner),
            Other::Mover(m) => (movers[*m].piece, poses[movers[*m].link] * movers[*m].link_from_owner),
        };
        let center = world_from_first.transform_point(first.piece.center);
        let between = center - world_from_second.transform_point(second.center);
        let balls = between.length() - first.piece.radius - second.radius;
        if balls > reach {
            return Gap { distance: balls, point: center };
        }
        self.distances += 1;
        piece_gap(first.piece, &world_from_first, second, &world_from_second, reach)
            .unwrap_or(Gap { distance: reach, point: center })
    }

    fn enclosed(&mut self, pair: &Pair<'a>) -> bool {
        let movers = self.movers;
        let poses = self.poses(0, 0.0);
        let first = &movers[pair.first];
        let world_from_first = poses[first.link] * first.link_from_owner;
        let (second, world_from_second) = match &pair.second {
            Other::Still { piece, world_from_owner } => (*piece, *world_from_owner),
            Other::Mover(m) => (movers[*m].piece, poses[movers[*m].link] * movers[*m].link_from_owner),
        };
        first.piece.encloses(&world_from_first, second, &world_from_second)
            || second.encloses(&world_from_second, first.piece, &world_from_first)
    }

    /// Link poses at a row, or so far on the straight line to the next.
    fn poses(&mut self, row: usize, fraction: f64) -> &[Pose] {
        let (case, track) = (self.case, self.track);
        if fraction == 0.0 {
            return self.at_rows.entry(row).or_insert_with(|| case.link_poses(&track.postures[row]));
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
        let poses = self.poses(row, 0.5);
        for ((mover, chain), out) in movers.iter().zip(&chains).zip(travel) {
            let center = (poses[mover.link] * mover.link_from_owner).transform_point(mover.piece.center);
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

    /// How many joints above each side, counted from its end, move it against the other.
    fn joints_between(&self, pair: &Pair<'a>) -> (usize, usize) {
        let first = &self.chains[pair.first];
        match pair.second {
            Other::Still { .. } => (first.len(), 0),
            Other::Mover(m) => {
                let second = &self.chains[m];
                let shared = first.iter().rev().zip(second.iter().rev()).take_while(|(a, b)| a == b).count();
                (first.len() - shared, second.len() - shared)
            }
        }
    }
}

#[cfg(test)]
mod tests;
