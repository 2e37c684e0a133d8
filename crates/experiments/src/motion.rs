//! Motion planning benchmarks: RRT-Connect and simplification over many problems, least of several
//! repeats, one thread.

use crate::motion_problems::{Problem, Problems};
use clearway_collision::lanes::exact::{Contact, contact, unchecked_pairs};
use clearway_collision::lanes::{Around, Body, Kernel, Obstacles, Piece, Settings as BodySettings};
use clearway_geometry::{Convex, Pose, Solid};
use clearway_motion::{Halton, RrtSettings, SimplifySettings, SphereSpace, Trees, connect, length, simplify};
use clearway_plan::Budget;
use clearway_robot::{Group, Sphere};
use serde::Serialize;
use std::time::{Duration, Instant};

/// How to run.
#[derive(Clone, Debug)]
pub struct Settings {
    pub range: f64,
    pub checks_per_rad: f64,
    pub repeats: usize,
    /// Per attempt, seconds.
    pub time_limit: f64,
    pub iterations: usize,
    pub simplify: SimplifySettings,
}

impl Default for Settings {
    fn default() -> Self {
        Self {
            range: 1.0,
            checks_per_rad: 32.0,
            repeats: 9,
            time_limit: 10.0,
            iterations: 1_000_000,
            simplify: SimplifySettings::default(),
        }
    }
}

/// One problem's result. Times in microseconds, costs in radians of joint distance.
#[derive(Clone, Debug, Serialize)]
pub struct Row {
    pub set: String,
    pub index: usize,
    pub solved: bool,
    pub plan_us: f64,
    pub simplify_us: f64,
    pub initial_cost: Option<f64>,
    pub cost: Option<f64>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub why: Option<String>,
    pub path: Vec<Vec<f64>>,
}

/// A robot of spheres, ready to plan for.
pub struct Planner {
    pub group: Group,
    pub spheres: Vec<Vec<Sphere>>,
    pub kernel: Kernel,
}

impl Planner {
    pub fn new(group: Group, spheres: Vec<Vec<Sphere>>) -> Self {
        let unchecked = unchecked_pairs(&group, &spheres);
        let kernel = Kernel::new(Body::new(&group, &spheres, unchecked, &BodySettings::default()));
        Self { group, spheres, kernel }
    }

    /// Why a configuration cannot be an end of a motion.
    pub fn refusal(&self, what: &str, q: &[f64], problem: &Problem, shapes: &[(Pose, Convex)]) -> Option<String> {
        for ((name, v), (low, high)) in self.group.names.iter().zip(q).zip(self.group.lower.iter().zip(&self.group.upper)) {
            if !(*low - 1e-6..=*high + 1e-6).contains(v) {
                return Some(format!("{what}: joint {name} at {v} is out of its limits, {low} to {high}"));
            }
        }
        let link = |l: usize| &self.group.links[l].name;
        Some(match contact(&self.group, &self.spheres, &self.kernel.body.unchecked, shapes, q, 0.0)? {
            Contact::Links(a, b) => format!("{what} in collision: {} touches {}", link(a), link(b)),
            Contact::Obstacle(l, o) => format!("{what} in collision: {} touches {}", link(l), problem.obstacles[o].name),
        })
    }
}

/// Plans one problem `repeats` times; the least times are kept.
pub fn run(planner: &Planner, problem: &Problem, settings: &Settings, trees: &mut Trees) -> Row {
    let shapes: Vec<(Pose, Convex)> = problem.obstacles.iter().map(|o| (o.pose, o.convex.clone())).collect();
    let mut row = Row {
        set: problem.set.clone(),
        index: problem.index,
        solved: false,
        plan_us: 0.0,
        simplify_us: 0.0,
        initial_cost: None,
        cost: None,
        why: planner.refusal("start", &problem.start, problem, &shapes),
        path: Vec::new(),
    };
    let refusals: Vec<Option<String>> =
        problem.goals.iter().map(|g| planner.refusal("goal", g, problem, &shapes)).collect();
    if row.why.is_none() && refusals.iter().all(Option::is_some) {
        row.why = refusals.into_iter().flatten().next();
    }
    if row.why.is_some() {
        return row;
    }
    let pieces = shapes
        .iter()
        .enumerate()
        .flat_map(|(i, (pose, convex))| Piece::of_solid(&Solid::new(convex.clone()), pose, i as u32).collect::<Vec<_>>())
        .collect();
    let obstacles = Obstacles::new(pieces);
    let mut standing = Vec::new();
    obstacles.mask(|_| true, &mut standing);
    let around = Around { obstacles: &obstacles, standing: &standing, margin: 0.0, hand: planner.group.hand[0] as f32 };
    let (lower, upper) = (&planner.group.lower, &planner.group.upper);
    let mut space = SphereSpace::new(&planner.kernel, around, lower, upper, settings.checks_per_rad);
    let rrt = RrtSettings { range: settings.range, iterations: settings.iterations, ..RrtSettings::default() };
    let micros = |from: Instant| from.elapsed().as_secs_f64() * 1e6;
    (row.plan_us, row.simplify_us) = (f64::INFINITY, f64::INFINITY);
    for _ in 0..settings.repeats.max(1) {
        let budget = Budget::unlimited().with_time(Duration::from_secs_f64(settings.time_limit));
        let started = Instant::now();
        let mut sampler = Halton::new(&space, 0);
        let found = connect(&mut space, &problem.start, &problem.goals, &mut sampler, &rrt, trees, &budget);
        row.plan_us = row.plan_us.min(micros(started));
        if std::env::var("COUNT").is_ok() { eprintln!("{} {} {:.1} us motions {} configurations {}", row.set,row.index,row.plan_us,space.scratch.motions,space.scratch.configurations); space.scratch.motions=0; space.scratch.configurations=0;}
        let Ok(Some(path)) = found else {
            row.simplify_us = 0.0;
            row.why = Some("no path found within the budget".to_owned());
            return row;
        };
        row.initial_cost = Some(length(&path));
        let started = Instant::now();
        let simple = simplify(&mut space, path.clone(), &settings.simplify, &budget).unwrap_or(path);
        row.simplify_us = row.simplify_us.min(micros(started));
        row.solved = true;
        row.cost = Some(length(&simple));
        row.path = simple;
    }
    row
}

/// Runs all problems, a row at a time.
pub fn run_all(planner: &Planner, problems: &Problems, settings: &Settings, mut each: impl FnMut(&Row)) {
    let mut trees = Trees::default();
    for problem in &problems.problems {
        each(&run(planner, problem, settings, &mut trees));
    }
}
