//! By how much a motion would have to be slowed down so that its rows keep to the limits.
//!
//! Divided differences of rows are weighted means of the derivatives of any motion through them, so
//! a motion within its limits has rows within them. At rest before and after: both ends count three
//! times, with derivatives of zero.

use crate::Limits;

/// For each row the factor by which times about it have to be stretched for velocity, acceleration
/// and jerk to hold: 1 or less where they do. `times` rise; `rows` has a value per joint for each.
pub fn slowdowns(times: &[f64], rows: &[f64], limits: &Limits) -> Vec<f64> {
    let joints = limits.velocity.len();
    let (Some(first), Some(last)) = (times.first(), times.last()) else { return Vec::new() };
    let mut t = vec![*first; 2];
    t.extend(times);
    t.extend([*last; 2]);
    let row = |i: usize| i.saturating_sub(2).min(times.len() - 1);
    let per = |from: usize, span: usize| if t[from + span] > t[from] { 1.0 / (t[from + span] - t[from]) } else { 0.0 };
    let by: Vec<[f64; 3]> =
        (0..joints).map(|j| [1.0 / limits.velocity[j], 2.0 / limits.acceleration[j], 6.0 / limits.jerk[j]]).collect();
    let mut all = vec![0.0f64; times.len()];
    let mut note = |at: usize, factor: f64| all[row(at)] = all[row(at)].max(factor);
    // Of each joint: the differences of first and second order that ended at the row before.
    let mut before = vec![[0.0; 2]; joints];
    for i in 0..t.len() - 1 {
        let [one, two, three] = [1, 2, 3].map(|span| if i + 1 < span { 0.0 } else { per(i + 1 - span, span) });
        let (here, next) = (&rows[row(i) * joints..][..joints], &rows[row(i + 1) * joints..][..joints]);
        // The largest part of the limit that any joint uses.
        let mut used = [0.0f64; 3];
        for (((a, b), last), by) in here.iter().zip(next).zip(&mut before).zip(&by) {
            let first = (b - a) * one;
            let second = (first - last[0]) * two;
            let third = (second - last[1]) * three;
            for ((used, difference), by) in used.iter_mut().zip([first, second, third]).zip(by) {
                *used = used.max(difference.abs() * by);
            }
            *last = [first, second];
        }
        note(i, used[0]);
        note(i + 1, used[0]);
        if i >= 1 {
            note(i, used[1].sqrt());
        }
        if i >= 2 {
            let factor = used[2].cbrt();
            note(i - 1, factor);
            note(i, factor);
        }
    }
    all
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_constant_jerk_is_found_as_it_is() {
        // 1 s of jerk 6, −6, −6, 6 in turn, a quarter second each.
        let position = |t: f64| {
            let ramp = |from: f64| (t - from).max(0.0).powi(3);
            ramp(0.0) - 2.0 * ramp(0.25) + 2.0 * ramp(0.75) - ramp(1.0)
        };
        let times: Vec<f64> = (0..=16).map(|i| i as f64 / 16.0).collect();
        let rows: Vec<f64> = times.iter().map(|t| position(*t)).collect();
        let only = |velocity, acceleration, jerk| Limits {
            velocity: vec![velocity],
            acceleration: vec![acceleration],
            jerk: vec![jerk],
        };
        let far = f64::INFINITY;
        let most = |limits| slowdowns(&times, &rows, &limits).into_iter().fold(0.0, f64::max);
        assert!((most(only(far, far, 6.0)) - 1.0).abs() < 1e-12);
        // Means over a sixteenth of a second fall short of the peaks of 1.5 and 0.375.
        let a = most(only(far, 1.5, far));
        let v = most(only(0.375, far, far));
        assert!(a <= 1.0 && a > 0.95 && v <= 1.0 && v > 0.97, "{a} {v}");
    }
}
