//! ROS 2: `trajectory_msgs/JointTrajectory` as JSON, with the gripper's commands in between.
//!
//! [`Layout::Sequence`] is a list to be worked off in order. An item either moves the arm
//!
//! ```json
//! {"name": "1_o3_transit-approach", "duration": 3.2,
//!  "segments": [{"step": 1, "object": "o3", "kind": "transit", "start": 0.0}, …],
//!  "trajectory": { … trajectory_msgs/JointTrajectory … }}
//! ```
//!
//! or works the gripper, each command shaped as `control_msgs/GripperCommand` (its position is the
//! joint's value, not the gap):
//!
//! ```json
//! {"name": "1_o3_grasp", "duration": 0.4, "segments": [ … ],
//!  "gripper": [{"joint": "finger_joint", "command": {"position": 0.31, "max_effort": 0.0}}]}
//! ```
//!
//! A trajectory goes on from one step into the next, for nothing makes the arm rest there; `start`
//! is where on its clock each segment begins. The arm stands still while the gripper works; should a plan move it there, the item has both and
//! they run together. The first item sets the gripper as the plan starts with it, if it has one. A
//! suction hand's items have an empty `gripper`: `grasp` switches it on, `release` off.
//!
//! [`Layout::Whole`] is one trajectory of the arm from the plan's first row to its last.
//!
//! Velocities and accelerations are the central differences of the rows, zero at both ends of a
//! trajectory, where the arm rests (controllers refuse anything else). Rows at 20 ms give
//! velocities that differ from the true ones by the acceleration's change within 20 ms.

use crate::csv::kind_name;
use crate::rows::{Nanoseconds, SECOND, TimedSegment, timed_segments};
use crate::{ExportError, Exporter};
use clearway_plan::PlanFile;
use clearway_plan::plan_file::SegmentKind;
use serde_json::{Value, json};

/// How the plan is divided.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Layout {
    /// A trajectory per run of segments between the gripper's actions, these as items of their own.
    #[default]
    Sequence,
    /// The arm's motion as one trajectory, without the gripper.
    Whole,
}

/// See the module.
#[derive(Default)]
pub struct JointTrajectory {
    pub layout: Layout,
}

impl Exporter for JointTrajectory {
    fn name(&self) -> &'static str {
        "joint-trajectory"
    }

    fn extension(&self) -> &'static str {
        "json"
    }

    fn export(&self, plan: &PlanFile) -> Result<Vec<u8>, ExportError> {
        let value = joint_trajectory(plan, self.layout)?;
        let mut text = serde_json::to_vec_pretty(&value).map_err(|e| ExportError::Json(e.to_string()))?;
        text.push(b'\n');
        Ok(text)
    }
}

/// The plan's motion, for a controller.
pub fn joint_trajectory(plan: &PlanFile, layout: Layout) -> Result<Value, ExportError> {
    let segments = timed_segments(plan)?;
    Ok(match layout {
        Layout::Whole => trajectory(plan, &segments),
        Layout::Sequence => sequence(plan, &segments),
    })
}

fn sequence(plan: &PlanFile, segments: &[TimedSegment]) -> Value {
    let mut items = Vec::new();
    if let Some(first) = segments.first().filter(|s| !s.segment.gripper.is_empty()) {
        let commands = first.segment.gripper.keys().filter_map(|joint| Some(command(joint, first.gripper(joint, 0)?)));
        items.push(json!({
            "name": "0_start", "duration": 0.0, "segments": [],
            "gripper": commands.collect::<Vec<_>>(),
        }));
    }
    let same_run = |a: &TimedSegment, b: &TimedSegment| !works_gripper(a) && !works_gripper(b);
    for run in segments.chunk_by(same_run) {
        items.push(item(plan, run));
    }
    Value::Array(items)
}

/// One item of the sequence; `run` is one gripper action, or segments without any.
fn item(plan: &PlanFile, run: &[TimedSegment]) -> Value {
    let (first, last) = (&run[0], &run[run.len() - 1]);
    let end = last.rows.last().map_or(last.start, |row| row.time);
    let seconds = |time: Nanoseconds| (time - first.start) as f64 / SECOND as f64;
    let segments = run.iter().map(|s| {
        json!({"step": s.step + 1, "object": s.object, "kind": kind_name(s.segment.kind), "start": seconds(s.start)})
    });
    let mut item = json!({
        "name": name(run),
        "duration": seconds(end),
        "segments": segments.collect::<Vec<_>>(),
    });
    if works_gripper(first) {
        item["gripper"] = last.gripper_at_end().into_iter().map(|(joint, value)| command(joint, value)).collect();
    }
    if !works_gripper(first) || moves_arm(run) {
        item["trajectory"] = trajectory(plan, run);
    }
    item
}

/// `1_o3_transit-approach`; across steps, `1_o3_retreat_2_o8_transit-approach`.
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

fn command(joint: &str, position: f64) -> Value {
    json!({"joint": joint, "command": {"position": position, "max_effort": 0.0}})
}

/// `trajectory_msgs/JointTrajectory` of consecutive segments; its clock starts with them.
fn trajectory(plan: &PlanFile, run: &[TimedSegment]) -> Value {
    let start = run.first().map_or(0, |s| s.start);
    let rows: Vec<(Nanoseconds, &[f64])> = run
        .iter()
        .enumerate()
        .flat_map(|(i, s)| s.rows.iter().skip(usize::from(i > 0)))
        .map(|row| (row.time - start, row.positions))
        .collect();
    let points: Vec<Value> = (0..rows.len())
        .map(|i| {
            let (time, positions) = rows[i];
            let (velocities, accelerations) = differences(&rows, i);
            json!({
                "positions": positions,
                "velocities": velocities,
                "accelerations": accelerations,
                "effort": [],
                "time_from_start": stamp(time),
            })
        })
        .collect();
    json!({
        "header": {"stamp": stamp(0), "frame_id": plan.scene.frame},
        "joint_names": plan.robot.joints,
        "points": points,
    })
}

/// Velocities and accelerations at row `i`: of the parabola through it and its neighbours, which
/// is the central difference where rows are evenly spaced. Zero at the ends.
fn differences(rows: &[(Nanoseconds, &[f64])], i: usize) -> (Vec<f64>, Vec<f64>) {
    let (_, here) = rows[i];
    if i == 0 || i + 1 == rows.len() {
        return (vec![0.0; here.len()], vec![0.0; here.len()]);
    }
    let seconds = |from: usize, to: usize| (rows[to].0 - rows[from].0) as f64 / SECOND as f64;
    let (before, after) = (seconds(i - 1, i), seconds(i, i + 1));
    (0..here.len())
        .map(|joint| {
            let (arriving, leaving) =
                ((here[joint] - rows[i - 1].1[joint]) / before, (rows[i + 1].1[joint] - here[joint]) / after);
            let velocity = (arriving * after + leaving * before) / (before + after);
            (velocity, 2.0 * (leaving - arriving) / (before + after))
        })
        .unzip()
}

fn stamp(time: Nanoseconds) -> Value {
    json!({"sec": time / SECOND, "nanosec": time % SECOND})
}
