//! Motions among suspects against dense sampling of the exact shapes, on the example shelf.
#![allow(clippy::unwrap_used)]

use clearway_collision::lanes::{LANES, Suspects};
use clearway_collision::{CollisionModel, Held, Moment, Quick, Scratch, World};
use clearway_geometry::{Pose, Vec3};
use clearway_plan::{ObjectId, ObjectSet};
use clearway_robot::{InverseKinematics, Robot};
use clearway_scene::Scene;
use rand::{RngExt, SeedableRng};
use rand_xoshiro::Xoshiro256PlusPlus;
use std::path::Path;
use std::sync::Arc;

/// Postures per row that the oracle looks at.
const DENSE: usize = 200;
const STEP: f64 = 0.0005;

#[test]
fn rows_are_clear_exactly_when_dense_samples_are() {
    let scene = Scene::load(&Path::new(env!("CARGO_MANIFEST_DIR")).join("../../examples/shelf.yaml")).unwrap();
    let robot = Arc::new(Robot::load(&scene.file.robot.model, Path::new("."), &[]).unwrap());
    let world = World::new(Arc::new(CollisionModel::new(robot.clone())), &scene);
    let inverse = InverseKinematics::new(&robot, &world.model.kinematics);
    let mut random = Xoshiro256PlusPlus::seed_from_u64(11);
    let mut scratch = Scratch::default();
    let mut suspects = Suspects::default();
    let all = ObjectSet::first(scene.objects.len());
    let (mut clear, mut touched, mut asked) = (0, 0, 0);
    while clear < 150 || touched < 150 {
        // The hand goes straight past some object, near enough to be suspected.
        let object = ObjectId(random.random_range(0..scene.objects.len() as u16));
        let mut near = |by: f64| {
            Vec3::new(random.random::<f64>() - 0.5, random.random::<f64>() - 0.5, random.random::<f64>() - 0.5) * by
        };
        let about = world.poses[object.index()].translation - world.up() * 0.02;
        let (from, way) = (about + near(0.25), near(0.2));
        let turn =
            Pose::from_rpy([-std::f64::consts::FRAC_PI_2, 0.0, near(1.0).x - std::f64::consts::FRAC_PI_2], Vec3::ZERO)
                .rotation;
        let Some(first) = inverse.solve(&Pose::new(turn, from), &robot.home).into_iter().next() else { continue };
        let mut rows = vec![first];
        while rows.len() < LANES {
            let target = Pose::new(turn, from + way * (rows.len() as f64 / LANES as f64));
            let Some(next) = inverse.follow(&target, &rows, 0.6) else { break };
            rows.push(next);
        }
        if rows.len() < 2 {
            continue;
        }
        let mut moment = Moment::new(all, robot.hand.open(), 0.001);
        if random.random::<bool>() {
            moment.standing.remove(object);
            let mut held = Held {
                object,
                parts: world.carried[object.index()].clone(),
                tool_from_object: Pose::from_rpy([-std::f64::consts::FRAC_PI_2, 0.0, 0.0], Vec3::ZERO),
                fixtures_below: Vec::new(),
                objects_below: ObjectSet::EMPTY,
                close: Arc::default(),
                kernel: None,
            };
            held.kernel = Some(world.model.holding(&held.solid()));
            moment.held = Some(held);
        }
        Quick::new(&world, &moment).rows_suspects(&rows, &mut suspects);
        let said = world.rows_clear(&rows, &moment, &suspects, STEP, &mut scratch);
        asked += usize::from(!suspects.is_empty() && !suspects.any_sure());
        let mut free_at = |more: f64| {
            let mut moment = moment.clone();
            moment.margin += more;
            moment.held_margin += more;
            (0..=(rows.len() - 1) * DENSE).all(|i| {
                let (row, t) = (i / DENSE, (i % DENSE) as f64 / DENSE as f64);
                let next = &rows[(row + 1).min(rows.len() - 1)];
                let q: Vec<f64> = rows[row].iter().zip(next).map(|(a, b)| a + (b - a) * t).collect();
                world.free(&q, &moment, &mut scratch)
            })
        };
        if said {
            // Between postures half a millimetre apart nothing is looked at.
            assert!(free_at(-STEP), "{rows:?}");
            clear += 1;
        } else {
            // Links among themselves keep a margin of their own, which the oracle shares.
            assert!(!free_at(1e-4), "{rows:?}");
            touched += 1;
        }
    }
    assert!(asked > 60, "{asked}: exact answers were hardly needed");
}
