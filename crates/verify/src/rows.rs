//! Structure, rows: widths, finite numbers, times, the start, and that segments join up.

use crate::case::Track;
use crate::model::Model;
use crate::names::Names;
use crate::report::{Place, Report, ViolationKind};
use clearway_plan::PlanFile;
use clearway_plan::plan_file::{GripperValue, Segment};

/// Rows are at most this many seconds apart.
const MOST_APART: f64 = 0.02 + 1e-9;
/// How exactly segments join, radians or metres.
const SAME: f64 = 1e-6;

/// Every segment as a track; `None` when a row cannot be read as a posture.
pub(crate) fn tracks<'a>(
    plan: &'a PlanFile,
    model: &Model,
    names: &Names,
    report: &mut Report,
) -> Option<Vec<Track<'a>>> {
    let before = report.violations.len();
    let mut start = 0.0;
    let mut tracks: Vec<Track> = Vec::new();
    let mut posture = names.fixed.clone();
    for (step_index, step) in plan.steps.iter().enumerate() {
        for (index, segment) in step.segments.iter().enumerate() {
            if let Err(what) = readable(segment, names.columns.len()) {
                report.at(ViolationKind::Rows, Place::segment(step_index, index, start), what);
                continue;
            }
            let mut postures = Vec::with_capacity(segment.positions.len());
            for (row, positions) in segment.positions.iter().enumerate() {
                for (joint, value) in names.columns.iter().zip(positions) {
                    posture[*joint] = *value;
                }
                for joint in &names.gripper {
                    match segment.gripper.get(&model.joints[*joint].name) {
                        Some(GripperValue::Held(value)) => posture[*joint] = *value,
                        Some(GripperValue::Rows(values)) => posture[*joint] = values[row],
                        None => {} // stays where it was; `gripper` reports it
                    }
                }
                model.follow(&mut posture);
                postures.push(posture.clone());
            }
            tracks.push(Track { step: step_index, index, segment, start, postures });
            start += segment.times.last().copied().unwrap_or(0.0).max(0.0);
        }
    }
    (report.violations.len() == before && !tracks.is_empty()).then_some(tracks)
}

fn readable(segment: &Segment, width: usize) -> Result<(), String> {
    if segment.times.is_empty() || segment.times.len() != segment.positions.len() {
        return Err(format!(
            "{} times and {} rows; expected as many, and at least one",
            segment.times.len(),
            segment.positions.len()
        ));
    }
    if let Some((i, row)) = segment.positions.iter().enumerate().find(|(_, row)| row.len() != width) {
        return Err(format!("row {i} has {} numbers; expected one for each of {width} joints", row.len()));
    }
    if segment.times.iter().chain(segment.positions.iter().flatten()).any(|v| !v.is_finite()) {
        return Err("a number that is not finite".to_owned());
    }
    for (name, value) in &segment.gripper {
        let (count, finite) = match value {
            GripperValue::Held(v) => (segment.times.len(), v.is_finite()),
            GripperValue::Rows(v) => (v.len(), v.iter().all(|v| v.is_finite())),
        };
        if count != segment.times.len() || !finite {
            return Err(format!(
                "gripper {name}: {count} values; expected one finite number, or one for each of {} rows",
                segment.times.len()
            ));
        }
    }
    Ok(())
}

pub(crate) fn check(plan: &PlanFile, model: &Model, names: &Names, tracks: &[Track], report: &mut Report) {
    for track in tracks {
        times(track, report);
    }
    if let Some(first) = tracks.first() {
        start(plan, model, names, first, report);
    }
    for pair in tracks.windows(2) {
        let [last, next] = pair else { continue };
        let (Some(end), Some(begin)) = (last.postures.last(), next.postures.first()) else { continue };
        for joint in &names.columns {
            let jump = (begin[*joint] - end[*joint]).abs();
            if jump > SAME {
                let name = &model.joints[*joint].name;
                let what =
                    format!("{name} starts at {:.6}, {jump:.6} from where the last segment ended", begin[*joint]);
                report.at(ViolationKind::Continuity, next.at(0), what);
            }
        }
    }
}

fn times(track: &Track, report: &mut Report) {
    let times = &track.segment.times;
    if times[0].abs() > 1e-9 {
        report.at(ViolationKind::Times, track.at(0), format!("times start at {} s; expected 0", times[0]));
    }
    if let Some(row) = (1..times.len()).find(|i| times[*i] <= times[i - 1]) {
        report.at(
            ViolationKind::Times,
            track.at(row),
            format!("the time goes from {} s to {} s; expected it to rise", times[row - 1], times[row]),
        );
    }
    if let Some(row) = (1..times.len()).find(|i| times[*i] - times[i - 1] > MOST_APART) {
        let apart = times[row] - times[row - 1];
        report.at(
            ViolationKind::Times,
            track.at(row),
            format!("{apart:.4} s after the row before; expected at most 0.02 s"),
        );
    }
}

fn start(plan: &PlanFile, model: &Model, names: &Names, first: &Track, report: &mut Report) {
    let given = plan.scene.robot.start.as_ref();
    for joint in &names.columns {
        let joint_data = &model.joints[*joint];
        let name = &joint_data.name;
        let rest = joint_data.range.map_or(0.0, |(low, high)| 0.0_f64.clamp(low, high));
        let expected = given.and_then(|s| s.get(name)).or(plan.robot.home.get(name)).copied().unwrap_or(rest);
        let found = first.postures[0][*joint];
        let away = (found - expected).abs();
        if away > SAME || away.is_nan() {
            report.at(
                ViolationKind::Start,
                first.at(0),
                format!("{name} starts at {found:.6}; the robot is at {expected:.6}"),
            );
        }
    }
}
