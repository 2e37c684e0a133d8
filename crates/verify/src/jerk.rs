//! Limits of jerk, where a plan claims any.
//!
//! Jerks are third divided differences of rows times six, across segment borders too: weighted means
//! of the jerk of any motion through the rows. Before the first row and after the last the robot is
//! at rest: both count three times, so that a jump of the acceleration there is seen. For a motion
//! within its jerk limit these never exceed it. Tolerance: a hundredth, plus 0.05 (rounding of rows
//! in the eighth digit, over 0.02 s cubed).

use crate::case::Track;
use crate::limits::{Slack, Speed, speeds, worst_by_segment};
use crate::model::Model;
use crate::names::Names;
use crate::report::{Place, Report, ViolationKind};
use clearway_plan::PlanFile;

const SLACK: Slack = Slack { relative: 1.01, absolute: 0.05 };

pub(crate) fn check(plan: &PlanFile, model: &Model, names: &Names, tracks: &[Track], report: &mut Report) {
    let Some(limits) = &plan.robot.limits.jerk else { return };
    for &joint in &names.columns {
        let name = model.joints[joint].name.as_str();
        match limits.get(name) {
            Some(&limit) if limit.is_finite() && limit > 0.0 => worst_by_segment(
                report,
                ViolationKind::JerkLimit,
                jerks(&speeds(joint, tracks)).into_iter(),
                limit,
                SLACK,
                |j| format!("{name} has a jerk of {j:.3}/s³; its limit is {limit}/s³"),
            ),
            other => report.plan(
                ViolationKind::DeclaredLimit,
                format!("limits.jerk of {name} is {other:?}; expected a positive number"),
            ),
        }
    }
}

fn jerks(speeds: &[Speed]) -> Vec<(Place, f64)> {
    let (Some(first), Some(last)) = (speeds.first(), speeds.last()) else { return Vec::new() };
    // At rest for no time at all, twice, at either end.
    let rest = |place: Place| [(place, 0.0, 0.0); 2];
    let moving = speeds.iter().map(|s| (s.place, s.seconds, s.velocity));
    let all: Vec<(Place, f64, f64)> = rest(first.place).into_iter().chain(moving).chain(rest(last.place)).collect();
    let over = |change: f64, seconds: f64| if seconds > 0.0 { change / seconds } else { 0.0 };
    let second: Vec<f64> = all.windows(2).map(|w| over(w[1].2 - w[0].2, w[0].1 + w[1].1)).collect();
    let third = |i: usize| over(second[i + 1] - second[i], all[i].1 + all[i + 1].1 + all[i + 2].1);
    (0..second.len() - 1).map(|i| (all[i + 1].0, 6.0 * third(i).abs())).collect()
}
