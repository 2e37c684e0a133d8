//! Writes down a session's outcome: the plan file, with what was built and why.

use crate::carry::Carried;
use crate::floor::Floor;
use crate::graph::{RetrievalGraph, Sequence};
use crate::roadmap::Roadmap;
use crate::ways::{Stage, Ways};
use clearway_collision::World;
use clearway_plan::plan_file::{
    GraphNodeTrace, GraphTrace, JointLimits, MeshFile, ObjectWhy, PlanFile, PlannedHand, PlannedRobot, RoadmapTrace, Stats,
    Status, Timing, Trace, Why,
};
use clearway_plan::robot_file::HandKind;
use clearway_plan::{ObjectId, ObjectSet, Stop, plan_file};
use clearway_robot::Robot;
use clearway_scene::Scene;
use std::collections::BTreeMap;

/// What there is to tell from.
pub struct View<'a> {
    pub scene: &'a Scene,
    pub world: &'a World,
    pub floor: &'a Floor,
    pub roadmap: &'a Roadmap,
    pub graph: &'a RetrievalGraph,
    pub ways: &'a [Option<Ways>],
}

pub fn plan_file(
    view: &View,
    status: Status,
    sequence: Option<&Sequence>,
    carried: Vec<Carried>,
    obstruction: Option<(ObjectId, &'static str)>,
    stopped: Option<Stop>,
) -> PlanFile {
    let why = match sequence {
        Some(sequence) => why_solved(view, sequence, &carried),
        None => why_not(view, status, obstruction, stopped),
    };
    let removed = sequence.map_or(Vec::new(), |s| s.objects.iter().map(|o| view.scene.names[o.index()].clone()).collect());
    PlanFile {
        format: plan_file::FORMAT.to_owned(),
        status,
        seed: 0,
        scene: view.scene.file.clone(),
        robot: planned_robot(&view.world.model.robot, &view.world.model.unchecked, view.scene),
        removed,
        lower_bound: None,
        steps: carried.into_iter().map(|c| c.step).collect(),
        trace: Some(trace(view, sequence)),
        timing: Timing::default(),
        stats: Stats::default(),
        why,
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

fn trace(view: &View, sequence: Option<&Sequence>) -> Trace {
    let names = &view.scene.names;
    let removed: ObjectSet = sequence.map_or(ObjectSet::EMPTY, |s| s.objects.iter().copied().collect());
    let (clusters, edges) = view.roadmap.clusters();
    let mean = |nodes: &[usize]| -> [f64; 2] {
        let sum = nodes.iter().fold([0.0, 0.0], |s, &i| [s[0] + view.roadmap.nodes[i].at.x, s[1] + view.roadmap.nodes[i].at.y]);
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
    for (object, set) in view.graph.failure_nodes() {
        let at = view.scene.objects[object.index()].pose.translation;
        let index = nodes.len();
        nodes.push(GraphNodeTrace {
            collisions: set.names(names),
            roadmap_nodes: 0,
            position: [at.x, at.y],
            blocks: Some(names[object.index()].clone()),
        });
        // As in Fig. 5(c): before every cluster that collides with the object (the goal, for the target).
        for (i, cluster) in clusters.iter().enumerate() {
            if cluster.collisions.contains(object) || (object == view.scene.target && i == 1) {
                edges.push([index, i]);
            }
        }
    }
    Trace {
        roadmap: RoadmapTrace {
            footprint_radius: view.floor.radius,
            nodes: view.roadmap.nodes.iter().map(|n| n.at.to_array()).collect(),
            edges: view.roadmap.edges.iter().map(|&(a, b)| [a, b]).collect(),
            collisions: view.roadmap.nodes.iter().map(|n| n.collisions.names(names)).collect(),
            path: sequence.and_then(|_| view.roadmap.path(&removed)).unwrap_or_default(),
        },
        retrieval_graph: GraphTrace { nodes, edges, path: sequence.map_or(Vec::new(), |s| s.nodes.clone()) },
    }
}

fn why_solved(view: &View, sequence: &Sequence, carried: &[Carried]) -> Why {
    let names = &view.scene.names;
    let target = &names[view.scene.target.index()];
    let objects: Vec<ObjectWhy> = sequence
        .objects
        .iter()
        .enumerate()
        .map(|(i, &object)| {
            let blocked: Vec<String> = sequence
                .objects
                .iter()
                .zip(carried)
                .skip(i + 1)
                .filter(|(_, c)| c.way_blocked_by.contains(object))
                .map(|(o, _)| names[o.index()].clone())
                .collect();
            let name = &names[object.index()];
            let reason = if object == view.scene.target {
                "it is the target".to_owned()
            } else if blocked.is_empty() {
                format!("`{name}` stands on the way out of `{target}` in the roadmap")
            } else {
                let list = blocked.iter().map(|b| format!("`{b}`")).collect::<Vec<_>>().join(" and ");
                let is = if blocked.len() > 1 { "are" } else { "is" };
                format!("`{name}` stands in the way of the hand, the arm or the carried object when {list} {is} taken")
            };
            ObjectWhy { object: name.clone(), order: i + 1, reason, blocked, ..learned(view, object) }
        })
        .collect();
    let summary = if sequence.objects.len() == 1 {
        format!("`{target}` can be taken directly.")
    } else {
        let before = sequence.objects.len() - 1;
        format!("`{target}` can be taken after {before} other object{}.", if before == 1 { "" } else { "s" })
    };
    Why { summary, objects }
}

fn why_not(view: &View, status: Status, obstruction: Option<(ObjectId, &'static str)>, stopped: Option<Stop>) -> Why {
    let names = &view.scene.names;
    let target = &names[view.scene.target.index()];
    let mut summary = match (status, stopped) {
        (Status::Impossible, _) => format!(
            "No declared grasp of `{target}` can be reached, even with every other object gone: see what became of the grasps."
        ),
        (_, Some(Stop::Cancelled)) => format!("Interrupted before a way to `{target}` was found."),
        (_, Some(Stop::Iterations)) => format!("The iterations allowed were spent before a way to `{target}` was found; nothing is proved."),
        _ => format!("The time allowed was spent before a way to `{target}` was found; nothing is proved."),
    };
    if let Some((object, what)) = obstruction {
        summary.push_str(&format!(" The last motion that failed: {what}, for `{}`.", names[object.index()]));
    }
    let objects = (0..view.ways.len())
        .filter(|&i| view.ways[i].is_some())
        .map(|i| {
            let object = ObjectId(i as u16);
            let why = learned(view, object);
            let reason = match (&why.blocked_by, view.ways[i].as_ref().map(|w| w.ways.len())) {
                (_, Some(0)) => "no grasp leads to it, whatever is removed".to_owned(),
                (by, _) if by.is_empty() => "it can be picked as things stand".to_owned(),
                (by, _) => format!(
                    "one of these has to go first: {}",
                    by.iter().map(|s| format!("{{{}}}", s.join(", "))).collect::<Vec<_>>().join(" or ")
                ),
            };
            ObjectWhy { object: names[i].clone(), reason, ..why }
        })
        .collect();
    Why { summary, objects }
}

/// What stands in the way of an object, over all its ways, and what became of its grasps.
fn learned(view: &View, object: ObjectId) -> ObjectWhy {
    let Some(ways) = &view.ways[object.index()] else { return ObjectWhy::default() };
    let sets = ObjectSet::minimal(ways.ways.iter().filter(|w| w.stage == Stage::Exact).map(|w| w.blocked_by).collect());
    ObjectWhy {
        blocked_by: sets.iter().filter(|s| !s.is_empty()).map(|s| s.names(&view.scene.names)).collect(),
        grasps: ways.grasp_counts(),
        ..ObjectWhy::default()
    }
}
