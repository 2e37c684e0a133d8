//! Ctrl-C ends the program at once, whatever it does, and leaves nothing behind.
#![cfg(unix)]

mod program;

use program::{Done, Program, covered_tray};
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
    let done = interrupted(&program, "generate shelf --objects 80 --least-removals 80 -o scene.yaml", Duration::from_millis(500));
    assert_eq!(done.code, Some(130), "{}", done.err);
    assert_eq!(program.files(), before);
}
