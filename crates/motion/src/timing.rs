//! Timing of a curve under velocity, acceleration and jerk limits, from rest to rest.
//!
//! First the time-optimal motion without jerk limits ([`crate::reach`]); if its rows keep to them
//! nonetheless, that is it. Otherwise its mean over a window of time, which has bounded jerk, is
//! taken as a spline ([`crate::law`]) and given the fastest pace that all limits allow
//! ([`crate::pace`]), some rounds of it. Limits are held by the rows themselves ([`crate::rows`]):
//! what is above one somewhere is slowed down there in the next round, and as a whole in the end.

use crate::law::{Eased, Law, Paced, Spline};
use crate::pace::{self, Bounds, Motion};
use crate::rows::{RowMaker, Sampled};
use crate::{Curve, Posture, reach};
use std::ops::Range;

/// Per joint: rad/s, rad/s² and rad/s³ (m/s, m/s², m/s³ for joints that slide); may be infinite.
#[derive(Clone, Debug)]
pub struct Limits {
    pub velocity: Vec<f64>,
    pub acceleration: Vec<f64>,
    pub jerk: Vec<f64>,
}

/// Rows in time; straight lines between them.
#[derive(Clone, Debug, Default)]
pub struct Timed {
    /// Seconds, from 0.
    pub times: Vec<f64>,
    pub positions: Vec<Posture>,
}

impl Timed {
    pub fn duration(&self) -> f64 {
        self.times.last().copied().unwrap_or(0.0)
    }
}

/// Times a curve from rest to rest; rows at most `row` seconds apart. A curve of no length gives
/// no rows.
pub fn time_curve(curve: &Curve, limits: &Limits, row: f64) -> Timed {
    let mut timed = Timed::default();
    for part in curve.parts() {
        append(&mut timed, time_part(curve, part, limits, row));
    }
    if let Some(last) = timed.positions.last_mut() {
        last.copy_from_slice(curve.end());
    }
    timed
}

fn append(timed: &mut Timed, more: Timed) {
    let offset = timed.duration();
    let skip = usize::from(!timed.times.is_empty());
    timed.times.extend(more.times.iter().skip(skip).map(|t| t + offset));
    timed.positions.extend(more.positions.into_iter().skip(skip));
}

/// A slowdown of less is not worth looking for anything better.
const GOOD: f64 = 1.002;
/// A slowdown of less is not worth another round.
const CLOSE: f64 = 1.005;

fn time_part(curve: &Curve, part: Range<usize>, limits: &Limits, row: f64) -> Timed {
    let acceleration = useful_acceleration(curve, part.clone(), limits);
    let profile = reach::fastest(curve, part.clone(), &limits.velocity, &acceleration);
    let maker = RowMaker { curve, part: part.clone(), limits, row };
    let sudden = maker.sample(maker.count(profile.duration()), &profile);
    if sudden.slowdown() <= GOOD {
        return maker.slowed(sudden, &profile);
    }
    // From no acceleration to the largest; no less than rows would show.
    let longest = (0..curve.joints()).map(|j| acceleration[j] / limits.jerk[j]).fold(0.0, f64::max);
    let window = longest.max(row).min(profile.duration());
    let eased = Eased { profile: &profile, window };
    let steps = ((eased.duration() / (STEP * row)).ceil() as usize).clamp(FEWEST, MOST);
    let mut spline = Spline::new(steps, &eased);
    let mut best: Option<(Paced, Sampled)> = None;
    let mut bounds = Bounds { slower: vec![1.0; steps + 1], most: vec![f64::INFINITY; steps + 1] };
    for (round, weights) in ROUNDS.into_iter().enumerate() {
        let x = pace::fastest(&motion(&spline, curve, &part), limits, &bounds, weights);
        let mut paced = Paced::new(spline, x);
        let mut found = maker.sample(maker.count(paced.duration()), &paced);
        let wanted = paced.duration();
        learn(&mut bounds, &found.excess, &paced);
        spline = Spline::new(steps, &paced);
        // What is above limits only here and there is slowed down there; after the first round it is more.
        let touches = if round > 0 { TOUCHES } else { 0 };
        for _ in 0..touches {
            if found.slowdown() < CLOSE {
                break;
            }
            let slower = paced.slowed(&found.excess);
            let again = maker.sample(maker.count(slower.duration()), &slower);
            if again.slowed_duration() >= found.slowed_duration() {
                break;
            }
            (paced, found) = (slower, again);
        }
        let good = found.slowdown() < CLOSE && found.slowed_duration() < LITTLE_LOST * wanted;
        if best.as_ref().is_none_or(|b| found.slowed_duration() < b.1.slowed_duration()) {
            best = Some((paced, found));
        }
        if good {
            break;
        }
    }
    if let Some((paced, found)) =
        best.take_if(|(_, b)| b.slowed_duration() <= sudden.slowed_duration().min(eased.duration()))
    {
        return maker.slowed(found, &paced);
    }
    let plain = maker.sample(maker.count(eased.duration()), &eased);
    let limit = sudden.slowed_duration().min(plain.slowed_duration());
    match best {
        Some((paced, found)) if found.slowed_duration() <= limit => maker.slowed(found, &paced),
        _ if plain.slowed_duration() <= sudden.slowed_duration() => maker.slowed(plain, &eased),
        _ => maker.slowed(sudden, &profile),
    }
}

/// Bounds for the next round, whose nodes are even in this one's time: slower where rows were above a
/// limit, or the step next to it. A little above comes from looking at nodes only, and is left to
/// the constraints there; far above is what the nodes do not see, and there the pace itself is held.
fn learn(bounds: &mut Bounds, excess: &[f64], paced: &Paced) {
    const LITTLE: f64 = 1.08;
    let steps = bounds.most.len() - 1;
    let rows = (excess.len() - 1) as f64;
    let row = |k: f64| (k / steps as f64).clamp(0.0, 1.0) * rows;
    let before = std::mem::take(&mut bounds.most);
    for k in 0..=steps {
        let at = k as f64;
        let above = excess[row(at - 1.0) as usize..=row(at + 1.0).ceil() as usize].iter().copied().fold(1.0, f64::max);
        bounds.slower[k] *= above.min(LITTLE);
        let (step, speed) = paced.pace(at / steps as f64 * paced.duration());
        let known = before[step].min(before[step + 1]) / (speed * speed);
        bounds.most.push(if above > LITTLE { known.min(1.0 / (above * above)) } else { known });
    }
}

/// The barrier's weight in each round: at first, and at last. After the first round the pace is
/// nearly right.
const ROUNDS: [(f64, f64); 5] = [(1.0, 0.002), (0.1, 0.002), (0.1, 0.002), (0.1, 0.002), (0.1, 0.002)];

/// Touching up costs time; where it costs more, another round may do better.
const LITTLE_LOST: f64 = 1.015;

/// How often a pace is touched up.
const TOUCHES: usize = 3;

/// Steps that the pace is chosen at: how long in rows, how few, how many.
const STEP: f64 = 1.25;
const FEWEST: usize = 24;
const MOST: usize = 256;

/// Acceleration that a joint can make use of: from rest to rest over some distance, jerk allows no
/// more than (jerk² · distance / 2)^⅓.
fn useful_acceleration(curve: &Curve, part: Range<usize>, limits: &Limits) -> Vec<f64> {
    let n = curve.joints();
    let mut travel = vec![0.0; n];
    let (mut slope, mut bend) = (vec![0.0; n], vec![0.0; n]);
    for piece in part {
        let (from, to) = (curve.knots()[piece], curve.knots()[piece + 1]);
        for s in [from, to] {
            curve.slope_and_bend(piece, s, &mut slope, &mut bend);
            travel.iter_mut().zip(&slope).for_each(|(t, s)| *t += s.abs() * (to - from) / 2.0);
        }
    }
    (0..n)
        .map(|j| {
            let useful = (limits.jerk[j].powi(2) * travel[j]).cbrt();
            if useful > 0.0 { limits.acceleration[j].min(useful) } else { limits.acceleration[j] }
        })
        .collect()
}

/// The motion of the joints when a spline leads along the curve.
fn motion(spline: &Spline, curve: &Curve, part: &Range<usize>) -> Motion {
    let (n, steps) = (curve.joints(), spline.steps());
    let (mut slope, mut bend) = (vec![0.0; n], vec![0.0; n]);
    let (first, second) = (Vec::with_capacity(n * steps), Vec::with_capacity(n * steps));
    let mut motion = Motion { joints: n, step: spline.step, first, second };
    let mut piece = part.start;
    for k in 0..steps {
        let (s, speed, push) = spline.at(k, 0.5);
        piece = curve.piece_at(s, piece).min(part.end - 1);
        curve.slope_and_bend(piece, s, &mut slope, &mut bend);
        motion.first.extend(slope.iter().map(|q| q * speed));
        motion.second.extend(slope.iter().zip(&bend).map(|(q, c)| c * speed * speed + q * push));
    }
    motion
}
