//! Inverse kinematics: the postures that bring the tool to a pose.
//!
//! Two builds are solved in closed form: six joints with three parallel axes and a wrist whose last
//! two axes meet (UR and its like), all branches; and seven joints with a spherical shoulder (Panda
//! and its like) or a spherical wrist (PR2 and its like), all branches for each of many values of the
//! joint at the other end, the last or the first. Any other chain is solved by damped least squares
//! from many seeds.

mod chain;
mod numeric;
mod spherical_shoulder;
mod subproblems;
mod sweep;
mod three_parallel;

use crate::kinematics::Kinematics;
use chain::Chain;
use clearway_geometry::Pose;
use numeric::Limits;
use std::f64::consts::TAU;
use sweep::{Asked, Sweep};

pub use spherical_shoulder::SphericalShoulder;
pub use three_parallel::ThreeParallel;

/// A posture of the arm: a value per arm joint.
pub type Posture = Vec<f64>;

/// How a pose is turned into postures.
#[derive(Clone, Debug)]
pub struct InverseKinematics {
    chain: Chain,
    lower: Vec<f64>,
    upper: Vec<f64>,
    method: Method,
    /// Whether poses are looked for that only few values of a redundant joint have.
    slivers: bool,
}

#[derive(Clone, Debug)]
enum Method {
    ThreeParallel(Box<ThreeParallel>),
    SphericalShoulder(Box<Sweep>),
    /// From these seeds, spread over the joint ranges.
    Numeric(Vec<Posture>),
}

/// A solution may miss the pose by this much, metres and radians.
pub const TOLERANCE: f64 = 1e-9;
/// One that was followed along a trail, by this much.
pub const TRAIL_TOLERANCE: f64 = 1e-6;

impl InverseKinematics {
    pub fn new(robot: &crate::Robot, kinematics: &Kinematics) -> Self {
        let method = if let Some(closed) = ThreeParallel::of(robot, kinematics) {
            Method::ThreeParallel(Box::new(closed))
        } else if let Some(closed) = SphericalShoulder::of(robot, kinematics) {
            Method::SphericalShoulder(Box::new(Sweep::new(closed, Limits { lower: &robot.lower, upper: &robot.upper })))
        } else {
            Method::Numeric(numeric::seeds(robot))
        };
        Self {
            chain: Chain::of(kinematics),
            lower: robot.lower.clone(),
            upper: robot.upper.clone(),
            method,
            slivers: true,
        }
    }

    /// By descent from seeds, even where a closed form is known: to measure the one beside the other.
    pub fn numeric(robot: &crate::Robot, kinematics: &Kinematics) -> Self {
        let method = Method::Numeric(numeric::seeds(robot));
        Self {
            chain: Chain::of(kinematics),
            lower: robot.lower.clone(),
            upper: robot.upper.clone(),
            method,
            slivers: true,
        }
    }

    /// In words, for reports.
    pub fn describe(&self) -> &'static str {
        match &self.method {
            Method::ThreeParallel(_) => "closed form (three parallel axes, up to 8 branches)",
            Method::SphericalShoulder(sweep) if sweep.closed.at_wrist() => {
                "closed form (spherical wrist, up to 8 branches for each value of the first joint, which is swept)"
            }
            Method::SphericalShoulder(_) => {
                "closed form (spherical shoulder, up to 8 branches for each value of the last joint, which is swept)"
            }
            Method::Numeric(_) => "numeric (damped least squares from spread seeds)",
        }
    }

    /// The same, several times faster about poses out of reach: those that only few values of a redundant joint
    /// have are passed over.
    #[must_use]
    pub fn without_slivers(self) -> Self {
        Self { slivers: false, ..self }
    }

    /// Whether the method finds every branch, so that finding none is a proof. A swept joint is no
    /// proof: there may be postures between the values tried.
    pub fn complete(&self) -> bool {
        matches!(self.method, Method::ThreeParallel(_))
    }

    /// Postures that bring the tool to `root_from_tool`, within the joint limits, each with its joints
    /// turned by whole turns to be nearest to `near`: all of them, or, where there are infinitely many,
    /// some that differ. At a singularity one of the infinitely many.
    pub fn solve(&self, root_from_tool: &Pose, near: &[f64]) -> Vec<Posture> {
        self.solve_some(root_from_tool, near, Asked { slivers: self.slivers, half_turn: false })
    }

    /// Some of them, soon: only with the value that a redundant joint has in `near`, or, where there is no closed form,
    /// what a descent from there finds.
    pub fn solve_near(&self, root_from_tool: &Pose, near: &[f64]) -> Vec<Posture> {
        let sound = |q: &mut Posture| self.polish(root_from_tool, q) && self.wrap(q, near);
        let mut found = match &self.method {
            Method::ThreeParallel(closed) => closed.solve(root_from_tool),
            Method::SphericalShoulder(sweep) => sweep.solve_near(root_from_tool, near),
            Method::Numeric(_) => numeric::solve(&self.chain, root_from_tool, &[near.to_vec()], self.limits()),
        };
        found.retain_mut(sound);
        found
    }

    /// The same for a hand that is the same upside down, and when it is asked for this pose and for the one turned by
    /// half a turn about its z axis: of postures that differ by just that turn of the last joint one is found. Half
    /// the work for arms with a swept last joint that turns the tool about z; others find all.
    pub fn solve_of_two(&self, root_from_tool: &Pose, near: &[f64]) -> Vec<Posture> {
        self.solve_some(root_from_tool, near, Asked { slivers: self.slivers, half_turn: true })
    }

    fn solve_some(&self, root_from_tool: &Pose, near: &[f64], asked: Asked) -> Vec<Posture> {
        let sound = |q: &mut Posture| self.polish(root_from_tool, q) && self.wrap(q, near);
        match &self.method {
            Method::ThreeParallel(closed) => {
                let mut found = closed.solve(root_from_tool);
                found.retain_mut(sound);
                distinct(found, 1e-6)
            }
            Method::SphericalShoulder(sweep) => {
                let asked = Asked { half_turn: asked.half_turn && sweep.half_turn_is_all(), ..asked };
                let mut found = sweep.solve(root_from_tool, near, asked);
                found.retain_mut(|q| self.wrap(q, near));
                let mut few = sweep::spread(found, near, asked);
                few.retain_mut(sound);
                few
            }
            Method::Numeric(seeds) => {
                let mut found = numeric::solve(&self.chain, root_from_tool, seeds, self.limits());
                found.retain_mut(sound);
                distinct(found, 0.3)
            }
        }
    }

    /// The posture that brings the tool to `root_from_tool` and is reached from the end of a trail of
    /// postures by a small motion: no joint moves by more than `reach` (radians or metres). Evenly
    /// spaced poses are found soonest; without a trail there is none.
    pub fn follow(&self, root_from_tool: &Pose, trail: &[Posture], reach: f64) -> Option<Posture> {
        let from = trail.last()?;
        let near = |q: &[f64]| q.iter().zip(from).all(|(a, b)| (a - b).abs() <= reach);
        let mut q = from.clone();
        if let [.., before, _] = trail {
            let onwards = q.iter_mut().zip(before).zip(self.lower.iter().zip(&self.upper));
            onwards.for_each(|((q, b), (low, high))| *q = (2.0 * *q - b).clamp(*low, *high));
        }
        if numeric::descend(&self.chain, root_from_tool, &mut q, Some(self.limits()), 20, TRAIL_TOLERANCE) && near(&q) {
            return Some(q);
        }
        let Method::SphericalShoulder(sweep) = &self.method else { return None };
        q.copy_from_slice(&sweep.follow(root_from_tool, from, self.limits(), reach)?);
        (self.polish(root_from_tool, &mut q) && near(&q) && self.limits().hold(&q)).then_some(q)
    }

    fn limits(&self) -> Limits<'_> {
        Limits { lower: &self.lower, upper: &self.upper }
    }

    /// A few Newton steps, so that rounding near singularities does not remain.
    fn polish(&self, target: &Pose, q: &mut [f64]) -> bool {
        numeric::descend(&self.chain, target, q, None, 4, TOLERANCE)
    }

    /// Turns joints by whole turns towards `near`; false when no turn lies within the limits.
    fn wrap(&self, q: &mut [f64], near: &[f64]) -> bool {
        for (i, value) in q.iter_mut().enumerate() {
            let (low, high) = (self.lower[i], self.upper[i]);
            if high - low < TAU && *value >= low && *value <= high {
                continue;
            }
            let nearest = *value + TAU * ((near[i] - *value) / TAU).round();
            let inside = |v: &f64| *v >= low - 1e-9 && *v <= high + 1e-9;
            match [nearest, nearest - TAU, nearest + TAU].into_iter().find(inside) {
                Some(v) => *value = v.clamp(low, high),
                None => return false,
            }
        }
        true
    }
}

/// Those of which each differs from all before by more than `apart` in some joint.
fn distinct(found: Vec<Posture>, apart: f64) -> Vec<Posture> {
    let mut distinct: Vec<Posture> = Vec::with_capacity(found.len());
    for q in found {
        if distinct.iter().all(|d| d.iter().zip(&q).any(|(a, b)| (a - b).abs() > apart)) {
            distinct.push(q);
        }
    }
    distinct
}
