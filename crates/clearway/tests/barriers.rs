//! Barriers: chains whose number is known, removals that a flood of the free space disproves or not, and
//! proofs with something wrong in them.

mod judged;

use clearway::{Budget, PlanFile, Planner, Request, Robot, Scene, Settings, Silent};
use clearway_plan::proof::{BarriersProof, GraspsProof};
use clearway_plan::scene_file::{Body, BoxKeys, CylinderKeys, FORMAT, PlaceArea, PoseKeys, RobotPlacement};
use clearway_plan::{ObjectId, ObjectSet, SceneFile};
use clearway_retrieval::barriers::Barriers;
use judged::found_wrong;
use rand::{RngExt, SeedableRng};
use rand_xoshiro::Xoshiro256PlusPlus;
use serde_json::{Value, json};
use std::collections::{HashSet, VecDeque};
use std::path::Path;
use std::sync::Arc;
use std::time::Duration;

/// Inside, metres.
const FRONT: f64 = 0.5;
const WIDTH: f64 = 0.5;
const FLOOR: f64 = 0.6;
const RADIUS: f64 = 0.035;
const TALL: f64 = 0.25;

fn body(id: &str, position: [f64; 3]) -> Body {
    Body { id: id.to_owned(), position, ..Body::default() }
}

fn cuboid(id: &str, size: [f64; 3], position: [f64; 3]) -> Body {
    Body { r#box: Some(BoxKeys { size }), ..body(id, position) }
}

fn cylinder(id: &str, radius: f64, height: f64, [x, y]: [f64; 2]) -> Body {
    Body { cylinder: Some(CylinderKeys { radius, height }), ..body(id, [x, y, FLOOR + height / 2.0]) }
}

/// A shelf, `height` and `depth` inside, with the target and others at these places.
fn shelf(height: f64, depth: f64, target: [f64; 2], others: &[[f64; 2]]) -> SceneFile {
    let (middle, side, half) = (FRONT + depth / 2.0, WIDTH / 2.0 + 0.01, FLOOR + height / 2.0);
    let fixtures = vec![
        cuboid("floor", [depth, WIDTH + 0.04, 0.02], [middle, 0.0, FLOOR - 0.01]),
        cuboid("top", [depth, WIDTH + 0.04, 0.02], [middle, 0.0, FLOOR + height + 0.01]),
        cuboid("left", [depth, 0.02, height], [middle, side, half]),
        cuboid("right", [depth, 0.02, height], [middle, -side, half]),
        cuboid("back", [0.02, WIDTH + 0.04, height + 0.04], [FRONT + depth + 0.01, 0.0, half]),
        cuboid("table", [0.54, 0.84, 0.03], [0.1, -0.82, 0.485]),
        cuboid("pedestal", [0.24, 0.24, 0.3], [0.0, 0.0, 0.15]),
    ];
    let mut objects: Vec<Body> =
        others.iter().enumerate().map(|(i, at)| cylinder(&format!("o{i}"), RADIUS, TALL, *at)).collect();
    objects.push(cylinder("target", RADIUS, TALL, target));
    SceneFile {
        format: FORMAT.to_owned(),
        name: String::new(),
        frame: "world".to_owned(),
        robot: RobotPlacement {
            model: "ur10_ag95".to_owned(),
            base: PoseKeys { position: [0.0, 0.0, 0.3], rpy: Some([0.0; 3]), quaternion: None },
            start: None,
            region: None,
        },
        fixtures,
        objects,
        target: "target".to_owned(),
        place: vec![PlaceArea { id: "tray".to_owned(), size: [0.5, 0.8], position: [0.1, -0.82, 0.5] }],
        workspace: None,
        exit: None,
        camera: None,
        weights: Default::default(),
        clearance: None,
        friction: None,
    }
}

/// Rows of `each` from wall to wall, the target behind them.
fn rows(count: usize, each: usize, height: f64) -> SceneFile {
    let x = |row: usize| FRONT + 0.05 + 0.12 * row as f64;
    let y = |i: usize| WIDTH * ((i as f64 + 0.5) / each as f64 - 0.5);
    let others: Vec<[f64; 2]> = (0..count).flat_map(|row| (0..each).map(move |i| [x(row), y(i)])).collect();
    shelf(height, 0.12 * count as f64 + 0.12, [x(count), 0.0], &others)
}

fn scene(file: SceneFile) -> Scene {
    Scene::from_file_struct(file, Path::new(".")).expect("a sound scene")
}

fn found(file: SceneFile) -> Barriers {
    Barriers::find(&scene(file), &Budget::unlimited()).expect("no limit")
}

#[test]
fn rows_from_wall_to_wall() {
    for count in 0..=4 {
        let barriers = found(rows(count, 5, 0.34));
        assert_eq!((barriers.bound(), barriers.sets.len()), (count + 1, count));
        assert!(barriers.sets.iter().all(|b| b.objects.len() == 5 && b.weight == 1.0));
    }
}

#[test]
fn what_can_be_passed_is_no_barrier() {
    let barred = |file: SceneFile| found(file).bound() > 1;
    assert!(barred(rows(1, 5, 0.34)));
    // Gaps wider than the target.
    assert!(!barred(rows(1, 3, 0.34)));
    // Room to lift it over.
    assert!(barred(rows(1, 5, 0.48)));
    assert!(!barred(rows(1, 5, 0.5)));
    let without = |id: &str| {
        let mut file = rows(1, 5, 0.34);
        file.fixtures.retain(|f| f.id != id);
        file
    };
    assert!(!barred(without("top")) && !barred(without("left")) && !barred(without("back")));
    // A place inside.
    let mut file = rows(1, 5, 0.34);
    file.place.push(PlaceArea { id: "inside".to_owned(), size: [0.1, 0.1], position: [FRONT + 0.05, 0.0, FLOOR] });
    assert!(!barred(file));
    // One too low to be in the way of what is lifted over it.
    let mut file = rows(1, 5, 0.34);
    file.objects[2] = cylinder("o2", RADIUS, 0.05, [FRONT + 0.05, 0.0]);
    assert!(!barred(file));
}

/// Whether a disc as large as the target gets from its place to the opening past the objects that are left:
/// a flood over a fine grid, which finds no way that is none.
fn gets_out(scene: &Scene, depth: f64, gone: ObjectSet) -> bool {
    const CELL: f64 = 0.002;
    let count = |length: f64| (length / CELL) as i64;
    let centre = |at: (i64, i64)| [FRONT + at.0 as f64 * CELL, -WIDTH / 2.0 + at.1 as f64 * CELL];
    let standing: Vec<[f64; 2]> = (0..scene.objects.len() as u16)
        .map(ObjectId)
        .filter(|o| *o != scene.target && !gone.contains(*o))
        .map(|o| scene.objects[o.index()].pose.translation.truncate().to_array())
        .collect();
    // From cell to cell nothing is passed by more than half a cell.
    let far = 2.0 * RADIUS + CELL * CELL / RADIUS;
    let free = |at: (i64, i64)| {
        let [x, y] = centre(at);
        y.abs() <= WIDTH / 2.0 - RADIUS
            && x <= FRONT + depth - RADIUS
            && standing.iter().all(|[a, b]| (a - x).hypot(b - y) >= far)
    };
    let at = scene.objects[scene.target.index()].pose.translation;
    let first = (count(at.x - FRONT), count(at.y + WIDTH / 2.0));
    let mut seen = HashSet::from([first]);
    let mut queue = VecDeque::from([first]);
    while let Some((i, j)) = queue.pop_front() {
        if i <= 0 {
            return true;
        }
        for next in [(i - 1, j), (i + 1, j), (i, j - 1), (i, j + 1)] {
            if free(next) && seen.insert(next) {
                queue.push_back(next);
            }
        }
    }
    false
}

/// Places without overlaps, the target's first, at the back.
fn random_places(random: &mut Xoshiro256PlusPlus, depth: f64, count: usize) -> Vec<[f64; 2]> {
    let mut places = vec![[FRONT + depth - RADIUS - 0.01, 0.0]];
    for _ in 0..20_000 {
        let mut between = |low: f64, high: f64| low + (high - low) * random.random::<f64>();
        let at = [between(FRONT + RADIUS, FRONT + depth - RADIUS), between(RADIUS - WIDTH / 2.0, WIDTH / 2.0 - RADIUS)];
        if places.len() <= count && places.iter().all(|p| (p[0] - at[0]).hypot(p[1] - at[1]) > 2.0 * RADIUS + 0.001) {
            places.push(at);
        }
    }
    places
}

/// All sets of `size` of the first `count` objects.
fn subsets(count: usize, size: usize) -> Vec<ObjectSet> {
    (0..1u32 << count)
        .filter(|bits| bits.count_ones() as usize == size)
        .map(|bits| (0..count as u16).filter(|i| bits >> i & 1 == 1).map(ObjectId).collect())
        .collect()
}

#[test]
fn floods_agree() {
    let mut random = Xoshiro256PlusPlus::seed_from_u64(5);
    let (depth, mut barred, mut equal, mut scenes) = (0.42, 0, 0, 0);
    while scenes < 60 {
        let places = random_places(&mut random, depth, 14);
        let scene = scene(shelf(0.34, depth, places[0], &places[1..]));
        let barriers = Barriers::find(&scene, &Budget::unlimited()).expect("no limit");
        let bound = barriers.bound();
        let others = scene.objects.len() - 1;
        let opened =
            |removed: usize| subsets(others, removed - 1).into_iter().any(|gone| gets_out(&scene, depth, gone));
        if bound > 1 {
            assert!(!opened(bound - 1), "{} do, {bound} are said to be needed: {places:?}", bound - 1);
            barred += 1;
        }
        equal += u32::from(opened(bound));
        scenes += 1;
    }
    assert!(barred > 20 && equal > 50, "{barred} barred, bound reached in {equal} of {scenes}");
}

fn planned(rows_before: usize) -> PlanFile {
    let robot = Robot::load("ur10_ag95", Path::new("."), &[]).expect("the built-in robot");
    let scene = scene(rows(rows_before, 5, 0.34));
    let mut planner = Planner::new(scene, Arc::new(robot), Settings::default()).expect("a fit scene");
    let budget = Budget::unlimited().with_time(Duration::from_secs(60));
    planner.plan(&Request::new(1, budget), &mut Silent).plan
}

#[test]
fn false_proofs_are_refused() {
    let mut plan = planned(1);
    let bound = plan.lower_bound.clone().expect("a bound");
    assert_eq!((bound.kind.as_str(), bound.removed, plan.removed.len()), ("geometric", 2, 2));
    let proof: BarriersProof = serde_json::from_value(bound.proof).expect("a proof");
    assert_eq!(found_wrong(&plan), [""; 0]);
    let mut told = |proof: Value| {
        plan.lower_bound.as_mut().expect("a bound").proof = proof;
        found_wrong(&plan).join("\n")
    };
    type Change<'a> = (&'a str, &'a dyn Fn(&mut BarriersProof), &'a str);
    let changes: [Change; 15] = [
        ("no barrier", &|p| p.barriers.clear(), "prove that 1 must be removed"),
        ("no enclosure", &|p| p.enclosure = None, "no enclosure"),
        ("half a barrier", &|p| p.barriers[0].weight = 0.5, ""),
        ("no weight", &|p| p.barriers[0].weight = 0.0, "prove that 1 must be removed"),
        ("too much weight", &|p| p.barriers[0].weight = 2.0, "not from 0 to 1"),
        ("twice the same", &|p| p.barriers.push(p.barriers[0].clone()), "add up to 2.0000"),
        ("a gap", &|p| drop(p.barriers[0].chain.remove(2)), "does not bar the way"),
        ("elsewhere", &|p| p.barriers[0].chain[2].to[0] += 0.08, "does not bar the way"),
        ("no body", &|p| p.barriers[0].chain[2].body = "o9".to_owned(), "no fixture and no other object"),
        ("the target", &|p| p.barriers[0].chain[2].body = "target".to_owned(), "no fixture and no other object"),
        ("other objects", &|p| drop(p.barriers[0].objects.pop()), "not those of its chain"),
        ("no ring", &|p| p.barriers[0].chain.truncate(2), "no closed line"),
        ("a stout target", &|p| p.enclosure.as_mut().expect("one").radius += 0.01, "holds no upright cylinder"),
        ("far from upright", &|p| p.enclosure.as_mut().expect("one").lean = 0.3, "may lean by"),
        ("a lower ceiling", &|p| p.enclosure.as_mut().expect("one").ceiling.z -= 0.05, "no face of \"top\""),
    ];
    for (fault, change, expected) in changes {
        let mut proof = proof.clone();
        change(&mut proof);
        let found = told(json!(proof));
        assert!(if expected.is_empty() { found.is_empty() } else { found.contains(expected) }, "{fault}: {found}");
    }
    assert!(told(json!({"barriers": 3})).contains("cannot be read"));
    // The target is lifted over a low row.
    for object in plan.scene.objects.iter_mut().filter(|o| o.id != "target") {
        let [x, y, _] = object.position;
        *object = cylinder(&object.id, RADIUS, 0.05, [x, y]);
    }
    plan.lower_bound.as_mut().expect("a bound").proof = json!(proof);
    assert!(found_wrong(&plan).iter().any(|v| v.contains("does not bar the way")));
}

/// Two rows: the hand needs more room than the target itself. Grasps and barriers prove it together.
#[test]
fn barriers_beside_the_grasps() {
    let mut plan = planned(2);
    let bound = plan.lower_bound.clone().expect("a bound");
    assert_eq!(bound.kind, "grasps");
    assert!(bound.removed > 3 && bound.removed <= plan.removed.len(), "{} {:?}", bound.removed, plan.removed);
    assert_eq!(found_wrong(&plan), [""; 0]);
    let mut proof: GraspsProof = serde_json::from_value(bound.proof).expect("a proof");
    let barriers = proof.barriers.as_mut().expect("barriers");
    assert_eq!(barriers.barriers.len(), 2);
    barriers.barriers[0].chain[0].to[1] += 0.1;
    plan.lower_bound.as_mut().expect("a bound").proof = json!(proof);
    let told = found_wrong(&plan).join("\n");
    assert!(told.contains("barrier 0"), "{told}");
}
