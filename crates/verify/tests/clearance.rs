//! The room that plans keep: against brute force, on either side of what is asked, and what is left out.

mod gantry;
#[path = "faults/robot.rs"]
#[allow(dead_code)] // as much as faults need
mod robot;

use clearway_plan::clearance::{Clearance, Least};
use clearway_plan::plan_file::{Segment, SegmentKind};
use clearway_plan::scene_file::{Body, BoxKeys, Part};
use clearway_plan::{Budget, PlanFile};
use clearway_verify::{CannotJudge, Report, ViolationKind as Kind, accept, verify};
use k::link::Geometry;
use parry3d_f64::math::{Pose, Rotation, Vector};
use parry3d_f64::query;
use parry3d_f64::shape::{Ball, Capsule, Cuboid, Cylinder, SharedShape};
use rand::SeedableRng;
use rand_xoshiro::Xoshiro256PlusPlus;
use robot::{Robot, isometry, placed};
use std::f64::consts::FRAC_PI_2;
use std::path::Path;

fn plan(seed: u64) -> PlanFile {
    gantry::plan(&mut Xoshiro256PlusPlus::seed_from_u64(seed))
}

fn pushing(seed: u64) -> PlanFile {
    gantry::pushing(&mut Xoshiro256PlusPlus::seed_from_u64(seed))
}

fn judge(plan: &PlanFile) -> Report {
    verify(plan, Path::new(""), &Budget::unlimited()).expect("judged")
}

fn least(report: &Report) -> Least {
    report.clearance.as_ref().and_then(|c| c.least.clone()).unwrap_or_else(|| panic!("nothing near: {report}"))
}

/// A solid in the world, and whose it is.
struct Solid {
    id: String,
    pose: Pose,
    shape: SharedShape,
}

fn along_z(radius: f64, height: f64) -> (Pose, SharedShape) {
    (Pose::from_rotation(Rotation::from_rotation_x(FRAC_PI_2)), SharedShape::new(Cylinder::new(height / 2.0, radius)))
}

fn shape(geometry: &Geometry<f64>) -> (Pose, SharedShape) {
    match geometry {
        Geometry::Box { depth, width, height } => {
            (Pose::IDENTITY, SharedShape::new(Cuboid::new(Vector::new(*depth, *width, *height) / 2.0)))
        }
        Geometry::Cylinder { radius, length } => along_z(*radius, *length),
        Geometry::Sphere { radius } => (Pose::IDENTITY, SharedShape::new(Ball::new(*radius))),
        Geometry::Capsule { radius, length } => {
            let end = Vector::Z * (*length / 2.0);
            (Pose::IDENTITY, SharedShape::new(Capsule::new(-end, end, *radius)))
        }
        Geometry::Mesh { .. } => panic!("the gantry has no meshes"),
    }
}

/// The parts of a body that is at `at`.
fn body(body: &Body, at: Pose) -> Vec<Solid> {
    let one = |geometry: &Geometry<f64>, at: Pose| {
        let (turn, shape) = shape(geometry);
        Solid { id: body.id.clone(), pose: at * turn, shape }
    };
    if let Some(geometry) = robot::primitive(body) {
        return vec![one(&geometry, at)];
    }
    let parts = body.compound.iter().flatten().map(|part| {
        let alone = Body { r#box: part.r#box.clone(), cylinder: part.cylinder.clone(), ..Body::default() };
        one(&robot::primitive(&alone).expect("a part"), at * Pose::from_translation(part.position.into()))
    });
    parts.collect()
}

fn pose(position: [f64; 3], quaternion: [f64; 4]) -> Pose {
    Pose::from_parts(position.into(), Rotation::from_array(quaternion))
}

fn start(body: &Body) -> Pose {
    let turn = body.rpy.map_or(body.quaternion.unwrap_or([0.0, 0.0, 0.0, 1.0]), |[_, _, yaw]| {
        [0.0, 0.0, (yaw / 2.0).sin(), (yaw / 2.0).cos()]
    });
    pose(body.position, turn)
}

/// The least distance at `fine` instants between any two rows, by the definition, with the kinematics of `k`.
fn brute_force(plan: &PlanFile, fine: u32) -> f64 {
    let robot = Robot::new(plan);
    let mut at: Vec<Pose> = plan.scene.objects.iter().map(start).collect();
    let fixtures: Vec<Solid> = plan.scene.fixtures.iter().flat_map(|f| body(f, start(f))).collect();
    let mut best = f64::INFINITY;
    for step in &plan.steps {
        let object = plan.scene.objects.iter().position(|o| o.id == step.object).expect("an object");
        let (from, to) = (at[object], pose(step.placed.position, step.placed.quaternion));
        for segment in &step.segments {
            let mut look = |row: usize, fraction: f64, at: &mut [Pose]| {
                robot.move_to(plan, segment, row, fraction);
                let held = segment.attached.as_ref().map(|attached| {
                    let found =
                        placed(&(robot.link_pose(&attached.tool).expect("a link") * isometry(&attached.pose_in_tool)));
                    pose(found.position, found.quaternion)
                });
                let moved = held.unwrap_or(at[object]);
                let pushed = pushed(plan, segment, row, fraction);
                let moved = pushed.map_or(moved, |way| Pose::from_translation(way) * from);
                at[object] = moved;
                let mut least = f64::INFINITY;
                let mut meet = |a: &Solid, b: &Solid| {
                    least = least
                        .min(query::distance(&a.pose, &*a.shape, &b.pose, &*b.shape).expect("known shapes").distance);
                };
                let moves = held.is_some() || pushed.is_some();
                let objects = || plan.scene.objects.iter().zip(at.iter()).map(|(o, p)| body(o, *p)).enumerate();
                for link in robot.shapes() {
                    let (turn, shape) = shape(&link.geometry);
                    let found = placed(&link.world_from_shape);
                    let part =
                        Solid { id: link.link.clone(), pose: pose(found.position, found.quaternion) * turn, shape };
                    if link.link != "rail" {
                        fixtures.iter().for_each(|f| meet(&part, f));
                    }
                    let hand = plan.robot.hand.links.contains(&link.link);
                    for (i, solids) in objects() {
                        let gripping = i == object && (segment.kind != SegmentKind::Transit || moves);
                        if !(hand && gripping) {
                            solids.iter().for_each(|s| meet(&part, s));
                        }
                    }
                }
                if moves {
                    let near = |end: &Pose| (end.translation - moved.translation).length() <= 0.03;
                    for part in body(&plan.scene.objects[object], moved) {
                        for other in &fixtures {
                            let carries = other.id == "table" && (near(&from) || pushed.is_some())
                                || other.id == "tray" && near(&to);
                            if !carries {
                                meet(&part, other);
                            }
                        }
                        for (i, solids) in objects() {
                            if i != object {
                                solids.iter().for_each(|s| meet(&part, s));
                            }
                        }
                    }
                }
                best = best.min(least);
            };
            for row in 0..segment.times.len() - 1 {
                for i in 0..fine {
                    look(row, f64::from(i) / f64::from(fine), &mut at);
                }
            }
            look(segment.times.len() - 1, 0.0, &mut at);
            if matches!(segment.kind, SegmentKind::Push | SegmentKind::Release) {
                at[object] = to;
            }
        }
    }
    best
}

/// How far the object is pushed then.
fn pushed(plan: &PlanFile, segment: &Segment, row: usize, fraction: f64) -> Option<Vector> {
    let push = plan.steps[0].push.as_ref().filter(|_| segment.kind == SegmentKind::Push)?;
    let next = (row + 1).min(segment.times.len() - 1);
    let direction = Vector::from(push.direction);
    let along = |row: usize| {
        let gone = |j: usize| segment.positions[row][j] - segment.positions[0][j];
        (Vector::new(gone(0), gone(1), gone(2)).dot(direction) - push.free).clamp(0.0, push.distance)
    };
    Some(direction * (along(row) + fraction * (along(next) - along(row))))
}

#[test]
fn as_by_brute_force() {
    let mut plans: Vec<PlanFile> = (0..4).map(plan).collect();
    for seed in 0..4 {
        let mut plan = pushing(seed);
        // Beside the way, and before the finger where it ends.
        for (id, share, left, far) in [("wall", 0.5, 0.06, 0.0), ("stop", 1.0, 0.0, 0.085)] {
            let push = plan.steps[0].push.as_ref().expect("a push");
            let [x, y, _] = push.direction;
            let (way, at) = (share * push.distance + far, plan.scene.objects[0].position);
            let position = [at[0] + way * x - left * y, at[1] + way * y + left * x, 0.02];
            let size = Some(BoxKeys { size: [0.02, 0.02, 0.04] });
            plan.scene.fixtures.push(Body { id: id.into(), r#box: size, position, ..Body::default() });
        }
        plans.push(plan);
    }
    for (i, plan) in plans.iter().enumerate() {
        let report = judge(plan);
        assert!(report.is_valid(), "plan {i}: {report}");
        let (found, expected) = (least(&report).distance, brute_force(plan, 8));
        // Found to 0.1 mm; and less than what samples see, which move by less than 0.5 mm.
        assert!(found < expected + 1e-4 && found > expected - 6e-4, "plan {i}: {found}, not {expected}: {report}");
    }
}

/// Over the bridge, whose top slides along x at 0.925 m.
fn lintel(plan: &mut PlanFile, gap: f64) {
    let size = Some(BoxKeys { size: [3.0, 3.0, 0.01] });
    let position = [0.0, 0.0, 0.925 + 0.005 + gap];
    plan.scene.fixtures.push(Body { id: "lintel".into(), r#box: size, position, ..Body::default() });
}

#[test]
fn what_is_asked() {
    for (gap, asked, valid) in [
        (2e-3, 2e-3, true),
        (1.93e-3, 2e-3, true),
        (1.85e-3, 2e-3, false),
        (2e-3, 0.0, true),
        (0.0, 0.0, true),
        (1e-3, 0.06, false),
    ] {
        let mut plan = plan(7);
        lintel(&mut plan, gap);
        plan.scene.clearance = Some(asked);
        let report = judge(&plan);
        assert_eq!(report.is_valid(), valid, "{gap}, {asked}: {report}");
        let least = least(&report);
        assert!((least.distance - gap).abs() < 1e-4, "{report}");
        assert_eq!(least.between, ["link bridge", "fixture lintel"], "{report}");
        assert!((least.at[2] - 0.925).abs() < 1e-6, "{least:?}");
        assert_eq!(report.has(Kind::Clearance), !valid);
        assert!(
            valid
                || report.to_string().contains("link bridge comes within 1.")
                    && report.to_string().contains("; the scene asks for")
        );
    }
    let mut plan = plan(7);
    lintel(&mut plan, 3.24e-3);
    plan.scene.clearance = Some(2e-3);
    let text = judge(&plan).to_string();
    assert!(
        text.contains("clearance 3.2 mm (asked: 2.0 mm), least between link bridge and fixture lintel at "),
        "{text}"
    );
    for asked in [f64::NAN, -1e-3] {
        plan.scene.clearance = Some(asked);
        assert!(matches!(verify(&plan, Path::new(""), &Budget::unlimited()), Err(CannotJudge::Scene { .. })));
    }
}

#[test]
fn what_is_claimed() {
    let mut plan = plan(7);
    lintel(&mut plan, 2e-3);
    let accepted = accept(plan.clone(), Path::new(""), &Budget::unlimited()).expect("valid");
    let told = accepted.plan().clearance.clone().expect("measured");
    assert_eq!(Some(&told), accepted.report().clearance.as_ref());
    let claims = |more: f64| {
        let least = told.least.clone().map(|l| Least { distance: l.distance + more, ..l });
        Clearance { least, ..told.clone() }
    };
    for (claim, valid) in [
        (claims(0.0), true),
        (claims(1.5e-4), true),
        (claims(3e-4), false),
        (claims(f64::NAN), false),
        (claims(-1.0), true),
        (Clearance { least: None, ..told.clone() }, false),
        (Clearance { asked: 1e-3, ..told.clone() }, false),
    ] {
        plan.clearance = Some(claim);
        let report = judge(&plan);
        assert_eq!(report.is_valid(), valid, "{:?}: {report}", plan.clearance);
        assert_eq!(report.has(Kind::Clearance), !valid);
    }
}

/// A wall beside all of a push, with a bump at the middle: a fixture of two parts.
fn wall(plan: &mut PlanFile, gap: f64, bump: f64) {
    let push = plan.steps[0].push.as_ref().expect("a push");
    let ([x, y, _], at) = (push.direction, plan.scene.objects[0].position);
    let turn = y.atan2(x);
    let boxed =
        |size: [f64; 3], position: [f64; 3]| Part { r#box: Some(BoxKeys { size }), position, ..Part::default() };
    let parts =
        vec![boxed([0.8, 0.01, 0.002], [0.0, 0.005, 0.0]), boxed([0.001, 0.01, 0.002], [0.0, 0.005 - bump, 0.0])];
    let (way, left) = (push.distance / 2.0, gantry::PUSHED_RADIUS + gap);
    let position = [at[0] + way * x - left * y, at[1] + way * y + left * x, 0.001];
    plan.scene.fixtures.push(Body {
        id: "wall".into(),
        compound: Some(parts),
        position,
        rpy: Some([0.0, 0.0, turn]),
        ..Body::default()
    });
}

#[test]
fn neighbours_limit_what_is_asked() {
    // (gap all along, nearer by this in the middle, asked): whether it is let pass, and whether it counts.
    for (gap, bump, asked, valid, counts) in [
        (1e-3, 0.0, 0.0, true, true),
        (1e-3, 0.0, 2e-3, true, false),
        (1e-3, 5e-5, 2e-3, true, false),
        (1e-3, 3e-4, 2e-3, false, false),
        (2.5e-3, 3e-4, 2e-3, true, true),
        (2.5e-3, 9e-4, 2e-3, false, true),
    ] {
        for seed in 0..5 {
            let mut plan = pushing(seed);
            wall(&mut plan, gap, bump);
            plan.scene.clearance = Some(asked);
            let report = judge(&plan);
            assert_eq!(report.is_valid(), valid, "{gap}, {bump}, {asked}, seed {seed}: {report}");
            assert_eq!(report.has(Kind::Clearance), !valid, "{report}");
            let counted = least(&report).between == ["pushed o0", "fixture wall"];
            assert_eq!(counted, counts, "{gap}, {bump}, {asked}, seed {seed}: {report}");
            let words = if counts { "the scene asks for" } else { "where it is taken or put they are 1.00 mm apart" };
            assert!(valid || report.to_string().contains(words), "{report}");
        }
    }
    // Held beside another object, 1 mm away: drawn straight up, it keeps that.
    for (asked, expected) in [(0.0, true), (2e-3, false)] {
        let mut plan = plan(2);
        let step = &plan.steps[0];
        let taken = plan.scene.objects.iter().find(|o| o.id == step.object).expect("an object");
        // Lower than the fingers come, and narrow: on the side of the object that no finger is at.
        let (at, yaw) = (start(taken), start(taken).rotation);
        let half = match (&taken.cylinder, &taken.r#box) {
            (Some(c), _) => c.radius,
            (_, Some(b)) => b.size[1] / 2.0,
            _ => 0.02,
        };
        let aside = at.translation + yaw * Vector::new(0.0, half + 1e-3 + 5e-4, 0.0);
        let body = Body {
            id: "beside".into(),
            r#box: Some(BoxKeys { size: [1e-3, 1e-3, 0.01] }),
            position: [aside.x, aside.y, 0.005],
            quaternion: Some(yaw.to_array()),
            ..Body::default()
        };
        plan.scene.objects.push(body);
        plan.scene.clearance = Some(asked);
        let report = judge(&plan);
        assert!(report.is_valid(), "{report}");
        let counted = least(&report).between[1] == "object beside";
        assert_eq!(counted, expected, "{report}");
        assert!(!counted || (least(&report).distance - 1e-3).abs() < 1e-4, "{report}");
    }
}
