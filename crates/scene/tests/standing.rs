//! Objects that stand elsewhere: what would carry them, and whether they would stay.
#![allow(clippy::unwrap_used)]

use clearway_geometry::{Pose, Vec3};
use clearway_plan::{ObjectId, ObjectSet};
use clearway_scene::{Scene, Support};
use proptest::prelude::*;
use std::path::Path;

/// On a table 1 m wide about the origin, its top at 0.
fn read(objects: &[String]) -> Result<Scene, clearway_files::FileError> {
    let list: String = objects.iter().enumerate().map(|(i, o)| format!("  - {{id: o{i}, {o}}}\n")).collect();
    let text = format!(
        "format: clearway-scene/1\nrobot: {{model: ur10_ag95}}\nfixtures:\n  - {{id: table, box: {{size: [1, 1, 0.02]}}, position: [0, 0, -0.01]}}\nobjects:\n{list}target: o0\n"
    );
    Scene::from_text(Path::new("stack.yaml"), &text)
}

fn scene(objects: &[String]) -> Scene {
    read(objects).unwrap_or_else(|error| panic!("{error}"))
}

fn cuboid(size: [f64; 3], position: [f64; 3]) -> String {
    format!("box: {{size: {size:?}}}, position: {position:?}")
}

fn set(ids: &[u16]) -> ObjectSet {
    ids.iter().map(|i| ObjectId(*i)).collect()
}

fn at(x: f64, y: f64, z: f64) -> Pose {
    Pose::from_translation(Vec3::new(x, y, z))
}

/// 0 and 1 are posts, 2 a board on them, 3 a load on the board, 4 stands apart.
fn table() -> Scene {
    scene(&[
        cuboid([0.04, 0.04, 0.2], [-0.1, 0.0, 0.1]),
        cuboid([0.04, 0.04, 0.2], [0.1, 0.0, 0.1]),
        cuboid([0.4, 0.1, 0.02], [0.0, 0.0, 0.21]),
        cuboid([0.04, 0.04, 0.1], [0.0, 0.0, 0.27]),
        cuboid([0.1, 0.1, 0.1], [0.3, 0.3, 0.05]),
    ])
}

#[test]
fn what_rests_on_what() {
    let scene = table();
    assert_eq!(scene.loads(ObjectId(0)), set(&[2]));
    assert_eq!(scene.loads(ObjectId(2)), set(&[3]));
    assert_eq!(scene.loads(ObjectId(3)), ObjectSet::EMPTY);
}

#[test]
fn a_moved_object_changes_what_carries_it_and_others() {
    let scene = table();
    // The load to the block, the block elsewhere, the board away from above.
    let there = scene.moved(ObjectId(3), at(0.3, 0.3, 0.15));
    assert_eq!(there.objects[3].support, Support::Objects(vec![ObjectId(4)]));
    assert_eq!((there.loads(ObjectId(2)), there.loads(ObjectId(4))), (ObjectSet::EMPTY, set(&[3])));
    assert_eq!(there.objects[3].pose, at(0.3, 0.3, 0.15));
    let there = there.moved(ObjectId(4), at(-0.3, 0.3, 0.05));
    assert_eq!(there.objects[3].support, Support::Objects(Vec::new()));
    assert_eq!(there.objects[4].support, Support::Fixture(0));
    // A post taken away leaves the other; put back, both.
    let without = scene.moved(ObjectId(1), at(0.3, -0.3, 0.1));
    assert_eq!(without.objects[2].support, Support::Objects(vec![ObjectId(0)]));
    let again = without.moved(ObjectId(1), scene.objects[1].pose);
    for (a, b) in again.objects.iter().zip(&scene.objects) {
        assert_eq!((a.pose, &a.support), (b.pose, &b.support));
    }
    // In the air.
    assert_eq!(scene.moved(ObjectId(0), at(0.0, 0.0, 3.0)).objects[0].support, Support::Objects(Vec::new()));
}

#[test]
fn where_an_object_would_stay() {
    let scene = table();
    let stands = |object: u16, pose: Pose, standing: &[u16]| scene.stands(ObjectId(object), &pose, set(standing));
    for i in 0..5 {
        assert!(scene.stands(ObjectId(i), &scene.objects[usize::from(i)].pose, scene.all()), "{i}");
    }
    // On the table, up to its edge and not beyond; not in the air, not sunk.
    assert!(stands(4, at(0.2, -0.3, 0.05), &[]));
    assert!(stands(4, at(0.4999, -0.3, 0.05), &[]));
    assert!(!stands(4, at(0.5002, -0.3, 0.05), &[]));
    assert!(stands(4, at(0.2, -0.3, 0.05009), &[]) && stands(4, at(0.2, -0.3, 0.04991), &[]));
    assert!(!stands(4, at(0.2, -0.3, 0.0502), &[]) && !stands(4, at(0.2, -0.3, 0.0498), &[]));
    // The board needs both its posts, or one in the middle.
    let board = scene.objects[2].pose;
    assert!(stands(2, board, &[0, 1]) && !stands(2, board, &[0]) && !stands(2, board, &[]));
    assert!(stands(2, at(0.1, 0.0, 0.21), &[1]));
    // And with its load too: at the end it would tip.
    assert!(stands(3, at(0.1, 0.0, 0.27), &[0, 1, 2]));
    assert!(stands(4, at(0.12, 0.0, 0.27), &[0, 1, 2]) && !stands(4, at(0.3, 0.0, 0.27), &[0, 1, 2]));
    // What tips under a load elsewhere on the same board counts; what does not hang together with it does not.
    let loaded = scene.moved(ObjectId(3), at(-0.17, 0.0, 0.27));
    assert!(loaded.stands(ObjectId(2), &board, set(&[0, 1, 3])) && !loaded.stands(ObjectId(2), &board, set(&[1, 3])));
    assert!(stands(4, at(0.3, 0.3, 0.05), &[2, 3]));
    // Under the board, as a third post.
    let short = scene.moved(ObjectId(1), at(0.3, -0.3, 0.1));
    assert!(
        !short.stands(ObjectId(2), &board, set(&[0])) && short.stands(ObjectId(1), &at(0.05, 0.0, 0.1), set(&[0, 2]))
    );
}

#[test]
fn a_counterweight_taken_away() {
    let scene = scene(&[
        cuboid([0.1, 0.1, 0.1], [0.0, 0.0, 0.05]),
        cuboid([0.4, 0.1, 0.02], [0.1, 0.0, 0.11]),
        cuboid([0.1, 0.1, 0.06], [-0.05, 0.0, 0.15]),
    ]);
    let board = scene.objects[1].pose;
    assert!(scene.stands(ObjectId(1), &board, set(&[0, 2])) && !scene.stands(ObjectId(1), &board, set(&[0])));
}

#[test]
fn it_is_quick() {
    // 20 objects: stacks of three on a board, and what stands about.
    let mut objects = Vec::new();
    for i in 0..4 {
        let x = -0.36 + 0.24 * f64::from(i);
        objects.push(format!("cylinder: {{radius: 0.03, height: 0.1}}, position: [{}, 0.0, 0.05]", x - 0.06));
        objects.push(format!("cylinder: {{radius: 0.03, height: 0.1}}, position: [{}, 0.0, 0.05]", x + 0.06));
        objects.push(cuboid([0.2, 0.08, 0.02], [x, 0.0, 0.11]));
        objects.push(format!("cylinder: {{radius: 0.03, height: 0.1}}, position: [{x}, 0.0, 0.17]"));
        objects.push(format!("cylinder: {{radius: 0.03, height: 0.1}}, position: [{x}, 0.2, 0.05]"));
    }
    let start = std::time::Instant::now();
    let scene = scene(&objects);
    let read = start.elapsed();
    let start = std::time::Instant::now();
    for i in 0..1000 {
        let moved = scene.moved(ObjectId(i % 20), at(0.0, -0.3, 0.05));
        assert!(moved.objects.len() == 20);
    }
    let moved = start.elapsed() / 1000;
    let start = std::time::Instant::now();
    for _ in 0..50 {
        for i in 0..20 {
            assert!(scene.stands(ObjectId(i), &scene.objects[usize::from(i)].pose, scene.all()));
        }
    }
    let stands = start.elapsed() / 1000;
    let start = std::time::Instant::now();
    for _ in 0..1000 {
        assert!(scene.stands(ObjectId(4), &at(-0.36, 0.0, 0.27), scene.all()));
    }
    let stacked = start.elapsed() / 1000;
    println!("read {read:?}, moved {moved:?}, stands {stands:?}, on a stack {stacked:?}");
    // With much room for slow machines.
    assert!(moved.as_millis() < 10 && stands.as_millis() < 10 && stacked.as_millis() < 10);
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(100))]

    /// A scene with an object moved is the scene that is read with the object there.
    #[test]
    fn moved_is_as_read(which in 0_u16..5, onto in 0_usize..5, x in -0.04..0.04, y in -0.04..0.04) {
        let scene = table();
        prop_assume!(usize::from(which) != onto);
        let size = |i: usize| scene.file.objects[i].r#box.as_ref().unwrap().size;
        let below = scene.objects[onto].pose.translation;
        let top = below.z + size(onto)[2] / 2.0;
        let pose = at(below.x + x, below.y + y, top + size(usize::from(which))[2] / 2.0);
        let moved = scene.moved(ObjectId(which), pose);
        let mut file = scene.file.clone();
        file.objects[usize::from(which)].position = pose.translation.to_array();
        // Unless something overlaps, floats or falls there.
        let Ok(again) = Scene::from_file_struct(file, Path::new(".")) else { return Ok(()) };
        for (a, b) in moved.objects.iter().zip(&again.objects) {
            prop_assert!((a.pose.translation - b.pose.translation).length() < 1e-9);
            prop_assert_eq!(&a.support, &b.support);
        }
        for o in moved.all().iter() {
            prop_assert!(moved.stands(o, &moved.objects[o.index()].pose, moved.all()));
        }
    }
}
