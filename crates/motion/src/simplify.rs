//! Shorter paths with fewer corners, without chance: corners are left out and cut until little
//! more is to be had.
//!
//! What was validated once is not asked again: a cut corner's ends lie on motions known to be free,
//! so that only the new motion between them is checked.

use crate::{MotionValidator, Path, between, distance, length};
use clearway_plan::{Budget, Stop};

/// How hard to try.
#[derive(Clone, Debug)]
pub struct Settings {
    /// Rounds over all corners.
    pub rounds: usize,
    /// A round that shortens the path by less than this part of it is the last.
    pub least_change: f64,
    /// A cut that saves less than this part of the path is not tried.
    pub least_gain: f64,
}

impl Default for Settings {
    fn default() -> Self {
        Self { rounds: 6, least_change: 0.01, least_gain: 0.003 }
    }
}

/// Shortens a free path; the ends stay, and the result is free.
pub fn simplify(
    validator: &mut impl MotionValidator,
    path: Path,
    settings: &Settings,
    budget: &Budget,
) -> Result<Path, Stop> {
    let mut path = leave_out(validator, path, budget)?;
    for _ in 0..settings.rounds {
        let before = length(&path);
        if path.len() < 3 {
            break;
        }
        path = cut_corners(validator, path, settings.least_gain * before, budget)?;
        path = leave_out(validator, path, budget)?;
        if length(&path) > before * (1.0 - settings.least_change) {
            break;
        }
    }
    Ok(path)
}

/// Leaves out corners where the straight line past them is free, farthest first.
fn leave_out(validator: &mut impl MotionValidator, mut path: Path, budget: &Budget) -> Result<Path, Stop> {
    let mut at = 0;
    while at + 2 < path.len() {
        budget.check()?;
        if let Some(next) = (at + 2..path.len()).rev().find(|&j| validator.motion_free(&path[at], &path[j])) {
            path.drain(at + 1..next);
        }
        at += 1;
    }
    Ok(path)
}

/// Replaces each corner by a straight cut, as wide as is free.
fn cut_corners(validator: &mut impl MotionValidator, path: Path, least: f64, budget: &Budget) -> Result<Path, Stop> {
    let mut cut: Path = Vec::with_capacity(path.len() * 2);
    cut.push(path[0].clone());
    for i in 1..path.len() - 1 {
        budget.check()?;
        let (before, corner, after) = (&cut[cut.len() - 1], &path[i], &path[i + 1]);
        let mut done = None;
        for part in [0.5, 0.25, 0.125] {
            let p = between(corner, before, part);
            let q = between(corner, after, part);
            let gain = distance(&p, corner) + distance(corner, &q) - distance(&p, &q);
            if gain < least {
                break;
            }
            if validator.motion_free(&p, &q) {
                done = Some((p, q));
                break;
            }
        }
        match done {
            Some((p, q)) => cut.extend([p, q]),
            None => cut.push(corner.clone()),
        }
    }
    cut.push(path[path.len() - 1].clone());
    Ok(cut)
}
