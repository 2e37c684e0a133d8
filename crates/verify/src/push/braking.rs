//! The object stops with the hand only if friction can brake it as hard: the tool's deceleration stays
//! below µ·g while it moves.
//!
//! Divided differences of rows, as for joints (see [`limits`](crate::limits)), across the border to what
//! follows the push, too; at the plan's end the robot is at rest. A hand that then goes back has left the
//! object where it stopped: only its coming to rest counts.

use super::{Line, MOVES, Push, Row, exceeds};
use crate::report::Report;

/// m/s².
const GRAVITY: f64 = 9.81;
/// For rows in the eighth digit, over 0.02 s²; m/s².
const SLACK: f64 = 0.01;

pub(super) fn check(push: &Push, rows: &[Row], line: &Line, ways: &[f64], friction: f64, report: &mut Report) {
    let most = friction * GRAVITY + SLACK;
    let mut worst: Option<(usize, f64)> = None;
    // Seconds, velocity, and whether the object moves, over each interval.
    let mut intervals: Vec<(f64, f64, bool)> = Vec::new();
    let mut ends: Vec<usize> = Vec::new();
    for i in 1..rows.len() {
        let seconds = rows[i].place.time - rows[i - 1].place.time;
        if seconds > 0.0 {
            let way = (rows[i].moved - rows[i - 1].moved).dot(line.direction);
            intervals.push((seconds, way / seconds, ways[i] > ways[i - 1] + MOVES));
            ends.push(i);
        }
    }
    let last = intervals.last().map_or(0.0, |i| i.0);
    intervals.push(after(push, rows, line).unwrap_or((last, 0.0, false)));
    for (pair, end) in intervals.windows(2).zip(ends) {
        let braking = 2.0 * (pair[0].1 - pair[1].1) / (pair[0].0 + pair[1].0);
        if pair[0].2 && exceeds(braking, most) && worst.is_none_or(|(_, w)| braking > w) {
            worst = Some((end, braking));
        }
    }
    if let Some((row, braking)) = worst {
        let what = format!(
            "the hand brakes at {braking:.2} m/s²; {} stops with it only below {:.2} m/s²",
            push.id(),
            friction * GRAVITY
        );
        push.fault(rows[row].place, what, report);
    }
}

/// The first interval after the push.
fn after(push: &Push, rows: &[Row], line: &Line) -> Option<(f64, f64, bool)> {
    let tool = push.case.model.link(&push.plan.robot.tool)?;
    let next = push.tracks.get(rows.last()?.track + 1)?;
    let [from, to] = next.postures.get(..2)? else { return None };
    let seconds = next.segment.times[1] - next.segment.times[0];
    let at = |posture: &[f64]| push.case.link_poses(posture)[tool].translation;
    (seconds > 0.0).then(|| (seconds, ((at(to) - at(from)).dot(line.direction) / seconds).max(0.0), false))
}
