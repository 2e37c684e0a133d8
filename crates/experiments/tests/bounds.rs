//! Lower bounds against the exact fewest removals, on scenes small enough to know them.
//!
//! `CLEARWAY_SCENES=2000 cargo test --release -p clearway-experiments --test bounds -- --nocapture` looks at
//! more of them and tells what it found.

use clearway_collision::CollisionModel;
use clearway_plan::event::Silent;
use clearway_plan::{Budget, SceneFile};
use clearway_retrieval::order::{self, Fewest};
use clearway_retrieval::{Planner, Request, Settings};
use clearway_robot::Robot;
use clearway_scenarios::{ROBOT, Wanted, shelf};
use clearway_scene::Scene;
use std::path::Path;
use std::sync::Arc;
use std::time::Duration;

#[test]
fn no_bound_is_above_the_optimum() {
    let scenes: u64 = std::env::var("CLEARWAY_SCENES").ok().and_then(|n| n.parse().ok()).unwrap_or(40);
    let robot = Arc::new(Robot::load(ROBOT, Path::new("."), &[]).expect("the built-in robot"));
    let model = Arc::new(CollisionModel::new(robot));
    let (mut known, mut equal, mut planned, mut fewest) = (0, 0, 0, 0);
    for seed in 1..=scenes {
        let wanted = Wanted { objects: 4 + seed as usize % 7, seed, least_removals: Some(1) };
        let file: SceneFile = shelf(&wanted).expect("a scene").file;
        let scene = Scene::from_file_struct(file, Path::new(".")).expect("a sound scene");
        let target = scene.target;
        let mut planner = Planner::with_model(scene, model.clone(), Settings::default()).expect("a fit scene");
        let budget = Budget::unlimited().with_time(Duration::from_secs(5));
        let plan = planner.plan(&Request::new(1, budget), &mut Silent).plan;
        let unlimited = Budget::unlimited();
        let ways = planner.feasibility().frozen(&unlimited).expect("no limit");
        let Fewest::Found(set) =
            order::fewest(&ways, &[], target, usize::MAX, 1_000_000, &unlimited).expect("no limit")
        else {
            continue;
        };
        known += 1;
        let Some(bound) = plan.lower_bound else { continue };
        planned += 1;
        assert!(bound.removed <= set.len(), "seed {seed}: {} needed at least, {} do", bound.removed, set.len());
        assert!(set.len() <= plan.removed.len(), "seed {seed}: the plan's ways are among all ways");
        equal += u64::from(bound.removed == set.len());
        fewest += u64::from(plan.removed.len() == set.len());
    }
    println!(
        "{scenes} scenes, optimum known in {known}, planned {planned}: bound equal in {equal}, plan equal in {fewest}"
    );
    assert!(known * 10 >= scenes * 8 && equal * 2 > planned, "{known} {planned} {equal}");
}
