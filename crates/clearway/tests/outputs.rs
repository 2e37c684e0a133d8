//! Where output goes: nothing is destroyed, nothing is lost in silence, a wrong name costs no work.
#![cfg(unix)]

mod program;

use program::{Done, Program, covered_tray};
use std::fs::File;
use std::io::{BufRead, BufReader};
use std::process::Stdio;
use std::time::{Duration, Instant};

#[test]
fn what_cannot_be_written_is_told_before_planning() {
    let program = Program::new();
    // Planning this would take the whole time limit.
    program.write("shelf.yaml", &covered_tray());
    std::fs::create_dir(program.path("folder")).expect("a directory");
    let began = Instant::now();
    for option in ["-o", "--html"] {
        let refuses = |path: &str, words: &[&str]| program.refuses(&format!("plan shelf.yaml {option} {path}"), words);
        refuses("none/plan.json", &["none/plan.json", "its directory does not exist", "mkdir -p none"]);
        refuses("folder", &["folder: is a directory"]);
        refuses("shelf.yaml/plan.json", &["shelf.yaml/plan.json", "is a file"]);
        refuses("./folder/../shelf.yaml", &["shelf.yaml: would be written over the input"]);
    }
    program.refuses("plan shelf.yaml -o out --html ./out", &["would be written over another output"]);
    program.refuses("generate shelf -o none/scene.yaml", &["none/scene.yaml"]);
    assert!(began.elapsed() < Duration::from_secs(30), "{:?}", began.elapsed());
}

#[test]
fn plans_are_not_overwritten_by_what_is_made_of_them() {
    let program = Program::new();
    program.does("plan shelf.yaml -o plan.json");
    program.refuses("view plan.json -o plan.json", &["would be written over the input"]);
    program.refuses("export plan.json --to csv -o plan.json", &["would be written over the input"]);
    std::fs::copy(program.path("plan.json"), program.path("plan.html")).expect("copied");
    program.refuses("view plan.html", &["would be written over the input"]);
}

#[test]
fn a_read_only_directory_is_told() {
    use std::os::unix::fs::PermissionsExt;
    let program = Program::new();
    let folder = program.path("locked");
    std::fs::create_dir(&folder).expect("a directory");
    std::fs::set_permissions(&folder, std::fs::Permissions::from_mode(0o555)).expect("locked");
    // The superuser may write anywhere.
    if File::create(folder.join("probe")).is_err() {
        program.refuses("plan shelf.yaml -o locked/plan.json", &["locked/plan.json", "permission denied"]);
    }
}

#[test]
fn a_reader_that_goes_away_is_no_error() {
    let program = Program::new();
    let mut child =
        program.command("schema plan").stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().expect("spawned");
    let mut line = String::new();
    BufReader::new(child.stdout.take().expect("piped")).read_line(&mut line).expect("a line");
    let done = Done::of(child.wait_with_output().expect("ended"));
    assert_eq!((done.code, done.err.as_str()), (Some(0), ""));
}

#[test]
fn a_full_disk_is_an_error() {
    let program = Program::new();
    let Ok(full) = File::options().write(true).open("/dev/full") else { return };
    let done = Done::of(program.command("schema plan").stdout(full).output().expect("ran"));
    assert_eq!(done.code, Some(2));
    assert!(done.err.contains("stdout cannot be written"), "{}", done.err);
}

#[test]
fn devices_are_written_to() {
    let program = Program::new();
    program.does("plan shelf.yaml -o /dev/null --html /dev/null");
    let done = program.does("generate shelf --objects 5 -o /dev/stdout");
    assert!(done.out.starts_with("format: clearway-scene/1"), "{}", done.out);
}
