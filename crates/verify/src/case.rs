//! One plan, made ready for judging: the robot's model, exact shapes, names turned into indices,
//! and every row as a whole posture.

use crate::error::CannotJudge;
use crate::meshes::Meshes;
use crate::model::Model;
use crate::report::Place;
use crate::shapes::{self, Piece};
use crate::sweep::When;
use crate::urdf;
use clearway_plan::PlanFile;
use clearway_plan::plan_file::{PlacedPose, Segment};
use clearway_plan::scene_file::{Body, PlaceArea};
use parry3d_f64::math::Pose;
use std::path::Path;

/// A fixture or an object.
pub(crate) struct Thing {
    pub id: String,
    pub pieces: Vec<Piece>,
    /// In the world, at the start.
    pub pose: Pose,
}

/// The robot and the scene.
pub(crate) struct Case {
    pub model: Model,
    pub world_from_root: Pose,
    pub fixtures: Vec<Thing>,
    pub objects: Vec<Thing>,
    pub places: Vec<PlaceArea>,
}

impl Case {
    pub fn new(plan: &PlanFile, directory: &Path) -> Result<Self, CannotJudge> {
        let mut meshes = Meshes::new(&plan.robot.meshes, directory);
        let model = urdf::read(&plan.robot.urdf, &mut meshes)?;
        let world_from_root = shapes::pose_from_keys(&plan.scene.robot.base)
            .ok_or_else(|| CannotJudge::Scene { place: "robot.base".to_owned(), what: "no valid pose".to_owned() })?;
        let mut things = |bodies: &[Body], what: &str| {
            bodies.iter().map(|b| thing(b, what, &mut meshes)).collect::<Result<Vec<_>, _>>()
        };
        let fixtures = things(&plan.scene.fixtures, "fixture")?;
        let objects = things(&plan.scene.objects, "object")?;
        for place in &plan.scene.place {
            if !place.size.iter().chain(&place.position).all(|v| v.is_finite()) {
                return Err(CannotJudge::Scene {
                    place: format!("place {:?}", place.id),
                    what: "numbers that are not finite".to_owned(),
                });
            }
        }
        for (i, object) in objects.iter().enumerate() {
            if objects[..i].iter().any(|o| o.id == object.id) {
                return Err(CannotJudge::Scene {
                    place: format!("object {:?}", object.id),
                    what: "two objects have this id".to_owned(),
                });
            }
        }
        Ok(Self { model, world_from_root, fixtures, objects, places: plan.scene.place.clone() })
    }

    pub fn object(&self, id: &str) -> Option<usize> {
        self.objects.iter().position(|o| o.id == id)
    }

    /// Every link's pose in the world.
    pub fn link_poses(&self, posture: &[f64]) -> Vec<Pose> {
        let mut poses = Vec::with_capacity(self.model.links.len());
        self.model.link_poses(&self.world_from_root, posture, &mut poses);
        poses
    }
}

fn thing(body: &Body, what: &str, meshes: &mut Meshes) -> Result<Thing, CannotJudge> {
    let place = format!("{what} {:?}", body.id);
    let pose = shapes::pose_from(body.position, body.rpy, body.quaternion)
        .ok_or_else(|| CannotJudge::Scene { place: place.clone(), what: "no valid pose".to_owned() })?;
    Ok(Thing { id: body.id.clone(), pieces: shapes::body_pieces(body, &place, meshes)?, pose })
}

/// `None` when the numbers are no pose.
pub(crate) fn pose_of(placed: &PlacedPose) -> Option<Pose> {
    shapes::pose_from(placed.position, None, Some(placed.quaternion))
}

/// A segment, every row a whole posture (a value per joint of the model).
pub(crate) struct Track<'a> {
    pub step: usize,
    pub index: usize,
    pub segment: &'a Segment,
    /// Seconds from the plan's start to the segment's.
    pub start: f64,
    pub postures: Vec<Vec<f64>>,
}

impl Track<'_> {
    pub fn place(&self) -> Place {
        Place::segment(self.step, self.index, self.start)
    }

    pub fn at(&self, row: usize) -> Place {
        self.place().row(row, self.start + self.segment.times.get(row).copied().unwrap_or(0.0))
    }

    /// The row before, and the time of the instant itself.
    pub fn when(&self, when: When) -> Place {
        let mut place = self.at(when.row);
        if let (Some(from), Some(to)) = (self.segment.times.get(when.row), self.segment.times.get(when.row + 1)) {
            place.time += when.fraction * (to - from);
        }
        place
    }
}
