//! What was found in a robot, for people: what `clearway robot` prints.

use crate::description::{CollisionKind, Joint, JointKind, Link, MeshSource, Model, Robot};
use clearway_plan::robot_file::{GraspKind, HandKind};
use std::collections::BTreeMap;

/// A robot: its arm, hand, other joints, shapes, and the pairs that are never checked.
pub fn report(robot: &Robot) -> String {
    let mut out = format!("robot {}: {} links, {} joints\n", robot.name, robot.links.len(), robot.joints.len());
    out += &format!(
        "\narm: {} joints, from {} to {}\n",
        robot.arm.len(),
        robot.links[robot.base].name,
        robot.links[robot.tip].name
    );
    let mut rows = vec![
        ["joint", "kind", "lower", "upper", "velocity", "acceleration", "jerk", "home"].map(str::to_owned).to_vec(),
    ];
    for (i, &j) in robot.arm.iter().enumerate() {
        let joint = &robot.joints[j];
        let mut row = vec![joint.name.clone(), kind(joint.kind).to_owned()];
        row.extend(
            [robot.lower[i], robot.upper[i], robot.velocity[i], robot.acceleration[i], robot.jerk[i], robot.home[i]]
                .map(number),
        );
        rows.push(row);
    }
    out += &table(&rows);
    out += "  (radians and metres, per second)\n";
    if robot.planar_base.is_some() {
        out += "  (the first three drive the base)\n";
    }

    let name = |l: &usize| robot.links[*l].name.as_str();
    out += &format!("\ntool: {}\n", name(&robot.hand.frame));
    out += &match (&robot.hand.kind, robot.hand.joint) {
        (HandKind::Suction { radius }, _) => format!("hand: suction cup, radius {} mm\n", millimetres(*radius)),
        (HandKind::Parallel, joint) => {
            let gaps = robot.hand.opening.iter().map(|&(_, gap)| gap);
            format!(
                "hand: parallel, {} to {} mm between the pads, opened by {}\n",
                millimetres(gaps.fold(f64::INFINITY, f64::min)),
                millimetres(robot.hand.widest()),
                joint.map_or("nothing", |j| robot.joints[j].name.as_str()),
            )
        }
    };
    out += &format!("hand links: {}\n", robot.hand.links.iter().map(name).collect::<Vec<_>>().join(", "));
    out += &match robot.grasps.kind {
        GraspKind::Side => format!(
            "grasps: from the side, {} directions × {} heights\n",
            robot.grasps.yaws,
            robot.grasps.heights.len()
        ),
        GraspKind::List => format!("grasps: {} listed poses\n", robot.grasps.list.len()),
    };
    for (joint, value) in &robot.fixed {
        out += &format!("held still: {joint} at {}\n", number(*value));
    }
    out += &followers(&robot.joints);
    out += &shapes(&robot.links, &robot.meshes);
    if robot.disabled_pairs.is_empty() {
        out += "\npairs of links never checked: none named (no SRDF, or an empty one)\n";
    } else {
        out += &format!("\npairs of links never checked, by the SRDF: {}\n", robot.disabled_pairs.len());
        for (a, b) in &robot.disabled_pairs {
            out += &format!("  {} – {}\n", name(a), name(b));
        }
    }
    if !robot.named_states.is_empty() {
        out += &format!(
            "named states: {}\n",
            robot.named_states.keys().map(String::as_str).collect::<Vec<_>>().join(", ")
        );
    }
    out
}

/// A URDF without a robot file: its joints and shapes.
pub fn report_model(model: &Model) -> String {
    let mut out = format!(
        "model {}: {} links, {} joints; root link {}\n\n",
        model.name,
        model.links.len(),
        model.joints.len(),
        model.links[0].name
    );
    let mut rows = vec![["joint", "kind", "lower", "upper", "velocity"].map(str::to_owned).to_vec()];
    for joint in model.joints.iter().filter(|j| j.moves()) {
        let mut row = vec![joint.name.clone(), kind(joint.kind).to_owned()];
        row.extend([joint.lower, joint.upper, joint.velocity].map(number));
        rows.push(row);
    }
    out += &table(&rows);
    out += &followers(&model.joints);
    out += &shapes(&model.links, &model.meshes);
    out
}

fn followers(joints: &[Joint]) -> String {
    let mut out = String::new();
    for joint in joints {
        if let Some(mimic) = &joint.mimic {
            let offset = if mimic.offset == 0.0 { String::new() } else { format!(" + {}", number(mimic.offset)) };
            out += &format!(
                "follows: {} = {} × {}{offset}\n",
                joint.name,
                number(mimic.multiplier),
                joints[mimic.joint].name
            );
        }
    }
    out
}

fn shapes(links: &[Link], meshes: &[MeshSource]) -> String {
    let mut out = "\ncollision shapes\n".to_owned();
    let mut rows = Vec::new();
    let mut bare = Vec::new();
    for link in links {
        if link.collision_kinds.is_empty() {
            bare.push(link.name.as_str());
            continue;
        }
        let mut counts: BTreeMap<String, usize> = BTreeMap::new();
        for (kind, parts) in &link.collision_kinds {
            let kind = match kind {
                CollisionKind::Box => "box".to_owned(),
                CollisionKind::Cylinder => "cylinder".to_owned(),
                CollisionKind::Sphere => "sphere".to_owned(),
                CollisionKind::Capsule => "capsule".to_owned(),
                CollisionKind::Mesh(uri) => {
                    format!(
                        "mesh {} as {parts} convex part{}",
                        uri.rsplit('/').next().unwrap_or(uri),
                        if *parts == 1 { "" } else { "s" }
                    )
                }
            };
            *counts.entry(kind).or_default() += 1;
        }
        let kinds: Vec<String> =
            counts.iter().map(|(kind, n)| if *n == 1 { kind.clone() } else { format!("{n} × {kind}") }).collect();
        rows.push(vec![link.name.clone(), kinds.join(", ")]);
    }
    out += &table(&rows);
    if !bare.is_empty() {
        out += &format!("  without shape: {}\n", bare.join(", "));
    }
    for mesh in meshes {
        out += &format!("mesh {} ({}…)\n", mesh.path.display(), mesh.sha256.get(..12).unwrap_or(&mesh.sha256));
    }
    out
}

fn kind(kind: JointKind) -> &'static str {
    match kind {
        JointKind::Fixed => "fixed",
        JointKind::Revolute => "revolute",
        JointKind::Continuous => "continuous",
        JointKind::Prismatic => "prismatic",
    }
}

fn millimetres(metres: f64) -> String {
    number(metres * 1000.0)
}

/// Four digits after the point, without the zeros at the end.
fn number(x: f64) -> String {
    if x.is_infinite() {
        return if x > 0.0 { "∞".to_owned() } else { "-∞".to_owned() };
    }
    let text = format!("{x:.4}");
    let text = text.trim_end_matches('0').trim_end_matches('.');
    if text == "-0" { "0".to_owned() } else { text.to_owned() }
}

/// Columns as wide as they must be, two spaces in.
fn table(rows: &[Vec<String>]) -> String {
    let columns = rows.iter().map(Vec::len).max().unwrap_or(0);
    let width = |c: usize| rows.iter().filter_map(|r| r.get(c)).map(|s| s.chars().count()).max().unwrap_or(0);
    let widths: Vec<usize> = (0..columns).map(width).collect();
    let line = |row: &Vec<String>| {
        let cells: Vec<String> = row.iter().zip(&widths).map(|(s, &w)| format!("{s:<w$}")).collect();
        format!("  {}\n", cells.join("  ").trim_end())
    };
    rows.iter().map(line).collect()
}
