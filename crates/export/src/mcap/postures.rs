//! Every joint of the robot at every row of the plan: those planned for, the gripper's, those held
//! still and those that mimic others. And from them, where links are.

use crate::ExportError;
use crate::rows::{Nanoseconds, TimedSegment, gripper_joints};
use crate::urdf::{Joint, Urdf};
use clearway_geometry::Pose;
use clearway_plan::PlanFile;
use std::collections::HashMap;

pub(crate) struct Postures<'a> {
    /// The joints planned for in the plan's order, the gripper's, then all others that move, in the URDF's order.
    pub names: Vec<&'a str>,
    /// A row for each of the plan's, in order.
    pub rows: Vec<Posture>,
    /// By joint: its place in `names`.
    columns: HashMap<&'a str, usize>,
    /// One per name.
    sources: Vec<Source>,
}

/// On the plan's clock: radians or metres, a value per name.
pub(crate) struct Posture {
    pub time: Nanoseconds,
    pub values: Vec<f64>,
}

/// Where a joint's value comes from.
enum Source {
    /// A column of the plan's rows.
    Arm(usize),
    /// A joint of the gripper, by its place among those the plan names.
    Gripper(usize),
    Held(f64),
    Mimic {
        column: usize,
        multiplier: f64,
        offset: f64,
    },
}

impl<'a> Postures<'a> {
    pub fn of(plan: &'a PlanFile, urdf: &'a Urdf, segments: &[TimedSegment]) -> Result<Self, ExportError> {
        let gripper = gripper_joints(plan);
        let known = |name: &str| urdf.joints.iter().any(|j| j.moves() && j.name == name);
        if let Some((i, name)) = plan.robot.joints.iter().enumerate().find(|(_, name)| !known(name)) {
            return Err(ExportError::malformed(format!("robot.joints[{i}]"), name, "a joint of robot.urdf that moves"));
        }
        if let Some(name) = gripper.iter().find(|name| !known(name)) {
            return Err(ExportError::malformed("the segments' `gripper`", name, "a joint of robot.urdf that moves"));
        }

        let mut names: Vec<&str> = Vec::new();
        let given = plan.robot.joints.iter().map(String::as_str).chain(gripper.iter().copied());
        for name in given.chain(urdf.joints.iter().filter(|j| j.moves()).map(|j| j.name.as_str())) {
            if !names.contains(&name) {
                names.push(name);
            }
        }
        let columns: HashMap<&str, usize> = names.iter().enumerate().map(|(i, &name)| (name, i)).collect();
        let source = |&name: &&str| {
            let mimic = || urdf.joints.iter().find(|j| j.name == name).and_then(|j| j.mimic.as_ref());
            if let Some(column) = plan.robot.joints.iter().position(|j| j == name) {
                Source::Arm(column)
            } else if let Some(index) = gripper.iter().position(|&j| j == name) {
                Source::Gripper(index)
            } else if let Some((mimic, &column)) = mimic().and_then(|m| Some((m, columns.get(m.leader.as_str())?))) {
                Source::Mimic { column, multiplier: mimic.multiplier, offset: mimic.offset }
            } else {
                Source::Held(plan.robot.fixed.get(name).copied().unwrap_or(0.0))
            }
        };
        let sources = names.iter().map(source).collect();
        let mut postures = Self { names, rows: Vec::new(), columns, sources };
        postures.rows = postures.evaluate(&gripper, segments);
        Ok(postures)
    }

    fn evaluate(&self, gripper: &[&str], segments: &[TimedSegment]) -> Vec<Posture> {
        // A segment that says nothing of the gripper leaves it as it is; before the first that does, as it will be.
        let first = |joint: &&str| segments.iter().find_map(|s| s.gripper(joint, 0)).unwrap_or(0.0);
        let mut hand: Vec<f64> = gripper.iter().map(first).collect();
        let mut rows = Vec::new();
        for segment in segments {
            for row in segment.own_rows() {
                for (value, joint) in hand.iter_mut().zip(gripper) {
                    *value = segment.gripper(joint, row.row).unwrap_or(*value);
                }
                let value = |column| self.value(column, row.positions, &hand);
                rows.push(Posture { time: row.time, values: (0..self.names.len()).map(value).collect() });
            }
        }
        rows
    }

    /// The URDF was read, so mimics end.
    fn value(&self, column: usize, arm: &[f64], hand: &[f64]) -> f64 {
        match self.sources[column] {
            Source::Arm(index) => arm[index],
            Source::Gripper(index) => hand[index],
            Source::Held(value) => value,
            Source::Mimic { column, multiplier, offset } => multiplier * self.value(column, arm, hand) + offset,
        }
    }

    /// Whether the plan moves the joint, by itself or as one that mimics.
    pub fn driven(&self, joint: &Joint) -> bool {
        let mut column = self.columns.get(joint.name.as_str()).copied();
        while let Some(Source::Mimic { column: leader, .. }) = column.map(|c| &self.sources[c]) {
            column = Some(*leader);
        }
        matches!(column.map(|c| &self.sources[c]), Some(Source::Arm(_) | Source::Gripper(_)))
    }

    pub fn parent_from_child(&self, joint: &Joint, posture: &Posture) -> Pose {
        joint.parent_from_child(self.columns.get(joint.name.as_str()).map_or(0.0, |&c| posture.values[c]))
    }

    /// A link seen from the robot's root.
    pub fn root_from_link(&self, urdf: &Urdf, link: &str, posture: &Posture) -> Pose {
        urdf.chain(link).fold(Pose::IDENTITY, |pose, joint| self.parent_from_child(joint, posture) * pose)
    }
}
