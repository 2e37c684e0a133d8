//! Faults of touching: something stands 0.5 mm deep in a shape's way at some instant, between rows
//! as well as on them.

use super::robot::{LinkShape, Robot, isometry, primitive, support};
use super::{Fault, Random, moves, segment_of};
use clearway_plan::PlanFile;
use clearway_plan::clearance::Clearance;
use clearway_plan::scene_file::{Body, BoxKeys, CylinderKeys, SphereKeys};
use clearway_verify::ViolationKind as Kind;
use k::link::Geometry;
use k::{Isometry3, UnitQuaternion, Vector3};
use rand::RngExt;
use std::f64::consts::PI;

/// Metres that an intruder reaches into what moves.
const DEPTH: f64 = 5e-4;
/// Metres asked of a plan, and what some intruder leaves.
const ASKED: f64 = 5e-4;
const LEFT: f64 = 2e-4;

pub const FAULTS: fn() -> Vec<Fault> = || {
    vec![
        Fault { name: "fixture 0.5 mm in a link's way", expected: &[Kind::Collision], plant: in_links_way },
        Fault {
            name: "fixture 0.5 mm in the held object's way",
            expected: &[Kind::HeldCollision],
            plant: in_held_ones_way,
        },
        Fault { name: "object moved into a link's way", expected: &[Kind::Collision], plant: object_in_the_way },
        Fault { name: "links touch by 0.5 mm", expected: &[Kind::SelfCollision], plant: links_touch },
        Fault {
            name: "link touches the held object by 0.5 mm",
            expected: &[Kind::HeldCollision],
            plant: link_touches_held,
        },
        Fault { name: "fixture 0.2 mm from a link's way", expected: &[Kind::Clearance], plant: near_links_way },
        Fault { name: "more room claimed than there is", expected: &[Kind::Clearance], plant: room_claimed },
    ]
};

fn direction(random: &mut Random) -> Vector3<f64> {
    let z: f64 = random.random_range(-1.0..1.0);
    let turn = random.random_range(-PI..PI);
    let flat = (1.0 - z * z).sqrt();
    Vector3::new(flat * turn.cos(), flat * turn.sin(), z)
}

/// A body whose nearest point to what lies against `out` is so far below `surface`: overlap along
/// `out`, and no less along any other direction.
fn intruder(surface: Vector3<f64>, out: Vector3<f64>, depth: f64, random: &mut Random) -> Body {
    let mut body = Body { id: "intruder".into(), ..Body::default() };
    let z_along_out = UnitQuaternion::rotation_between(&Vector3::z(), &out)
        .unwrap_or_else(|| UnitQuaternion::from_axis_angle(&Vector3::x_axis(), PI));
    let q = z_along_out.quaternion();
    body.quaternion = Some([q.i, q.j, q.k, q.w]);
    let thick = random.random_range(1.2e-3..0.03);
    let wide = random.random_range(1.5e-3..0.03);
    match random.random_range(0..3) {
        0 => body.sphere = Some(SphereKeys { radius: thick / 2.0 }),
        1 => body.r#box = Some(BoxKeys { size: [wide, wide, thick] }),
        _ => body.cylinder = Some(CylinderKeys { radius: wide / 2.0, height: thick }),
    }
    body.position = (surface + out * (thick / 2.0 - depth)).into();
    body
}

/// The robot at a random instant of a motion, mostly between rows.
fn instant(plan: &PlanFile, robot: &Robot, random: &mut Random, carrying: bool) -> Option<(usize, usize)> {
    let (i, j) = segment_of(plan, random, 3, |s| moves(s) && (s.attached.is_some() || !carrying))?;
    let segment = &plan.steps[i].segments[j];
    let row = random.random_range(0..segment.times.len() - 1);
    let fraction = if random.random_bool(0.2) { 0.0 } else { random.random_range(0.0..1.0) };
    robot.move_to(plan, segment, row, fraction);
    Some((i, j))
}

fn some_shape(robot: &Robot, random: &mut Random, wanted: impl Fn(&LinkShape) -> bool) -> Option<LinkShape> {
    let mut shapes: Vec<LinkShape> = robot.shapes().into_iter().filter(wanted).collect();
    (!shapes.is_empty()).then(|| shapes.swap_remove(random.random_range(0..shapes.len())))
}

fn in_links_way(plan: &mut PlanFile, robot: &Robot, random: &mut Random) -> Option<()> {
    instant(plan, robot, random, false)?;
    let shape = some_shape(robot, random, |s| !robot.moving_above(&s.link).is_empty())?;
    let out = direction(random);
    let surface = support(&shape.geometry, &shape.world_from_shape, &out);
    plan.scene.fixtures.push(intruder(surface, out, DEPTH, random));
    Some(())
}

/// Nothing is touched; but the scene asks for more room.
fn near_links_way(plan: &mut PlanFile, robot: &Robot, random: &mut Random) -> Option<()> {
    instant(plan, robot, random, false)?;
    let shape = some_shape(robot, random, |s| !robot.moving_above(&s.link).is_empty())?;
    let out = direction(random);
    let surface = support(&shape.geometry, &shape.world_from_shape, &out);
    plan.scene.fixtures.push(intruder(surface, out, -LEFT, random));
    plan.scene.clearance = Some(ASKED);
    Some(())
}

/// No plan that takes things from among others keeps 45 mm.
fn room_claimed(plan: &mut PlanFile, _: &Robot, _: &mut Random) -> Option<()> {
    let asked = plan.scene.clearance.unwrap_or(0.0);
    plan.clearance = Some(Clearance { asked, least: None, up_to: 0.045 });
    Some(())
}

/// The held object's shape and pose now; `None` within 10 mm of where it stood or will stand: what
/// reaches into it there by less than 1 mm from below may be what it stands on.
fn held(plan: &PlanFile, robot: &Robot, (i, j): (usize, usize)) -> Option<(Geometry<f64>, Isometry3<f64>)> {
    let attached = plan.steps[i].segments[j].attached.as_ref()?;
    let body = plan.scene.objects.iter().find(|o| o.id == attached.object)?;
    let pose = robot.link_pose(&attached.tool)? * isometry(&attached.pose_in_tool);
    let near = |stood: [f64; 3]| (Vector3::from(stood) - pose.translation.vector).norm() < 0.01;
    let resting = near(body.position) || near(plan.steps[i].placed.position);
    (!resting).then_some((primitive(body)?, pose))
}

fn in_held_ones_way(plan: &mut PlanFile, robot: &Robot, random: &mut Random) -> Option<()> {
    let at = instant(plan, robot, random, true)?;
    let (geometry, pose) = held(plan, robot, at)?;
    let out = direction(random);
    let surface = support(&geometry, &pose, &out);
    plan.scene.fixtures.push(intruder(surface, out, DEPTH, random));
    Some(())
}

/// An object that is not taken stands with its centre in a link.
fn object_in_the_way(plan: &mut PlanFile, robot: &Robot, random: &mut Random) -> Option<()> {
    instant(plan, robot, random, false)?;
    let shape = some_shape(robot, random, |s| !robot.moving_above(&s.link).is_empty())?;
    let taken: Vec<String> = plan.steps.iter().map(|s| s.object.clone()).collect();
    let still: Vec<usize> =
        (0..plan.scene.objects.len()).filter(|i| !taken.contains(&plan.scene.objects[*i].id)).collect();
    let object = super::pick(&still, random)?;
    // Compounds may be hollow at their centre.
    primitive(&plan.scene.objects[object])?;
    plan.scene.objects[object].position = shape.world_from_shape.translation.vector.into();
    Some(())
}

/// Adds a ball to a link's collision shapes in the URDF.
fn add_ball(plan: &mut PlanFile, link: &str, center: Vector3<f64>, radius: f64) -> Option<()> {
    let start = plan.robot.urdf.find(&format!("<link name=\"{link}\">"))?;
    let at = start + plan.robot.urdf[start..].find('>')? + 1;
    let ball = format!(
        "<collision><origin xyz=\"{} {} {}\"/><geometry><sphere radius=\"{radius}\"/></geometry></collision>",
        center.x, center.y, center.z
    );
    plan.robot.urdf.insert_str(at, &ball);
    Some(())
}

/// One link grows a ball that another runs into.
fn links_touch(plan: &mut PlanFile, robot: &Robot, random: &mut Random) -> Option<()> {
    instant(plan, robot, random, false)?;
    let shape = some_shape(robot, random, |_| true)?;
    let unchecked =
        |other: &String| plan.robot.unchecked_pairs.iter().any(|p| p.contains(&shape.link) && p.contains(other));
    let other = some_shape(robot, random, |s| s.link != shape.link && !unchecked(&s.link))?;
    let out = direction(random);
    let radius = random.random_range(1e-3..0.02);
    let center = support(&shape.geometry, &shape.world_from_shape, &out) + out * (radius - DEPTH);
    let in_other = other.world_from_link.inverse() * k::nalgebra::Point3::from(center);
    add_ball(plan, &other.link, in_other.coords, radius)
}

/// A link that is not the hand's grows a ball that reaches into what is held.
fn link_touches_held(plan: &mut PlanFile, robot: &Robot, random: &mut Random) -> Option<()> {
    let at = instant(plan, robot, random, true)?;
    let (geometry, pose) = held(plan, robot, at)?;
    let hand = plan.robot.hand.links.clone();
    let other = some_shape(robot, random, |s| !hand.contains(&s.link))?;
    let out = direction(random);
    let radius = random.random_range(1e-3..0.02);
    let center = support(&geometry, &pose, &out) + out * (radius - DEPTH);
    let in_other = other.world_from_link.inverse() * k::nalgebra::Point3::from(center);
    add_ball(plan, &other.link, in_other.coords, radius)
}
