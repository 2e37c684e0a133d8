//! The time-optimal speed along a curve under velocity and acceleration limits, by reachability
//! analysis (Pham and Pham 2018): backwards the largest speeds from which one can still stop,
//! forwards the largest acceleration that stays below them. From rest to rest.
//!
//! Along the curve, x is the squared speed and u the acceleration; u is constant between grid
//! points, and constraints hold at both ends of every interval.

use crate::Curve;
use std::cell::Cell;
use std::ops::Range;

/// Longest grid interval, in the curve's parameter (about radians), and most that the slope turns in one.
const LONGEST: f64 = 0.03;
const TURN: f64 = 0.1;

/// Position along a curve over time: constant acceleration between grid points.
#[derive(Clone, Debug, Default)]
pub struct Profile {
    /// At each grid point: time from 0, position, its integral over time, speed.
    times: Vec<f64>,
    positions: Vec<f64>,
    integrals: Vec<f64>,
    speeds: Vec<f64>,
    /// The interval last asked about.
    last: Cell<usize>,
}

impl Profile {
    pub fn duration(&self) -> f64 {
        self.times.last().copied().unwrap_or(0.0)
    }

    /// Where it starts and ends.
    pub fn ends(&self) -> (f64, f64) {
        (self.positions[0], self.positions[self.positions.len() - 1])
    }

    /// Position and its integral at a time, best asked in rising order; at rest before and after.
    pub fn at(&self, time: f64) -> (f64, f64) {
        let last = self.times.len() - 1;
        if time <= 0.0 {
            return (self.positions[0], self.positions[0] * time);
        }
        if time >= self.times[last] {
            let end = self.positions[last];
            return (end, self.integrals[last] + end * (time - self.times[last]));
        }
        let mut i = self.last.get();
        while self.times[i] > time {
            i -= 1;
        }
        while i + 1 < last && self.times[i + 1] <= time {
            i += 1;
        }
        self.last.set(i);
        let (t, whole) = (time - self.times[i], self.times[i + 1] - self.times[i]);
        let push = (self.speeds[i + 1] - self.speeds[i]) / whole;
        let position = self.positions[i] + t * (self.speeds[i] + t * push / 2.0);
        let integral = self.integrals[i] + t * (self.positions[i] + t * (self.speeds[i] / 2.0 + t * push / 6.0));
        (position, integral)
    }
}

/// `|u − slope·x| ≤ half`: what one joint's acceleration limit allows at one grid point.
#[derive(Clone, Copy)]
struct Band {
    slope: f64,
    half: f64,
}

/// The fastest profile over a run of pieces, limits per joint.
pub fn fastest(curve: &Curve, part: Range<usize>, velocity: &[f64], acceleration: &[f64]) -> Profile {
    let n = curve.joints();
    let grid = grid(curve, part);
    let count = grid.len() - 1;
    let (mut slopes, mut bends) = (vec![0.0; n * grid.len()], vec![0.0; n * grid.len()]);
    for (i, (s, piece)) in grid.iter().enumerate() {
        let row = i * n..(i + 1) * n;
        curve.slope_and_bend(*piece, *s, &mut slopes[row.clone()], &mut bends[row]);
    }
    // Squared speed that velocity limits allow, and bends alone.
    let mut cap: Vec<f64> = vec![1e6; count + 1];
    let mut bands = Vec::with_capacity(2 * n * count);
    for i in 0..=count {
        for j in 0..n {
            let (slope, bend) = (slopes[i * n + j], bends[i * n + j]);
            cap[i] = cap[i].min((velocity[j] / slope).powi(2));
            if slope.abs() < TINY {
                cap[i] = cap[i].min(acceleration[j] / bend.abs());
            }
        }
    }
    for i in 0..count {
        let width = grid[i + 1].0 - grid[i].0;
        for j in 0..n {
            let (here, next) = (i * n + j, (i + 1) * n + j);
            // q̈ = q' u + q'' x at the start, and at the end with x + 2·width·u.
            for (a, b) in [(slopes[here], bends[here]), (slopes[next] + 2.0 * width * bends[next], bends[next])] {
                if a.abs() > TINY {
                    bands.push(Band { slope: -b / a, half: acceleration[j] / a.abs() });
                } else {
                    bands.push(Band { slope: 0.0, half: f64::INFINITY });
                }
            }
        }
    }
    let bands = |i: usize| &bands[2 * n * i..2 * n * (i + 1)];
    let width = |i: usize| grid[i + 1].0 - grid[i].0;
    // Backwards: from which squared speeds can the end be reached at rest? Never from none at all.
    let mut most = vec![0.0; count + 1];
    for i in (1..count).rev() {
        most[i] = largest(bands(i), cap[i], width(i), most[i + 1]).max(1e-6 * cap[i]);
    }
    // Forwards, as fast as that allows.
    let mut speed = vec![0.0; count + 1];
    for i in 0..count {
        let (low, high) = range(bands(i), speed[i], width(i), most[i + 1]);
        let push = if low.at <= high.at { high.at } else { (low.at + high.at) / 2.0 };
        speed[i + 1] = (speed[i] + 2.0 * width(i) * push).clamp(1e-6 * most[i + 1], most[i + 1]);
    }
    let mut profile = Profile {
        times: vec![0.0],
        positions: grid.iter().map(|g| g.0).collect(),
        integrals: vec![0.0],
        speeds: speed.iter().map(|x| x.sqrt()).collect(),
        last: Cell::new(0),
    };
    for i in 0..count {
        let (from, to) = (profile.speeds[i], profile.speeds[i + 1]);
        let t = 2.0 * width(i) / (from + to);
        profile.times.push(profile.times[i] + t);
        profile.integrals.push(profile.integrals[i] + t * (profile.positions[i] + t * (from / 3.0 + to / 6.0)));
    }
    profile
}

/// A slope, or a speed, that is none.
const TINY: f64 = 1e-12;

/// Grid points with the piece that each is on: none in straight stretches but every [`LONGEST`],
/// more where the curve turns.
fn grid(curve: &Curve, part: Range<usize>) -> Vec<(f64, usize)> {
    let (knots, n) = (curve.knots(), curve.joints());
    let (start, end) = (knots[part.start], knots[part.end]);
    // A short curve gets a few points as well.
    let longest = LONGEST.min((end - start) / 16.0);
    let mut grid = vec![(start, part.start)];
    let (mut length, mut turn) = (0.0, 0.0);
    for piece in part {
        let (from, to) = (knots[piece], knots[piece + 1]);
        let (c, wide) = (curve.piece(piece), to - from);
        let bend = |t: f64| (0..n).map(|j| (c[2 * n + j] + t * c[3 * n + j]).powi(2)).sum::<f64>().sqrt();
        let turned = wide * (bend(0.0) + bend(wide)) / 2.0;
        length += wide / longest;
        turn += turned / TURN;
        let parts = f64::max(length, turn);
        if parts < 0.5 && to < end {
            continue;
        }
        let parts = parts.ceil().max(1.0);
        grid.extend((1..=parts as usize).map(|i| (from + wide * i as f64 / parts, piece)));
        (length, turn) = (0.0, 0.0);
    }
    grid
}

/// A bound of u at some x: its value there, and as a line over x.
#[derive(Clone, Copy)]
struct Bound {
    at: f64,
    slope: f64,
    offset: f64,
}

/// The highest lower and the lowest upper bound of u at `x`, so that the next squared speed is
/// within `0..=next`.
fn range(bands: &[Band], x: f64, width: f64, next: f64) -> (Bound, Bound) {
    let steep = -1.0 / (2.0 * width);
    let mut low = Bound { at: x * steep, slope: steep, offset: 0.0 };
    let mut high = Bound { at: (x - next) * steep, slope: steep, offset: -next * steep };
    for band in bands {
        let middle = band.slope * x;
        if middle + band.half < high.at {
            high = Bound { at: middle + band.half, slope: band.slope, offset: band.half };
        }
        if middle - band.half > low.at {
            low = Bound { at: middle - band.half, slope: band.slope, offset: -band.half };
        }
    }
    (low, high)
}

/// The largest squared speed, at most `cap`, that leaves an allowed acceleration. Bounds are lines
/// over x, so low − high is convex: Newton's method from the right ends after a few steps.
fn largest(bands: &[Band], cap: f64, width: f64, next: f64) -> f64 {
    let mut x = cap;
    for _ in 0..64 {
        let (low, high) = range(bands, x, width, next);
        let steeper = low.slope - high.slope;
        if low.at <= high.at || steeper <= 0.0 {
            break;
        }
        let better = ((high.offset - low.offset) / steeper).max(0.0);
        if better >= x * (1.0 - 1e-12) {
            break;
        }
        x = better;
    }
    x
}
