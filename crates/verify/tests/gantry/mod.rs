//! A robot simple enough to plan for by hand: a gantry over a table, with a parallel gripper that
//! points down. [`plan`] takes some objects from the table to a tray, and is exactly valid; so is
//! [`pushing`], which pushes one along the table.

// Not every test that has a gantry uses all of it.
#![allow(dead_code)]

use clearway_plan::PlanFile;
use clearway_plan::plan_file::{
    Action, Attached, GripperValue, JointLimits, LowerBound, PlacedPose, PlannedHand, PlannedRobot, Segment,
    SegmentKind, Status, Step,
};
use clearway_plan::push::Push;
use clearway_plan::scene_file::{
    Body, BoxKeys, CylinderKeys, Part, PlaceArea, PoseKeys, RobotPlacement, SceneFile, SphereKeys,
};
use parry3d_f64::math::{Pose, Rotation, Vector};
use rand::RngExt;
use rand_xoshiro::Xoshiro256PlusPlus;
use std::collections::BTreeMap;
use std::f64::consts::PI;

pub const URDF: &str = r#"<robot name="gantry">
  <link name="rail"><collision><geometry><box size="0.3 0.1 0.08"/></geometry></collision></link>
  <joint name="x" type="prismatic"><parent link="rail"/><child link="bridge"/><origin xyz="0 0 -0.1"/>
    <axis xyz="1 0 0"/><limit lower="-0.6" upper="0.6" velocity="1.0" effort="1"/></joint>
  <link name="bridge"><collision><geometry><box size="0.08 0.3 0.05"/></geometry></collision></link>
  <joint name="y" type="prismatic"><parent link="bridge"/><child link="cart"/><origin xyz="0 0 -0.08"/>
    <axis xyz="0 1 0"/><limit lower="-0.9" upper="0.9" velocity="1.0" effort="1"/></joint>
  <link name="cart"><collision><geometry><box size="0.08 0.08 0.05"/></geometry></collision></link>
  <joint name="z" type="prismatic"><parent link="cart"/><child link="column"/><origin xyz="0 0 -0.08"/>
    <axis xyz="0 0 1"/><limit lower="-0.6" upper="0.05" velocity="1.0" effort="1"/></joint>
  <link name="column"><collision><origin xyz="0 0 -0.15"/><geometry><cylinder radius="0.02" length="0.3"/></geometry></collision>
    <collision><origin xyz="0.03 0 -0.15" rpy="0 1.5707963267948966 0"/><geometry><sphere radius="0.015"/></geometry></collision></link>
  <joint name="yaw" type="continuous"><parent link="column"/><child link="palm"/><origin xyz="0 0 -0.32"/>
    <axis xyz="0 0 1"/><limit velocity="2.0" effort="1"/></joint>
  <link name="palm"><collision><geometry><box size="0.14 0.04 0.03"/></geometry></collision></link>
  <joint name="finger" type="prismatic"><parent link="palm"/><child link="left"/><origin xyz="0 0 -0.057"/>
    <axis xyz="1 0 0"/><limit lower="0" upper="0.06" velocity="0.2" effort="1"/></joint>
  <link name="left"><collision><origin xyz="0.005 0 0"/><geometry><box size="0.01 0.02 0.08"/></geometry></collision></link>
  <joint name="finger_right" type="prismatic"><parent link="palm"/><child link="right"/><origin xyz="0 0 -0.057"/>
    <axis xyz="-1 0 0"/><limit lower="0" upper="0.06" velocity="0.2" effort="1"/><mimic joint="finger"/></joint>
  <link name="right"><collision><origin xyz="-0.005 0 0"/><geometry><box size="0.01 0.02 0.08"/></geometry></collision></link>
  <joint name="hold" type="fixed"><parent link="palm"/><child link="grasp_center"/><origin xyz="0 0 -0.07" rpy="3.141592653589793 0 0"/></joint>
  <link name="grasp_center"/>
</robot>"#;

/// Height of grasp_center above the table when z is 0.
const TOOL_HEIGHT: f64 = 0.35;
const OPEN: f64 = 0.045;
const TRAY_TOP: f64 = 0.05;
const VELOCITY: [f64; 4] = [1.0, 1.0, 1.0, 2.0];
const ACCELERATION: [f64; 4] = [4.0, 4.0, 4.0, 8.0];
/// Of the fifth-order polynomials, 60 · distance / time³: at their shortest (0.1 s) just within.
const JERK: [f64; 4] = [420.0, 420.0, 420.0, 840.0];

struct Object {
    body: Body,
    at: Vector,
    yaw: f64,
    height: f64,
    half_width: f64,
}

/// A valid plan over a random table: up to 5 of 8 objects go to the tray.
pub fn plan(random: &mut Xoshiro256PlusPlus) -> PlanFile {
    let mut cells: Vec<(i32, i32)> = (-2..=2).flat_map(|i| (0..4).map(move |j| (i, j))).collect();
    let objects: Vec<Object> = (0..8)
        .map(|i| {
            let (cx, cy) = cells.swap_remove(random.random_range(0..cells.len()));
            let mut jitter = || random.random_range(-0.008..0.008);
            let (x, y) = (f64::from(cx) * 0.18 + jitter(), 0.1 + f64::from(cy) * 0.18 + jitter());
            object(i, x, y, random)
        })
        .collect();
    let mut left: Vec<usize> = (0..objects.len()).collect();
    let taken: Vec<usize> =
        (0..random.random_range(2..=4)).map(|_| left.swap_remove(random.random_range(0..left.len()))).collect();
    let mut slots: Vec<(f64, f64)> =
        (-1..=1).flat_map(|i| [-0.09, 0.09].map(|y| (f64::from(i) * 0.17, y - 0.7))).collect();
    let mut mover = Mover { at: [0.0; 4], steps: Vec::new() };
    for (i, &o) in taken.iter().enumerate() {
        let (x, y) = slots.swap_remove(random.random_range(0..slots.len()));
        mover.take(&objects[o], [x, y], random.random_range(-PI..PI), i + 1 == taken.len());
    }
    let names: Vec<String> = taken.iter().map(|o| objects[*o].body.id.clone()).collect();
    let scene = scene(&objects, names.last().cloned().unwrap_or_default());
    PlanFile {
        status: Status::Solved,
        robot: robot(),
        removed: names,
        lower_bound: Some(LowerBound {
            removed: 1,
            kind: "geometric".into(),
            proof: serde_json::json!({"barriers": []}),
        }),
        steps: mover.steps,
        ..PlanFile::unsolved(scene)
    }
}

/// What [`pushing`] pushes, metres.
pub const PUSHED_RADIUS: f64 = 0.035;
pub const PUSHED_HEIGHT: f64 = 0.07;
/// grasp_center above the table as it pushes: the fingers end 3 mm above it, the palm is over the object.
const PUSH_HEIGHT: f64 = 0.03;

/// A valid plan of one step: a cylinder on the empty table, `o0`, is pushed by the finger behind it.
pub fn pushing(random: &mut Xoshiro256PlusPlus) -> PlanFile {
    let turn = random.random_range(-0.3..0.3);
    let (yaw, x): (f64, f64) = if random.random_bool(0.5) { (turn, -0.2) } else { (PI + turn, 0.2) };
    let (distance, free) = (random.random_range(0.05..0.3), OPEN - PUSHED_RADIUS);
    let body = Body {
        id: "o0".into(),
        cylinder: Some(CylinderKeys { radius: PUSHED_RADIUS, height: PUSHED_HEIGHT }),
        position: [x, -0.13, PUSHED_HEIGHT / 2.0],
        ..Body::default()
    };
    let at = Vector::from(body.position);
    let object = Object { at, yaw: 0.0, height: PUSHED_HEIGHT, half_width: PUSHED_RADIUS, body };
    let along = Vector::new(yaw.cos(), yaw.sin(), 0.0);
    let mut mover = Mover { at: [0.0; 4], steps: Vec::new() };
    let over = [x, -0.13, 0.0, yaw];
    let down = PUSH_HEIGHT - TOOL_HEIGHT;
    let end = Vector::from([x, -0.13, 0.0]) + along * (free + distance);
    let segments = vec![
        mover.go(SegmentKind::Transit, over, OPEN),
        mover.go(SegmentKind::Approach, [x, -0.13, down, yaw], OPEN),
        mover.go_within(SegmentKind::Push, [end.x, end.y, down, yaw], OPEN, 0.5),
        mover.go(SegmentKind::Retreat, [end.x, end.y, 0.0, yaw], OPEN),
        mover.go(SegmentKind::Transit, [0.0; 4], OPEN),
    ];
    let push = Push {
        direction: along.to_array(),
        distance,
        free,
        height: PUSHED_HEIGHT,
        tips_at: PUSHED_RADIUS / 0.4,
        margin_of_error: 0.0,
    };
    mover.steps.push(Step {
        object: "o0".into(),
        action: Action::Push,
        segments,
        placed: placed(&Pose::from_translation(at + along * distance)),
        push: Some(push),
    });
    PlanFile {
        status: Status::Solved,
        robot: robot(),
        removed: vec!["o0".into()],
        steps: mover.steps,
        ..PlanFile::unsolved(scene(&[object], "o0".into()))
    }
}

fn object(index: usize, x: f64, y: f64, random: &mut Xoshiro256PlusPlus) -> Object {
    let height = random.random_range(0.08..0.15);
    let half_width = random.random_range(0.015..0.03);
    let yaw = random.random_range(-PI..PI);
    let mut body = Body { id: format!("o{index}"), position: [x, y, height / 2.0], ..Body::default() };
    if random.random_bool(0.5) {
        body.rpy = Some([0.0, 0.0, yaw]);
    } else {
        body.quaternion = Some(Rotation::from_rotation_z(yaw).to_array());
    }
    match index % 3 {
        0 => body.cylinder = Some(CylinderKeys { radius: half_width, height }),
        1 => body.r#box = Some(BoxKeys { size: [2.0 * half_width, 0.04, height] }),
        _ => {
            // A foot and a neck.
            let foot = Part {
                r#box: Some(BoxKeys { size: [2.0 * half_width, 0.04, height - 0.05] }),
                position: [0.0, 0.0, -0.025],
                ..Part::default()
            };
            let neck = Part {
                cylinder: Some(CylinderKeys { radius: half_width, height: 0.05 }),
                position: [0.0, 0.0, height / 2.0 - 0.025],
                ..Part::default()
            };
            body.compound = Some(vec![foot, neck]);
        }
    }
    Object { body, at: Vector::new(x, y, height / 2.0), yaw, height, half_width }
}

fn scene(objects: &[Object], target: String) -> SceneFile {
    let fixture = |id: &str, position: [f64; 3]| Body { id: id.into(), position, ..Body::default() };
    let boxed = |id: &str, position, size| Body { r#box: Some(BoxKeys { size }), ..fixture(id, position) };
    SceneFile {
        format: clearway_plan::scene_file::FORMAT.to_owned(),
        name: "gantry".into(),
        frame: "world".into(),
        robot: RobotPlacement {
            model: "gantry.yaml".into(),
            base: PoseKeys { position: [0.0, 0.0, 1.0], ..PoseKeys::default() },
            start: None,
            region: None,
        },
        fixtures: vec![
            boxed("table", [0.0, 0.3, -0.05], [1.4, 1.2, 0.1]),
            boxed("tray", [0.0, -0.7, TRAY_TOP / 2.0], [0.6, 0.5, TRAY_TOP]),
            boxed("mount", [0.0, 0.0, 1.05], [0.1, 0.1, 0.1]),
            Body { cylinder: Some(CylinderKeys { radius: 0.03, height: 0.18 }), ..fixture("pin", [-0.6, 0.4, 0.09]) },
            Body { sphere: Some(SphereKeys { radius: 0.05 }), ..fixture("ball", [0.6, 0.2, 0.05]) },
            Body { capsule: Some(CylinderKeys { radius: 0.03, height: 0.1 }), ..fixture("post", [0.6, 0.6, 0.08]) },
        ],
        objects: objects.iter().map(|o| o.body.clone()).collect(),
        target,
        place: vec![PlaceArea { id: "tray_top".into(), size: [0.6, 0.5], position: [0.0, -0.7, TRAY_TOP] }],
        workspace: None,
        exit: None,
        camera: None,
        weights: Default::default(),
        clearance: None,
        friction: None,
    }
}

fn robot() -> PlannedRobot {
    let joints = ["x", "y", "z", "yaw"].map(str::to_owned);
    let by_joint = |values: [f64; 4]| joints.iter().cloned().zip(values).collect::<BTreeMap<_, _>>();
    let pairs = [
        ["rail", "bridge"],
        ["bridge", "cart"],
        ["cart", "column"],
        ["column", "palm"],
        ["palm", "left"],
        ["palm", "right"],
        ["left", "right"],
    ];
    PlannedRobot {
        urdf: URDF.to_owned(),
        tool: "grasp_center".into(),
        fixed: BTreeMap::new(),
        home: by_joint([0.0; 4]),
        limits: JointLimits {
            velocity: by_joint(VELOCITY),
            acceleration: by_joint(ACCELERATION),
            jerk: Some(by_joint(JERK)),
        },
        hand: PlannedHand {
            kind: "parallel".into(),
            frame: "grasp_center".into(),
            joint: Some("finger".into()),
            opening: BTreeMap::from([("0.0".into(), 0.0), ("0.06".into(), 0.12)]),
            links: ["left", "right", "palm"].map(str::to_owned).to_vec(),
            base_radius: 0.07,
            finger_thickness: 0.01,
            radius: None,
        },
        grasps: None,
        unchecked_pairs: pairs.map(|p| p.map(str::to_owned)).to_vec(),
        meshes: Vec::new(),
        joints: joints.to_vec(),
        base_joints: Vec::new(),
    }
}

struct Mover {
    at: [f64; 4],
    steps: Vec<Step>,
}

impl Mover {
    fn take(&mut self, object: &Object, [x, y]: [f64; 2], turn: f64, last: bool) {
        let grip = object.half_width + 5e-4;
        // grasp_center 20 mm below the object's top, fingers across its x.
        let above = [object.at.x, object.at.y, 0.0, object.yaw];
        let down = object.height - 0.02 - TOOL_HEIGHT;
        let at = |p: [f64; 4], z: f64| [p[0], p[1], z, p[3]];
        let drop = [x, y, 0.0, object.yaw + turn];
        let world_from_object = Pose::from_parts(object.at, Rotation::from_rotation_z(object.yaw));
        let tool_from_object = tool(at(above, down)).inverse() * world_from_object;
        let attached = Attached {
            object: object.body.id.clone(),
            tool: "grasp_center".into(),
            pose_in_tool: placed(&tool_from_object),
        };
        let mut segments = vec![
            self.go(SegmentKind::Transit, above, OPEN),
            self.go(SegmentKind::Approach, at(above, down), OPEN),
            self.squeeze(SegmentKind::Grasp, OPEN, grip),
        ];
        for goal in [above, drop, at(drop, down + TRAY_TOP)] {
            segments.push(Segment { attached: Some(attached.clone()), ..self.go(SegmentKind::Transfer, goal, grip) });
        }
        let put = tool(self.at) * tool_from_object;
        segments.push(self.squeeze(SegmentKind::Release, grip, OPEN));
        segments.push(self.go(SegmentKind::Retreat, drop, OPEN));
        if last {
            segments.push(self.go(SegmentKind::Transit, [0.0; 4], OPEN));
        }
        self.steps.push(Step {
            object: object.body.id.clone(),
            action: Action::PickPlace,
            segments,
            placed: placed(&put),
            push: None,
        });
    }

    /// A straight line in joint space, from rest to rest, with a fifth-order polynomial in time.
    fn go(&mut self, kind: SegmentKind, goal: [f64; 4], finger: f64) -> Segment {
        self.go_within(kind, goal, finger, 1.0)
    }

    /// With this share of the limits of acceleration.
    fn go_within(&mut self, kind: SegmentKind, goal: [f64; 4], finger: f64, share: f64) -> Segment {
        let from = self.at;
        let needed = (0..4).map(|j| {
            let far = (goal[j] - from[j]).abs();
            (1.9 * far / VELOCITY[j]).max((5.8 * far / ACCELERATION[j] / share).sqrt())
        });
        let rows = ((needed.fold(0.1, f64::max) / 0.02).ceil() as usize).max(5);
        let share = |row: usize| {
            let t = row as f64 / rows as f64;
            t * t * t * (10.0 + t * (6.0 * t - 15.0))
        };
        self.at = goal;
        Segment {
            kind,
            times: (0..=rows).map(|row| row as f64 * 0.02).collect(),
            positions: (0..=rows)
                .map(|row| (0..4).map(|j| from[j] + share(row) * (goal[j] - from[j])).collect())
                .collect(),
            gripper: BTreeMap::from([("finger".into(), GripperValue::Held(finger))]),
            attached: None,
        }
    }

    fn squeeze(&self, kind: SegmentKind, from: f64, to: f64) -> Segment {
        let rows = 20;
        let value = |row: usize| from + (to - from) * row as f64 / rows as f64;
        Segment {
            kind,
            times: (0..=rows).map(|row| row as f64 * 0.02).collect(),
            positions: vec![self.at.to_vec(); rows + 1],
            gripper: BTreeMap::from([("finger".into(), GripperValue::Rows((0..=rows).map(value).collect()))]),
            attached: None,
        }
    }
}

/// grasp_center in the world.
fn tool([x, y, z, yaw]: [f64; 4]) -> Pose {
    Pose::from_parts(Vector::new(x, y, TOOL_HEIGHT + z), Rotation::from_rotation_z(yaw) * Rotation::from_rotation_x(PI))
}

fn placed(pose: &Pose) -> PlacedPose {
    PlacedPose { position: pose.translation.to_array(), quaternion: pose.rotation.to_array() }
}
