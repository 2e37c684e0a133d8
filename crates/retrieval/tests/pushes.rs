//! Pushing an object aside: only what slides straight, no higher than it tips, to where it is in nobody's way.
#![allow(clippy::unwrap_used)]

use clearway_plan::event::Silent;
use clearway_plan::plan_file::{Action, PlanFile, SegmentKind, Status};
use clearway_plan::{Budget, SceneFile};
use clearway_retrieval::push::{GRAVITY, Pushes};
use clearway_retrieval::{Planner, Request, Settings};
use clearway_robot::Robot;
use clearway_scene::Scene;
use std::path::Path;
use std::sync::Arc;

/// A target at the end of a narrow bay, and one object before it, where there is room; `blocker` is that object's shape and what else is to be said of it.
fn scene(blocker: &str, others: &str) -> String {
    format!(
        "\
format: clearway-scene/1
robot: {{model: ur10_ag95, base: {{position: [0, 0, 0.3]}}}}
fixtures:
  - {{id: floor, box: {{size: [0.6, 1.0, 0.02]}}, position: [0.9, 0, 0.59]}}
  - {{id: top, box: {{size: [0.6, 1.0, 0.02]}}, position: [0.9, 0, 1.11]}}
  - {{id: left, box: {{size: [0.6, 0.02, 0.5]}}, position: [0.9, 0.5, 0.85]}}
  - {{id: right, box: {{size: [0.6, 0.02, 0.5]}}, position: [0.9, -0.5, 0.85]}}
  - {{id: back, box: {{size: [0.02, 1.0, 0.5]}}, position: [1.21, 0, 0.85]}}
  - {{id: table, box: {{size: [0.54, 0.84, 0.03]}}, position: [0.1, -0.82, 0.485]}}
  - {{id: bay_left, box: {{size: [0.34, 0.01, 0.3]}}, position: [1.03, 0.09, 0.75]}}
  - {{id: bay_right, box: {{size: [0.34, 0.01, 0.3]}}, position: [1.03, -0.09, 0.75]}}
{others}
objects:
  - {{id: blocker, {blocker}, position: [0.75, 0.0, 0.72]}}
  - {{id: wanted, cylinder: {{radius: 0.035, height: 0.24}}, position: [0.98, 0.0, 0.72]}}
  - {{id: beside, cylinder: {{radius: 0.035, height: 0.24}}, position: [0.75, 0.35, 0.72]}}
  - {{id: other, cylinder: {{radius: 0.035, height: 0.24}}, position: [0.75, -0.35, 0.72]}}
target: wanted
place: [{{id: tray, size: [0.5, 0.8], position: [0.1, -0.82, 0.5]}}]
"
    )
}

fn plan_with(text: &str, when: Pushes, change: impl FnOnce(&mut SceneFile)) -> PlanFile {
    let mut file = Scene::from_text(Path::new("bay.yaml"), text).unwrap().file;
    change(&mut file);
    let scene = Scene::from_file_struct(file, Path::new(".")).unwrap();
    let robot = Arc::new(Robot::load("ur10_ag95", Path::new("."), &[]).unwrap());
    let mut settings = Settings::default();
    settings.push.when = when;
    let mut planner = Planner::new(scene, robot, settings).unwrap();
    let plan = planner.plan(&Request::new(1, Budget::unlimited().with_iterations(20_000)), &mut Silent).plan;
    assert_eq!(plan.status, Status::Solved);
    plan
}

fn plan(blocker: &str, when: Pushes) -> PlanFile {
    plan_with(&scene(blocker, ""), when, |_| ())
}

const CAN: &str = "cylinder: {radius: 0.037, height: 0.24}";

fn why_not(plan: &PlanFile, object: &str) -> String {
    assert!(plan.steps.iter().all(|s| s.action == Action::PickPlace));
    plan.why.objects.iter().find(|o| o.object == object).unwrap().push.clone()
}

#[test]
fn a_can_is_pushed_aside() {
    let plan = plan(CAN, Pushes::Prefer);
    let step = &plan.steps[0];
    assert_eq!((step.object.as_str(), step.action), ("blocker", Action::Push));
    let push = step.push.as_ref().unwrap();
    // Level, straight, as far as it says, and lower than it tips: r / µ.
    assert!(push.direction[2].abs() < 1e-9);
    let start = [0.75, 0.0, 0.72];
    for axis in 0..3 {
        assert!((start[axis] + push.distance * push.direction[axis] - step.placed.position[axis]).abs() < 1e-9);
    }
    assert!((push.tips_at - 0.037 / 0.4).abs() < 1e-9);
    assert!(push.height < push.tips_at);
    let kinds: Vec<SegmentKind> = step.segments.iter().map(|s| s.kind).collect();
    assert!(kinds.windows(2).any(|k| k == [SegmentKind::Approach, SegmentKind::Push]));
    assert!(step.segments.iter().all(|s| s.attached.is_none()));
    assert_eq!(plan.removed, ["blocker", "wanted"]);
}

/// The hand brakes so gently that the object, which friction alone would stop, stays before it.
#[test]
fn the_hand_brakes_less_than_friction_does() {
    let plan = plan(CAN, Pushes::Prefer);
    let robot = Robot::load("ur10_ag95", Path::new("."), &[]).unwrap();
    let kinematics = clearway_collision::CollisionModel::new(Arc::new(robot)).kinematics;
    let segment = plan.steps[0].segments.iter().find(|s| s.kind == SegmentKind::Push).unwrap();
    let at: Vec<_> = segment.positions.iter().map(|q| kinematics.tool(q, 0.0)).collect();
    let way: Vec<f64> = at.iter().map(|p| p.translation.distance(at[0].translation)).collect();
    let speed: Vec<f64> =
        way.windows(2).zip(segment.times.windows(2)).map(|(w, t)| (w[1] - w[0]) / (t[1] - t[0])).collect();
    let braking =
        speed.windows(2).zip(segment.times.windows(2)).map(|(v, t)| (v[0] - v[1]) / (t[1] - t[0])).fold(0.0, f64::max);
    assert!(braking < 0.6 * 0.4 * GRAVITY, "{braking}");
    assert!(speed.iter().all(|v| *v < 0.26));
    // The tool neither turns nor leaves the line.
    let (first, last) = (at[0], at[at.len() - 1]);
    let along = (last.translation - first.translation).normalize();
    for pose in &at {
        assert!(pose.angle_to(&first) < 1e-3);
        assert!((pose.translation - first.translation).reject_from(along).length() < 5e-4);
    }
}

#[test]
fn pushes_are_left_out_when_asked() {
    assert_eq!(why_not(&plan(CAN, Pushes::Never), "blocker"), "");
}

#[test]
fn a_push_is_chosen_where_it_takes_less_time() {
    let (picked, chosen) = (plan(CAN, Pushes::Never), plan(CAN, Pushes::Choose));
    assert!(chosen.steps[0].duration() <= picked.steps[0].duration());
}

#[test]
fn boxes_and_balls_are_not_pushed() {
    let told = why_not(&plan("box: {size: [0.06, 0.06, 0.24]}", Pushes::Prefer), "blocker");
    assert_eq!(told, "picked: it is no upright cylinder: pushed, it may turn aside");
}

/// At µ = 2 a can of 37 mm tips when it is pushed higher than 18 mm.
#[test]
fn what_would_tip_is_not_pushed() {
    let told = why_not(&plan(&format!("{CAN}, friction: 2.0"), Pushes::Prefer), "blocker");
    assert_eq!(told, "picked: the hand does not get low enough: pushed higher, it would tip");
}

/// The board ends 0.19 m beside the object: with its foot over the edge it would tip sooner.
#[test]
fn nothing_is_pushed_over_an_edge() {
    let alone = |text: String| {
        text.lines().filter(|l| !l.contains("id: beside") && !l.contains("id: other")).collect::<Vec<_>>().join("\n")
    };
    let narrow = |width: f64| {
        alone(scene(CAN, "")).replace(
            "{id: floor, box: {size: [0.6, 1.0, 0.02]}",
            &format!("{{id: floor, box: {{size: [0.6, {width}, 0.02]}}"),
        )
    };
    let mut pushed = 0;
    for width in [0.30, 0.34, 0.38, 0.42, 0.5] {
        let plan = plan_with(&narrow(width), Pushes::Prefer, |_| ());
        let step = &plan.steps[0];
        if step.action == Action::Push {
            pushed += 1;
            let [x, y, _] = step.placed.position;
            assert!(y.abs() + 0.037 * 0.97 <= width / 2.0 + 1e-6 && x - 0.037 * 0.97 >= 0.6, "{width}: {x}, {y}");
        }
    }
    assert!(pushed >= 2, "{pushed}");
}

#[test]
fn what_carries_something_is_not_pushed() {
    let text = scene(CAN, "").replace(
        "target: wanted",
        "  - {id: lid, cylinder: {radius: 0.03, height: 0.05}, position: [0.75, 0.0, 0.865]}\ntarget: wanted",
    );
    let told = plan_with(&text, Pushes::Prefer, |_| ());
    assert!(
        told.why
            .objects
            .iter()
            .any(|o| o.object == "blocker" && o.push.contains("it stands on another object or carries one"))
    );
}

/// Between posts there is no room to push it to.
#[test]
fn without_room_it_is_picked() {
    let posts = [
        "  - {id: post_left, box: {size: [0.02, 0.02, 0.05]}, position: [0.75, 0.06, 0.625]}",
        "  - {id: post_right, box: {size: [0.02, 0.02, 0.05]}, position: [0.75, -0.06, 0.625]}",
        "  - {id: post_behind, box: {size: [0.02, 0.06, 0.02]}, position: [0.815, 0.0, 0.61]}",
    ]
    .join("\n");
    let told = why_not(&plan_with(&scene(CAN, &posts), Pushes::Prefer, |_| ()), "blocker");
    assert!(told.starts_with("picked: "), "{told}");
    assert!(
        told.contains("no room to push it") || told.contains("would tip") || told.contains("does not get round"),
        "{told}"
    );
}

/// What is pushed aside keeps the scene's clearance and the margin of error from everything on its way.
#[test]
fn what_is_pushed_keeps_its_distance() {
    let plan = plan_with(&scene(CAN, ""), Pushes::Prefer, |file| file.clearance = Some(0.005));
    let Some(push) = &plan.steps[0].push else { panic!("not pushed: {}", plan.why.objects[0].push) };
    for (x, y) in [(0.98, 0.0), (0.75, 0.35), (0.75, -0.35)] {
        for i in 0..=100 {
            let d = push.distance * f64::from(i) / 100.0;
            let at = [0.75 + d * push.direction[0], d * push.direction[1]];
            let gap = (at[0] - x).hypot(at[1] - y) - 0.037 - 0.035;
            assert!(gap > 0.0099, "{gap}");
        }
    }
}
