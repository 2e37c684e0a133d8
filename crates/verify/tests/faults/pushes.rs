//! Faults of pushes, for plans that have any.

use super::robot::Robot;
use super::{Fault, Random, either_sign, pick};
use clearway_plan::PlanFile;
use clearway_plan::plan_file::{Action, SegmentKind};
use clearway_plan::scene_file::{Body, BoxKeys};
use clearway_verify::ViolationKind as Kind;
use rand::RngExt;

pub const FAULTS: fn() -> Vec<Fault> = || {
    vec![
        Fault { name: "pushed too high", expected: &[Kind::Push], plant: too_high },
        Fault { name: "pushed too suddenly", expected: &[Kind::Push], plant: too_sudden },
        Fault { name: "what is pushed is not round", expected: &[Kind::Push], plant: not_round },
        Fault { name: "hand meets what it pushes elsewhere", expected: &[Kind::Push], plant: met_elsewhere },
        Fault { name: "pushed another way than is said", expected: &[Kind::Push], plant: another_way },
        Fault {
            name: "fixture in the pushed object's way",
            expected: &[Kind::PushedCollision, Kind::Overlap],
            plant: in_its_way,
        },
    ]
};

/// A step that pushes, and the number of its object.
fn some_push(plan: &PlanFile, random: &mut Random) -> Option<(usize, usize)> {
    let pushes: Vec<usize> = (0..plan.steps.len()).filter(|i| plan.steps[*i].action == Action::Push).collect();
    let step = pick(&pushes, random)?;
    plan.steps[step].push.as_ref().filter(|push| push.distance > 0.01)?;
    let held = plan.steps[step].segments.iter().any(|s| s.kind == SegmentKind::Push && s.attached.is_some());
    let object = plan.scene.objects.iter().position(|o| o.id == plan.steps[step].object)?;
    (!held).then_some((step, object))
}

/// So rough that it tips wherever it is pushed but at its foot.
fn too_high(plan: &mut PlanFile, _: &Robot, random: &mut Random) -> Option<()> {
    let (_, object) = some_push(plan, random)?;
    plan.scene.objects[object].friction = Some(random.random_range(20.0..50.0));
    Some(())
}

/// So smooth that it slides on.
fn too_sudden(plan: &mut PlanFile, _: &Robot, random: &mut Random) -> Option<()> {
    let (_, object) = some_push(plan, random)?;
    plan.scene.objects[object].friction = Some(random.random_range(1e-4..1e-3));
    Some(())
}

/// A box within the cylinder.
fn not_round(plan: &mut PlanFile, _: &Robot, random: &mut Random) -> Option<()> {
    let (_, object) = some_push(plan, random)?;
    let body = &mut plan.scene.objects[object];
    let round = body.cylinder.take()?;
    let side = round.radius * std::f64::consts::SQRT_2;
    body.r#box = Some(BoxKeys { size: [side, side, round.height] });
    Some(())
}

/// Later, so that it would be within the object, or before it is there.
fn met_elsewhere(plan: &mut PlanFile, _: &Robot, random: &mut Random) -> Option<()> {
    let (step, _) = some_push(plan, random)?;
    let step = &mut plan.steps[step];
    let push = step.push.as_mut()?;
    let by = either_sign(random, 5e-3, 8e-3);
    if push.free + by < 0.0 {
        return None;
    }
    (push.free, push.distance) = (push.free + by, push.distance - by);
    (0..3).for_each(|a| step.placed.position[a] -= by * push.direction[a]);
    Some(())
}

fn another_way(plan: &mut PlanFile, _: &Robot, random: &mut Random) -> Option<()> {
    let (step, _) = some_push(plan, random)?;
    let push = plan.steps[step].push.as_mut()?;
    // More than 1 mm beside the way of the tool.
    let turn = either_sign(random, 2e-3 / push.distance, 3.0);
    let [x, y, z] = push.direction;
    push.direction = [x * turn.cos() - y * turn.sin(), x * turn.sin() + y * turn.cos(), z];
    Some(())
}

/// A post half-way through the object.
fn in_its_way(plan: &mut PlanFile, _: &Robot, random: &mut Random) -> Option<()> {
    let (step, _) = some_push(plan, random)?;
    let step = &plan.steps[step];
    let push = step.push.as_ref()?;
    let back = random.random_range(0.0..push.distance);
    let position = std::array::from_fn(|a| step.placed.position[a] - back * push.direction[a]);
    let size = Some(BoxKeys { size: [0.01; 3] });
    plan.scene.fixtures.push(Body { id: "post".into(), r#box: size, position, ..Body::default() });
    Some(())
}
