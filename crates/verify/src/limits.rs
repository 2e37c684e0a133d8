//! Limits of joint position, velocity and acceleration, and that the limits claimed are the URDF's.
//!
//! Velocities are differences of rows; accelerations are differences of velocities over half of
//! both intervals, across segment borders too; before the first row and after the last the robot
//! is at rest. For a motion within its acceleration limit these never exceed it. Tolerance: a
//! thousandth, plus 1e-6 (position, velocity) or 1e-4 (acceleration: rounding of rows over 0.02 s²).

use crate::case::Track;
use crate::model::Model;
use crate::names::Names;
use crate::report::{Place, Report, ViolationKind};
use clearway_plan::PlanFile;

const SLACK: Slack = Slack { relative: 1.001, absolute: 1e-6 };
const ACCELERATION_SLACK: Slack = Slack { relative: 1.001, absolute: 1e-4 };

pub(crate) fn check(plan: &PlanFile, model: &Model, names: &Names, tracks: &[Track], report: &mut Report) {
    let limits = &plan.robot.limits;
    for &joint in &names.columns {
        let data = &model.joints[joint];
        let name = data.name.as_str();
        positions(model, joint, tracks, report);
        let speeds = speeds(joint, tracks);
        match limits.velocity.get(name) {
            Some(&limit) if limit.is_finite() && limit > 0.0 => {
                if let Some(urdf) = data.velocity
                    && limit > urdf * SLACK.relative
                {
                    let what = format!("limits.velocity of {name} is {limit}; the URDF allows {urdf}");
                    report.plan(ViolationKind::DeclaredLimit, what);
                }
                worst_by_segment(
                    report,
                    ViolationKind::VelocityLimit,
                    speeds.iter().map(|s| (s.place, s.velocity.abs())),
                    limit,
                    SLACK,
                    |v| format!("{name} moves at {v:.4}/s; its limit is {limit}/s"),
                );
            }
            other => report.plan(
                ViolationKind::DeclaredLimit,
                format!("limits.velocity of {name} is {other:?}; expected a positive number"),
            ),
        }
        match limits.acceleration.get(name) {
            Some(&limit) if limit.is_finite() && limit > 0.0 => {
                worst_by_segment(
                    report,
                    ViolationKind::AccelerationLimit,
                    accelerations(&speeds).into_iter(),
                    limit,
                    ACCELERATION_SLACK,
                    |a| format!("{name} accelerates at {a:.4}/s²; its limit is {limit}/s²"),
                );
            }
            other => report.plan(
                ViolationKind::DeclaredLimit,
                format!("limits.acceleration of {name} is {other:?}; expected a positive number"),
            ),
        }
    }
}

fn positions(model: &Model, joint: usize, tracks: &[Track], report: &mut Report) {
    let Some((low, high)) = model.joints[joint].range else { return };
    for track in tracks {
        let outside = |row: &Vec<f64>| !(low - SLACK.absolute..=high + SLACK.absolute).contains(&row[joint]);
        if let Some(row) = track.postures.iter().position(outside) {
            let what = format!(
                "{} at {:.5}; its limits are {low} to {high}",
                model.joints[joint].name, track.postures[row][joint]
            );
            report.at(ViolationKind::PositionLimit, track.at(row), what);
        }
    }
}

/// A joint's mean velocity over one interval.
pub(crate) struct Speed {
    /// The row at the interval's end.
    pub place: Place,
    pub seconds: f64,
    pub velocity: f64,
}

/// Intervals whose time does not rise are left out: they are reported as such.
pub(crate) fn speeds(joint: usize, tracks: &[Track]) -> Vec<Speed> {
    let of_track = |track: &Track| {
        (1..track.postures.len())
            .filter_map(|row| {
                let seconds = track.segment.times[row] - track.segment.times[row - 1];
                let velocity = (track.postures[row][joint] - track.postures[row - 1][joint]) / seconds;
                (seconds > 0.0).then(|| Speed { place: track.at(row), seconds, velocity })
            })
            .collect::<Vec<_>>()
    };
    tracks.iter().flat_map(of_track).collect()
}

fn accelerations(speeds: &[Speed]) -> Vec<(Place, f64)> {
    let (Some(first), Some(last)) = (speeds.first(), speeds.last()) else { return Vec::new() };
    let between = speeds
        .windows(2)
        .map(|w| (w[1].place, 2.0 * (w[1].velocity - w[0].velocity).abs() / (w[0].seconds + w[1].seconds)));
    std::iter::once((first.place, 2.0 * first.velocity.abs() / first.seconds))
        .chain(between)
        .chain([(last.place, 2.0 * last.velocity.abs() / last.seconds)])
        .collect()
}

/// How far above a limit a value may be.
#[derive(Clone, Copy)]
pub(crate) struct Slack {
    /// Factor.
    pub relative: f64,
    /// Besides.
    pub absolute: f64,
}

/// Reports, for each segment, the value most above the limit.
pub(crate) fn worst_by_segment(
    report: &mut Report,
    kind: ViolationKind,
    values: impl Iterator<Item = (Place, f64)>,
    limit: f64,
    slack: Slack,
    say: impl Fn(f64) -> String,
) {
    let mut worst: Option<(Place, f64)> = None;
    for (place, value) in values.filter(|(_, v)| *v > limit * slack.relative + slack.absolute) {
        match worst {
            Some((at, most)) if (at.step, at.segment) == (place.step, place.segment) => {
                if value > most {
                    worst = Some((place, value));
                }
            }
            _ => {
                if let Some((at, most)) = worst.replace((place, value)) {
                    report.at(kind, at, say(most));
                }
            }
        }
    }
    if let Some((at, most)) = worst {
        report.at(kind, at, say(most));
    }
}
