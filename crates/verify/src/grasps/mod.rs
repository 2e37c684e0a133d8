//! Lower bounds of the kind `grasps` ([`GraspsProof`]), judged without trusting the planner.
//!
//! The declared grasps are made anew from the robot file's keys, the branches of the inverse kinematics
//! from the model, the straight stretch is walked again, every object named as blocking is measured
//! with exact shapes, and the fewest removals are searched for. What the proof says need not
//! be all that blocks; less makes the bound smaller.

mod branches;
mod declared;
mod fewest;

use crate::barriers;
use crate::case::Case;
use crate::error::CannotJudge;
use crate::lower_bound::Verdict;
use crate::names::Names;
use crate::shapes::{Piece, body_gap};
use branches::{Arm, turn_between};
use clearway_plan::plan_file::LowerBound;
use clearway_plan::proof::{Branch, GraspCase, GraspsProof, ObjectCase};
use clearway_plan::{Budget, PlanFile};
use fewest::fewest;
use parry3d_f64::math::{Pose, Vector};
use std::collections::BTreeSet;

/// Between the postures looked at on the stretch, metres; no joint turns farther from one to the next.
const STEP: f64 = 0.02;
const REACH: f64 = 0.6;
/// Poses and postures are the same up to this: numbers in proofs are rounded.
const SAME: f64 = 1e-5;
/// How well distances are measured, metres.
const EXACT: f64 = 2e-5;
/// A closed hand that stays this far off does not hold, metres.
const LOOSE: f64 = 5e-4;
/// Plans keep no more room than this, metres, besides what the scene asks for, and raise things by no more;
/// the robot keeps this from itself.
const MOST_CLEARANCE: f64 = 1e-3;
const MOST_LIFT: f64 = 0.02;
const SELF_CLEARANCE: f64 = 2e-3;

/// Whether the proof, whose kind is this, holds.
pub(crate) fn verdict(
    plan: &PlanFile,
    case: &Case,
    names: &Names,
    bound: &LowerBound,
    budget: &Budget,
) -> Result<Verdict, CannotJudge> {
    match Judge::new(plan, case, names, bound) {
        Ok(judge) => judge.verdict(bound.removed, budget),
        Err(verdict) => Ok(verdict),
    }
}

struct Judge<'a> {
    plan: &'a PlanFile,
    case: &'a Case,
    names: &'a Names,
    proof: GraspsProof,
    arm: Arm<'a>,
    /// The hand's joint, and its values wide open and closed.
    hand: usize,
    closed: f64,
    flips: bool,
}

impl<'a> Judge<'a> {
    fn new(plan: &'a PlanFile, case: &'a Case, names: &'a Names, bound: &LowerBound) -> Result<Self, Verdict> {
        let no = |what: &str| Verdict::False(format!("the proof of the lower bound: {what}"));
        let unknown = |what: &str| Verdict::Unknown(format!("the lower bound's proof: {what}"));
        let proof: GraspsProof =
            serde_json::from_value(bound.proof.clone()).map_err(|e| no(&format!("cannot be read ({e})")))?;
        let Some(grasps) = &plan.robot.grasps else {
            return Err(unknown("the file does not say which grasps are declared (robot.grasps)"));
        };
        let hand = &plan.robot.hand;
        let values: Option<Vec<(f64, f64)>> =
            hand.opening.iter().map(|(v, gap)| Some((v.parse().ok()?, *gap))).collect();
        let (Some(joint), Some(values)) = (hand.joint.as_ref().and_then(|j| case.model.joint(j)), values) else {
            return Err(unknown("only for parallel hands is it known how to judge it"));
        };
        let by_gap = |a: &&(f64, f64), b: &&(f64, f64)| a.1.total_cmp(&b.1);
        let (Some(open), Some(closed)) = (values.iter().max_by(by_gap), values.iter().min_by(by_gap)) else {
            return Err(unknown("the hand has no opening"));
        };
        if (proof.hand - open.0).abs() > 1e-9 || (proof.standoff - grasps.standoff).abs() > 1e-9 {
            return Err(no("the hand is not wide open, or the standoff is not the declared one"));
        }
        let small = |v: f64, most: f64| (0.0..=most).contains(&v);
        let most = MOST_CLEARANCE + plan.scene.clearance.unwrap_or(0.0);
        if !small(proof.clearance, most) || !small(proof.held_clearance, most) || !small(proof.lift, MOST_LIFT) {
            return Err(no("its clearances or its lift are more than plans keep to"));
        }
        let mut rest = names.fixed.clone();
        rest[joint] = open.0;
        case.model.follow(&mut rest);
        let tool = case.model.link(&plan.robot.tool).unwrap_or_default();
        let Some(arm) = Arm::new(case, &names.columns, tool, rest) else {
            return Err(unknown("only for six joints with three parallel axes are all branches known"));
        };
        let turns = names.columns.last().and_then(|&c| case.model.joints[c].range);
        let flips = turns.is_some_and(|(low, high)| high - low < std::f64::consts::TAU);
        Ok(Self { plan, case, names, proof, arm, hand: joint, closed: closed.0, flips })
    }
}

impl Judge<'_> {
    fn verdict(&self, removed: usize, budget: &Budget) -> Result<Verdict, CannotJudge> {
        let mut ways: Vec<Option<Vec<BTreeSet<usize>>>> = vec![None; self.case.objects.len()];
        for listed in &self.proof.objects {
            let Some(object) = self.case.object(&listed.object) else {
                return Ok(Verdict::False(format!(
                    "the lower bound's proof names {:?}, which is no object",
                    listed.object
                )));
            };
            match self.object(object, listed, budget)? {
                Ok(sets) => ways[object] = Some(sets),
                Err(why) => {
                    return Ok(Verdict::False(format!("the lower bound's proof, object {}: {why}", listed.object)));
                }
            }
        }
        let Some(target) = self.case.object(&self.plan.scene.target) else {
            return Ok(Verdict::Unknown("the lower bound: the target is no object".to_owned()));
        };
        let barriers = match self.proof.barriers.as_ref().map(|b| barriers::sets(self.case, target, b)).transpose() {
            Ok(sets) => sets.unwrap_or_default(),
            Err(why) => return Ok(Verdict::False(format!("the lower bound's proof: {why}"))),
        };
        Ok(match fewest(&ways, &barriers, target, removed, budget)? {
            Some(count) if count < removed => Verdict::False(format!(
                "lower_bound.removed is {removed}, but its proof leaves open that {count} are enough"
            )),
            Some(_) => Verdict::Proved,
            None => Verdict::Unknown("the lower bound: too many sets to search".to_owned()),
        })
    }

    /// The sets that the listed branches of an object leave, or what is wrong with the list.
    fn object(
        &self,
        object: usize,
        listed: &ObjectCase,
        budget: &Budget,
    ) -> Result<Result<Vec<BTreeSet<usize>>, String>, CannotJudge> {
        let thing = &self.case.objects[object];
        let declared =
            self.plan.robot.grasps.as_ref().and_then(|g| declared::declared(g, &thing.pieces, &thing.pose, self.flips));
        let Some(declared) = declared else { return Ok(Err("the declared grasps are no poses".to_owned())) };
        if declared.len() != listed.grasps.len() {
            return Ok(Err(format!("{} grasps are listed, {} declared", listed.grasps.len(), declared.len())));
        }
        let mut sets = Vec::new();
        for (index, (grasp, object_from_tool)) in listed.grasps.iter().zip(&declared).enumerate() {
            budget.check()?;
            match self.grasp(object, object_from_tool, grasp) {
                Ok(more) => sets.extend(more),
                Err(why) => return Ok(Err(format!("grasp {index}: {why}"))),
            }
        }
        Ok(Ok(sets))
    }

    fn grasp(
        &self,
        object: usize,
        object_from_tool: &Pose,
        listed: &GraspCase,
    ) -> Result<Vec<BTreeSet<usize>>, String> {
        let thing = &self.case.objects[object];
        let [x, y, z, w] = listed.quaternion;
        let told = crate::shapes::pose_from(listed.position, None, Some([x, y, z, w])).ok_or("its pose is none")?;
        if (told.translation - object_from_tool.translation).length() > SAME
            || turn_between(&told, object_from_tool) > SAME
        {
            return Err("it is not the declared one".to_owned());
        }
        let world_from_tool = thing.pose * *object_from_tool;
        if !listed.holds {
            return if self.may_hold(object, &world_from_tool) {
                Err("the hand may hold the object there".to_owned())
            } else {
                Ok(Vec::new())
            };
        }
        let home = vec![0.0; self.names.columns.len()];
        for posture in self.arm.postures(&world_from_tool, &home) {
            let same = |b: &&Branch| {
                let off = |(a, b): (&f64, &f64)| ((a - b) / std::f64::consts::TAU).fract().abs();
                b.posture.len() == posture.len()
                    && posture.iter().zip(&b.posture).map(off).all(|turn| turn.min(1.0 - turn) < 1e-4)
            };
            if !listed.branches.iter().any(|b| same(&b)) {
                return Err(format!("a posture is missing: {posture:.4?}"));
            }
        }
        let mut sets = Vec::new();
        for branch in &listed.branches {
            if branch.posture.len() != home.len() || !branch.posture.iter().all(|v| v.is_finite()) {
                return Err("a posture has not one number per joint".to_owned());
            }
            sets.extend(self.branch(object, object_from_tool, branch)?);
        }
        Ok(sets)
    }

    /// The set of a branch; `None` when it is rightly said to be no way at all.
    fn branch(
        &self,
        object: usize,
        object_from_tool: &Pose,
        branch: &Branch,
    ) -> Result<Option<BTreeSet<usize>>, String> {
        let thing = &self.case.objects[object];
        let grasp = thing.pose * *object_from_tool;
        let at = self.arm.tool(&branch.posture);
        if (at.translation - grasp.translation).length() > SAME || turn_between(&at, &grasp) > SAME {
            return Err(format!("the posture {:?} is elsewhere", branch.posture));
        }
        let tool_from_object = object_from_tool.inverse();
        let mut stretch = Stretch { judge: self, grasp, last: branch.posture.clone(), step: 0 };
        let mut blocked: BTreeSet<usize> = BTreeSet::new();
        let mut missing: BTreeSet<usize> = BTreeSet::new();
        for name in branch.blocked_by.iter().flatten() {
            missing
                .insert(self.case.object(name).filter(|o| *o != object).ok_or(format!("{name:?} is no other object"))?);
        }
        let mut on_line = false;
        loop {
            let links = self.case.link_poses(&self.arm.whole(&stretch.last));
            let held = self.arm.tool(&stretch.last) * tool_from_object;
            match &branch.blocked_by {
                Some(_) => {
                    missing.retain(|&other| {
                        let near = self.near_object(&links, &held, object, other);
                        if near {
                            blocked.insert(other);
                        }
                        !near
                    });
                    if missing.is_empty() {
                        return Ok(Some(blocked));
                    }
                }
                None if self.near_fixed(&links, &held, object, on_line) => return Ok(None),
                None => {}
            }
            on_line = true;
            match stretch.next() {
                Some(true) => {}
                Some(false) => break,
                None if branch.blocked_by.is_none() => return Ok(None),
                None => break,
            }
        }
        Err(match missing.first() {
            Some(&object) => format!("{} is not in the way of {:?}", self.case.objects[object].id, branch.posture),
            None => format!("nothing is in the way of {:?} for good", branch.posture),
        })
    }

    /// Whether the open hand goes round the object and the closed one reaches it.
    fn may_hold(&self, object: usize, world_from_tool: &Pose) -> bool {
        let thing = &self.case.objects[object];
        let zero = vec![0.0; self.names.columns.len()];
        let nearest = |value: Option<f64>| {
            let mut whole = self.arm.whole(&zero);
            if let Some(value) = value {
                whole[self.hand] = value;
                self.case.model.follow(&mut whole);
            }
            let poses = self.case.link_poses(&whole);
            let tool = self.arm.tool(&zero).inverse();
            let gap = |(link, pose): (usize, &Pose)| {
                let placed = *world_from_tool * tool * *pose;
                body_gap(&self.case.model.links[link].pieces, &placed, &thing.pieces, &thing.pose, 0.01)
                    .map(|g| g.distance)
            };
            let hand = poses.iter().enumerate().filter(|(link, _)| self.names.in_hand[*link]);
            hand.filter_map(gap).fold(f64::INFINITY, f64::min)
        };
        nearest(None) > EXACT && nearest(Some(self.closed)) < LOOSE - EXACT
    }

    fn near(&self, a: &[Piece], at_a: &Pose, b: &[Piece], at_b: &Pose, clearance: f64) -> bool {
        body_gap(a, at_a, b, at_b, clearance).is_some_and(|g| g.distance < clearance)
    }

    /// Whether the robot or what it holds is too near to an object where that stands.
    fn near_object(&self, links: &[Pose], held: &Pose, object: usize, other: usize) -> bool {
        let (thing, other) = (&self.case.objects[object], &self.case.objects[other]);
        self.near(&thing.pieces, held, &other.pieces, &other.pose, self.proof.held_clearance)
            || self
                .case
                .model
                .links
                .iter()
                .zip(links)
                .any(|(link, at)| self.near(&link.pieces, at, &other.pieces, &other.pose, self.proof.clearance))
    }

    /// Whether the robot or what it holds is too near to a fixture or to the robot itself.
    fn near_fixed(&self, links: &[Pose], held: &Pose, object: usize, lifted: bool) -> bool {
        let model = &self.case.model;
        let thing = &self.case.objects[object];
        let fixture = self.case.fixtures.iter().any(|f| {
            lifted && self.near(&thing.pieces, held, &f.pieces, &f.pose, self.proof.held_clearance)
                || links.iter().enumerate().any(|(l, at)| {
                    !model.mounted(l) && self.near(&model.links[l].pieces, at, &f.pieces, &f.pose, self.proof.clearance)
                })
        });
        let pair = |a: usize| {
            (a + 1..links.len()).any(|b| {
                !self.names.unchecked.contains(&(a, b))
                    && self.near(
                        &model.links[a].pieces,
                        &links[a],
                        &model.links[b].pieces,
                        &links[b],
                        SELF_CLEARANCE + EXACT,
                    )
            })
        };
        let met = |l: usize| {
            !self.names.in_hand[l]
                && self.near(&model.links[l].pieces, &links[l], &thing.pieces, held, self.proof.held_clearance)
        };
        fixture || (0..links.len()).any(|l| pair(l) || met(l))
    }
}

/// The postures along the straight line, one after the other.
struct Stretch<'a, 'j> {
    judge: &'j Judge<'a>,
    grasp: Pose,
    last: Vec<f64>,
    step: usize,
}

impl Stretch<'_, '_> {
    /// Goes on; `false` at the standoff, `None` where the arm does not reach.
    fn next(&mut self) -> Option<bool> {
        let proof = &self.judge.proof;
        let before = (self.step as f64 - 1.0) * STEP;
        if self.step > 0 && before >= proof.standoff - 1e-9 {
            return Some(false);
        }
        let out = (self.step as f64 * STEP).min(proof.standoff);
        self.step += 1;
        let forward = self.grasp.rotation * Vector::Z;
        let at = Pose::from_parts(self.grasp.translation + Vector::Z * proof.lift - forward * out, self.grasp.rotation);
        let far = |q: &Vec<f64>| q.iter().zip(&self.last).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
        let next = self.judge.arm.postures(&at, &self.last).into_iter().min_by(|a, b| far(a).total_cmp(&far(b)))?;
        if far(&next) > REACH {
            return None;
        }
        self.last = next;
        Some(true)
    }
}
