//! Shortcuts: the same path with fewer corners and less way.

use crate::{MotionValidator, Path, Posture, between, distance, length};
use clearway_plan::{Budget, Stop};
use rand::{Rng, RngExt};

/// Shortens a free path: first by leaving out corners, then by `attempts` random cuts between
/// points on its lines. The ends stay. The result is free where the input was.
pub fn shorten(
    space: &mut impl MotionValidator,
    path: Path,
    attempts: usize,
    random: &mut impl Rng,
    budget: &Budget,
) -> Result<Path, Stop> {
    let mut path = leave_out(space, path, budget)?;
    for _ in 0..attempts {
        budget.check()?;
        if path.len() < 3 {
            break;
        }
        let total = length(&path);
        let (mut a, mut b) = (random.random::<f64>() * total, random.random::<f64>() * total);
        if a > b {
            std::mem::swap(&mut a, &mut b);
        }
        let ((i, p), (j, q)) = (point_at(&path, a), point_at(&path, b));
        if i == j {
            continue;
        }
        let kept: f64 = distance(&p, &path[i + 1]) + length(&path[i + 1..=j]) + distance(&path[j], &q);
        // A cut that saves next to nothing is not worth its checks.
        if distance(&p, &q) > 0.98 * kept || !space.state_free(&p) || !space.motion_free(&p, &q) {
            continue;
        }
        let mut shorter: Path = path[..=i].to_vec();
        shorter.push(p);
        shorter.push(q);
        shorter.extend_from_slice(&path[j + 1..]);
        shorter.dedup_by(|a, b| distance(a, b) < 1e-9);
        path = shorter;
    }
    Ok(path)
}

/// Leaves out corners where the straight line past them is free, farthest first.
fn leave_out(space: &mut impl MotionValidator, path: Path, budget: &Budget) -> Result<Path, Stop> {
    let Some(first) = path.first() else { return Ok(path) };
    let mut short = vec![first.clone()];
    let mut at = 0;
    while at + 1 < path.len() {
        budget.check()?;
        let next = (at + 2..path.len()).rev().find(|&j| space.motion_free(&path[at], &path[j])).unwrap_or(at + 1);
        short.push(path[next].clone());
        at = next;
    }
    Ok(short)
}

/// The line and the posture at a distance along the path.
fn point_at(path: &[Posture], mut along: f64) -> (usize, Posture) {
    for (i, w) in path.windows(2).enumerate() {
        let d = distance(&w[0], &w[1]);
        if along <= d || i + 2 == path.len() {
            let t = if d > 0.0 { (along / d).min(1.0) } else { 0.0 };
            return (i, between(&w[0], &w[1], t));
        }
        along -= d;
    }
    (0, path[0].clone())
}
