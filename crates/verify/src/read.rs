//! Reads plan files leniently: unknown keys are passed over, in the scene too, where the scene
//! file's own reader would refuse them. At most 256 MiB. Numbers that are not finite are no JSON.

use crate::error::CannotJudge;
use crate::judge::verify;
use crate::report::Report;
use clearway_files::{FileError, Limits, json, read_text};
use clearway_plan::{Budget, PlanFile};
use serde_json::{Map, Value};
use std::path::Path;

/// Reads and judges a plan file; meshes are found relative to it.
pub fn verify_file(path: &Path, budget: &Budget) -> Result<Report, CannotJudge> {
    let plan = read_plan(path)?;
    verify(&plan, path.parent().unwrap_or(Path::new("")), budget)
}

/// Reads a plan file without judging it.
pub fn read_plan(path: &Path) -> Result<PlanFile, FileError> {
    let text = read_text(path, &Limits::PLAN)?;
    let mut document: Value = json::from_str(path, &text)?;
    if let Some(scene) = document.get_mut("scene") {
        prune_scene(scene);
    }
    serde_json::from_value(document).map_err(|error| {
        FileError::new(path, error.to_string()).help("`clearway schema plan` prints what a plan file looks like")
    })
}

const POSE: &[&str] = &["position", "rpy", "quaternion"];
const SHAPES: &[&str] = &["box", "cylinder", "sphere", "capsule", "mesh", "points", "compound"];

/// Takes away keys that `clearway-scene/1` does not know.
fn prune_scene(scene: &mut Value) {
    keep(
        scene,
        &[&[
            "format",
            "name",
            "frame",
            "robot",
            "fixtures",
            "objects",
            "target",
            "place",
            "workspace",
            "exit",
            "camera",
            "clearance",
            "friction",
        ]],
    );
    within(scene, "robot", |robot| {
        keep(robot, &[&["model", "base", "start", "region"]]);
        within(robot, "base", |base| keep(base, &[POSE]));
        within(robot, "region", |rect| keep(rect, &[&["min", "max"]]));
    });
    within(scene, "workspace", |rect| keep(rect, &[&["min", "max"]]));
    within(scene, "camera", |camera| keep(camera, &[&["position", "look_at", "fov", "enter_unseen"]]));
    for list in ["fixtures", "objects"] {
        each(scene, list, |body| {
            keep(body, &[&["id", "mass", "friction"], SHAPES, POSE]);
            prune_shapes(body);
            each(body, "compound", |part| {
                keep(part, &[&SHAPES[..5], POSE]);
                prune_shapes(part);
            });
        });
    }
    each(scene, "place", |place| keep(place, &[&["id", "size", "position"]]));
}

fn prune_shapes(body: &mut Value) {
    for (shape, keys) in [
        ("box", &["size"][..]),
        ("cylinder", &["radius", "height"]),
        ("sphere", &["radius"]),
        ("capsule", &["radius", "height"]),
        ("mesh", &["file", "scale"]),
        ("points", &["file", "radius"]),
    ] {
        within(body, shape, |value| keep(value, &[keys]));
    }
}

fn keep(value: &mut Value, known: &[&[&str]]) {
    if let Value::Object(map) = value {
        let all = std::mem::take(map);
        *map = all
            .into_iter()
            .filter(|(key, _)| known.iter().any(|keys| keys.contains(&key.as_str())))
            .collect::<Map<_, _>>();
    }
}

fn within(value: &mut Value, key: &str, change: impl FnOnce(&mut Value)) {
    if let Some(inner) = value.get_mut(key) {
        change(inner);
    }
}

fn each(value: &mut Value, key: &str, change: impl FnMut(&mut Value)) {
    if let Some(Value::Array(items)) = value.get_mut(key) {
        items.iter_mut().for_each(change);
    }
}
