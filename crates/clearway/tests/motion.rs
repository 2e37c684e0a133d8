//! `clearway motion` and `clearway bench motion` from outside; paths are checked again by the tests
//! in Python.

mod program;

use program::{ARM, AROUND_A_BALL, Program, behind_a_wall};
use serde_json::{Value, json};

fn with_arm() -> Program {
    let program = Program::new();
    program.write("arm.urdf", ARM);
    program.write("problem.yaml", AROUND_A_BALL);
    program
}

/// Two problems of one set; the second one's goal touches the ball.
fn problems() -> Value {
    let ball = json!({"name": "ball", "position": [0.8, 0.0, 0.0], "radius": 0.1});
    json!({"robot": "planar", "joints": ["shoulder", "elbow"], "problems": {"balls": [
        {"index": 1, "start": [1.0, 0.0], "goals": [[-1.0, 0.0]], "sphere": [ball]},
        {"index": 2, "start": [1.0, 0.0], "goals": [[0.0, 0.0]], "sphere": [ball]},
    ]}})
}

#[test]
fn a_path_and_a_trajectory() {
    let program = with_arm();
    let done = program.does("motion problem.yaml -o answer.json");
    assert!(done.out.starts_with("solved: ") && done.out.contains("s of motion"), "{}", done.out);
    assert_eq!(done.err, "");
    let answer = program.json("answer.json");
    assert_eq!((&answer["format"], &answer["status"]), (&"clearway-path/1".into(), &"solved".into()));
    assert_eq!(answer["joints"], json!(["shoulder", "elbow"]));
    let path = answer["path"].as_array().expect("rows");
    assert_eq!(
        (&path[0], &path[path.len() - 1], &answer["goal"]),
        (&json!([1.0, 0.0]), &json!([-1.0, 0.0]), &json!(0))
    );
    assert!(path.len() > 2 && answer["cost"].as_f64() > Some(2.0), "{answer}");
    let rows = |key: &str| answer["trajectory"][key].as_array().map_or(0, Vec::len);
    assert!(rows("times") > 20 && rows("times") == rows("positions"));
}

#[test]
fn json_on_stdout_is_the_answer() {
    let program = with_arm();
    let read = |seed: u64| -> Value {
        let done = program.does(&format!("motion problem.yaml --json --seed {seed}"));
        let mut answer: Value = serde_json::from_str(&done.out).expect("one JSON object");
        answer["timing"] = Value::Null;
        answer
    };
    assert_eq!(read(3), read(3), "the same seed");
    assert_ne!(read(3)["path"], read(4)["path"], "another seed");
}

#[test]
fn no_way_is_4_and_says_why() {
    let program = with_arm();
    program.write("problem.yaml", &behind_a_wall());
    let done = program.run("motion problem.yaml --time-limit 0.3 -o answer.json --json");
    assert_eq!(done.code, Some(4), "{}{}", done.out, done.err);
    assert!(done.err.contains("no way from the start to the goal was found: the time was up"), "{}", done.err);
    let answer = program.json("answer.json");
    assert_eq!(answer["status"], "out_of_budget");
    assert!(answer["why"][0].as_str().is_some_and(|w| w.contains("nothing is proved")));
    assert_eq!(serde_json::from_str::<Value>(&done.out).expect("JSON"), answer);
}

#[test]
fn bad_problems_are_2_with_their_line() {
    let program = with_arm();
    let cases = [
        (
            "shoulder: 1.0",
            "shoulder: 3.5",
            "5:",
            "the start is out of limits: joint `shoulder` at 3.5, expected a value from -3 to 3",
        ),
        ("shoulder: 1.0", "shoulder: 0.0", "5:", "the start is in collision: fore touches ball"),
        (
            "[-1.0, 0.0]",
            "[0.0, 2.6]",
            "7:",
            "the goal is out of limits: joint `elbow` at 2.6, expected a value from -2.5 to 2.5",
        ),
        ("[-1.0, 0.0]", "[0.1, 0.0]", "7:", "the goal is in collision: fore touches ball"),
        ("radius: 0.1", "radius: .nan", "4:", "the radius of obstacle `ball` is NaN"),
        ("[0.8, 0.0, 0.0]", "[0.8, .inf, 0.0]", "4:", "position holds inf"),
        ("sphere: {radius: 0.1}", "points: {file: no.xyz, radius: 0.1}", "4:", "a point cloud without points"),
        ("arm.urdf", "bare.urdf", "2:", "a robot without a single collision shape"),
        ("acceleration: 4", "acceleration: 0", "8:", "the limit 0"),
    ];
    program.write("no.xyz", "");
    program.write("bare.urdf", &ARM.replace("collision>", "visual>"));
    for (from, to, line, words) in cases {
        assert!(AROUND_A_BALL.contains(from));
        program.write("problem.yaml", &AROUND_A_BALL.replace(from, to));
        program.refuses("motion problem.yaml -o answer.json", &[&format!("problem.yaml:{line}"), words]);
    }
    program.refuses("motion nothing.yaml", &["nothing.yaml", "no such file"]);
    program.write("problem.yaml", AROUND_A_BALL);
    program.refuses("motion problem.yaml -o problem.yaml", &["would be written over the input"]);
}

#[test]
fn bench_rows_then_a_summary() {
    let program = with_arm();
    program.write("problems.json", &problems().to_string());
    let done = program.does("bench motion --robot arm.urdf --problems problems.json --repeats 2");
    let lines: Vec<Value> = done.out.lines().map(|l| serde_json::from_str(l).expect("JSON")).collect();
    let [first, second, last] = lines.as_slice() else { panic!("{}", done.out) };
    assert_eq!((&first["set"], &first["index"], &first["solved"]), (&"balls".into(), &1.into(), &true.into()));
    assert_eq!((&second["solved"], &second["why"]), (&false.into(), &"goal: in collision: fore touches ball".into()));
    let summary = &last["summary"];
    assert_eq!((&summary["solved"], &summary["total"], &summary["spheres"]), (&1.into(), &2.into(), &5.into()));
    assert_eq!(summary["version"], env!("CARGO_PKG_VERSION"));
    assert!(done.err.contains("solved      1 of 2"), "{}", done.err);
}

#[test]
fn bench_keeps_what_is_there() {
    let program = with_arm();
    program.write("problems.json", &problems().to_string());
    let command = "bench motion --robot arm.urdf --problems problems.json --repeats 1 --out results";
    assert_eq!(program.does(command).out, "");
    assert_eq!(program.json("results/summary.json")["summary"]["total"], 2);
    program.refuses(command, &["results", "from an earlier run", "name another directory"]);
    program.refuses("bench motion --robot arm.urdf --problems problems.json --out arm.urdf/x", &["arm.urdf/x"]);
}
