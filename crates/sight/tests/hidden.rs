//! Hulls of hidden space against rays: whatever a ray says is hidden is in some hull, and hulls hold little else.

use clearway_geometry::{Convex, Pose, Solid, Vec3, ray};
use clearway_plan::scene_file::Camera;
use clearway_sight::shadow::{Begins, out_of_view, shadow};
use clearway_sight::{Region, Standing, Thing, View, look};
use rand::{RngExt, SeedableRng};
use rand_xoshiro::Xoshiro256PlusPlus;

const REGION: Region = Region { low: Vec3::new(0.5, -0.5, 0.6), high: Vec3::new(1.2, 0.5, 1.0) };

fn view(fov: f64) -> View {
    View::new(&Camera { position: [-0.2, 0.0, 1.0], look_at: [0.9, 0.0, 0.75], fov, enter_unseen: false })
}

fn upright(radius: f64, height: f64, x: f64, y: f64) -> (Solid, Pose) {
    (
        Solid::new(Convex::Cylinder { radius, half: height / 2.0 }),
        Pose::from_translation(Vec3::new(x, y, 0.6 + height / 2.0)),
    )
}

fn cuboid(half: Vec3, at: Vec3, yaw: f64) -> (Solid, Pose) {
    (Solid::new(Convex::Box { half }), Pose::from_rpy([0.0, 0.0, yaw], at))
}

fn between(random: &mut Xoshiro256PlusPlus, low: f64, high: f64) -> f64 {
    low + (high - low) * random.random::<f64>()
}

fn point(random: &mut Xoshiro256PlusPlus) -> Vec3 {
    REGION.low + (REGION.high - REGION.low) * Vec3::new(random.random(), random.random(), random.random())
}

#[test]
fn what_rays_find_hidden_is_in_the_hull() {
    let mut random = Xoshiro256PlusPlus::seed_from_u64(1);
    let view = view(1.5);
    let (mut hidden, mut held) = (0, 0);
    for i in 0..40 {
        let (x, y) = (between(&mut random, 0.55, 0.9), between(&mut random, -0.4, 0.4));
        let (solid, pose) = match i % 3 {
            0 => cuboid(Vec3::new(0.04, 0.05, 0.1), Vec3::new(x, y, 0.7), between(&mut random, 0.0, 3.0)),
            _ => upright(between(&mut random, 0.03, 0.06), between(&mut random, 0.1, 0.33), x, y),
        };
        let hull = shadow(&view, &REGION, &solid, &pose, Begins::Middle);
        let behind = shadow(&view, &REGION, &solid, &pose, Begins::Behind(0.001));
        for _ in 0..4000 {
            let p = point(&mut random);
            let line = p - view.eye;
            let met = ray::meets_solid(&solid, &pose, view.eye, line.normalize()).filter(|t| *t < line.length());
            let outside = solid.depth(pose.inverse_point(p)) < 0.0;
            if met.is_some() && outside {
                hidden += 1;
                assert!(hull.depth(p) > -1e-6, "{p} is hidden by {solid:?} at {pose:?}");
            }
            if hull.depth(p) > 0.0 && outside {
                held += 1;
            }
            // Behind the body it is the same.
            assert!(behind.depth(p) < 1e-6 || hull.depth(p) > -1e-6);
        }
    }
    assert!(hidden > 2000 && held < hidden * 23 / 20, "{hidden} hidden, {held} in hulls");
}

#[test]
fn beside_the_picture_nothing_is_seen() {
    let mut random = Xoshiro256PlusPlus::seed_from_u64(2);
    let view = view(0.5);
    let outside = out_of_view(&view, &REGION);
    let mut beside = 0;
    for _ in 0..20_000 {
        let p = point(&mut random);
        let held = outside.depth(p);
        assert!(held.abs() < 1e-6 || (held > 0.0) != view.holds(p - view.eye), "{p}");
        beside += u32::from(held > 0.0);
    }
    assert!((2000..18_000).contains(&beside), "{beside}");
}

#[test]
fn seen_behind_and_partly() {
    let view = view(1.5);
    let front = upright(0.06, 0.33, 0.6, 0.0);
    let behind = upright(0.035, 0.2, 0.9, 0.0);
    let beside = upright(0.035, 0.2, 0.9, 0.3);
    // Its right edge is in view.
    let partly = upright(0.04, 0.25, 0.9, 0.055);
    let thing = |(solid, pose): &'static (Solid, Pose), known| Thing { standing: Standing { solid, pose }, known };
    let leak = |body: &(Solid, Pose)| -> &'static (Solid, Pose) { Box::leak(Box::new(body.clone())) };
    let all = [&front, &behind, &beside, &partly].map(leak);
    let sight = look(&view, &REGION, &[], &all.map(|b| thing(b, false)));
    assert_eq!(sight.new, [0, 2]);
    // Something is there, and it is due to the front one.
    assert_eq!(sight.hidden.iter().map(|h| h.behind).collect::<Vec<_>>(), [Some(0)]);
    assert!(sight.hidden[0].space.depth(partly.1.translation) > 0.0);
    // With the front one gone all are seen.
    let sight = look(&view, &REGION, &[], &all[1..].iter().map(|b| thing(b, false)).collect::<Vec<_>>());
    assert_eq!(sight.new, [0, 1, 2]);
    assert!(sight.hidden.is_empty());
}
