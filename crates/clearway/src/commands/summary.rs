//! What a run tells: progress while it runs, a summary at the end.

use clearway::{Event, Observer, PlanFile, Report};
use clearway_plan::plan_file::{Action, Status};
use clearway_plan::scene_file::FRICTION;
use serde_json::{Value, json};
use std::io::{IsTerminal, Write};
use std::path::Path;

/// One line on stderr that is written over, when that is a terminal.
pub struct Progress {
    shown: bool,
    written: bool,
}

impl Progress {
    pub fn new(wanted: bool) -> Self {
        Self { shown: wanted && std::io::stderr().is_terminal(), written: false }
    }

    pub fn line(&mut self, text: &str) {
        if self.shown {
            let _ = write!(std::io::stderr(), "\r\x1b[2K{text}");
            self.written = true;
        }
    }

    pub fn clear(&mut self) {
        if self.written {
            let _ = write!(std::io::stderr(), "\r\x1b[2K");
            self.written = false;
        }
    }
}

impl Observer for Progress {
    fn event(&mut self, event: Event) {
        match event {
            Event::Iteration { exploration_limit, roadmap_nodes, .. } => {
                self.line(&format!("exploration limit {exploration_limit}, {roadmap_nodes} roadmap nodes"));
            }
            Event::Sequence { objects } => self.line(&format!("trying {}", objects.join(" → "))),
            Event::Blocked { object, .. } => self.line(&format!("{object} is blocked")),
            Event::Taken { object } => self.line(&format!("motion found for {object}")),
        }
    }
}

/// How it ended, in a line.
pub fn verdict(plan: &PlanFile) -> String {
    match plan.status {
        Status::Solved if plan.steps.is_empty() => "solved: nothing to do".to_owned(),
        Status::Solved => format!("solved: {}", order(plan).join(" → ")),
        Status::Impossible => format!("impossible: {}", plan.why.summary),
        Status::OutOfBudget => format!("no plan: {}", plan.why.summary),
    }
}

/// The objects in the order in which they are moved; for a goal of its own those that are moved again, again.
pub fn order(plan: &PlanFile) -> Vec<String> {
    match plan.goal {
        Some(_) => plan.steps.iter().map(|s| s.object.clone()).collect(),
        None => plan.removed.clone(),
    }
}

/// For people.
pub fn text(plan: &PlanFile, output: Option<&Path>, html: Option<&Path>) -> String {
    let mut out = verdict(plan) + "\n";
    if plan.status == Status::Solved {
        match plan.goal {
            Some(_) if plan.steps.is_empty() => out += "  the goal holds as things stand\n",
            Some(_) => {
                out +=
                    &format!("  moved {} in {}\n", count(plan.removed.len(), "object"), count(plan.steps.len(), "step"))
            }
            None => out += &format!("  removed {}{}\n", plan.removed.len(), bound(plan)),
        }
        for step in &plan.why.objects {
            let number = if plan.goal.is_some() { "-".to_owned() } else { format!("{}.", step.order) };
            let push = if step.push.is_empty() { String::new() } else { format!("; {}", step.push) };
            out += &format!("  {number} {}: {}{push}\n", step.object, step.reason);
        }
        out += &format!(
            "  planned in {:.1} ms ({:.1} ms choosing, {:.1} ms moving), {:.1} s of motion\n",
            plan.timing.total * 1e3,
            plan.timing.task * 1e3,
            plan.timing.motion * 1e3,
            plan.duration()
        );
        match plan.drives().len() {
            0 => {}
            1 => out += "  the base moves once\n",
            n => out += &format!("  the base moves {n} times\n"),
        }
        out += &assumed(plan);
        out += &format!("  verified: no violations{}\n", clearance(plan));
    } else {
        out += &super::explain::some_objects(plan);
    }
    for (what, path) in [("plan", output), ("page", html)] {
        if let Some(path) = path {
            out += &format!("  {what}: {}\n", path.display());
        }
    }
    out
}

/// The friction that pushes rest upon, where the scene does not give it.
fn assumed(plan: &PlanFile) -> String {
    let pushed = plan.steps.iter().filter(|s| s.action == Action::Push).map(|s| s.object.as_str());
    let assumed: Vec<&str> = pushed.filter(|id| plan.assumed.friction.iter().any(|a| a == id)).collect();
    if assumed.is_empty() {
        return String::new();
    }
    format!("  assumed for the pushes: friction {FRICTION} of {}, for which the scene gives none\n", assumed.join(", "))
}

/// The least room that the motions keep.
fn clearance(plan: &PlanFile) -> String {
    let Some(clearance) = &plan.clearance else { return String::new() };
    let Some(least) = &clearance.least else { return format!("; clearance more than {:.0} mm", clearance.up_to * 1e3) };
    let asked = if clearance.asked > 0.0 { format!(" ({:.1} mm asked)", clearance.asked * 1e3) } else { String::new() };
    format!(
        "; clearance {:.1} mm{asked}, {} and {} at {:.1} s",
        least.distance * 1e3,
        least.between[0],
        least.between[1],
        least.time
    )
}

fn count(n: usize, what: &str) -> String {
    format!("{n} {what}{}", if n == 1 { "" } else { "s" })
}

fn bound(plan: &PlanFile) -> String {
    match &plan.lower_bound {
        Some(b) => format!(
            ", at least {} needed ({})",
            b.removed,
            if b.kind == "grasps" { "declared grasps" } else { &b.kind }
        ),
        None => String::new(),
    }
}

/// For programs: one object.
pub fn json(plan: &PlanFile, report: Option<&Report>, output: Option<&Path>, html: Option<&Path>) -> Value {
    let path = |p: Option<&Path>| p.map(|p| p.display().to_string());
    json!({
        "status": plan.status,
        "seed": plan.seed,
        "removed": plan.removed,
        "lower_bound": plan.lower_bound.as_ref().map(|b| json!({"removed": b.removed, "kind": b.kind})),
        "steps": plan.steps.len(),
        "duration": plan.duration(),
        "timing": plan.timing,
        "stats": plan.stats,
        "clearance": plan.clearance,
        "verified": report.is_some_and(Report::is_valid),
        "why": plan.why.summary,
        "plan": path(output),
        "page": path(html),
    })
}
