//! What the kernel knows of a robot by itself, against its shapes: tables of neighbours, links that stand still.
#![allow(clippy::unwrap_used)]

use clearway_collision::lanes::Suspects;
use clearway_collision::{CollisionModel, Moment, Quick, Scratch, World};
use clearway_geometry::distance::distance;
use clearway_plan::ObjectSet;
use clearway_robot::Robot;
use clearway_scene::Scene;
use rand::{RngExt, SeedableRng};
use rand_xoshiro::Xoshiro256PlusPlus;
use std::f64::consts::PI;
use std::path::Path;
use std::sync::Arc;

/// Of a robot whose base drives, the robot at its stop.
fn model(name: &str) -> Arc<CollisionModel> {
    let robot = Robot::load(name, Path::new("."), &[]).unwrap();
    let model = Arc::new(CollisionModel::new(Arc::new(robot)));
    model.standing.as_ref().map_or(model.clone(), |standing| standing.model.clone())
}

fn posture(model: &CollisionModel, random: &mut Xoshiro256PlusPlus) -> Vec<f64> {
    let ranges = model.robot.lower.iter().zip(&model.robot.upper).map(|(low, high)| (low.max(-PI), high.min(PI)));
    ranges.map(|(low, high)| low + (high - low) * random.random::<f64>()).collect()
}

/// Metres between the shapes of two links.
fn apart(model: &CollisionModel, a: usize, b: usize, q: &[f64], hand: f64) -> f64 {
    let mut frames = Vec::new();
    model.kinematics.frames(q, hand, &mut frames);
    let parts = |link: usize| model.robot.links[link].collision.parts.iter();
    let pairs = parts(a).flat_map(|(p, c)| parts(b).map(move |(o, d)| (p, c, o, d)));
    pairs.map(|(p, c, o, d)| distance(c, &(frames[a] * *p), d, &(frames[b] * *o))).fold(f64::INFINITY, f64::min)
}

#[test]
fn tables_of_neighbours_call_clear_what_is_clear() {
    for name in ["panda", "pr2_left"] {
        let model = model(name);
        let margin = f64::from(model.kernel.body.self_margin);
        let mut random = Xoshiro256PlusPlus::seed_from_u64(5);
        assert!(!model.kernel.neighbours.is_empty(), "{name}");
        let (mut clear, mut close, mut refused) = (0, 0, 0);
        let hands = [model.robot.hand.open(), model.robot.hand.joint_at(0.03), model.robot.hand.joint_at(0.0)];
        for sample in 0..1500 {
            let q = posture(&model, &mut random);
            let hand = hands[sample % hands.len()];
            for n in model.kernel.neighbours.iter() {
                let truly = apart(&model, n.a, n.b, &q, hand);
                if n.clear(hand, |j| q[j]) {
                    assert!(truly >= margin, "{name}, links {} and {}: {truly} at {q:?}, hand {hand}", n.a, n.b);
                    clear += 1;
                    close += usize::from(truly < 0.03);
                } else {
                    refused += usize::from(truly < margin);
                }
            }
        }
        assert!(clear > 900 && close > 300 && refused > 10, "{name}: {clear} {close} {refused}");
    }
}

#[test]
fn motions_that_tables_call_clear_are_clear_all_along() {
    for name in ["panda", "pr2_left"] {
        let model = model(name);
        let margin = f64::from(model.kernel.body.self_margin);
        let hand = model.robot.hand.open();
        let mut random = Xoshiro256PlusPlus::seed_from_u64(6);
        let mut clear = 0;
        for _ in 0..200 {
            let (from, mut to) = (posture(&model, &mut random), posture(&model, &mut random));
            // Beyond half a turn, and back again: a joint without limits is counted round.
            for (j, upper) in model.robot.upper.iter().enumerate().filter(|(_, upper)| !upper.is_finite()) {
                assert_eq!(*upper, f64::INFINITY);
                to[j] += 2.0 * PI;
            }
            for n in model.kernel.neighbours.iter().filter(|n| n.motion_clear(hand, &from, &to)) {
                clear += 1;
                for i in 0..=60 {
                    let q: Vec<f64> = from.iter().zip(&to).map(|(a, b)| a + (b - a) * f64::from(i) / 60.0).collect();
                    let truly = apart(&model, n.a, n.b, &q, hand);
                    assert!(truly >= margin, "{name}, links {} and {}: {truly} at {q:?}", n.a, n.b);
                }
            }
        }
        assert!(clear > 20, "{name}: {clear}");
    }
}

/// Links that stand still are asked as obstacles, by their shapes: nothing that they touch is missed, whatever room
/// is asked of obstacles.
#[test]
fn nothing_is_touched_that_the_kernel_does_not_suspect() {
    for (name, scene) in [("panda", "shelf"), ("pr2_left", "pr2_table")] {
        let path = Path::new(env!("CARGO_MANIFEST_DIR")).join(format!("../../examples/{scene}.yaml"));
        let scene = Scene::load(&path).unwrap();
        let model = model(name);
        let world = World::new(model.clone(), &scene);
        assert!(model.kernel.still.as_ref().is_some_and(|still| !still.is_empty()));
        let mut random = Xoshiro256PlusPlus::seed_from_u64(7);
        let (mut touching, mut itself, mut free) = (0, 0, 0);
        for margin in [0.0004, 0.002, 0.02] {
            let moment = Moment::new(ObjectSet::first(scene.objects.len()), model.robot.hand.open(), margin);
            let nothing = Moment::new(ObjectSet::EMPTY, model.robot.hand.open(), margin);
            let (mut quick, mut scratch, mut suspects) =
                (Quick::new(&world, &moment), Scratch::default(), Suspects::default());
            for _ in 0..1500 {
                let q = posture(&model, &mut random);
                quick.suspects(std::slice::from_ref(&q), &mut suspects);
                let truly = world.free(&q, &moment, &mut scratch);
                assert_eq!(world.free_among(&q, &moment, &suspects, &mut scratch), truly, "{name} at {q:?}");
                if quick.free(&q) {
                    assert!(truly, "{name} at {q:?}");
                    free += 1;
                }
                touching += usize::from(!truly);
                itself += usize::from(!world.free(&q, &nothing, &mut scratch));
            }
        }
        assert!(touching > 300 && itself > 100 && free > 300, "{name}: {touching} {itself} {free}");
    }
}
