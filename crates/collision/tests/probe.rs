//! Collision answers against brute force on the example shelf.
#![allow(clippy::unwrap_used)]

use clearway_collision::{CollisionModel, Held, Moment, Probe, Scratch, Slack, Touch, World};
use clearway_geometry::Pose;
use clearway_geometry::distance::distance;
use clearway_plan::{ObjectId, ObjectSet};
use clearway_robot::Robot;
use clearway_scene::Scene;
use rand::{RngExt, SeedableRng};
use rand_xoshiro::Xoshiro256PlusPlus;
use std::path::Path;
use std::sync::Arc;

fn shelf() -> (Scene, World) {
    let scene = Scene::load(&Path::new(env!("CARGO_MANIFEST_DIR")).join("../../examples/shelf.yaml")).unwrap();
    let robot = Arc::new(Robot::load(&scene.file.robot.model, Path::new("."), &[]).unwrap());
    let world = World::new(Arc::new(CollisionModel::new(robot)), &scene);
    (scene, world)
}

/// Postures in front of and inside the shelf, not all over the place.
fn posture(world: &World, random: &mut Xoshiro256PlusPlus) -> Vec<f64> {
    world.model.robot.home.iter().map(|h| h + 1.6 * (random.random::<f64>() - 0.5)).collect()
}

fn held(world: &World, object: ObjectId) -> Held {
    Held {
        close: Arc::default(),
        kernel: None,
        object,
        parts: world.carried[object.index()].clone(),
        tool_from_object: Pose::from_rpy([-std::f64::consts::FRAC_PI_2, 0.0, 0.0], clearway_geometry::Vec3::ZERO),
        fixtures_below: Vec::new(),
        objects_below: ObjectSet::EMPTY,
    }
}

/// The least distance of the moving links and what is held to each object, by GJK without filters.
fn brute_force(world: &World, q: &[f64], moment: &Moment) -> Vec<f64> {
    let mut frames = Vec::new();
    world.model.kinematics.frames(q, moment.hand, &mut frames);
    let mut shapes = Vec::new();
    for (link, frame) in world.model.robot.links.iter().zip(&frames) {
        let index = world.model.robot.link(&link.name).unwrap();
        if world.model.kinematics.moved_by[index] != 0 {
            shapes.extend(link.collision.parts.iter().map(|(p, c)| (*frame * *p, c.clone())));
        }
    }
    if let Some(held) = &moment.held {
        let frame = frames[world.model.kinematics.tool] * held.tool_from_object;
        shapes.extend(held.parts.iter().map(|p| (frame * p.pose, p.convex.clone())));
    }
    world
        .objects
        .iter()
        .map(|o| {
            o.parts
                .iter()
                .flat_map(|part| shapes.iter().map(|(p, c)| distance(&part.convex, &part.root_from_part, c, p)))
                .fold(f64::INFINITY, f64::min)
        })
        .collect()
}

#[test]
fn touched_sets_are_those_of_brute_force() {
    let (scene, world) = shelf();
    let mut random = Xoshiro256PlusPlus::seed_from_u64(5);
    let mut scratch = Scratch::default();
    let (mut with_objects, mut looked_at) = (0, 0);
    let all = ObjectSet::first(scene.objects.len());
    for i in 0..6000 {
        let carried = ObjectId(i % 16);
        let standing = if i % 2 == 0 { all } else { all.difference(ObjectSet::of(carried)) };
        let mut moment = Moment::new(standing, world.model.robot.hand.open(), 0.003);
        if i % 2 == 1 {
            moment.held = Some(held(&world, carried));
        }
        let q = posture(&world, &mut random);
        let Touch::Objects(found) = world.touched(&q, &moment, &mut scratch) else { continue };
        looked_at += 1;
        with_objects += usize::from(!found.is_empty());
        for (index, d) in brute_force(&world, &q, &moment).into_iter().enumerate() {
            let id = ObjectId(index as u16);
            if standing.contains(id) && (d - moment.margin).abs() > 1e-6 {
                assert_eq!(found.contains(id), d < moment.margin, "object {index} at {d}");
            }
        }
        assert_eq!(world.free(&q, &moment, &mut scratch), found.is_empty());
    }
    assert!(looked_at > 300 && with_objects > 100, "{looked_at} {with_objects}");
}

#[test]
fn what_a_probe_calls_free_around_is_free_around() {
    let (scene, world) = shelf();
    let mut random = Xoshiro256PlusPlus::seed_from_u64(6);
    let mut scratch = Scratch::default();
    let all = ObjectSet::first(scene.objects.len());
    let mut slack = Slack::default();
    let mut around = 0;
    for i in 0..4000 {
        let mut moment = Moment::new(all.difference(ObjectSet::of(ObjectId(3))), world.model.robot.hand.open(), 0.002);
        if i % 2 == 1 {
            moment.held = Some(held(&world, ObjectId(3)));
        }
        let q = posture(&world, &mut random);
        let size = 0.2 * random.random::<f64>();
        let joints: Vec<f64> = (0..6).map(|_| size * random.random::<f64>()).collect();
        slack.set(&world, &moment, &joints);
        if world.probe(&q, &moment, Some(&slack), &mut scratch) != Probe::Around {
            continue;
        }
        around += 1;
        for _ in 0..20 {
            let near: Vec<f64> =
                q.iter().zip(&joints).map(|(q, d)| q + d * (2.0 * random.random::<f64>() - 1.0)).collect();
            assert!(world.free(&near, &moment, &mut scratch), "{q:?} {near:?}");
        }
    }
    assert!(around > 200, "{around}");
}

#[test]
fn removing_an_object_only_frees() {
    let (scene, world) = shelf();
    let mut random = Xoshiro256PlusPlus::seed_from_u64(7);
    let mut scratch = Scratch::default();
    let all = ObjectSet::first(scene.objects.len());
    for _ in 0..500 {
        let q = posture(&world, &mut random);
        let full = world.touched(&q, &Moment::new(all, 0.0, 0.001), &mut scratch);
        let Touch::Objects(set) = full else { continue };
        for id in set.iter() {
            let fewer = Moment::new(all.difference(ObjectSet::of(id)), 0.0, 0.001);
            assert_eq!(world.touched(&q, &fewer, &mut scratch), Touch::Objects(set.difference(ObjectSet::of(id))));
        }
    }
}
