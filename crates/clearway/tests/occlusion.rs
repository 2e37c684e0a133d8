//! Hidden objects: retrievals with a simulated camera, dialogues, and plans that take what they cannot know.

mod program;

use clearway::scenarios::{self, Wanted};
use clearway::{
    Budget, CollisionModel, LookRule, Outcome, PlanFile, Request, Robot, Scene, Settings, Silent, solve_observed,
    verify,
};
use clearway_geometry::{Pose, Vec3};
use clearway_plan::SceneFile;
use clearway_retrieval::occlusion::simulated::SimulatedCamera;
use clearway_retrieval::occlusion::{Dialogue, Notice, Observation, Turn};
use clearway_sight::View;
use program::Program;
use std::path::Path;
use std::sync::{Arc, OnceLock};
use std::time::Duration;

fn model() -> Arc<CollisionModel> {
    static MODEL: OnceLock<Arc<CollisionModel>> = OnceLock::new();
    let robot = || Robot::load("ur10_suction", Path::new("."), &[]).expect("the built-in robot");
    MODEL.get_or_init(|| Arc::new(CollisionModel::new(Arc::new(robot())))).clone()
}

fn scene(objects: usize, seed: u64) -> SceneFile {
    scenarios::occluded(&Wanted { objects, seed, least_removals: None }).expect("a scene").file
}

fn sound(file: SceneFile) -> Scene {
    Scene::from_file_struct(file, Path::new(".")).expect("a sound scene")
}

fn request() -> Request {
    Request::new(1, Budget::unlimited().with_time(Duration::from_secs(120)))
}

fn solved(file: SceneFile, rule: LookRule) -> PlanFile {
    match solve_observed(sound(file), model(), Settings::default(), rule, &request(), Path::new("."), &mut Silent)
        .expect("a fit scene")
    {
        Outcome::Solved(plan) => plan.into_inner(),
        other => panic!("{other:?}"),
    }
}

#[test]
fn found_and_taken_by_every_rule() {
    for (objects, seed) in [(5, 1), (12, 2)] {
        let file = scene(objects, seed);
        for rule in LookRule::ALL {
            let plan = solved(file.clone(), rule);
            assert_eq!(plan.removed.last(), Some(&file.target), "{rule:?}");
            assert_eq!(plan.known.len(), plan.steps.len());
            assert!(!plan.known[0].seen.contains(&file.target), "the target is hidden at first");
            // Nothing is taken that was not seen, and what was seen stays so.
            for (known, step) in plan.known.iter().zip(&plan.steps) {
                assert!(known.seen.contains(&step.object));
            }
            assert!(plan.known.windows(2).all(|w| w[0].seen.iter().all(|o| w[1].seen.contains(o))));
        }
    }
}

#[test]
fn the_same_seed_looks_the_same_way() {
    let file = scene(8, 3);
    let strip = |mut plan: PlanFile| {
        plan.timing = Default::default();
        plan.known.iter_mut().for_each(|k| k.planning = 0.0);
        serde_json::to_string(&plan).expect("JSON")
    };
    assert_eq!(strip(solved(file.clone(), LookRule::Expected)), strip(solved(file, LookRule::Expected)));
}

fn found_wrong(plan: &PlanFile) -> String {
    let report = verify(plan, Path::new("."), &Budget::unlimited()).expect("a judgement");
    report.violations.iter().map(|v| v.to_string()).chain(report.not_checked).collect::<Vec<_>>().join("\n")
}

#[test]
fn claims_about_what_was_seen_are_judged() {
    let plan = solved(scene(8, 1), LookRule::Expected);
    assert_eq!(found_wrong(&plan), "");
    let with = |change: &dyn Fn(&mut PlanFile)| {
        let mut plan = plan.clone();
        change(&mut plan);
        found_wrong(&plan)
    };
    let target = plan.scene.target.clone();
    let told = with(&|p| p.known[0].seen.push(target.clone()));
    assert!(told.contains("but only 0 % of it was in view") || told.contains("% of it was in view"), "{told}");
    let first = plan.steps[0].object.clone();
    let told = with(&|p| p.known[0].seen.retain(|o| *o != first));
    assert!(told.contains("which was not known"), "{told}");
    assert!(with(&|p| drop(p.known.pop())).contains("entries for"));
    assert!(with(&|p| p.known.clear()).contains("as if all was"));
    assert!(with(&|p| p.scene.camera = None).contains("no camera"));
    // Through a peephole.
    let told = with(&|p| p.scene.camera.as_mut().expect("a camera").fov = 0.2);
    assert!(told.contains("not seen"), "{told}");
}

/// A plan made with everything known moves through space that a camera does not see.
#[test]
fn motions_through_hidden_space_are_found() {
    let mut moved = 0;
    for seed in 1..=4 {
        let mut file = scene(8, seed);
        let camera = file.camera.take();
        let mut planner =
            clearway::Planner::with_model(sound(file), model(), Settings::default()).expect("a fit scene");
        let mut plan = planner.plan(&request(), &mut Silent).plan;
        plan.scene.camera = camera;
        let all: Vec<String> = plan.scene.objects.iter().map(|o| o.id.clone()).collect();
        plan.known = (0..plan.steps.len())
            .map(|step| clearway_plan::plan_file::Known { step, seen: all.clone(), ..Default::default() })
            .collect();
        let told = found_wrong(&plan);
        assert!(told.contains("was in view"), "{told}");
        moved += usize::from(told.contains("which was not in view before"));
    }
    assert!(moved > 0);
    // A scene may allow it.
    let mut file = scene(8, 1);
    file.camera.as_mut().expect("a camera").enter_unseen = true;
    assert_eq!(found_wrong(&solved(file, LookRule::Expected)), "");
}

/// A camera and a dialogue about one scene, and the camera's first look.
fn begun(file: SceneFile) -> (Dialogue, SimulatedCamera, Observation) {
    let scene = sound(file);
    let view = View::new(scene.file.camera.as_ref().expect("a camera"));
    let mut camera = SimulatedCamera::new(scene.clone(), view.clone());
    let dialogue = Dialogue::new(&scene, view, camera.region, model(), Settings::default(), LookRule::Expected);
    let look = camera.look();
    (dialogue, camera, look)
}

#[test]
fn what_contradicts_is_taken_in() {
    let (mut dialogue, _, look) = begun(scene(8, 2));
    let notices = dialogue.observe(look.clone());
    let new: Vec<String> = look.objects.iter().map(|o| o.id.clone()).collect();
    assert!(new.len() >= 2, "{new:?}");
    assert_eq!(notices, new.iter().cloned().map(Notice::New).collect::<Vec<_>>());
    // The same again is nothing new; a little elsewhere it has moved; gone it is told once.
    assert_eq!(dialogue.observe(look.clone()), []);
    let mut other = look.clone();
    other.objects[0].pose = Pose::from_translation(other.objects[0].pose.translation + Vec3::new(0.0, 0.01, 0.0));
    assert_eq!(dialogue.observe(other), [Notice::Moved(new[0].clone())]);
    let gone = Observation { objects: Vec::new(), gone: vec![new[1].clone()], hidden: look.hidden.clone() };
    assert_eq!(dialogue.observe(gone.clone()), [Notice::Gone(new[1].clone())]);
    assert_eq!(dialogue.observe(gone), []);
    assert!(!dialogue.seen().contains(&new[1]));
    // It goes on with what is left.
    match dialogue.next(&request(), &mut Silent).expect("a fit scene") {
        Turn::Act(action) => assert_ne!(action.object, new[1]),
        Turn::End(plan, _) => panic!("{}", plan.why.summary),
    }
}

#[test]
fn a_target_that_is_nowhere() {
    let program = Program::new();
    let mut file = scene(4, 1);
    // Far from what the camera can see, on a table of its own.
    let target = file.objects.iter().position(|o| o.id == file.target).expect("the target");
    let table = file.fixtures.iter().find(|f| f.id == "table").expect("a table").clone();
    let mut far = table.clone();
    (far.id, far.position[0]) = ("far".to_owned(), -2.0);
    let height = file.objects[target].cylinder.as_ref().expect("a cylinder").height;
    let top = far.position[2] + far.r#box.as_ref().expect("a box").size[2] / 2.0;
    file.objects[target].position = [-2.0, far.position[1], top + height / 2.0];
    file.fixtures.push(far);
    program.write("scene.yaml", &serde_json::to_string(&file).expect("JSON"));
    let done = program.run("plan scene.yaml -o plan.json");
    assert_eq!(done.code, Some(3), "{}{}", done.out, done.err);
    assert!(done.err.contains("was not found: every reachable volume was seen"), "{}", done.err);
}

/// A hand that closes round things in a shelf drawn without regard to the camera; where that may be, through unseen space.
#[test]
fn a_parallel_hand_among_neighbours() {
    let file = |enter_unseen: bool| {
        let mut file =
            scenarios::shelf(&Wanted { objects: 12, seed: 2, least_removals: Some(2) }).expect("a scene").file;
        let [position, look_at] = [[-0.15, 0.0, 1.0], [0.85, 0.0, 0.75]];
        file.camera = Some(clearway_plan::scene_file::Camera { position, look_at, fov: 1.5, enter_unseen });
        file
    };
    let robot = Robot::load("ur10_ag95", Path::new("."), &[]).expect("the built-in robot");
    let model = Arc::new(CollisionModel::new(Arc::new(robot)));
    for enter_unseen in [false, true] {
        let outcome = solve_observed(
            sound(file(enter_unseen)),
            model.clone(),
            Settings::default(),
            LookRule::Expected,
            &request(),
            Path::new("."),
            &mut Silent,
        );
        assert!(matches!(outcome, Ok(Outcome::Solved(_))), "{outcome:?}");
    }
}

#[test]
fn cameras_that_see_nothing() {
    let program = Program::new();
    let file = scene(4, 1);
    let written = |change: &dyn Fn(&mut SceneFile)| {
        let mut file = file.clone();
        change(&mut file);
        program.write("scene.yaml", &serde_json::to_string(&file).expect("JSON"));
        let done = program.run("plan scene.yaml");
        assert_eq!(done.code, Some(2), "{}{}", done.out, done.err);
        done.err
    };
    let inside = written(&|f| f.camera.as_mut().expect("a camera").position = f.objects[0].position);
    assert!(inside.contains("the camera is inside `") && inside.contains("scene.yaml:1"), "{inside}");
    let away = written(&|f| f.camera.as_mut().expect("a camera").look_at = [-5.0, 0.0, 1.0]);
    assert!(away.contains("looks away"), "{away}");
}
