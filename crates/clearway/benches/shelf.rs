//! The main job on generated shelves: solved and verified, removals, time to a complete plan.
//!
//! `cargo bench --bench shelf [-- SCENES_PER_SIZE [FIRST_SEED [REPEATS]]]`; one thread, the robot made
//! ready once, the lower bound and verification timed apart ("judged"); of all repeats the least.
//! "proved": plans that remove no more than their bound says is needed. Prints one line per size and
//! the worst scenes.

use clearway::scenarios::{self, Wanted};
use clearway::{Budget, CollisionModel, Outcome, Planner, Request, Robot, Scene, Settings, Silent, solve};
use clearway_experiments::statistics::{mean, quantile};
use std::path::Path;
use std::sync::Arc;
use std::time::{Duration, Instant};

fn main() {
    let mut numbers = std::env::args().skip(1).filter_map(|a| a.parse::<u64>().ok());
    let count = numbers.next().unwrap_or(20);
    let first = numbers.next().unwrap_or(1);
    let repeats = numbers.next().unwrap_or(3).max(1);
    let here = Path::new(".");
    let robot = Arc::new(Robot::load("ur10_ag95", here, &[]).expect("the built-in robot"));
    let began = Instant::now();
    let model = Arc::new(CollisionModel::new(robot));
    println!(
        "robot ready in {:.1} ms; the times below are from a scene to a complete plan",
        began.elapsed().as_secs_f64() * 1e3
    );
    println!("objects  solved  removed  proved  median ms  p95 ms  task ms  motion ms  judged ms  motion s");
    for objects in [12, 16, 20] {
        let mut best = Vec::new();
        for seed in first..first + count {
            let drawn = scenarios::shelf(&Wanted { objects, seed, least_removals: None }).expect("a scene");
            let scene = Scene::from_file_struct(drawn.file, here).expect("a sound scene");
            let runs: Option<Vec<Run>> = (0..repeats).map(|_| run(&scene, &model, here, seed)).collect();
            // The machine is shared: the least of all repeats says what the work takes.
            best.extend(runs.into_iter().flatten().reduce(Run::least));
        }
        let column = |value: fn(&Run) -> f64| best.iter().map(value).collect::<Vec<f64>>();
        let ms = |value, part| quantile(&column(value), part).unwrap_or(f64::NAN) * 1e3;
        println!(
            "{objects:7}  {:6}  {:7.2}  {:6}  {:9.1}  {:6.1}  {:7.1}  {:9.1}  {:9.1}  {:8.1}",
            format!("{}/{count}", best.len()),
            mean(&column(|r| r.removed)).unwrap_or(f64::NAN),
            best.iter().filter(|r| r.proved).count(),
            ms(|r| r.total, 0.5),
            ms(|r| r.total, 0.95),
            ms(|r| r.task, 0.5),
            ms(|r| r.motion, 0.5),
            ms(|r| r.judged, 0.5),
            quantile(&column(|r| r.lasts), 0.5).unwrap_or(f64::NAN),
        );
        best.sort_by(|a, b| b.total.total_cmp(&a.total));
        let worst: Vec<String> =
            best.iter().take(4).map(|r| format!("seed {}: {:.0} ms", r.seed, r.total * 1e3)).collect();
        println!("         slowest: {}", worst.join(", "));
    }
}

/// One plan's seconds.
struct Run {
    seed: u64,
    total: f64,
    task: f64,
    motion: f64,
    judged: f64,
    lasts: f64,
    removed: f64,
    proved: bool,
}

impl Run {
    /// The least of both in each time.
    fn least(self, other: Self) -> Self {
        Self {
            total: self.total.min(other.total),
            task: self.task.min(other.task),
            motion: self.motion.min(other.motion),
            judged: self.judged.min(other.judged),
            ..self
        }
    }
}

/// Plans a scene from nothing but the robot; `None` when there is no verified plan.
fn run(scene: &Scene, model: &Arc<CollisionModel>, here: &Path, seed: u64) -> Option<Run> {
    let began = Instant::now();
    let mut planner = Planner::with_model(scene.clone(), model.clone(), Settings::default()).expect("a fit scene");
    let prepared = began.elapsed();
    let request = Request::new(1, Budget::unlimited().with_time(Duration::from_secs(10)));
    let began = Instant::now();
    match solve(&mut planner, &request, here, &mut Silent) {
        Outcome::Solved(verified) => {
            let plan = verified.plan();
            Some(Run {
                seed,
                total: plan.timing.total + prepared.as_secs_f64(),
                task: plan.timing.task,
                motion: plan.timing.motion,
                judged: began.elapsed().as_secs_f64() - plan.timing.total,
                lasts: plan.duration(),
                removed: plan.removed.len() as f64,
                proved: plan.lower_bound.as_ref().is_some_and(|b| b.removed == plan.removed.len()),
            })
        }
        Outcome::Refused(why) => {
            println!("seed {seed}: refused: {}", why.to_string().lines().take(4).collect::<Vec<_>>().join(" | "));
            None
        }
        other => {
            println!("seed {seed}: {}", format!("{other:?}").chars().take(80).collect::<String>());
            None
        }
    }
}
