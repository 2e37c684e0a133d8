//! Forces that balance, or a motion that proves there are none: phase 1 of the simplex method.
//!
//! Looked for are x ≥ 0 with A x = b. To begin with an artificial variable per row makes up for b; the
//! method drives their sum down. It keeps the inverse of the basis and asks each column, which has few
//! entries, what it would gain. The steepest column enters; after steps that gain nothing it is the
//! first that gains (Bland's rule), so that it ends.

/// Gains and pivots below this are 0. Rows and columns are to be of size 1, about.
const ZERO: f64 = 1e-9;
/// By how much a variable may be below 0 on the way.
const ROUNDING: f64 = 1e-9;
/// What may be left of the artificial variables, and of any row in the end.
const LEFT: f64 = 1e-7;
/// The entries of a column that are not 0: row, value.
pub(crate) type Column = Vec<(usize, f64)>;

/// No x ≥ 0 gives b: the multipliers y of the rows have y·a ≤ 0 for every column, and y·b > 0.
#[derive(Clone, Debug)]
pub(crate) struct Infeasible {
    pub(crate) multipliers: Vec<f64>,
}

/// x ≥ 0 with A x = b, by column, unless there are none.
pub(crate) fn solve(columns: &[Column], right: &[f64]) -> Result<Vec<f64>, Infeasible> {
    solve_by(columns, right, right.len() + 50)
}

/// The same with Bland's rule after so many steps without gain.
fn solve_by(columns: &[Column], right: &[f64], patience: usize) -> Result<Vec<f64>, Infeasible> {
    let rows = right.len();
    // Rows turned so that b ≥ 0; the artificial variables are the columns past the last.
    let sign: Vec<f64> = right.iter().map(|b| if *b < 0.0 { -1.0 } else { 1.0 }).collect();
    let mut basis: Vec<usize> = (0..rows).map(|r| columns.len() + r).collect();
    let mut inverse: Vec<Vec<f64>> =
        (0..rows).map(|r| (0..rows).map(|c| if r == c { sign[r] } else { 0.0 }).collect()).collect();
    let mut values: Vec<f64> = right.iter().map(|b| b.abs()).collect();
    let mut price = sign;
    let mut stalled = 0;
    for _ in 0..30 * (rows + 10) {
        let gain = |c: usize| columns[c].iter().map(|(r, v)| price[*r] * v).sum::<f64>();
        let mut gains = (0..columns.len()).map(|c| (c, gain(c))).filter(|(_, g)| *g > ZERO);
        let enters = if stalled < patience { gains.max_by(|a, b| a.1.total_cmp(&b.1)) } else { gains.next() };
        let Some((enters, _)) = enters else { break };
        let change: Vec<f64> =
            inverse.iter().map(|row| columns[enters].iter().map(|(r, v)| row[*r] * v).sum::<f64>()).collect();
        // By Bland's rule in a fixed order, the artificial ones first.
        let order = |r: usize| (stalled >= patience).then(|| (basis[r] < columns.len(), basis[r]));
        let Some(leaves) = leaves(&values, &change, order) else { break };
        let step = values[leaves].max(0.0) / change[leaves];
        stalled = if step > ZERO { 0 } else { stalled + 1 };
        inverse[leaves].iter_mut().for_each(|v| *v /= change[leaves]);
        let pivot = inverse[leaves].clone();
        for (r, row) in inverse.iter_mut().enumerate().filter(|(r, _)| *r != leaves && change[*r] != 0.0) {
            row.iter_mut().zip(&pivot).for_each(|(v, p)| *v -= change[r] * p);
            values[r] -= change[r] * step;
        }
        values[leaves] = step;
        basis[leaves] = enters;
        price.fill(0.0);
        for (row, _) in inverse.iter().zip(&basis).filter(|(_, b)| **b >= columns.len()) {
            price.iter_mut().zip(row).for_each(|(p, v)| *p += v);
        }
    }
    let mut found = vec![0.0; columns.len()];
    for (value, column) in values.iter().zip(&basis) {
        if let Some(x) = found.get_mut(*column) {
            *x = value.max(0.0);
        }
    }
    // What counts is what is left, not what the steps have summed up to.
    let mut rest = right.to_vec();
    for (column, x) in columns.iter().zip(&found) {
        column.iter().for_each(|(r, v)| rest[*r] -= v * x);
    }
    if rest.iter().all(|left| left.abs() <= LEFT) { Ok(found) } else { Err(Infeasible { multipliers: price }) }
}

/// The row whose variable is the first to reach 0, as the others change by so much each. Of those that do so
/// within rounding, the one that changes most, or the first in `order`.
fn leaves<K: Ord>(values: &[f64], change: &[f64], order: impl Fn(usize) -> Option<K>) -> Option<usize> {
    let may = || (0..values.len()).filter(|r| change[*r] > ZERO);
    let step = may().map(|r| (values[r].max(0.0) + ROUNDING) / change[r]).fold(f64::INFINITY, f64::min);
    let first = may().filter(|r| values[*r] <= step * change[*r]);
    first.min_by(|&a, &b| order(a).cmp(&order(b)).then(change[b].total_cmp(&change[a])))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn dense(rows: &[&[f64]]) -> Vec<Column> {
        (0..rows[0].len()).map(|c| rows.iter().enumerate().map(|(r, row)| (r, row[c])).collect()).collect()
    }

    #[test]
    fn small_ones() {
        let columns = dense(&[&[1.0, 1.0], &[-1.0, 1.0]]);
        let Ok(found) = solve(&columns, &[1.0, 0.2]) else { panic!("there is one") };
        assert!((found[0] - 0.4).abs() < 1e-9 && (found[1] - 0.6).abs() < 1e-9, "{found:?}");
        let Err(Infeasible { multipliers: y }) = solve(&columns, &[1.0, 1.1]) else { panic!("there is none") };
        assert!(y[0] - y[1] <= 1e-9 && y[0] + y[1] <= 1e-9 && y[0] + 1.1 * y[1] > 0.0, "{y:?}");
        assert!(solve(&[], &[0.0]).is_ok() && solve(&[], &[1.0]).is_err() && solve(&[], &[]).is_ok());
    }

    /// What was made feasible is found so, and a proof that there is nothing proves it.
    #[test]
    fn found_or_refuted() {
        let mut state = 1_u64;
        let mut draw = || {
            state = state.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
            (state >> 33) as f64 / f64::from(1_u32 << 31) * 2.0 - 1.0
        };
        let mut refuted = 0;
        for round in 0..600 {
            let (rows, count) = (2 + round % 9, 3 + round % 25);
            let columns: Vec<Column> = (0..count).map(|_| (0..rows).map(|r| (r, draw())).collect()).collect();
            let mut right: Vec<f64> = (0..rows).map(|_| draw()).collect();
            if round % 2 == 0 {
                let x: Vec<f64> = (0..count).map(|_| draw().max(0.0)).collect();
                let row = |r: usize| columns.iter().zip(&x).map(|(c, x)| c[r].1 * x).sum();
                right = (0..rows).map(row).collect();
            }
            match solve_by(&columns, &right, [usize::MAX, 0, 3][round % 3]) {
                Ok(x) => assert!(x.iter().all(|v| *v >= 0.0)),
                Err(Infeasible { multipliers: y }) => {
                    refuted += 1;
                    assert!(round % 2 == 1, "{round}");
                    assert!(y.iter().zip(&right).map(|(y, b)| y * b).sum::<f64>() > 1e-8);
                    assert!(columns.iter().all(|c| c.iter().map(|(r, v)| y[*r] * v).sum::<f64>() <= 1e-8));
                }
            }
        }
        assert!((100..250).contains(&refuted), "{refuted}");
    }
}
