//! The verifier's outline: what is checked, in which order.

use crate::case::Case;
use crate::error::CannotJudge;
use crate::report::{Report, ViolationKind};
use crate::watch::Watch;
use crate::{carry, gripper, jerk, limits, lower_bound, names, passes, region, rows, sight, steps, unchecked};
use clearway_plan::plan_file::{FORMAT, Status};
use clearway_plan::{Budget, PlanFile};
use std::path::Path;

/// Judges a plan. `plan_directory` is where its meshes are relative to.
///
/// Takes some tenths of a second for a plan of a minute. `Err` only when there is no judging it: a
/// URDF or scene that makes no sense, a mesh that is missing or another, the budget spent. When the
/// plan's structure is so broken that rows cannot be read, only structure is reported.
pub fn verify(plan: &PlanFile, plan_directory: &Path, budget: &Budget) -> Result<Report, CannotJudge> {
    judge(plan, plan_directory, budget, true)
}

/// The same; the lower bound's proof, which has nothing to do with the motions, only on demand.
pub(crate) fn judge(
    plan: &PlanFile,
    plan_directory: &Path,
    budget: &Budget,
    with_proof: bool,
) -> Result<Report, CannotJudge> {
    let mut report = Report::default();
    if plan.format != FORMAT {
        report.plan(ViolationKind::Format, format!("the format is {:?}; expected {FORMAT:?}", plan.format));
    }
    // A goal of its own may hold at first.
    if plan.status != Status::Solved || plan.steps.is_empty() && plan.goal.is_none() {
        let status = serde_json::to_string(&plan.status).unwrap_or_default();
        report.plan(
            ViolationKind::NotSolved,
            format!("no plan to judge: the status is {status}, with {} steps", plan.steps.len()),
        );
        return Ok(report);
    }
    let case = Case::new(plan, plan_directory)?;
    lower_bound::check_claim(plan, &mut report);
    let names = names::resolve(plan, &case.model, &mut report);
    let objects = steps::check(plan, &case, &mut report);
    let Some(names) = names else { return Ok(report) };
    if with_proof {
        lower_bound::check_proof(plan, &case, &names, budget, &mut report)?;
    }
    let Some(tracks) = rows::tracks(plan, &case.model, &names, &mut report) else { return Ok(report) };
    report.checked.steps = plan.steps.len();
    report.checked.segments = tracks.len();
    report.checked.rows = tracks.iter().map(|t| t.postures.len()).sum();
    report.checked.duration = tracks.last().map_or(0.0, |t| t.start + t.segment.times.last().copied().unwrap_or(0.0));
    rows::check(plan, &case.model, &names, &tracks, &mut report);
    gripper::check(&case.model, &names, &tracks, &mut report);
    limits::check(plan, &case.model, &names, &tracks, &mut report);
    jerk::check(plan, &case.model, &names, &tracks, &mut report);
    region::check(plan, &case, &names, &tracks, &mut report);
    unchecked::check(plan, &case, &names, budget, &mut report)?;
    let Some(objects) = objects else { return Ok(report) };
    let stages = carry::stages(plan, &case, &names, &tracks, &objects, budget, &mut report)?;
    sight::check(plan, &case, &tracks, &stages, budget, &mut report)?;
    let watches: Vec<Watch> = stages.iter().map(|stage| Watch::new(&case, &names, stage)).collect();
    passes::check(plan, &case, &tracks, &stages, &watches, budget, &mut report)?;
    Ok(report)
}
