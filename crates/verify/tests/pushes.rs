//! Pushes along the gantry's table: sound ones, each fault under its own name, and tolerances.

mod gantry;

use clearway_plan::plan_file::{PlacedPose, Segment, SegmentKind, Step};
use clearway_plan::scene_file::{Body, BoxKeys, CylinderKeys, Part, SphereKeys};
use clearway_plan::{Budget, PlanFile};
use clearway_verify::{Report, ViolationKind as Kind, verify};
use gantry::{PUSHED_HEIGHT, PUSHED_RADIUS};
use rand::SeedableRng;
use rand_xoshiro::Xoshiro256PlusPlus;
use std::path::Path;

/// Of the segments.
const APPROACH: usize = 1;
const PUSH: usize = 2;
const RETREAT: usize = 3;

fn plan(seed: u64) -> PlanFile {
    gantry::pushing(&mut Xoshiro256PlusPlus::seed_from_u64(seed))
}

fn judge(plan: &PlanFile) -> Report {
    verify(plan, Path::new(""), &Budget::unlimited()).expect("judged")
}

fn step(plan: &mut PlanFile) -> &mut Step {
    &mut plan.steps[0]
}

/// The direction of the push, and its distance.
fn way(plan: &PlanFile) -> ([f64; 3], f64) {
    let push = plan.steps[0].push.as_ref().expect("a push");
    (push.direction, push.distance)
}

/// Where the object is once it has gone this share of its way, and so far to the left.
fn beside(plan: &PlanFile, share: f64, left: f64) -> [f64; 3] {
    let ([x, y, _], distance) = way(plan);
    let at = plan.scene.objects[0].position;
    [at[0] + share * distance * x - left * y, at[1] + share * distance * y + left * x, at[2]]
}

fn boxed(id: &str, size: [f64; 3], position: [f64; 3]) -> Body {
    Body { id: id.into(), r#box: Some(BoxKeys { size }), position, ..Body::default() }
}

/// For several pushes: what is found has these kinds, one of them with these words.
fn found(change: impl Fn(&mut PlanFile), kinds: &[Kind], words: &str) {
    for seed in 0..6 {
        let mut plan = plan(seed);
        change(&mut plan);
        let report = judge(&plan);
        for kind in kinds {
            assert!(report.has(*kind), "{kind:?}, seed {seed}: {report}");
        }
        assert!(report.violations.iter().all(|v| kinds.contains(&v.kind)), "seed {seed}: {report}");
        assert!(kinds.is_empty() || report.to_string().contains(words), "{words:?}, seed {seed}: {report}");
    }
}

fn sound(change: impl Fn(&mut PlanFile)) {
    found(change, &[], "");
}

#[test]
fn sound_pushes_are_valid() {
    for seed in 0..30 {
        let report = judge(&plan(seed));
        assert!(report.is_valid() && report.not_checked.is_empty(), "seed {seed}: {report}");
    }
    // Told of another's plan, or not, turned about itself, standing on a foot, one segment or two.
    sound(|p| step(p).push = None);
    sound(|p| step(p).placed.quaternion = [0.0, 0.0, 1.0_f64.sin(), 1.0_f64.cos()]);
    sound(|p| p.scene.objects[0] = on_a_foot(&p.scene.objects[0], 0.03));
    sound(two_segments);
}

/// A wide body on a foot, as high and as wide as before.
fn on_a_foot(object: &Body, foot: f64) -> Body {
    let part = |radius: f64, height: f64, z: f64| Part {
        cylinder: Some(CylinderKeys { radius, height }),
        position: [0.0, 0.0, z],
        ..Part::default()
    };
    let low = part(foot, 0.01, 0.005 - PUSHED_HEIGHT / 2.0);
    let parts = vec![part(PUSHED_RADIUS, PUSHED_HEIGHT - 0.01, 0.005), low];
    Body { cylinder: None, compound: Some(parts), ..object.clone() }
}

fn two_segments(plan: &mut PlanFile) {
    let push = step(plan).segments[PUSH].clone();
    let middle = push.times.len() / 2;
    let half = |from: usize, to: usize| Segment {
        times: push.times[from..to].iter().map(|t| t - push.times[from]).collect(),
        positions: push.positions[from..to].to_vec(),
        ..push.clone()
    };
    let halves = [half(0, middle + 1), half(middle, push.times.len())];
    step(plan).segments.splice(PUSH..=PUSH, halves);
}

#[test]
fn where_it_is_put() {
    let put = |along: f64, up: f64| {
        move |p: &mut PlanFile| {
            let ([x, y, _], _) = way(p);
            let at = &mut step(p).placed.position;
            *at = [at[0] + along * x, at[1] + along * y, at[2] + up];
        }
    };
    sound(put(0.9e-3, 0.0));
    sound(put(-0.9e-3, 0.0));
    sound(put(0.0, 0.9e-3));
    found(put(1.2e-3, 0.0), &[Kind::Push], "`placed` is 1.2 mm from where pushing o0 leaves it");
    found(put(0.0, 1.2e-3), &[Kind::Push, Kind::OffPlace], "o0 is pushed to 1.2 mm above where it stood");
    // Without `push` the way is what `placed` says.
    let unsaid = |p: &mut PlanFile| {
        put(0.02, 0.0)(p);
        step(p).push = None;
    };
    found(unsaid, &[Kind::Push], "");
    let tilted = |p: &mut PlanFile| step(p).placed.quaternion = [0.01, 0.0, 0.0, 1.0];
    found(tilted, &[Kind::Push, Kind::Tilted, Kind::Unstable], "o0 is tilted by 0.020 rad where it is pushed to");
}

#[test]
fn what_is_said_of_it() {
    for direction in [[0.0, 0.0, 1.0], [2.0, 0.0, 0.0], [f64::NAN, 0.0, 0.0]] {
        let said = |p: &mut PlanFile| step(p).push.as_mut().expect("a push").direction = direction;
        found(said, &[Kind::Push], "expected a level unit vector");
    }
    found(|p| step(p).push.as_mut().expect("a push").free = -0.01, &[Kind::Push], "lengths from 0 to 1000 m");
    let farther = |p: &mut PlanFile| {
        let ([x, y, _], _) = way(p);
        let step = step(p);
        step.placed.position[0] += 0.005 * x;
        step.placed.position[1] += 0.005 * y;
        step.push.as_mut().expect("a push").distance += 0.005;
    };
    found(farther, &[Kind::Push], "the tool goes ");
}

/// Moves the rows of the push by a bump, in joint space; its ends stay.
fn bump(plan: &mut PlanFile, by: [f64; 4]) {
    let rows = &mut step(plan).segments[PUSH].positions;
    let last = rows.len() as f64 - 1.0;
    for (i, row) in rows.iter_mut().enumerate() {
        let share = (std::f64::consts::PI * i as f64 / last).sin().powi(4);
        (0..4).for_each(|j| row[j] += by[j] * share);
    }
}

#[test]
fn the_tool_goes_straight() {
    // A slower plan, so that bumps break no limits.
    let bumped = |by: [f64; 4]| {
        move |p: &mut PlanFile| {
            bump(p, by);
            p.robot.limits.jerk = None;
        }
    };
    let limits = [Kind::Push, Kind::VelocityLimit, Kind::AccelerationLimit];
    for (by, words) in [
        ([0.0, 0.0, 2.0e-3, 0.0], "the tool is 2.0 mm beside the line along which it pushes"),
        ([0.0, 0.0, 0.0, 0.015], "rad as it pushes"),
    ] {
        for seed in 0..6 {
            let mut plan = plan(seed);
            bumped(by)(&mut plan);
            let report = judge(&plan);
            assert!(report.has(Kind::Push) && report.violations.iter().all(|v| limits.contains(&v.kind)), "{report}");
            assert!(report.to_string().contains(words), "{report}");
        }
    }
    sound(bumped([0.0, 0.0, 0.9e-3, 0.0]));
    sound(bumped([0.0, 0.0, 0.0, 5e-3]));
}

#[test]
fn what_stands_in_its_way() {
    for (left, touches) in [(0.0, true), (0.0999, true), (0.101, false), (-0.0999, true), (-0.101, false)] {
        // As high as the tips of the fingers are above the table: only the object meets it.
        let size = [0.13, 0.13, 0.002];
        let curb = |p: &mut PlanFile| {
            let ([x, y, _], _) = way(p);
            let mut at = beside(p, 0.5, left);
            at[2] = 0.001;
            let turn = y.atan2(x);
            p.scene.fixtures.push(Body { rpy: Some([0.0, 0.0, turn]), ..boxed("curb", size, at) });
        };
        let kinds: &[Kind] = if touches { &[Kind::PushedCollision] } else { &[] };
        for seed in [1, 2, 4] {
            let mut plan = plan(seed);
            curb(&mut plan);
            // It is there from the beginning, or at the end, if the push is short.
            let report = judge(&plan);
            let named = report.violations.iter().filter(|v| v.kind == Kind::PushedCollision);
            assert_eq!(named.clone().count(), kinds.len(), "{left}, seed {seed}: {report}");
            assert!(
                named.into_iter().all(|v| v.what.starts_with("pushed o0 is") && v.what.contains("inside fixture curb"))
            );
        }
    }
    // An object; and a link that is not the hand's.
    let other = |p: &mut PlanFile| {
        let ([x, y, _], distance) = way(p);
        let mut at = beside(p, 0.5, 0.0);
        at[2] = 0.001;
        let (turn, long) = (y.atan2(x), (distance - 0.12).max(0.002));
        if distance > 0.15 {
            p.scene.objects.push(Body { rpy: Some([0.0, 0.0, turn]), ..boxed("o1", [long, 0.02, 0.002], at) });
        }
    };
    for seed in 0..12 {
        let mut plan = plan(seed);
        other(&mut plan);
        let report = judge(&plan);
        assert_eq!(report.has(Kind::PushedCollision), plan.scene.objects.len() > 1, "seed {seed}: {report}");
    }
    let bead = "<link name=\"column\"><collision><origin xyz=\"0 0 -0.4\"/><geometry><sphere radius=\"0.02\"/></geometry></collision>";
    let link = |p: &mut PlanFile| {
        p.robot.urdf = p.robot.urdf.replace("<link name=\"column\">", bead);
        let pairs = [["column", "left"], ["column", "right"]];
        p.robot.unchecked_pairs.extend(pairs.map(|p| p.map(str::to_owned)));
    };
    let mut with_bead = plan(0);
    link(&mut with_bead);
    let report = judge(&with_bead);
    assert!(
        report.violations.iter().any(|v| v.kind == Kind::PushedCollision && v.what.starts_with("link column")),
        "{report}"
    );
}

#[test]
fn what_carries_it() {
    // A mat, flush with the table, under the last of its way.
    let mat = |p: &mut PlanFile| {
        let mut at = beside(p, 1.0, 0.0);
        at[2] = -0.005;
        p.scene.fixtures.push(boxed("mat", [0.06, 0.06, 0.01], at));
    };
    found(mat, &[Kind::Push], "o0 stands on table; pushed");
    // The table ends before the middle of the object does, or behind it.
    for (short, falls) in [(-0.04, false), (-0.002, false), (0.004, true), (0.03, true)] {
        for seed in 0..12 {
            let mut plan = plan(seed);
            let ([x, _, _], distance) = way(&plan);
            let end = beside(&plan, 1.0, 0.0)[0] - short * x.signum();
            let table = &mut plan.scene.fixtures[0];
            table.position[0] = end - 0.7 * x.signum();
            // What stands on the table falls; what is left at the start has to stand.
            if distance < 0.12 {
                continue;
            }
            let report = judge(&plan);
            assert_eq!(report.has(Kind::Unstable), falls, "{short}, seed {seed}: {report}");
            assert!(!falls || report.to_string().contains("on its way o0 is not stable"), "{report}");
        }
    }
    let top = |p: &mut PlanFile| {
        let [x, y, _] = p.scene.objects[0].position;
        p.scene.objects.push(boxed("top", [0.01, 0.01, 0.005], [x, y, PUSHED_HEIGHT + 0.0025]));
    };
    let kinds = [Kind::Push, Kind::Collision, Kind::PushedCollision];
    for seed in 0..6 {
        let mut plan = plan(seed);
        top(&mut plan);
        let report = judge(&plan);
        assert!(report.to_string().contains("top stands on o0, which is pushed"), "{report}");
        assert!(report.violations.iter().any(|v| kinds.contains(&v.kind)), "{report}");
    }
}

/// The object meets the hand so much later than is said, or earlier.
fn late(plan: &mut PlanFile, by: f64) {
    let ([x, y, _], _) = way(plan);
    let step = step(plan);
    let push = step.push.as_mut().expect("a push");
    (push.free, push.distance) = (push.free + by, push.distance - by);
    step.placed.position[0] -= by * x;
    step.placed.position[1] -= by * y;
}

#[test]
fn the_hand_is_at_it_and_not_in_it() {
    sound(|p| late(p, 0.9e-3));
    sound(|p| late(p, -1.3e-3));
    found(|p| late(p, 1.5e-3), &[Kind::Push], "mm inside o0, which it pushes");
    found(|p| late(p, -2.5e-3), &[Kind::Push], "the hand is more than 1.5 mm from o0, which it should push");
    // The finger before it goes ahead of it.
    let before = |p: &mut PlanFile| {
        let ([x, y, _], _) = way(p);
        let free = p.steps[0].push.as_ref().expect("a push").free;
        let ahead = [free * x, free * y];
        for (at, by) in p.scene.objects[0].position.iter_mut().zip(ahead) {
            *at += by;
        }
        let step = step(p);
        let push = step.push.as_mut().expect("a push");
        (push.free, push.distance) = (0.0, push.distance + push.free);
        for (at, by) in step.placed.position.iter_mut().zip(ahead) {
            *at += 2.0 * by;
        }
    };
    found(before, &[Kind::Push], "the hand is not behind o0, which it should push");
    // Coming down, it meets the object's rim with a finger; going up, it takes one through it.
    for segment in [APPROACH, RETREAT] {
        for seed in 0..6 {
            let mut plan = plan(seed);
            let ([x, y, _], _) = way(&plan);
            let rows = &mut step(&mut plan).segments[segment].positions;
            let middle = rows.len() / 2;
            // Down again, between the rows' ends, and ahead: the finger behind it is in it.
            let low = rows.iter().map(|r| r[2]).fold(f64::INFINITY, f64::min);
            rows[middle][2] = low + 0.01;
            rows[middle][0] += 0.02 * x;
            rows[middle][1] += 0.02 * y;
            let report = judge(&plan);
            assert!(report.to_string().contains("mm inside o0, which it pushes"), "{segment}, {seed}: {report}");
        }
    }
}

#[test]
fn what_is_pushed_too_high_tips() {
    // It is pushed all along its side, up to its top.
    let limit = PUSHED_RADIUS / PUSHED_HEIGHT;
    sound(move |p| p.scene.friction = Some(0.98 * limit));
    found(
        move |p| p.scene.friction = Some(1.02 * limit),
        &[Kind::Push],
        "o0 tips: it is pushed 70.0 mm above its bottom",
    );
    // Its own counts; on another object the larger one.
    found(move |p| p.scene.objects[0].friction = Some(1.02 * limit), &[Kind::Push], "o0 tips");
    let own = move |p: &mut PlanFile| {
        (p.scene.friction, p.scene.objects[0].friction) = (Some(1.02 * limit), Some(0.98 * limit));
    };
    sound(own);
    let board = move |p: &mut PlanFile| {
        let table = p.scene.fixtures.remove(0);
        let position = [table.position[0], table.position[1], -0.15];
        let size = table.r#box.as_ref().expect("a box").size;
        p.scene.fixtures.insert(0, boxed("ground", [size[0], size[1], 0.1], position));
        p.scene.objects.push(Body { friction: Some(1.02 * limit), ..boxed("board", size, table.position) });
    };
    found(board, &[Kind::Push], "o0 tips");
    // On a narrow foot; and up to the height of the fingers only.
    found(
        |p| p.scene.objects[0] = on_a_foot(&p.scene.objects[0], 0.02),
        &[Kind::Push],
        "it slides if that is below 50.",
    );
    let tall = move |friction: f64| {
        move |p: &mut PlanFile| {
            // The palm would be in it: it is gone.
            p.robot.urdf = p.robot.urdf.replace("<box size=\"0.14 0.04 0.03\"/>", "<box size=\"0.14 0.04 0.001\"/>");
            p.robot.urdf = p.robot.urdf.replace("<box size=\"0.01 0.02 0.08\"/>", "<box size=\"0.01 0.02 0.06\"/>");
            p.scene.friction = Some(friction);
        }
    };
    // From 13 to 73 mm above the table, then.
    sound(tall(0.98 * limit));
}

#[test]
fn what_is_not_round_turns_aside() {
    let (side, height) = (2.0 * PUSHED_RADIUS, PUSHED_HEIGHT);
    let as_box = |p: &mut PlanFile| {
        let ([x, y, _], _) = way(p);
        let object = &mut p.scene.objects[0];
        (object.cylinder, object.r#box) = (None, Some(BoxKeys { size: [side, side, height] }));
        let turn = y.atan2(x);
        object.rpy = Some([0.0, 0.0, turn]);
        step(p).placed.quaternion = [0.0, 0.0, (turn / 2.0).sin(), (turn / 2.0).cos()];
    };
    found(as_box, &[Kind::Push], "o0 may turn aside: it is not round");
    let as_ball = |p: &mut PlanFile| {
        let object = &mut p.scene.objects[0];
        (object.cylinder, object.sphere) = (None, Some(SphereKeys { radius: PUSHED_RADIUS }));
    };
    found(as_ball, &[Kind::Push], "o0 may turn aside: it may roll");
    let crooked = |p: &mut PlanFile| {
        let mut body = on_a_foot(&p.scene.objects[0], 0.03);
        body.compound.as_mut().expect("parts")[1].position[0] += 1e-3;
        p.scene.objects[0] = body;
    };
    found(crooked, &[Kind::Push], "its parts have no common axis");
}

#[test]
fn it_stops_with_the_hand() {
    for seed in 0..6 {
        let mut plan = plan(seed);
        // The hardest braking, by second differences.
        let rows = &plan.steps[0].segments[PUSH].positions;
        let ([x, y, _], _) = way(&plan);
        let along = |row: &[f64]| row[0] * x + row[1] * y;
        let braking = |w: &[Vec<f64>]| (2.0 * along(&w[1]) - along(&w[0]) - along(&w[2])) / 4e-4;
        let most = rows.windows(3).map(braking).fold(0.0, f64::max);
        for (share, stops) in [(1.02, true), (0.97, false)] {
            plan.scene.friction = Some(share * most / 9.81);
            let report = judge(&plan);
            assert_eq!(report.is_valid(), stops, "{share}: {report}");
            assert!(stops || report.has(Kind::Push) && report.to_string().contains("the hand brakes at"), "{report}");
        }
        // Stopped dead, within the limits that such a plan claims.
        plan.scene.friction = None;
        let segment = &mut plan.steps[0].segments[PUSH];
        let count = segment.times.len();
        let last = segment.positions[count - 1].clone();
        segment.positions.truncate(count / 2);
        segment.times.truncate(count / 2);
        let stop = segment.positions[count / 2 - 1].clone();
        let moved = along(&stop) - along(&segment.positions[0]);
        let short: [f64; 4] = std::array::from_fn(|j| stop[j] - last[j]);
        for later in &mut plan.steps[0].segments[PUSH + 1..] {
            later.positions.iter_mut().for_each(|row| (0..4).for_each(|j| row[j] += short[j]));
        }
        let start = plan.scene.objects[0].position;
        let push = plan.steps[0].push.as_mut().expect("a push");
        push.distance = moved - push.free;
        let at = [start[0] + push.distance * x, start[1] + push.distance * y, start[2]];
        plan.steps[0].placed = PlacedPose { position: at, quaternion: [0.0, 0.0, 0.0, 1.0] };
        let report = judge(&plan);
        assert!(report.has(Kind::Push) && report.to_string().contains("the hand brakes at"), "{report}");
    }
}

#[test]
fn held_or_not() {
    let mut plan = plan(1);
    two_segments(&mut plan);
    let at = plan.scene.objects[0].position;
    let pose = PlacedPose { position: at, quaternion: [0.0, 0.0, 0.0, 1.0] };
    let attached =
        clearway_plan::plan_file::Attached { object: "o0".into(), tool: "grasp_center".into(), pose_in_tool: pose };
    plan.steps[0].segments[PUSH + 1].attached = Some(attached);
    let report = judge(&plan);
    assert!(report.to_string().contains("o0 is held in some push segments, and in others not"), "{report}");
    // A step without a push segment.
    let mut plan = self::plan(1);
    plan.steps[0].segments[PUSH].kind = SegmentKind::Transit;
    assert!(judge(&plan).has(Kind::Steps));
}
