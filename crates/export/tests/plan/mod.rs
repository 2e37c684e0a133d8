//! A plan small enough to reckon with: two joints, a gripper of two fingers, objects of every shape.
#![allow(dead_code)] // each test uses some of it

use clearway_plan::PlanFile;
use serde_json::{Value, json};

/// `pan` turns about the world's z, `lift` about y half a metre up, `rail` is held out by 0.2 m along x, the
/// fingers slide apart along y. The tool is one metre along x from the lift.
pub const URDF: &str = r#"<robot name="r">
  <link name="base"/><link name="column"/><link name="arm"/><link name="rail"/><link name="tool"/>
  <link name="left"/><link name="right"/>
  <joint name="pan" type="continuous"><parent link="base"/><child link="column"/><axis xyz="0 0 2"/></joint>
  <joint name="lift" type="revolute"><parent link="column"/><child link="arm"/>
    <origin xyz="0 0 0.5"/><axis xyz="0 1 0"/><limit lower="-3" upper="3" effort="1" velocity="1"/></joint>
  <joint name="extension" type="prismatic"><parent link="arm"/><child link="rail"/>
    <axis xyz="1 0 0"/><limit lower="0" upper="1" effort="1" velocity="1"/></joint>
  <joint name="tool_joint" type="fixed"><parent link="rail"/><child link="tool"/>
    <origin xyz="0.8 0 0" rpy="1.5707963267948966 0 0"/></joint>
  <joint name="finger_joint" type="prismatic"><parent link="rail"/><child link="left"/>
    <origin xyz="0.8 0 0"/><axis xyz="0 1 0"/><limit lower="0" upper="1" effort="1" velocity="1"/></joint>
  <joint name="other_finger_joint" type="prismatic"><parent link="rail"/><child link="right"/>
    <origin xyz="0.8 0 0"/><axis xyz="0 1 0"/><limit lower="-1" upper="1" effort="1" velocity="1"/>
    <mimic joint="finger_joint" multiplier="-1" offset="0.01"/></joint>
</robot>"#;

/// A step per name: transit, approach, grasp, transfer, release, retreat.
pub fn plan(objects: &[&str]) -> PlanFile {
    let mut angle = 0.1;
    let mut rows = |count: usize, rate: f64| {
        let times: Vec<f64> = (0..count).map(|i| i as f64 * 0.02).collect();
        let positions: Vec<[f64; 2]> =
            times.iter().map(|t| [angle + rate * t * t, -1.0 / 3.0 * (angle + rate * t * t)]).collect();
        angle += rate * times[count - 1] * times[count - 1];
        (times, positions)
    };
    let mut segment = |kind: &str, count: usize, rate: f64, gripper: Value, object: Option<&str>| {
        let (times, positions) = rows(count, rate);
        let attached = object.map(|id| {
            json!({"object": id, "tool": "tool", "pose_in_tool": {"position": [0, 0, 0.1], "quaternion": [0, 0, 0, 1]}})
        });
        json!({"kind": kind, "times": times, "positions": positions, "gripper": {"finger_joint": gripper}, "attached": attached})
    };
    let steps: Vec<Value> = objects
        .iter()
        .enumerate()
        .map(|(i, id)| {
            let segments = vec![
                segment("transit", 30, 0.3, json!(0.0), None),
                segment("approach", 7, -0.2, json!(0.0), None),
                segment("grasp", 4, 0.0, json!([0.0, 0.1, 0.2, 0.3]), None),
                segment("transfer", 41, 0.5, json!(0.3), Some(id)),
                segment("release", 3, 0.0, json!([0.3, 0.15, 0.0]), None),
                segment("retreat", 6, 0.1, json!(0.0), None),
            ];
            json!({"object": id, "action": "pick_place", "segments": segments,
                   "placed": {"position": [-1, i, 0.25], "quaternion": [0, 0, 0.6, 0.8]}})
        })
        .collect();
    let bodies: Vec<Value> = objects
        .iter()
        .enumerate()
        .map(|(i, id)| json!({"id": id, "cylinder": {"radius": 0.05, "height": 0.2}, "position": [1, i, 0.1]}))
        .collect();
    serde_json::from_value(json!({
        "format": "clearway-plan/1", "status": "solved", "seed": 1, "removed": objects,
        "scene": {
            "format": "clearway-scene/1", "frame": "map", "target": "o1", "objects": bodies,
            "robot": {"model": "x", "base": {"position": [0, 0, 0.3], "rpy": [0, 0, std::f64::consts::FRAC_PI_2]}},
            "fixtures": [{"id": "floor", "box": {"size": [2, 2, 0.1]}, "position": [0, 0, -0.05]}],
            "place": [{"id": "tray", "size": [0.4, 0.5], "position": [-1, 0, 0.2]}],
        },
        "robot": {"urdf": URDF, "joints": ["pan", "lift"], "tool": "tool", "fixed": {"extension": 0.2},
                  "limits": {"velocity": {}, "acceleration": {}},
                  "hand": {"kind": "parallel", "frame": "tool", "links": [], "base_radius": 0.05, "finger_thickness": 0.01}},
        "steps": steps,
        "why": {"summary": "so it is", "objects": [{"object": "o1", "order": 1, "reason": "it is the target"}]},
    }))
    .expect("a plan")
}

pub fn all_rows(plan: &PlanFile) -> Vec<Vec<f64>> {
    let mut rows: Vec<Vec<f64>> = Vec::new();
    for segment in plan.steps.iter().flat_map(|s| &s.segments) {
        let shared = usize::from(!rows.is_empty());
        rows.extend(segment.positions.iter().skip(shared).cloned());
    }
    rows
}

pub fn duration(plan: &PlanFile) -> f64 {
    plan.steps.iter().flat_map(|s| &s.segments).filter_map(|s| s.times.last()).sum()
}
