//! Faults planted into plans that the planner made: the verifier finds them.

#[path = "../../verify/tests/faults/mod.rs"]
mod faults;

use clearway::scenarios::{self, Wanted};
use clearway::{Budget, Outcome, PlanFile, Planner, Request, Robot, Scene, Settings, Silent, solve};
use rand::SeedableRng;
use rand_xoshiro::Xoshiro256PlusPlus;
use std::path::Path;
use std::sync::Arc;
use std::time::Duration;

/// Of each fault.
const PLANTED: usize = 30;
/// How often a plan may have no occasion for a fault.
const TRIES: usize = 600;

/// A verified plan of a generated shelf.
fn planned(objects: usize, seed: u64) -> PlanFile {
    let here = Path::new(".");
    let robot = Arc::new(Robot::load("ur10_ag95", here, &[]).expect("the built-in robot"));
    let drawn = scenarios::shelf(&Wanted { objects, seed, least_removals: None }).expect("a scene");
    let scene = Scene::from_file_struct(drawn.file, here).expect("a sound scene");
    let mut planner = Planner::new(scene, robot, Settings::default()).expect("a fit scene");
    let request = Request { seed: 1, budget: Budget::unlimited().with_time(Duration::from_secs(60)) };
    match solve(&mut planner, &request, here, &mut Silent) {
        Outcome::Solved(verified) => verified.into_inner(),
        Outcome::Refused(rejected) => panic!("{objects} objects, seed {seed}: refused: {rejected}"),
        other => panic!("{objects} objects, seed {seed}: {other:?}"),
    }
}

#[test]
fn faults_in_real_plans_are_found() {
    let plans: Vec<_> = [(12, 1), (16, 2), (20, 3)]
        .map(|(objects, seed)| planned(objects, seed))
        .into_iter()
        .map(|plan| (faults::robot::Robot::new(&plan), plan))
        .collect();
    let mut random = Xoshiro256PlusPlus::seed_from_u64(1);
    let (mut all, mut caught, mut missed) = (0, 0, Vec::new());
    println!("{:<42} {:>7} {:>7} {:>10}", "fault", "planted", "caught", "under name");
    for fault in faults::all() {
        let (mut planted, mut refused, mut named) = (0, 0, 0);
        for attempt in 0..TRIES {
            if planted == PLANTED {
                break;
            }
            let (robot, plan) = &plans[attempt % plans.len()];
            let mut plan = plan.clone();
            if (fault.plant)(&mut plan, robot, &mut random).is_none() {
                continue;
            }
            planted += 1;
            let report = clearway_verify::verify(&plan, Path::new("."), &Budget::unlimited()).expect("judged");
            refused += usize::from(!report.is_valid());
            named += usize::from(fault.expected.iter().any(|kind| report.has(*kind)));
            if report.is_valid() {
                missed.push(format!("{} (attempt {attempt})", fault.name));
            }
        }
        println!("{:<42} {planted:>7} {refused:>7} {named:>10}", fault.name);
        all += planted;
        caught += refused;
    }
    println!("{:<42} {all:>7} {caught:>7}", "all");
    assert!(all >= 1_000, "only {all} planted");
    assert!(caught * 100 >= all * 99, "{caught} of {all} caught; missed:\n{}", missed.join("\n"));
}
