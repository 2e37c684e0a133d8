//! Are there x ≥ 0 with A x = b? The first phase of the simplex method, with the basis' inverse at hand.
//!
//! The column that gains most enters; when nothing moves for long, Bland's rule takes over, which
//! cannot go in circles. A yes is checked by putting x in, a no by Farkas: some y has y·a ≤ 0 for
//! every column a and y·b > 0. Where rounding spoilt both, the inverse is made anew, a few times.

/// Entries of A and b are about 1.
pub(super) struct Problem {
    /// Of each column: rows and entries.
    pub columns: Vec<Vec<(usize, f64)>>,
    pub right: Vec<f64>,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Answer {
    Yes,
    No,
    /// It took too long, or rounding got in the way.
    Unknown,
}

/// A x may differ from b by this, and y·b be as small.
const SAME: f64 = 1e-7;
/// Gains, pivots and steps that are as small are none.
const NONE: f64 = 1e-9;
const NO_STEP: f64 = 1e-12;
/// The inverse is made anew this often at most.
const AGAIN: usize = 3;
/// Multiplications, about: some seconds.
const WORK: f64 = 4e9;

pub(super) fn solve(problem: &Problem) -> Answer {
    Simplex::new(problem).run()
}

struct Simplex<'a> {
    problem: &'a Problem,
    /// Row by row.
    inverse: Vec<f64>,
    /// By row, the column; from `columns.len()` on, the artificial ones.
    basis: Vec<usize>,
    value: Vec<f64>,
}

impl<'a> Simplex<'a> {
    fn new(problem: &'a Problem) -> Self {
        let mut simplex = Self { problem, inverse: Vec::new(), basis: Vec::new(), value: Vec::new() };
        simplex.reset();
        simplex
    }

    /// Only artificial columns: of each row its unit vector, with the sign of b.
    fn reset(&mut self) {
        let (rows, right) = (self.rows(), &self.problem.right);
        self.inverse = vec![0.0; rows * rows];
        for (row, b) in right.iter().enumerate() {
            self.inverse[row * rows + row] = if *b < 0.0 { -1.0 } else { 1.0 };
        }
        self.basis = (0..rows).map(|row| self.problem.columns.len() + row).collect();
        self.value = right.iter().map(|b| b.abs()).collect();
    }

    fn rows(&self) -> usize {
        self.problem.right.len()
    }

    fn is_artificial(&self, row: usize) -> bool {
        self.basis[row] >= self.problem.columns.len()
    }

    fn run(&mut self) -> Answer {
        let rows = self.rows();
        let most = (WORK / (rows * rows).max(1) as f64).min(100.0 * rows as f64 + 1e3) as usize;
        let (mut still, mut again) = (0, 0);
        for _ in 0..most {
            let prices = self.prices();
            let bland = still > 2 * rows + 20;
            let step = self.entering(&prices, bland).and_then(|column| {
                let along = self.along(column);
                let row = self.leaving(&along, bland)?;
                let step = self.value[row] / along[row];
                self.pivot(row, column, &along);
                Some(step)
            });
            match step {
                Some(step) => still = if step > NO_STEP { 0 } else { still + 1 },
                None if self.solves() => return Answer::Yes,
                None if self.refutes(&prices) => return Answer::No,
                None if again == AGAIN => return Answer::Unknown,
                None => {
                    again += 1;
                    self.refresh();
                }
            }
        }
        Answer::Unknown
    }

    /// What a unit of each row takes off the sum of the artificial columns' values.
    fn prices(&self) -> Vec<f64> {
        let rows = self.rows();
        let mut prices = vec![0.0; rows];
        for row in (0..rows).filter(|r| self.is_artificial(*r)) {
            prices.iter_mut().zip(&self.inverse[row * rows..]).for_each(|(p, i)| *p += i);
        }
        prices
    }

    fn gain(&self, prices: &[f64], column: usize) -> f64 {
        self.problem.columns[column].iter().map(|(row, a)| prices[*row] * a).sum()
    }

    fn entering(&self, prices: &[f64], bland: bool) -> Option<usize> {
        let gains = (0..self.problem.columns.len()).map(|column| (column, self.gain(prices, column)));
        let mut gains = gains.filter(|(_, gain)| *gain > NONE);
        let found = if bland { gains.next() } else { gains.max_by(|a, b| a.1.total_cmp(&b.1)) };
        found.map(|(column, _)| column)
    }

    /// How the basis' values fall with the column's.
    fn along(&self, column: usize) -> Vec<f64> {
        let entries = &self.problem.columns[column];
        let rows = self.inverse.chunks_exact(self.rows());
        rows.map(|row| entries.iter().map(|(r, a)| row[*r] * a).sum()).collect()
    }

    /// The row that is first at 0. Of several, that with the largest pivot; or Bland's.
    fn leaving(&self, along: &[f64], bland: bool) -> Option<usize> {
        let candidates = || (0..self.rows()).filter(|row| along[*row] > NONE);
        let ratio = |row: usize| self.value[row] / along[row];
        let least = candidates().map(ratio).fold(f64::INFINITY, f64::min);
        let first = candidates().filter(|row| ratio(*row) <= least + NO_STEP);
        if bland {
            first.min_by_key(|row| self.basis[*row])
        } else {
            first.max_by(|a, b| along[*a].total_cmp(&along[*b]))
        }
    }

    fn pivot(&mut self, row: usize, column: usize, along: &[f64]) {
        let rows = self.rows();
        let (before, rest) = self.inverse.split_at_mut(row * rows);
        let (pivoted, after) = rest.split_at_mut(rows);
        pivoted.iter_mut().for_each(|entry| *entry /= along[row]);
        let others = before.chunks_exact_mut(rows).chain(after.chunks_exact_mut(rows));
        let factors = along[..row].iter().chain(&along[row + 1..]);
        for (other, factor) in others.zip(factors).filter(|(_, factor)| **factor != 0.0) {
            other.iter_mut().zip(&*pivoted).for_each(|(entry, p)| *entry -= factor * p);
        }
        let step = self.value[row] / along[row];
        for (value, factor) in self.value.iter_mut().zip(along) {
            *value = (*value - factor * step).max(0.0);
        }
        self.value[row] = step;
        self.basis[row] = column;
    }

    /// Whether the values, without the artificial columns', give b.
    fn solves(&self) -> bool {
        let mut left = self.problem.right.clone();
        for row in (0..self.rows()).filter(|r| !self.is_artificial(*r)) {
            for (r, a) in &self.problem.columns[self.basis[row]] {
                left[*r] -= a * self.value[row];
            }
        }
        left.iter().all(|l| l.abs() <= SAME)
    }

    /// By Farkas: no column gains, as `run` has seen, and b would.
    fn refutes(&self, prices: &[f64]) -> bool {
        let no_gain = (0..self.problem.columns.len()).all(|column| self.gain(prices, column) <= NONE);
        no_gain && prices.iter().zip(&self.problem.right).map(|(p, b)| p * b).sum::<f64>() > SAME
    }

    /// The inverse and the values again, from the columns of the basis.
    fn refresh(&mut self) {
        let columns: Vec<usize> = self.basis.iter().copied().filter(|c| *c < self.problem.columns.len()).collect();
        self.reset();
        for column in columns {
            let along = self.along(column);
            let free = (0..self.rows()).filter(|row| self.is_artificial(*row) && along[*row].abs() > NONE);
            if let Some(row) = free.max_by(|a, b| along[*a].abs().total_cmp(&along[*b].abs())) {
                self.pivot(row, column, &along);
            }
        }
        let right = &self.problem.right;
        let values = self.inverse.chunks_exact(right.len());
        self.value = values.map(|row| row.iter().zip(right).map(|(i, b)| i * b).sum::<f64>().max(0.0)).collect();
    }
}

#[cfg(test)]
mod tests;
