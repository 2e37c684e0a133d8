//! RRT-Connect (Kuffner and LaValle 2000): two trees that grow towards each other, with dynamic
//! domains (Yershova et al. 2005) so that samples behind an obstacle are not tried again and again.

use crate::sampler::Sampler;
use crate::tree::Tree;
use crate::{MotionValidator, Path, Posture};
use clearway_plan::{Budget, Stop};

/// How the trees grow.
#[derive(Clone, Debug)]
pub struct Settings {
    /// Longest new motion, radians in joint space.
    pub range: f64,
    /// Samples drawn before giving up.
    pub iterations: usize,
    /// Once a motion from a node failed, samples farther from it than this, in ranges, are passed over.
    pub domain: f64,
}

impl Default for Settings {
    fn default() -> Self {
        Self { range: 0.8, iterations: 600, domain: 4.0 }
    }
}

impl Settings {
    pub fn validate(&self) -> Result<(), String> {
        if !(self.range > 0.0) {
            return Err(format!("range is {}, must be positive", self.range));
        }
        if !(self.domain >= 1.0) {
            return Err(format!("domain is {}, must be at least 1", self.domain));
        }
        Ok(())
    }
}

/// By how much a node's domain changes when a motion from it passes or fails.
const DOMAIN_CHANGE: f64 = 1e-4;

/// Room for the trees; reuse it to allocate nothing but the answer.
#[derive(Clone, Debug, Default)]
pub struct Trees {
    from_start: Tree,
    from_goal: Tree,
    sample: Posture,
    new: Posture,
    target: Posture,
}

/// A path from `start` to one of `goals`, or `None` when the iterations run out. Ends that are not
/// free are left out; straight lines are tried first.
pub fn connect(
    validator: &mut impl MotionValidator,
    start: &[f64],
    goals: &[Posture],
    sampler: &mut impl Sampler,
    settings: &Settings,
    trees: &mut Trees,
    budget: &Budget,
) -> Result<Option<Path>, Stop> {
    let joints = start.len();
    let Trees { from_start, from_goal, sample, new, target } = trees;
    from_start.clear(joints);
    from_goal.clear(joints);
    for room in [&mut *sample, new, target] {
        room.clear();
        room.resize(joints, 0.0);
    }
    if !validator.state_free(start) {
        return Ok(None);
    }
    for goal in goals {
        if validator.state_free(goal) {
            if validator.motion_free(start, goal) {
                return Ok(Some(vec![start.to_vec(), goal.clone()]));
            }
            from_goal.add(goal, None);
        }
    }
    if from_goal.len() == 0 {
        return Ok(None);
    }
    from_start.add(start, None);
    let mut forward = true;
    for iteration in 0..settings.iterations {
        if iteration % 16 == 0 {
            budget.check()?;
        }
        sampler.sample(sample);
        let (tree, other) =
            if forward { (&mut *from_start, &mut *from_goal) } else { (&mut *from_goal, &mut *from_start) };
        let (nearest, distance) = tree.nearest(sample);
        if distance > tree.domains[nearest] || distance == 0.0 {
            continue;
        }
        step(tree.node(nearest), sample, settings.range / distance, new);
        if !validator.motion_free(tree.node(nearest), new) {
            let domain = &mut tree.domains[nearest];
            *domain = if domain.is_finite() {
                (*domain * (1.0 - DOMAIN_CHANGE)).max(settings.range)
            } else {
                settings.domain * settings.range
            };
            continue;
        }
        tree.domains[nearest] *= 1.0 + DOMAIN_CHANGE;
        let added = tree.add(new, Some(nearest));
        target.copy_from_slice(new);
        if let Some(met) = reach(validator, other, target, settings.range, new) {
            let (mut path, mut rest) = (tree.branch(added), other.branch(met));
            rest.pop();
            rest.reverse();
            path.extend(rest);
            if !forward {
                path.reverse();
            }
            return Ok(Some(path));
        }
        // The smaller tree grows next.
        forward = from_start.len() <= from_goal.len();
    }
    Ok(None)
}

/// Steps of equal length from the tree's nearest node towards `target` until it is reached.
fn reach(
    validator: &mut impl MotionValidator,
    tree: &mut Tree,
    target: &[f64],
    range: f64,
    new: &mut [f64],
) -> Option<usize> {
    let (mut at, distance) = tree.nearest(target);
    let steps = (distance / range).ceil().max(1.0) as usize;
    for left in (1..=steps).rev() {
        step(tree.node(at), target, 1.0 / left as f64, new);
        if !validator.motion_free(tree.node(at), new) {
            return None;
        }
        at = tree.add(new, Some(at));
    }
    Some(at)
}

/// `to`, or the point `part` of the way there, where that is less.
fn step(from: &[f64], to: &[f64], part: f64, out: &mut [f64]) {
    if part >= 1.0 {
        out.copy_from_slice(to);
        return;
    }
    for ((out, a), b) in out.iter_mut().zip(from).zip(to) {
        *out = a + (b - a) * part;
    }
}
