//! Plans that are right, and plans that go wrong.

mod gantry;

use clearway_plan::{Budget, Stop};
use clearway_simulate::{CannotSimulate, Noise, Settings, ThingKind, simulate, trials};
use gantry::{pick, played};
use serde_json::json;
use std::sync::Arc;
use std::sync::atomic::AtomicBool;

#[test]
fn a_plan_that_is_right_ends_as_planned() {
    for mass in [None, Some(0.05), Some(2.0)] {
        let mut plan = pick(Vec::new());
        plan.scene.objects[0].mass = mass;
        let outcome = played(&plan, &Settings::default());
        assert!(outcome.as_planned && !outcome.touched, "{mass:?}: {outcome}");
        assert!(outcome.touches.is_empty(), "{mass:?}: {outcome}");
        assert!(outcome.holds[0].slipped < 1e-3, "{mass:?}: {:?}", outcome.holds);
        assert_eq!(outcome.ends[0].assumed.mass, mass.is_none());
    }
}

/// A planner fills in what the scene leaves out, and says so.
#[test]
fn what_was_filled_in_is_told() {
    let mut plan = pick(Vec::new());
    for object in &mut plan.scene.objects {
        (object.mass, object.friction) = (Some(0.2), Some(0.4));
    }
    assert!(!played(&plan, &Settings::default()).to_string().contains("assumed"));
    plan.assumed.mass = vec!["o".to_owned()];
    plan.assumed.friction = plan.scene.objects.iter().map(|o| o.id.clone()).collect();
    let outcome = played(&plan, &Settings::default()).to_string();
    assert!(outcome.contains("assumed: 500 kg/m³ for o\n"), "{outcome}");
    assert!(outcome.contains("assumed: friction 0.4 for all objects"), "{outcome}");
}

#[test]
fn without_friction_it_stays_behind() {
    let mut plan = pick(Vec::new());
    plan.scene.friction = Some(0.005);
    let outcome = played(&plan, &Settings { rubber: 0.0, ..Settings::default() });
    let end = outcome.end("o").expect("an object");
    assert!(!outcome.as_planned && end.elsewhere, "{outcome}");
}

#[test]
fn what_is_in_the_way_is_told() {
    let wall = json!({"id": "wall", "box": {"size": [0.02, 0.5, 0.2]}, "position": [0.65, 0, 0.72]});
    let outcome = played(&pick(vec![wall]), &Settings::default());
    assert!(outcome.touched, "{outcome}");
    let touch = outcome.touches.iter().find(|t| t.first.id == "wall" || t.second.id == "wall").expect("a touch");
    assert!(touch.by_robot() && (2.1..2.8).contains(&touch.time), "{touch}");
    assert!(outcome.to_string().contains("wall"), "{outcome}");
}

#[test]
fn an_object_that_is_nudged_is_told() {
    let mut plan = pick(Vec::new());
    plan.scene.objects[1].position[0] = 0.8;
    let outcome = played(&plan, &Settings::default());
    assert!(outcome.touches.iter().any(|t| t.by_robot() && t.second.id == "other"), "{outcome}");
    assert!(outcome.touches.iter().any(|t| t.first.kind == ThingKind::Link || t.second.kind == ThingKind::Held));
}

#[test]
fn trials_are_the_same_whatever_the_threads() {
    let plan = pick(Vec::new());
    let noise = Noise { position: 0.002, friction: 0.2, radius: 0.001 };
    let run = |seed, threads| {
        trials(&plan, "".as_ref(), &Settings::default(), &noise, (3, seed), &Budget::unlimited().with_threads(threads))
            .expect("trials")
    };
    let (one, two) = (run(5, 1), run(5, 2));
    assert_eq!(one, two);
    assert_eq!(one.as_planned, 3, "{one}");
    assert_ne!(one.trials[0].outcome.ends, run(6, 1).trials[0].outcome.ends);
    assert_ne!(one.trials[0].outcome.ends, one.trials[1].outcome.ends);
}

#[test]
fn what_makes_no_sense_is_refused() {
    let plan = pick(Vec::new());
    let budget = Budget::unlimited();
    let refused = |noise: Noise, count: usize| {
        trials(&plan, "".as_ref(), &Settings::default(), &noise, (count, 1), &budget).expect_err("refused").to_string()
    };
    assert!(refused(Noise { position: -0.1, ..Noise::default() }, 1).contains("noise"));
    assert!(refused(Noise::default(), 0).contains("trials"));
    let mut unsolved = plan.clone();
    unsolved.steps.clear();
    let error = simulate(&unsolved, "".as_ref(), &Settings::default(), &budget).expect_err("nothing to play");
    assert!(error.to_string().contains("0 steps"), "{error}");
    let cancelled = budget.with_cancel(Arc::new(AtomicBool::new(true)));
    let stopped = simulate(&plan, "".as_ref(), &Settings::default(), &cancelled);
    assert!(matches!(stopped, Err(CannotSimulate::Stopped(Stop::Cancelled))));
}
