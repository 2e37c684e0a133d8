//! Structure, steps: they name objects of the scene, their segments come in an order that makes
//! sense, `removed` lists their objects, and the target goes last unless the plan has a goal of its own.

use crate::case::Case;
use crate::report::{Place, Report, ViolationKind};
use clearway_plan::PlanFile;
use clearway_plan::plan_file::{Action, SegmentKind, Step};

/// The object of each step; `None` when a step names none.
pub(crate) fn check(plan: &PlanFile, case: &Case, report: &mut Report) -> Option<Vec<usize>> {
    let mut objects = Vec::new();
    for (i, step) in plan.steps.iter().enumerate() {
        match case.object(&step.object) {
            Some(object) => objects.push(object),
            None => report.at(
                ViolationKind::Steps,
                Place::step(i, 0.0),
                format!("the scene has no object {:?}", step.object),
            ),
        }
        if let Err(what) = order(step) {
            report.at(ViolationKind::Steps, Place::step(i, 0.0), what);
        }
    }
    if case.object(&plan.scene.target).is_none() {
        report.plan(ViolationKind::Steps, format!("the target {:?} is no object of the scene", plan.scene.target));
    }
    if let Some(goal) = &plan.goal {
        // Any object may be moved for it, the target or another last.
        report.not_checked.push(format!("whether the goal {goal} is reached"));
    } else if let Some(last) = plan.steps.last()
        && last.object != plan.scene.target
    {
        let what = format!("the last step takes {:?}; expected the target, {:?}", last.object, plan.scene.target);
        report.plan(ViolationKind::Steps, what);
    }
    removed(plan, report);
    (objects.len() == plan.steps.len()).then_some(objects)
}

/// `removed` is the steps' distinct objects, in order of their first steps or of their last.
fn removed(plan: &PlanFile, report: &mut Report) {
    let distinct = |steps: &mut dyn Iterator<Item = &Step>| {
        let mut names: Vec<String> = Vec::new();
        for step in steps {
            if !names.contains(&step.object) {
                names.push(step.object.clone());
            }
        }
        names
    };
    let by_first = distinct(&mut plan.steps.iter());
    let mut by_last = distinct(&mut plan.steps.iter().rev());
    by_last.reverse();
    if plan.removed != by_first && plan.removed != by_last {
        let what = format!("removed is [{}]; the steps take [{}]", plan.removed.join(", "), by_first.join(", "));
        report.plan(ViolationKind::Removed, what);
    }
}

/// Picking: come, grasp, carry, release, leave. Pushing: come, push, leave.
fn order(step: &Step) -> Result<(), String> {
    use SegmentKind::{Approach, Grasp, Push, Release, Retreat, Transfer, Transit};
    let phases: &[(&[SegmentKind], bool)] = match step.action {
        Action::PickPlace => &[
            (&[Transit, Approach], false),
            (&[Grasp], true),
            (&[Transfer, Transit], true),
            (&[Release], true),
            (&[Retreat, Transit], false),
        ],
        Action::Push => &[(&[Transit, Approach], false), (&[Push], true), (&[Retreat, Transit], false)],
    };
    let mut rest = step.segments.iter().map(|s| s.kind).peekable();
    for (kinds, needed) in phases {
        let mut found = false;
        while rest.next_if(|kind| kinds.contains(kind)).is_some() {
            found = true;
        }
        if *needed && !found {
            return Err(match rest.peek() {
                Some(kind) => format!("a {kind:?} segment where a {:?} was expected", kinds[0]).to_lowercase(),
                None => format!("ends without a {:?} segment", kinds[0]).to_lowercase(),
            });
        }
    }
    match rest.next() {
        Some(kind) => Err(format!("a {kind:?} segment out of order").to_lowercase()),
        None => Ok(()),
    }
}
