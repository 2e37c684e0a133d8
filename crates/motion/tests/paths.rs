//! Paths on the example shelf: free when checked again much finer, ends kept, shorter after shortening.
#![allow(clippy::unwrap_used)]

use clearway_collision::{CollisionModel, Moment, Scratch, World};
use clearway_motion::{
    Halton, Limits, RrtSettings, Space, Trees, between, connect, distance, length, shorten, slowdowns, smooth,
    time_curve,
};
use clearway_plan::{Budget, ObjectSet};
use clearway_robot::Robot;
use clearway_scene::Scene;
use rand::{RngExt, SeedableRng};
use rand_xoshiro::Xoshiro256PlusPlus;
use std::path::Path;
use std::sync::Arc;

#[test]
fn paths_are_free_and_timed_within_limits() {
    let scene = Scene::load(&Path::new(env!("CARGO_MANIFEST_DIR")).join("../../examples/shelf.yaml")).unwrap();
    let robot = Arc::new(Robot::load(&scene.file.robot.model, Path::new("."), &[]).unwrap());
    let world = World::new(Arc::new(CollisionModel::new(robot)), &scene);
    let moment = Moment::new(ObjectSet::first(scene.objects.len()), 0.0, 0.002);
    let mut space = Space::new(&world, &moment, 0.01);
    let mut random = Xoshiro256PlusPlus::seed_from_u64(11);
    let robot = &world.model.robot;
    let limits =
        Limits { velocity: robot.velocity.clone(), acceleration: robot.acceleration.clone(), jerk: robot.jerk.clone() };
    let budget = Budget::unlimited();
    let mut trees = Trees::default();
    let (mut found, mut bent) = (0, 0);
    for _ in 0..60 {
        let goal: Vec<f64> = world.model.robot.home.iter().map(|h| h + 3.0 * (random.random::<f64>() - 0.5)).collect();
        let start = world.model.robot.home.clone();
        let mut halton = Halton::new(&space, 0);
        let settings = RrtSettings::default();
        let Some(path) =
            connect(&mut space, &start, &[goal.clone()], &mut halton, &settings, &mut trees, &budget).unwrap()
        else {
            continue;
        };
        found += 1;
        bent += usize::from(path.len() > 2);
        assert!(distance(&path[0], &start) < 1e-12 && distance(&path[path.len() - 1], &goal) < 1e-12);
        let shorter = shorten(&mut space, path.clone(), 20, &mut random, &budget).unwrap();
        assert!(length(&shorter) <= length(&path) + 1e-9);
        let timed = time_curve(&smooth(&mut space, &shorter, 1.0), &limits, 0.02);
        assert!(distance(&timed.positions[0], &start) < 1e-9);
        assert!(distance(&timed.positions[timed.positions.len() - 1], &goal) < 1e-9);
        // Half a millimetre of the margin may be lost between the checks, not all of it.
        let strict = Moment { margin: 0.0005, ..moment.clone() };
        let mut scratch = Scratch::default();
        for path in [&shorter, &timed.positions] {
            for w in path.windows(2) {
                let count = (distance(&w[0], &w[1]) / 0.002).ceil().max(1.0) as usize;
                for i in 0..=count {
                    let t = i as f64 / count as f64;
                    let q = between(&w[0], &w[1], t);
                    assert!(world.free(&q, &strict, &mut scratch));
                }
            }
        }
        assert!(timed.times.windows(2).all(|t| t[1] > t[0] && t[1] - t[0] <= 0.02 + 1e-9));
        assert!(slowdowns(&timed.times, &timed.positions.concat(), &limits).iter().all(|s| *s <= 1.0 + 1e-6));
    }
    assert!(found > 15 && bent > 3, "{found} {bent}");
}

/// A curve about a waypoint at a joint's limit may swing beyond it.
#[test]
fn rows_beyond_a_limit_are_not_free() {
    let scene = Scene::load(&Path::new(env!("CARGO_MANIFEST_DIR")).join("../../examples/shelf.yaml")).unwrap();
    let robot = Arc::new(Robot::load(&scene.file.robot.model, Path::new("."), &[]).unwrap());
    let (home, upper) = (robot.home.clone(), robot.upper.clone());
    let world = World::new(Arc::new(CollisionModel::new(robot)), &scene);
    let moment = Moment::new(ObjectSet::EMPTY, world.model.robot.hand.open(), 0.0);
    for quick in [false, true] {
        let mut space = if quick { Space::quick(&world, &moment, 0.01) } else { Space::new(&world, &moment, 0.01) };
        let rows = |last: f64| {
            [home[5], (home[5] + last) / 2.0, last]
                .map(|q6| home[..5].iter().copied().chain([q6]).collect::<Vec<f64>>())
        };
        assert!(space.rows_free(&rows(upper[5])));
        assert!(!space.rows_free(&rows(upper[5] + 1e-3)));
    }
}
