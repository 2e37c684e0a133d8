//! Faults of structure: what a reader can see without moving the robot.

use super::robot::Robot;
use super::{Fault, Random, either_sign, moves, pick, segment_of};
use clearway_plan::PlanFile;
use clearway_plan::plan_file::{GripperValue, LowerBound, SegmentKind, Status};
use clearway_verify::ViolationKind as Kind;
use rand::RngExt;

pub const FAULTS: fn() -> Vec<Fault> = || {
    vec![
        Fault { name: "waypoint dropped", expected: &[Kind::Times], plant: waypoint_dropped },
        Fault { name: "rows too far apart", expected: &[Kind::Times], plant: rows_too_far_apart },
        Fault { name: "times not rising", expected: &[Kind::Times], plant: times_not_rising },
        Fault { name: "times not from 0", expected: &[Kind::Times], plant: times_not_from_zero },
        Fault { name: "row of wrong width or not finite", expected: &[Kind::Rows], plant: bad_row },
        Fault { name: "start that is not the robot's", expected: &[Kind::Start], plant: other_start },
        Fault { name: "segments do not join", expected: &[Kind::Continuity], plant: segments_do_not_join },
        Fault { name: "step missing", expected: &[Kind::Removed], plant: step_missing },
        Fault {
            name: "segment missing",
            expected: &[Kind::Steps, Kind::Start, Kind::Continuity, Kind::Gripper],
            plant: segment_missing,
        },
        Fault { name: "segments out of order", expected: &[Kind::Steps], plant: segments_out_of_order },
        Fault { name: "unknown object", expected: &[Kind::Steps], plant: unknown_object },
        Fault { name: "target not last", expected: &[Kind::Steps], plant: target_not_last },
        Fault { name: "removed is not what was", expected: &[Kind::Removed], plant: removed_differs },
        Fault { name: "unknown joint", expected: &[Kind::Joints], plant: unknown_joint },
        Fault { name: "gripper changes in transit", expected: &[Kind::Gripper], plant: gripper_in_transit },
        Fault { name: "gripper beyond its limits", expected: &[Kind::Gripper], plant: gripper_beyond_limits },
        Fault { name: "unchecked pair that may touch", expected: &[Kind::UncheckedPair], plant: unchecked_pair },
        Fault { name: "limits above the URDF's", expected: &[Kind::DeclaredLimit], plant: limits_above_urdf },
        Fault { name: "bound above what was removed", expected: &[Kind::LowerBound], plant: bound_too_high },
        Fault { name: "not solved", expected: &[Kind::NotSolved], plant: not_solved },
    ]
};

fn waypoint_dropped(plan: &mut PlanFile, _: &Robot, random: &mut Random) -> Option<()> {
    let (i, j) = segment_of(plan, random, 5, moves)?;
    let segment = &mut plan.steps[i].segments[j];
    let row = random.random_range(1..segment.times.len() - 1);
    // As many rows as leave a gap.
    while row < segment.times.len() - 1 && segment.times[row] - segment.times[row - 1] <= 0.0201 {
        segment.times.remove(row);
        segment.positions.remove(row);
        for value in segment.gripper.values_mut() {
            if let GripperValue::Rows(values) = value {
                values.remove(row);
            }
        }
    }
    (segment.times[row] - segment.times[row - 1] > 0.0201).then_some(())
}

fn rows_too_far_apart(plan: &mut PlanFile, _: &Robot, random: &mut Random) -> Option<()> {
    let (i, j) = segment_of(plan, random, 3, |_| true)?;
    let times = &mut plan.steps[i].segments[j].times;
    let row = random.random_range(1..times.len());
    let later = 0.02 - (times[row] - times[row - 1]) + random.random_range(1e-6..0.5);
    times[row..].iter_mut().for_each(|t| *t += later);
    Some(())
}

fn times_not_rising(plan: &mut PlanFile, _: &Robot, random: &mut Random) -> Option<()> {
    let (i, j) = segment_of(plan, random, 3, |_| true)?;
    let times = &mut plan.steps[i].segments[j].times;
    let row = random.random_range(1..times.len());
    times[row] = times[row - 1] - if random.random_bool(0.5) { 0.0 } else { random.random_range(0.0..0.01) };
    Some(())
}

fn times_not_from_zero(plan: &mut PlanFile, _: &Robot, random: &mut Random) -> Option<()> {
    let (i, j) = segment_of(plan, random, 1, |_| true)?;
    let later = either_sign(random, 1e-6, 1.0);
    plan.steps[i].segments[j].times.iter_mut().for_each(|t| *t += later);
    Some(())
}

fn bad_row(plan: &mut PlanFile, _: &Robot, random: &mut Random) -> Option<()> {
    let (i, j) = segment_of(plan, random, 2, |_| true)?;
    let segment = &mut plan.steps[i].segments[j];
    let row = random.random_range(0..segment.positions.len());
    match random.random_range(0..5) {
        0 => segment.positions[row].push(0.0),
        1 => drop(segment.positions[row].pop()),
        2 => segment.positions[row][0] = f64::NAN,
        3 => segment.times[row] = f64::INFINITY,
        _ => drop(segment.positions.pop()),
    }
    Some(())
}

fn other_start(plan: &mut PlanFile, _: &Robot, random: &mut Random) -> Option<()> {
    let joint = pick(&plan.robot.joints, random)?;
    let away = either_sign(random, 1e-5, 0.5);
    let start = plan.scene.robot.start.get_or_insert_with(|| plan.robot.home.clone());
    *start.entry(joint).or_insert(0.0) += away;
    Some(())
}

fn segments_do_not_join(plan: &mut PlanFile, _: &Robot, random: &mut Random) -> Option<()> {
    let (i, j) = segment_of(plan, random, 1, |_| true)?;
    if (i, j) == (0, 0) {
        return None;
    }
    let column = random.random_range(0..plan.robot.joints.len());
    let away = either_sign(random, 1e-5, 0.2);
    plan.steps[i].segments[j].positions[0][column] += away;
    Some(())
}

fn step_missing(plan: &mut PlanFile, _: &Robot, random: &mut Random) -> Option<()> {
    let step = random.random_range(0..plan.steps.len());
    let object = plan.steps.remove(step).object;
    (!plan.steps.is_empty() && plan.steps.iter().all(|s| s.object != object)).then_some(())
}

fn segment_missing(plan: &mut PlanFile, _: &Robot, random: &mut Random) -> Option<()> {
    let (i, j) =
        segment_of(plan, random, 2, |s| moves(s) || matches!(s.kind, SegmentKind::Grasp | SegmentKind::Release))?;
    let last = i + 1 == plan.steps.len() && j + 1 == plan.steps[i].segments.len();
    plan.steps[i].segments.remove(j);
    // Without its last motion home a plan is still whole.
    (!last).then_some(())
}

fn segments_out_of_order(plan: &mut PlanFile, _: &Robot, random: &mut Random) -> Option<()> {
    let (i, j) = segment_of(plan, random, 1, |s| matches!(s.kind, SegmentKind::Grasp | SegmentKind::Release))?;
    let other = [SegmentKind::Push, SegmentKind::Approach, SegmentKind::Retreat, SegmentKind::Transit];
    plan.steps[i].segments[j].kind = pick(&other, random)?;
    Some(())
}

fn unknown_object(plan: &mut PlanFile, _: &Robot, random: &mut Random) -> Option<()> {
    let step = random.random_range(0..plan.steps.len());
    plan.steps[step].object = "no_such_object".into();
    Some(())
}

fn target_not_last(plan: &mut PlanFile, _: &Robot, random: &mut Random) -> Option<()> {
    let others: Vec<String> =
        plan.scene.objects.iter().map(|o| o.id.clone()).filter(|id| *id != plan.scene.target).collect();
    plan.scene.target = pick(&others, random)?;
    Some(())
}

fn removed_differs(plan: &mut PlanFile, _: &Robot, random: &mut Random) -> Option<()> {
    match random.random_range(0..3) {
        0 => drop(plan.removed.pop()),
        1 => plan.removed.push("no_such_object".into()),
        _ if plan.removed.len() > 1 => plan.removed.swap(0, 1),
        _ => return None,
    }
    Some(())
}

fn unknown_joint(plan: &mut PlanFile, _: &Robot, random: &mut Random) -> Option<()> {
    match random.random_range(0..4) {
        0 => *plan.robot.joints.last_mut()? = "no_such_joint".into(),
        1 => plan.robot.tool = "no_such_link".into(),
        2 => plan.robot.hand.links.push("no_such_link".into()),
        _ => {
            let (i, j) = segment_of(plan, random, 1, |_| true)?;
            plan.steps[i].segments[j].gripper.insert("no_such_joint".into(), GripperValue::Held(0.0));
        }
    }
    Some(())
}

fn gripper_in_transit(plan: &mut PlanFile, _: &Robot, random: &mut Random) -> Option<()> {
    let (i, j) = segment_of(plan, random, 3, |s| moves(s) && !s.gripper.is_empty())?;
    let segment = &mut plan.steps[i].segments[j];
    let rows = segment.times.len();
    let name = segment.gripper.keys().next()?.clone();
    let value = segment.gripper.get_mut(&name)?;
    let mut values = match value {
        GripperValue::Held(v) => vec![*v; rows],
        GripperValue::Rows(v) => v.clone(),
    };
    values[random.random_range(1..rows)] += either_sign(random, 1e-5, 0.01);
    *value = GripperValue::Rows(values);
    Some(())
}

fn gripper_beyond_limits(plan: &mut PlanFile, robot: &Robot, random: &mut Random) -> Option<()> {
    let name = plan.robot.hand.joint.clone()?;
    let limits = robot.chain.find(&name)?.joint().limits?;
    let (i, j) = segment_of(plan, random, 2, |s| s.gripper.contains_key(&name))?;
    let beyond = limits.max + random.random_range(1e-4..0.1);
    plan.steps[i].segments[j].gripper.insert(name, GripperValue::Held(beyond));
    Some(())
}

/// The root's own link against one at least three moving joints away that is not of the hand; for a
/// robot like an arm these do not touch in most postures.
fn unchecked_pair(plan: &mut PlanFile, robot: &Robot, random: &mut Random) -> Option<()> {
    let links: Vec<String> = robot.shapes().into_iter().map(|s| s.link).collect();
    let near: Vec<String> = links.iter().filter(|l| robot.moving_above(l).len() <= 1).cloned().collect();
    let far: Vec<String> = links.iter().filter(|l| robot.moving_above(l).len() >= 4).cloned().collect();
    let pair = [pick(&near, random)?, pick(&far, random)?];
    let known = plan.robot.unchecked_pairs.iter().any(|p| p.iter().all(|l| pair.contains(l)));
    plan.robot.unchecked_pairs.push(pair);
    (!known).then_some(())
}

fn limits_above_urdf(plan: &mut PlanFile, _: &Robot, random: &mut Random) -> Option<()> {
    let joint = pick(&plan.robot.joints, random)?;
    match random.random_range(0..4) {
        0 => *plan.robot.limits.velocity.get_mut(&joint)? *= 100.0,
        1 => drop(plan.robot.limits.velocity.remove(&joint)),
        2 => drop(plan.robot.limits.jerk.as_mut()?.remove(&joint)),
        _ => drop(plan.robot.limits.acceleration.remove(&joint)),
    }
    Some(())
}

fn bound_too_high(plan: &mut PlanFile, _: &Robot, random: &mut Random) -> Option<()> {
    let removed = plan.removed.len() + random.random_range(1..4);
    plan.lower_bound =
        Some(LowerBound { removed, kind: "geometric".into(), proof: serde_json::json!({"barriers": []}) });
    Some(())
}

fn not_solved(plan: &mut PlanFile, _: &Robot, random: &mut Random) -> Option<()> {
    match random.random_range(0..3) {
        0 => plan.status = Status::OutOfBudget,
        1 => plan.status = Status::Impossible,
        _ => plan.steps.clear(),
    }
    Some(())
}
