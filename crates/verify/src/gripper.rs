//! Structure, gripper: given throughout, within its limits, continuous, and changing only in
//! `grasp` and `release`, no faster than the URDF allows.

use crate::case::Track;
use crate::model::Model;
use crate::names::Names;
use crate::report::{Report, ViolationKind};
use clearway_plan::plan_file::SegmentKind;

/// Radians or metres: below this the gripper does not change.
const SAME: f64 = 1e-6;

pub(crate) fn check(model: &Model, names: &Names, tracks: &[Track], report: &mut Report) {
    for &joint in &names.gripper {
        let data = &model.joints[joint];
        let name = &data.name;
        let mut last: Option<f64> = None;
        for track in tracks {
            let value = |row: usize| track.postures[row][joint];
            if !track.segment.gripper.contains_key(name) {
                report.at(ViolationKind::Gripper, track.place(), format!("does not say where the gripper's {name} is"));
            }
            if let Some(end) = last
                && (value(0) - end).abs() > SAME
            {
                report.at(
                    ViolationKind::Gripper,
                    track.at(0),
                    format!("{name} jumps from {end:.4} to {:.4} between segments", value(0)),
                );
            }
            let rows = track.postures.len();
            let may_change = matches!(track.segment.kind, SegmentKind::Grasp | SegmentKind::Release);
            if !may_change && let Some(row) = (1..rows).find(|r| (value(*r) - value(0)).abs() > SAME) {
                let what = format!(
                    "{name} changes from {:.4} to {:.4}; only grasp and release may change it",
                    value(0),
                    value(row)
                );
                report.at(ViolationKind::Gripper, track.at(row), what);
            }
            if let Some((low, high)) = data.range
                && let Some(row) = (0..rows).find(|r| !(low - SAME..=high + SAME).contains(&value(*r)))
            {
                report.at(
                    ViolationKind::Gripper,
                    track.at(row),
                    format!("{name} at {:.4}; its limits are {low} to {high}", value(row)),
                );
            }
            let speed = |row: usize| {
                let apart = track.segment.times[row] - track.segment.times[row - 1];
                if apart > 0.0 { (value(row) - value(row - 1)).abs() / apart } else { 0.0 }
            };
            if let Some(limit) = data.velocity
                && let Some(row) = (1..rows).find(|r| speed(*r) > limit * 1.001 + 1e-6)
            {
                report.at(
                    ViolationKind::Gripper,
                    track.at(row),
                    format!("{name} moves at {:.3}/s; the URDF allows {limit}/s", speed(row)),
                );
            }
            last = Some(value(rows - 1));
        }
    }
}
