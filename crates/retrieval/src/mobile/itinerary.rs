//! From where which object is taken, and in what order: the cheapest way to the target when every
//! stop's ways are known. Fewer removals come first, then fewer moves of the base, then less time, or
//! whatever the weights say.
//!
//! A\* over what is gone and where the base is. A lower bound of what is left: the target, and the
//! fewest objects that still stand in any of its ways.

use crate::order::WaysIn;
use crate::ordered::Ordered;
use clearway_plan::scene_file::Weights;
use clearway_plan::{Budget, ObjectId, ObjectSet, Stop};
use std::cmp::Reverse;
use std::collections::{BinaryHeap, HashMap};

/// What is known of a scene with several stops.
pub struct Errand<'a> {
    /// By stop: by object the sets of which one has to be gone for it to be taken from there.
    pub ways: &'a [WaysIn],
    /// Besides, whatever the stop; what failed elsewhere is in these.
    pub allowed: &'a WaysIn,
    /// Seconds from stop to stop; infinite where there is no way.
    pub drives: &'a [Vec<f64>],
    /// By stop: where what is taken there is put down.
    pub puts: &'a [usize],
    pub target: ObjectId,
    /// Those that may be taken.
    pub objects: ObjectSet,
    /// Those that are gone already.
    pub gone: ObjectSet,
    pub start: usize,
    pub weights: Weights,
}

/// One object taken from a stop.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Visit {
    pub object: ObjectId,
    pub stop: usize,
}

/// Sets looked at before the search is given up.
const MOST: usize = 20_000;

impl Errand<'_> {
    /// The cheapest order that ends with the target; `None` where there is none, or too many to look at.
    pub fn cheapest(&self, budget: &Budget) -> Result<Option<Vec<Visit>>, Stop> {
        type State = (ObjectSet, usize);
        let left = |gone: &ObjectSet| {
            let lacking = self.allowed[self.target.index()].iter().map(|w| w.difference(*gone).len()).min();
            lacking.map(|n| self.weights.removal * (n + 1) as f64)
        };
        let mut best: HashMap<State, (f64, Option<(State, Visit)>)> = HashMap::new();
        let mut queue = BinaryHeap::new();
        let begin = (self.gone, self.start);
        let Some(estimate) = left(&begin.0) else { return Ok(None) };
        best.insert(begin, (0.0, None));
        queue.push(Reverse((Ordered(estimate), begin)));
        let mut looked = 0;
        while let Some(Reverse((Ordered(estimate), state))) = queue.pop() {
            let (gone, at) = state;
            let cost = best[&state].0;
            if gone.contains(self.target) {
                let mut visits = Vec::new();
                let mut at = state;
                while let Some((before, visit)) = best[&at].1 {
                    visits.push(visit);
                    at = before;
                }
                visits.reverse();
                return Ok(Some(visits));
            }
            if left(&gone).is_none_or(|l| cost + l < estimate - 1e-9) {
                continue;
            }
            looked += 1;
            if looked > MOST {
                return Ok(None);
            }
            budget.check()?;
            for object in self.objects.difference(gone).iter() {
                let free = |ways: &WaysIn| ways[object.index()].iter().any(|w| w.is_subset(&gone));
                if !free(self.allowed) {
                    continue;
                }
                for stop in (0..self.ways.len()).filter(|&s| free(&self.ways[s])) {
                    let after = (gone.with(object), self.puts[stop]);
                    let step = self.weights.removal + self.moving(at, stop) + self.moving(stop, after.1);
                    let total = cost + step;
                    if total < best.get(&after).map_or(f64::INFINITY, |b| b.0) {
                        best.insert(after, (total, Some((state, Visit { object, stop }))));
                        let rest = if object == self.target { Some(0.0) } else { left(&after.0) };
                        queue.extend(rest.map(|rest| Reverse((Ordered(total + rest), after))));
                    }
                }
            }
        }
        Ok(None)
    }

    fn moving(&self, from: usize, to: usize) -> f64 {
        if from == to { 0.0 } else { self.weights.base_move + self.weights.second * self.drives[from][to] }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand::{RngExt, SeedableRng};
    use rand_xoshiro::Xoshiro256PlusPlus;

    /// All orders and stops, tried one after the other.
    fn brute(errand: &Errand, gone: ObjectSet, at: usize) -> f64 {
        if gone.contains(errand.target) {
            return 0.0;
        }
        let mut least = f64::INFINITY;
        for object in errand.objects.difference(gone).iter() {
            for stop in 0..errand.ways.len() {
                let free = |ways: &WaysIn| ways[object.index()].iter().any(|w| w.is_subset(&gone));
                if free(errand.allowed) && free(&errand.ways[stop]) {
                    let put = errand.puts[stop];
                    let step = errand.weights.removal + errand.moving(at, stop) + errand.moving(stop, put);
                    least = least.min(step + brute(errand, gone.with(object), put));
                }
            }
        }
        least
    }

    #[test]
    fn no_order_is_cheaper() {
        let mut random = Xoshiro256PlusPlus::seed_from_u64(5);
        let (mut solved, mut driven) = (0, 0);
        for scene in 0..300 {
            let (count, stops) = (random.random_range(1..6usize), random.random_range(1..4usize));
            let mut some = |most: usize| -> ObjectSet {
                (0..random.random_range(0..=most)).map(|_| ObjectId(random.random_range(0..count) as u16)).collect()
            };
            let ways: Vec<WaysIn> = (0..stops)
                .map(|_| {
                    (0..count as u16)
                        .map(|o| {
                            let sets = (0..some(2).len()).map(|_| some(2)).map(|mut s| {
                                s.remove(ObjectId(o));
                                s
                            });
                            sets.collect()
                        })
                        .collect()
                })
                .collect();
            let allowed: WaysIn = (0..count).map(|o| ways.iter().flat_map(|w| w[o].clone()).collect()).collect();
            let drives: Vec<Vec<f64>> =
                (0..stops).map(|_| (0..stops).map(|_| random.random_range(1.0..20.0)).collect()).collect();
            let puts: Vec<usize> = (0..stops).map(|s| if random.random_range(0..3) == 0 { 0 } else { s }).collect();
            let weights = if scene % 2 == 0 {
                Weights::default()
            } else {
                Weights { removal: 3.0, base_move: 10.0, second: 0.5 }
            };
            let objects = (0..count as u16).map(ObjectId).collect();
            let errand = Errand {
                ways: &ways,
                allowed: &allowed,
                drives: &drives,
                puts: &puts,
                target: ObjectId(0),
                objects,
                gone: ObjectSet::EMPTY,
                start: 0,
                weights,
            };
            let least = brute(&errand, ObjectSet::EMPTY, 0);
            let found = errand.cheapest(&Budget::unlimited()).unwrap();
            assert_eq!(found.is_some(), least.is_finite());
            let Some(visits) = found else { continue };
            solved += 1;
            let (mut gone, mut at, mut cost) = (ObjectSet::EMPTY, 0, 0.0);
            for visit in &visits {
                let free = |ways: &WaysIn| ways[visit.object.index()].iter().any(|w| w.is_subset(&gone));
                assert!(free(&ways[visit.stop]));
                driven += usize::from(at != visit.stop);
                cost += weights.removal + errand.moving(at, visit.stop) + errand.moving(visit.stop, puts[visit.stop]);
                at = puts[visit.stop];
                gone.insert(visit.object);
            }
            assert_eq!(visits.last().map(|v| v.object), Some(ObjectId(0)));
            assert!((cost - least).abs() < 1e-9, "{cost} for {least}");
        }
        assert!(solved > 60 && driven > 20, "{solved} solved, {driven} moves");
    }
}
