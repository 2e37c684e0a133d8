//! Lower bounds: their proofs hold, false ones are refused, and no plan goes below them.

mod judged;

use clearway::scenarios::{self, Wanted};
use clearway::{Budget, CollisionModel, PlanFile, Planner, Request, Robot, Scene, Settings, Silent};
use clearway_plan::SceneFile;
use clearway_plan::proof::GraspsProof;
use judged::found_wrong;
use serde_json::{Value, json};
use std::path::Path;
use std::sync::{Arc, OnceLock};
use std::time::Duration;

fn model() -> Arc<CollisionModel> {
    static MODEL: OnceLock<Arc<CollisionModel>> = OnceLock::new();
    let robot = || Robot::load("ur10_ag95", Path::new("."), &[]).expect("the built-in robot");
    MODEL.get_or_init(|| Arc::new(CollisionModel::new(Arc::new(robot())))).clone()
}

fn shelf(objects: usize, seed: u64) -> SceneFile {
    scenarios::shelf(&Wanted { objects, seed, least_removals: None }).expect("a scene").file
}

fn plan(file: SceneFile) -> PlanFile {
    let scene = Scene::from_file_struct(file, Path::new(".")).expect("a sound scene");
    let mut planner = Planner::with_model(scene, model(), Settings::default()).expect("a fit scene");
    let budget = Budget::unlimited().with_time(Duration::from_secs(60));
    planner.plan(&Request::new(1, budget), &mut Silent).plan
}

fn bound(plan: &PlanFile) -> usize {
    plan.lower_bound.as_ref().expect("a bound").removed
}

#[test]
fn proofs_hold() {
    let mut equal = 0;
    for (objects, seed) in [(8, 1), (12, 2), (12, 6), (16, 3), (20, 4)] {
        let plan = plan(shelf(objects, seed));
        assert!((1..=plan.removed.len()).contains(&bound(&plan)), "{objects} objects, seed {seed}");
        assert_eq!(found_wrong(&plan), [""; 0], "{objects} objects, seed {seed}");
        equal += usize::from(bound(&plan) == plan.removed.len());
    }
    assert!(equal >= 2, "{equal} of 5 proved to be the fewest");
}

/// With any one or two fewer objects gone than the bound says, the target cannot be had at once.
#[test]
fn no_plan_goes_below() {
    let mut tried = 0;
    for (objects, seed) in [(12, 2), (12, 3), (12, 4), (12, 6), (16, 10)] {
        let whole = shelf(objects, seed);
        let least = bound(&plan(whole.clone()));
        let others: Vec<&str> = whole.objects.iter().map(|o| o.id.as_str()).filter(|id| *id != whole.target).collect();
        // Of an order with fewer removals, all but the target are gone in one of these.
        let fewer: Vec<Vec<&str>> = match least {
            0 | 1 => continue,
            2 => vec![vec![]],
            3 => others.iter().map(|o| vec![*o]).collect(),
            _ => others.iter().enumerate().flat_map(|(i, a)| others[..i].iter().map(move |b| vec![*a, *b])).collect(),
        };
        for gone in fewer {
            let mut file = whole.clone();
            file.objects.retain(|o| !gone.contains(&o.id.as_str()));
            let plan = plan(file);
            assert_ne!(plan.removed.len(), 1, "{objects} objects, seed {seed}, without {gone:?}; the bound is {least}");
            tried += 1;
        }
    }
    assert!(tried > 30, "{tried}");
}

/// A plan whose bound is proved, and its proof.
fn proved() -> (PlanFile, GraspsProof) {
    let plan = plan(shelf(12, 4));
    let bound = plan.lower_bound.as_ref().expect("a bound");
    assert!(bound.kind == "grasps" && bound.removed == 3 && plan.removed.len() > 3, "{} {}", bound.kind, bound.removed);
    let proof = serde_json::from_value(bound.proof.clone()).expect("a proof");
    (plan, proof)
}

#[test]
fn false_proofs_are_refused() {
    let (plan, proof) = proved();
    let told = |proof: Value, removed: usize| {
        let mut plan = plan.clone();
        let bound = plan.lower_bound.as_mut().expect("a bound");
        (bound.proof, bound.removed) = (proof, removed);
        found_wrong(&plan).join("\n")
    };
    assert_eq!(told(json!(proof), 3), "");
    let change = |change: &dyn Fn(&mut GraspsProof)| {
        let mut proof = proof.clone();
        change(&mut proof);
        told(json!(proof), 3)
    };
    let target = proof.objects.iter().position(|o| o.object == plan.scene.target).expect("the target");
    let holding = |p: &GraspsProof, of: &dyn Fn(Option<&Vec<String>>) -> bool| {
        let mut all = p.objects[target]
            .grasps
            .iter()
            .enumerate()
            .flat_map(|(g, case)| (0..case.branches.len()).map(move |b| (g, b)));
        all.find(|&(g, b)| of(p.objects[target].grasps[g].branches[b].blocked_by.as_ref())).expect("such a branch")
    };
    let (g, b) = holding(&proof, &|by| by.is_some_and(|by| !by.is_empty()));
    let (fixed, _) = holding(&proof, &|by| by.is_none());
    type Fault<'a> = (&'a str, String, &'a str);
    let faults: [Fault; 10] = [
        ("one more", told(json!(proof), 4), "leaves open that 3 are enough"),
        ("no object", change(&|p| p.objects.clear()), "leaves open that 1 are enough"),
        ("a grasp less", change(&|p| drop(p.objects[target].grasps.pop())), "grasps are listed"),
        (
            "a branch less",
            change(&|p| drop(p.objects[target].grasps[fixed].branches.remove(0))),
            "a posture is missing",
        ),
        ("another grasp", change(&|p| p.objects[target].grasps[0].position[2] += 0.01), "not the declared one"),
        (
            "another posture",
            change(&|p| p.objects[target].grasps[g].branches[b].posture[3] += 0.01),
            "a posture is missing",
        ),
        ("no way", change(&|p| p.objects[target].grasps[g].branches[b].blocked_by = None), "for good"),
        (
            "blocked by all",
            change(&|p| {
                p.objects[target].grasps[g].branches[b].blocked_by =
                    Some(plan.scene.objects.iter().map(|o| o.id.clone()).filter(|o| *o != plan.scene.target).collect())
            }),
            "is not in the way of",
        ),
        ("does not hold", change(&|p| p.objects[target].grasps[g].holds = false), "may hold the object"),
        ("room that no plan keeps", change(&|p| p.clearance = 0.02), "more than plans keep"),
    ];
    for (fault, found, expected) in faults {
        assert!(found.contains(expected), "{fault}: {found}");
    }
    assert!(told(json!({"objects": "none"}), 3).contains("cannot be read"));
}
