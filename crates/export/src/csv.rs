//! Comma-separated values: one row per sample, for spreadsheets and data frames.
//!
//! The header is `time,step,segment,kind,object,attached`, the joints, the gripper's joints. Steps
//! and their segments count from 1; `attached` is what the hand holds, or empty. Names are quoted
//! as RFC 4180 asks; lines end in a line feed. Positions are written in full, so that they read
//! back bit for bit; times to the nanosecond. Where one segment ends and the next begins is one
//! row, the earlier segment's last.

use crate::kinds::kind_name;
use crate::rows::{Nanoseconds, SECOND, gripper_joints, timed_segments};
use crate::{ExportError, Exporter};
use clearway_plan::PlanFile;

/// See the module.
pub struct Csv;

impl Exporter for Csv {
    fn name(&self) -> &'static str {
        "csv"
    }

    fn extension(&self) -> &'static str {
        "csv"
    }

    fn export(&self, plan: &PlanFile) -> Result<Vec<u8>, ExportError> {
        csv(plan).map(String::into_bytes)
    }
}

/// The whole plan as one table.
pub fn csv(plan: &PlanFile) -> Result<String, ExportError> {
    let grippers = gripper_joints(plan);
    let mut table = String::new();
    let joints = plan.robot.joints.iter().map(String::as_str);
    let fixed = ["time", "step", "segment", "kind", "object", "attached"];
    push_line(&mut table, fixed.into_iter().chain(joints).chain(grippers.iter().copied()).map(quoted));

    for segment in timed_segments(plan)? {
        let attached = segment.segment.attached.as_ref().map_or("", |a| a.object.as_str());
        for row in segment.own_rows() {
            let place = [
                seconds(row.time),
                (segment.step + 1).to_string(),
                (segment.index + 1).to_string(),
                kind_name(segment.segment.kind).to_owned(),
                quoted(segment.object),
                quoted(attached),
            ];
            let positions = row.positions.iter().map(f64::to_string);
            let gripper = grippers.iter().map(|j| segment.gripper(j, row.row).map_or(String::new(), |v| v.to_string()));
            push_line(&mut table, place.into_iter().chain(positions).chain(gripper));
        }
    }
    Ok(table)
}

fn push_line(table: &mut String, fields: impl Iterator<Item = String>) {
    for (i, field) in fields.enumerate() {
        if i > 0 {
            table.push(',');
        }
        table.push_str(&field);
    }
    table.push('\n');
}

/// RFC 4180: a field with a comma, a quote or a line break stands in quotes, its quotes doubled.
fn quoted(field: &str) -> String {
    if field.contains([',', '"', '\n', '\r']) {
        format!("\"{}\"", field.replace('"', "\"\""))
    } else {
        field.to_owned()
    }
}

/// Exact, without trailing zeros.
fn seconds(time: Nanoseconds) -> String {
    let text = format!("{}.{:09}", time / SECOND, time % SECOND);
    text.trim_end_matches('0').trim_end_matches('.').to_owned()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn times_are_exact_and_short() {
        assert_eq!([0, 20_000_000, SECOND, 1_500_000_001].map(seconds), ["0", "0.02", "1", "1.500000001"]);
    }

    #[test]
    fn quotes_only_what_needs_them() {
        assert_eq!([" o1", "a,b", "a\"b", "a\r\nb"].map(quoted), [" o1", "\"a,b\"", "\"a\"\"b\"", "\"a\r\nb\""]);
    }
}
