//! The redundant joint of a closed form, swept over its range; and out of the many postures a few
//! that differ.

use super::Posture;
use super::numeric::Limits;
use super::spherical_shoulder::{SphericalShoulder, Swept};
use clearway_geometry::Pose;
use std::f64::consts::{PI, TAU};

/// Values of the swept joint that are tried.
const VALUES: usize = 24;
/// While none of them is of use, as many values between each two.
const FINER: usize = 8;
/// Postures handed on, of half a turn of the swept joint alone, and how far apart they are at least in some joint,
/// radians.
const MOST: usize = 12;
const MOST_OF_HALF: usize = 8;
const APART: f64 = 0.3;

/// A closed form and the values of its swept joint.
#[derive(Clone, Debug)]
pub struct Sweep {
    pub closed: SphericalShoulder,
    /// What the joint may be, a whole turn at most.
    low: f64,
    high: f64,
    coarse: Vec<Swept>,
    fine: Vec<Swept>,
}

/// Which postures are wanted.
#[derive(Clone, Copy, Debug)]
pub struct Asked {
    /// Also those that only few values of the swept joint have.
    pub slivers: bool,
    /// Only within half a turn about the middle of the swept joint's range.
    pub half_turn: bool,
}

impl Sweep {
    pub fn new(closed: SphericalShoulder, limits: Limits) -> Self {
        let swept = closed.swept();
        let (lower, upper) = (limits.lower[swept], limits.upper[swept]);
        let (low, high) = if upper - lower > TAU { (-PI, PI) } else { (lower, upper) };
        let spread = |count: usize| {
            (0..count).map(|i| closed.at(low + (high - low) * (i as f64 + 0.5) / count as f64)).collect()
        };
        let (coarse, fine) = (spread(VALUES), spread(VALUES * FINER));
        Self { closed, low, high, coarse, fine }
    }

    /// Whether within half a turn of the swept joint every posture is found but for half a turn of the tool
    /// about its z axis.
    pub fn half_turn_is_all(&self) -> bool {
        self.high - self.low >= PI && self.closed.turns_end_about_z()
    }

    /// Postures at values of the swept joint spread over its range, and at `near`'s; failing those, if asked, at
    /// the values where slivers are.
    pub fn solve(&self, root_from_tool: &Pose, near: &[f64], asked: Asked) -> Vec<[f64; 7]> {
        let closed = &self.closed;
        let wanted = closed.wanted(root_from_tool);
        let middle = (self.low + self.high) / 2.0;
        let inside = |value: f64| {
            (self.low..=self.high).contains(&value) && (!asked.half_turn || (value - middle).abs() <= PI / 2.0)
        };
        let mut found = Vec::new();
        let mut at = |swept: &Swept| {
            if inside(swept.value) {
                closed.solve_at(&wanted, swept, |q| found.push(q));
            }
        };
        if let Some(&value) = near.get(closed.swept()) {
            at(&closed.at(value));
        }
        self.coarse.iter().for_each(&mut at);
        if found.is_empty() && asked.slivers {
            for swept in self.fine.iter().filter(|swept| inside(swept.value)) {
                closed.solve_at(&wanted, swept, |q| found.push(q));
            }
        }
        // An elbow that straightens within its limits (PR2's) leaves a sliver round where the way is longest;
        // another may lie at either end of the range. A spherical shoulder's elbow seldom does (a Panda misses
        // hardly one pose in a thousand) and is left with the values above.
        if found.is_empty() && asked.slivers && closed.at_wrist() {
            let extremes = closed.extremes(&wanted).map(|q| self.low + (q - self.low).rem_euclid(TAU));
            for value in extremes.into_iter().chain([self.low, self.high]).filter(|&q| inside(q)) {
                closed.solve_at(&wanted, &closed.at(value), |q| found.push(q));
            }
        }
        found
    }

    /// Postures at the value that the swept joint has in `near`.
    pub fn solve_near(&self, root_from_tool: &Pose, near: &[f64]) -> Vec<Posture> {
        let closed = &self.closed;
        let mut found = Vec::new();
        closed.solve_at(&closed.wanted(root_from_tool), &closed.at(near[closed.swept()]), |q| found.push(Vec::from(q)));
        found
    }

    /// The posture nearest to `from` (in the joint that moves most) at the value of the swept joint
    /// nearest to `from`'s that has one within `reach` in every joint.
    pub fn follow(&self, root_from_tool: &Pose, from: &[f64], limits: Limits, reach: f64) -> Option<[f64; 7]> {
        const STEPS: i32 = 8;
        let closed = &self.closed;
        let (wanted, swept) = (closed.wanted(root_from_tool), closed.swept());
        for step in 0..=STEPS {
            let mut best: Option<(f64, [f64; 7])> = None;
            for side in [1.0, -1.0] {
                let value = from[swept] + side * reach * f64::from(step) / f64::from(STEPS);
                if value < limits.lower[swept] || value > limits.upper[swept] {
                    continue;
                }
                closed.solve_at(&wanted, &closed.at(value), |mut q| {
                    for i in 0..7 {
                        q[i] = from[i] + (q[i] - from[i] + PI).rem_euclid(TAU) - PI;
                    }
                    let far = apart(&q, from);
                    if limits.hold(&q) && far <= reach && best.is_none_or(|(least, _)| far < least) {
                        best = Some((far, q));
                    }
                });
            }
            if let Some((_, q)) = best {
                return Some(q);
            }
        }
        None
    }
}

/// A few of the postures, as different as can be, the one nearest to `near` first.
pub fn spread(mut postures: Vec<[f64; 7]>, near: &[f64], asked: Asked) -> Vec<Posture> {
    let most = if asked.half_turn { MOST_OF_HALF } else { MOST };
    let nearest = |a: &usize, b: &usize| apart(&postures[*a], near).total_cmp(&apart(&postures[*b], near));
    let Some(first) = (0..postures.len()).min_by(nearest) else { return Vec::new() };
    let mut chosen = vec![postures.swap_remove(first)];
    let mut gaps: Vec<f64> = postures.iter().map(|q| apart(q, &chosen[0])).collect();
    while chosen.len() < most {
        let Some((i, gap)) = gaps.iter().copied().enumerate().max_by(|a, b| a.1.total_cmp(&b.1)) else { break };
        if gap < APART {
            break;
        }
        gaps.swap_remove(i);
        let next = postures.swap_remove(i);
        for (gap, q) in gaps.iter_mut().zip(&postures) {
            *gap = gap.min(apart(q, &next));
        }
        chosen.push(next);
    }
    chosen.into_iter().map(Vec::from).collect()
}

/// How far the joint that differs most differs.
fn apart(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max)
}
