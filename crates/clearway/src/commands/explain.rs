//! `clearway explain`: why these objects, in this order; for a failure, what stood in the way.

use super::output::print;
use crate::cli::ExplainArgs;
use crate::exit::{Exit, Failure};
use clearway::PlanFile;
use clearway_plan::plan_file::{ObjectWhy, Status};

pub fn run(args: &ExplainArgs) -> Result<Exit, Failure> {
    let plan = clearway::read_plan(&args.plan)?;
    print(text(&plan))?;
    Ok(Exit::Done)
}

fn text(plan: &PlanFile) -> String {
    let name = if plan.scene.name.is_empty() { "the scene" } else { &plan.scene.name };
    let mut out = format!("{name}, target {}: ", plan.scene.target);
    match plan.status {
        Status::Solved => {
            out += &format!("solved, {} removed in the order {}\n", plan.removed.len(), plan.removed.join(" → "));
            out += &format!("{}\n", plan.why.summary);
            if let Some(bound) = &plan.lower_bound {
                let gap = plan.removed.len().saturating_sub(bound.removed);
                out += &format!("Removed {}, at least {} needed ({} proof), gap {gap}.\n", plan.removed.len(), bound.removed, bound.kind);
            }
        }
        Status::Impossible => out += &format!("impossible\n{}\n", plan.why.summary),
        Status::OutOfBudget => out += &format!("no plan found\n{}\n", plan.why.summary),
    }
    out.push('\n');
    out += &objects(plan);
    let s = &plan.stats;
    out += &format!(
        "\n{} round{}, exploration limit {}, {} sequences tried, {} grasp postures looked at, {} roadmap and {} retrieval graph nodes\n",
        s.iterations,
        if s.iterations == 1 { "" } else { "s" },
        s.exploration_limit,
        s.sequences_tried,
        s.grasps_tried,
        s.roadmap_nodes,
        s.retrieval_nodes
    );
    out
}

/// What was learned about each object, a paragraph each.
pub fn objects(plan: &PlanFile) -> String {
    let mut out = String::new();
    for why in &plan.why.objects {
        let order = if why.order > 0 { format!("{}. ", why.order) } else { "- ".to_owned() };
        out += &format!("{order}{}: {}\n", why.object, why.reason);
        out += &details(why);
    }
    out
}

fn details(why: &ObjectWhy) -> String {
    let mut out = String::new();
    if !why.blocked_by.is_empty() && why.order > 0 {
        let sets: Vec<String> = why.blocked_by.iter().map(|s| format!("{{{}}}", s.join(", "))).collect();
        out += &format!("     had to wait for one of: {}\n", sets.join(" or "));
    }
    for grasp in &why.grasps {
        out += &format!("     {:>5} × {}\n", grasp.count, grasp.outcome);
    }
    out
}
