//! With `--iterations`, the same seed gives the same plan bit for bit, `timing` aside.

mod program;

use program::Program;

#[test]
fn one_seed_one_plan_whatever_the_threads() {
    let program = Program::new();
    for objects in [12, 20] {
        program.does(&format!("generate shelf --objects {objects} --seed 4 -o scene.yaml"));
        let plan = |threads: usize| {
            let done =
                program.run(&format!("plan scene.yaml --seed 7 --iterations 20 --threads {threads} -o plan.json"));
            assert!(matches!(done.code, Some(0 | 4)), "{}", done.err);
            let mut plan = program.json("plan.json");
            plan.as_object_mut().expect("an object").remove("timing").expect("timing");
            plan.to_string()
        };
        let first = plan(1);
        assert_eq!(first, plan(1), "{objects} objects, run again");
        assert_eq!(first, plan(4), "{objects} objects, on 4 threads");
    }
}

#[test]
fn another_seed_another_plan() {
    let program = Program::new();
    let steps = |seed: usize| {
        program.does(&format!("plan shelf.yaml --seed {seed} --iterations 20 -o plan.json"));
        program.json("plan.json")["steps"].to_string()
    };
    assert_ne!(steps(1), steps(2));
}

#[test]
fn one_seed_one_scene() {
    let program = Program::new();
    let scene = || program.does("generate shelf --objects 12 --seed 9").out;
    assert_eq!(scene(), scene());
}
