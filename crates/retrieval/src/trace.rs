//! Writes down a session's outcome: the plan file, with what was built and why.

use crate::carry::Carried;
use crate::feasibility::{Ending, Feasibility, Journey};
use crate::graph::{RetrievalGraph, Sequence};
use crate::roadmap::Roadmap;
use crate::ways::{Stage, Ways};
use clearway_plan::object_set::one_of;
use clearway_plan::plan_file::{
    GraphNodeTrace, GraphTrace, GraspCount, JointLimits, MeshFile, ObjectWhy, PlanFile, PlannedHand, PlannedRobot,
    RoadmapTrace, Stats, Status, Timing, Trace, Why,
};
use clearway_plan::robot_file::HandKind;
use clearway_plan::{ObjectId, ObjectSet, Stop, plan_file};
use clearway_robot::Robot;
use clearway_scene::{Scene, Support};
use std::collections::BTreeMap;

/// A plan over these objects.
pub fn solved(arm: &Feasibility, objects: &[ObjectId], journey: Journey) -> PlanFile {
    let names = &arm.scene.names;
    let mut why = why_solved(arm, objects, &journey.carried);
    for (object, not_pushed) in &journey.not_pushed {
        why.objects
            .iter_mut()
            .filter(|w| w.object == names[object.index()])
            .for_each(|w| w.push = format!("picked: {}", not_pushed.reason()));
    }
    let carried = journey.carried;
    for (step, push) in carried.iter().filter_map(|c| Some((&c.step, c.step.push.as_ref()?))) {
        let told = format!("pushed aside by {:.0} mm", push.distance * 1e3);
        why.objects.iter_mut().filter(|w| w.object == step.object).for_each(|w| w.push = told.clone());
    }
    PlanFile {
        why,
        removed: objects.iter().map(|o| names[o.index()].clone()).collect(),
        steps: carried.into_iter().map(|c| c.step).collect(),
        ..without_steps(arm, Status::Solved)
    }
}

/// No plan, and why; the last motion that could not be had.
pub fn unsolved(arm: &Feasibility, ending: &Ending, obstruction: Option<(ObjectId, &'static str)>) -> PlanFile {
    let status = if matches!(ending, Ending::Impossible(_)) { Status::Impossible } else { Status::OutOfBudget };
    PlanFile { why: why_not(arm, ending, obstruction), ..without_steps(arm, status) }
}

/// A plan that a symbolic planner made, for a goal of its own or to have the target; objects may come up more than once.
pub fn handled(arm: &Feasibility, carried: Vec<Carried>, goal: Option<&str>) -> PlanFile {
    let mut removed: Vec<String> = Vec::new();
    for Carried { step, .. } in &carried {
        removed.retain(|o| *o != step.object);
        removed.push(step.object.clone());
    }
    PlanFile {
        why: why_handled(arm, &removed, &carried, goal.is_some()),
        removed,
        steps: carried.into_iter().map(|c| c.step).collect(),
        goal: goal.map(str::to_owned),
        ..without_steps(arm, Status::Solved)
    }
}

/// No plan for a goal, and why: a proof or not.
pub fn not_handled(arm: &Feasibility, why: String, proved: bool, goal: Option<&str>) -> PlanFile {
    let status = if proved { Status::Impossible } else { Status::OutOfBudget };
    PlanFile {
        why: Why { summary: why, objects: all_learned(arm), sides: Vec::new() },
        goal: goal.map(str::to_owned),
        ..without_steps(arm, status)
    }
}

fn why_handled(arm: &Feasibility, removed: &[String], carried: &[Carried], has_goal: bool) -> Why {
    let names = &arm.scene.names;
    let reason = |name: &String| {
        let Some(object) = arm.scene.object(name) else { return (String::new(), Vec::new()) };
        let first = carried.iter().position(|c| c.step.object == *name).unwrap_or(0);
        let later =
            carried.iter().skip(first + 1).filter(|c| c.step.object != *name && c.way_blocked_by.contains(object));
        let mut blocked: Vec<String> = later.map(|c| c.step.object.clone()).collect();
        blocked.dedup();
        let reason = match stands_on(arm, object, &blocked).is_empty() && blocked.is_empty() {
            true if has_goal => "the goal asks for it".to_owned(),
            true if object == arm.scene.target => "it is the target".to_owned(),
            true => "a motion asks for it".to_owned(),
            false => in_the_way(arm, object, &blocked),
        };
        (reason, blocked)
    };
    let objects = removed.iter().enumerate().map(|(i, name)| {
        let (reason, blocked) = reason(name);
        let loosely = carried.iter().any(|c| c.step.object == *name && c.loosely);
        let why = ObjectWhy { object: name.clone(), order: i + 1, reason, blocked, ..ObjectWhy::default() };
        held(why, loosely)
    });
    let what = if has_goal {
        "The goal is reached".to_owned()
    } else {
        format!("`{}` is had", names[arm.scene.target.index()])
    };
    let steps = if carried.len() == 1 { "step" } else { "steps" };
    let summary = match carried.is_empty() {
        true => "The goal holds as things stand: there is nothing to do.".to_owned(),
        false => {
            format!("{what} with {} of {} objects moved, in {} {steps}.", removed.len(), names.len(), carried.len())
        }
    };
    Why { summary, objects: objects.collect(), sides: Vec::new() }
}

/// Tells of an object how it is held, if not firmly.
fn held(why: ObjectWhy, loosely: bool) -> ObjectWhy {
    let told = if loosely { "; not held firmly: it may turn or slip in the hand" } else { "" };
    ObjectWhy { reason: why.reason + told, held_loosely: loosely, ..why }
}

/// Those of some objects that an object stands on.
fn stands_on<'a>(arm: &Feasibility, object: ObjectId, others: &'a [String]) -> Vec<&'a String> {
    let below = match &arm.scene.objects[object.index()].support {
        Support::Objects(below) => below.as_slice(),
        Support::Fixture(_) => &[],
    };
    others.iter().filter(|o| below.iter().any(|b| arm.scene.names[b.index()] == **o)).collect()
}

/// Why an object has to go before those that it blocks.
fn in_the_way(arm: &Feasibility, object: ObjectId, blocked: &[String]) -> String {
    let name = &arm.scene.names[object.index()];
    let list = |names: &[&String]| names.iter().map(|b| format!("`{b}`")).collect::<Vec<_>>().join(" and ");
    let under = stands_on(arm, object, blocked);
    if !under.is_empty() {
        let has = if under.len() > 1 { "have" } else { "has" };
        return format!("`{name}` stands on {}, which {has} to go", list(&under));
    }
    let is = if blocked.len() > 1 { "are" } else { "is" };
    let blocked: Vec<&String> = blocked.iter().collect();
    format!("`{name}` stands in the way of the hand, the arm or the carried object when {} {is} taken", list(&blocked))
}

fn without_steps(arm: &Feasibility, status: Status) -> PlanFile {
    PlanFile {
        format: plan_file::FORMAT.to_owned(),
        status,
        seed: 0,
        scene: arm.scene.file.clone(),
        assumed: arm.scene.assumed.clone(),
        robot: planned_robot(arm.robot(), &arm.model().unchecked, &arm.scene),
        removed: Vec::new(),
        goal: None,
        lower_bound: None,
        steps: Vec::new(),
        known: Vec::new(),
        clearance: None,
        trace: None,
        timing: Timing::default(),
        stats: Stats::default(),
        why: Why::default(),
    }
}

/// The robot as a plan file tells it; mesh files are as the loaders found them.
fn planned_robot(robot: &Robot, unchecked: &[[String; 2]], scene: &Scene) -> PlannedRobot {
    let by_joint = |values: &[f64]| -> BTreeMap<String, f64> {
        robot.arm_names().into_iter().map(str::to_owned).zip(values.iter().copied()).collect()
    };
    let hand = &robot.hand;
    let meshes = robot
        .meshes
        .iter()
        .map(|m| (m.uri.clone(), m.path.clone(), m.sha256.clone()))
        .chain(scene.meshes.iter().map(|m| (m.uri.clone(), m.path.clone(), m.sha256.clone())))
        .map(|(uri, path, sha256)| MeshFile { uri, file: path.to_string_lossy().into_owned(), sha256 })
        .collect();
    PlannedRobot {
        urdf: robot.urdf_text.clone(),
        joints: robot.arm_names().into_iter().map(str::to_owned).collect(),
        base_joints: robot.planar_base.iter().flatten().map(|&j| robot.joints[j].name.clone()).collect(),
        tool: robot.links[hand.frame].name.clone(),
        fixed: robot.fixed.clone(),
        home: by_joint(&robot.home),
        limits: JointLimits {
            velocity: by_joint(&robot.velocity),
            acceleration: by_joint(&robot.acceleration),
            jerk: Some(by_joint(&robot.jerk)),
        },
        hand: PlannedHand {
            kind: if hand.kind == HandKind::Parallel { "parallel" } else { "suction" }.to_owned(),
            frame: robot.links[hand.frame].name.clone(),
            joint: hand.joint.map(|j| robot.joints[j].name.clone()),
            opening: robot.file.hand.opening.clone(),
            links: hand.links.iter().map(|&l| robot.links[l].name.clone()).collect(),
            base_radius: hand.base_radius,
            finger_thickness: hand.finger_thickness,
            radius: match hand.kind {
                HandKind::Suction { radius } => Some(radius),
                HandKind::Parallel => None,
            },
        },
        grasps: Some(robot.grasps.clone()),
        unchecked_pairs: unchecked.to_vec(),
        meshes,
    }
}

/// What was built: the roadmap and the retrieval graph, and the sequence's path in them.
pub fn trace(arm: &Feasibility, roadmap: &Roadmap, graph: &RetrievalGraph, sequence: Option<&Sequence>) -> Trace {
    let names = &arm.scene.names;
    let removed: ObjectSet = sequence.map_or(ObjectSet::EMPTY, |s| s.objects.iter().copied().collect());
    let (clusters, edges) = roadmap.clusters();
    let mean = |nodes: &[usize]| -> [f64; 2] {
        let sum = nodes.iter().fold([0.0, 0.0], |s, &i| [s[0] + roadmap.nodes[i].at.x, s[1] + roadmap.nodes[i].at.y]);
        sum.map(|v| v / nodes.len().max(1) as f64)
    };
    let mut nodes: Vec<GraphNodeTrace> = clusters
        .iter()
        .map(|c| GraphNodeTrace {
            collisions: c.collisions.names(names),
            roadmap_nodes: c.roadmap_nodes.len(),
            position: mean(&c.roadmap_nodes),
            blocks: None,
        })
        .collect();
    let mut edges: Vec<[usize; 2]> = edges.into_iter().map(|(a, b)| [a, b]).collect();
    for (object, set) in graph.failure_nodes() {
        let at = arm.scene.objects[object.index()].pose.translation;
        let index = nodes.len();
        nodes.push(GraphNodeTrace {
            collisions: set.names(names),
            roadmap_nodes: 0,
            position: [at.x, at.y],
            blocks: Some(names[object.index()].clone()),
        });
        // As in Fig. 5(c): before every cluster that collides with the object (the goal, for the target).
        for (i, cluster) in clusters.iter().enumerate() {
            if cluster.collisions.contains(object) || (object == arm.scene.target && i == 1) {
                edges.push([index, i]);
            }
        }
    }
    Trace {
        roadmap: RoadmapTrace {
            footprint_radius: arm.floor.radius,
            nodes: roadmap.nodes.iter().map(|n| n.at.to_array()).collect(),
            edges: roadmap.edges.iter().map(|&(a, b)| [a, b]).collect(),
            collisions: roadmap.nodes.iter().map(|n| n.collisions.names(names)).collect(),
            path: sequence.and_then(|_| roadmap.path(&removed)).unwrap_or_default(),
        },
        retrieval_graph: GraphTrace { nodes, edges, path: sequence.map_or(Vec::new(), |s| s.nodes.clone()) },
    }
}

fn why_solved(arm: &Feasibility, removed: &[ObjectId], carried: &[Carried]) -> Why {
    let names = &arm.scene.names;
    let target = &names[arm.scene.target.index()];
    let objects: Vec<ObjectWhy> = removed
        .iter()
        .enumerate()
        .map(|(i, &object)| {
            let blocked: Vec<String> = removed
                .iter()
                .zip(carried)
                .skip(i + 1)
                .filter(|(_, c)| c.way_blocked_by.contains(object))
                .map(|(o, _)| names[o.index()].clone())
                .collect();
            let name = &names[object.index()];
            let reason = if object == arm.scene.target {
                "it is the target".to_owned()
            } else if blocked.is_empty() {
                format!("`{name}` stands on the way out of `{target}` in the roadmap")
            } else {
                in_the_way(arm, object, &blocked)
            };
            let why = ObjectWhy { object: name.clone(), order: i + 1, reason, blocked, ..learned(arm, object) };
            held(why, carried.get(i).is_some_and(|c| c.loosely))
        })
        .collect();
    let summary = if removed.len() == 1 {
        format!("`{target}` can be taken directly.")
    } else {
        let before = removed.len() - 1;
        format!("`{target}` can be taken after {before} other object{}.", if before == 1 { "" } else { "s" })
    };
    Why { summary, objects, sides: Vec::new() }
}

fn why_not(arm: &Feasibility, ending: &Ending, obstruction: Option<(ObjectId, &'static str)>) -> Why {
    let names = &arm.scene.names;
    let target = &names[arm.scene.target.index()];
    let mut summary = match ending {
        Ending::Impossible(stuck) => never_taken(arm, arm.scene.target, *stuck),
        Ending::Stopped(Some(Stop::Cancelled)) => format!("Interrupted before a way to `{target}` was found."),
        Ending::Stopped(Some(Stop::Iterations)) => {
            format!("The iterations allowed were spent before a way to `{target}` was found; nothing is proved.")
        }
        Ending::Stopped(None) => {
            format!("Everything that was known of was tried, and no way to `{target}` was found; nothing is proved.")
        }
        _ => format!("The time allowed was spent before a way to `{target}` was found; nothing is proved."),
    };
    if let Some((object, what)) = obstruction {
        summary.push_str(&format!(" The last motion that failed: {what}, for `{}`.", names[object.index()]));
    }
    let sides = arm.sides();
    if !sides.is_empty() && sides.iter().all(|s| s.free == 0) {
        summary.push_str(&format!(" There is no side from which the robot could reach `{target}`."));
    }
    Why { summary, objects: all_learned(arm), sides }
}

/// What was learned of all objects that came up.
fn all_learned(arm: &Feasibility) -> Vec<ObjectWhy> {
    let names = &arm.scene.names;
    (0..names.len())
        .filter(|&i| arm.looked_into(ObjectId(i as u16)))
        .map(|i| {
            let object = ObjectId(i as u16);
            let why = learned(arm, object);
            let reason = match &why.blocked_by {
                _ if arm.no_way_is_known(object) => {
                    "no grasp that was tried leads to it, whatever is removed".to_owned()
                }
                by if by.is_empty() => "it can be picked as things stand".to_owned(),
                by => format!("one of these has to go first: {}", one_of(by, usize::MAX)),
            };
            ObjectWhy { object: names[i].clone(), reason, ..why }
        })
        .collect()
}

/// Why it is proved that an object cannot be taken; `stuck`: all of which that is proved.
pub fn never_taken(arm: &Feasibility, object: ObjectId, stuck: ObjectSet) -> String {
    let names = &arm.scene.names;
    let name = &names[object.index()];
    let mut others = stuck;
    others.remove(object);
    if others.is_empty() {
        return format!(
            "No declared grasp of `{name}` can be reached, even with every other object gone: see what became of the grasps."
        );
    }
    let others: Vec<String> = others.iter().map(|o| format!("`{}`", names[o.index()])).collect();
    format!(
        "`{name}` cannot be reached over any declared grasp: in each stands something that cannot be taken either: {}.",
        others.join(", ")
    )
}

/// What stands in the way of an object, over all its ways, and what became of its grasps.
fn learned(arm: &Feasibility, object: ObjectId) -> ObjectWhy {
    let ways = || arm.all_ways(object);
    let exact = ways().flat_map(|w| &w.ways).filter(|w| w.stage == Stage::Exact).map(|w| w.blocked_by);
    let sets = ObjectSet::minimal(exact.collect());
    let mut grasps: Vec<GraspCount> = Vec::new();
    for count in ways().flat_map(Ways::grasp_counts) {
        match grasps.iter_mut().find(|g| g.outcome == count.outcome) {
            Some(known) => known.count += count.count,
            None => grasps.push(count),
        }
    }
    ObjectWhy {
        blocked_by: sets.iter().filter(|s| !s.is_empty()).map(|s| s.names(&arm.scene.names)).collect(),
        grasps,
        ..ObjectWhy::default()
    }
}
