//! `unchecked_pairs`: links that are adjacent (see [`Model::adjacent`]), both of the hand, or touch
//! in at least 70 % of postures drawn uniformly.
//!
//! 400 postures with a fixed seed; joints of rows and gripper within their limits (a continuous
//! joint within ±π), the fixed ones where they are. A sample this large is off by up to 7 % (three
//! standard deviations), so a pair is refused below 63 %. Touching is overlap, however small.

use crate::case::Case;
use crate::error::CannotJudge;
use crate::model::Model;
use crate::names::Names;
use crate::report::{Report, ViolationKind};
use crate::shapes::body_gap;
use clearway_plan::{Budget, PlanFile};
use parry3d_f64::math::Pose;
use rand::{RngExt, SeedableRng};
use rand_xoshiro::Xoshiro256PlusPlus;
use std::f64::consts::PI;

const POSTURES: usize = 400;
const NEEDED: f64 = 0.7;
/// Three standard deviations of a sample's share at 70 %.
const UNCERTAIN: f64 = 0.069;

pub(crate) fn check(
    plan: &PlanFile,
    case: &Case,
    names: &Names,
    budget: &Budget,
    report: &mut Report,
) -> Result<(), CannotJudge> {
    let hand = of_hand(plan, &case.model, names);
    let doubtful: Vec<(usize, usize)> = names
        .unchecked
        .iter()
        .copied()
        .filter(|&(a, b)| a != b && !(hand[a] && hand[b]) && !case.model.adjacent(a, b))
        .filter(|&(a, b)| !case.model.links[a].pieces.is_empty() && !case.model.links[b].pieces.is_empty())
        .collect();
    report.checked.unchecked_pairs = names.unchecked.len();
    if doubtful.is_empty() {
        return Ok(());
    }
    let mut touching = vec![0usize; doubtful.len()];
    let mut random = Xoshiro256PlusPlus::seed_from_u64(0x7061_6972);
    let mut poses: Vec<Pose> = Vec::new();
    let mut posture = names.fixed.clone();
    for _ in 0..POSTURES {
        budget.check()?;
        for &joint in names.columns.iter().chain(&names.gripper) {
            let (low, high) = case.model.joints[joint].range.unwrap_or((-PI, PI));
            posture[joint] = low + (high - low) * random.random::<f64>();
        }
        case.model.follow(&mut posture);
        case.model.link_poses(&case.world_from_root, &posture, &mut poses);
        for (count, &(a, b)) in touching.iter_mut().zip(&doubtful) {
            let (first, second) = (&case.model.links[a].pieces, &case.model.links[b].pieces);
            if body_gap(first, &poses[a], second, &poses[b], 0.0).is_some_and(|g| g.distance <= 0.0) {
                *count += 1;
            }
        }
    }
    for (&count, &(a, b)) in touching.iter().zip(&doubtful) {
        let share = count as f64 / POSTURES as f64;
        if share < NEEDED - UNCERTAIN {
            let (a, b) = (&case.model.links[a].name, &case.model.links[b].name);
            let what = format!(
                "{a} and {b} go unchecked, but are not adjacent, not both of the hand, and touch in only {:.0} % of postures",
                share * 100.0
            );
            report.plan(ViolationKind::UncheckedPair, what);
        }
    }
    Ok(())
}

/// By link: in `hand.links`, below such a link, or moved by the hand's joint.
fn of_hand(plan: &PlanFile, model: &Model, names: &Names) -> Vec<bool> {
    let leader = plan.robot.hand.joint.as_ref().and_then(|name| model.joint(name));
    let moved_by_hand =
        |joint: usize| Some(joint) == leader || model.joints[joint].mimic.is_some_and(|m| Some(m.joint) == leader);
    let mut hand = names.in_hand.clone();
    // Parents come first.
    for link in 0..model.links.len() {
        if let Some(joint) = model.links[link].joint {
            hand[link] |= hand[model.joints[joint].parent] || moved_by_hand(joint);
        }
    }
    hand
}
