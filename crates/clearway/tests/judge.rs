//! Faults planted into plans that the planner made: the verifier finds them.

#[path = "../../verify/tests/faults/mod.rs"]
mod faults;

use clearway::scenarios::{self, Wanted};
use clearway::{Budget, Outcome, PlanFile, Planner, Request, Robot, Scene, Settings, Silent, solve};
use rand::SeedableRng;
use rand_xoshiro::Xoshiro256PlusPlus;
use std::path::Path;
use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::time::Duration;

/// Of each fault.
const PLANTED: usize = 19;
/// How often a plan may have no occasion for a fault.
const TRIES: usize = 600;

/// A verified plan of a generated shelf.
fn planned(objects: usize, seed: u64) -> PlanFile {
    let here = Path::new(".");
    let robot = Arc::new(Robot::load("ur10_ag95", here, &[]).expect("the built-in robot"));
    let drawn = scenarios::shelf(&Wanted { objects, seed, least_removals: None }).expect("a scene");
    let scene = Scene::from_file_struct(drawn.file, here).expect("a sound scene");
    let mut planner = Planner::new(scene, robot, Settings::default()).expect("a fit scene");
    let request = Request::new(1, Budget::unlimited().with_time(Duration::from_secs(60)));
    match solve(&mut planner, &request, here, &mut Silent) {
        Outcome::Solved(verified) => verified.into_inner(),
        Outcome::Refused(rejected) => panic!("{objects} objects, seed {seed}: refused: {rejected}"),
        other => panic!("{objects} objects, seed {seed}: {other:?}"),
    }
}

/// The bottle's rim passed the shelf's front edge between two rows 3 mm apart, 0.27 mm deep.
#[test]
fn edges_that_pass_between_rows() {
    assert_eq!(planned(6, 1185).removed.len(), 2);
}

/// What became of one kind of fault.
struct Row {
    name: &'static str,
    planted: usize,
    caught: usize,
    /// Caught under the name that the fault should have.
    named: usize,
}

fn plant(fault: &faults::Fault, plans: &[PlanFile]) -> Row {
    // Not shared between threads: it moves.
    let robots: Vec<_> = plans.iter().map(faults::robot::Robot::new).collect();
    let mut random = Xoshiro256PlusPlus::seed_from_u64(1);
    let mut row = Row { name: fault.name, planted: 0, caught: 0, named: 0 };
    for attempt in 0..TRIES {
        if row.planted == PLANTED {
            break;
        }
        let which = attempt % plans.len();
        let mut plan = plans[which].clone();
        if (fault.plant)(&mut plan, &robots[which], &mut random).is_none() {
            continue;
        }
        let report = clearway_verify::verify(&plan, Path::new("."), &Budget::unlimited()).expect("judged");
        row.planted += 1;
        row.caught += usize::from(!report.is_valid());
        row.named += usize::from(fault.expected.iter().any(|kind| report.has(*kind)));
    }
    row
}

#[test]
fn faults_in_real_plans_are_found() {
    let plans = [(8, 1), (12, 2), (16, 3)].map(|(objects, seed)| planned(objects, seed));
    let faults = faults::all();
    let next = AtomicUsize::new(0);
    let worker = || {
        let mut rows = Vec::new();
        while let Some(fault) = faults.get(next.fetch_add(1, Ordering::Relaxed)) {
            rows.push(plant(fault, &plans));
        }
        rows
    };
    let threads = std::thread::available_parallelism().map_or(1, usize::from);
    let rows: Vec<Row> = std::thread::scope(|scope| {
        let workers: Vec<_> = (0..threads).map(|_| scope.spawn(worker)).collect();
        workers.into_iter().flat_map(|w| w.join().expect("no panic")).collect()
    });
    println!("{:<42} {:>7} {:>7} {:>10}", "fault", "planted", "caught", "under name");
    for row in &rows {
        println!("{:<42} {:>7} {:>7} {:>10}", row.name, row.planted, row.caught, row.named);
    }
    let sum = |of: fn(&Row) -> usize| rows.iter().map(of).sum::<usize>();
    let (planted, caught, named) = (sum(|r| r.planted), sum(|r| r.caught), sum(|r| r.named));
    println!("{:<42} {planted:>7} {caught:>7} {named:>10}", "all");
    assert!(planted >= 1_000, "only {planted} planted");
    assert!(caught * 100 >= planted * 99, "{caught} of {planted} caught");
}
