//! The fewest removals that a proof leaves open.

use crate::error::CannotJudge;
use clearway_plan::Budget;
use std::cmp::Reverse;
use std::collections::{BTreeSet, BinaryHeap, HashSet};

/// Sets looked at before the search is given up.
const MOST_SETS: usize = 400_000;

/// The fewest removals, or `claimed` if that is fewer. By object: of which sets one has to be gone before;
/// `None`: it may go at any time. Of each barrier one object has to go. `None`: too many sets to look at.
///
/// From the target alone sets grow by what they cannot do without: one of the sets of a member that the
/// others do not free, then one object of a barrier that stands. The smallest that can be taken whole is the answer.
pub(super) fn fewest(
    ways: &[Option<Vec<BTreeSet<usize>>>],
    barriers: &[BTreeSet<usize>],
    target: usize,
    claimed: usize,
    budget: &Budget,
) -> Result<Option<usize>, CannotJudge> {
    let at_least = |set: &BTreeSet<usize>| {
        let lacking = |object: &usize| match &ways[*object] {
            Some(ways) => ways.iter().map(|w| w.difference(set).count()).min(),
            None => Some(0),
        };
        let most = set.iter().try_fold(0, |most, object| lacking(object).map(|l| most.max(l)));
        most.map(|lacking| set.len() + lacking.max(standing_apart(barriers, set)))
    };
    let mut queue = BinaryHeap::new();
    let mut seen = HashSet::new();
    let mut push = |queue: &mut BinaryHeap<_>, set: BTreeSet<usize>| {
        if let Some(size) = at_least(&set).filter(|size| *size < claimed)
            && !seen.contains(&set)
        {
            seen.insert(set.clone());
            queue.push(Reverse((size, set)));
        }
        seen.len()
    };
    push(&mut queue, BTreeSet::from([target]));
    while let Some(Reverse((size, set))) = queue.pop() {
        budget.check()?;
        let stuck = stuck(ways, &set);
        let standing = barriers.iter().find(|b| b.is_disjoint(&set));
        let mut known = 0;
        match (stuck.is_empty(), standing) {
            (true, None) => return Ok(Some(size)),
            (true, Some(barrier)) => {
                for object in barrier {
                    known = push(&mut queue, set.iter().chain([object]).copied().collect());
                }
            }
            (false, _) => {
                for way in stuck.iter().filter_map(|o| ways[*o].as_ref()).flatten() {
                    known = push(&mut queue, set.union(way).copied().collect());
                }
            }
        }
        if known > MOST_SETS {
            return Ok(None);
        }
    }
    Ok(Some(claimed))
}

/// Those that cannot be taken with no others gone than the set.
fn stuck(ways: &[Option<Vec<BTreeSet<usize>>>], set: &BTreeSet<usize>) -> BTreeSet<usize> {
    let (mut left, mut gone) = (set.clone(), BTreeSet::new());
    loop {
        let free = |o: &usize| ways[*o].as_ref().is_none_or(|ways| ways.iter().any(|w| w.is_subset(&gone)));
        let more: Vec<usize> = left.iter().copied().filter(free).collect();
        if more.is_empty() {
            return left;
        }
        for object in more {
            left.remove(&object);
            gone.insert(object);
        }
    }
}

/// Of the barriers that stand so many that no two have an object in common: each needs a removal.
fn standing_apart(barriers: &[BTreeSet<usize>], gone: &BTreeSet<usize>) -> usize {
    let mut hit = gone.clone();
    let mut count = 0;
    for barrier in barriers {
        if barrier.is_disjoint(&hit) {
            hit.extend(barrier);
            count += 1;
        }
    }
    count
}

#[cfg(test)]
mod tests {
    use super::*;
    use clearway_plan::Budget;

    fn sets(all: &[&[usize]]) -> Option<Vec<BTreeSet<usize>>> {
        Some(all.iter().map(|s| s.iter().copied().collect()).collect())
    }

    /// For every claim that is not too high the claim itself is the answer.
    fn found(ways: &[Option<Vec<BTreeSet<usize>>>], barriers: &[&[usize]]) -> usize {
        let barriers = sets(barriers).unwrap_or_default();
        let of = |claimed: usize| {
            fewest(ways, &barriers, 0, claimed, &Budget::unlimited()).expect("no limit").expect("few sets")
        };
        let found = of(8);
        assert!((1..=8).all(|claimed| of(claimed) == claimed.min(found)));
        found
    }

    #[test]
    fn the_fewest_by_hand() {
        // Taken at once; after either of two; after both; behind one another; behind a circle, or the long way.
        assert_eq!(found(&[sets(&[&[]]), None], &[]), 1);
        assert_eq!(found(&[sets(&[&[1], &[2]]), None, None], &[]), 2);
        assert_eq!(found(&[sets(&[&[1, 2]]), None, None], &[]), 3);
        assert_eq!(found(&[sets(&[&[1]]), sets(&[&[2]]), sets(&[&[3]]), None], &[]), 4);
        assert_eq!(found(&[sets(&[&[1], &[3, 4, 5]]), sets(&[&[2]]), sets(&[&[1]]), None, None, None], &[]), 4);
        // None at all: every claim holds.
        assert_eq!(found(&[sets(&[])], &[]), 8);
    }

    #[test]
    fn barriers_by_hand() {
        let free = || sets(&[&[]]);
        assert_eq!(found(&[free(), None, None], &[&[1, 2]]), 2);
        assert_eq!(found(&[free(), None, None, None], &[&[1, 2], &[2, 3]]), 2);
        assert_eq!(found(&[free(), None, None, None], &[&[1], &[2, 3]]), 3);
        // In the barrier only what is behind another; what has to go anyway opens another.
        assert_eq!(found(&[free(), sets(&[&[2]]), None], &[&[1]]), 3);
        assert_eq!(found(&[sets(&[&[1], &[2]]), None, None], &[&[2]]), 2);
        assert_eq!(found(&[free(), sets(&[&[2]]), sets(&[&[1]])], &[&[1, 2]]), 8);
    }

    /// Against all sets, on many small cases.
    #[test]
    fn agrees_with_brute_force() {
        let mut state = 7u64;
        let mut below = |n: usize| {
            state = state.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
            (state >> 33) as usize % n
        };
        for _ in 0..500 {
            let mut some = |most: usize| -> BTreeSet<usize> { (0..below(most + 1)).map(|_| 1 + below(5)).collect() };
            let ways: Vec<Option<Vec<BTreeSet<usize>>>> =
                (0..6).map(|_| Some((0..2).map(|_| some(3)).collect())).collect();
            let barriers: Vec<BTreeSet<usize>> = (0..2).map(|_| some(3)).filter(|b| !b.is_empty()).collect();
            let all = (0..32u32)
                .map(|bits| (0..6).filter(|i| *i == 0 || bits >> (i - 1) & 1 == 1).collect::<BTreeSet<usize>>());
            let answers =
                all.filter(|set| stuck(&ways, set).is_empty() && barriers.iter().all(|b| !b.is_disjoint(set)));
            let least = answers.map(|set| set.len()).min().unwrap_or(9);
            assert_eq!(
                fewest(&ways, &barriers, 0, 9, &Budget::unlimited()).expect("no limit"),
                Some(least),
                "{ways:?} {barriers:?}"
            );
        }
    }
}
