//! Ctrl-C ends the program at once, whatever it does, and leaves nothing behind.
#![cfg(unix)]

mod program;

use program::{ARM, Done, Program, behind_a_wall, covered_tray};
use std::process::{Command, Stdio};
use std::time::{Duration, Instant};

/// The program has 100 ms; the rest is for a busy machine to start `kill` and notice the end.
const SOON: Duration = Duration::from_millis(400);

/// Starts, interrupts after `wait`, and says how it ended.
fn interrupted(program: &Program, arguments: &str, wait: Duration) -> Done {
    let child = program.command(arguments).stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().expect("spawned");
    std::thread::sleep(wait);
    let began = Instant::now();
    let sent = Command::new("kill").args(["-INT", &child.id().to_string()]).status().expect("kill runs");
    assert!(sent.success(), "{arguments}: ended by itself");
    let output = child.wait_with_output().expect("ended");
    let took = began.elapsed();
    println!("{arguments}: {took:?}");
    assert!(took < SOON, "{arguments}: {took:?}");
    Done::of(output)
}

#[test]
fn planning_is_130_and_writes_nothing() {
    let program = Program::new();
    program.write("scene.yaml", &covered_tray());
    for (scene, more) in [("scene.yaml", ""), ("scene.yaml", "--json"), ("shelf.yaml", "--improve 60")] {
        for wait in [100, 1000, 2500] {
            if !more.is_empty() && wait < 2500 {
                continue;
            }
            let before = program.files();
            let arguments = format!("plan {scene} -o plan.json --html page.html {more}");
            let done = interrupted(&program, &arguments, Duration::from_millis(wait));
            assert_eq!((done.code, done.out.as_str()), (Some(130), ""), "{arguments}: {}", done.err);
            assert!(done.err.contains("interrupted"), "{}", done.err);
            assert_eq!(program.files(), before, "{arguments}");
        }
    }
}

#[test]
fn drawing_a_scene_is_130() {
    let program = Program::new();
    let before = program.files();
    let done = interrupted(
        &program,
        "generate shelf --objects 80 --least-removals 80 -o scene.yaml",
        Duration::from_millis(500),
    );
    assert_eq!(done.code, Some(130), "{}", done.err);
    assert_eq!(program.files(), before);
}

#[test]
fn planning_a_motion_is_130_and_writes_nothing() {
    let program = Program::new();
    program.write("arm.urdf", ARM);
    program.write("problem.yaml", &behind_a_wall());
    let before = program.files();
    let done = interrupted(&program, "motion problem.yaml --time-limit 60 -o answer.json", Duration::from_millis(500));
    assert_eq!((done.code, done.out.as_str()), (Some(130), ""), "{}", done.err);
    assert_eq!(program.files(), before);
}

#[test]
fn a_benchmark_is_130_and_keeps_its_rows() {
    let program = Program::new();
    program.write("arm.urdf", ARM);
    let ball = r#"{"name": "ball", "position": [0.8, 0, 0], "radius": 0.1}"#;
    let wall = r#"{"name": "wall", "position": [0.45, 0, 0], "half_extents": [0.3, 0.01, 0.1]}"#;
    let problem = |more: &str| format!(r#"{{"start": [1.0, 0.0], "goals": [[-1.0, 0.0]], "sphere": [{ball}]{more}}}"#);
    let rows = [problem(""), problem(""), problem(&format!(r#", "box": [{wall}]"#))].join(", ");
    program
        .write("problems.json", &format!(r#"{{"joints": ["shoulder", "elbow"], "problems": {{"balls": [{rows}]}}}}"#));
    // The third problem has no answer, and all the time in the world.
    let arguments = "bench motion --robot arm.urdf --problems problems.json --repeats 1 --time-limit 600 --out results";
    let done = interrupted(&program, arguments, Duration::from_millis(1500));
    assert_eq!(done.code, Some(130), "{}", done.err);
    let kept = std::fs::read_to_string(program.path("results/motion.jsonl")).expect("rows");
    assert!(!kept.is_empty() && kept.ends_with('\n') && !program.path("results/summary.json").exists());
    for row in kept.lines() {
        let row: serde_json::Value = serde_json::from_str(row).expect("whole rows");
        assert_eq!(row["solved"], true);
    }
}
