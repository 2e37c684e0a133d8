//! `clearway simulate`: how it ends, and what it refuses.

mod program;

use program::Program;
use serde_json::Value;

#[test]
fn as_planned_is_0_and_elsewhere_is_1() {
    let program = Program::new();
    program.does("plan shelf.yaml --seed 1 -o plan.json");
    let done = program.does("simulate plan.json");
    assert!(done.out.starts_with("ends as planned"), "{}", done.out);
    assert!(done.out.contains("settings: 1000 steps/s"), "{}", done.out);
    let done = program.does("simulate plan.json --noise 0.001 --trials 2 --seed 3 --json");
    let report: Value = serde_json::from_str(&done.out).expect("one JSON object");
    assert_eq!((&report["as_planned"], &report["seed"]), (&2.into(), &3.into()));
    // Pads of ice: nothing comes along.
    let done = program.run("simulate plan.json --rubber 0 --grip 0.1 --json");
    assert_eq!(done.code, Some(1), "{}{}", done.out, done.err);
    let report: Value = serde_json::from_str(&done.out).expect("one JSON object");
    assert_eq!(report["as_planned"], false);
}

#[test]
fn bad_input_is_2() {
    let program = Program::new();
    program.does("plan shelf.yaml --seed 1 -o plan.json");
    let text = std::fs::read_to_string(program.path("plan.json")).expect("a plan");
    let mut plan: Value = serde_json::from_str(&text).expect("JSON");
    plan["steps"] = Value::Array(Vec::new());
    program.write("empty.json", &plan.to_string());
    plan["status"] = "impossible".into();
    program.write("unsolved.json", &plan.to_string());
    program.write("torn.json", &text[..text.len() / 2]);
    program.refuses("simulate plan.json --noise -0.001", &["noise"]);
    program.refuses("simulate plan.json --noise-friction 2", &["friction"]);
    program.refuses("simulate plan.json --trials 0", &["trials"]);
    program.refuses("simulate plan.json --grip NaN", &["grip"]);
    program.refuses("simulate empty.json", &["nothing to play"]);
    program.refuses("simulate unsolved.json", &["impossible"]);
    program.refuses("simulate torn.json", &["torn.json"]);
    program.refuses("simulate nowhere.json", &["nowhere.json"]);
}
