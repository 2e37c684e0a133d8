//! What is proved never to be taken, against what is.
#![allow(clippy::unwrap_used)]

use clearway_plan::event::Silent;
use clearway_plan::plan_file::Status;
use clearway_plan::{Budget, ObjectId, ObjectSet};
use clearway_retrieval::{Planner, Request, Settings};
use clearway_robot::Robot;
use clearway_scene::Scene;
use rand::{RngExt, SeedableRng};
use rand_xoshiro::Xoshiro256PlusPlus;
use std::path::Path;
use std::sync::Arc;

fn planner(scene: &str) -> Planner {
    let scene = Scene::from_text(Path::new("scene.yaml"), scene).unwrap();
    let robot = Arc::new(Robot::load("ur10_ag95", Path::new("."), &[]).unwrap());
    Planner::new(scene, robot, Settings::default()).unwrap()
}

/// A compartment, and a tray beside the robot.
fn compartment(width: f64, objects: &str) -> String {
    let (left, right) = (width / 2.0 + 0.01, -width / 2.0 - 0.01);
    format!(
        "format: clearway-scene/1
robot: {{model: ur10_ag95, base: {{position: [0, 0, 0.3]}}}}
fixtures:
  - {{id: floor, box: {{size: [0.6, 0.9, 0.02]}}, position: [0.95, 0, 0.59]}}
  - {{id: top, box: {{size: [0.6, 0.9, 0.02]}}, position: [0.95, 0, 0.96]}}
  - {{id: left, box: {{size: [0.6, 0.02, 0.35]}}, position: [0.95, {left}, 0.775]}}
  - {{id: right, box: {{size: [0.6, 0.02, 0.35]}}, position: [0.95, {right}, 0.775]}}
  - {{id: table, box: {{size: [0.5, 0.8, 0.02]}}, position: [0.1, -0.8, 0.49]}}
objects:
{objects}
  - {{id: wanted, cylinder: {{radius: 0.035, height: 0.2}}, position: [1.05, 0, 0.7]}}
target: wanted
place:
  - {{id: tray, size: [0.5, 0.8], position: [0.1, -0.8, 0.5]}}
"
    )
}

#[test]
fn nothing_gets_past_what_no_hand_can_hold() {
    for (wide, stuck) in [(0.36, true), (0.05, false)] {
        let crate_ = format!("  - {{id: crate, box: {{size: [0.05, {wide}, 0.3]}}, position: [0.8, 0, 0.75]}}");
        let mut planner = planner(&compartment(0.38, &crate_));
        let plan = planner.plan(&Request::new(1, Budget::unlimited().with_iterations(40)), &mut Silent).plan;
        let (status, other) = if stuck { (Status::Impossible, "`crate`") } else { (Status::Solved, "") };
        assert!(plan.status == status && plan.why.summary.contains(other), "{wide}: {}", plan.why.summary);
        let all = planner.scene().all();
        let proved = planner.feasibility().proved_stuck(ObjectId(1), &Budget::unlimited()).unwrap();
        assert_eq!(proved, if stuck { all } else { ObjectSet::EMPTY });
    }
}

#[test]
fn what_can_be_taken_is_never_called_stuck() {
    let mut random = Xoshiro256PlusPlus::seed_from_u64(3);
    let (mut taken, mut stuck) = (0, 0);
    for _ in 0..12 {
        let width: f64 = random.random_range(0.12..0.4);
        let mut objects = Vec::new();
        for i in 0..4 {
            let (x, y) = (0.7 + 0.088 * f64::from(i), random.random_range(-0.5..0.5) * (width - 0.09));
            let (radius, height) = (random.random_range(0.025..0.043), random.random_range(0.08..0.3));
            let z = 0.6 + height / 2.0;
            objects.push(format!(
                "  - {{id: o{i}, cylinder: {{radius: {radius}, height: {height}}}, position: [{x}, {y}, {z}]}}"
            ));
        }
        let mut planner = planner(&compartment(width, &objects.join("\n")));
        let budget = Budget::unlimited();
        let ways = planner.feasibility().frozen(&budget).unwrap();
        let mut gone = ObjectSet::EMPTY;
        for _ in 0..ways.len() {
            let free = |i: &usize| ways[*i].iter().any(|way| way.is_subset(&gone));
            gone = (0..ways.len()).filter(free).map(|i| ObjectId(i as u16)).collect::<ObjectSet>().union(gone);
        }
        for object in planner.scene().all().iter() {
            let proved = planner.feasibility().proved_stuck(object, &budget).unwrap();
            assert!(proved.is_empty() || proved.contains(object) && !proved.intersects(&gone), "{width}: {proved:?}");
            taken += usize::from(gone.contains(object));
            stuck += usize::from(!proved.is_empty());
        }
    }
    assert!(taken > 10 && stuck > 10, "{taken} taken, {stuck} stuck");
}
