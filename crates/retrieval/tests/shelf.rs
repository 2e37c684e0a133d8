//! The planner's parts against brute force on the example shelf.
#![allow(clippy::unwrap_used)]

use clearway_collision::{CollisionModel, Scratch, World};
use clearway_geometry::Vec2;
use clearway_plan::event::Silent;
use clearway_plan::plan_file::{Action, SegmentKind, Status};
use clearway_plan::{Budget, ObjectId, ObjectSet};
use clearway_retrieval::floor::Floor;
use clearway_retrieval::roadmap::{self, Roadmap};
use clearway_retrieval::ways::{self, Explorer};
use clearway_retrieval::{FirstLimit, Planner, Request, SceneDelta, Settings};
use clearway_robot::{InverseKinematics, Robot};
use clearway_scene::Scene;
use rand::SeedableRng;
use rand_xoshiro::Xoshiro256PlusPlus;
use std::path::Path;
use std::sync::Arc;

fn shelf() -> (Scene, Arc<Robot>) {
    let scene = Scene::load(&Path::new(env!("CARGO_MANIFEST_DIR")).join("../../examples/shelf.yaml")).unwrap();
    let robot = Robot::load(&scene.file.robot.model, Path::new("."), &[]).unwrap();
    (scene, Arc::new(robot))
}

fn request(seed: u64) -> Request {
    Request::new(seed, Budget::unlimited().with_iterations(40))
}

#[test]
fn the_roadmap_keeps_its_promises() {
    let (scene, robot) = shelf();
    let floor = Floor::new(&scene, &robot);
    assert!(floor.collisions(floor.exit).is_empty(), "x_s is outside");
    // Appendix B: r_b = max(r_base, r_g + r_f).
    assert!(floor.radius >= robot.hand.base_radius);
    let mut roadmap = Roadmap::new(&floor);
    let mut random = Xoshiro256PlusPlus::seed_from_u64(1);
    let settings = roadmap::Settings::default();
    for limit in 1..=4 {
        let before = roadmap.nodes.len();
        roadmap.expand(&floor, limit, &settings, &mut random, &Budget::unlimited()).unwrap();
        assert!(roadmap.nodes[before..].iter().all(|n| n.collisions.len() < limit), "K ≤ L − 1");
    }
    assert_eq!(roadmap.samples, 4 * settings.samples);
    // Col and EdgeCol by brute force: circles against densely sampled discs.
    let circles: Vec<(Vec2, f64)> = scene
        .objects
        .iter()
        .map(|o| (o.pose.translation.truncate(), o.solid.aabb(o.pose).1.x - o.pose.translation.x))
        .collect();
    let col = |p: Vec2| -> ObjectSet {
        (0..circles.len())
            .filter(|&i| i != scene.target.index() && circles[i].0.distance(p) < circles[i].1 + floor.radius)
            .map(|i| ObjectId(i as u16))
            .collect()
    };
    for node in &roadmap.nodes {
        assert_eq!(node.collisions, col(node.at));
    }
    assert!(roadmap.edges.len() > 200);
    for &(a, b) in &roadmap.edges {
        let (a, b) = (roadmap.nodes[a], roadmap.nodes[b]);
        assert!(a.at.distance(b.at) <= settings.longest_edge * (1.0 + 1e-8));
        let ends = a.collisions.union(b.collisions);
        let on_the_way = (0..=200).fold(ObjectSet::EMPTY, |s, i| s.union(col(a.at.lerp(b.at, i as f64 / 200.0))));
        assert!(on_the_way.is_subset(&ends), "an edge meets nothing that its ends do not");
    }
    // Clusters part the nodes; members are alike; x_s and x_g are alone.
    let (clusters, edges) = roadmap.clusters();
    assert_eq!((&clusters[0].roadmap_nodes, &clusters[1].roadmap_nodes), (&vec![0], &vec![1]));
    assert_eq!(clusters.iter().map(|c| c.roadmap_nodes.len()).sum::<usize>(), roadmap.nodes.len());
    for c in &clusters {
        assert!(c.roadmap_nodes.iter().all(|&i| roadmap.nodes[i].collisions == c.collisions));
    }
    assert!(edges.iter().all(|(a, b)| a < b && *b < clusters.len()));
    // A path with some objects removed meets only those.
    let all = ObjectSet::first(scene.objects.len());
    let path = roadmap.path(&all).unwrap();
    assert_eq!((path[0], path[path.len() - 1]), (0, 1));
    assert!(roadmap.path(&ObjectSet::EMPTY).is_none_or(|p| p.iter().all(|&i| roadmap.nodes[i].collisions.is_empty())));
}

#[test]
fn a_plan_is_whole_and_every_first_limit_finds_one() {
    let (scene, robot) = shelf();
    for first_limit in [FirstLimit::One, FirstLimit::GraspCover, FirstLimit::All] {
        let settings = Settings { first_limit, ..Settings::default() };
        let mut planner = Planner::new(scene.clone(), robot.clone(), settings).unwrap();
        let plan = planner.plan(&request(1), &mut Silent).plan;
        assert_eq!(plan.status, Status::Solved);
        assert_eq!(plan.removed.last(), Some(&scene.file.target));
        assert_eq!(plan.removed.len(), plan.steps.len());
        assert!(first_limit == FirstLimit::All || plan.removed.len() <= plan.stats.exploration_limit);
        for step in &plan.steps {
            let kinds: Vec<SegmentKind> = step.segments.iter().map(|s| s.kind).collect();
            use SegmentKind::{Approach, Grasp, Push, Release, Retreat, Transfer};
            let needed: &[SegmentKind] = match step.action {
                Action::PickPlace => &[Approach, Grasp, Transfer, Release, Retreat],
                Action::Push => &[Approach, Push, Retreat],
            };
            assert!(needed.iter().all(|kind| kinds.contains(kind)), "{kinds:?}");
        }
        let home = &robot.home;
        let end = plan.steps.last().unwrap().segments.last().unwrap().positions.last().unwrap();
        assert!(end.iter().zip(home).all(|(a, b)| (a - b).abs() < 1e-9), "it ends at rest");
    }
}

#[test]
fn a_session_follows_its_scene() {
    let (scene, robot) = shelf();
    let mut planner = Planner::new(scene.clone(), robot.clone(), Settings::default()).unwrap();
    let first = planner.plan(&request(1), &mut Silent).plan;
    assert!(first.removed.len() > 1);
    // What was removed vanishes: now the target can be had at once.
    let mut file = scene.file.clone();
    file.objects.retain(|o| o.id == scene.file.target || !first.removed.contains(&o.id));
    let changed = Scene::from_file_struct(file, Path::new(".")).unwrap();
    planner.update(SceneDelta::Scene(Box::new(changed))).unwrap();
    let second = planner.plan(&request(1), &mut Silent).plan;
    assert_eq!((second.status, second.removed), (Status::Solved, vec![scene.file.target.clone()]));
    // And back again.
    planner.update(SceneDelta::Scene(Box::new(scene))).unwrap();
    assert_eq!(planner.plan(&request(1), &mut Silent).plan.removed.len(), first.removed.len());
}

#[test]
fn paper_mode_plans_too() {
    let (scene, robot) = shelf();
    let mut planner = Planner::new(scene, robot, Settings::paper()).unwrap();
    assert_eq!(planner.plan(&request(1), &mut Silent).plan.status, Status::Solved);
}

#[test]
fn a_spent_budget_says_what_stood_in_the_way() {
    let (scene, robot) = shelf();
    let target = scene.file.target.clone();
    let mut planner = Planner::new(scene, robot, Settings::default()).unwrap();
    let answer = planner.plan(&Request::new(1, Budget::unlimited().with_iterations(1)), &mut Silent);
    assert_eq!(answer.plan.status, Status::OutOfBudget);
    let why = answer.plan.why.objects.iter().find(|o| o.object == target).unwrap();
    assert!(!why.blocked_by.is_empty() && !why.grasps.is_empty());
}

#[test]
fn ways_looked_into_up_to_a_limit_are_those_of_all_within_it() {
    let (scene, robot) = shelf();
    let world = World::new(Arc::new(CollisionModel::new(robot.clone())), &scene);
    let inverse = InverseKinematics::new(&robot, &world.model.kinematics);
    let floor = Floor::new(&scene, &robot);
    let settings = ways::Settings::default();
    let all = ObjectSet::first(scene.objects.len());
    let explorer =
        Explorer { world: &world, inverse: &inverse, floor: &floor, settings: &settings, moved_to: None, empty: false };
    let (mut scratch, budget) = (Scratch::default(), Budget::unlimited());
    let mut some = 0;
    for object in all.iter() {
        let explored = explorer.explore(object, &budget).unwrap();
        let mut whole = explored.clone();
        let sets = explorer.minimal_sets(object, &mut whole, ObjectSet::CAPACITY, &mut scratch, &budget).unwrap();
        // One limit after the other, as a search raises it.
        let mut raised = explored;
        for most in 0..6 {
            let found = explorer.minimal_sets(object, &mut raised, most, &mut scratch, &budget).unwrap();
            let within: Vec<ObjectSet> = sets.iter().copied().filter(|s| s.len() <= most).collect();
            let (mut a, mut b) = (found.clone(), within.clone());
            a.sort();
            b.sort();
            assert_eq!(a, b, "{object:?} up to {most}");
            some += found.len();
        }
    }
    assert!(some > 30, "{some}");
}
