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
        self.empty_handed(SegmentKind::Transit, timed)
    }

    /// The base's values before the arm's.
    pub(crate) fn widened(&self, mut timed: Timed) -> Timed {
        if !self.base.is_empty() {
            timed.positions.iter_mut().for_each(|row| *row = self.base.iter().chain(row.iter()).copied().collect());
        }
        timed
    }

    /// To the object, the grasp, and away with it: the rows of `there` are the arm's alone.
    pub(crate) fn taking_segments(
        &self,
        object: ObjectId,
        grasp: &Grasp,
        there: Timed,
        across: Vec<Timed>,
    ) -> Vec<Segment> {
        let robot = &self.world.model.robot;
        let (open, closed) = (robot.hand.open(), grasp.closed);
        let attached = Attached {
            object: self.scene.names[object.index()].clone(),
            tool: robot.links[robot.hand.frame].name.clone(),
            pose_in_tool: written(&grasp.object_from_tool.inverse()),
        };
        let gripped = there.positions.last().cloned().unwrap_or_default();
        let mut segments = self.coming_segments(there);
        segments.push(self.grip(SegmentKind::Grasp, &gripped, open, closed));
        let held = self.gripper(GripperValue::Held(closed));
        segments.extend(
            across.into_iter().map(|t| segment(SegmentKind::Transfer, t, held.clone(), Some(attached.clone()))),
        );
        segments
    }

    /// To an object with the hand open: the last of it is the approach.
    pub(crate) fn coming_segments(&self, there: Timed) -> Vec<Segment> {
        let begins = self.comes_near(&there.positions);
        let (transit, approach) = split(there, begins);
        let transit = transit.map(|t| self.empty_handed(SegmentKind::Transit, t));
        transit.into_iter().chain(approach.map(|t| self.empty_handed(SegmentKind::Approach, t))).collect()
    }

    /// Away from an object with the hand open: the first of it is the retreat.
    pub(crate) fn going_segments(&self, back: Timed) -> Vec<Segment> {
        let ends = self.is_gone(&back.positions);
        let (retreat, rest) = split(back, ends);
        let retreat = retreat.map(|t| self.empty_handed(SegmentKind::Retreat, t));
        retreat.into_iter().chain(rest.map(|t| self.empty_handed(SegmentKind::Transit, t))).collect()
    }

    /// The row at which a motion to an object has only the standoff left, if it has more before.
    pub(crate) fn comes_near(&self, rows: &[Posture]) -> Option<usize> {
        let (tool, standoff) = (self.tool_position(), self.world.model.robot.grasps.standoff);
        let end = rows.last().map_or(Vec3::ZERO, &tool);
        rows.iter().rposition(|q| tool(q).distance(end) > standoff)
    }

    /// The row at which a motion away from an object has left it by the standoff, if it ever does.
    pub(crate) fn is_gone(&self, rows: &[Posture]) -> Option<usize> {
        let (tool, standoff) = (self.tool_position(), self.world.model.robot.grasps.standoff);
        let start = rows.first().map_or(Vec3::ZERO, &tool);
        rows.iter().position(|q| tool(q).distance(start) >= standoff - 1e-6)
    }

    /// A motion with the hand open and nothing in it.
    pub(crate) fn empty_handed(&self, kind: SegmentKind, timed: Timed) -> Segment {
        let open = self.world.model.robot.hand.open();
        segment(kind, self.widened(timed), self.gripper(GripperValue::Held(open)), None)
    }

    /// Where the tool of the open hand is, in the root frame.
    pub(crate) fn tool_position(&self) -> impl Fn(&Posture) -> Vec3 + use<R> {
        let model = self.world.model.clone();
        move |q| model.kinematics.tool(q, model.robot.hand.open()).translation
    }

    /// Letting go, and away from it.
    pub(crate) fn leaving_segments(&self, let_go: &Posture, grasp: &Grasp, back: Timed) -> Vec<Segment> {
        let open = self.world.model.robot.hand.open();
        let mut segments = vec![self.grip(SegmentKind::Release, let_go, grasp.closed, open)];
        segments.extend(self.going_segments(back));
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

fn segment(
    kind: SegmentKind,
    timed: Timed,
    gripper: BTreeMap<String, GripperValue>,
    attached: Option<Attached>,
) -> Segment {
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
