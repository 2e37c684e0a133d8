//! Velocities and accelerations of rows, which give positions alone.

use crate::rows::{Nanoseconds, SECOND};

/// Per second and second², at row `i`: of the parabola through it and its neighbours, which is the
/// central difference where rows are evenly spaced. Zero at the ends, where all is at rest.
pub(crate) fn differences(rows: &[(Nanoseconds, &[f64])], i: usize) -> (Vec<f64>, Vec<f64>) {
    let (_, here) = rows[i];
    if i == 0 || i + 1 == rows.len() {
        return (vec![0.0; here.len()], vec![0.0; here.len()]);
    }
    let seconds = |from: usize, to: usize| (rows[to].0 - rows[from].0) as f64 / SECOND as f64;
    let (before, after) = (seconds(i - 1, i), seconds(i, i + 1));
    (0..here.len())
        .map(|joint| {
            let (arriving, leaving) =
                ((here[joint] - rows[i - 1].1[joint]) / before, (rows[i + 1].1[joint] - here[joint]) / after);
            let velocity = (arriving * after + leaving * before) / (before + after);
            (velocity, 2.0 * (leaving - arriving) / (before + after))
        })
        .unzip()
}
