//! The fewest objects that have to go for the target to be had, when every object's ways are known.
//!
//! An object can be taken when one of its sets is gone. Removal is monotone: what can be taken stays
//! so. Hence an answer is a set *S* that holds the target and, for each member, one of its ways in
//! full, in an order without circles; the smallest such set is looked for by A\* over sets.
//!
//! A set that is no answer yet has members that cannot be taken with the others gone. In an answer
//! above it the first of these to be taken has a way that is not all in the set, so the search adds
//! each way of each of them; whatever the answer is, one of these steps leads to it. No member needs
//! fewer objects more than its smallest way lacks, which makes a bound for A\*.

use clearway_plan::{Budget, ObjectId, ObjectSet, Stop};
use std::cmp::Reverse;
use std::collections::{BinaryHeap, HashSet};

/// By object: sets of which any one, gone, lets the object be taken. No set: it never can be.
pub type WaysIn = Vec<Vec<ObjectSet>>;

/// The objects of `set` that can be taken with no others gone, in an order in which they can.
fn order_within(ways: &WaysIn, set: &ObjectSet) -> Vec<ObjectId> {
    let mut gone = ObjectSet::EMPTY;
    let mut order = Vec::new();
    loop {
        let next = set.difference(gone).iter().find(|o| ways[o.index()].iter().any(|w| w.is_subset(&gone)));
        let Some(next) = next else { return order };
        gone.insert(next);
        order.push(next);
    }
}

/// Sets looked at before a search is given up: seconds.
const MOST_SETS: usize = 300_000;

/// The fewest removals of at most `most`, the target included and last; `None` when there is no such
/// order. Of equally few any. [`Stop::Iterations`] where there are too many sets to look at.
pub fn fewest(ways: &WaysIn, target: ObjectId, most: usize, budget: &Budget) -> Result<Option<Vec<ObjectId>>, Stop> {
    let lacking = |object: ObjectId, set: &ObjectSet| ways[object.index()].iter().map(|w| w.difference(*set).len()).min();
    // The size of any answer above a set is at least this; `None` when there is none.
    let bound = |set: &ObjectSet| -> Option<usize> {
        set.iter().try_fold(0, |most, o| lacking(o, set).map(|l| most.max(l))).map(|l| l + set.len())
    };
    let mut queue = BinaryHeap::new();
    let mut seen = HashSet::new();
    let mut push = |queue: &mut BinaryHeap<_>, set: ObjectSet| {
        if let Some(size) = bound(&set).filter(|&s| s <= most)
            && seen.insert(set)
        {
            queue.push(Reverse((size, Reverse(set.len()), set)));
        }
    };
    push(&mut queue, ObjectSet::of(target));
    let mut looked = 0;
    while let Some(Reverse((_, _, set))) = queue.pop() {
        budget.check()?;
        looked += 1;
        if looked > MOST_SETS {
            return Err(Stop::Iterations);
        }
        let order = order_within(ways, &set);
        if order.contains(&target) {
            // An answer without some of them would have come first, so all go, the target last.
            let before = order.into_iter().filter(|o| *o != target);
            return Ok(Some(before.chain([target]).collect()));
        }
        let taken: ObjectSet = order.into_iter().collect();
        for stuck in set.difference(taken).iter() {
            for way in ways[stuck.index()].iter().filter(|w| !w.is_subset(&set)) {
                push(&mut queue, way.union(set));
            }
        }
    }
    Ok(None)
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand::{Rng, RngExt, SeedableRng};
    use rand_xoshiro::Xoshiro256PlusPlus;

    /// All ordered subsets, fewest first.
    fn by_brute_force(ways: &WaysIn, target: ObjectId) -> Option<usize> {
        let others: Vec<ObjectId> = (0..ways.len() as u16).map(ObjectId).filter(|o| *o != target).collect();
        let sets = (0..1u32 << others.len())
            .map(|bits| others.iter().enumerate().filter(|(i, _)| bits >> i & 1 == 1).map(|(_, o)| *o).collect::<ObjectSet>());
        let opens = |set: &ObjectSet| {
            let all = set.with(target);
            let order = order_within(ways, &all);
            order.len() == all.len() && ways[target.index()].iter().any(|w| w.is_subset(set))
        };
        sets.filter(opens).map(|s| s.len() + 1).min()
    }

    /// Each object has up to three ways, few of them empty: there are many circles.
    fn random_ways(count: usize, random: &mut impl Rng) -> WaysIn {
        let mut below = |n: usize| random.random_range(0..n);
        let mut ways: WaysIn = vec![Vec::new(); count];
        for (object, ways) in ways.iter_mut().enumerate() {
            for _ in 0..below(4) {
                let size = if below(6) == 0 { 0 } else { 1 + below(2) };
                let set: ObjectSet = (0..size).map(|_| ObjectId(below(count) as u16)).collect();
                if !set.contains(ObjectId(object as u16)) {
                    ways.push(set);
                }
            }
        }
        ways
    }

    #[test]
    fn agrees_with_brute_force() {
        let mut random = Xoshiro256PlusPlus::seed_from_u64(1);
        let (mut had, mut deep) = (0, 0);
        for _ in 0..2000 {
            let ways = random_ways(8, &mut random);
            let found = fewest(&ways, ObjectId(0), usize::MAX, &Budget::unlimited()).expect("no limit");
            let best = by_brute_force(&ways, ObjectId(0));
            assert_eq!(found.as_ref().map(Vec::len), best, "{ways:?}");
            let Some(order) = found else { continue };
            had += 1;
            deep += usize::from(order.len() > 3);
            assert_eq!(order.last(), Some(&ObjectId(0)));
            let mut gone = ObjectSet::EMPTY;
            for object in order {
                assert!(ways[object.index()].iter().any(|w| w.is_subset(&gone)), "{ways:?}");
                gone.insert(object);
            }
            assert_eq!(fewest(&ways, ObjectId(0), gone.len() - 1, &Budget::unlimited()).expect("no limit"), None);
        }
        assert!(had > 500 && deep > 50, "{had} {deep}");
    }

    #[test]
    fn circles_are_no_order() {
        let ways = vec![vec![ObjectSet::of(ObjectId(1))], vec![ObjectSet::of(ObjectId(2))], vec![ObjectSet::of(ObjectId(1))]];
        assert_eq!(fewest(&ways, ObjectId(0), 9, &Budget::unlimited()).expect("no limit"), None);
    }
}
