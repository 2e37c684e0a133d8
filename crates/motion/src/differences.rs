//! By how much a motion would have to be slowed down so that its rows keep to the limits.
//!
//! Divided differences of rows are weighted means of the derivatives of any motion through them, so
//! a motion within its limits has rows within them. At rest before and after: both ends count three
//! times, with derivatives of zero.

use crate::{Limits, Posture};

/// For each row the factor by which times about it have to be stretched for velocity, acceleration
/// and jerk to hold: 1 or less where they do. `times` rise.
pub fn slowdowns(times: &[f64], rows: &[Posture], limits: &Limits) -> Vec<f64> {
    let (Some(first), Some(last)) = (times.first(), times.last()) else { return Vec::new() };
    let mut t = vec![*first; 2];
    t.extend(times);
    t.extend([*last; 2]);
    let per = |span: usize| -> Vec<f64> {
        (0..t.len() - span).map(|i| if t[i + span] > t[i] { 1.0 / (t[i + span] - t[i]) } else { 0.0 }).collect()
    };
    let (one, two, three) = (per(1), per(2), per(3));
    let row = |i: usize| i.saturating_sub(2).min(rows.len() - 1);
    // By difference: the largest part of the limit that any joint uses.
    let (mut v, mut a, mut j) = (vec![0.0f64; one.len()], vec![0.0f64; two.len()], vec![0.0f64; three.len()]);
    for joint in 0..rows[0].len() {
        let (by_v, by_a, by_j) =
            (1.0 / limits.velocity[joint], 2.0 / limits.acceleration[joint], 6.0 / limits.jerk[joint]);
        let (mut last_v, mut last_a) = (0.0, 0.0);
        for i in 0..one.len() {
            let difference = (rows[row(i + 1)][joint] - rows[row(i)][joint]) * one[i];
            v[i] = v[i].max(difference.abs() * by_v);
            if i >= 1 {
                let second = (difference - last_v) * two[i - 1];
                a[i - 1] = a[i - 1].max(second.abs() * by_a);
                if i >= 2 {
                    j[i - 2] = j[i - 2].max((second - last_a).abs() * three[i - 2] * by_j);
                }
                last_a = second;
            }
            last_v = difference;
        }
    }
    let mut all = vec![0.0f64; rows.len()];
    let mut note = |at: usize, factor: f64| all[row(at)] = all[row(at)].max(factor);
    for i in 0..one.len() {
        for at in [i, i + 1] {
            note(at, v[i]);
        }
    }
    for i in 0..two.len() {
        note(i + 1, a[i].sqrt());
    }
    for i in 0..three.len() {
        for at in [i + 1, i + 2] {
            note(at, j[i].cbrt());
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
        let rows: Vec<Posture> = times.iter().map(|t| vec![position(*t)]).collect();
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
