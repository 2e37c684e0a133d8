//! The smoothest curve along a free path that is free as well.

use crate::{Corners, Curve, Path, Space, distance};

/// Off by less than this the curve counts as the path itself, metres: a fraction of the margins.
const SAME: f64 = 1e-4;

/// The curve with all corners rounded by a part of what goes, from 0 (as the path) to 1, whatever that touches.
pub fn rounded(path: &Path, part: f64) -> Curve {
    let path = distinct(path);
    let corners = Corners::of(&path);
    let widths: Vec<f64> = corners.widest().iter().map(|width| part * width).collect();
    Curve::through(&corners, &widths)
}

/// A path without waypoints in the same place as the one before.
fn distinct(path: &Path) -> Path {
    let mut path = path.clone();
    path.dedup_by(|a, b| distance(a, b) < 1e-9);
    path
}

/// Every corner is rounded by a part of what goes, as in [`rounded`], and less where the rounding would touch
/// something. Rounding one corner changes the curve within its width only, and is checked there
/// with all that was rounded before it.
pub fn smooth(space: &mut Space, path: &Path, part: f64) -> Curve {
    const PARTS: usize = 24;
    let path = distinct(path);
    let corners = Corners::of(&path);
    let widest = corners.widest();
    let mut widths = vec![0.0; path.len()];
    for i in 0..path.len() {
        widths[i] = part * widest[i];
        while widths[i] > 0.0 {
            let waypoint = &path[i];
            let off: Vec<f64> = waypoint.iter().zip(corners.off(i, widths[i])).map(|(q, o)| q + o).collect();
            if space.sweep(waypoint, &off) < SAME || space.rows_free(&corners.rows_about(i, &widths, PARTS)) {
                break;
            }
            widths[i] *= 0.5;
            if widths[i] < 0.02 * widest[i] {
                widths[i] = 0.0;
            }
        }
    }
    Curve::through(&corners, &widths)
}
