//! Fractional packing: weights of sets, as heavy as can be, such that no element bears more than 1.
//!
//! The simplex method on max Σ w, Σ w over the sets that hold an element ≤ 1, w ≥ 0, from w = 0, by Bland's
//! rule. Its dual prices the elements: every set costs at least 1, all elements together as much as the
//! sets weigh.

use clearway_plan::ObjectSet;

/// Below this a number is 0.
const ZERO: f64 = 1e-9;

pub struct Packing {
    /// By set.
    pub weights: Vec<f64>,
    /// By element: what one more of it would be worth.
    pub prices: Vec<f64>,
}

/// No set may be empty; elements are below `count`.
pub fn pack(sets: &[ObjectSet], count: usize) -> Packing {
    // A row for each element in some set: the sets, the slacks, the right side. The last row: reduced costs.
    let elements: Vec<usize> =
        sets.iter().fold(ObjectSet::EMPTY, |all, s| all.union(*s)).iter().map(|o| o.index()).collect();
    let width = sets.len() + elements.len() + 1;
    let mut rows: Vec<Vec<f64>> = Vec::with_capacity(elements.len() + 1);
    for (r, element) in elements.iter().enumerate() {
        let mut row = vec![0.0; width];
        for (c, set) in sets.iter().enumerate() {
            row[c] = f64::from(u8::from(set.iter().any(|o| o.index() == *element)));
        }
        (row[sets.len() + r], row[width - 1]) = (1.0, 1.0);
        rows.push(row);
    }
    let mut costs = vec![0.0; width];
    costs[..sets.len()].fill(-1.0);
    rows.push(costs);
    let last = elements.len();
    let mut basis: Vec<usize> = (sets.len()..width - 1).collect();
    while let Some(enters) = (0..width - 1).find(|&c| rows[last][c] < -ZERO) {
        let ratio = |r: usize| rows[r][width - 1] / rows[r][enters];
        let may = (0..last).filter(|&r| rows[r][enters] > ZERO);
        let Some(leaves) = may.min_by(|&a, &b| ratio(a).total_cmp(&ratio(b)).then(basis[a].cmp(&basis[b]))) else {
            break;
        };
        let pivot = rows[leaves][enters];
        rows[leaves].iter_mut().for_each(|v| *v /= pivot);
        let pivot_row = rows[leaves].clone();
        for (_, row) in rows.iter_mut().enumerate().filter(|(r, row)| *r != leaves && row[enters] != 0.0) {
            let times = row[enters];
            row.iter_mut().zip(&pivot_row).for_each(|(v, p)| *v -= times * p);
        }
        basis[leaves] = enters;
    }
    let mut weights = vec![0.0; sets.len()];
    for (r, &c) in basis.iter().enumerate().filter(|(_, c)| **c < sets.len()) {
        weights[c] = rows[r][width - 1].max(0.0);
    }
    let mut prices = vec![0.0; count];
    for (r, &element) in elements.iter().enumerate() {
        prices[element] = rows[last][sets.len() + r].max(0.0);
    }
    Packing { weights, prices }
}

#[cfg(test)]
mod tests {
    use super::*;
    use clearway_plan::ObjectId;
    use rand::{RngExt, SeedableRng};
    use rand_xoshiro::Xoshiro256PlusPlus;

    fn set(all: &[u16]) -> ObjectSet {
        all.iter().map(|&i| ObjectId(i)).collect()
    }

    fn total(sets: &[ObjectSet]) -> f64 {
        pack(sets, 8).weights.iter().sum()
    }

    #[test]
    fn known_packings() {
        assert_eq!(total(&[]), 0.0);
        assert_eq!(total(&[set(&[1, 2]), set(&[3])]), 2.0);
        assert_eq!(total(&[set(&[1, 2]), set(&[2, 3]), set(&[2])]), 1.0);
        // Each two of three meet: a half of each.
        assert!((total(&[set(&[1, 2]), set(&[2, 3]), set(&[1, 3])]) - 1.5).abs() < 1e-12);
    }

    /// Weights and prices are feasible and worth the same: by duality both are optimal.
    #[test]
    fn weights_and_prices_prove_each_other() {
        let mut random = Xoshiro256PlusPlus::seed_from_u64(3);
        for _ in 0..2000 {
            let mut below = |n: u16| random.random_range(0..n);
            let sets: Vec<ObjectSet> =
                (0..below(12)).map(|_| (0..1 + below(4)).map(|_| ObjectId(below(8))).collect()).collect();
            let Packing { weights, prices } = pack(&sets, 8);
            for element in 0..8 {
                let borne: f64 =
                    sets.iter().zip(&weights).filter(|(s, _)| s.contains(ObjectId(element))).map(|(_, w)| w).sum();
                assert!(borne <= 1.0 + 1e-9, "{sets:?}");
            }
            assert!(sets.iter().all(|s| s.iter().map(|o| prices[o.index()]).sum::<f64>() >= 1.0 - 1e-9), "{sets:?}");
            assert!(weights.iter().chain(&prices).all(|v| *v >= 0.0));
            let (heavy, dear): (f64, f64) = (weights.iter().sum(), prices.iter().sum());
            assert!((heavy - dear).abs() < 1e-9, "{heavy} {dear} {sets:?}");
        }
    }
}
