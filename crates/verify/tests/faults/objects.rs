//! Faults of what is held and where it stands.

use super::robot::{Robot, isometry, placed};
use super::{Fault, Random, either_sign, pick, segment_of};
use clearway_plan::PlanFile;
use clearway_plan::plan_file::Attached;
use clearway_plan::scene_file::{Body, BoxKeys};
use clearway_verify::ViolationKind as Kind;
use k::{Isometry3, Translation3, UnitQuaternion, Vector3, nalgebra as na};
use rand::RngExt;
use std::f64::consts::PI;

pub const FAULTS: fn() -> Vec<Fault> = || {
    vec![
        Fault { name: "attachment skipped", expected: &[Kind::Attachment], plant: attachment_skipped },
        Fault { name: "attached too early or too long", expected: &[Kind::Attachment], plant: attached_outside },
        Fault { name: "hold changes on the way", expected: &[Kind::Attachment], plant: hold_changes },
        Fault { name: "object jumps into the hand", expected: &[Kind::Teleport], plant: jumps_into_hand },
        Fault { name: "object turns in the hand", expected: &[Kind::Teleport], plant: turns_in_hand },
        Fault { name: "attached far from the hand", expected: &[Kind::Grip], plant: far_from_hand },
        Fault { name: "let go in mid-air", expected: &[Kind::LetGo], plant: mid_air },
        Fault {
            name: "put down elsewhere than placed",
            expected: &[Kind::PutDown, Kind::LetGo, Kind::Push],
            plant: elsewhere,
        },
        Fault { name: "placed tilted", expected: &[Kind::Tilted], plant: tilted },
        Fault { name: "placed off the tray", expected: &[Kind::OffPlace], plant: off_place },
        Fault { name: "placed above the tray", expected: &[Kind::Unsupported], plant: above_place },
        Fault { name: "placed inside another object", expected: &[Kind::Overlap], plant: inside_another },
        Fault { name: "object floats", expected: &[Kind::Unsupported], plant: floats },
        Fault { name: "objects overlap at the start", expected: &[Kind::Overlap], plant: overlap_at_start },
        Fault { name: "support taken from under an object", expected: &[Kind::Unsupported], plant: support_taken },
        Fault { name: "object stands over an edge", expected: &[Kind::Unstable], plant: over_an_edge },
        Fault { name: "one of two supports taken", expected: &[Kind::Unstable], plant: one_support_taken },
        Fault { name: "put down over an edge", expected: &[Kind::Unstable], plant: put_over_an_edge },
    ]
};

fn is_attached(segment: &clearway_plan::plan_file::Segment) -> bool {
    segment.attached.is_some()
}

fn all_attached(plan: &mut PlanFile, step: usize) -> impl Iterator<Item = &mut Attached> {
    plan.steps[step].segments.iter_mut().filter_map(|s| s.attached.as_mut())
}

fn some_direction(random: &mut Random) -> Vector3<f64> {
    let z: f64 = random.random_range(-1.0..1.0);
    let turn = random.random_range(-PI..PI);
    let flat = (1.0 - z * z).sqrt();
    Vector3::new(flat * turn.cos(), flat * turn.sin(), z)
}

fn body<'a>(plan: &'a mut PlanFile, id: &str) -> Option<&'a mut Body> {
    plan.scene.objects.iter_mut().find(|o| o.id == id)
}

fn attachment_skipped(plan: &mut PlanFile, _: &Robot, random: &mut Random) -> Option<()> {
    let (i, j) = segment_of(plan, random, 1, is_attached)?;
    plan.steps[i].segments[j].attached = None;
    Some(())
}

fn attached_outside(plan: &mut PlanFile, _: &Robot, random: &mut Random) -> Option<()> {
    let step = random.random_range(0..plan.steps.len());
    let attached = all_attached(plan, step).next()?.clone();
    use clearway_plan::plan_file::SegmentKind::{Approach, Retreat, Transit};
    let segments = &mut plan.steps[step].segments;
    let free: Vec<usize> = (0..segments.len())
        .filter(|j| segments[*j].attached.is_none() && matches!(segments[*j].kind, Transit | Approach | Retreat))
        .collect();
    segments[pick(&free, random)?].attached = Some(attached);
    Some(())
}

fn hold_changes(plan: &mut PlanFile, _: &Robot, random: &mut Random) -> Option<()> {
    let step = random.random_range(0..plan.steps.len());
    let count = all_attached(plan, step).count();
    let away = some_direction(random) * random.random_range(1e-5..0.05);
    let which = (count > 1).then(|| random.random_range(1..count))?;
    let attached = all_attached(plan, step).nth(which)?;
    (0..3).for_each(|a| attached.pose_in_tool.position[a] += away[a]);
    Some(())
}

fn jumps_into_hand(plan: &mut PlanFile, _: &Robot, random: &mut Random) -> Option<()> {
    let step = random.random_range(0..plan.steps.len());
    // What is pushed is not held.
    all_attached(plan, step).next()?;
    // Twice the tolerance: a valid plan may use all of it.
    let away = some_direction(random) * random.random_range(2.01e-3..0.1);
    for attached in all_attached(plan, step) {
        (0..3).for_each(|a| attached.pose_in_tool.position[a] += away[a]);
    }
    Some(())
}

fn turns_in_hand(plan: &mut PlanFile, _: &Robot, random: &mut Random) -> Option<()> {
    let step = random.random_range(0..plan.steps.len());
    all_attached(plan, step).next()?;
    let axis = na::Unit::new_normalize(some_direction(random));
    let turn = UnitQuaternion::from_axis_angle(&axis, either_sign(random, 0.021, PI));
    for attached in all_attached(plan, step) {
        let pose = isometry(&attached.pose_in_tool);
        attached.pose_in_tool = placed(&Isometry3::from_parts(pose.translation, pose.rotation * turn));
    }
    Some(())
}

/// Held, all along, so far down that nothing of the hand is within 5 mm; the object stands there, too.
fn far_from_hand(plan: &mut PlanFile, robot: &Robot, random: &mut Random) -> Option<()> {
    let step = random.random_range(0..plan.steps.len());
    let first = plan.steps[step].segments.iter().position(is_attached)?;
    let attached = plan.steps[step].segments[first].attached.clone()?;
    robot.move_to(plan, &plan.steps[step].segments[first], 0, 0.0);
    let tool = robot.link_pose(&attached.tool)?;
    // Links of the hand reach less than 0.5 m, objects too.
    let away = Translation3::from(some_direction(random) * random.random_range(1.5..3.0));
    for attached in all_attached(plan, step) {
        attached.pose_in_tool = placed(&(away * isometry(&attached.pose_in_tool)));
    }
    let id = plan.steps[step].object.clone();
    if plan.steps.iter().filter(|s| s.object == id).count() > 1 {
        return None;
    }
    let stands = placed(&(tool * away * isometry(&attached.pose_in_tool)));
    let body = body(plan, &id)?;
    (body.position, body.rpy, body.quaternion) = (stands.position, None, Some(stands.quaternion));
    Some(())
}

/// What the object was to be put on, and where, is farther down.
fn mid_air(plan: &mut PlanFile, _: &Robot, random: &mut Random) -> Option<()> {
    let step = random.random_range(0..plan.steps.len());
    let down = random.random_range(4.1e-3..0.2);
    plan.steps[step].placed.position[2] -= down;
    plan.scene.place.iter_mut().for_each(|p| p.position[2] -= down);
    plan.scene.fixtures.iter_mut().for_each(|f| f.position[2] -= down);
    Some(())
}

fn elsewhere(plan: &mut PlanFile, _: &Robot, random: &mut Random) -> Option<()> {
    let step = &mut plan.steps;
    let step = random.random_range(0..step.len());
    let direction = random.random_range(-PI..PI);
    let far = random.random_range(2.01e-3..0.3);
    let position = &mut plan.steps[step].placed.position;
    position[0] += far * direction.cos();
    position[1] += far * direction.sin();
    Some(())
}

fn tilted(plan: &mut PlanFile, _: &Robot, random: &mut Random) -> Option<()> {
    let step = random.random_range(0..plan.steps.len());
    let direction = random.random_range(-PI..PI);
    let axis = na::Unit::new_normalize(Vector3::new(direction.cos(), direction.sin(), 0.0));
    let turn = UnitQuaternion::from_axis_angle(&axis, random.random_range(0.021..PI - 0.1));
    let pose = isometry(&plan.steps[step].placed);
    plan.steps[step].placed = placed(&Isometry3::from_parts(pose.translation, turn * pose.rotation));
    Some(())
}

/// The tray is elsewhere, by at least its own size.
fn off_place(plan: &mut PlanFile, _: &Robot, random: &mut Random) -> Option<()> {
    let axis = random.random_range(0..2);
    for place in &mut plan.scene.place {
        place.position[axis] += either_sign(random, 1.0, 3.0) * place.size[axis];
    }
    // Another place may now be where this one was.
    (plan.scene.place.len() == 1).then_some(())
}

/// Put down, and let go, above the tray. What it is of is where it was.
fn above_place(plan: &mut PlanFile, _: &Robot, random: &mut Random) -> Option<()> {
    let down = random.random_range(2.01e-3..0.1);
    plan.scene.place.iter_mut().for_each(|p| p.position[2] -= down);
    Some(())
}

/// Another object stands where this one is put.
fn inside_another(plan: &mut PlanFile, _: &Robot, random: &mut Random) -> Option<()> {
    let step = random.random_range(0..plan.steps.len());
    let still: Vec<String> = plan
        .scene
        .objects
        .iter()
        .map(|o| o.id.clone())
        .filter(|id| plan.steps.iter().all(|s| s.object != *id))
        .collect();
    let id = pick(&still, random)?;
    let mut at = plan.steps[step].placed.position;
    at[0] += random.random_range(-5e-3..5e-3);
    at[1] += random.random_range(-5e-3..5e-3);
    body(plan, &id)?.position = at;
    Some(())
}

fn floats(plan: &mut PlanFile, _: &Robot, random: &mut Random) -> Option<()> {
    let i = random.random_range(0..plan.scene.objects.len());
    plan.scene.objects[i].position[2] += random.random_range(2.01e-3..0.02);
    Some(())
}

fn overlap_at_start(plan: &mut PlanFile, _: &Robot, random: &mut Random) -> Option<()> {
    let count = plan.scene.objects.len();
    if count < 2 {
        return None;
    }
    let i = random.random_range(0..count);
    let j = (i + random.random_range(1..count)) % count;
    let at = plan.scene.objects[j].position;
    plan.scene.objects[i].position[0] = at[0] + random.random_range(-5e-3..5e-3);
    plan.scene.objects[i].position[1] = at[1] + random.random_range(-5e-3..5e-3);
    Some(())
}

/// A small box stands on an object that is taken before it.
fn support_taken(plan: &mut PlanFile, _: &Robot, random: &mut Random) -> Option<()> {
    let step = random.random_range(0..plan.steps.len());
    let id = plan.steps[step].object.clone();
    let [x, y, top] = top_of(body(plan, &id)?)?;
    let size = random.random_range(0.002..0.02);
    plan.scene.objects.push(boxed("on_top", [size; 3], [x, y, top + 0.5 * size]));
    Some(())
}

/// The middle of an upright object's top.
fn top_of(object: &Body) -> Option<[f64; 3]> {
    let height = match (&object.r#box, &object.cylinder) {
        (Some(b), _) => b.size[2],
        (_, Some(c)) => c.height,
        _ => return None,
    };
    let leans = object.rpy.is_some_and(|[r, p, _]| r != 0.0 || p != 0.0)
        || object.quaternion.is_some_and(|[x, y, ..]| x != 0.0 || y != 0.0);
    let [x, y, z] = object.position;
    (!leans).then_some([x, y, z + 0.5 * height])
}

fn boxed(id: &str, size: [f64; 3], position: [f64; 3]) -> Body {
    Body { id: id.into(), r#box: Some(BoxKeys { size }), position, ..Body::default() }
}

/// On a block far away; its centre is 2 mm beyond the edge, or farther.
fn over_an_edge(plan: &mut PlanFile, _: &Robot, random: &mut Random) -> Option<()> {
    let size = [(); 3].map(|()| random.random_range(0.01..0.2));
    let away = random.random_range(2e-3..0.5 * size[0] - 2e-3);
    plan.scene.fixtures.push(boxed("block", [1.0; 3], [9.5, 0.0, 0.5]));
    plan.scene.objects.push(boxed("over", size, [10.0 + away, 0.0, 1.0 + 0.5 * size[2]]));
    Some(())
}

/// A board lies on an object that is taken, and on a post, which stays.
fn one_support_taken(plan: &mut PlanFile, _: &Robot, random: &mut Random) -> Option<()> {
    let step = random.random_range(0..plan.steps.len());
    let id = plan.steps[step].object.clone();
    let [x, y, top] = top_of(body(plan, &id)?)?;
    let (length, thick) = (random.random_range(0.1..0.3), random.random_range(0.002..0.02));
    plan.scene.fixtures.push(boxed("post", [0.01, 0.01, 0.02], [x + length, y, top - 0.01]));
    plan.scene.objects.push(boxed("board", [length, 0.01, thick], [x + 0.5 * length, y, top + 0.5 * thick]));
    Some(())
}

/// The gantry's tray ends 2 mm, or more, before what is put down has its centre.
fn put_over_an_edge(plan: &mut PlanFile, _: &Robot, random: &mut Random) -> Option<()> {
    let step = random.random_range(0..plan.steps.len());
    let [x, ..] = plan.steps[step].placed.position;
    let tray = plan.scene.fixtures.iter_mut().find(|f| f.id == "tray")?;
    let width = tray.r#box.as_ref()?.size[0];
    tray.position[0] = x + random.random_range(2e-3..0.01) + 0.5 * width;
    Some(())
}
