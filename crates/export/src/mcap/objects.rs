//! Where the objects are, as the plan goes on: standing, in the hand, on their way while pushed.

use crate::ExportError;
use crate::rows::TimedSegment;
use clearway_geometry::{Pose, Quat, Vec3};
use clearway_plan::PlanFile;
use clearway_plan::plan_file::{PlacedPose, SegmentKind, Step};

#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum At<'a> {
    /// In the world.
    World(Pose),
    /// In the frame of a link.
    Link(&'a str, Pose),
}

pub(crate) struct Objects<'a> {
    plan: &'a PlanFile,
    /// As the scene lists them.
    pub at: Vec<At<'a>>,
    /// The segment that the plan is in.
    now: Option<Now<'a>>,
    way: Option<Way>,
}

#[derive(Clone, Copy)]
struct Now<'a> {
    step: usize,
    held: Option<&'a str>,
}

/// A pushed object's, straight from where it stood to where it is to stand.
struct Way {
    object: usize,
    from: Pose,
    to: Pose,
    /// Where the tool was when the push began, in the robot's root.
    tool: Vec3,
}

impl<'a> Objects<'a> {
    /// As the plan finds them. Every step's object is one of the scene's, and so is what is held.
    pub fn of(plan: &'a PlanFile) -> Result<Self, ExportError> {
        for (i, step) in plan.steps.iter().enumerate() {
            let held = step.segments.iter().filter_map(|s| s.attached.as_ref()).map(|a| a.object.as_str());
            for id in held.chain([step.object.as_str()]) {
                if !plan.scene.objects.iter().any(|o| o.id == id) {
                    return Err(ExportError::malformed(
                        format!("steps[{i}]"),
                        format!("`{id}`"),
                        "an object of the scene",
                    ));
                }
            }
        }
        let pose = |o: &clearway_plan::scene_file::Body| {
            let keys =
                clearway_plan::scene_file::PoseKeys { position: o.position, rpy: o.rpy, quaternion: o.quaternion };
            At::World(keys.pose())
        };
        Ok(Self { plan, at: plan.scene.objects.iter().map(pose).collect(), now: None, way: None })
    }

    /// A segment begins: whether any object is elsewhere, or goes with something else, from here on.
    pub fn begin(&mut self, segment: &TimedSegment<'a>) -> bool {
        let before = self.at.clone();
        let attached = segment.segment.attached.as_ref();
        let held = attached.map(|a| a.object.as_str());
        if let Some(last) = self.now {
            let placed = &self.plan.steps[last.step];
            if let Some(id) = last.held.filter(|&id| held != Some(id)) {
                self.put(id, &placed.placed);
            }
            if last.step != segment.step && held != Some(placed.object.as_str()) {
                self.put(&placed.object, &placed.placed);
            }
        }
        if let (Some(attached), Some(object)) = (attached, held.and_then(|id| self.index(id))) {
            self.at[object] = At::Link(&attached.tool, pose(&attached.pose_in_tool));
        }
        if self.now.is_none_or(|last| last.step != segment.step) {
            self.way = None;
        }
        self.now = Some(Now { step: segment.step, held });
        before != self.at
    }

    /// A segment that pushes begins, with the tool where it is in the robot's root.
    pub fn begin_push(&mut self, segment: &TimedSegment<'a>, tool: Vec3) {
        let step = &self.plan.steps[segment.step];
        if self.way.is_none()
            && let Some(object) = self.index(&step.object)
            && let At::World(from) = self.at[object]
        {
            self.way = Some(Way { object, from, to: pose(&step.placed), tool });
        }
    }

    /// A row of a segment that pushes: whether the object moved on. `tool` is in the robot's root, whose
    /// directions are turned by `world_from_root`.
    pub fn push(&mut self, segment: &TimedSegment<'a>, row: usize, world_from_root: &Pose, tool: Vec3) -> bool {
        let step = &self.plan.steps[segment.step];
        let Some(way) = &self.way else { return false };
        let share = match &step.push {
            Some(push) => {
                let gone = (world_from_root.rotation * (tool - way.tool)).dot(Vec3::from_array(push.direction));
                (gone - push.free) / push.distance
            }
            None => share_of_time(step, segment, row),
        };
        // A distance of 0 is no way at all.
        let share = if share.is_finite() { share.clamp(0.0, 1.0) } else { 1.0 };
        let there = At::World(between(&way.from, &way.to, share));
        let moved = self.at[way.object] != there;
        self.at[way.object] = there;
        moved
    }

    /// The plan is over: whether an object stands elsewhere for it.
    pub fn end(&mut self) -> bool {
        let before = self.at.clone();
        if let Some(Now { step, held: None }) = self.now {
            let step = &self.plan.steps[step];
            self.put(&step.object, &step.placed);
        }
        before != self.at
    }

    fn put(&mut self, id: &str, placed: &PlacedPose) {
        if let Some(object) = self.index(id) {
            self.at[object] = At::World(pose(placed));
        }
    }

    fn index(&self, id: &str) -> Option<usize> {
        self.plan.scene.objects.iter().position(|o| o.id == id)
    }
}

/// Of a step that does not say how it pushes: how much of its pushing is done at a row.
fn share_of_time(step: &Step, segment: &TimedSegment, row: usize) -> f64 {
    let seconds = |index: usize| step.segments[index].times.last().copied().unwrap_or(0.0);
    let pushes = || (0..step.segments.len()).filter(|&i| step.segments[i].kind == SegmentKind::Push);
    let before: f64 = pushes().filter(|&i| i < segment.index).map(seconds).sum();
    (before + segment.segment.times[row]) / pushes().map(seconds).sum::<f64>()
}

fn pose(placed: &PlacedPose) -> Pose {
    Pose::from_quaternion(placed.quaternion, Vec3::from_array(placed.position))
}

fn between(from: &Pose, to: &Pose, share: f64) -> Pose {
    if share >= 1.0 {
        return *to;
    }
    let [a, b] = [from, to].map(|pose| Quat::from_array(pose.quaternion()));
    Pose::from_quaternion(a.slerp(b, share).to_array(), from.translation.lerp(to.translation, share))
}
