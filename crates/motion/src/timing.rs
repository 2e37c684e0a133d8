//! Time-optimal timing of a curve under velocity and acceleration limits, by reachability analysis
//! (Pham and Pham 2018): backwards the largest speeds from which one can still stop, forwards the
//! largest acceleration that stays below them. From rest to rest.
//!
//! Constraints hold at both ends of every grid interval; pieces are quadratic, so the bend is
//! constant in each. Rows are sampled evenly in time, which keeps second differences of the rows
//! within the acceleration limit, as those are averages of it.

use crate::curve::{Curve, Piece};
use crate::Posture;

/// Per joint: rad/s and rad/s² (m/s, m/s² for joints that slide).
#[derive(Clone, Debug)]
pub struct Limits {
    pub velocity: Vec<f64>,
    pub acceleration: Vec<f64>,
}

/// Rows in time; straight lines between them.
#[derive(Clone, Debug, Default)]
pub struct Timed {
    /// Seconds, from 0.
    pub times: Vec<f64>,
    pub positions: Vec<Posture>,
}

/// Longest grid interval, in the curve's parameter (about radians).
const GRID: f64 = 0.03;
/// Part of the limits that is used: rounding and sampling must not cross them.
const USED: f64 = 0.995;

/// Times a curve from rest to rest; rows at most `row` seconds apart. A curve of no length gives
/// no rows.
pub fn time_curve(curve: &Curve, limits: &Limits, row: f64) -> Timed {
    let mut timed = Timed::default();
    let mut bounds = vec![0];
    bounds.extend(&curve.stops);
    bounds.push(curve.pieces.len());
    for w in bounds.windows(2) {
        if w[0] < w[1] {
            append(&mut timed, &time_smooth(&curve.pieces[w[0]..w[1]], limits, row));
        }
    }
    timed
}

fn append(timed: &mut Timed, more: &Timed) {
    let offset = timed.times.last().copied().unwrap_or(0.0);
    let skip = usize::from(!timed.times.is_empty());
    timed.times.extend(more.times.iter().skip(skip).map(|t| t + offset));
    timed.positions.extend(more.positions.iter().skip(skip).cloned());
}

struct Interval<'a> {
    piece: &'a Piece,
    /// Parameter within the piece where it begins.
    from: f64,
    width: f64,
}

fn time_smooth(pieces: &[Piece], limits: &Limits, row: f64) -> Timed {
    let mut grid: Vec<Interval> = Vec::new();
    for piece in pieces {
        let count = ((piece.length / GRID).ceil() as usize).max(2);
        let width = piece.length / count as f64;
        grid.extend((0..count).map(|i| Interval { piece, from: width * i as f64, width }));
    }
    let n = grid.len();
    let constraints: Vec<Vec<Line>> = grid.iter().map(|i| acceleration_lines(i, limits)).collect();
    // Squared speed that the velocity limits allow at each grid point.
    let mut fastest = vec![f64::INFINITY; n + 1];
    for (i, interval) in grid.iter().enumerate() {
        for (end, t) in [(i, interval.from), (i + 1, interval.from + interval.width)] {
            for (slope, v) in interval.piece.slope_at(t).iter().zip(&limits.velocity) {
                if slope.abs() > 1e-12 {
                    fastest[end] = fastest[end].min((USED * v / slope).powi(2));
                }
            }
        }
    }
    // Backwards: from which squared speeds can the end be reached at rest?
    let mut most = vec![0.0; n + 1];
    for i in (0..n).rev() {
        most[i] = largest_speed(&constraints[i], fastest[i], grid[i].width, most[i + 1]);
    }
    // Forwards, as fast as that allows.
    let mut speed = vec![0.0; n + 1];
    for i in 0..n {
        let (low, high) = range(&constraints[i], speed[i], grid[i].width, most[i + 1]);
        let push = if low <= high { high } else { (low + high) / 2.0 };
        speed[i + 1] = (speed[i] + 2.0 * grid[i].width * push).clamp(0.0, most[i + 1]);
    }
    let mut clock = vec![0.0; n + 1];
    for i in 0..n {
        let sum = speed[i].max(0.0).sqrt() + speed[i + 1].max(0.0).sqrt();
        clock[i + 1] = clock[i] + 2.0 * grid[i].width / sum.max(1e-9);
    }
    sample(&grid, &speed, &clock, row)
}

fn sample(grid: &[Interval], speed: &[f64], clock: &[f64], row: f64) -> Timed {
    let total = clock[grid.len()];
    let count = ((total / row).ceil() as usize).max(1);
    let mut timed = Timed::default();
    let mut i = 0;
    for k in 0..=count {
        let time = total * k as f64 / count as f64;
        while i + 1 < grid.len() && clock[i + 1] <= time {
            i += 1;
        }
        let interval = &grid[i];
        let push = (speed[i + 1] - speed[i]) / (2.0 * interval.width);
        let t = time - clock[i];
        let along = (speed[i].sqrt() * t + push * t * t / 2.0).clamp(0.0, interval.width);
        let along = if k == count { interval.width } else { along };
        timed.times.push(time);
        timed.positions.push(interval.piece.at(interval.from + along));
    }
    timed
}

/// `a·u + b·x ≤ c`, with u the acceleration and x the squared speed along the curve.
#[derive(Clone, Copy)]
struct Line {
    a: f64,
    b: f64,
    c: f64,
}

fn acceleration_lines(interval: &Interval, limits: &Limits) -> Vec<Line> {
    let mut lines = Vec::with_capacity(4 * limits.acceleration.len());
    let at_start = interval.piece.slope_at(interval.from);
    let at_end = interval.piece.slope_at(interval.from + interval.width);
    for (j, most) in limits.acceleration.iter().enumerate() {
        let bend = 2.0 * interval.piece.bend[j];
        let c = USED * most;
        // q̈ = q' u + q'' x, at the start and, with x + 2·width·u, at the end.
        for (a, b) in [(at_start[j], bend), (at_end[j] + 2.0 * interval.width * bend, bend)] {
            if a.abs() > 1e-12 || b.abs() > 1e-12 {
                lines.push(Line { a, b, c });
                lines.push(Line { a: -a, b: -b, c });
            }
        }
    }
    lines
}

/// The accelerations allowed at squared speed `x`, so that the next one is within `0..=next`.
fn range(lines: &[Line], x: f64, width: f64, next: f64) -> (f64, f64) {
    let ((low, _, _), (high, _, _)) = active(lines, x, width, next);
    (low, high)
}

/// The highest lower and the lowest upper bound of u at `x`, each with its slope over x and offset.
#[allow(clippy::type_complexity)]
fn active(lines: &[Line], x: f64, width: f64, next: f64) -> ((f64, f64, f64), (f64, f64, f64)) {
    let mut low = (-x / (2.0 * width), -1.0 / (2.0 * width), 0.0);
    let mut high = ((next - x) / (2.0 * width), -1.0 / (2.0 * width), next / (2.0 * width));
    for l in lines {
        if l.a.abs() <= 1e-12 {
            continue;
        }
        let bound = (l.c - l.b * x) / l.a;
        if l.a > 0.0 && bound < high.0 {
            high = (bound, -l.b / l.a, l.c / l.a);
        } else if l.a < 0.0 && bound > low.0 {
            low = (bound, -l.b / l.a, l.c / l.a);
        }
    }
    (low, high)
}

/// The largest squared speed, at most `fastest`, that leaves an allowed acceleration. Bounds are
/// lines over x, so low − high is convex: Newton's method from the right ends after a few steps.
fn largest_speed(lines: &[Line], fastest: f64, width: f64, next: f64) -> f64 {
    let mut x = fastest;
    for l in lines {
        if l.a.abs() <= 1e-12 && l.b > 0.0 {
            x = x.min(l.c / l.b);
        }
    }
    if !x.is_finite() {
        x = 1e6;
    }
    for _ in 0..64 {
        let (low, high) = active(lines, x, width, next);
        if low.0 <= high.0 + 1e-12 {
            return x.max(0.0);
        }
        let slope = low.1 - high.1;
        if slope <= 0.0 {
            break;
        }
        x = (high.2 - low.2) / slope;
        if x <= 0.0 {
            break;
        }
    }
    0.0
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Curve;

    fn limits() -> Limits {
        Limits { velocity: vec![2.0, 3.0], acceleration: vec![8.0, 8.0] }
    }

    fn check(timed: &Timed, limits: &Limits) {
        let (mut before, mut last_dt) = (vec![0.0; 2], 0.0);
        for (w, t) in timed.positions.windows(2).zip(timed.times.windows(2)) {
            let dt = t[1] - t[0];
            assert!(dt > 0.0 && dt <= 0.02 + 1e-9);
            for j in 0..2 {
                let v = (w[1][j] - w[0][j]) / dt;
                assert!(v.abs() <= limits.velocity[j] + 1e-9, "velocity {v}");
                let a = (v - before[j]) / ((dt + last_dt) / 2.0);
                assert!(a.abs() <= limits.acceleration[j] + 1e-9, "acceleration {a}");
                before[j] = v;
            }
            last_dt = dt;
        }
        for j in 0..2 {
            assert!((before[j] / (last_dt / 2.0)).abs() <= limits.acceleration[j] + 1e-9);
        }
    }

    #[test]
    fn a_straight_line_takes_the_closed_form_time() {
        // One joint moves 1 rad: 0.25 s up to 2 rad/s, the same down, 0.25 s at 2 rad/s.
        let curve = Curve::through(&[vec![0.0, 0.0], vec![1.0, 0.0]], &[]);
        let timed = time_curve(&curve, &limits(), 0.01);
        let (v, a): (f64, f64) = (2.0 * USED, 8.0 * USED);
        let expected = 2.0 * v / a + (1.0 - v * v / a) / v;
        assert!((timed.times.last().unwrap() - expected).abs() < 0.01 * expected, "{:?}", timed.times.last());
        check(&timed, &limits());
    }

    #[test]
    fn limits_hold_on_random_paths() {
        for seed in 0..60 {
            let path: Vec<Posture> = (0..8)
                .map(|i| {
                    let t = (seed * 8 + i) as f64;
                    vec![2.0 * (t * 1.3).sin(), 1.5 * (t * 2.1).cos()]
                })
                .collect();
            let cut: Vec<f64> = (0..6).map(|i| if (seed + i) % 5 == 0 { 0.0 } else { 1.0 / (1 + i % 3) as f64 }).collect();
            let timed = time_curve(&Curve::through(&path, &cut), &limits(), 0.02);
            check(&timed, &limits());
            assert!(crate::distance(timed.positions.last().unwrap(), &path[7]) < 1e-9);
            assert!(crate::distance(&timed.positions[0], &path[0]) < 1e-12);
        }
    }

    #[test]
    fn dense_waypoints_are_followed_smoothly() {
        let path: Vec<Posture> = (0..=60).map(|i| vec![(i as f64 * 0.02).sin(), (i as f64 * 0.02).cos()]).collect();
        let timed = time_curve(&Curve::through(&path, &vec![1.0; 59]), &limits(), 0.01);
        check(&timed, &limits());
        assert!(*timed.times.last().unwrap() < 1.2, "{:?}", timed.times.last());
    }
}
