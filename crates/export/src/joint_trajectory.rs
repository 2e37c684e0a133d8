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
//! or works the gripper, each command shaped as `control_msgs/GripperCommand`, whose position is the
//! joint's value; `gap` is how far apart the pads then are, metres, for drivers that ask for that:
//!
//! ```json
//! {"name": "1_o3_grasp", "duration": 0.4, "segments": [ … ],
//!  "gripper": [{"joint": "finger_joint", "command": {"position": 0.31, "max_effort": 0.0}, "gap": 0.0497}]}
//! ```
//!
//! A trajectory goes on from one step into the next, for nothing makes the arm rest there; `start`
//! is where on its clock each segment begins. The arm stands still while the gripper works; should a
//! plan move it there, the item has both and they run together. The first item sets the gripper as the plan starts with it, if it has one. A
//! suction hand's items have an empty `gripper`: `grasp` switches it on, `release` off.
//!
//! [`Layout::Whole`] is one trajectory of the arm from the plan's first row to its last.
//!
//! Velocities and accelerations are the central differences of the rows, zero at both ends of a
//! trajectory, where the arm rests (controllers refuse anything else). Rows at 20 ms give
//! velocities that differ from the true ones by the acceleration's change within 20 ms.

use crate::gap::gap;
use crate::kinds::kind_name;
use crate::rows::{Nanoseconds, SECOND, timed_segments};
use crate::sequence::{Item, Point, sequence, trajectory};
use crate::{ExportError, Exporter};
use clearway_plan::PlanFile;
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
        let mut text = serde_json::to_vec_pretty(&value)?;
        text.push(b'\n');
        Ok(text)
    }
}

/// The plan's motion, for a controller.
pub fn joint_trajectory(plan: &PlanFile, layout: Layout) -> Result<Value, ExportError> {
    let segments = timed_segments(plan)?;
    Ok(match layout {
        Layout::Whole => message(plan, &trajectory(&segments)),
        Layout::Sequence => sequence(&segments).iter().map(|item| entry(plan, item)).collect(),
    })
}

/// One item of the sequence.
fn entry(plan: &PlanFile, item: &Item) -> Value {
    let seconds = |time: Nanoseconds| (time - item.start) as f64 / SECOND as f64;
    let segments = item.segments.iter().map(|s| {
        json!({"step": s.step + 1, "object": s.object, "kind": kind_name(s.segment.kind), "start": seconds(s.start)})
    });
    let mut entry = json!({
        "name": item.name,
        "duration": seconds(item.end),
        "segments": segments.collect::<Vec<_>>(),
    });
    if let Some(gripper) = &item.gripper {
        entry["gripper"] = gripper.iter().map(|&(joint, value)| command(plan, joint, value)).collect();
    }
    if let Some(points) = &item.trajectory {
        entry["trajectory"] = message(plan, points);
    }
    entry
}

fn command(plan: &PlanFile, joint: &str, position: f64) -> Value {
    let mut command = json!({"joint": joint, "command": {"position": position, "max_effort": 0.0}});
    if let Some(gap) = gap(&plan.robot.hand, joint, position) {
        command["gap"] = json!(gap);
    }
    command
}

/// `trajectory_msgs/JointTrajectory`; its stamp of 0 says: from now.
fn message(plan: &PlanFile, points: &[Point]) -> Value {
    let points = points.iter().map(|point| {
        json!({
            "positions": point.positions,
            "velocities": point.velocities,
            "accelerations": point.accelerations,
            "effort": [],
            "time_from_start": stamp(point.time),
        })
    });
    json!({
        "header": {"stamp": stamp(0), "frame_id": plan.scene.frame},
        "joint_names": plan.robot.joints,
        "points": points.collect::<Vec<_>>(),
    })
}

fn stamp(time: Nanoseconds) -> Value {
    json!({"sec": time / SECOND, "nanosec": time % SECOND})
}
