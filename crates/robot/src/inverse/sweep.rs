//! The redundant joint of a closed form, swept over its range; and out of the many postures a few
//! that differ.

use super::Posture;
use super::spherical_shoulder::SphericalShoulder;
use clearway_geometry::Pose;
use std::f64::consts::PI;

/// Values of the swept joint that are tried.
const VALUES: usize = 24;
/// While none of them is of use, as many values between each two.
const FINER: usize = 8;
/// Postures handed on, and how far apart they are at least in some joint, radians.
const MOST: usize = 12;
const APART: f64 = 0.3;

/// Postures at values of the swept joint spread over its range, and at `near`'s; failing those, if asked, at
/// the values where `slivers` are.
pub fn solve(
    closed: &SphericalShoulder,
    root_from_tool: &Pose,
    near: &[f64],
    (lower, upper): (&[f64], &[f64]),
    slivers: bool,
) -> Vec<Posture> {
    let swept = closed.swept();
    let (lower, upper) = (lower[swept], upper[swept]);
    let (low, high) = if upper - lower > 2.0 * PI { (-PI, PI) } else { (lower, upper) };
    let mut found = Vec::new();
    let mut at = |value: f64| closed.solve_at(root_from_tool, value, |q| found.push(q.to_vec()));
    if let Some(&value) = near.get(swept).filter(|&&q| (low..=high).contains(&q)) {
        at(value);
    }
    let value = |i: f64| low + (high - low) * i / VALUES as f64;
    for i in 0..VALUES {
        at(value(i as f64 + 0.5));
    }
    if found.is_empty() && slivers {
        for i in 0..VALUES * FINER {
            closed.solve_at(root_from_tool, value((i as f64 + 0.5) / FINER as f64), |q| found.push(q.to_vec()));
        }
    }
    // An elbow that straightens within its limits (PR2's) leaves a sliver round where the way is longest;
    // another may lie at either end of the range. A spherical shoulder's elbow seldom does (a Panda misses
    // hardly one pose in a thousand) and is left with the values above.
    if found.is_empty() && slivers && closed.at_wrist() {
        let extremes = closed.extremes(root_from_tool).map(|q| low + (q - low).rem_euclid(2.0 * PI));
        for value in extremes.into_iter().chain([low, high]).filter(|q| (low..=high).contains(q)) {
            closed.solve_at(root_from_tool, value, |q| found.push(q.to_vec()));
        }
    }
    found
}

/// The posture nearest to `from` (in the joint that moves most) at the value of the swept joint
/// nearest to `from`'s that has one within `reach` in every joint.
pub fn follow(
    closed: &SphericalShoulder,
    root_from_tool: &Pose,
    from: &[f64],
    lower: &[f64],
    upper: &[f64],
    reach: f64,
) -> Option<[f64; 7]> {
    const STEPS: i32 = 8;
    let swept = closed.swept();
    for step in 0..=STEPS {
        let mut best: Option<(f64, [f64; 7])> = None;
        for side in [1.0, -1.0] {
            let value = from[swept] + side * reach * f64::from(step) / f64::from(STEPS);
            if value < lower[swept] || value > upper[swept] {
                continue;
            }
            closed.solve_at(root_from_tool, value, |mut q| {
                for i in 0..7 {
                    q[i] = from[i] + (q[i] - from[i] + PI).rem_euclid(2.0 * PI) - PI;
                }
                let far = apart(&q, from);
                let inside = q.iter().zip(lower).zip(upper).all(|((q, l), u)| q >= l && q <= u);
                if inside && far <= reach && best.is_none_or(|(least, _)| far < least) {
                    best = Some((far, q));
                }
            });
        }
        if let Some((_, q)) = best {
            return Some(q);
        }
    }
    None
}

/// A few of the postures, as different as can be, the one nearest to `near` first.
pub fn spread(mut postures: Vec<Posture>, near: &[f64]) -> Vec<Posture> {
    let nearest = |a: &usize, b: &usize| apart(&postures[*a], near).total_cmp(&apart(&postures[*b], near));
    let Some(first) = (0..postures.len()).min_by(nearest) else { return postures };
    let mut chosen = vec![postures.swap_remove(first)];
    let mut gaps: Vec<f64> = postures.iter().map(|q| apart(q, &chosen[0])).collect();
    while chosen.len() < MOST {
        let Some((i, gap)) = gaps.iter().copied().enumerate().max_by(|a, b| a.1.total_cmp(&b.1)) else { break };
        if gap < APART {
            break;
        }
        gaps.swap_remove(i);
        let next = postures.swap_remove(i);
        for (gap, q) in gaps.iter_mut().zip(&postures) {
            *gap = gap.min(apart(q, &next));
        }
        chosen.push(next);
    }
    chosen
}

/// How far the joint that differs most differs.
fn apart(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max)
}
