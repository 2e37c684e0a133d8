//! A path of straight lines as a trajectory whose rows are free: the one place where paths of the
//! sphere space meet curves and timing.

use crate::{Corners, Curve, Limits, MotionValidator, Path, SphereSpace, Timed, distance, time_curve};
use clearway_plan::{Budget, Stop};

/// Longest time between rows, seconds.
const ROW: f64 = 0.02;

/// Times a free path from rest to rest. Corners are rounded as widely as leaves the lines between
/// the rows free; a corner that cannot be rounded at all is stopped at.
pub fn time_path(space: &mut SphereSpace, path: &Path, limits: &Limits, budget: &Budget) -> Result<Timed, Stop> {
    let mut path = path.clone();
    path.dedup_by(|a, b| distance(a, b) < 1e-9);
    if path.len() < 2 {
        return Ok(Timed { times: vec![0.0; path.len()], positions: path });
    }
    let corners = Corners::of(&path);
    let widest = corners.widest();
    let mut widths = widest.clone();
    loop {
        budget.check()?;
        let timed = time_curve(&Curve::through(&corners, &widths), limits, ROW);
        let mut narrowed = false;
        for rows in timed.positions.windows(2) {
            if !space.motion_free(&rows[0], &rows[1]) {
                narrowed |= narrow(&path, &rows[0], &widest, &mut widths);
            }
        }
        if !narrowed {
            return Ok(timed);
        }
    }
}

/// Narrows the rounded corner nearest to a row; false when none is rounded, so that the row lies on
/// the path itself.
fn narrow(path: &Path, row: &[f64], widest: &[f64], widths: &mut [f64]) -> bool {
    let apart = |i: &usize| distance(&path[*i], row);
    let rounded = (0..path.len()).filter(|&i| widths[i] > 0.0);
    let Some(nearest) = rounded.min_by(|a, b| apart(a).total_cmp(&apart(b))) else { return false };
    widths[nearest] = if widths[nearest] > 0.02 * widest[nearest] { widths[nearest] * 0.5 } else { 0.0 };
    true
}
