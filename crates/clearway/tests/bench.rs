//! `clearway bench` on the paper's experiments: rows that survive, several at a time, tables from rows.

mod program;

use program::{Done, Program};
use serde_json::Value;
use std::collections::BTreeMap;
use std::fs;
use std::time::Duration;

/// Rows by their keys, without what differs from run to run. None stands twice.
fn rows(text: &str) -> BTreeMap<String, Value> {
    let mut all = BTreeMap::new();
    for line in text.lines() {
        let mut row: Value = serde_json::from_str(line).expect("a row");
        row.as_object_mut().expect("an object").remove("timing");
        let key = ["planner", "objects", "least_removals", "first_limit", "scene_seed", "seed"]
            .map(|k| row[k].to_string())
            .join(" ");
        assert!(all.insert(key, row).is_none(), "twice: {line}");
    }
    all
}

fn bench(program: &Program, out: &str, more: &str) -> Done {
    program.does(&format!("bench optimal --quick --time-limit 60 --out {out} {more}"))
}

fn kept(program: &Program, out: &str) -> BTreeMap<String, Value> {
    rows(&fs::read_to_string(program.path(out).join("optimal.jsonl")).expect("rows"))
}

#[test]
fn killed_and_resumed_it_is_the_same() {
    let program = Program::new();
    bench(&program, "whole", "");
    let whole = kept(&program, "whole");
    assert!(whole.len() >= 10 && whole.values().all(|row| row["status"] == "solved"));
    // Killed again and again, also before anything is there.
    let mut kills = 0;
    for round in 0..5 {
        let resume = if round == 0 { "" } else { "--resume" };
        let mut run = program
            .command(&format!("bench optimal --quick --time-limit 60 --out killed --jobs 2 {resume}"))
            .stderr(std::process::Stdio::null())
            .spawn()
            .expect("the program runs");
        std::thread::sleep(Duration::from_millis(50 + round * 700));
        kills += usize::from(run.try_wait().expect("its state").is_none());
        // It may have ended by itself.
        let _ = run.kill();
        run.wait().expect("ended");
    }
    assert!(kills > 0);
    bench(&program, "killed", "--resume");
    assert_eq!(kept(&program, "killed"), whole);
    // What a kill leaves of a row in the middle of writing is none.
    let path = program.path("killed").join("optimal.jsonl");
    let text = fs::read_to_string(&path).expect("rows");
    fs::write(&path, &text[..text.len() - 7]).expect("written");
    bench(&program, "killed", "--resume");
    assert_eq!(kept(&program, "killed"), whole);
}

#[test]
fn planners_agree_where_they_must() {
    let program = Program::new();
    let all = rows(&program.does("bench optimal --quick --time-limit 60").out);
    let of = |planner: &'static str| all.values().filter(move |row| row["planner"] == planner);
    let by_scene = |planner: &'static str| -> BTreeMap<u64, u64> {
        of(planner)
            .map(|row| (row["scene_seed"].as_u64().expect("a seed"), row["removed"].as_u64().expect("a count")))
            .collect()
    };
    let (exact, brute) = (by_scene("exact"), by_scene("brute_force"));
    assert_eq!(exact.keys().collect::<Vec<_>>(), [&2001, &3001, &4001]);
    for (scene, removed) in &exact {
        // Motions may fail where there are ways; routes may lead where brute force does not look.
        assert!(brute[scene].abs_diff(*removed) <= 1, "{scene}: {brute:?} {exact:?}");
    }
    for row in of("clearway") {
        let (removed, bound) = (row["removed"].as_u64().expect("a count"), row["bound"].as_u64().expect("a bound"));
        assert!(bound <= removed && bound <= exact[&row["scene_seed"].as_u64().expect("a seed")], "{row}");
        assert_eq!(
            (row["verdict"].as_str(), row["order"].as_array().map(Vec::len)),
            (Some("valid"), Some(removed as usize))
        );
        assert_eq!(row["scene"].as_str().map(str::len), Some(64));
    }
}

#[test]
fn tables_come_from_rows_alone() {
    let program = Program::new();
    bench(&program, "out", "");
    program.does("bench report out");
    let report = fs::read_to_string(program.path("out").join("report.md")).expect("a report");
    assert!(report.contains("Table VI") && !report.contains("Table I:"), "{report}");
    let first = program.files();
    program.does("bench report out");
    assert_eq!(program.files(), first);
}

#[test]
fn bad_use_is_told() {
    let program = Program::new();
    program.refuses("bench known --quick --resume", &["--out"]);
    program.refuses("bench optimal --jobs 0", &["--jobs"]);
    program.refuses("bench report .", &["holds no rows", "bench known --quick --out DIR"]);
    fs::create_dir(program.path("out")).expect("a directory");
    let settings = r#"{"experiment":"peers","quick":true,"time_limit":2.0,"version":"0.1.0"}"#;
    program.write("out/peers.settings.json", settings);
    program.write("out/peers.jsonl", "{}\nnonsense\n");
    program.refuses("bench peers --quick --out out", &["peers.jsonl", "is there already", "--resume"]);
    program.refuses("bench peers --out out --resume", &["peers.settings.json", "\"quick\":true", "\"quick\":false"]);
    program.refuses("bench peers --quick --out out --resume", &["peers.jsonl:1:", "is no row"]);
    program.refuses("bench report out", &["peers.jsonl:1:", "is no row"]);
}
