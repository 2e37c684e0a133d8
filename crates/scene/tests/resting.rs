//! What carries what, and how noise is snapped.
#![allow(clippy::unwrap_used)]

use clearway_plan::ObjectId;
use clearway_scene::{Scene, Support};
use std::path::Path;

/// A shelf of two boards, 0.4 m apart, the lower one's top at 0.6 m.
fn scene(objects: &[&str]) -> Scene {
    read(objects).unwrap_or_else(|error| panic!("{error}"))
}

fn read(objects: &[&str]) -> Result<Scene, clearway_files::FileError> {
    let list: String = objects.iter().map(|o| format!("  - {{{o}}}\n")).collect();
    let text = format!(
        "format: clearway-scene/1\nrobot: {{model: ur10_ag95}}\nfixtures:\n  - {{id: upper, box: {{size: [1, 1, 0.02]}}, position: [0, 0, 1.01]}}\n  - {{id: lower, box: {{size: [1, 1, 0.02]}}, position: [0, 0, 0.59]}}\nobjects:\n{list}target: a\n"
    );
    Scene::from_text(Path::new("shelf.yaml"), &text)
}

fn heights(scene: &Scene) -> Vec<f64> {
    scene.objects.iter().map(|o| o.pose.translation.z).collect()
}

#[test]
fn the_board_above_carries_nothing() {
    let scene = scene(&[
        "id: a, box: {size: [0.1, 0.1, 0.3995]}, position: [0, 0, 0.79975]",
        "id: b, sphere: {radius: 0.05}, position: [0.3, 0, 1.07]",
    ]);
    assert_eq!(scene.objects[0].support, Support::Fixture(1));
    assert_eq!(scene.objects[1].support, Support::Fixture(0));
}

#[test]
fn noise_is_snapped_and_exact_things_stay() {
    let scene = scene(&[
        "id: a, cylinder: {radius: 0.04, height: 0.2}, position: [0, 0, 0.7008]",
        "id: b, cylinder: {radius: 0.04, height: 0.2}, position: [0.2, 0, 0.6993]",
        "id: c, cylinder: {radius: 0.04, height: 0.2}, position: [0.4, 0, 0.7]",
        "id: d, capsule: {radius: 0.04, height: 0.1}, rpy: [1.5707963267948966, 0, 0.3], position: [-0.3, 0, 0.6405]",
        "id: e, sphere: {radius: 0.04}, position: [-0.3, 0.3, 0.6396]",
        "id: f, box: {size: [0.1, 0.1, 0.1]}, rpy: [0.7853981633974483, 0, 0], position: [0, 0.3, 0.6712]",
    ]);
    let expected = [0.7, 0.7, 0.7, 0.64, 0.64, 0.6 + 0.005_f64.sqrt()];
    for (found, expected) in heights(&scene).iter().zip(expected) {
        assert!((found - expected).abs() < 1e-7, "{found} is not {expected}");
    }
    assert_eq!(heights(&scene)[2], 0.7);
    for (object, written) in scene.objects.iter().zip(&scene.file.objects) {
        assert_eq!(object.pose.translation.to_array(), written.position);
    }
}

#[test]
fn stacks_settle_from_below_whatever_their_order() {
    let scene = scene(&[
        "id: a, box: {size: [0.2, 0.2, 0.05]}, position: [0, 0, 0.8264]",
        "id: b, cylinder: {radius: 0.04, height: 0.2}, position: [0, 0, 0.7008]",
        "id: c, cylinder: {radius: 0.02, height: 0.05}, position: [0.05, 0, 0.8755]",
    ]);
    assert_eq!(scene.objects[0].support, Support::Objects(vec![ObjectId(1)]));
    assert_eq!(scene.objects[1].support, Support::Fixture(1));
    assert_eq!(scene.objects[2].support, Support::Objects(vec![ObjectId(0)]));
    for (found, expected) in heights(&scene).iter().zip([0.825, 0.7, 0.875]) {
        assert!((found - expected).abs() < 1e-9, "{found} is not {expected}");
    }
}

#[test]
fn several_may_carry_one() {
    let scene = scene(&[
        "id: a, box: {size: [0.3, 0.1, 0.05]}, position: [0, 0, 0.825]",
        "id: b, cylinder: {radius: 0.04, height: 0.2}, position: [-0.1, 0, 0.7]",
        "id: c, cylinder: {radius: 0.04, height: 0.1995}, position: [0.1, 0, 0.69975]",
        "id: d, box: {size: [0.04, 0.04, 0.1]}, position: [0, 0, 0.65]",
    ]);
    assert_eq!(scene.objects[0].support, Support::Objects(vec![ObjectId(1), ObjectId(2)]));
    assert!((heights(&scene)[0] - 0.825).abs() < 1e-12);
}

#[test]
fn compounds_rest_on_their_lowest_part() {
    // A table with two legs, and a ball under it.
    let scene = scene(&[
        "id: a, compound: [{box: {size: [0.4, 0.2, 0.02]}, position: [0, 0, 0.11]}, {box: {size: [0.02, 0.2, 0.1]}, position: [-0.19, 0, 0.05]}, {box: {size: [0.02, 0.2, 0.1]}, position: [0.19, 0, 0.05]}], position: [0, 0, 0.6004]",
        "id: b, sphere: {radius: 0.04}, position: [0, 0, 0.64]",
    ]);
    assert_eq!(scene.objects[0].support, Support::Fixture(1));
    assert_eq!(scene.objects[1].support, Support::Fixture(1));
    assert!((heights(&scene)[0] - 0.6).abs() < 1e-12);
}

#[test]
fn reading_back_what_was_read_changes_nothing() {
    let first = scene(&[
        "id: a, cylinder: {radius: 0.04, height: 0.2}, position: [0, 0, 0.7008]",
        "id: b, capsule: {radius: 0.04, height: 0.1}, quaternion: [0.5, 0.5, 0.5, 0.5], position: [-0.3, 0, 0.6405]",
        "id: c, box: {size: [0.1, 0.1, 0.1]}, rpy: [0.7853981633974483, 0, 0.2], position: [0.3, 0.3, 0.6702]",
        "id: d, sphere: {radius: 0.02}, position: [0.01, 0.01, 0.8199]",
        "id: e, box: {size: [0.05, 0.05, 0.1]}, position: [0.0649, 0, 0.6509]",
    ]);
    let json = serde_json::to_string(&first.file).unwrap();
    let second = Scene::from_text(Path::new("again.json"), &json).unwrap();
    assert_eq!(first.file, second.file);
    assert_eq!(json, serde_json::to_string(&second.file).unwrap());
    for (a, b) in first.objects.iter().zip(&second.objects) {
        assert_eq!((a.pose, &a.support), (b.pose, &b.support));
    }
    let third = Scene::from_file_struct(first.file.clone(), Path::new("")).unwrap();
    assert_eq!(third.file, first.file);
}

#[test]
fn a_packed_shelf_of_256_is_read() {
    let mut objects = vec!["id: a, cylinder: {radius: 0.02, height: 0.2}, position: [-0.45, -0.45, 0.7]".to_owned()];
    for i in 1..256 {
        let (x, y) = (-0.45 + 0.045 * f64::from(i / 16), -0.45 + 0.045 * f64::from(i % 16));
        objects.push(format!("id: o{i}, cylinder: {{radius: 0.02, height: 0.2}}, position: [{x}, {y}, 0.7]"));
    }
    let scene = scene(&objects.iter().map(String::as_str).collect::<Vec<_>>());
    assert_eq!(scene.objects.len(), 256);
    assert!(scene.objects.iter().all(|o| o.support == Support::Fixture(1)));
}
