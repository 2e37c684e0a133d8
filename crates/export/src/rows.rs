//! The plan as rows on one clock. Where a segment ends and the next begins is one instant and one
//! row: the earlier segment's last.

use crate::ExportError;
use crate::kinds::status_name;
use clearway_plan::PlanFile;
use clearway_plan::plan_file::{GripperValue, Segment};
use std::collections::{BTreeMap, BTreeSet};

/// Nanoseconds: what other programs keep time in.
pub(crate) type Nanoseconds = u64;

pub(crate) const SECOND: Nanoseconds = 1_000_000_000;

/// Plans end before this: ROS counts seconds in 32 bits.
const LONGEST: Nanoseconds = 2_000_000_000 * SECOND;

/// A segment of the plan and its rows on the plan's clock.
pub(crate) struct TimedSegment<'a> {
    /// Counted from 0.
    pub step: usize,
    /// Counted from 0, within the step.
    pub index: usize,
    pub object: &'a str,
    pub segment: &'a Segment,
    /// When its first row is; the instant of the previous segment's last row.
    pub start: Nanoseconds,
    /// All its rows, the one shared with the previous segment included.
    pub rows: Vec<TimedRow<'a>>,
}

pub(crate) struct TimedRow<'a> {
    pub time: Nanoseconds,
    pub positions: &'a [f64],
    /// Which row of the segment, for gripper values given by row.
    pub row: usize,
}

impl TimedSegment<'_> {
    /// The rows that no earlier segment has: all of the plan's first, all but the first elsewhere.
    pub(crate) fn own_rows(&self) -> &[TimedRow<'_>] {
        let shared = usize::from(self.step > 0 || self.index > 0).min(self.rows.len());
        &self.rows[shared..]
    }

    /// The gripper joint's value in a row, if the segment gives it.
    pub(crate) fn gripper(&self, joint: &str, row: usize) -> Option<f64> {
        match self.segment.gripper.get(joint)? {
            GripperValue::Held(value) => Some(*value),
            GripperValue::Rows(values) => values.get(row).copied(),
        }
    }

    /// What the gripper is at when the segment ends.
    pub(crate) fn gripper_at_end(&self) -> BTreeMap<&str, f64> {
        let last = self.rows.len().saturating_sub(1);
        self.segment.gripper.keys().filter_map(|j| Some((j.as_str(), self.gripper(j, last)?))).collect()
    }
}

/// Every joint that some segment moves the gripper by, in alphabetical order.
pub(crate) fn gripper_joints(plan: &PlanFile) -> Vec<&str> {
    let segments = plan.steps.iter().flat_map(|step| &step.segments);
    segments.flat_map(|s| s.gripper.keys().map(String::as_str)).collect::<BTreeSet<_>>().into_iter().collect()
}

/// All segments in order, checked: at least one row each, as many columns as joints, finite
/// numbers, times from 0 that rise by a nanosecond at least.
pub(crate) fn timed_segments(plan: &PlanFile) -> Result<Vec<TimedSegment<'_>>, ExportError> {
    let mut clock = 0;
    let mut timed = Vec::new();
    for (step, content) in plan.steps.iter().enumerate() {
        for (index, segment) in content.segments.iter().enumerate() {
            let place = format!("steps[{step}].segments[{index}]");
            let rows = timed_rows(segment, plan.robot.joints.len(), clock, &place)?;
            let start = clock;
            clock = rows.last().map_or(clock, |row| row.time);
            timed.push(TimedSegment { step, index, object: &content.object, segment, start, rows });
        }
    }
    if timed.is_empty() {
        return Err(ExportError::NoMotion { status: status_name(plan.status) });
    }
    Ok(timed)
}

fn timed_rows<'a>(
    segment: &'a Segment,
    joints: usize,
    start: Nanoseconds,
    place: &str,
) -> Result<Vec<TimedRow<'a>>, ExportError> {
    let (times, positions) = (&segment.times, &segment.positions);
    if times.is_empty() {
        return Err(ExportError::malformed(format!("{place}.times"), "no rows", "at least one"));
    }
    if times.len() != positions.len() {
        return Err(ExportError::malformed(
            format!("{place}.positions"),
            format!("{} rows", positions.len()),
            format!("{}, one per time", times.len()),
        ));
    }
    for (joint, value) in &segment.gripper {
        let at = || format!("{place}.gripper.{joint}");
        let values = match value {
            GripperValue::Held(value) => std::slice::from_ref(value),
            GripperValue::Rows(values) if values.len() != times.len() => {
                return Err(ExportError::malformed(
                    at(),
                    format!("{} values", values.len()),
                    format!("1 or {}", times.len()),
                ));
            }
            GripperValue::Rows(values) => values,
        };
        if let Some(value) = values.iter().find(|value| !value.is_finite()) {
            return Err(ExportError::malformed(at(), value, "a finite number"));
        }
    }
    let mut rows: Vec<TimedRow<'a>> = Vec::with_capacity(times.len());
    for (row, (&time, positions)) in times.iter().zip(positions).enumerate() {
        let at = |list: &str| format!("{place}.{list}[{row}]");
        if positions.len() != joints {
            return Err(ExportError::malformed(
                at("positions"),
                format!("{} numbers", positions.len()),
                format!("{joints}, one per joint"),
            ));
        }
        if let Some(value) = positions.iter().find(|value| !value.is_finite()) {
            return Err(ExportError::malformed(at("positions"), value, "finite numbers"));
        }
        let local = nanoseconds(time).filter(|local| start + local < LONGEST).ok_or_else(|| {
            ExportError::malformed(at("times"), time, "seconds from 0, and a plan that ends within 60 years")
        })?;
        if row == 0 && local != 0 {
            return Err(ExportError::malformed(at("times"), time, 0));
        }
        let time = start + local;
        if rows.last().is_some_and(|before| before.time >= time) {
            return Err(ExportError::malformed(at("times"), times[row], "a later time than the row before's"));
        }
        rows.push(TimedRow { time, positions, row });
    }
    Ok(rows)
}

/// `None` for what is negative, not finite, or beyond any plan.
fn nanoseconds(seconds: f64) -> Option<Nanoseconds> {
    (0.0..LONGEST as f64 / SECOND as f64).contains(&seconds).then(|| (seconds * SECOND as f64).round() as Nanoseconds)
}
