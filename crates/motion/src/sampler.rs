//! Where samples come from.

use crate::{MotionValidator, Posture};
use rand::{Rng, RngExt};

/// Draws configurations.
pub trait Sampler {
    fn sample(&mut self, q: &mut [f64]);
}

/// Halton's sequence: evenly spread, the same every time.
#[derive(Clone, Debug)]
pub struct Halton {
    joints: Vec<Radical>,
    /// Boxes of configurations, by joint; samples are drawn from each in turn.
    boxes: Vec<Vec<(f64, f64)>>,
    turn: usize,
}

/// One joint's counter in the base of a prime, and its digits mirrored at the point.
#[derive(Clone, Debug)]
struct Radical {
    base: u32,
    digits: [u32; DIGITS],
    value: f64,
}

/// Enough for 3²⁰ samples.
const DIGITS: usize = 20;
const PRIMES: [u32; 32] = [
    3, 5, 7, 11, 13, 17, 19, 23, 29, 31, 37, 41, 43, 47, 53, 59, 61, 67, 71, 73, 79, 83, 89, 97, 101, 103, 107, 109,
    113, 127, 131, 137,
];

impl Halton {
    /// Over all the joints' ranges. `skip`: where in the sequence to begin; another value is another
    /// attempt.
    pub fn new(validator: &impl MotionValidator, skip: u32) -> Self {
        let radical = |base: u32| {
            let (mut digits, mut left, mut weight, mut value) = ([0; DIGITS], skip, 1.0, 0.0);
            for digit in &mut digits {
                *digit = left % base;
                left /= base;
                weight /= f64::from(base);
                value += f64::from(*digit) * weight;
            }
            Radical { base, digits, value }
        };
        let ranges = ranges(validator);
        Self {
            joints: ranges.iter().zip(PRIMES).map(|(_, base)| radical(base)).collect(),
            boxes: vec![ranges],
            turn: 0,
        }
    }

    /// Every other sample from about the ends of the motion, where the narrow passages mostly are and
    /// the short ways, too.
    pub fn near_ends(validator: &impl MotionValidator, skip: u32, start: &[f64], goals: &[Posture]) -> Self {
        let mut halton = Self::new(validator, skip);
        halton.boxes.push(about_ends(validator, start, goals));
        halton
    }
}

/// By joint: where samples are drawn.
fn ranges(validator: &impl MotionValidator) -> Vec<(f64, f64)> {
    (0..validator.lower().len()).map(|j| validator.sampled_range(j)).collect()
}

/// The box of a motion's ends, a little wider.
fn about_ends(validator: &impl MotionValidator, start: &[f64], goals: &[Posture]) -> Vec<(f64, f64)> {
    /// Radians or metres; less finds shorter ways, but no way round.
    const WIDER: f64 = 1.0;
    let about = |(j, (low, high)): (usize, (f64, f64))| {
        let ends = || goals.iter().map(Vec::as_slice).chain([start]).map(|q| q[j]);
        let (least, most) = (ends().fold(f64::INFINITY, f64::min), ends().fold(f64::NEG_INFINITY, f64::max));
        ((least - WIDER).max(low), (most + WIDER).min(high))
    };
    ranges(validator).into_iter().enumerate().map(about).collect()
}

impl Radical {
    fn count(&mut self) {
        let mut weight = 1.0;
        for digit in &mut self.digits {
            weight /= f64::from(self.base);
            *digit += 1;
            if *digit < self.base {
                self.value += weight;
                return;
            }
            // Carried on to the next digit.
            self.value -= f64::from(self.base - 1) * weight;
            *digit = 0;
        }
    }
}

impl Sampler for Halton {
    fn sample(&mut self, q: &mut [f64]) {
        let within = &self.boxes[self.turn];
        self.turn = (self.turn + 1) % self.boxes.len();
        for ((q, joint), (low, high)) in q.iter_mut().zip(&mut self.joints).zip(within) {
            joint.count();
            *q = low + (high - low) * joint.value;
        }
    }
}

/// Part of the samples taken from guides, where there are any.
const GUIDED: f64 = 0.8;

/// Random samples, most of them near the ends of the motion or from among guides.
pub struct NearEnds<'a, R> {
    ranges: Vec<(f64, f64)>,
    neighbourhood: Vec<(f64, f64)>,
    guides: &'a [Posture],
    /// Part of the samples drawn near the ends rather than from all configurations.
    near: f64,
    random: &'a mut R,
}

impl<'a, R: Rng> NearEnds<'a, R> {
    pub fn new(
        validator: &impl MotionValidator,
        start: &[f64],
        goals: &[Posture],
        guides: &'a [Posture],
        near: f64,
        random: &'a mut R,
    ) -> Self {
        let (ranges, neighbourhood) = (ranges(validator), about_ends(validator, start, goals));
        Self { ranges, neighbourhood, guides, near, random }
    }
}

impl<R: Rng> Sampler for NearEnds<'_, R> {
    fn sample(&mut self, q: &mut [f64]) {
        if !self.guides.is_empty() && self.random.random::<f64>() < GUIDED {
            q.copy_from_slice(&self.guides[self.random.random_range(0..self.guides.len())]);
            return;
        }
        let ranges = if self.random.random::<f64>() < self.near { &self.neighbourhood } else { &self.ranges };
        for (q, (low, high)) in q.iter_mut().zip(ranges) {
            *q = low + (high - low) * self.random.random::<f64>();
        }
    }
}
