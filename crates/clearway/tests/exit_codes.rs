//! How the program ends, and what it says and leaves behind then.

mod program;

use program::{Program, SHELF, closed_shelf, covered_tray, far_away, json, shelf_with};

#[test]
fn solved_is_0_and_verified() {
    let program = Program::new();
    let done = program.does("plan shelf.yaml --seed 1 -o plan.json --html page.html");
    assert!(done.out.starts_with("solved: ") && done.out.contains("verified: no violations"), "{}", done.out);
    assert_eq!(done.err, "");
    let plan = program.json("plan.json");
    assert_eq!(plan["status"], "solved");
    assert_eq!(plan["removed"].as_array().and_then(|r| r.last()), Some(&"o15".into()));
    assert!(program.path("page.html").exists());
    program.does("verify plan.json");
    program.does("explain plan.json");
    program.does("view plan.json -o again.html");
    for to in ["csv", "joint-trajectory"] {
        assert!(!program.does(&format!("export plan.json --to {to}")).out.is_empty());
    }
}

#[test]
fn json_is_one_object_on_stdout() {
    let program = Program::new();
    for (scene, code, status) in [(SHELF.to_owned(), 0, "solved"), (far_away(), 3, "impossible")] {
        program.write("scene.yaml", &scene);
        let done = program.run("plan scene.yaml --json -o plan.json");
        assert_eq!(done.code, Some(code), "{}", done.err);
        let summary: serde_json::Value = serde_json::from_str(&done.out).expect("one JSON object");
        assert_eq!(summary["status"], status);
        assert_eq!(summary["plan"], "plan.json");
    }
}

#[test]
fn violations_are_1() {
    let program = Program::new();
    program.does("plan shelf.yaml -o plan.json");
    let text = std::fs::read_to_string(program.path("plan.json")).expect("a plan");
    let spoilt = text.replacen("\"removed\":[", "\"removed\":[\"nobody\",", 1);
    assert_ne!(spoilt, text);
    program.write("spoilt.json", &spoilt);
    let done = program.run("verify spoilt.json");
    assert_eq!(done.code, Some(1), "{}{}", done.out, done.err);
    assert!(done.out.contains("nobody"), "{}", done.out);
    let done = program.run("verify spoilt.json --json");
    assert_eq!(done.code, Some(1));
    assert!(serde_json::from_str::<serde_json::Value>(&done.out).expect("JSON").is_object());
}

#[test]
fn proved_impossible_is_3_and_says_why() {
    let program = Program::new();
    for scene in [far_away(), closed_shelf()] {
        program.write("scene.yaml", &scene);
        let done = program.run("plan scene.yaml -o plan.json");
        assert_eq!((done.code, done.out.as_str()), (Some(3), ""), "{}", done.err);
        assert!(done.err.starts_with("impossible: ") && done.err.contains("o15"), "{}", done.err);
        let plan = program.json("plan.json");
        assert_eq!(plan["status"], "impossible");
        assert!(plan["why"]["summary"].as_str().is_some_and(|s| s.contains("o15")));
        assert!(program.does("explain plan.json").out.contains("impossible"));
    }
}

/// Whatever way of asking: something has to be moved that never can be.
#[test]
fn goals_that_are_proved_out_of_reach_are_3_as_well() {
    let program = Program::new();
    program.write("scene.yaml", &closed_shelf());
    let goal = |text: &str| {
        program.write("goal.pddl", text);
        "--goal goal.pddl".to_owned()
    };
    for (asked, words) in [
        ("--symbolic", "`o15` has to be moved"),
        ("--symbolic --all-movable", "`o15` has to be moved"),
        ("(On o3 tray)", "`o3` has to be moved"),
        ("(forall (?o - item) (On ?o tray))", "`o1` has to be moved"),
        ("(or (On o3 tray) (On o4 tray))", "one of `o3`, `o4` has to be moved"),
    ] {
        let asked = if asked.starts_with('(') { goal(asked) } else { asked.to_owned() };
        let done = program.run(&format!("plan scene.yaml -o plan.json {asked}"));
        assert_eq!((done.code, done.out.as_str()), (Some(3), ""), "{asked}: {}", done.err);
        assert!(done.err.starts_with("impossible: ") && done.err.contains(words), "{asked}: {}", done.err);
        assert_eq!(program.json("plan.json")["status"], "impossible");
        std::fs::remove_file(program.path("plan.json")).expect("removed");
    }
}

#[test]
fn spent_budgets_are_4_and_say_why() {
    let program = Program::new();
    program.write("scene.yaml", &covered_tray());
    for limit in ["--iterations 1", "--time-limit 0.3", "--time-limit 1e-6"] {
        let done = program.run(&format!("plan scene.yaml -o plan.json {limit}"));
        assert_eq!((done.code, done.out.as_str()), (Some(4), ""), "{limit}: {}", done.err);
        assert!(done.err.starts_with("no plan: "), "{}", done.err);
        let plan = program.json("plan.json");
        assert_eq!(plan["status"], "out_of_budget");
        assert!(plan["why"]["summary"].as_str().is_some_and(|s| !s.is_empty()));
        std::fs::remove_file(program.path("plan.json")).expect("removed");
    }
}

#[test]
fn bad_scenes_are_2_with_their_line() {
    let program = Program::new();
    let line = |text: &str, part: &str| 1 + text.lines().position(|l| l.contains(part)).expect("a line");
    let cases = [
        (shelf_with("target: o15", "target: nobody"), "target:", "`nobody`"),
        (shelf_with("target: o15", "target: o15\ncolour: red"), "colour", "unknown key `colour`"),
        (shelf_with("  model: ur10_ag95", "  model: ur99"), "ur99", "no built-in robot is called `ur99`"),
        (shelf_with("  model: ur10_ag95", "  model: arms/mine.yaml"), "mine.yaml", "no such file"),
        (shelf_with("fixtures:\n", "  start:\n    elbow_joint: 9\nfixtures:\n"), "elbow_joint: 9", "elbow_joint"),
        (
            shelf_with(
                "fixtures:\n",
                "fixtures:\n- {id: post, box: {size: [0.2, 0.2, 0.2]}, position: [0.45, 0.16, 0.85]}\n",
            ),
            "robot:",
            "touches fixture `post`",
        ),
    ];
    for (scene, at, words) in cases {
        program.write("scene.yaml", &scene);
        let place = line(&scene, at);
        let near = [place, place + 1].map(|l| format!("scene.yaml:{l}:"));
        let done = program.run("plan scene.yaml -o plan.json");
        assert_eq!(done.code, Some(2), "{}", done.err);
        assert!(near.iter().any(|n| done.err.contains(n)), "line {place} is not in {}", done.err);
        assert!(done.err.contains(words), "{words}: {}", done.err);
        assert!(done.out.is_empty() && !program.path("plan.json").exists());
    }
}

#[test]
fn bad_robots_are_2_seen_from_the_scene() {
    let program = Program::new();
    program.write("scene.yaml", &shelf_with("  model: ur10_ag95", "  model: robot.yaml"));
    let robot = |acceleration: &str| {
        program.write(
            "robot.yaml",
            &format!("format: clearway-robot/1\nurdf: a.urdf\narm: {{base: a, tip: b}}\nlimits:\n  acceleration: {acceleration}\n"),
        );
    };
    for (acceleration, words) in [
        ("fast", "found string \"fast\", expected a number for all joints, or a mapping from joint to number"),
        (".nan", "found `.nan`, expected a finite number"),
        ("", "found nothing, expected a number for all joints"),
        ("[1, 2]", "found a list, expected a mapping"),
        ("{elbow: wide}", "found `wide`, expected a number"),
    ] {
        robot(acceleration);
        program.refuses("plan scene.yaml -o plan.json", &["scene.yaml:8:", "robot.yaml:5:", words]);
        program.refuses("robot robot.yaml", &["robot.yaml:5:", words]);
    }
    program.refuses("robot nothing.yaml", &["nothing.yaml", "no such file"]);
    program.does("robot ur10_ag95");
}

#[test]
fn nulls_are_as_good_as_nothing_in_a_plan() {
    let program = Program::new();
    program.does("plan shelf.yaml -o plan.json");
    let mut plan = program.json("plan.json");
    for key in ["why", "trace", "lower_bound", "timing", "stats"] {
        plan[key] = serde_json::Value::Null;
    }
    plan["robot"]["meshes"] = serde_json::Value::Null;
    plan["robot"]["fixed"] = serde_json::Value::Null;
    plan["news"] = 1.into();
    program.write("older.json", &plan.to_string());
    for command in ["verify", "explain", "view"] {
        program.does(&format!("{command} older.json"));
    }
}

#[test]
fn without_arguments_the_demo() {
    let program = Program::new();
    program.does("");
    assert_eq!(json(&program.path("clearway-demo.plan.json"))["status"], "solved");
    assert!(program.path("clearway-demo.html").exists());
}
