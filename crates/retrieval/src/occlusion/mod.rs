//! Section V-A, Algorithm 4: retrieval when not all objects are seen.
//!
//! A [`Dialogue`] is told what is in view, answers with the next action and its motions, and is told what
//! came into view after it was carried out. As long as the target is not seen an object is taken away to look
//! behind it ([`guess`]); after that the target is planned for as if all were known. What objects
//! hide counts as part of them: it is not to be touched as long as they stand, and gone with
//! them. After each action there is another look, and the rest of the plan stands only if that brings nothing new.

pub mod guess;
pub mod simulated;

use crate::feasibility::Unfit;
use crate::planner::{Answer, Planner, Request, SceneDelta, Settings};
use clearway_collision::CollisionModel;
use clearway_geometry::{Pose, Solid, Vec3};
use clearway_motion::Posture;
use clearway_plan::event::Observer;
use clearway_plan::plan_file::{Known, PlanFile, Stats, Status, Step, Timing};
use clearway_plan::{ObjectId, ObjectSet, Stop};
use clearway_scene::{Fixture, Hidden, Object, Scene};
use clearway_sight::shadow::{Begins, shadow};
use clearway_sight::{BEHIND, Region, View};
use guess::{Guess, Rule};
use std::sync::Arc;
use std::time::Instant;

/// An object that is this far from where it was has been moved, metres; and radians.
const MOVED: f64 = 0.001;
/// Names space that is not seen, where no object hides it.
const UNSEEN: &str = "(unseen)";

/// What is seen: objects with their shapes and poses in the world, and what space is not.
#[derive(Clone, Debug)]
pub struct Observation {
    /// Those in view now. One that was seen before and is not listed is taken to be where it was.
    pub objects: Vec<Object>,
    /// Seen before, and no longer where it was, although that place is in view.
    pub gone: Vec<String>,
    /// Space that no object known hides, or that hides something unknown: by the object to which that is due.
    pub hidden: Vec<(Option<String>, Solid)>,
}

/// What an observation changed.
#[derive(Clone, Debug, PartialEq)]
pub enum Notice {
    /// It came into view.
    New(String),
    /// It stands elsewhere than before: planned for anew.
    Moved(String),
    /// It is no longer there.
    Gone(String),
}

/// What to do next.
#[derive(Clone, Debug)]
pub enum Turn {
    /// This; then look again and tell ([`Dialogue::observe`]), [`Dialogue::done`] before it.
    Act(Box<Action>),
    /// Nothing: there is no plan. Says why.
    End(Box<PlanFile>, Option<Stop>),
}

/// One object's removal.
#[derive(Clone, Debug)]
pub struct Action {
    pub object: String,
    pub step: Step,
    /// The target was taken: the end.
    pub last: bool,
    pub known: Known,
    /// The plan this is the first step of.
    pub plan: PlanFile,
}

/// Where a known object is.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Whereabouts {
    Standing,
    /// Taken away.
    Placed,
    Gone,
}

struct Seen {
    object: Object,
    whereabouts: Whereabouts,
}

/// One retrieval, from look to look.
pub struct Dialogue {
    /// What is known from the start: fixtures, places, robot; no objects.
    empty: Scene,
    model: Arc<CollisionModel>,
    settings: Settings,
    rule: Rule,
    view: View,
    region: Region,
    target: String,
    target_shape: Arc<Solid>,
    known: Vec<Seen>,
    hidden: Vec<(Option<String>, Solid)>,
    new: Vec<String>,
    posture: Option<Posture>,
    steps: usize,
    planner: Option<Planner>,
    rest: Option<Rest>,
}

/// What is left of a plan whose first steps were carried out: good as long as looking brings nothing new, for it
/// was made as if there were nothing behind what it removes.
struct Rest {
    taking: String,
    plan: PlanFile,
    /// Hidden spaces besides those of known objects, when it was made.
    hidden: usize,
}

impl Dialogue {
    /// `scene`: its fixtures, places and camera count, not its objects; of the target the shape. `region`: where
    /// space that is not seen counts.
    pub fn new(
        scene: &Scene,
        view: View,
        region: Region,
        model: Arc<CollisionModel>,
        settings: Settings,
        rule: Rule,
    ) -> Self {
        let target = &scene.objects[scene.target.index()];
        Self {
            empty: Scene { objects: Vec::new(), names: Vec::new(), hidden: Vec::new(), ..scene.clone() },
            model,
            settings,
            rule,
            view,
            region,
            target: target.id.clone(),
            target_shape: target.solid.clone(),
            known: Vec::new(),
            hidden: Vec::new(),
            new: Vec::new(),
            posture: None,
            steps: 0,
            planner: None,
            rest: None,
        }
    }

    /// All objects seen so far and still there.
    pub fn seen(&self) -> Vec<String> {
        self.known.iter().filter(|s| s.whereabouts != Whereabouts::Gone).map(|s| s.object.id.clone()).collect()
    }

    /// Takes in what is seen.
    pub fn observe(&mut self, observation: Observation) -> Vec<Notice> {
        let mut notices = Vec::new();
        for object in observation.objects {
            let id = object.id.clone();
            match self.known.iter_mut().find(|s| s.object.id == id) {
                None => {
                    notices.push(Notice::New(id.clone()));
                    self.new.push(id);
                    self.known.push(Seen { object, whereabouts: Whereabouts::Standing });
                }
                Some(seen) => {
                    let (a, b) = (&seen.object.pose, &object.pose);
                    let moved = a.translation.distance(b.translation) > MOVED || a.angle_to(b) > MOVED;
                    if moved || seen.whereabouts == Whereabouts::Gone {
                        notices.push(Notice::Moved(id));
                        *seen = Seen { object, whereabouts: Whereabouts::Standing };
                    }
                }
            }
        }
        for id in observation.gone {
            if let Some(seen) = self.known.iter_mut().find(|s| s.object.id == id && s.whereabouts != Whereabouts::Gone)
            {
                seen.whereabouts = Whereabouts::Gone;
                notices.push(Notice::Gone(id));
            }
        }
        self.hidden = observation.hidden;
        let as_expected = notices.is_empty() && self.rest.as_ref().is_some_and(|rest| self.hidden.len() <= rest.hidden);
        self.rest = self.rest.take().filter(|rest| as_expected && !rest.plan.steps.is_empty());
        notices
    }

    /// An action was carried out: the object is where the step says, and so is the arm.
    pub fn done(&mut self, action: &Action) {
        self.steps += 1;
        self.new.clear();
        if let Some(seen) = self.known.iter_mut().find(|s| s.object.id == action.object) {
            seen.whereabouts = Whereabouts::Placed;
            let placed = &action.step.placed;
            seen.object.pose = Pose::from_quaternion(placed.quaternion, Vec3::from_array(placed.position));
        }
        let rows = action.step.segments.iter().rev().find_map(|s| s.positions.last());
        self.posture = rows.cloned();
    }

    /// What to do next.
    pub fn next(&mut self, request: &Request, observer: &mut dyn Observer) -> Result<Turn, Unfit> {
        let began = Instant::now();
        if let Some(Rest { taking, plan, .. }) = self.rest.take() {
            let known = self.known(taking, None, began);
            return Ok(self.act(plan, known));
        }
        let mut scene = self.scene();
        let target = scene.object(&self.target);
        let standing = scene.all();
        let Some(first) = standing.iter().next() else { return Ok(self.not_found()) };
        scene.target = target.unwrap_or(first);
        let (places, ranked) = match target {
            Some(_) => (Vec::new(), Vec::new()),
            None => {
                let guess = Guess::new(&self.view, &self.region, &scene, &self.target_shape);
                let places = guess.places(&standing);
                if places.iter().all(|p| p.behind.is_none()) {
                    return Ok(self.not_found());
                }
                let exit = scene.base.translation;
                let ranked = guess.ranked(self.rule, &places, &standing, exit);
                (places, ranked)
            }
        };
        // What may be entered need not be known.
        let enter = scene.file.camera.as_ref().is_some_and(|c| c.enter_unseen);
        if enter {
            scene.hidden.clear();
            scene.fixtures.retain(|f| f.id != UNSEEN);
        }
        let mut planner = self.ready(&scene)?;
        let answer = match target {
            Some(_) => {
                planner.feasibility().set_homing(true);
                Some((self.target.clone(), planner.plan(request, observer)))
            }
            None => {
                planner.feasibility().set_homing(false);
                self.look_behind(&mut planner, &scene, &ranked, request, observer)
            }
        };
        self.planner = Some(planner);
        let Some((taking, Answer { plan, stopped })) = answer else { return Ok(self.not_found()) };
        if plan.status != Status::Solved || plan.steps.is_empty() {
            return Ok(Turn::End(Box::new(plan), stopped));
        }
        let behind = |o: ObjectId| places.iter().filter(|p| p.behind.is_some_and(|b| b == ObjectSet::of(o))).count();
        let looked_behind = scene.object(&taking).filter(|_| target.is_none());
        let chance = looked_behind.map(|o| behind(o) as f64 / places.len().max(1) as f64);
        let known = self.known(taking, chance, began);
        Ok(self.act(plan, known))
    }

    fn known(&self, taking: String, chance: Option<f64>, began: Instant) -> Known {
        let planning = began.elapsed().as_secs_f64();
        Known { step: self.steps, seen: self.seen(), new: self.new.clone(), taking, chance, planning }
    }

    /// The first step of a plan that has one; what is left of it is kept.
    fn act(&mut self, mut plan: PlanFile, known: Known) -> Turn {
        let step = plan.steps.remove(0);
        let last = step.object == self.target;
        let rest = PlanFile { timing: Timing::default(), stats: Stats::default(), ..plan.clone() };
        self.rest = Some(Rest { taking: known.taking.clone(), plan: rest, hidden: self.hidden.len() });
        Turn::Act(Box::new(Action { object: step.object.clone(), step, last, known, plan }))
    }

    /// The first of the ranked objects for which there is a motion: of those within reach at once, then of all.
    fn look_behind(
        &self,
        planner: &mut Planner,
        scene: &Scene,
        ranked: &[ObjectId],
        request: &Request,
        observer: &mut dyn Observer,
    ) -> Option<(String, Answer)> {
        let mut failed = None;
        for at_once in [true, false] {
            for &object in ranked {
                let arm = planner.feasibility();
                if at_once && !arm.can_pick(object, &ObjectSet::EMPTY, &request.budget).unwrap_or(false) {
                    continue;
                }
                planner.retarget(object);
                let request = Request { most_removals: at_once.then_some(1), ..request.clone() };
                let answer = planner.plan(&request, observer);
                let solved = answer.plan.status == Status::Solved;
                let answer = (scene.names[object.index()].clone(), answer);
                if solved {
                    return Some(answer);
                }
                if request.budget.check().is_err() {
                    return Some(answer);
                }
                failed = failed.filter(|_| at_once).or(Some(answer));
            }
        }
        failed
    }

    fn not_found(&self) -> Turn {
        let mut plan = PlanFile::unsolved(self.empty.file.clone());
        plan.status = Status::Impossible;
        plan.why.summary = format!("`{}` was not found: every reachable volume was seen.", self.target);
        Turn::End(Box::new(plan), None)
    }

    /// A planner for the scene as it is known; the arm is where the last step left it.
    fn ready(&mut self, scene: &Scene) -> Result<Planner, Unfit> {
        let mut planner = match self.planner.take() {
            Some(mut planner) => {
                planner.update(SceneDelta::Scene(Box::new(scene.clone())))?;
                planner
            }
            None => Planner::with_model(scene.clone(), self.model.clone(), self.settings.clone())?,
        };
        if let Some(posture) = &self.posture {
            planner.update(SceneDelta::Posture(posture.clone()))?;
        }
        Ok(planner)
    }

    /// What is known: objects that stand can be moved, what was put down or cannot be seen can not.
    fn scene(&self) -> Scene {
        let mut scene = self.empty.clone();
        for seen in &self.known {
            match seen.whereabouts {
                Whereabouts::Standing => {
                    scene.names.push(seen.object.id.clone());
                    scene.objects.push(seen.object.clone());
                }
                Whereabouts::Placed => {
                    let Object { id, solid, pose, .. } = seen.object.clone();
                    scene.fixtures.push(Fixture { id, solid, pose });
                }
                Whereabouts::Gone => {}
            }
        }
        for (index, object) in scene.objects.iter().enumerate() {
            let of = |begins: Begins| shadow(&self.view, &self.region, &object.solid, &object.pose, begins);
            let (space, beyond) = (of(Begins::Middle), of(Begins::Behind(BEHIND)));
            scene.hidden.push(Hidden { behind: ObjectId(index as u16), space, beyond, glimpsed: false });
        }
        for (behind, space) in &self.hidden {
            match behind.as_ref().and_then(|id| scene.object(id)) {
                Some(behind) => {
                    scene.hidden.push(Hidden { behind, space: space.clone(), beyond: space.clone(), glimpsed: true })
                }
                None => scene.fixtures.push(Fixture {
                    id: UNSEEN.to_owned(),
                    solid: Arc::new(space.clone()),
                    pose: Pose::IDENTITY,
                }),
            }
        }
        scene
    }
}
