//! Curves that can be driven with bounded jerk: straight lines whose corners are rounded so that
//! the second derivative is continuous.
//!
//! A path's slope jumps at its corners. Spread over a width, the jump becomes a bend that rises,
//! stays and falls (a trapezoid with the jump as its area): `q'' = Σ jumpᵢ · trapezoidᵢ`. That is
//! the cubic B-spline idea with a width of its own for every corner; widths may overlap, so the
//! dense waypoints of a straight hand motion give a bend that does not return to zero at each.
//! Beyond a corner's width the curve is as it would be without it. Parameter: length along the
//! straight lines, from 0.

use crate::{Posture, distance};
use std::ops::Range;

/// Slopes that differ by less are the same.
const STRAIGHT: f64 = 1e-9;

/// The waypoints of a path with the length up to each, and the slopes between them.
#[derive(Clone, Debug)]
pub struct Corners<'a> {
    path: &'a [Posture],
    /// Length of the path up to each waypoint.
    along: Vec<f64>,
    slopes: Vec<Posture>,
}

impl<'a> Corners<'a> {
    /// `path` must not repeat a waypoint.
    pub fn of(path: &'a [Posture]) -> Self {
        let mut along = vec![0.0];
        let mut slopes = Vec::with_capacity(path.len());
        for w in path.windows(2) {
            let far = distance(&w[0], &w[1]);
            along.push(along[along.len() - 1] + far);
            slopes.push(w[0].iter().zip(&w[1]).map(|(a, b)| (b - a) / far).collect());
        }
        Self { path, along, slopes }
    }

    /// Of inner waypoint `i` (1 to n − 2): by how much the slope jumps there.
    fn jump(&self, i: usize) -> impl Iterator<Item = f64> {
        self.slopes[i - 1].iter().zip(&self.slopes[i]).map(|(u, v)| v - u)
    }

    /// The widest that each corner (one per waypoint, 0 at both ends) may be rounded to either
    /// side: three quarters of the way to the next corner of its size or to the path's end. Equal
    /// corners equally far apart then add up to an even bend. Farther if that is not noticed.
    pub fn widest(&self) -> Vec<f64> {
        const REACH: f64 = 0.75;
        let n = self.path.len();
        let sizes: Vec<f64> = (0..n)
            .map(|i| if i == 0 || i + 1 >= n { f64::INFINITY } else { self.jump(i).map(|d| d * d).sum::<f64>().sqrt() })
            .collect();
        (0..n)
            .map(|i| {
                if sizes[i] < STRAIGHT || sizes[i].is_infinite() {
                    return 0.0;
                }
                let reach = |others: &mut dyn Iterator<Item = usize>| {
                    let mut passed = 0.0;
                    for k in others {
                        passed += sizes[k];
                        if passed > 0.5 * sizes[i] {
                            return (self.along[k] - self.along[i]).abs();
                        }
                    }
                    0.0
                };
                let apart = reach(&mut (0..i).rev()).min(reach(&mut (i + 1..n)));
                let end = self.along[i].min(self.along[n - 1] - self.along[i]);
                (REACH * apart).max(self.unnoticed(i, &sizes).min(REACH * end))
            })
            .collect()
    }

    /// How wide a corner may be, over its neighbours too, for all of them together to take the curve
    /// hardly off its path: evens out what is not exact about dense waypoints.
    fn unnoticed(&self, i: usize, sizes: &[f64]) -> f64 {
        const OFF: f64 = 1e-4;
        let (mut low, mut high, mut turn) = (i, i, sizes[i]);
        loop {
            let width = OFF / (turn * Trapezoid(1.0).twice(0.0));
            let (before, after) = (self.along[i] - self.along[low - 1], self.along[high + 1] - self.along[i]);
            if width <= before.min(after) {
                return width;
            }
            if before < after {
                low -= 1;
                turn += sizes[low];
            } else {
                high += 1;
                turn += sizes[high];
            }
            if turn.is_infinite() {
                return before.min(after);
            }
        }
    }

    /// How far rounding corner `i` to `width` takes the curve off its waypoint: joint by joint.
    pub fn off(&self, i: usize, width: f64) -> Posture {
        self.jump(i).map(|d| d * Trapezoid(width).twice(0.0)).collect()
    }

    /// The rounded path from `width` before waypoint `i` to as much after it, as rows.
    pub fn rows_about(&self, i: usize, widths: &[f64], parts: usize) -> Vec<Posture> {
        let (from, to) = (self.along[i] - widths[i], self.along[i] + widths[i]);
        let mut at: Vec<f64> = (0..=parts).map(|k| from + (to - from) * k as f64 / parts as f64).collect();
        at.extend(self.along.iter().filter(|s| (from..to).contains(*s)));
        at.sort_by(f64::total_cmp);
        let joints = self.path[0].len();
        at.iter()
            .map(|&s| {
                let mut row = vec![0.0; 4 * joints];
                self.derivatives(s, s, widths, &mut row);
                row.truncate(joints);
                row
            })
            .collect()
    }

    /// Position and the first three derivatives at `s`, one row each; the third as it is at
    /// `inside`, where it jumps.
    fn derivatives(&self, s: f64, inside: f64, widths: &[f64], out: &mut [f64]) {
        let joints = self.path[0].len();
        let last = self.slopes.len() - 1;
        let line = self.along.partition_point(|a| *a <= inside).saturating_sub(1).min(last);
        let (position, rest) = out.split_at_mut(joints);
        let (slope, rest) = rest.split_at_mut(joints);
        let (bend, twist) = rest.split_at_mut(joints);
        for j in 0..joints {
            position[j] = self.path[line][j] + self.slopes[line][j] * (s - self.along[line]);
            slope[j] = self.slopes[line][j];
            (bend[j], twist[j]) = (0.0, 0.0);
        }
        for i in 1..=last {
            let (y, middle) = (s - self.along[i], inside - self.along[i]);
            if widths[i] <= 0.0 || middle.abs() >= widths[i] {
                continue;
            }
            let shape = Trapezoid(widths[i]);
            // Relative to the line before the corner, or to the one after it.
            let (mut off, mut turned) = (shape.twice(y), shape.once(y));
            if middle >= 0.0 {
                (off, turned) = (off - y, turned - 1.0);
            }
            let (height, rise) = (shape.height(y), shape.rise(middle));
            for (j, jump) in self.jump(i).enumerate() {
                position[j] += jump * off;
                slope[j] += jump * turned;
                bend[j] += jump * height;
                twist[j] += jump * rise;
            }
        }
    }
}

/// A trapezoid of area 1 about 0, this wide to either side, level on its middle third.
#[derive(Clone, Copy)]
struct Trapezoid(f64);

impl Trapezoid {
    fn height(self, y: f64) -> f64 {
        let w = self.0;
        (9.0 / (8.0 * w * w) * (w - y.abs()).max(0.0)).min(0.75 / w)
    }

    /// Its derivative, away from where that jumps.
    fn rise(self, y: f64) -> f64 {
        let w = self.0;
        if y.abs() * 3.0 < w || y.abs() > w { 0.0 } else { -y.signum() * 9.0 / (8.0 * w * w) }
    }

    /// Its integral from the left: 0 to 1.
    fn once(self, y: f64) -> f64 {
        let (w, z) = (self.0, y.abs());
        let tail = if z * 3.0 < w { 0.5 - 0.75 * z / w } else { 9.0 / 16.0 * ((w - z).max(0.0) / w).powi(2) };
        if y < 0.0 { tail } else { 1.0 - tail }
    }

    /// The integral of that: from 0 on the left to `y` on the right.
    fn twice(self, y: f64) -> f64 {
        let (w, z) = (self.0, y.abs());
        let tail = if z * 3.0 < w {
            w / 18.0 + (w / 3.0 - z) / 2.0 - 0.375 * (w / 9.0 - z * z / w)
        } else {
            3.0 / 16.0 * (w - z).max(0.0).powi(3) / (w * w)
        };
        tail + y.max(0.0)
    }
}

/// Cubic pieces in a row, flat in memory. Where two meet at an angle (a corner that could not be
/// rounded) the motion has to stop.
#[derive(Clone, Debug, Default)]
pub struct Curve {
    joints: usize,
    /// Where each piece begins, and where the last ends.
    knots: Vec<f64>,
    /// Of each piece: the position and its first three derivatives at its beginning, a row each.
    pieces: Vec<f64>,
    /// The pieces after each stop.
    stops: Vec<usize>,
    end: Posture,
}

impl Curve {
    /// Rounds the corner at waypoint *i* by `widths[i]` to either side; 0 leaves a stop there. No
    /// width may reach beyond the path.
    pub fn through(corners: &Corners, widths: &[f64]) -> Curve {
        let (Some(first), Some(end)) = (corners.path.first(), corners.path.last()) else { return Curve::default() };
        let mut curve = Curve { joints: first.len(), end: end.clone(), ..Curve::default() };
        let length = corners.along[corners.along.len() - 1];
        let (mut knots, mut stops) = (vec![0.0, length], Vec::new());
        for i in 1..corners.slopes.len() {
            let (s, w) = (corners.along[i], widths[i]);
            if w > 0.0 {
                knots.extend([s - w, s - w / 3.0, s + w / 3.0, s + w]);
            } else {
                knots.push(s);
                stops.extend(corners.jump(i).any(|d| d.abs() > STRAIGHT).then_some(s));
            }
        }
        knots.sort_by(f64::total_cmp);
        let tiny = 1e-12 * length;
        let mut stops = stops.into_iter().peekable();
        let mut row = vec![0.0; 4 * curve.joints];
        for w in knots.windows(2).filter(|w| w[1] - w[0] > tiny) {
            // A piece begins where the one before it ended, whatever was left out between them.
            let from = curve.knots.last().copied().unwrap_or(0.0);
            while stops.next_if(|s| *s <= from + 2.0 * tiny).is_some() {
                curve.stops.push(curve.knots.len().saturating_sub(1));
            }
            corners.derivatives(from, (from + w[1]) / 2.0, widths, &mut row);
            curve.pieces.extend(&row);
            if curve.knots.is_empty() {
                curve.knots.push(0.0);
            }
            curve.knots.push(w[1]);
        }
        curve
    }

    pub fn joints(&self) -> usize {
        self.joints
    }

    /// Where the pieces begin, and where the last ends.
    pub fn knots(&self) -> &[f64] {
        &self.knots
    }

    /// The position and its first three derivatives at a piece's beginning, a row of joints each.
    pub fn piece(&self, piece: usize) -> &[f64] {
        &self.pieces[4 * self.joints * piece..][..4 * self.joints]
    }

    /// Runs of pieces between stops.
    pub fn parts(&self) -> Vec<Range<usize>> {
        let mut bounds = vec![0];
        bounds.extend(&self.stops);
        bounds.push(self.knots.len().saturating_sub(1));
        bounds.windows(2).map(|w| w[0]..w[1]).filter(|r| !r.is_empty()).collect()
    }

    /// The piece that holds `s`, looking from piece `from` on.
    pub(crate) fn piece_at(&self, s: f64, from: usize) -> usize {
        let last = self.knots.len().saturating_sub(2);
        let mut piece = from;
        while piece < last && self.knots[piece + 1] <= s {
            piece += 1;
        }
        piece
    }

    /// Adds the position at `s` of a piece: a value per joint.
    pub(crate) fn position(&self, piece: usize, s: f64, out: &mut Vec<f64>) {
        let t = s - self.knots[piece];
        let (c, n) = (self.piece(piece), self.joints);
        out.extend((0..n).map(|j| c[j] + t * (c[n + j] + t * (c[2 * n + j] / 2.0 + t * c[3 * n + j] / 6.0))));
    }

    /// The first two derivatives at `s` of a piece.
    pub(crate) fn slope_and_bend(&self, piece: usize, s: f64, slope: &mut [f64], bend: &mut [f64]) {
        let t = s - self.knots[piece];
        let (c, n) = (self.piece(piece), self.joints);
        for j in 0..n {
            slope[j] = c[n + j] + t * (c[2 * n + j] + t * c[3 * n + j] / 2.0);
            bend[j] = c[2 * n + j] + t * c[3 * n + j];
        }
    }

    /// The posture that the curve ends at.
    pub fn end(&self) -> &[f64] {
        &self.end
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn position(curve: &Curve, piece: usize, s: f64) -> Posture {
        let mut position = Posture::new();
        curve.position(piece, s, &mut position);
        position
    }

    fn end_of(curve: &Curve, piece: usize) -> [Vec<f64>; 3] {
        let (n, s) = (curve.joints, curve.knots[piece + 1]);
        let (mut slope, mut bend) = (vec![0.0; n], vec![0.0; n]);
        curve.slope_and_bend(piece, s, &mut slope, &mut bend);
        [position(curve, piece, s), slope, bend]
    }

    fn zigzag() -> Vec<Posture> {
        vec![vec![0.0, 0.0], vec![1.0, 0.0], vec![1.0, 2.0], vec![0.5, 2.5], vec![0.5, 2.6], vec![0.6, 2.7]]
    }

    #[test]
    fn joins_are_twice_smooth_and_ends_stay() {
        let path = zigzag();
        let corners = Corners::of(&path);
        let curve = Curve::through(&corners, &corners.widest());
        assert_eq!(curve.parts().len(), 1);
        for piece in 0..curve.knots.len() - 2 {
            for (end, next) in end_of(&curve, piece).iter().zip(curve.piece(piece + 1).chunks(2)) {
                assert!(distance(end, next) < 1e-9, "{end:?} {next:?}");
            }
        }
        let [end, slope, bend] = end_of(&curve, curve.knots.len() - 2);
        assert!(distance(&end, &path[5]) < 1e-12 && distance(&curve.piece(0)[..2], &path[0]) < 1e-12);
        assert!(distance(&slope, &corners.slopes[4]) < 1e-12 && distance(&bend, &[0.0; 2]) < 1e-9);
    }

    #[test]
    fn rows_are_those_of_the_pieces() {
        let path = zigzag();
        let corners = Corners::of(&path);
        let widths = corners.widest();
        let curve = Curve::through(&corners, &widths);
        let rows = corners.rows_about(2, &widths, 40);
        let fine: Vec<Posture> = (0..=4000)
            .map(|i| i as f64 / 4000.0 * corners.along[5])
            .map(|s| position(&curve, curve.piece_at(s, 0), s))
            .collect();
        let off = |row: &Posture| fine.iter().map(|f| distance(f, row)).fold(f64::INFINITY, f64::min);
        assert!(rows.len() > 40 && rows.iter().all(|row| off(row) < 1e-3));
    }

    #[test]
    fn a_corner_left_as_it_is_is_a_stop_and_a_straight_one_is_none() {
        let path = vec![vec![0.0, 0.0], vec![0.5, 0.0], vec![1.0, 0.0], vec![1.0, 2.0]];
        let curve = Curve::through(&Corners::of(&path), &[0.0; 4]);
        assert_eq!((curve.parts(), curve.end()), (vec![0..2, 2..3], &[1.0, 2.0][..]));
    }

    #[test]
    fn an_even_arc_gets_an_even_bend() {
        let path: Vec<Posture> = (0..=60).map(|i| vec![(i as f64 * 0.02).sin(), (i as f64 * 0.02).cos()]).collect();
        let corners = Corners::of(&path);
        let curve = Curve::through(&corners, &corners.widest());
        for piece in 10..curve.knots.len() - 11 {
            let bend = &curve.piece(piece)[4..6];
            assert!((bend[0].hypot(bend[1]) - 1.0).abs() < 0.01, "{bend:?}");
        }
    }

    #[test]
    fn there_and_back_turns_without_a_stop() {
        let path = vec![vec![0.0], vec![1.0], vec![0.0]];
        let corners = Corners::of(&path);
        let curve = Curve::through(&corners, &corners.widest());
        assert_eq!(curve.parts().len(), 1);
        assert!(position(&curve, curve.piece_at(1.0, 0), 1.0)[0] < 0.9);
    }
}
