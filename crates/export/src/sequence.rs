//! The plan as a list to be worked off in order: trajectories of the arm, and in between what the
//! gripper does. `joint_trajectory` says what an item means to who works it off.

use crate::differences::differences;
use crate::kinds::kind_name;
use crate::rows::{Nanoseconds, TimedSegment};
use clearway_plan::plan_file::SegmentKind;

/// One gripper action, or consecutive segments without any. Before the first there may be one
/// without segments: the gripper as the plan starts with it.
pub(crate) struct Item<'a> {
    /// `1_o3_transit-approach`; across steps, `1_o3_retreat_2_o8_transit-approach`.
    pub name: String,
    pub start: Nanoseconds,
    pub end: Nanoseconds,
    pub segments: &'a [TimedSegment<'a>],
    /// What the gripper's joints are set to; `None` where the arm alone moves.
    pub gripper: Option<Vec<(&'a str, f64)>>,
    pub trajectory: Option<Vec<Point<'a>>>,
}

/// A row of a trajectory, whose clock starts with it.
pub(crate) struct Point<'a> {
    pub time: Nanoseconds,
    pub positions: &'a [f64],
    pub velocities: Vec<f64>,
    pub accelerations: Vec<f64>,
}

pub(crate) fn sequence<'a>(segments: &'a [TimedSegment<'a>]) -> Vec<Item<'a>> {
    let mut items = Vec::new();
    if let Some(first) = segments.first().filter(|s| !s.segment.gripper.is_empty()) {
        let commands =
            first.segment.gripper.keys().filter_map(|joint| Some((joint.as_str(), first.gripper(joint, 0)?)));
        items.push(Item {
            name: "0_start".to_owned(),
            start: first.start,
            end: first.start,
            segments: &[],
            gripper: Some(commands.collect()),
            trajectory: None,
        });
    }
    let same_run = |a: &TimedSegment, b: &TimedSegment| !works_gripper(a) && !works_gripper(b);
    items.extend(segments.chunk_by(same_run).map(item));
    items
}

fn item<'a>(run: &'a [TimedSegment<'a>]) -> Item<'a> {
    let (first, last) = (&run[0], &run[run.len() - 1]);
    let gripping = works_gripper(first);
    Item {
        name: name(run),
        start: first.start,
        end: last.rows.last().map_or(last.start, |row| row.time),
        segments: run,
        gripper: gripping.then(|| last.gripper_at_end().into_iter().collect()),
        trajectory: (!gripping || moves_arm(run)).then(|| trajectory(run)),
    }
}

/// The rows of consecutive segments, each once.
pub(crate) fn trajectory<'a>(run: &'a [TimedSegment<'a>]) -> Vec<Point<'a>> {
    let start = run.first().map_or(0, |s| s.start);
    let rows: Vec<(Nanoseconds, &[f64])> = run
        .iter()
        .enumerate()
        .flat_map(|(i, s)| s.rows.iter().skip(usize::from(i > 0)))
        .map(|row| (row.time - start, row.positions))
        .collect();
    (0..rows.len())
        .map(|i| {
            let (time, positions) = rows[i];
            let (velocities, accelerations) = differences(&rows, i);
            Point { time, positions, velocities, accelerations }
        })
        .collect()
}

fn name(run: &[TimedSegment]) -> String {
    let of_step = |part: &[TimedSegment]| {
        let kinds: Vec<&str> = part.iter().map(|s| kind_name(s.segment.kind)).collect();
        format!("{}_{}_{}", part[0].step + 1, part[0].object, kinds.join("-"))
    };
    run.chunk_by(|a, b| a.step == b.step).map(of_step).collect::<Vec<_>>().join("_")
}

fn works_gripper(segment: &TimedSegment) -> bool {
    matches!(segment.segment.kind, SegmentKind::Grasp | SegmentKind::Release)
}

/// Whether any joint leaves its place by more than a nanoradian (or nanometre).
fn moves_arm(run: &[TimedSegment]) -> bool {
    let mut rows = run.iter().flat_map(|s| &s.rows);
    let Some(first) = rows.next() else { return false };
    rows.any(|row| row.positions.iter().zip(first.positions).any(|(a, b)| (a - b).abs() > 1e-9))
}
