//! The claim that every plan removes at least so many objects, and its proof.

use crate::case::Case;
use crate::error::CannotJudge;
use crate::names::Names;
use crate::report::{Report, ViolationKind};
use crate::{barriers, grasps};
use clearway_plan::plan_file::LowerBound;
use clearway_plan::proof::BarriersProof;
use clearway_plan::{Budget, PlanFile};

/// What a proof is worth.
pub(crate) enum Verdict {
    Proved,
    /// Why it could not be judged.
    Unknown(String),
    /// What is wrong with it.
    False(String),
}

/// A bound above what the plan removes is false, whatever its proof.
pub(crate) fn check_claim(plan: &PlanFile, report: &mut Report) {
    let Some(bound) = &plan.lower_bound else { return };
    if bound.removed > plan.removed.len() {
        let what = format!("lower_bound.removed is {}, but this plan removes {}", bound.removed, plan.removed.len());
        report.plan(ViolationKind::LowerBound, what);
    }
}

pub(crate) fn check_proof(
    plan: &PlanFile,
    case: &Case,
    names: &Names,
    budget: &Budget,
    report: &mut Report,
) -> Result<(), CannotJudge> {
    let Some(bound) = &plan.lower_bound else { return Ok(()) };
    let verdict = match bound.kind.as_str() {
        "geometric" => geometric(plan, case, bound),
        "grasps" => grasps::verdict(plan, case, names, bound, budget)?,
        kind => Verdict::Unknown(format!("the {kind:?} proof that at least {} must be removed", bound.removed)),
    };
    match verdict {
        Verdict::Proved => {}
        Verdict::Unknown(why) => report.not_checked.push(why),
        Verdict::False(why) => report.plan(ViolationKind::LowerBound, why),
    }
    Ok(())
}

fn geometric(plan: &PlanFile, case: &Case, bound: &LowerBound) -> Verdict {
    let no = |what: String| Verdict::False(format!("the proof of the lower bound: {what}"));
    let proof: BarriersProof = match serde_json::from_value(bound.proof.clone()) {
        Ok(proof) => proof,
        Err(e) => return no(format!("cannot be read ({e})")),
    };
    let Some(target) = case.object(&plan.scene.target) else {
        return Verdict::Unknown("the lower bound: the target is no object".to_owned());
    };
    match barriers::sets(case, target, &proof).and_then(|sets| barriers::packed(&proof, &sets)) {
        Ok(proved) if proved < bound.removed => no(format!(
            "its barriers prove that {proved} must be removed, the target included; {} is claimed",
            bound.removed
        )),
        Ok(_) => Verdict::Proved,
        Err(why) => no(why),
    }
}
