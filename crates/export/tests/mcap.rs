//! Bags read back with the `mcap` crate's reader, messages with a reader of CDR of the tests' own.

mod plan;

use clearway_export::{ExportError, Mcap, Mesh, mcap as export};
use clearway_plan::PlanFile;
use clearway_plan::plan_file::{Action, SegmentKind};
use plan::{all_rows, duration, plan};
use serde_json::{Value, json};
use std::collections::BTreeMap;

const SECOND: u64 = 1_000_000_000;

/// Fields in the order of a schema.
struct Reader<'a> {
    bytes: &'a [u8],
    at: usize,
}

impl<'a> Reader<'a> {
    fn new(message: &'a [u8]) -> Self {
        assert_eq!(message[..4], [0, 1, 0, 0]);
        Self { bytes: &message[4..], at: 0 }
    }

    fn take<const N: usize>(&mut self) -> [u8; N] {
        self.at = self.at.next_multiple_of(N);
        self.at += N;
        self.bytes[self.at - N..self.at].try_into().expect("bytes")
    }

    fn u32(&mut self) -> u32 {
        u32::from_le_bytes(self.take())
    }

    fn f32(&mut self) -> f32 {
        f32::from_le_bytes(self.take())
    }

    fn f64s<const N: usize>(&mut self) -> [f64; N] {
        [(); N].map(|()| f64::from_le_bytes(self.take()))
    }

    fn string(&mut self) -> String {
        let length = self.u32() as usize;
        self.at += length;
        assert_eq!(self.bytes[self.at - 1], 0);
        String::from_utf8(self.bytes[self.at - length..self.at - 1].to_vec()).expect("text")
    }

    fn list<T>(&mut self, read: impl Fn(&mut Self) -> T) -> Vec<T> {
        (0..self.u32()).map(|_| read(self)).collect()
    }

    fn numbers(&mut self) -> Vec<f64> {
        self.list(|r| r.f64s::<1>()[0])
    }

    fn time(&mut self) -> u64 {
        u64::from(self.u32()) * SECOND + u64::from(self.u32())
    }

    fn header(&mut self) -> (u64, String) {
        (self.time(), self.string())
    }
}

#[derive(Debug, PartialEq)]
struct Marker {
    frame: String,
    name: String,
    number: u32,
    kind: u32,
    position: [f64; 3],
    quaternion: [f64; 4],
    scale: [f64; 3],
    points: Vec<[f64; 3]>,
}

fn marker(r: &mut Reader) -> Marker {
    let (_, frame) = r.header();
    let (name, number, kind) = (r.string(), r.u32(), r.u32());
    assert_eq!(r.u32(), 0, "added");
    let (position, quaternion, scale) = (r.f64s(), r.f64s(), r.f64s());
    assert!((0..4).all(|_| (0.0..=1.0).contains(&r.f32())), "a colour");
    assert_eq!(r.time(), 0, "for ever");
    assert_eq!(r.take::<1>(), [1], "locked to its frame");
    let points = r.list(Reader::f64s);
    assert_eq!((r.u32(), r.string(), r.header(), r.string()), (0, String::new(), (0, String::new()), String::new()));
    assert_eq!(
        (r.u32(), r.u32(), r.string(), r.string(), r.string()),
        (0, 0, String::new(), String::new(), String::new())
    );
    assert_eq!((r.u32(), r.take::<1>()), (0, [0]));
    Marker { frame, name, number, kind, position, quaternion, scale, points }
}

fn markers(message: &[u8]) -> Vec<Marker> {
    let mut reader = Reader::new(message);
    let markers = reader.list(marker);
    assert_eq!(reader.at, reader.bytes.len(), "nothing is left");
    markers
}

/// Topic, time, bytes, in the file's order.
fn messages(bag: &[u8]) -> Vec<(String, u64, Vec<u8>)> {
    let message = |m: Result<mcap::Message, mcap::McapError>| {
        let m = m.expect("a message");
        assert_eq!(m.log_time, m.publish_time);
        (m.channel.topic.clone(), m.log_time, m.data.to_vec())
    };
    mcap::MessageStream::new(bag).expect("MCAP").map(message).collect()
}

fn on<'a>(messages: &'a [(String, u64, Vec<u8>)], topic: &str) -> Vec<(u64, &'a [u8])> {
    messages.iter().filter(|m| m.0 == topic).map(|m| (m.1, m.2.as_slice())).collect()
}

fn bag(plan: &PlanFile) -> Vec<(String, u64, Vec<u8>)> {
    messages(&export(plan, &[]).expect("exported"))
}

#[test]
fn the_bag_is_ros_2s_with_every_row_on_a_clock_that_never_goes_back() {
    let plan = plan(&["o1", "o2"]);
    let bytes = export(&plan, &[]).expect("exported");
    assert_eq!(bytes, export(&plan, &[]).expect("exported"), "the same plan gives the same bytes");

    let messages = messages(&bytes);
    assert!(messages.windows(2).all(|w| w[0].1 <= w[1].1));
    assert_eq!(messages[0].1, clearway_export::mcap::START);
    let last = messages[messages.len() - 1].1;
    assert!(((last - messages[0].1) as f64 / SECOND as f64 - duration(&plan)).abs() < 1e-8);
    let mut counts = BTreeMap::new();
    messages.iter().for_each(|m| *counts.entry(m.0.as_str()).or_insert(0) += 1);
    let rows = all_rows(&plan).len();
    assert_eq!(
        counts.into_iter().collect::<Vec<_>>(),
        [
            ("/events", 2 + 12),
            ("/joint_states", rows),
            ("/robot_description", 1),
            ("/scene/fixtures", 1),
            ("/scene/objects", 5),
            ("/tf", rows),
            ("/tf_static", 1),
            ("/trajectory", 5),
        ]
    );

    let summary = mcap::Summary::read(&bytes).expect("MCAP").expect("a summary");
    assert_eq!(summary.stats.as_ref().map(|s| s.message_count), Some(messages.len() as u64));
    assert_eq!(summary.metadata_indexes.iter().map(|m| m.name.as_str()).collect::<Vec<_>>(), ["rosbag2", "clearway"]);
    for channel in summary.channels.values() {
        let schema = channel.schema.as_ref().expect("a schema");
        assert_eq!((schema.encoding.as_str(), channel.message_encoding.as_str()), ("ros2msg", "cdr"));
        let latched =
            ["/robot_description", "/tf_static", "/scene/fixtures", "/scene/objects"].contains(&channel.topic.as_str());
        let durability = if latched { "durability: 1\n" } else { "durability: 2\n" };
        assert!(channel.metadata["offered_qos_profiles"].contains(durability), "{}", channel.topic);
    }
    let attachment = mcap::read::attachment(&bytes, &summary.attachment_indexes[0]).expect("attached");
    assert_eq!(attachment.name, "plan.json");
    assert!(attachment.data == serde_json::to_vec(&plan).expect("JSON"));
}

#[test]
fn joint_states_have_all_joints_and_velocities() {
    let plan = plan(&["o1"]);
    let bag = bag(&plan);
    let states: Vec<_> = on(&bag, "/joint_states")
        .into_iter()
        .map(|(time, message)| {
            let mut r = Reader::new(message);
            assert_eq!(r.header(), (time, String::new()));
            let names = r.list(Reader::string);
            assert_eq!(names, ["pan", "lift", "finger_joint", "extension", "other_finger_joint"]);
            (r.numbers(), r.numbers(), r.numbers())
        })
        .collect();
    assert_eq!(states.iter().map(|s| s.0[..2].to_vec()).collect::<Vec<_>>(), all_rows(&plan));
    assert!(states.iter().all(|s| s.0[3] == 0.2 && s.0[4] == 0.01 - s.0[2] && s.2.is_empty()));
    let fingers: Vec<f64> = states.iter().map(|s| s.0[2]).collect();
    assert_eq!(fingers[34..43], [0.0, 0.0, 0.1, 0.2, 0.3, 0.3, 0.3, 0.3, 0.3]);
    assert!((states[10].1[0] - 2.0 * 0.3 * 0.2).abs() < 1e-9, "{:?}", states[10].1);
    assert_eq!((&states[0].1, &states[states.len() - 1].1), (&vec![0.0; 5], &vec![0.0; 5]));
}

#[test]
fn frames_follow_the_joints() {
    let plan = plan(&["o1"]);
    let bag = bag(&plan);
    let frames = |message: &[u8]| {
        Reader::new(message).list(|r| {
            let (_, parent) = r.header();
            (format!("{parent} {}", r.string()), r.f64s::<3>(), r.f64s::<4>())
        })
    };
    let close = |a: &[f64], b: &[f64]| a.iter().zip(b).all(|(a, b)| (a - b).abs() < 1e-12);
    let half = std::f64::consts::FRAC_1_SQRT_2;

    let still = frames(on(&bag, "/tf_static")[0].1);
    assert_eq!(still.iter().map(|f| f.0.as_str()).collect::<Vec<_>>(), ["map base", "arm rail", "rail tool"]);
    assert!(close(&still[0].1, &[0.0, 0.0, 0.3]) && close(&still[0].2, &[0.0, 0.0, half, half]));
    assert!(close(&still[1].1, &[0.2, 0.0, 0.0]), "held out");
    assert!(close(&still[2].1, &[0.8, 0.0, 0.0]) && close(&still[2].2, &[half, 0.0, 0.0, half]));

    let rows = all_rows(&plan);
    for (row, (_, message)) in on(&bag, "/tf").into_iter().enumerate() {
        let moving = frames(message);
        let names: Vec<&str> = moving.iter().map(|f| f.0.as_str()).collect();
        assert_eq!(names, ["base column", "column arm", "rail left", "rail right"]);
        let [pan, lift] = [rows[row][0] / 2.0, rows[row][1] / 2.0];
        assert!(close(&moving[0].2, &[0.0, 0.0, pan.sin(), pan.cos()]));
        assert!(close(&moving[1].1, &[0.0, 0.0, 0.5]) && close(&moving[1].2, &[0.0, lift.sin(), 0.0, lift.cos()]));
        assert!((moving[2].1[1] + moving[3].1[1] - 0.01).abs() < 1e-12, "the fingers slide apart");
    }
}

#[test]
fn objects_stand_are_held_and_stand_again() {
    let plan = plan(&["o1", "o2"]);
    let bag = bag(&plan);
    let states: Vec<_> = on(&bag, "/scene/objects").into_iter().map(|(time, m)| (time, markers(m))).collect();
    let at = |i: usize, object: usize| {
        let marker = &states[i].1[object];
        (marker.frame.as_str(), marker.position)
    };
    let stood =
        ["o1", "o2"].iter().zip(&states[0].1).all(|(id, m)| m.name == *id && m.kind == 3 && m.scale == [0.1, 0.1, 0.2]);
    assert!(stood);
    assert_eq!([at(0, 0), at(0, 1)], [("map", [1.0, 0.0, 0.1]), ("map", [1.0, 1.0, 0.1])]);
    assert_eq!([at(1, 0), at(1, 1)], [("tool", [0.0, 0.0, 0.1]), ("map", [1.0, 1.0, 0.1])]);
    assert_eq!([at(2, 0), at(2, 1)], [("map", [-1.0, 0.0, 0.25]), ("map", [1.0, 1.0, 0.1])]);
    assert_eq!([at(4, 0), at(4, 1)], [("map", [-1.0, 0.0, 0.25]), ("map", [-1.0, 1.0, 0.25])]);
    assert!((states[4].1[1].quaternion[2] - 0.6).abs() < 1e-12);
    // Transit, approach and grasp are 30, 7 and 4 rows of 20 ms, whose ends are shared.
    assert_eq!(states[1].0, SECOND + 38 * SECOND / 50);
    assert_eq!(states[2].0, SECOND + 78 * SECOND / 50);
}

#[test]
fn what_is_pushed_goes_with_the_hand_or_evenly() {
    let mut plan = plan(&["o1"]);
    let step = &mut plan.steps[0];
    step.action = Action::Push;
    step.segments.drain(2..5);
    step.segments[1].kind = SegmentKind::Push;
    step.segments.truncate(2);
    let push = &mut step.segments[1];
    push.gripper.clear();
    // The arm turns by a tenth of a radian in a second: its tip, a metre out, goes sideways.
    push.times = (0..=50).map(|i| f64::from(i) * 0.02).collect();
    push.positions = push.times.iter().map(|t| vec![0.1 * (t - 0.5), 0.0]).collect();
    step.segments[0].positions.iter_mut().for_each(|row| *row = vec![-0.05, 0.0]);
    step.placed =
        serde_json::from_value(json!({"position": [1, 0.06, 0.1], "quaternion": [0, 0, 0, 1]})).expect("a pose");

    let places = |plan: &PlanFile| -> Vec<f64> {
        on(&bag(plan), "/scene/objects").iter().map(|(_, m)| markers(m)[0].position[1]).collect()
    };
    let even = places(&plan);
    assert_eq!(even.len(), 51);
    assert!(even.iter().enumerate().all(|(i, y)| (y - 0.06 * i as f64 / 50.0).abs() < 1e-12), "{even:?}");

    // The base is turned by a quarter: the tip goes along the world's -x.
    plan.steps[0].push = serde_json::from_value(json!({
        "direction": [-1, 0, 0], "distance": 0.06, "free": 0.03, "height": 0.1, "tips_at": 0.2, "margin_of_error": 0.01,
    }))
    .expect("a push");
    let pushed = places(&plan);
    assert_eq!((pushed[0], pushed[pushed.len() - 1]), (0.0, 0.06));
    assert!(pushed.windows(2).all(|w| w[0] < w[1]));
    let gone = |time: f64| ((0.1 * (time - 0.5)).sin() + 0.05_f64.sin() - 0.03).clamp(0.0, 0.06);
    let expected: Vec<f64> = (0..=50).map(|i| gone(f64::from(i) * 0.02)).collect();
    let first = expected.iter().position(|y| *y > 0.0).expect("pushed");
    assert!(first > 10, "the hand first comes near");
    for (y, expected) in pushed[1..].iter().zip(&expected[first..]) {
        assert!((y - expected).abs() < 1e-12, "{pushed:?}\n{expected:?}");
    }
}

#[test]
fn every_shape_is_drawn() {
    let mut plan = plan(&["o1"]);
    plan.scene.fixtures = serde_json::from_value(json!([
        {"id": "sphere", "sphere": {"radius": 0.1}},
        {"id": "capsule", "capsule": {"radius": 0.1, "height": 0.4}, "position": [1, 0, 0], "rpy": [0, std::f64::consts::FRAC_PI_2, 0]},
        {"id": "mug", "compound": [{"cylinder": {"radius": 0.04, "height": 0.1}}, {"box": {"size": [0.01, 0.02, 0.03]}, "position": [0.05, 0, 0]}],
         "position": [0, 1, 0]},
        {"id": "mesh", "mesh": {"file": "m.stl", "scale": [1, 2, 3]}},
        {"id": "cloud", "points": {"file": "c.xyz", "radius": 0.01}},
        {"id": "lost", "mesh": {"file": "lost.stl"}},
    ]))
    .expect("fixtures");
    let vertices = vec![[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
    let mesh = Mesh { uri: "m.stl".into(), vertices: vertices.clone(), triangles: vec![[0, 1, 2], [0, 1, 7]] };
    let cloud = Mesh { uri: "c.xyz".into(), vertices: vertices.clone(), triangles: Vec::new() };
    let bytes = export(&plan, &[mesh, cloud]).expect("exported");
    let drawn = markers(on(&messages(&bytes), "/scene/fixtures")[0].1);
    let shapes: Vec<_> = drawn.iter().map(|m| (m.name.as_str(), m.number, m.kind)).collect();
    assert_eq!(
        shapes,
        [
            ("sphere", 0, 2),
            ("capsule", 0, 3),
            ("capsule", 1, 2),
            ("capsule", 2, 2),
            ("mug", 0, 3),
            ("mug", 1, 1),
            ("mesh", 0, 11),
            ("cloud", 0, 7),
            ("tray", 0, 1),
        ]
    );
    assert!(drawn.iter().all(|m| m.frame == "map"));
    assert!(
        (drawn[2].position[0] - 1.2).abs() < 1e-12 && (drawn[3].position[0] - 0.8).abs() < 1e-12,
        "the capsule lies"
    );
    assert_eq!((drawn[5].position, drawn[5].scale), ([0.05, 1.0, 0.0], [0.01, 0.02, 0.03]));
    assert_eq!(drawn[6].points, [[1.0, 0.0, 0.0], [0.0, 2.0, 0.0], [0.0, 0.0, 3.0]]);
    assert_eq!((&drawn[7].points, drawn[7].scale), (&vertices, [0.02; 3]));
    assert_eq!(drawn[8].position, [-1.0, 0.0, 0.199], "a place's top is where the scene says");
}

#[test]
fn the_log_tells_the_steps() {
    let bag = bag(&plan(&["o1", "o2"]));
    let told = |message: &[u8]| {
        let mut r = Reader::new(message);
        let (time, level, name) = (r.time(), r.take::<1>()[0], r.string());
        assert_eq!((level, name.as_str()), (20, "clearway"));
        (time, r.string())
    };
    let log: Vec<(u64, String)> = on(&bag, "/events").into_iter().map(|(_, m)| told(m)).collect();
    let texts: Vec<&str> = log.iter().map(|l| l.1.as_str()).collect();
    assert_eq!(texts[..4], ["step 1 of 2: take o1: it is the target", "o1: transit", "o1: approach", "o1: grasp"]);
    assert_eq!(texts[7..9], ["step 2 of 2: take o2", "o2: transit"]);
    assert_eq!(log[2].0, SECOND + 29 * SECOND / 50);
}

#[test]
fn trajectories_are_those_of_the_sequence() {
    let plan = plan(&["o1", "o2"]);
    let sequence = clearway_export::joint_trajectory(&plan, clearway_export::Layout::Sequence).expect("exported");
    let expected: Vec<&Value> = sequence.as_array().expect("list").iter().filter_map(|i| i.get("trajectory")).collect();
    let bag = bag(&plan);
    let found = on(&bag, "/trajectory");
    assert_eq!(found.len(), expected.len());
    for ((_, message), expected) in found.into_iter().zip(expected) {
        let mut r = Reader::new(message);
        assert_eq!(r.header(), (0, "map".to_owned()), "from now");
        assert_eq!(json!(r.list(Reader::string)), expected["joint_names"]);
        let points = r.list(|r| {
            let (positions, velocities, accelerations, effort) = (r.numbers(), r.numbers(), r.numbers(), r.numbers());
            let (sec, nanosec) = (r.u32(), r.u32());
            json!({"positions": positions, "velocities": velocities, "accelerations": accelerations, "effort": effort,
                   "time_from_start": {"sec": sec, "nanosec": nanosec}})
        });
        assert_eq!(json!(points), expected["points"]);
    }
}

#[test]
fn a_root_link_that_is_the_world_is_not_said_twice() {
    let mut plan = plan(&["o1"]);
    plan.scene.frame = "base".into();
    assert_eq!(export(&plan, &[]).expect_err("refused"), ExportError::FrameTaken { frame: "base".into() });
    plan.scene.robot.base = Default::default();
    let parents = Reader::new(on(&bag(&plan), "/tf_static")[0].1).list(|r| {
        let (_, parent) = r.header();
        r.string();
        r.f64s::<7>();
        parent
    });
    assert_eq!(parents, ["arm", "rail"]);
    plan.scene.frame = "tool".into();
    assert!(export(&plan, &[]).is_err());
}

#[test]
fn plans_that_do_not_fit_together_are_refused() {
    let broken = |change: fn(&mut PlanFile)| {
        let mut plan = plan(&["o1"]);
        change(&mut plan);
        clearway_export::Exporter::export(&Mcap::default(), &plan).expect_err("refused").to_string()
    };
    let urdf = |from: &str, to: &str| {
        let mut plan = plan(&["o1"]);
        plan.robot.urdf = plan.robot.urdf.replacen(from, to, 1);
        export(&plan, &[]).expect_err("refused").to_string()
    };
    assert!(broken(|p| p.steps.clear()).contains("`solved`"));
    assert!(broken(|p| p.robot.urdf = "<robot".into()).starts_with("robot.urdf: found"));
    assert!(broken(|p| p.robot.joints[1] = "tool_joint".into()).starts_with("robot.joints[1]: found tool_joint"));
    assert!(broken(|p| p.steps[0].object = "o9".into()).starts_with("steps[0]: found `o9`, expected an object"));
    assert!(broken(|p| p.robot.tool = "x".into()).starts_with("the tool: found `x`"));
    assert!(broken(|p| p.steps[0].segments[0].times[29] = 3e9).contains("within 60 years"));
    assert!(urdf("finger_joint\" type=\"prismatic", "f\" type=\"prismatic").contains("mimicking `finger_joint`"));
    assert!(urdf("0 0 2", "0 0 0").contains("axis"));
    assert!(urdf("0 0 0.5", "0 0 x").contains("`xyz=\"0 0 x\"`"));
    assert!(urdf("type=\"fixed\"", "type=\"floating\"").contains("`floating`"));
    assert!(urdf("<link name=\"tool\"/>", "").contains("at link `tool`"));
    assert!(urdf("<link name=\"left\"/>", "<link name=\"left\"/><link name=\"left\"/>").contains("of one name"));
    assert!(
        urdf("<link name=\"left\"/>", "<link name=\"left\"/><link name=\"loose\"/>")
            .contains("2 links that hang from none")
    );
    assert!(urdf("<child link=\"column\"/>", "<child link=\"base\"/>").contains("hanging from itself"));
    assert!(urdf("<parent link=\"column\"/>", "<parent link=\"tool\"/>").contains("hanging from itself"));
}
