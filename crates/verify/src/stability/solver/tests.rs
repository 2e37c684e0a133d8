use super::*;
use rand::{RngExt, SeedableRng};
use rand_xoshiro::Xoshiro256PlusPlus;

fn dense(rows: &[&[f64]], right: &[f64]) -> Problem {
    let columns = rows.first().map_or(0, |r| r.len());
    let column = |c: usize| rows.iter().enumerate().map(|(r, row)| (r, row[c])).collect();
    Problem { columns: (0..columns).map(column).collect(), right: right.to_vec() }
}

#[test]
fn by_hand() {
    let lever: &[&[f64]] = &[&[1.0, 1.0], &[-1.0, 2.0]];
    for (rows, right, expected) in [
        (lever, &[1.0, 0.0][..], Answer::Yes),
        (lever, &[1.0, 2.0], Answer::Yes),
        (lever, &[1.0, 2.1], Answer::No),
        (lever, &[1.0, -1.1], Answer::No),
        (lever, &[-1.0, 0.0], Answer::No),
        (lever, &[0.0, 0.0], Answer::Yes),
        (&[], &[], Answer::Yes),
        (&[&[], &[]], &[0.0, 0.0], Answer::Yes),
        (&[&[], &[]], &[0.0, 1.0], Answer::No),
        // Rows that say the same, and that contradict each other.
        (&[&[1.0, 1.0], &[1.0, 1.0]], &[1.0, 1.0], Answer::Yes),
        (&[&[1.0, 1.0], &[1.0, 1.0]], &[1.0, 2.0], Answer::No),
        // An empty row and an empty column.
        (&[&[1.0, 0.0], &[0.0, 0.0]], &[1.0, 0.0], Answer::Yes),
        (&[&[1.0, 0.0], &[0.0, 0.0]], &[1.0, 1.0], Answer::No),
    ] {
        assert_eq!(solve(&dense(rows, right)), expected, "{rows:?} {right:?}");
    }
}

#[test]
fn numbers_that_are_none_do_no_harm() {
    for odd in [f64::NAN, f64::INFINITY, -f64::INFINITY, 1e300] {
        assert_ne!(solve(&dense(&[&[1.0, odd], &[odd, 1.0]], &[1.0, -1.0])), Answer::Yes);
    }
    assert_eq!(solve(&dense(&[&[1.0, 1.0], &[-1.0, 1.0]], &[f64::NAN, 1.0])), Answer::Unknown);
}

/// Beale's and Kuhn's, on which the simplex method without Bland's rule goes in circles.
#[test]
fn no_circles() {
    let beale: &[&[f64]] = &[
        &[0.25, -60.0, -0.04, 9.0, 1.0, 0.0, 0.0],
        &[0.5, -90.0, -0.02, 3.0, 0.0, 1.0, 0.0],
        &[0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0],
    ];
    assert_eq!(solve(&dense(beale, &[0.0, 0.0, 1.0])), Answer::Yes);
    let kuhn: &[&[f64]] = &[
        &[-2.0, -9.0, 1.0, 9.0, 1.0, 0.0],
        &[1.0 / 3.0, 1.0, -1.0 / 3.0, -2.0, 0.0, 1.0],
        &[-2.0, -3.0, 1.0, 12.0, 0.0, 0.0],
    ];
    assert_eq!(solve(&dense(kuhn, &[0.0, 0.0, 0.0])), Answer::Yes);
}

#[test]
fn what_was_made_to_have_an_answer_has_it() {
    let mut random = Xoshiro256PlusPlus::seed_from_u64(1);
    for round in 0..2_000 {
        let rows = random.random_range(1..12);
        let columns = random.random_range(1..25);
        // Small whole numbers: many ties.
        let whole = round % 2 == 0;
        let mut entry = || {
            let value: f64 = random.random_range(-1.0..1.0);
            if whole { (3.0 * value).round() } else { value }
        };
        let matrix: Vec<Vec<f64>> = (0..rows).map(|_| (0..columns).map(|_| entry()).collect()).collect();
        let refs: Vec<&[f64]> = matrix.iter().map(Vec::as_slice).collect();
        let x: Vec<f64> = (0..columns).map(|_| entry().max(0.0)).collect();
        let right: Vec<f64> = matrix.iter().map(|row| row.iter().zip(&x).map(|(a, x)| a * x).sum()).collect();
        assert_eq!(solve(&dense(&refs, &right)), Answer::Yes, "{matrix:?} {x:?}");
        // With y at hand: every column is turned to its far side, and b is on its own.
        let y: Vec<f64> = (0..rows).map(|_| entry()).collect();
        let along = |v: &[f64]| v.iter().zip(&y).map(|(a, y)| a * y).sum::<f64>();
        let mut problem = dense(&refs, &y);
        for column in &mut problem.columns {
            let values: Vec<f64> = column.iter().map(|(_, a)| *a).collect();
            if along(&values) > 0.0 {
                column.iter_mut().for_each(|(_, a)| *a = -*a);
            }
        }
        let expected = if along(&y) > 0.0 { Answer::No } else { Answer::Yes };
        assert_eq!(solve(&problem), expected, "{matrix:?} {y:?}");
    }
}

#[test]
fn a_spoilt_inverse_is_made_anew() {
    let problem = dense(&[&[1.0, 1.0, 0.3], &[-1.0, 2.0, 0.1], &[0.5, 0.2, -1.0]], &[1.0, 0.2, 0.1]);
    let mut simplex = Simplex::new(&problem);
    assert_eq!(simplex.run(), Answer::Yes);
    simplex.inverse.iter_mut().for_each(|i| *i = 0.9 * *i + 0.01);
    simplex.value.iter_mut().for_each(|v| *v += 0.1);
    assert!(!simplex.solves());
    assert_eq!(simplex.run(), Answer::Yes);
}
