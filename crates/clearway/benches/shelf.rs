//! The main job on generated shelves: solved, refused, removals, time to a complete plan.
//!
//! `cargo bench --bench shelf [-- SCENES_PER_SIZE [FIRST_SEED]]`; one thread, verification timed
//! apart. Prints one line per size and the worst scenes.

use clearway::scenarios::{self, Wanted};
use clearway::{Budget, CollisionModel, Outcome, Planner, Request, Robot, Scene, Settings, Silent, duration, solve};
use std::path::Path;
use std::sync::Arc;
use std::time::{Duration, Instant};

fn main() {
    let mut numbers = std::env::args().skip(1).filter_map(|a| a.parse::<u64>().ok());
    let count = numbers.next().unwrap_or(20);
    let first = numbers.next().unwrap_or(1);
    let here = Path::new(".");
    let robot = Arc::new(Robot::load("ur10_ag95", here, &[]).expect("the built-in robot"));
    let began = Instant::now();
    let model = Arc::new(CollisionModel::new(robot));
    println!("robot ready in {:.1} ms; the times below are from a scene to a complete plan", began.elapsed().as_secs_f64() * 1e3);
    println!("objects  solved  refused  removed  median ms  p95 ms  task ms  motion ms  verify ms  motion s");
    for objects in [12, 16, 20] {
        let (mut times, mut task, mut motion, mut judged, mut lasts) = (vec![], vec![], vec![], vec![], vec![]);
        let (mut removed, mut refused) = (vec![], 0);
        let mut slow = Vec::new();
        for seed in first..first + count {
            let drawn = scenarios::shelf(&Wanted { objects, seed, least_removals: None }).expect("a scene");
            let scene = Scene::from_file_struct(drawn.file, here).expect("a sound scene");
            let began = Instant::now();
            let mut planner = Planner::with_model(scene, model.clone(), Settings::default()).expect("a fit scene");
            let prepared = began.elapsed();
            let request = Request { seed: 1, budget: Budget::unlimited().with_time(Duration::from_secs(10)) };
            let began = Instant::now();
            match solve(&mut planner, &request, here, &mut Silent) {
                Outcome::Solved(verified) => {
                    let plan = verified.plan();
                    let total = plan.timing.total + prepared.as_secs_f64();
                    judged.push(began.elapsed().as_secs_f64() - plan.timing.total);
                    times.push(total);
                    task.push(plan.timing.task);
                    motion.push(plan.timing.motion);
                    lasts.push(duration(plan));
                    removed.push(plan.removed.len() as f64);
                    slow.push((total, seed));
                }
                Outcome::Refused(why) => {
                    refused += 1;
                    println!("seed {seed}: refused: {}", why.to_string().lines().take(4).collect::<Vec<_>>().join(" | "));
                }
                other => println!("seed {seed}: {}", format!("{other:?}").chars().take(80).collect::<String>()),
            }
        }
        let ms = |v: &mut Vec<f64>, part: f64| quantile(v, part) * 1e3;
        println!(
            "{objects:7}  {:6}  {refused:7}  {:7.2}  {:9.1}  {:6.1}  {:7.1}  {:9.1}  {:9.1}  {:8.1}",
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

fn quantile(values: &mut [f64], part: f64) -> f64 {
    values.sort_by(f64::total_cmp);
    values.get(((values.len() as f64 - 1.0) * part).round() as usize).copied().unwrap_or(f64::NAN)
}
