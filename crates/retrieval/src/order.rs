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
//!
//! There may be barriers besides: sets of which every answer has a member.

use clearway_plan::{Budget, ObjectId, ObjectSet, Stop};
use std::cmp::Reverse;
use std::collections::{BinaryHeap, HashSet};

/// By object: sets of which any one, gone, lets the object be taken. No set: it never can be.
pub type WaysIn = Vec<Vec<ObjectSet>>;

/// The objects of `set` that can be taken with no others gone, in an order in which they can: of those
/// that can be taken next the one for which `key` of it and the last one is least.
pub fn arrange<K: PartialOrd>(
    ways: &WaysIn,
    set: &ObjectSet,
    key: impl Fn(Option<ObjectId>, ObjectId) -> K,
) -> Vec<ObjectId> {
    let mut gone = ObjectSet::EMPTY;
    let mut order: Vec<ObjectId> = Vec::new();
    loop {
        let last = order.last().copied();
        let free = |o: &ObjectId| ways[o.index()].iter().any(|w| w.is_subset(&gone));
        let next = set
            .difference(gone)
            .iter()
            .filter(free)
            .map(|o| (key(last, o), o))
            .reduce(|a, b| if b.0 < a.0 { b } else { a });
        let Some((_, next)) = next else { return order };
        gone.insert(next);
        order.push(next);
    }
}

/// Those of `set` that can be taken with no others gone.
pub(crate) fn takable(ways: &WaysIn, set: &ObjectSet) -> ObjectSet {
    let mut gone = ObjectSet::EMPTY;
    loop {
        let free = |o: &ObjectId| ways[o.index()].iter().any(|w| w.is_subset(&gone));
        let before = gone.len();
        for object in set.difference(gone).iter().filter(free).collect::<Vec<_>>() {
            gone.insert(object);
        }
        if gone.len() == before {
            return gone;
        }
    }
}

/// How many objects may stand in the way of an object in a sequence of at most `limit`: all but
/// itself, and the target.
pub fn most_in_way(limit: usize, is_target: bool) -> usize {
    limit.saturating_sub(if is_target { 1 } else { 2 })
}

/// Sets looked at before a search that matters is given up: seconds.
pub const THOROUGH: usize = 300_000;

/// What a search for the fewest removals found.
#[derive(Clone, Debug, PartialEq)]
pub enum Fewest {
    /// The objects, the target among them; of equally few any.
    Found(ObjectSet),
    /// There is no answer of so few; the fewest there can be, if there is any.
    None { at_least: Option<usize> },
    /// Too many sets to look at.
    TooMany,
}

/// A set of which an answer has at least one member. The weights of all that hold an object add up to at
/// most 1.
#[derive(Clone, Copy, Debug)]
pub struct Barrier {
    pub objects: ObjectSet,
    pub weight: f64,
}

/// At least so many objects hit all barriers that `set` does not.
fn to_hit(barriers: &[Barrier], set: &ObjectSet) -> usize {
    let unhit = barriers.iter().filter(|b| !b.objects.intersects(set));
    least(unhit.map(|b| b.weight).sum())
}

/// So many objects, given the weight of a packing: rounded up, up to what numbers are uncertain by.
pub(crate) fn least(weight: f64) -> usize {
    (weight - 1e-4).ceil().max(0.0) as usize
}

/// The fewest removals, at most `most` with the target; `sets`: how many may be looked at.
pub fn fewest(
    ways: &WaysIn,
    barriers: &[Barrier],
    target: ObjectId,
    most: usize,
    sets: usize,
    budget: &Budget,
) -> Result<Fewest, Stop> {
    let lacking =
        |object: ObjectId, set: &ObjectSet| ways[object.index()].iter().map(|w| w.difference(*set).len()).min();
    // The size of any answer above a set is at least this; `None` when there is none.
    let bound = |set: &ObjectSet| -> Option<usize> {
        let ways = set.iter().try_fold(0, |most, o| lacking(o, set).map(|l| most.max(l)));
        ways.map(|l| l.max(to_hit(barriers, set)) + set.len())
    };
    let mut queue = BinaryHeap::new();
    let mut seen = HashSet::new();
    let mut beyond: Option<usize> = None;
    let mut push = |queue: &mut BinaryHeap<_>, set: ObjectSet| match bound(&set) {
        Some(size) if size <= most => {
            if seen.insert(set) {
                queue.push(Reverse((size, Reverse(set.len()), set)));
            }
        }
        Some(size) => beyond = Some(beyond.map_or(size, |b| b.min(size))),
        None => {}
    };
    push(&mut queue, ObjectSet::of(target));
    let mut looked = 0;
    while let Some(Reverse((_, _, set))) = queue.pop() {
        budget.check()?;
        looked += 1;
        if looked > sets {
            return Ok(Fewest::TooMany);
        }
        let taken = takable(ways, &set);
        let standing = barriers.iter().find(|b| !b.objects.intersects(&taken));
        if taken.contains(target) && standing.is_none() {
            // An answer without some of them would have come first, so all of them go.
            return Ok(Fewest::Found(taken));
        }
        let stuck = set.difference(taken);
        if let (true, Some(barrier)) = (stuck.is_empty(), standing) {
            for object in barrier.objects.iter() {
                push(&mut queue, set.with(object));
            }
        }
        for stuck in stuck.iter() {
            for way in ways[stuck.index()].iter().filter(|w| !w.is_subset(&set)) {
                push(&mut queue, way.union(set));
            }
        }
    }
    Ok(Fewest::None { at_least: beyond })
}

/// Few removals, not always the fewest, however many objects there are: for each object a small set with
/// which it can be taken, made from those of what stands in its way, until none gets smaller. `None`
/// when there is no answer.
pub fn few(ways: &WaysIn, target: ObjectId, budget: &Budget) -> Result<Option<ObjectSet>, Stop> {
    let mut with: Vec<Option<ObjectSet>> = vec![None; ways.len()];
    let mut changed = true;
    while changed {
        changed = false;
        for (index, ways) in ways.iter().enumerate() {
            budget.check()?;
            let itself = ObjectSet::of(ObjectId(index as u16));
            let whole = |way: &ObjectSet| way.iter().try_fold(itself, |set, o| Some(set.union(with[o.index()]?)));
            let best = ways.iter().filter_map(whole).min_by_key(ObjectSet::len);
            if let Some(best) = best.filter(|b| with[index].is_none_or(|w| b.len() < w.len())) {
                with[index] = Some(best);
                changed = true;
            }
        }
    }
    let Some(mut set) = with[target.index()] else { return Ok(None) };
    // What is there for nothing, or for another way than the one taken, stays.
    for object in set.iter().filter(|o| *o != target) {
        let without = set.difference(ObjectSet::of(object));
        let taken = takable(ways, &without);
        if taken.contains(target) {
            set = taken;
        }
    }
    Ok(Some(set))
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand::{Rng, RngExt, SeedableRng};
    use rand_xoshiro::Xoshiro256PlusPlus;

    /// All ordered subsets, fewest first.
    fn by_brute_force(ways: &WaysIn, target: ObjectId) -> Option<usize> {
        let others: Vec<ObjectId> = (0..ways.len() as u16).map(ObjectId).filter(|o| *o != target).collect();
        let sets = (0..1u32 << others.len()).map(|bits| {
            others.iter().enumerate().filter(|(i, _)| bits >> i & 1 == 1).map(|(_, o)| *o).collect::<ObjectSet>()
        });
        let opens = |set: &ObjectSet| {
            let all = set.with(target);
            takable(ways, &all) == all && ways[target.index()].iter().any(|w| w.is_subset(set))
        };
        sets.filter(opens).map(|s| s.len() + 1).min()
    }

    fn search(ways: &WaysIn, most: usize) -> Fewest {
        fewest(ways, &[], ObjectId(0), most, 100_000, &Budget::unlimited()).expect("no limit")
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
        let (mut had, mut deep, mut equal) = (0, 0, 0);
        for _ in 0..2000 {
            let ways = random_ways(8, &mut random);
            let best = by_brute_force(&ways, ObjectId(0));
            let some = few(&ways, ObjectId(0), &Budget::unlimited()).expect("no limit");
            let Fewest::Found(set) = search(&ways, usize::MAX) else {
                assert_eq!((best, some), (None, None), "{ways:?}");
                continue;
            };
            assert_eq!(Some(set.len()), best, "{ways:?}");
            let some = some.expect("there is an answer");
            assert!(some.len() >= set.len() && takable(&ways, &some) == some && some.contains(ObjectId(0)), "{ways:?}");
            equal += usize::from(some.len() == set.len());
            had += 1;
            deep += usize::from(set.len() > 3);
            // One by one, each with a way that is gone.
            let order = arrange(&ways, &set, |_, o| if o == ObjectId(0) { 1 } else { 0 });
            assert_eq!((order.len(), order.last()), (set.len(), Some(&ObjectId(0))));
            let mut gone = ObjectSet::EMPTY;
            for object in order {
                assert!(ways[object.index()].iter().any(|w| w.is_subset(&gone)), "{ways:?}");
                gone.insert(object);
            }
            // Below there is none, and what is said of more is true.
            match search(&ways, set.len() - 1) {
                Fewest::None { at_least } => assert!(at_least.is_some_and(|n| n <= set.len()), "{ways:?}"),
                other => panic!("{other:?} for {ways:?}"),
            }
        }
        assert!(equal * 100 > had * 90, "{equal} of {had}");
        assert!(had > 500 && deep > 50, "{had} {deep}");
    }

    #[test]
    fn circles_are_no_order() {
        let ways =
            vec![vec![ObjectSet::of(ObjectId(1))], vec![ObjectSet::of(ObjectId(2))], vec![ObjectSet::of(ObjectId(1))]];
        assert_eq!(search(&ways, 9), Fewest::None { at_least: None });
        assert_eq!(few(&ways, ObjectId(0), &Budget::unlimited()).expect("no limit"), None);
    }
}
