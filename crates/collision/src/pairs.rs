//! Which pairs of links are checked against each other.
//!
//! Not checked are: links joined by a joint (across links without shape, too), links of the hand
//! among themselves, links that do not move against each other, and pairs whose exact shapes touch in
//! nearly every posture. The plan file
//! may leave out pairs that touch in at least 70 % of postures drawn uniformly; the mark here is
//! higher, so that another draw does not fall on the other side.

use clearway_geometry::{Pose, distance::closer_than};
use clearway_robot::group::{adjacent, spread};
use clearway_robot::{Kinematics, Robot};
use std::f64::consts::PI;

const SAMPLES: usize = 200;
const ALWAYS: f64 = 0.85;

/// Checked pairs by index, and the unchecked ones by name.
pub fn checked_pairs(robot: &Robot, kinematics: &Kinematics) -> (Vec<(usize, usize)>, Vec<[String; 2]>) {
    let shaped: Vec<usize> = (0..robot.links.len()).filter(|&i| !robot.links[i].collision.parts.is_empty()).collect();
    let mut candidates = Vec::new();
    let mut unchecked = Vec::new();
    for (n, &a) in shaped.iter().enumerate() {
        for &b in &shaped[n + 1..] {
            let hand = robot.hand.links.contains(&a) && robot.hand.links.contains(&b);
            if hand || adjacent(&robot.links, &robot.joints, a, b) {
                unchecked.push((a, b));
            } else {
                candidates.push((a, b));
            }
        }
    }
    let mut touching = vec![0usize; candidates.len()];
    let mut frames: Vec<Pose> = Vec::new();
    let open = robot.hand.open();
    for s in 0..SAMPLES {
        let range = |j: usize| (robot.lower[j].max(-PI), robot.upper[j].min(PI));
        let posture = spread(s, (0..kinematics.arm_joints).map(range));
        kinematics.frames(&posture, open, &mut frames);
        for (count, &(a, b)) in touching.iter_mut().zip(&candidates) {
            *count += usize::from(overlap(robot, &frames, a, b));
        }
    }
    // Links that do not move against each other keep their distance, however small.
    let moves = |&(a, b): &(usize, usize)| {
        kinematics.moved_by[a] != kinematics.moved_by[b] || kinematics.moved_by_hand[a] != kinematics.moved_by_hand[b]
    };
    let mut checked = Vec::new();
    for (pair, count) in candidates.into_iter().zip(touching) {
        if count as f64 >= ALWAYS * SAMPLES as f64 {
            unchecked.push(pair);
        } else if moves(&pair) {
            checked.push(pair);
        }
    }
    unchecked.sort_unstable();
    let name = |i: usize| robot.links[i].name.clone();
    (checked, unchecked.into_iter().map(|(a, b)| [name(a), name(b)]).collect())
}

/// The unchecked pairs alone, for reports.
pub fn unchecked_pairs(robot: &Robot) -> Vec<[String; 2]> {
    checked_pairs(robot, &Kinematics::new(robot)).1
}

fn overlap(robot: &Robot, frames: &[Pose], a: usize, b: usize) -> bool {
    robot.links[a].collision.parts.iter().any(|(pa, ca)| {
        robot.links[b]
            .collision
            .parts
            .iter()
            .any(|(pb, cb)| closer_than(ca, &(frames[a] * *pa), cb, &(frames[b] * *pb), 1e-6))
    })
}
