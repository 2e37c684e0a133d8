//! Plans for a robot that is quickly understood: a hand on two slides, x and z, over a table whose top is at 0.5 m.
//! Its fingers close along y; the gap is 0.09 m less twice the joint's value.
#![allow(dead_code)]

use clearway_plan::{Budget, PlanFile};
use clearway_simulate::{Outcome, Settings, simulate};
use serde_json::{Value, json};

pub const TABLE: f64 = 0.5;
pub const RADIUS: f64 = 0.03;
pub const HEIGHT: f64 = 0.12;

const URDF: &str = r#"<robot name="gantry">
  <link name="root"/>
  <joint name="x" type="prismatic"><parent link="root"/><child link="rail"/><axis xyz="1 0 0"/><limit lower="-5" upper="5" velocity="9" effort="1"/></joint>
  <link name="rail"/>
  <joint name="z" type="prismatic"><parent link="rail"/><child link="palm"/><axis xyz="0 0 1"/><limit lower="-5" upper="5" velocity="9" effort="1"/></joint>
  <link name="palm"><collision><origin xyz="0 0 0.1"/><geometry><box size="0.04 0.12 0.04"/></geometry></collision></link>
  <joint name="frame" type="fixed"><parent link="palm"/><child link="grasp"/><origin rpy="0 0 1.5707963267948966"/></joint>
  <link name="grasp"/>
  <joint name="close" type="prismatic"><parent link="palm"/><child link="left"/><origin xyz="0 0.05 0"/><axis xyz="0 -1 0"/><limit lower="0" upper="0.045" velocity="1" effort="1"/></joint>
  <link name="left"><collision><geometry><box size="0.02 0.01 0.04"/></geometry></collision></link>
  <joint name="also" type="prismatic"><parent link="palm"/><child link="right"/><origin xyz="0 -0.05 0"/><axis xyz="0 1 0"/><limit lower="0" upper="0.045" velocity="1" effort="1"/><mimic joint="close"/></joint>
  <link name="right"><collision><geometry><box size="0.02 0.01 0.04"/></geometry></collision></link>
</robot>"#;

/// An upright cylinder on the table.
pub fn cylinder(id: &str, x: f64) -> Value {
    json!({"id": id, "cylinder": {"radius": RADIUS, "height": HEIGHT}, "position": [x, 0, TABLE + HEIGHT / 2.0]})
}

/// Where the hand goes: from here to there, smoothly or at a steady pace.
pub struct Way {
    pub kind: &'static str,
    pub to: [f64; 2],
    pub seconds: f64,
    pub steady: bool,
    /// The gripper's joint in the end.
    pub close: f64,
}

pub fn smooth(kind: &'static str, to: [f64; 2], seconds: f64, close: f64) -> Way {
    Way { kind, to, seconds, steady: false, close }
}

/// A plan of one step that begins at `from`.
pub fn plan(
    action: &str,
    objects: Vec<Value>,
    fixtures: Vec<Value>,
    from: [f64; 2],
    ways: &[Way],
    placed: [f64; 3],
) -> PlanFile {
    let id = objects[0]["id"].clone();
    let (mut at, mut closed) = (from, 0.0);
    let mut segments = Vec::new();
    for way in ways {
        let rows = (way.seconds / 0.01).round() as usize;
        let part = |i: usize| {
            let t = i as f64 / rows as f64;
            if way.steady { t } else { t * t * t * (10.0 - 15.0 * t + 6.0 * t * t) }
        };
        let between = |a: f64, b: f64, i: usize| a + (b - a) * part(i);
        let times: Vec<f64> = (0..=rows).map(|i| way.seconds * i as f64 / rows as f64).collect();
        let positions: Vec<[f64; 2]> =
            (0..=rows).map(|i| [between(at[0], way.to[0], i), between(at[1], way.to[1], i)]).collect();
        let gripper: Vec<f64> = (0..=rows).map(|i| between(closed, way.close, i)).collect();
        segments.push(json!({"kind": way.kind, "times": times, "positions": positions, "gripper": {"close": gripper}, "attached": null}));
        (at, closed) = (way.to, way.close);
    }
    let mut all = vec![json!({"id": "table", "box": {"size": [8, 2, 0.1]}, "position": [0, 0, TABLE - 0.05]})];
    all.extend(fixtures);
    serde_json::from_value(json!({
        "format": "clearway-plan/1", "status": "solved", "seed": 1, "removed": [id],
        "scene": {"format": "clearway-scene/1", "robot": {"model": "gantry"}, "fixtures": all, "objects": objects, "target": id},
        "robot": {"urdf": URDF, "joints": ["x", "z"], "tool": "grasp", "home": {"x": from[0], "z": from[1]},
                  "limits": {"velocity": {}, "acceleration": {}},
                  "hand": {"kind": "parallel", "frame": "grasp", "joint": "close", "opening": {"0.0": 0.09, "0.045": 0.0},
                           "links": ["palm", "left", "right"], "base_radius": 0.06, "finger_thickness": 0.01},
                  "unchecked_pairs": [["palm", "left"], ["palm", "right"], ["left", "right"]]},
        "steps": [{"object": id, "action": action, "segments": segments,
                   "placed": {"position": placed, "quaternion": [0, 0, 0, 1]}}],
    }))
    .expect("a plan")
}

/// Takes `o` at x = 0.5 and puts it down at x = 0.8; another stands at 0.2.
pub fn pick(fixtures: Vec<Value>) -> PlanFile {
    let closed = 0.045 - RADIUS;
    let ways = [
        smooth("transit", [0.5, 0.75], 0.8, 0.0),
        smooth("approach", [0.5, 0.57], 0.5, 0.0),
        smooth("grasp", [0.5, 0.57], 0.3, closed),
        smooth("transfer", [0.5, 0.75], 0.5, closed),
        smooth("transfer", [0.8, 0.75], 0.6, closed),
        smooth("transfer", [0.8, 0.57], 0.5, closed),
        smooth("release", [0.8, 0.57], 0.3, 0.0),
        smooth("retreat", [0.8, 0.75], 0.5, 0.0),
    ];
    plan(
        "pick_place",
        vec![cylinder("o", 0.5), cylinder("other", 0.2)],
        fixtures,
        [0.0, 0.75],
        &ways,
        [0.8, 0.0, TABLE + HEIGHT / 2.0],
    )
}

/// The hand waits high above while things happen.
pub fn watch(objects: Vec<Value>, seconds: f64) -> PlanFile {
    let mut all = vec![cylinder("o", -1.0)];
    all.extend(objects);
    let placed = [-1.0, 0.0, TABLE + HEIGHT / 2.0];
    plan(
        "push",
        all,
        Vec::new(),
        [0.0, 3.0],
        &[smooth("transit", [0.0, 3.0], seconds, 0.0), smooth("push", [0.0, 3.0], 0.1, 0.0)],
        placed,
    )
}

pub fn played(plan: &PlanFile, settings: &Settings) -> Outcome {
    simulate(plan, "".as_ref(), settings, &Budget::unlimited()).expect("played")
}
