//! Even rows of a motion along a curve, as slow as their differences need them to be.

use crate::differences::slowdowns;
use crate::law::Law;
use crate::{Curve, Limits, Timed};
use std::ops::Range;

/// What rows are made of.
pub struct RowMaker<'a> {
    pub curve: &'a Curve,
    /// The pieces moved along.
    pub part: Range<usize>,
    pub limits: &'a Limits,
    /// Rows are at most this far apart, seconds.
    pub row: f64,
}

/// Rows, not slowed down yet.
pub struct Sampled {
    duration: f64,
    /// A value per joint for each row.
    positions: Vec<f64>,
    /// Row by row: the factor by which times about it are too short.
    pub excess: Vec<f64>,
}

impl Sampled {
    /// By how much all of it has to be slowed down: 1 if not at all.
    pub fn slowdown(&self) -> f64 {
        self.excess.iter().copied().fold(1.0, f64::max)
    }

    pub fn slowed_duration(&self) -> f64 {
        self.duration * self.slowdown()
    }
}

fn even(duration: f64, count: usize) -> Vec<f64> {
    (0..=count).map(|k| duration * k as f64 / count as f64).collect()
}

impl RowMaker<'_> {
    /// Steps from row to row that a motion needs.
    pub fn count(&self, duration: f64) -> usize {
        // Not one more for rounding.
        (duration / self.row - 1e-9).ceil().max(1.0) as usize
    }

    pub fn sample(&self, count: usize, law: &impl Law) -> Sampled {
        let (knots, duration) = (self.curve.knots(), law.duration());
        let (start, end) = (knots[self.part.start], knots[self.part.end]);
        let mut piece = self.part.start;
        let mut positions = Vec::with_capacity((count + 1) * self.curve.joints());
        for k in 0..=count {
            let s = match k {
                0 => start,
                k if k == count => end,
                k => law.position(duration * k as f64 / count as f64).clamp(start, end),
            };
            piece = self.curve.piece_at(s, piece).min(self.part.end - 1);
            self.curve.position(piece, s, &mut positions);
        }
        let excess = slowdowns(&even(duration, count), &positions, self.limits);
        Sampled { duration, positions, excess }
    }

    /// Rows slowed down as a whole until they keep to all limits. Slower rows are farther apart:
    /// then there have to be more.
    pub fn slowed(&self, mut found: Sampled, law: &impl Law) -> Timed {
        loop {
            let count = found.excess.len() - 1;
            // Rounding must not cross a limit.
            let duration = found.slowed_duration() * (1.0 + 1e-9);
            let needed = self.count(duration);
            if needed <= count {
                let positions = found.positions.chunks_exact(self.curve.joints()).map(<[f64]>::to_vec).collect();
                return Timed { times: even(duration, count), positions };
            }
            found = self.sample(needed, law);
        }
    }
}
