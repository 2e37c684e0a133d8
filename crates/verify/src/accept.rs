//! A plan that the verifier found nothing wrong with.

use crate::error::CannotJudge;
use crate::judge::judge;
use crate::report::Report;
use clearway_plan::{Budget, PlanFile};
use std::path::Path;

/// Only [`accept`] makes one.
#[derive(Clone, Debug)]
pub struct VerifiedPlan {
    plan: PlanFile,
    report: Report,
}

impl VerifiedPlan {
    pub fn plan(&self) -> &PlanFile {
        &self.plan
    }

    pub fn report(&self) -> &Report {
        &self.report
    }

    pub fn into_inner(self) -> PlanFile {
        self.plan
    }
}

/// A plan that is not accepted.
#[derive(Debug, thiserror::Error)]
pub enum Rejected {
    /// It has violations.
    #[error("the plan breaks its contract: {report}")]
    Violations { plan: Box<PlanFile>, report: Box<Report> },
    /// It could not be judged.
    #[error(transparent)]
    Unjudged(#[from] CannotJudge),
}

/// Verifies a plan, and vouches for it; not for its lower bound's proof, which [`crate::verify`] judges.
/// The plan accepted tells the clearance measured.
pub fn accept(mut plan: PlanFile, plan_directory: &Path, budget: &Budget) -> Result<VerifiedPlan, Rejected> {
    let report = judge(&plan, plan_directory, budget, false)?;
    if report.is_valid() {
        plan.clearance.clone_from(&report.clearance);
        Ok(VerifiedPlan { plan, report })
    } else {
        Err(Rejected::Violations { plan: Box::new(plan), report: Box::new(report) })
    }
}
