//! MCAP: the plan as a recording that Foxglove opens and ROS 2 plays (`ros2 bag play`).
//!
//! | topic | type | when |
//! |---|---|---|
//! | `/robot_description` | `std_msgs/msg/String`, the plan's URDF | at the start, latched |
//! | `/tf_static` | `tf2_msgs/msg/TFMessage`: the robot in the world, links that never move against each other | at the start, latched |
//! | `/tf` | `tf2_msgs/msg/TFMessage`: all links that the plan moves | every row |
//! | `/joint_states` | `sensor_msgs/msg/JointState`, every joint that can move | every row |
//! | `/trajectory` | `trajectory_msgs/msg/JointTrajectory`, as in `joint_trajectory`'s sequence | as each begins |
//! | `/scene/fixtures` | `visualization_msgs/msg/MarkerArray`: fixtures, places | at the start, latched |
//! | `/scene/objects` | `visualization_msgs/msg/MarkerArray`: all objects | when one moves or is taken, latched |
//! | `/events` | `rcl_interfaces/msg/Log`: steps with their reasons, segments | as each begins |
//!
//! What a topic has to say it says whole, so that a viewer can go to any time knowing but the last
//! message of each. What is held is drawn in the frame of the link that holds it; what is pushed goes
//! with the hand. The record `clearway` is the plan in short, the attachment `plan.json` the plan.
//!
//! The clock is the plan's, [`START`] later, as a time of 0 means "any" to much of ROS. The same plan
//! gives the same bytes. Metres, radians; the world is called as the scene's `frame` says.

mod bag;
mod cdr;
mod messages;
mod objects;
mod postures;
mod shapes;
mod topics;
mod words;

use crate::rows::{Nanoseconds, SECOND, timed_segments};
use crate::urdf::Urdf;
use crate::{ExportError, Exporter, Mesh};
use clearway_plan::PlanFile;
use clearway_plan::plan_file::SegmentKind;
use objects::Objects;
use postures::Postures;
use topics::Topics;

/// The time of the plan's first row, nanoseconds.
pub const START: Nanoseconds = SECOND;

/// See the module.
#[derive(Default)]
pub struct Mcap {
    /// What is in the files that the scene names; shapes whose file is not here are not drawn.
    pub meshes: Vec<Mesh>,
}

impl Exporter for Mcap {
    fn name(&self) -> &'static str {
        "mcap"
    }

    fn extension(&self) -> &'static str {
        "mcap"
    }

    fn export(&self, plan: &PlanFile) -> Result<Vec<u8>, ExportError> {
        mcap(plan, &self.meshes)
    }
}

/// The plan as a file's content.
pub fn mcap(plan: &PlanFile, meshes: &[Mesh]) -> Result<Vec<u8>, ExportError> {
    let segments = timed_segments(plan)?;
    let urdf = Urdf::read(&plan.robot.urdf)?;
    check_frames(plan, &urdf)?;
    let postures = Postures::of(plan, &urdf, &segments)?;
    let mut objects = Objects::of(plan)?;
    let items = crate::sequence::sequence(&segments);

    let mut topics = Topics::new(plan, &urdf, &postures, meshes)?;
    topics.begin()?;
    topics.objects(0, &objects.at)?;
    let mut trajectories = items.iter().filter_map(|item| Some((item.start, item.trajectory.as_ref()?))).peekable();
    let tool = |row: usize| postures.root_from_link(&urdf, &plan.robot.tool, &postures.rows[row]).translation;
    let world_from_root = plan.scene.robot.base.pose();
    let mut row = 0usize;
    for segment in &segments {
        if objects.begin(segment) {
            topics.objects(segment.start, &objects.at)?;
        }
        if segment.index == 0 {
            topics.event(segment.start, words::step(plan, segment.step))?;
        }
        topics.event(segment.start, words::segment(segment))?;
        if let Some((start, points)) = trajectories.next_if(|(start, _)| *start <= segment.start) {
            topics.trajectory(start, points)?;
        }
        let pushes = segment.segment.kind == SegmentKind::Push;
        if pushes {
            // From the row shared with the segment before.
            objects.begin_push(segment, tool(row.saturating_sub(1)));
        }
        for own in segment.own_rows() {
            topics.posture(row)?;
            if pushes && objects.push(segment, own.row, &world_from_root, tool(row)) {
                topics.objects(own.time, &objects.at)?;
            }
            row += 1;
        }
    }
    if objects.end() {
        topics.objects(postures.rows.last().map_or(0, |row| row.time), &objects.at)?;
    }
    topics.finish()
}

/// Every frame has one name, and a name one frame. A root link that is called as the world is the world,
/// if it stands at its zero.
fn check_frames(plan: &PlanFile, urdf: &Urdf) -> Result<(), ExportError> {
    let frame = &plan.scene.frame;
    let same = *frame == urdf.root && plan.scene.robot.base.pose() == clearway_geometry::Pose::IDENTITY;
    if urdf.has_link(frame) && !same {
        return Err(ExportError::FrameTaken { frame: frame.clone() });
    }
    let attached = plan.steps.iter().flat_map(|s| &s.segments).filter_map(|s| s.attached.as_ref());
    for tool in attached.map(|a| &a.tool).chain([&plan.robot.tool]) {
        if !urdf.has_link(tool) {
            return Err(ExportError::malformed("the tool", format!("`{tool}`"), "a link of robot.urdf"));
        }
    }
    Ok(())
}
