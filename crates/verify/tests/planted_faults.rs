//! Every fault planted into a valid plan is found, under its own name.
//!
//! Plans come from the hand-planned gantry; or, if `CLEARWAY_PLANS` names a folder, from the plan
//! files in it.

mod faults;
mod gantry;

use clearway_plan::{Budget, PlanFile};
use clearway_verify::{Report, ViolationKind, read_plan, verify};
use faults::robot::Robot;
use rand::SeedableRng;
use rand_xoshiro::Xoshiro256PlusPlus;
use std::path::{Path, PathBuf};
use std::time::Instant;

/// Of each fault.
const PLANTED: usize = 40;
/// How often a plan may have no occasion for a fault.
const TRIES: usize = 2_000;

struct Valid {
    plan: PlanFile,
    directory: PathBuf,
    robot: Robot,
}

fn judge(plan: &PlanFile, directory: &Path) -> Report {
    verify(plan, directory, &Budget::unlimited()).unwrap_or_else(|error| panic!("not judged: {error}"))
}

fn valid_plans() -> Vec<Valid> {
    let valid = |plan: PlanFile, directory: PathBuf| {
        let report = judge(&plan, &directory);
        assert!(report.is_valid(), "{report}");
        Valid { robot: Robot::new(&plan), plan, directory }
    };
    let Some(folder) = std::env::var_os("CLEARWAY_PLANS") else {
        let mut random = Xoshiro256PlusPlus::seed_from_u64(2);
        return (0..12).map(|_| valid(gantry::plan(&mut random), PathBuf::new())).collect();
    };
    let mut files: Vec<PathBuf> =
        std::fs::read_dir(&folder).expect("a folder").map(|e| e.expect("an entry").path()).collect();
    files.sort();
    files
        .into_iter()
        .filter(|f| f.extension().is_some_and(|e| e == "json"))
        .map(|f| (read_plan(&f).unwrap_or_else(|e| panic!("{e}")), f.parent().unwrap_or(Path::new("")).to_owned()))
        .filter(|(plan, _)| !plan.steps.is_empty())
        .map(|(plan, directory)| valid(plan, directory))
        .collect()
}

#[test]
fn every_planted_fault_is_found() {
    let plans = valid_plans();
    assert!(!plans.is_empty());
    let mut random = Xoshiro256PlusPlus::seed_from_u64(3);
    let (mut all, mut misses) = (0, Vec::new());
    println!("{:<42} {:>7} {:>7} {:>9}", "fault", "planted", "found", "ms each");
    for fault in faults::all() {
        let (mut planted, mut found, mut seconds) = (0_usize, 0_usize, 0.0);
        for attempt in 0..TRIES {
            if planted == PLANTED {
                break;
            }
            let valid = &plans[attempt % plans.len()];
            let mut plan = valid.plan.clone();
            if (fault.plant)(&mut plan, &valid.robot, &mut random).is_none() {
                continue;
            }
            planted += 1;
            let start = Instant::now();
            let report = judge(&plan, &valid.directory);
            seconds += start.elapsed().as_secs_f64();
            if fault.expected.iter().any(|kind: &ViolationKind| report.has(*kind)) {
                found += 1;
            } else {
                misses.push(format!("{} (attempt {attempt}): {report}", fault.name));
            }
        }
        println!("{:<42} {planted:>7} {found:>7} {:>9.2}", fault.name, seconds * 1e3 / planted.max(1) as f64);
        all += planted;
    }
    println!("{:<42} {all:>7}", "all");
    assert!(misses.is_empty(), "{} missed:\n{}", misses.len(), misses.join("\n"));
    assert!(all >= 1_000, "only {all} planted");
}
