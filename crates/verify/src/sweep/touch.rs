//! Overlaps along a segment. Nothing that overlaps by 0.2 mm for an instant is missed, and nothing
//! that overlaps by less than 0.1 mm is reported.

use super::{LOOK_AHEAD, Pair, Seek, Sweep, When};
use crate::gap::Gap;
use crate::rest::TOUCH;
use parry3d_f64::math::{Pose, Vector};
use std::collections::BTreeMap;

/// Overlap that a bound may leave open without a closer look; the rest of 0.1 mm is for
/// inexact distances.
const LEFT_OPEN: f64 = 5e-5;

/// How much overlap is forgiven, and near which owner positions (world) of the first mover.
#[derive(Clone, Default)]
pub(crate) struct Forgiven {
    pub near: Vec<Vector>,
    pub within: f64,
    pub overlap: f64,
}

/// The deepest overlap found for a subject.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Touch {
    pub subject: usize,
    pub when: When,
    /// Metres.
    pub depth: f64,
    pub point: Vector,
    /// One shape is wholly inside a mesh: the depth says nothing.
    pub enclosed: bool,
}

/// Touches along a segment, looked for.
pub(crate) struct Touches<'a, 'p> {
    pairs: &'p [Pair<'a>],
    /// By subject.
    forgiven: Vec<Option<Forgiven>>,
    /// By pair.
    found: Vec<Option<Touch>>,
}

impl<'a, 'p> Touches<'a, 'p> {
    pub fn new(pairs: &'p [Pair<'a>], forgiven: Vec<Option<Forgiven>>) -> Self {
        Self { pairs, forgiven, found: vec![None; pairs.len()] }
    }

    /// After the sweep: the deepest touch of every subject that touches, by subject.
    pub fn deepest(&self, sweep: &mut Sweep<'a>) -> Vec<Touch> {
        let mut deepest: BTreeMap<usize, Touch> = BTreeMap::new();
        for (pair, found) in self.pairs.iter().zip(&self.found) {
            let when = When { row: 0, fraction: 0.0 };
            let enclosed = (found.is_none() && sweep.enclosed(pair)).then(|| {
                let Gap { distance, point } = sweep.measure(pair, when, LOOK_AHEAD).gap;
                Touch { subject: pair.subject, when, depth: distance.abs(), point, enclosed: true }
            });
            if let Some(touch) = found.or(enclosed) {
                let entry = deepest.entry(touch.subject).or_insert(touch);
                if touch.depth > entry.depth {
                    *entry = touch;
                }
            }
        }
        deepest.into_values().collect()
    }
}

impl Seek for Touches<'_, '_> {
    fn below(&self, _: usize) -> f64 {
        -LEFT_OPEN
    }

    fn met(&mut self, pair: usize, gap: Gap, when: When, owner: &Pose) {
        if gap.distance >= -TOUCH {
            return;
        }
        let subject = self.pairs[pair].subject;
        if let Some(forgiven) = &self.forgiven[subject]
            && gap.distance >= -forgiven.overlap
            && forgiven.near.iter().any(|p| (*p - owner.translation).length() <= forgiven.within)
        {
            return;
        }
        let depth = -gap.distance;
        if self.found[pair].is_none_or(|f| depth > f.depth) {
            self.found[pair] = Some(Touch { subject, when, depth, point: gap.point, enclosed: false });
        }
    }

    fn done(&self, pair: usize) -> bool {
        self.found[pair].is_some()
    }

    fn counts(&self, _: usize, _: &Pose) -> bool {
        true
    }
}
