//! Faults of motion: limits of position, velocity, acceleration and jerk.

use super::robot::Robot;
use super::{Fault, Random, either_sign, moves, segment_of};
use clearway_plan::PlanFile;
use clearway_plan::plan_file::Segment;
use clearway_verify::ViolationKind as Kind;
use rand::RngExt;

pub const FAULTS: fn() -> Vec<Fault> = || {
    vec![
        Fault { name: "velocity limit exceeded", expected: &[Kind::VelocityLimit], plant: too_fast },
        Fault { name: "acceleration limit exceeded", expected: &[Kind::AccelerationLimit], plant: too_sudden },
        Fault { name: "jerk limit exceeded", expected: &[Kind::JerkLimit], plant: too_jerky },
        Fault { name: "jerk limit exceeded by a start", expected: &[Kind::JerkLimit], plant: starts_moving },
        Fault { name: "a row out of line", expected: &[Kind::AccelerationLimit], plant: row_out_of_line },
        Fault {
            name: "waypoint dropped, times closed up",
            expected: &[Kind::VelocityLimit, Kind::AccelerationLimit],
            plant: closed_up,
        },
        Fault { name: "position limit exceeded", expected: &[Kind::PositionLimit], plant: too_far },
    ]
};

/// By interval and joint: velocity.
fn velocities(segment: &Segment) -> Vec<Vec<f64>> {
    let interval = |i: usize| {
        let seconds = segment.times[i] - segment.times[i - 1];
        segment.positions[i].iter().zip(&segment.positions[i - 1]).map(|(b, a)| (b - a) / seconds).collect()
    };
    (1..segment.times.len()).map(interval).collect()
}

/// The largest share of the velocity limits used, and of the acceleration limits (within the segment).
fn shares(plan: &PlanFile, segment: &Segment) -> (f64, f64) {
    let limit = |map: &std::collections::BTreeMap<String, f64>, column: usize| map[&plan.robot.joints[column]];
    let v = velocities(segment);
    let (mut fast, mut sudden): (f64, f64) = (0.0, 0.0);
    for (i, row) in v.iter().enumerate() {
        for (column, velocity) in row.iter().enumerate() {
            fast = fast.max(velocity.abs() / limit(&plan.robot.limits.velocity, column));
            if i > 0 {
                let seconds = 0.5 * (segment.times[i + 1] - segment.times[i - 1]);
                sudden = sudden.max(
                    (velocity - v[i - 1][column]).abs() / seconds / limit(&plan.robot.limits.acceleration, column),
                );
            }
        }
    }
    (fast, sudden)
}

/// The same path in less time, so that the fastest joint is 2 % to twice over its limit.
fn too_fast(plan: &mut PlanFile, _: &Robot, random: &mut Random) -> Option<()> {
    let (i, j) = segment_of(plan, random, 3, moves)?;
    let (fast, _) = shares(plan, &plan.steps[i].segments[j]);
    let factor = random.random_range(1.02..2.0) / fast;
    plan.steps[i].segments[j].times.iter_mut().for_each(|t| *t /= factor);
    (factor > 1.0).then_some(())
}

fn too_sudden(plan: &mut PlanFile, _: &Robot, random: &mut Random) -> Option<()> {
    let (i, j) = segment_of(plan, random, 4, moves)?;
    let (_, sudden) = shares(plan, &plan.steps[i].segments[j]);
    let factor = (random.random_range(1.02..2.0) / sudden).sqrt();
    plan.steps[i].segments[j].times.iter_mut().for_each(|t| *t /= factor);
    (factor > 1.0).then_some(())
}

/// A limit that one joint's motion is 2 % to twice over.
fn too_jerky(plan: &mut PlanFile, _: &Robot, random: &mut Random) -> Option<()> {
    let (i, j) = segment_of(plan, random, 5, moves)?;
    let column = random.random_range(0..plan.robot.joints.len());
    let segment = &plan.steps[i].segments[j];
    // Third differences of even rows.
    let seconds = segment.times[1];
    let third = |w: &[Vec<f64>]| (w[3][column] - 3.0 * (w[2][column] - w[1][column]) - w[0][column]) / seconds.powi(3);
    let most = segment.positions.windows(4).map(|w| third(w).abs()).fold(0.0, f64::max);
    let name = plan.robot.joints[column].clone();
    plan.robot.limits.jerk.as_mut()?.insert(name, most / random.random_range(1.02..2.0));
    (most > 10.0).then_some(())
}

/// The first motion from its middle on: the robot starts with a jolt.
fn starts_moving(plan: &mut PlanFile, _: &Robot, random: &mut Random) -> Option<()> {
    let column = random.random_range(0..plan.robot.joints.len());
    let segment = plan.steps.first_mut()?.segments.first_mut()?;
    let middle = segment.times.len() / 2;
    let speed = segment.positions[middle + 1][column] - segment.positions[middle][column];
    let start = segment.times[middle];
    segment.positions.drain(..middle);
    segment.times.drain(..middle);
    segment.times.iter_mut().for_each(|t| *t -= start);
    (speed.abs() > 1e-3).then_some(())
}

/// One joint in one row out of line by what its acceleration limit allows in a row's time, or more.
fn row_out_of_line(plan: &mut PlanFile, _: &Robot, random: &mut Random) -> Option<()> {
    let (i, j) = segment_of(plan, random, 5, moves)?;
    let column = random.random_range(0..plan.robot.joints.len());
    let limit = plan.robot.limits.acceleration[&plan.robot.joints[column]];
    let segment = &mut plan.steps[i].segments[j];
    let row = random.random_range(2..segment.times.len() - 2);
    let seconds = segment.times[row + 1] - segment.times[row - 1];
    segment.positions[row][column] += either_sign(random, 1.05, 5.0) * limit * seconds * seconds / 4.0;
    Some(())
}

/// One row less, and no time for it: somewhere the robot goes at twice its speed.
fn closed_up(plan: &mut PlanFile, _: &Robot, random: &mut Random) -> Option<()> {
    let (i, j) = segment_of(plan, random, 6, moves)?;
    let v = velocities(&plan.steps[i].segments[j]);
    let segment = &plan.steps[i].segments[j];
    let fitting: Vec<usize> = (2..segment.times.len() - 2)
        .filter(|&row| {
            let seconds = segment.times[row + 1] - segment.times[row];
            v[row].iter().enumerate().any(|(column, velocity)| {
                velocity.abs() > 3.0 * plan.robot.limits.acceleration[&plan.robot.joints[column]] * seconds
            })
        })
        .collect();
    let row = super::pick(&fitting, random)?;
    let segment = &mut plan.steps[i].segments[j];
    let seconds = segment.times[row] - segment.times[row - 1];
    segment.positions.remove(row);
    segment.times.remove(row);
    segment.times[row..].iter_mut().for_each(|t| *t -= seconds);
    for value in segment.gripper.values_mut() {
        if let clearway_plan::plan_file::GripperValue::Rows(values) = value {
            values.remove(row);
        }
    }
    Some(())
}

fn too_far(plan: &mut PlanFile, robot: &Robot, random: &mut Random) -> Option<()> {
    let (i, j) = segment_of(plan, random, 3, |_| true)?;
    let column = random.random_range(0..plan.robot.joints.len());
    let limits = robot.chain.find(&plan.robot.joints[column])?.joint().limits?;
    let segment = &mut plan.steps[i].segments[j];
    let row = random.random_range(0..segment.times.len());
    let beyond = random.random_range(1e-4..1.0);
    segment.positions[row][column] = if random.random_bool(0.5) { limits.max + beyond } else { limits.min - beyond };
    // Continuous joints come with limits that are no limits.
    (limits.max - limits.min < 50.0 && limits.max > limits.min).then_some(())
}
