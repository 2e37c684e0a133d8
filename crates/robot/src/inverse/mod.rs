//! Inverse kinematics: the postures that bring the tool to a pose.
//!
//! Arms with three parallel axes and a wrist whose last two axes meet (UR and its like) are
//! solved in closed form, all branches; any other chain by damped least squares from many seeds.

mod numeric;
mod subproblems;
mod three_parallel;

use crate::kinematics::Kinematics;
use clearway_geometry::Pose;
use std::f64::consts::TAU;

pub use three_parallel::ThreeParallel;

/// A posture of the arm: a value per arm joint.
pub type Posture = Vec<f64>;

/// How a pose is turned into postures.
#[derive(Clone, Debug)]
pub struct InverseKinematics {
    kinematics: Kinematics,
    lower: Vec<f64>,
    upper: Vec<f64>,
    method: Method,
    /// Seeds of the numeric solver, spread over the joint ranges.
    seeds: Vec<Posture>,
}

#[derive(Clone, Debug)]
enum Method {
    ThreeParallel(Box<ThreeParallel>),
    Numeric,
}

/// A solution may miss the pose by this much, metres and radians.
pub const TOLERANCE: f64 = 1e-9;

impl InverseKinematics {
    pub fn new(robot: &crate::Robot, kinematics: &Kinematics) -> Self {
        let method = match ThreeParallel::of(robot, kinematics) {
            Some(closed) => Method::ThreeParallel(Box::new(closed)),
            None => Method::Numeric,
        };
        let seeds = numeric::seeds(robot);
        Self { kinematics: kinematics.clone(), lower: robot.lower.clone(), upper: robot.upper.clone(), method, seeds }
    }

    /// In words, for reports.
    pub fn describe(&self) -> &'static str {
        match self.method {
            Method::ThreeParallel(_) => "closed form (three parallel axes, up to 8 branches)",
            Method::Numeric => "numeric (damped least squares from spread seeds)",
        }
    }

    /// Whether the method finds every branch, so that finding none is a proof.
    pub fn complete(&self) -> bool {
        matches!(self.method, Method::ThreeParallel(_))
    }

    /// All postures found that bring the tool to `root_from_tool`, within the joint limits, each
    /// with its joints turned by whole turns to be nearest to `near`. At a singularity one of the
    /// infinitely many.
    pub fn solve(&self, root_from_tool: &Pose, near: &[f64]) -> Vec<Posture> {
        let mut found = match &self.method {
            Method::ThreeParallel(closed) => closed.solve(root_from_tool),
            Method::Numeric => self.seeds.iter().filter_map(|s| self.descend(root_from_tool, s)).collect(),
        };
        found.retain_mut(|q| self.polish(root_from_tool, q) && self.wrap(q, near));
        let mut distinct: Vec<Posture> = Vec::with_capacity(found.len());
        let apart = if matches!(self.method, Method::Numeric) { 0.3 } else { 1e-6 };
        for q in found {
            if distinct.iter().all(|d| d.iter().zip(&q).any(|(a, b)| (a - b).abs() > apart)) {
                distinct.push(q);
            }
        }
        distinct
    }

    /// The posture that brings the tool to `root_from_tool` and is reached from `from` by a small
    /// motion: no joint moves by more than `reach` (radians or metres).
    pub fn follow(&self, root_from_tool: &Pose, from: &[f64], reach: f64) -> Option<Posture> {
        let mut q = from.to_vec();
        if !(self.polish(root_from_tool, &mut q) || numeric::descend(&self.kinematics, root_from_tool, &mut q, 20, TOLERANCE)) {
            return None;
        }
        let near = q.iter().zip(from).all(|(a, b)| (a - b).abs() <= reach);
        let inside = q.iter().zip(&self.lower).zip(&self.upper).all(|((q, l), u)| q >= l && q <= u);
        (near && inside).then_some(q)
    }

    fn descend(&self, target: &Pose, seed: &[f64]) -> Option<Posture> {
        let mut q = seed.to_vec();
        numeric::descend_within(&self.kinematics, target, &mut q, &self.lower, &self.upper).then_some(q)
    }

    /// A few Newton steps, so that rounding near singularities does not remain.
    fn polish(&self, target: &Pose, q: &mut [f64]) -> bool {
        numeric::descend(&self.kinematics, target, q, 4, TOLERANCE)
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
