//! A simulated camera, and retrievals played through with it.

use super::guess::Rule;
use super::{Dialogue, Observation, Turn};
use crate::feasibility::Unfit;
use crate::planner::{Request, Settings};
use clearway_collision::CollisionModel;
use clearway_geometry::{Pose, Vec3};
use clearway_plan::Stop;
use clearway_plan::event::Observer;
use clearway_plan::plan_file::{PlanFile, Status, Timing, Why};
use clearway_scene::{Object, Scene};
use clearway_sight::{Region, Sight, Standing, Thing, View, blind, look};
use std::sync::Arc;

/// A camera that looks at a scene of which everything is known.
pub struct SimulatedCamera {
    pub view: View,
    pub region: Region,
    scene: Scene,
    poses: Vec<Pose>,
    known: Vec<bool>,
}

impl SimulatedCamera {
    pub fn new(scene: Scene, view: View) -> Self {
        let region = Region::of(&scene);
        let poses = scene.objects.iter().map(|o| o.pose).collect();
        let known = vec![false; scene.objects.len()];
        Self { view, region, scene, poses, known }
    }

    /// Looks, as things stand.
    pub fn look(&mut self) -> Observation {
        let fixtures: Vec<Standing> =
            self.scene.fixtures.iter().map(|f| Standing { solid: &f.solid, pose: &f.pose }).collect();
        let things: Vec<Thing> = (self.scene.objects.iter().zip(&self.poses).zip(&self.known))
            .map(|((o, pose), known)| Thing { standing: Standing { solid: &o.solid, pose }, known: *known })
            .collect();
        let Sight { new, hidden } = look(&self.view, &self.region, &fixtures, &things);
        let name = |index: usize| self.scene.objects[index].id.clone();
        let objects = new.iter().map(|&i| Object { pose: self.poses[i], ..self.scene.objects[i].clone() }).collect();
        // What known objects hide, who is told of them knows.
        let hidden = hidden.into_iter().map(|h| (h.behind.map(name), h.space)).collect();
        for index in new {
            self.known[index] = true;
        }
        Observation { objects, gone: Vec::new(), hidden }
    }

    /// An object was put down elsewhere.
    pub fn moved(&mut self, object: &str, pose: Pose) {
        if let Some(id) = self.scene.object(object) {
            self.poses[id.index()] = pose;
        }
    }
}

/// A whole retrieval, from look to look: the plan, and what stopped it if there is none.
pub fn play(
    scene: Scene,
    model: Arc<CollisionModel>,
    settings: Settings,
    rule: Rule,
    request: &Request,
    observer: &mut dyn Observer,
) -> Result<(PlanFile, Option<Stop>), Unfit> {
    let Some(camera) = &scene.file.camera else { return Err(Unfit::Camera("the scene has no camera".to_owned())) };
    if model.standing.is_some() {
        return Err(Unfit::Drives(
            "its base drives, and the scene has a camera: hidden objects are planned for from one place".to_owned(),
        ));
    }
    let view = View::new(camera);
    if let Some(why) = blind(&scene, &view) {
        return Err(Unfit::Camera(why));
    }
    let file = scene.file.clone();
    let mut camera = SimulatedCamera::new(scene.clone(), view.clone());
    let mut dialogue = Dialogue::new(&scene, view, camera.region, model, settings, rule);
    let mut whole = PlanFile { seed: request.seed, ..PlanFile::unsolved(file) };
    let mut timing = Timing::default();
    loop {
        dialogue.observe(camera.look());
        match dialogue.next(request, observer)? {
            Turn::Act(action) => {
                dialogue.done(&action);
                let placed = &action.step.placed;
                camera
                    .moved(&action.object, Pose::from_quaternion(placed.quaternion, Vec3::from_array(placed.position)));
                let known = &action.known;
                let PlanFile { robot, timing: own, stats, why, .. } = action.plan;
                whole.robot = robot;
                timing.total += known.planning;
                timing.motion += own.motion;
                whole.stats.iterations += stats.iterations;
                whole.stats.sequences_tried += stats.sequences_tried;
                whole.stats.grasps_tried += stats.grasps_tried;
                whole.stats.exploration_limit = whole.stats.exploration_limit.max(stats.exploration_limit);
                whole.why.objects.extend(why.objects.into_iter().filter(|w| w.object == action.object).map(|mut w| {
                    w.order = whole.removed.len() + 1;
                    if known.taking == action.object && !action.last {
                        w.reason = "what it hides was to be seen".to_owned();
                    }
                    w
                }));
                whole.removed.push(action.object);
                whole.known.push(action.known);
                whole.steps.push(action.step);
                whole.timing = Timing { task: timing.total - timing.motion, ..timing.clone() };
                if action.last {
                    whole.status = Status::Solved;
                    whole.why.summary = format!(
                        "{} of {} objects were seen by the end; {} removed.",
                        dialogue.seen().len(),
                        whole.scene.objects.len(),
                        whole.removed.len()
                    );
                    return Ok((whole, None));
                }
            }
            Turn::End(end, stopped) => {
                let why = Why {
                    summary: end.why.summary,
                    objects: whole.why.objects.into_iter().chain(end.why.objects).collect(),
                    sides: Vec::new(),
                };
                return Ok((PlanFile { status: end.status, why, ..whole }, stopped));
            }
        }
    }
}
