//! What a bag says in words: its log and its summary.

use crate::kinds::{kind_name, status_name};
use crate::rows::TimedSegment;
use clearway_plan::PlanFile;
use clearway_plan::plan_file::Action;
use std::collections::BTreeMap;

/// `step 2 of 4: take o8: …stands in the way of…`
pub(crate) fn step(plan: &PlanFile, step: usize) -> String {
    let content = &plan.steps[step];
    let verb = match content.action {
        Action::PickPlace => "take",
        Action::Push => "push",
    };
    let mut text = format!("step {} of {}: {verb} {}", step + 1, plan.steps.len(), content.object);
    let reason = plan.why.objects.iter().find(|why| why.object == content.object).map(|why| why.reason.as_str());
    if let Some(reason) = reason.filter(|reason| !reason.is_empty()) {
        text.push_str(": ");
        text.push_str(reason);
    }
    text
}

/// `o8: grasp`
pub(crate) fn segment(segment: &TimedSegment) -> String {
    format!("{}: {}", segment.object, kind_name(segment.segment.kind))
}

/// The plan in short. Numbers of seconds are planning's, but for `motion`, which the robot takes.
pub(crate) fn summary(plan: &PlanFile) -> BTreeMap<String, String> {
    let mut entries = BTreeMap::new();
    let mut say = |key: &str, value: String| {
        entries.insert(key.to_owned(), value);
    };
    say("status", status_name(plan.status).to_owned());
    say("scene", plan.scene.name.clone());
    say("robot", plan.scene.robot.model.clone());
    say("target", plan.scene.target.clone());
    say("seed", plan.seed.to_string());
    say("removed", plan.removed.join(", "));
    say("removals", plan.removed.len().to_string());
    say("steps", plan.steps.len().to_string());
    say("motion", plan.duration().to_string());
    say("planning", plan.timing.total.to_string());
    say("planning.task", plan.timing.task.to_string());
    say("planning.motion", plan.timing.motion.to_string());
    if let Some(bound) = &plan.lower_bound {
        say("lower_bound", bound.removed.to_string());
        say("lower_bound.kind", bound.kind.clone());
    }
    if let Some(goal) = &plan.goal {
        say("goal", goal.clone());
    }
    if !plan.why.summary.is_empty() {
        say("summary", plan.why.summary.clone());
    }
    entries
}
