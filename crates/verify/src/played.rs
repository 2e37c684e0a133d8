//! A plan made ready for being played by others: its robot as links with exact shapes and forward kinematics, its
//! scene, and its rows as whole postures, read by the same code that judges plans.
//!
//! SI units, world frame with z up. A posture is one value per joint of the URDF that [`Played`] was read from,
//! mimic joints included. Reading takes some milliseconds, a pass of forward kinematics a microsecond or two.

use crate::case::{Case, Thing};
use crate::error::CannotJudge;
use crate::names::{self, Names};
use crate::report::{Report, Violation, ViolationKind};
use crate::shapes::{Piece, body_gap};
use crate::{rest, rows, steps};
use clearway_plan::PlanFile;
use clearway_plan::plan_file::{SegmentKind, Status};
use parry3d_f64::math::Pose;
use parry3d_f64::shape::SharedShape;
use std::path::Path;

/// Why a plan cannot be played.
#[derive(Debug, thiserror::Error)]
pub enum CannotPlay {
    #[error(transparent)]
    Unreadable(#[from] CannotJudge),
    #[error("there is nothing to play: {0}")]
    Nothing(String),
    /// The first thing that is wrong with its structure.
    #[error("the plan is no motion: {0}")]
    Wrong(Violation),
}

/// One exact shape, in its owner's frame. Cylinders and capsules lie as parry has them, along y.
#[derive(Clone)]
pub struct PlayedShape {
    pub shape: SharedShape,
    pub owner_from_shape: Pose,
}

/// A link of the robot.
pub struct PlayedLink {
    pub name: String,
    pub shapes: Vec<PlayedShape>,
    /// One of `hand.links`.
    pub in_hand: bool,
    /// Mounted on what the robot stands on: it may meet fixtures.
    pub mounted: bool,
    /// Moved by a joint of the gripper, directly or by `<mimic>`.
    pub finger: bool,
}

/// A fixture or an object.
pub struct PlayedBody {
    pub id: String,
    pub shapes: Vec<PlayedShape>,
    /// At the start.
    pub world_from_body: Pose,
}

/// A segment, every row a whole posture.
pub struct PlayedSegment {
    /// Indices into the plan's steps, and the step's segments.
    pub step: usize,
    pub index: usize,
    pub kind: SegmentKind,
    /// Seconds from the plan's start.
    pub start: f64,
    /// Seconds from the segment's start, rising from 0; as many as postures, and at least one.
    pub times: Vec<f64>,
    pub postures: Vec<Vec<f64>>,
}

/// See the module.
pub struct Played {
    case: Case,
    names: Names,
    pub links: Vec<PlayedLink>,
    pub fixtures: Vec<PlayedBody>,
    pub objects: Vec<PlayedBody>,
    pub segments: Vec<PlayedSegment>,
    /// The object of each step, an index into `objects`.
    pub step_objects: Vec<usize>,
}

impl Played {
    /// `directory` is where the plan's meshes are relative to.
    pub fn new(plan: &PlanFile, directory: &Path) -> Result<Self, CannotPlay> {
        if plan.status != Status::Solved || plan.steps.is_empty() {
            let status = serde_json::to_string(&plan.status).unwrap_or_default();
            return Err(CannotPlay::Nothing(format!("the status is {status}, with {} steps", plan.steps.len())));
        }
        let case = Case::new(plan, directory)?;
        let mut report = Report::default();
        let names = names::resolve(plan, &case.model, &mut report);
        let step_objects = steps::check(plan, &case, &mut report);
        let tracks = names.as_ref().and_then(|names| rows::tracks(plan, &case.model, names, &mut report));
        if let (Some(names), Some(tracks)) = (&names, &tracks) {
            rows::check(plan, &case.model, names, tracks, &mut report);
        }
        // The rest may be wrong and still be played.
        let (Some(names), Some(step_objects), Some(tracks), None) =
            (names, step_objects, tracks, report.violations.iter().find(|v| stops(v)))
        else {
            let first = report.violations.into_iter().find(stops);
            return Err(first.map_or_else(|| CannotPlay::Nothing("no rows".to_owned()), CannotPlay::Wrong));
        };
        let segments = tracks
            .into_iter()
            .map(|track| PlayedSegment {
                step: track.step,
                index: track.index,
                kind: track.segment.kind,
                start: track.start,
                times: track.segment.times.clone(),
                postures: track.postures,
            })
            .collect();
        let model = &case.model;
        let links = model.links.iter().enumerate().map(|(i, link)| PlayedLink {
            name: link.name.clone(),
            shapes: played_shapes(&link.pieces),
            in_hand: names.in_hand[i],
            mounted: model.mounted(i),
            finger: model.moving_joints_above(i).into_iter().any(|j| {
                let leader = model.joints[j].mimic.map_or(j, |m| m.joint);
                names.gripper.contains(&leader)
            }),
        });
        let (links, fixtures) = (links.collect(), case.fixtures.iter().map(played_body).collect());
        let objects = case.objects.iter().map(played_body).collect();
        Ok(Self { links, fixtures, objects, segments, step_objects, case, names })
    }

    pub fn link(&self, name: &str) -> Option<usize> {
        self.case.model.link(name)
    }

    pub fn joint(&self, name: &str) -> Option<usize> {
        self.case.model.joint(name)
    }

    /// Limits of a joint that has any, rad or m.
    pub fn range(&self, joint: usize) -> Option<(f64, f64)> {
        self.case.model.joints[joint].range
    }

    /// The joints of `robot.joints` and of the gripper.
    pub fn driven(&self) -> impl Iterator<Item = usize> {
        self.names.columns.iter().chain(&self.names.gripper).copied()
    }

    /// Gives every mimic joint its value.
    pub fn follow(&self, posture: &mut [f64]) {
        self.case.model.follow(posture);
    }

    /// Every link's pose in the world.
    pub fn link_poses(&self, posture: &[f64], poses: &mut Vec<Pose>) {
        self.case.model.link_poses(&self.case.world_from_root, posture, poses);
    }

    /// Whether the plan leaves a pair of links unchecked.
    pub fn unchecked(&self, a: usize, b: usize) -> bool {
        a == b || self.names.unchecked.contains(&(a.min(b), a.max(b)))
    }

    /// What carries an object that is at `at` while the objects are where `standing` says (`None`: elsewhere):
    /// ids of fixtures and objects.
    pub fn carriers(&self, standing: &[Option<Pose>], object: usize, at: &Pose) -> Vec<String> {
        let standing = standing.to_vec();
        rest::carriers(&self.case, &standing, object, at).into_iter().map(str::to_owned).collect()
    }
}

/// Signed distance between two bodies of such shapes; `None`: farther apart than `reach`.
pub fn distance(
    a: &[PlayedShape],
    world_from_a: &Pose,
    b: &[PlayedShape],
    world_from_b: &Pose,
    reach: f64,
) -> Option<f64> {
    let pieces = |shapes: &[PlayedShape]| -> Vec<Piece> {
        shapes.iter().map(|s| Piece::new(s.owner_from_shape, s.shape.clone())).collect()
    };
    body_gap(&pieces(a), world_from_a, &pieces(b), world_from_b, reach).map(|gap| gap.distance)
}

/// Without these there are no motions and no scene to speak of.
fn stops(violation: &Violation) -> bool {
    use ViolationKind::{Continuity, Joints, Rows, Start, Steps, Times};
    matches!(violation.kind, Joints | Rows | Times | Start | Continuity | Steps)
}

fn played_body(thing: &Thing) -> PlayedBody {
    PlayedBody { id: thing.id.clone(), shapes: played_shapes(&thing.pieces), world_from_body: thing.pose }
}

fn played_shapes(pieces: &[Piece]) -> Vec<PlayedShape> {
    pieces.iter().map(|p| PlayedShape { shape: p.shape.clone(), owner_from_shape: p.pose }).collect()
}
