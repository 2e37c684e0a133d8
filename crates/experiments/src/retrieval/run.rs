//! One run of an experiment, from drawing the scene to the verifier's verdict.

use crate::Machine;
use crate::peers::{self, brute_force::brute_force, shortest_path::shortest_path, step_by_step::traversability};
use crate::retrieval::experiment::{Case, Draw, Experiment, Kind, TaskPlanner};
use crate::retrieval::row::{Growth, Row, Timing};
use clearway_collision::CollisionModel;
use clearway_files::FileError;
use clearway_plan::event::{Event, Observer, Silent};
use clearway_plan::plan_file::{self, LowerBound, Status};
use clearway_plan::{Budget, PlanFile, Stop};
use clearway_retrieval::handling::Handling;
use clearway_retrieval::occlusion::guess::Rule;
use clearway_retrieval::occlusion::simulated::play;
use clearway_retrieval::order::{self, Fewest};
use clearway_retrieval::push::{self, Pushes};
use clearway_retrieval::{Feasibility, FirstLimit, Planner, Request, Settings, Unfit, mobile};
use clearway_robot::Robot;
use clearway_scenarios::{self as scenarios, Wanted};
use clearway_scene::Scene;
use clearway_symbolic as symbolic;
use clearway_symbolic::engine::Ferroplan;
use clearway_symbolic::problem::{self, Asked};
use clearway_symbolic::search::Algorithm;
use clearway_verify::verify;
use sha2::{Digest, Sha256};
use std::collections::HashMap;
use std::path::Path;
use std::sync::{Arc, Mutex, OnceLock, PoisonError};
use std::time::{Duration, Instant};

/// What runs share: the robot made ready, and scenes drawn.
pub struct Bench {
    experiment: Experiment,
    /// Per run.
    time_limit: Duration,
    /// Over all of it.
    budget: Budget,
    machine: Machine,
    /// By the robot's name.
    models: Mutex<HashMap<String, Arc<CollisionModel>>>,
    /// Scenes with their hashes; drawing one takes as long as planning in some.
    scenes: Mutex<HashMap<Draw, Arc<OnceLock<Result<Drawn, String>>>>>,
}

#[derive(Clone)]
struct Drawn {
    scene: Scene,
    hash: String,
}

/// Why there is no row.
#[derive(Clone, Debug, PartialEq)]
pub enum NoRow {
    /// The whole experiment is to end.
    Stopped,
    /// An error of ours.
    Internal(String),
}

impl Bench {
    pub fn new(experiment: Experiment, time_limit: f64, budget: Budget) -> Self {
        let time_limit = Duration::from_secs_f64(time_limit);
        Self {
            experiment,
            time_limit,
            budget,
            machine: Machine::this(),
            models: Mutex::default(),
            scenes: Mutex::default(),
        }
    }

    /// Of the robot that a scene names.
    fn model(&self, scene: &Scene) -> Result<Arc<CollisionModel>, NoRow> {
        let name = &scene.file.robot.model;
        let mut models = self.models.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some(model) = models.get(name) {
            return Ok(model.clone());
        }
        let robot = Robot::load(name, Path::new("."), &[]).map_err(|e| NoRow::Internal(e.to_string()))?;
        let model = Arc::new(CollisionModel::new(Arc::new(robot)));
        models.insert(name.clone(), model.clone());
        Ok(model)
    }

    fn drawn(&self, draw: &Draw) -> Result<Drawn, NoRow> {
        let cell = self.scenes.lock().unwrap_or_else(PoisonError::into_inner).entry(*draw).or_default().clone();
        cell.get_or_init(|| draw_scene(draw)).clone().map_err(NoRow::Internal)
    }

    /// Forgets the scene of a case that was its last.
    pub fn done_with(&self, draw: &Draw) {
        self.scenes.lock().unwrap_or_else(PoisonError::into_inner).remove(draw);
    }

    pub fn run(&self, case: &Case) -> Result<Row, NoRow> {
        let Drawn { scene, hash } = self.drawn(&case.draw)?;
        let model = self.model(&scene)?;
        let mut row = Row { scene: hash, ..self.named(case) };
        let request = Request::new(case.seed, self.budget.clone().with_time(self.time_limit));
        let unfit = |unfit| NoRow::Internal(format!("{:?}: {unfit:?}", case.draw));
        let began = Instant::now();
        let plan = match case.planner {
            TaskPlanner::Exact => {
                let mut planner = Planner::with_model(scene, model, settings(case)).map_err(unfit)?;
                return self.exact(&mut planner, row);
            }
            TaskPlanner::Clearway | TaskPlanner::Farthest | TaskPlanner::Largest
                if case.draw.kind == Kind::Occluded =>
            {
                let rule = match case.planner {
                    TaskPlanner::Farthest => Rule::Farthest,
                    TaskPlanner::Largest => Rule::Largest,
                    _ => Rule::Expected,
                };
                play(scene, model, settings(case), rule, &request, &mut Silent).map_err(unfit)?.0
            }
            TaskPlanner::Clearway
            | TaskPlanner::Paper
            | TaskPlanner::AllKnown
            | TaskPlanner::FixedBase
            | TaskPlanner::Farthest
            | TaskPlanner::Largest => {
                let mut growing = Growing::default();
                let mut planner = Planner::with_model(scene, model, settings(case)).map_err(unfit)?;
                let plan = planner.plan(&request, &mut growing).plan;
                if self.experiment == Experiment::Graphs {
                    row.growth = growing.0;
                }
                plan
            }
            TaskPlanner::Streams | TaskPlanner::StreamsIncremental | TaskPlanner::Sequences => {
                self.with_streams(scene, model, case, &request).map_err(|error| match error {
                    Unmade::Unfit(error) => unfit(error),
                    Unmade::Read(error) => NoRow::Internal(error.to_string()),
                })?
            }
            TaskPlanner::Traversability | TaskPlanner::ShortestPath | TaskPlanner::BruteForce => {
                let Settings { ways, carry, push, mobile, .. } = settings(case);
                let mut arm = Feasibility::new(scene, model, ways, carry, push, mobile).map_err(unfit)?;
                let peer: &peers::Peer = match case.planner {
                    TaskPlanner::Traversability => &traversability,
                    TaskPlanner::ShortestPath => &shortest_path,
                    _ => &brute_force,
                };
                peers::plan(&mut arm, peer, &request)
            }
        };
        self.check_not_stopped()?;
        self.judge(plan, began, row)
    }

    /// The target had with symbols and streams; what they need of the robot and of files is made ready before the clock runs.
    fn with_streams(
        &self,
        scene: Scene,
        model: Arc<CollisionModel>,
        case: &Case,
        request: &Request,
    ) -> Result<PlanFile, Unmade> {
        let domain = symbolic::domain();
        let streams = symbolic::streams(&domain).map_err(Unmade::Read)?;
        let mut handling = Handling::new(scene, model, settings(case), request.seed).map_err(Unmade::Unfit)?;
        let goal =
            problem::retrieval(&domain, handling.scene()).ok_or_else(|| Unmade::Read(FileError::new("", "no goal")))?;
        let algorithm = match case.planner {
            TaskPlanner::StreamsIncremental => Algorithm::Incremental,
            _ => Algorithm::Focused,
        };
        let asked = Asked {
            domain: &domain,
            streams: &streams,
            goal: &goal,
            retrieval: true,
            algorithm,
            engine: &Ferroplan::default(),
            removals: false,
            sequences: case.planner == TaskPlanner::Sequences,
        };
        Ok(problem::solve(&mut handling, &asked, request.seed, &request.budget).plan)
    }

    /// Takes a plan into its row, with the verdict on it and its lower bound.
    fn judge(&self, plan: PlanFile, began: Instant, mut row: Row) -> Result<Row, NoRow> {
        row.status = match plan.status {
            Status::Solved => "solved",
            Status::Impossible => "impossible",
            Status::OutOfBudget => "out_of_budget",
        }
        .to_owned();
        row.verdict = "none".to_owned();
        if plan.status == Status::Solved {
            match verify(&plan, Path::new("."), &self.budget) {
                Ok(report) if report.is_valid() => row.verdict = "valid".to_owned(),
                Ok(_) => (row.status, row.verdict) = ("refused".to_owned(), "violations".to_owned()),
                Err(error) => {
                    self.check_not_stopped()?;
                    return Err(NoRow::Internal(format!("the verifier: {error}")));
                }
            }
        }
        if let Some(LowerBound { removed, kind, .. }) = &plan.lower_bound {
            (row.bound, row.bound_kind) = (*removed, kind.clone());
        }
        row.base_moves = plan.drives().len();
        row.actions = plan.known.iter().map(|k| k.planning).collect();
        row.motion = plan.duration();
        row.removed = plan.removed.len();
        row.order = plan.removed;
        row.iterations = plan.stats.iterations as u64;
        row.sequences = plan.stats.sequences_tried as u64;
        row.samples = plan.stats.samples;
        row.roadmap_nodes = plan.stats.roadmap_nodes;
        row.retrieval_nodes = plan.stats.retrieval_nodes;
        let plan_file::Timing { total, task, motion } = plan.timing;
        let judged = (began.elapsed().as_secs_f64() - total).max(0.0);
        row.timing = Timing { total, task, motion, judged };
        Ok(row)
    }

    /// The fewest removals over all ways of the arm and the routes that a run of Clearway's finds, but those
    /// along which it found no motion.
    fn exact(&self, planner: &mut Planner, mut row: Row) -> Result<Row, NoRow> {
        let budget = self.budget.clone().with_time(self.time_limit);
        planner.plan(&Request::new(row.seed, budget.clone()), &mut Growing::default());
        let arm = planner.feasibility();
        arm.drop_failed();
        let target = arm.scene().target;
        let began = Instant::now();
        let found = arm
            .frozen(&budget)
            .and_then(|ways| order::fewest(&ways, &[], target, usize::MAX, order::THOROUGH, &budget));
        row.timing.task = began.elapsed().as_secs_f64();
        row.timing.total = row.timing.task;
        self.check_not_stopped()?;
        let set = match found {
            Ok(Fewest::Found(set)) => Some(set),
            Ok(_) | Err(Stop::Deadline | Stop::Iterations) => None,
            Err(Stop::Cancelled) => return Err(NoRow::Stopped),
        };
        row.status = if set.is_some() { "solved" } else { "out_of_budget" }.to_owned();
        row.verdict = "none".to_owned();
        row.optimum = set.map(|set| set.len());
        row.removed = row.optimum.unwrap_or(0);
        Ok(row)
    }

    fn check_not_stopped(&self) -> Result<(), NoRow> {
        self.budget.check().map_err(|_| NoRow::Stopped)
    }

    /// A row with nothing but what was asked for.
    pub fn named(&self, case: &Case) -> Row {
        Row {
            experiment: self.experiment.name().to_owned(),
            planner: case.planner.name().to_owned(),
            objects: case.draw.objects,
            first_limit: named(case.first_limit),
            least_removals: case.draw.least_removals,
            scene_seed: case.draw.seed,
            seed: case.seed,
            version: env!("CARGO_PKG_VERSION").to_owned(),
            machine: self.machine.clone(),
            ..Row::default()
        }
    }
}

/// Why symbols and streams could not be asked.
enum Unmade {
    Unfit(Unfit),
    Read(FileError),
}

/// As it stands in rows.
fn named(limit: FirstLimit) -> String {
    match limit {
        FirstLimit::One => "1",
        FirstLimit::GraspCover => "grasp",
        FirstLimit::All => "all",
    }
    .to_owned()
}

fn settings(case: &Case) -> Settings {
    let settings = if case.planner == TaskPlanner::Paper { Settings::paper() } else { Settings::default() };
    let mobile = mobile::Settings { drives: case.planner != TaskPlanner::FixedBase, ..settings.mobile };
    // The paper's tables are of picks.
    let push = push::Settings { when: Pushes::Never, ..settings.push };
    Settings { first_limit: case.first_limit, push, mobile, ..settings }
}

fn draw_scene(draw: &Draw) -> Result<Drawn, String> {
    let wanted = Wanted { objects: draw.objects, seed: draw.seed, least_removals: Some(draw.least_removals) };
    let drawn = match draw.kind {
        Kind::Shelf => scenarios::shelf(&wanted),
        Kind::Large => scenarios::large(&wanted),
        Kind::Occluded => scenarios::occluded(&wanted),
        Kind::Table => scenarios::table(&wanted, false),
        Kind::Contrast => scenarios::table(&wanted, true),
        Kind::Stacked => scenarios::stacked(&Wanted { least_removals: None, ..wanted }),
    };
    let file = drawn.map_err(|e| e.to_string())?.file;
    let text = serde_json::to_string(&file).map_err(|e| e.to_string())?;
    let hash = Sha256::digest(text.as_bytes()).iter().map(|b| format!("{b:02x}")).collect();
    let scene = Scene::from_file_struct(file, Path::new(".")).map_err(|e| e.to_string())?;
    Ok(Drawn { scene, hash })
}

/// Listens to how the graphs grow.
#[derive(Default)]
struct Growing(Vec<Growth>);

impl Observer for Growing {
    fn event(&mut self, event: Event) {
        if let Event::Iteration { exploration_limit, roadmap_nodes, retrieval_nodes } = event {
            self.0.push(Growth { exploration_limit, roadmap_nodes, retrieval_nodes });
        }
    }
}
