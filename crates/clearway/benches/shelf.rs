//! The main job on generated shelves: solved and verified, removals, time to a complete plan.
//!
//! `cargo bench --bench shelf [-- SCENES_PER_SIZE [FIRST_SEED [REPEATS]]]`; one thread, the robot made
//! ready once, verification timed apart; of all repeats the least. Prints one line per size and the
//! worst scenes.

use clearway::scenarios::{self, Wanted};
use clearway::{Budget, CollisionModel, Outcome, Planner, Request, Robot, Scene, Settings, Silent, duration, solve};
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
    println!("robot ready in {:.1} ms; the times below are from a scene to a complete plan", began.elapsed().as_secs_f64() * 1e3);
    println!("objects  solved  removed  median ms  p95 ms  task ms  motion ms  verify ms  motion s");
    for objects in [12, 16, 20] {
        let (mut times, mut task, mut motion, mut judged, mut lasts) = (vec![], vec![], vec![], vec![], vec![]);
        let mut removed = vec![];
        let mut slow = Vec::new();
        for seed in first..first + count {
            let drawn = scenarios::shelf(&Wanted { objects, seed, least_removals: None }).expect("a scene");
            let scene = Scene::from_file_struct(drawn.file, here).expect("a sound scene");
            let runs: Vec<Option<Run>> = (0..repeats).map(|_| run(&scene, &model, here, seed)).collect();
            // The machine is shared: the least of all repeats says what the work takes.
            let least = |value: fn(&Run) -> f64| runs.iter().flatten().map(value).fold(f64::INFINITY, f64::min);
            let Some(Some(any)) = runs.first() else { continue };
            times.push(least(|r| r.total));
            task.push(least(|r| r.task));
            motion.push(least(|r| r.motion));
            judged.push(least(|r| r.judged));
            lasts.push(any.lasts);
            removed.push(any.removed);
            slow.push((least(|r| r.total), seed));
        }
        let ms = |v: &mut Vec<f64>, part: f64| quantile(v, part) * 1e3;
        println!(
            "{objects:7}  {:6}  {:7.2}  {:9.1}  {:6.1}  {:7.1}  {:9.1}  {:9.1}  {:8.1}",
            format!("{}/{count}", times.len()),
            removed.iter().sum::<f64>() / removed.len().max(1) as f64,
            ms(&mut times.clone(), 0.5),
            ms(&mut times, 0.95),
            ms(&mut task, 0.5),
            ms(&mut motion, 0.5),
            ms(&mut judged, 0.5),
            quantile(&mut lasts, 0.5),
        );
        slow.sort_by(|a, b| b.0.total_cmp(&a.0));
        let worst: Vec<String> = slow.iter().take(4).map(|(t, s)| format!("seed {s}: {:.0} ms", t * 1e3)).collect();
        println!("         slowest: {}", worst.join(", "));
    }
}

/// One plan's seconds.
struct Run {
    total: f64,
    task: f64,
    motion: f64,
    judged: f64,
    lasts: f64,
    removed: f64,
}

/// Plans a scene from nothing but the robot; `None` when there is no verified plan.
fn run(scene: &Scene, model: &Arc<CollisionModel>, here: &Path, seed: u64) -> Option<Run> {
    let began = Instant::now();
    let mut planner = Planner::with_model(scene.clone(), model.clone(), Settings::default()).expect("a fit scene");
    let prepared = began.elapsed();
    let request = Request { seed: 1, budget: Budget::unlimited().with_time(Duration::from_secs(10)) };
    let began = Instant::now();
    match solve(&mut planner, &request, here, &mut Silent) {
        Outcome::Solved(verified) => {
            let plan = verified.plan();
            Some(Run {
                total: plan.timing.total + prepared.as_secs_f64(),
                task: plan.timing.task,
                motion: plan.timing.motion,
                judged: began.elapsed().as_secs_f64() - plan.timing.total,
                lasts: duration(plan),
                removed: plan.removed.len() as f64,
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

fn quantile(values: &mut [f64], part: f64) -> f64 {
    values.sort_by(f64::total_cmp);
    values.get(((values.len() as f64 - 1.0) * part).round() as usize).copied().unwrap_or(f64::NAN)
}
