//! The arm's postures at one moment: which are free, which straight lines are.

use crate::Posture;
use clearway_collision::{Moment, Scratch, Touch, World};
use clearway_plan::ObjectSet;

/// Postures of one robot at one moment.
pub struct Space<'a> {
    pub world: &'a World,
    pub moment: &'a Moment,
    scratch: Scratch,
    /// Between two checked postures of a line no point of the robot moves farther, metres.
    pub step: f64,
}

impl<'a> Space<'a> {
    pub fn new(world: &'a World, moment: &'a Moment, step: f64) -> Self {
        Self { world, moment, scratch: Scratch::default(), step }
    }

    pub fn lower(&self) -> &[f64] {
        &self.world.robot.lower
    }

    pub fn upper(&self) -> &[f64] {
        &self.world.robot.upper
    }

    pub fn inside_limits(&self, q: &[f64]) -> bool {
        q.iter().zip(self.lower()).zip(self.upper()).all(|((q, l), u)| q >= l && q <= u)
    }

    #[inline]
    pub fn free(&mut self, q: &[f64]) -> bool {
        self.world.free(q, self.moment, &mut self.scratch)
    }

    #[inline]
    pub fn touched(&mut self, q: &[f64]) -> Touch {
        self.world.touched(q, self.moment, &mut self.scratch)
    }

    /// An upper bound of how far any point of the robot moves on the straight line, metres.
    #[inline]
    pub fn sweep(&self, a: &[f64], b: &[f64]) -> f64 {
        a.iter().zip(b).zip(&self.world.reach).map(|((a, b), r)| (a - b).abs() * r).sum()
    }

    /// Whether the straight line is free, both ends included; `a` is taken to be free already.
    pub fn line_free(&mut self, a: &[f64], b: &[f64]) -> bool {
        if !self.free(b) {
            return false;
        }
        let count = (self.sweep(a, b) / self.step).ceil() as usize;
        let mut q: Posture = a.to_vec();
        // Coarse first: most lines that are blocked show it at a handful of postures.
        let mut gap = count.next_power_of_two();
        while gap > 1 {
            for i in (gap / 2..count).step_by(gap) {
                let t = i as f64 / count as f64;
                for (q, (a, b)) in q.iter_mut().zip(a.iter().zip(b)) {
                    *q = a + (b - a) * t;
                }
                if !self.free(&q) {
                    return false;
                }
            }
            gap /= 2;
        }
        true
    }

    /// Whether every line of a path is free, its first posture included.
    pub fn path_free(&mut self, path: &[Posture]) -> bool {
        path.first().is_none_or(|q| self.free(q)) && path.windows(2).all(|w| self.line_free(&w[0], &w[1]))
    }

    /// Everything movable that a path touches; `None` when it touches something fixed.
    pub fn path_touched(&mut self, path: &[Posture]) -> Option<ObjectSet> {
        let mut all = ObjectSet::EMPTY;
        for w in path.windows(2) {
            let count = (self.sweep(&w[0], &w[1]) / self.step).ceil().max(1.0) as usize;
            for i in 0..=count {
                let t = i as f64 / count as f64;
                let q: Posture = w[0].iter().zip(&w[1]).map(|(a, b)| a + (b - a) * t).collect();
                match self.touched(&q) {
                    Touch::Fixed => return None,
                    Touch::Objects(set) => all = all.union(set),
                }
            }
        }
        Some(all)
    }
}
