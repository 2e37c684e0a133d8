//! Time laws: how far along its curve a motion is at a time.

use crate::reach::Profile;
use std::cell::Cell;

/// Position along a curve over time.
pub trait Law {
    /// Seconds.
    fn duration(&self) -> f64;
    /// Position at the start and at the end.
    fn ends(&self) -> (f64, f64);
    /// Position at a time, best asked in rising order.
    fn position(&self, time: f64) -> f64;
}

impl Law for Profile {
    fn duration(&self) -> f64 {
        Profile::duration(self)
    }

    fn ends(&self) -> (f64, f64) {
        Profile::ends(self)
    }

    fn position(&self, time: f64) -> f64 {
        self.at(time).0
    }
}

/// A profile's mean over a window of time: its acceleration is bounded, so this has bounded jerk.
/// Begins and ends half a window before and after.
pub struct Eased<'a> {
    pub profile: &'a Profile,
    /// Seconds.
    pub window: f64,
}

impl Law for Eased<'_> {
    fn duration(&self) -> f64 {
        self.profile.duration() + self.window
    }

    fn ends(&self) -> (f64, f64) {
        self.profile.ends()
    }

    fn position(&self, time: f64) -> f64 {
        (self.profile.at(time).1 - self.profile.at(time - self.window).1) / self.window
    }
}

/// A uniform cubic B-spline over τ, at rest at both ends.
#[derive(Clone, Debug)]
pub struct Spline {
    /// Seconds.
    pub step: f64,
    /// Control points; three are equal at either end.
    points: Vec<f64>,
}

impl Spline {
    /// What a law does, in so many steps: the same where that is a cubic.
    pub fn new(steps: usize, law: &impl Law) -> Self {
        let step = law.duration() / steps as f64;
        let (start, end) = law.ends();
        let at = |k: usize| law.position(k as f64 * step).clamp(start, end);
        let mut points = vec![start; 3];
        let (mut before, mut here) = (at(1), at(2));
        for k in 3..steps {
            let after = at(k);
            points.push(here - (before - 2.0 * here + after) / 6.0);
            (before, here) = (here, after);
        }
        points.extend([end; 3]);
        Self { step, points }
    }

    pub fn steps(&self) -> usize {
        self.points.len() - 3
    }

    /// Position, and its first two derivatives over τ, this far into a step (0 to 1).
    pub fn at(&self, step: usize, t: f64) -> (f64, f64, f64) {
        let [a, b, c, d] = [0, 1, 2, 3].map(|i| self.points[step + i]);
        let (u, h) = (1.0 - t, self.step);
        let near = |t: f64| 4.0 + t * t * (3.0 * t - 6.0);
        let position = (u * u * u * a + near(t) * b + near(u) * c + t * t * t * d) / 6.0;
        let first = (u * u * (b - a) + (1.0 + 2.0 * t * u) * (c - b) + t * t * (d - c)) / (2.0 * h);
        let second = (u * (a - 2.0 * b + c) + t * (b - 2.0 * c + d)) / (h * h);
        (position, first, second)
    }
}

/// A spline at another pace: x = (dτ/dt)² is linear in τ within every step.
#[derive(Clone, Debug)]
pub struct Paced {
    spline: Spline,
    /// dτ/dt at both ends of every step, and when each is reached.
    speeds: Vec<f64>,
    times: Vec<f64>,
    /// The step last asked about.
    last: Cell<usize>,
}

impl Paced {
    /// `x` at both ends of every step.
    pub fn new(spline: Spline, x: Vec<f64>) -> Self {
        let speeds: Vec<f64> = x.into_iter().map(f64::sqrt).collect();
        let mut times = vec![0.0];
        for w in speeds.windows(2) {
            times.push(times[times.len() - 1] + 2.0 * spline.step / (w[0] + w[1]));
        }
        Self { spline, speeds, times, last: Cell::new(0) }
    }

    /// The same pace, slower about the rows that are too fast: `excess`, evenly spaced in time, says by
    /// what factor each is. Slower by as much there, and less and less towards rows farther off.
    pub fn slowed(&self, excess: &[f64]) -> Self {
        const ABOUT: usize = 8;
        let rows = excess.len() - 1;
        let window = |k: usize| k.saturating_sub(ABOUT)..=(k + ABOUT).min(rows);
        let most: Vec<f64> = (0..=rows).map(|k| excess[window(k)].iter().copied().fold(1.0, f64::max)).collect();
        let mean = |k: usize| most[window(k)].iter().sum::<f64>() / window(k).count() as f64;
        let slower: Vec<f64> = (0..=rows).map(mean).collect();
        let at = |time: f64| {
            let row = time / self.duration() * rows as f64;
            let k = (row as usize).min(rows.saturating_sub(1));
            slower[k] + (slower[k + 1] - slower[k]) * (row - k as f64)
        };
        let x = self.speeds.iter().zip(&self.times).map(|(speed, time)| (speed / at(*time)).powi(2)).collect();
        Self::new(self.spline.clone(), x)
    }

    /// At a time, best asked in rising order: the step, and dτ/dt.
    pub fn pace(&self, time: f64) -> (usize, f64) {
        let i = self.step(time);
        let part = (time - self.times[i]) / (self.times[i + 1] - self.times[i]);
        (i, self.speeds[i] + part * (self.speeds[i + 1] - self.speeds[i]))
    }

    fn step(&self, time: f64) -> usize {
        let mut i = if self.times[self.last.get()] <= time { self.last.get() } else { 0 };
        while i + 2 < self.times.len() && self.times[i + 1] <= time {
            i += 1;
        }
        self.last.set(i);
        i
    }
}

impl Law for Paced {
    fn duration(&self) -> f64 {
        self.times[self.times.len() - 1]
    }

    fn ends(&self) -> (f64, f64) {
        (self.spline.points[0], self.spline.points[self.spline.points.len() - 1])
    }

    fn position(&self, time: f64) -> f64 {
        let i = self.step(time);
        let t = time - self.times[i];
        let push = (self.speeds[i + 1] - self.speeds[i]) / (self.times[i + 1] - self.times[i]);
        let part = t * (self.speeds[i] + t * push / 2.0) / self.spline.step;
        self.spline.at(i, part.clamp(0.0, 1.0)).0
    }
}
