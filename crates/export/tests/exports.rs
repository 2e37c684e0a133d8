//! Round trips through both formats: positions equal, clocks rising, durations equal.

mod plan;

use clearway_export::{ExportError, Layout, csv, exporters, joint_trajectory, rename_joints};
use clearway_plan::PlanFile;
use plan::{all_rows, duration, plan};
use serde_json::{Value, json};

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
    assert_eq!(names, [("joint-trajectory", "json"), ("mcap", "mcap"), ("csv", "csv")]);
    for exporter in exporters() {
        let content = exporter.export(&plan).expect("exported");
        assert!(content.ends_with(if exporter.name() == "mcap" { mcap::MAGIC } else { b"\n" }));
    }
    assert_eq!(
        csv(&PlanFile { steps: Vec::new(), ..plan }).expect_err("refused"),
        ExportError::NoMotion { status: "solved" }
    );
}

#[test]
fn gripper_commands_tell_the_gap() {
    let mut plan = plan(&["o1"]);
    plan.robot.hand.joint = Some("finger_joint".into());
    plan.robot.hand.opening = [("0.0".to_owned(), 0.08), ("0.5".to_owned(), 0.0)].into();
    let sequence = joint_trajectory(&plan, Layout::Sequence).expect("exported");
    let gap = |item: usize| sequence[item]["gripper"][0]["gap"].as_f64().expect("a gap");
    assert!(gap(0) == 0.08 && (gap(2) - 0.032).abs() < 1e-12);
}

#[test]
fn joints_go_by_other_names() {
    let renamed = |pairs: &[(&str, &str)]| {
        let mut plan = plan(&["o1"]);
        plan.robot.hand.joint = Some("finger_joint".into());
        pairs.iter().try_for_each(|(old, new)| rename_joints(&mut plan, old, new))?;
        joint_trajectory(&plan, Layout::Sequence)
    };
    let names = |pairs: &[(&str, &str)]| {
        let sequence = renamed(pairs).expect("exported");
        (sequence[1]["trajectory"]["joint_names"].clone(), sequence[2]["gripper"][0]["joint"].clone())
    };
    assert_eq!(names(&[("", "left_")]), (json!(["left_pan", "left_lift"]), json!("left_finger_joint")));
    assert_eq!(names(&[("pan", "turn"), ("fin", "Fin")]), (json!(["turn", "lift"]), json!("Finger_joint")));
    assert_eq!(renamed(&[("tilt", "x")]).expect_err("refused"), ExportError::NoSuchName { old: "tilt".into() });
    let same = renamed(&[("pan", "lift")]).expect_err("refused").to_string();
    assert_eq!(same, "with `lift` for `pan` two joints have the same name");
}
