//! Round trips through both formats: positions equal, clocks rising, durations equal.

use clearway_export::{ExportError, Layout, csv, exporters, joint_trajectory};
use clearway_plan::PlanFile;
use serde_json::{Value, json};

/// A step per name: transit, approach, grasp, transfer, release, retreat; two joints, one of the gripper.
fn plan(objects: &[&str]) -> PlanFile {
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
            json!({"object": id, "tool": "tool", "pose_in_tool": {"position": [0, 0, 0], "quaternion": [0, 0, 0, 1]}})
        });
        json!({"kind": kind, "times": times, "positions": positions, "gripper": {"finger_joint": gripper}, "attached": attached})
    };
    let steps: Vec<Value> = objects
        .iter()
        .map(|id| {
            let segments = vec![
                segment("transit", 30, 0.3, json!(0.0), None),
                segment("approach", 7, -0.2, json!(0.0), None),
                segment("grasp", 4, 0.0, json!([0.0, 0.1, 0.2, 0.3]), None),
                segment("transfer", 41, 0.5, json!(0.3), Some(id)),
                segment("release", 3, 0.0, json!([0.3, 0.15, 0.0]), None),
                segment("retreat", 6, 0.1, json!(0.0), None),
            ];
            json!({"object": id, "action": "pick_place", "segments": segments,
                   "placed": {"position": [0, 0, 0], "quaternion": [0, 0, 0, 1]}})
        })
        .collect();
    serde_json::from_value(json!({
        "format": "clearway-plan/1", "status": "solved", "seed": 1, "removed": objects,
        "scene": {"format": "clearway-scene/1", "frame": "map", "robot": {"model": "x"}, "objects": [], "target": "o1"},
        "robot": {"urdf": "<robot/>", "joints": ["pan", "lift"], "tool": "tool", "limits": {"velocity": {}, "acceleration": {}},
                  "hand": {"kind": "parallel", "frame": "tool", "links": [], "base_radius": 0.05, "finger_thickness": 0.01}},
        "steps": steps,
    }))
    .expect("a plan")
}

fn all_rows(plan: &PlanFile) -> Vec<Vec<f64>> {
    let mut rows: Vec<Vec<f64>> = Vec::new();
    for segment in plan.steps.iter().flat_map(|s| &s.segments) {
        let shared = usize::from(!rows.is_empty());
        rows.extend(segment.positions.iter().skip(shared).cloned());
    }
    rows
}

fn duration(plan: &PlanFile) -> f64 {
    plan.steps.iter().flat_map(|s| &s.segments).filter_map(|s| s.times.last()).sum()
}

fn seconds(stamp: &Value) -> f64 {
    stamp["sec"].as_f64().expect("sec") + stamp["nanosec"].as_f64().expect("nanosec") / 1e9
}

fn points(trajectory: &Value) -> &[Value] {
    trajectory["points"].as_array().expect("points")
}

fn numbers(value: &Value) -> Vec<f64> {
    value.as_array().expect("list").iter().map(|v| v.as_f64().expect("number")).collect()
}

#[test]
fn the_whole_trajectory_has_every_row_once_on_one_rising_clock() {
    let plan = plan(&["o1", "o2"]);
    let whole = joint_trajectory(&plan, Layout::Whole).expect("exported");
    assert_eq!(whole["header"], json!({"stamp": {"sec": 0, "nanosec": 0}, "frame_id": "map"}));
    assert_eq!(whole["joint_names"], json!(["pan", "lift"]));
    let points = points(&whole);
    assert_eq!(points.iter().map(|p| numbers(&p["positions"])).collect::<Vec<_>>(), all_rows(&plan));
    let times: Vec<f64> = points.iter().map(|p| seconds(&p["time_from_start"])).collect();
    assert!(times.windows(2).all(|w| w[0] < w[1]));
    assert!(points.iter().all(|p| p["time_from_start"]["nanosec"].as_u64() < Some(1_000_000_000)));
    assert!((times[times.len() - 1] - duration(&plan)).abs() < 1e-8);
}

#[test]
fn velocities_and_accelerations_are_those_of_a_parabola_and_end_at_rest() {
    let whole = joint_trajectory(&plan(&["o1"]), Layout::Whole).expect("exported");
    let points = points(&whole);
    let time = seconds(&points[10]["time_from_start"]);
    let (v, a) = (numbers(&points[10]["velocities"]), numbers(&points[10]["accelerations"]));
    assert!((v[0] - 2.0 * 0.3 * time).abs() < 1e-9 && (a[0] - 0.6).abs() < 1e-6, "{v:?} {a:?}");
    for end in [&points[0], &points[points.len() - 1]] {
        assert_eq!((numbers(&end["velocities"]), numbers(&end["accelerations"])), (vec![0.0; 2], vec![0.0; 2]));
    }
}

#[test]
fn the_sequence_alternates_between_arm_and_gripper_and_loses_nothing() {
    let plan = plan(&["o1", "o2"]);
    let sequence = joint_trajectory(&plan, Layout::Sequence).expect("exported");
    let items = sequence.as_array().expect("list");
    let names: Vec<&str> = items.iter().map(|i| i["name"].as_str().expect("name")).collect();
    assert_eq!(
        names,
        [
            "0_start",
            "1_o1_transit-approach",
            "1_o1_grasp",
            "1_o1_transfer",
            "1_o1_release",
            "1_o1_retreat_2_o2_transit-approach",
            "2_o2_grasp",
            "2_o2_transfer",
            "2_o2_release",
            "2_o2_retreat",
        ]
    );
    assert_eq!(
        items[2]["gripper"],
        json!([{"joint": "finger_joint", "command": {"position": 0.3, "max_effort": 0.0}}])
    );
    assert!(items[2].get("trajectory").is_none(), "the arm stands still");
    assert_eq!(items[5]["segments"][1], json!({"step": 2, "object": "o2", "kind": "transit", "start": 0.1}));
    let total: f64 = items.iter().map(|i| i["duration"].as_f64().expect("duration")).sum();
    assert!((total - duration(&plan)).abs() < 1e-8);
    let mut last: Option<Vec<f64>> = None;
    for item in items.iter().filter(|i| i.get("trajectory").is_some()) {
        let points = points(&item["trajectory"]);
        let ends = [&points[0], &points[points.len() - 1]].map(|p| numbers(&p["positions"]));
        assert_eq!(seconds(&points[0]["time_from_start"]), 0.0);
        assert!(
            (seconds(&points[points.len() - 1]["time_from_start"]) - item["duration"].as_f64().expect("duration"))
                .abs()
                < 1e-9
        );
        assert!(last.is_none_or(|last| last == ends[0]), "a trajectory starts where the last one ended");
        last = Some(ends[1].clone());
    }
}

#[test]
fn an_arm_that_moves_while_gripping_keeps_its_trajectory() {
    let mut plan = plan(&["o1"]);
    plan.steps[0].segments[2].positions[2][0] += 0.01;
    let sequence = joint_trajectory(&plan, Layout::Sequence).expect("exported");
    assert_eq!(points(&sequence[2]["trajectory"]).len(), 4);
    assert!(sequence[2].get("gripper").is_some());
}

/// A reader of RFC 4180 tables.
fn read_csv(text: &str) -> Vec<Vec<String>> {
    let (mut table, mut row, mut field, mut inside) = (Vec::new(), Vec::new(), String::new(), false);
    let mut chars = text.chars().peekable();
    while let Some(c) = chars.next() {
        match c {
            '"' if inside && chars.peek() == Some(&'"') => field.extend(chars.next()),
            '"' => inside = !inside,
            ',' if !inside => row.push(std::mem::take(&mut field)),
            '\n' if !inside => {
                row.push(std::mem::take(&mut field));
                table.push(std::mem::take(&mut row));
            }
            c => field.push(c),
        }
    }
    table
}

#[test]
fn the_table_reads_back_bit_for_bit_whatever_the_names() {
    let odd = "a \"big\", red\ncan";
    let plan = plan(&["o1", odd]);
    let table = read_csv(&csv(&plan).expect("exported"));
    assert_eq!(table[0], ["time", "step", "segment", "kind", "object", "attached", "pan", "lift", "finger_joint"]);
    let rows = &table[1..];
    let number = |text: &String| text.parse::<f64>().expect("number");
    assert_eq!(
        rows.iter().map(|r| r[6..8].iter().map(number).collect::<Vec<_>>()).collect::<Vec<_>>(),
        all_rows(&plan)
    );
    assert!(rows.windows(2).all(|w| number(&w[0][0]) < number(&w[1][0])));
    assert!((number(&rows[rows.len() - 1][0]) - duration(&plan)).abs() < 1e-8);
    assert!(rows.iter().all(|r| r.len() == table[0].len()));
    let held: Vec<_> = rows.iter().filter(|r| r[5] == odd).collect();
    assert_eq!(held.len(), 40, "a transfer's rows but the first, which ends the grasp");
    assert!(held.iter().all(|r| r[4] == odd && r[3] == "transfer" && r[1] == "2" && r[2] == "4" && r[8] == "0.3"));
}

#[test]
fn what_cannot_be_put_in_order_is_named_by_its_place() {
    let broken = |change: fn(&mut PlanFile)| {
        let mut plan = plan(&["o1"]);
        change(&mut plan);
        let error = csv(&plan).expect_err("refused").to_string();
        assert_eq!(error, joint_trajectory(&plan, Layout::Whole).expect_err("refused").to_string());
        error
    };
    assert!(broken(|p| p.steps.clear()).contains("`solved`"));
    assert!(
        broken(|p| p.steps[0].segments[1].times[3] = 0.04).starts_with("steps[0].segments[1].times[3]: found 0.04")
    );
    assert!(broken(|p| p.steps[0].segments[1].times[0] = 0.01).contains("expected 0;"));
    assert!(broken(|p| p.steps[0].segments[1].times[0] = f64::NAN).contains("times[0]: found NaN"));
    assert!(
        broken(|p| p.steps[0].segments[0].positions[2].push(1.0)).contains("positions[2]: found 3 numbers, expected 2")
    );
    assert!(broken(|p| p.steps[0].segments[0].positions[2][1] = f64::INFINITY).contains("found inf"));
    assert!(broken(|p| drop(p.steps[0].segments[0].positions.pop())).contains("found 29 rows, expected 30"));
    assert!(broken(|p| p.steps[0].segments[5].times.clear()).contains("segments[5].times: found no rows"));
    let error = broken(|p| {
        p.steps[0].segments[2]
            .gripper
            .insert("finger_joint".into(), clearway_plan::plan_file::GripperValue::Rows(vec![0.0]));
    });
    assert!(error.contains("gripper.finger_joint: found 1 values, expected 1 or 4"), "{error}");
}

#[test]
fn every_exporter_writes_what_its_name_says() {
    let plan = plan(&["o1"]);
    let names: Vec<_> = exporters().iter().map(|e| (e.name(), e.extension())).collect();
    assert_eq!(names, [("joint-trajectory", "json"), ("csv", "csv")]);
    for exporter in exporters() {
        let content = exporter.export(&plan).expect("exported");
        assert!(content.ends_with(b"\n"));
    }
    assert_eq!(
        csv(&PlanFile { steps: Vec::new(), ..plan }).expect_err("refused"),
        ExportError::NoMotion { status: "solved" }
    );
}
