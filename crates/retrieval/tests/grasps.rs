//! Preset grasps: objects are held so that they do not turn or slip in the hand, where they can be.
#![allow(clippy::unwrap_used)]

use clearway_collision::{CollisionModel, World};
use clearway_geometry::Vec3;
use clearway_plan::event::Silent;
use clearway_plan::plan_file::Status;
use clearway_plan::{Budget, ObjectId};
use clearway_retrieval::grasps::{Presets, declared, preset_grasps};
use clearway_retrieval::handling::Handling;
use clearway_retrieval::planner::{Planner, Request, SceneDelta, Settings};
use clearway_robot::Robot;
use clearway_scene::Scene;
use std::path::Path;
use std::sync::Arc;

fn arm(robot: &str) -> Arc<CollisionModel> {
    let robot = Arc::new(Robot::load(robot, Path::new("."), &[]).unwrap());
    let model = Arc::new(CollisionModel::new(robot));
    model.standing.as_ref().map_or(model.clone(), |standing| standing.model.clone())
}

/// One object before a robot, and what it can be taken by.
fn presets(model: &Arc<CollisionModel>, object: &str) -> (World, Presets) {
    let text = format!(
        "\
format: clearway-scene/1
robot: {{model: any, base: {{position: [0, 0, 0]}}}}
fixtures:
  - {{id: table, box: {{size: [0.6, 1.0, 0.02]}}, position: [0.7, 0, 0.49]}}
objects:
  - {{id: thing, {object}}}
target: thing
place: [{{id: tray, size: [0.2, 0.2], position: [0.7, 0.3, 0.5]}}]
"
    );
    let scene = Scene::from_text(Path::new("table.yaml"), &text).unwrap();
    let world = World::new(model.clone(), &scene);
    let presets = preset_grasps(&world, ObjectId(0), false);
    (world, presets)
}

/// The directions in which the hand points, by the object's axes.
fn forwards(presets: &Presets) -> Vec<Vec3> {
    presets.grasps.iter().map(|grasp| grasp.object_from_tool.rotation.z_axis).collect()
}

/// By how much a level direction is off the nearest axis, radians.
fn off_axis(forward: Vec3) -> f64 {
    let turn = forward.truncate().to_angle() / std::f64::consts::FRAC_PI_2;
    (turn - turn.round()).abs() * std::f64::consts::FRAC_PI_2
}

#[test]
fn boxes_are_held_by_their_sides_however_they_stand() {
    for robot in ["ur10_ag95", "panda", "pr2_left", "ur10_suction"] {
        let model = arm(robot);
        for (yaw, size) in
            [0.0, 0.1, 0.3, 0.785, 1.4].into_iter().flat_map(|yaw| [(yaw, "0.05, 0.06"), (yaw, "0.05, 0.05")])
        {
            let (_, presets) = presets(
                &model,
                &format!("box: {{size: [{size}, 0.14]}}, position: [0.7, 0, 0.57], rpy: [0, 0, {yaw}]"),
            );
            let forwards = forwards(&presets);
            let square = |f: &Vec3| off_axis(*f) < 0.02;
            assert!(!forwards.is_empty() && forwards.iter().all(square), "{robot}, {yaw}: {forwards:?}");
            // From all four sides.
            for side in [Vec3::X, -Vec3::X, Vec3::Y, -Vec3::Y] {
                assert!(forwards.iter().any(|f| f.dot(side) > 0.999), "{robot}, {yaw}: none along {side}");
            }
            assert!(presets.askew > 0, "{robot}, {yaw}");
        }
    }
}

#[test]
fn cylinders_are_held_from_all_round() {
    for robot in ["ur10_ag95", "panda", "pr2_left", "ur10_suction"] {
        let (world, presets) = presets(&arm(robot), "cylinder: {radius: 0.03, height: 0.14}, position: [0.7, 0, 0.57]");
        assert_eq!((presets.askew, presets.too_wide), (0, 0), "{robot}");
        assert_eq!(presets.grasps.len(), declared(&world, ObjectId(0)).len(), "{robot}");
    }
}

/// At 0.65 of its height a bottle's body just ends: the fingers would hold it by its shoulder.
#[test]
fn a_bottle_is_not_held_by_its_shoulder() {
    let bottle = "compound: [{cylinder: {radius: 0.033, height: 0.15}}, {cylinder: {radius: 0.0135, height: 0.08}, position: [0, 0, 0.115]}], position: [0.7, 0, 0.575]";
    let (_, presets) = presets(&arm("panda"), bottle);
    let heights: Vec<f64> = presets.grasps.iter().map(|g| g.object_from_tool.translation.z).collect();
    assert!(!heights.is_empty() && heights.iter().all(|z| *z < 0.065), "{heights:?}");
    assert!(presets.askew > 0);
}

/// Across two corners a flat box is narrower turned one way: the fingers turn it, whatever else they meet.
#[test]
fn flat_boxes_are_not_held_across_their_corners() {
    for (robot, size, yaw) in
        [("panda", "0.069, 0.031", -0.151), ("panda", "0.07, 0.035", 0.3), ("ur10_ag95", "0.07, 0.035", 0.3)]
    {
        let (_, presets) = presets(
            &arm(robot),
            &format!("box: {{size: [{size}, 0.12]}}, position: [0.7, 0, 0.56], rpy: [0, 0, {yaw}]"),
        );
        assert!(!presets.grasps.is_empty() && presets.grasps.iter().all(|grasp| grasp.firm));
        assert!(forwards(&presets).iter().all(|f| off_axis(*f) < 0.05), "{robot}: {:?}", forwards(&presets));
    }
}

/// What nearly fills the open hand is dragged along when it leaves.
#[test]
fn the_hand_has_to_open_a_little() {
    for (width, firm) in [(0.076, true), (0.079, false)] {
        let (_, presets) =
            presets(&arm("panda"), &format!("box: {{size: [{width}, {width}, 0.12]}}, position: [0.7, 0, 0.56]"));
        assert!(!presets.grasps.is_empty() && presets.grasps.iter().all(|grasp| grasp.firm == firm), "{width}");
    }
}

/// A box as deep as makes a difference, but for rounding: the grasps are the same whichever way it is turned.
#[test]
fn rounding_does_not_decide_how_many_grasps_there_are() {
    let count = |yaw: f64| {
        let thing = format!("box: {{size: [0.06, 0.06, 0.15]}}, position: [0.7, 0, 0.575], rpy: [0, 0, {yaw}]");
        declared(&presets(&arm("ur10_ag95"), &thing).0, ObjectId(0)).len()
    };
    for step in 1..40 {
        assert_eq!(count(0.7 + 0.0003 * f64::from(step)), count(0.7), "{step}");
    }
}

/// No hold is firm: better a loose one than none.
#[test]
fn what_cannot_be_held_firmly_is_held_all_the_same() {
    // Too wide for the hand both ways; a corner goes between the fingers.
    let wide = "box: {size: [0.1, 0.12, 0.14]}, position: [0.7, 0, 0.57]";
    let (world, presets) = presets(&arm("panda"), wide);
    assert!(presets.askew == 0 && presets.grasps.iter().all(|grasp| !grasp.firm));
    let holding = declared(&world, ObjectId(0)).iter().filter(|(_, grasp)| grasp.is_some()).count();
    assert!(!presets.grasps.is_empty() && presets.grasps.len() == holding);
}

/// A box stands cornerwise between walls that leave the hand one direction, or with room all round.
fn cornerwise(walls: f64) -> Scene {
    let text = format!(
        "\
format: clearway-scene/1
robot: {{model: ur10_suction, base: {{position: [0, 0, 0]}}}}
fixtures:
  - {{id: table, box: {{size: [0.6, 1.6, 0.02]}}, position: [0.8, 0, 0.49]}}
  - {{id: left, box: {{size: [0.4, 0.02, 0.3]}}, position: [0.8, {walls}, 0.65]}}
  - {{id: right, box: {{size: [0.4, 0.02, 0.3]}}, position: [0.8, -{walls}, 0.65]}}
objects:
  - {{id: thing, box: {{size: [0.05, 0.05, 0.14]}}, position: [0.8, 0, 0.57], rpy: [0, 0, 0.7853981634]}}
target: thing
place: [{{id: tray, size: [0.2, 0.2], position: [0.7, 0.6, 0.5]}}]
"
    );
    Scene::from_text(Path::new("between.yaml"), &text).unwrap()
}

#[test]
fn a_loose_hold_is_the_last_resort_and_is_told() {
    // In one session: what one scene needs, the next need not.
    let mut planner = Planner::with_model(cornerwise(0.4), arm("ur10_suction"), Settings::default()).unwrap();
    for (walls, loosely) in [(0.065, true), (0.4, false), (0.065, true)] {
        planner.update(SceneDelta::Scene(Box::new(cornerwise(walls)))).unwrap();
        let plan = planner.plan(&Request::new(0, Budget::unlimited().with_iterations(2000)), &mut Silent).plan;
        assert_eq!(plan.status, Status::Solved, "{walls}: {}", plan.why.summary);
        let reason = &plan.why.objects[0].reason;
        assert_eq!(reason.contains("not held firmly"), loosely, "{walls}: {reason}");
        assert_eq!(plan.why.objects[0].held_loosely, loosely);
    }
}

/// A symbolic planner is given them all, the firm ones first.
#[test]
fn handling_gives_firm_holds_first() {
    let mut handling = Handling::new(cornerwise(0.4), arm("ur10_suction"), Settings::default(), 0).unwrap();
    let firm: Vec<bool> =
        handling.grasps(ObjectId(0), &Budget::unlimited()).unwrap().iter().map(|grasp| grasp.firm).collect();
    assert!(firm.contains(&true) && firm.contains(&false) && firm.is_sorted_by(|a, b| a >= b), "{firm:?}");
}
