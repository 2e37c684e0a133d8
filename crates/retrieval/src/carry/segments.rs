//! Motions written down as a plan's segments.

use super::Carrier;
use crate::grasps::Grasp;
use clearway_geometry::{Pose, Vec3};
use clearway_motion::{Posture, Timed};
use clearway_plan::ObjectId;
use clearway_plan::plan_file::{Attached, GripperValue, PlacedPose, Segment, SegmentKind};
use clearway_plan::robot_file::HandKind;
use rand::Rng;
use std::collections::BTreeMap;

impl<R: Rng> Carrier<'_, R> {
    /// A motion with an open hand that is no approach and no retreat.
    pub fn transit(&self, timed: Timed) -> Segment {
        let open = self.world.model.robot.hand.open();
        segment(SegmentKind::Transit, self.widened(timed), self.gripper(GripperValue::Held(open)), None)
    }

    /// The base's values before the arm's.
    pub(crate) fn widened(&self, mut timed: Timed) -> Timed {
        if !self.base.is_empty() {
            timed.positions.iter_mut().for_each(|row| *row = self.base.iter().chain(row.iter()).copied().collect());
        }
        timed
    }

    /// To the object, the grasp, and away with it: the rows of `there` are the arm's alone.
    pub(crate) fn taking_segments(&self, object: ObjectId, grasp: &Grasp, there: Timed, across: Vec<Timed>) -> Vec<Segment> {
        let robot = &self.world.model.robot;
        let standoff = robot.grasps.standoff;
        let (open, closed) = (robot.hand.open(), grasp.closed);
        let held = |value: f64| -> BTreeMap<String, GripperValue> { self.gripper(GripperValue::Held(value)) };
        let attached = Attached {
            object: self.scene.names[object.index()].clone(),
            tool: robot.links[robot.hand.frame].name.clone(),
            pose_in_tool: written(&grasp.object_from_tool.inverse()),
        };
        let gripped = there.positions.last().cloned().unwrap_or_default();
        let tool = |q: &Posture| self.world.model.kinematics.tool(q, open).translation;
        let mut segments = Vec::new();
        let begins = there.positions.iter().rposition(|q| tool(q).distance(tool(&gripped)) > standoff);
        let (transit, approach) = split(there, begins);
        segments.extend(transit.map(|t| segment(SegmentKind::Transit, self.widened(t), held(open), None)));
        segments.extend(approach.map(|t| segment(SegmentKind::Approach, self.widened(t), held(open), None)));
        segments.push(self.grip(SegmentKind::Grasp, &gripped, open, closed));
        segments.extend(across.into_iter().map(|t| segment(SegmentKind::Transfer, t, held(closed), Some(attached.clone()))));
        segments
    }

    /// Letting go, and away from it.
    pub(crate) fn leaving_segments(&self, let_go: &Posture, grasp: &Grasp, back: Timed) -> Vec<Segment> {
        let robot = &self.world.model.robot;
        let standoff = robot.grasps.standoff;
        let open = robot.hand.open();
        let tool = |q: &Posture| self.world.model.kinematics.tool(q, open).translation;
        let mut segments = vec![self.grip(SegmentKind::Release, let_go, grasp.closed, open)];
        let ends = back.positions.iter().position(|q| tool(q).distance(tool(let_go)) >= standoff - 1e-6);
        let (retreat, home) = split(back, ends);
        let away = |kind, t| segment(kind, self.widened(t), self.gripper(GripperValue::Held(open)), None);
        segments.extend(retreat.map(|t| away(SegmentKind::Retreat, t)));
        segments.extend(home.map(|t| away(SegmentKind::Transit, t)));
        segments
    }

    /// The arm stands still while the hand's joint goes from one value to another.
    fn grip(&self, kind: SegmentKind, posture: &Posture, from: f64, to: f64) -> Segment {
        let robot = &self.world.model.robot;
        let speed = robot.hand.joint.map_or(f64::INFINITY, |j| robot.joints[j].velocity);
        // A cosine ramp is at its fastest π/2 times its mean.
        let needed = (to - from).abs() / speed * std::f64::consts::FRAC_PI_2 * 1.05;
        let total = needed.max(self.settings.grip_time);
        let count = (total / self.settings.row).ceil() as usize;
        let times: Vec<f64> = (0..=count).map(|i| total * i as f64 / count as f64).collect();
        let ramp = |t: f64| (1.0 - (std::f64::consts::PI * t / total).cos()) / 2.0;
        let mut values: Vec<f64> = times.iter().map(|&t| from + (to - from) * ramp(t)).collect();
        values[0] = from;
        values[count] = to;
        let positions = vec![posture.clone(); times.len()];
        segment(kind, self.widened(Timed { times, positions }), self.gripper(GripperValue::Rows(values)), None)
    }

    pub(crate) fn gripper(&self, value: GripperValue) -> BTreeMap<String, GripperValue> {
        let robot = &self.world.model.robot;
        match (&robot.hand.kind, robot.hand.joint) {
            (HandKind::Parallel, Some(joint)) => BTreeMap::from([(robot.joints[joint].name.clone(), value)]),
            _ => BTreeMap::new(),
        }
    }
}

fn segment(kind: SegmentKind, timed: Timed, gripper: BTreeMap<String, GripperValue>, attached: Option<Attached>) -> Segment {
    Segment { kind, times: timed.times, positions: timed.positions, gripper, attached }
}

/// Parts a motion at a row, which both halves have; a half without motion is `None`.
fn split(timed: Timed, at: Option<usize>) -> (Option<Timed>, Option<Timed>) {
    let Some(at) = at else { return (None, Some(timed)) };
    if at + 1 >= timed.positions.len() {
        return (Some(timed), None);
    }
    let offset = timed.times[at];
    let late = Timed {
        times: timed.times[at..].iter().map(|t| t - offset).collect(),
        positions: timed.positions[at..].to_vec(),
    };
    if at == 0 {
        return (None, Some(late));
    }
    let early = Timed { times: timed.times[..=at].to_vec(), positions: timed.positions[..=at].to_vec() };
    (Some(early), Some(late))
}

pub(crate) fn written(pose: &Pose) -> PlacedPose {
    let p: Vec3 = pose.translation;
    PlacedPose { position: p.to_array(), quaternion: pose.quaternion() }
}
