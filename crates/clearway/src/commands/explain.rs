//! `clearway explain`: why these objects, in this order; for a failure, what stood in the way.

use super::output::print;
use super::summary;
use crate::cli::ExplainArgs;
use crate::exit::{Exit, Failure};
use clearway::PlanFile;
use clearway_plan::object_set::one_of;
use clearway_plan::plan_file::{Drive, Known, LowerBound, ObjectWhy, SideWhy, Status};
use clearway_plan::proof::{BarriersProof, Branch, Enclosure, GraspsProof, ObjectCase};
use std::collections::BTreeSet;

/// Sets of objects named for each object of a proof.
const SHOWN: usize = 6;

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
            let order = summary::order(plan).join(" → ");
            match &plan.goal {
                Some(goal) => out += &format!("solved, {} steps for the goal {goal}: {order}\n", plan.steps.len()),
                None => out += &format!("solved, {} removed in the order {order}\n", plan.removed.len()),
            }
            out += &format!("{}\n", plan.why.summary);
            if let Some(bound) = &plan.lower_bound {
                let gap = plan.removed.len().saturating_sub(bound.removed);
                out += &format!(
                    "Removed {}, at least {} needed, gap {gap}; the proof: ",
                    plan.removed.len(),
                    bound.removed
                );
                out += &proof(bound);
            }
        }
        Status::Impossible => out += &format!("impossible\n{}\n", plan.why.summary),
        Status::OutOfBudget => out += &format!("no plan found\n{}\n", plan.why.summary),
    }
    out += &plan.known.iter().map(known).collect::<String>();
    out.push('\n');
    out += &objects(plan);
    out += &sides(plan);
    out += &drives(plan);
    let s = &plan.stats;
    // No retrieval graph, but symbols and streams.
    if plan.trace.is_none() && s.retrieval_nodes == 0 {
        out += &format!(
            "\n{} symbolic plans, {} streams asked, {} sets of movable objects tried\n",
            s.iterations, s.samples, s.sequences_tried
        );
        return out;
    }
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

/// What was seen before a step, and what the step was for.
fn known(known: &Known) -> String {
    let new = if known.new.is_empty() { "nothing new".to_owned() } else { format!("new: {}", known.new.join(", ")) };
    let aim = match known.chance {
        None => format!("{} is in view, and this is for it", known.taking),
        Some(chance) => format!(
            "to look behind {}: {:.0} % of the places left for the target come into view",
            known.taking,
            100.0 * chance
        ),
    };
    format!("Before step {}: {} objects seen ({new}); {aim}\n", known.step + 1, known.seen.len())
}

/// What proves the bound, in words.
fn proof(bound: &LowerBound) -> String {
    let grasps = || serde_json::from_value::<GraspsProof>(bound.proof.clone()).ok();
    let shut_in =
        || serde_json::from_value::<BarriersProof>(bound.proof.clone()).ok().filter(|p| !p.barriers.is_empty());
    let told = match bound.kind.as_str() {
        "grasps" => grasps().map(|proof| {
            let stretch = format!("the straight {} m before them", proof.standoff);
            let objects: Vec<String> = proof.objects.iter().map(blocked).collect();
            let besides = proof.barriers.as_ref().map_or(String::new(), |b| format!("and besides {}", barriers(b)));
            format!("what blocks the declared grasps, or {stretch},\n{}{besides}", objects.concat())
        }),
        "geometric" => shut_in().map(|proof| barriers(&proof)),
        _ => None,
    };
    told.unwrap_or_else(|| match bound.removed {
        1 => "the target has to go.\n".to_owned(),
        _ => format!("kind {:?}.\n", bound.kind),
    })
}

/// What shuts the target in, a line for each barrier.
fn barriers(proof: &BarriersProof) -> String {
    let mut out = "what shuts the target in, whatever the hand and the arm".to_owned();
    if let Some(Enclosure { lean, floor, ceiling, .. }) = &proof.enclosure {
        let degrees = lean.to_degrees();
        out += &format!(
            ";\n  between {} and {} it cannot be lifted over that, leaning by up to {degrees:.0}°",
            floor.fixture, ceiling.fixture
        );
    }
    out.push('\n');
    let whole = proof.barriers.iter().all(|b| b.weight > 1.0 - 1e-6);
    for barrier in &proof.barriers {
        let fixtures: BTreeSet<&str> =
            barrier.chain.iter().map(|l| l.body.as_str()).filter(|b| !barrier.objects.iter().any(|o| o == b)).collect();
        let among = if fixtures.is_empty() {
            String::new()
        } else {
            format!(", in a ring with {}", Vec::from_iter(fixtures).join(", "))
        };
        let weight = if whole { String::new() } else { format!(" (weight {:.2})", barrier.weight) };
        out += &format!("  one of {} has to go{among}{weight}\n", barrier.objects.join(", "));
    }
    out
}

/// One object's grasps in a line or two.
fn blocked(case: &ObjectCase) -> String {
    let holding = case.grasps.iter().filter(|g| g.holds).count();
    let branches: Vec<&Branch> = case.grasps.iter().flat_map(|g| &g.branches).collect();
    let mut sets: Vec<&Vec<String>> = branches.iter().filter_map(|b| b.blocked_by.as_ref()).collect();
    let open = sets.len();
    sets.sort_by_key(|s| s.len());
    let mut least: Vec<&Vec<String>> = Vec::new();
    for set in sets {
        if !least.iter().any(|l| l.iter().all(|o| set.contains(o))) {
            least.push(set);
        }
    }
    let by = match least.first() {
        None => "nothing helps".to_owned(),
        Some(first) if first.is_empty() => "some are free as things stand".to_owned(),
        Some(_) => format!("before it has to go {}", one_of(&least, SHOWN)),
    };
    format!(
        "  {}: {holding} of {} grasps hold, in {} postures, {open} of them not ruled out for good; {by}\n",
        case.object,
        case.grasps.len(),
        branches.len(),
    )
}

/// What was learned about each object, a paragraph each.
pub fn objects(plan: &PlanFile) -> String {
    plan.why.objects.iter().map(object).collect()
}

/// Where the base drives.
fn drives(plan: &PlanFile) -> String {
    let at = |[x, y, yaw]: [f64; 3]| format!("({x:.2}, {y:.2}) facing {:.0}°", yaw.to_degrees().rem_euclid(360.0));
    let drives = plan.drives();
    let line = |d: &Drive| {
        let what = if d.carrying { "with" } else { "for" };
        format!("  {what} {}: from {} to {}, {:.1} s\n", plan.steps[d.step].object, at(d.from), at(d.to), d.seconds)
    };
    match drives.len() {
        0 => String::new(),
        n => format!(
            "The base moves {n} time{}:\n{}",
            if n == 1 { "" } else { "s" },
            drives.iter().map(line).collect::<String>()
        ),
    }
}

/// Which sides of the target a mobile base was tried on, and what is in its way there.
fn sides(plan: &PlanFile) -> String {
    /// Of what is in the way on a side.
    const NAMED: usize = 4;
    let side = |side: &SideWhy| {
        let degrees = side.bearing.to_degrees();
        let found = match (side.tried, side.free) {
            (0, _) => "no place there has it in reach".to_owned(),
            (tried, 0) => {
                // Those in the way at most places come first.
                let more = side.blocked_by.len().saturating_sub(NAMED);
                let named = side.blocked_by[..side.blocked_by.len() - more].join(", ");
                let more = if more > 0 { format!(" and {more} more") } else { String::new() };
                format!("none of {tried} places is free: {named}{more}")
            }
            (tried, free) => format!("{free} of {tried} places are free"),
        };
        format!("  {degrees:>4.0}° from {}: {found}\n", plan.scene.target)
    };
    if plan.why.sides.is_empty() {
        return String::new();
    }
    let list: String = plan.why.sides.iter().map(side).collect();
    format!("Sides on which the robot could stand to reach the target (0° is along x, 90° along y):\n{list}")
}

/// The same of the target and a few others.
pub fn some_objects(plan: &PlanFile) -> String {
    const OTHERS: usize = 6;
    let (target, others): (Vec<&ObjectWhy>, Vec<&ObjectWhy>) =
        plan.why.objects.iter().partition(|why| why.object == plan.scene.target);
    let mut out: String = target.into_iter().chain(others.iter().take(OTHERS).copied()).map(object).collect();
    out += &sides(plan);
    if others.len() > OTHERS {
        out += &format!("… and {} more; with a plan file (-o) `clearway explain` tells all\n", others.len() - OTHERS);
    }
    out
}

fn object(why: &ObjectWhy) -> String {
    let order = if why.order > 0 { format!("{}. ", why.order) } else { "- ".to_owned() };
    format!("{order}{}: {}\n{}", why.object, why.reason, details(why))
}

fn details(why: &ObjectWhy) -> String {
    let mut out = String::new();
    if !why.push.is_empty() {
        out += &format!("     {}\n", why.push);
    }
    if !why.blocked_by.is_empty() && why.order > 0 {
        out += &format!("     had to wait for one of: {}\n", one_of(&why.blocked_by, usize::MAX));
    }
    for grasp in &why.grasps {
        out += &format!("     {:>5} × {}\n", grasp.count, grasp.outcome);
    }
    out
}
