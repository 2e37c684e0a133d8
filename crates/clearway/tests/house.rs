//! Which rooms of the house may use which: the table of ARCHITECTURE.md, held against what
//! `cargo metadata` says.

use serde_json::Value;
use std::collections::BTreeMap;
use std::process::Command;

/// Crate, and the crates of the workspace that it may use.
const MAY_USE: [(&str, &[&str]); 17] = [
    ("geometry", &[]),
    ("files", &[]),
    ("plan", &["geometry"]),
    ("robot", &["geometry", "files", "plan"]),
    ("scene", &["geometry", "files", "plan"]),
    ("sight", &["geometry", "plan", "scene"]),
    ("collision", &["geometry", "plan", "robot", "scene"]),
    ("motion", &["geometry", "files", "plan", "robot", "scene", "collision"]),
    ("retrieval", &["geometry", "plan", "robot", "scene", "sight", "collision", "motion"]),
    ("symbolic", &["geometry", "files", "plan", "scene", "retrieval"]),
    ("verify", &["plan", "files"]),
    ("simulate", &["plan", "verify"]),
    ("scenarios", &["geometry", "plan", "robot", "scene", "sight", "collision", "retrieval"]),
    ("export", &["geometry", "plan"]),
    ("viewer", &["plan"]),
    (
        "experiments",
        &[
            "geometry",
            "files",
            "plan",
            "robot",
            "scene",
            "collision",
            "motion",
            "retrieval",
            "symbolic",
            "verify",
            "scenarios",
            "export",
            "viewer",
        ],
    ),
    (
        "clearway",
        &[
            "geometry",
            "files",
            "plan",
            "robot",
            "scene",
            "sight",
            "collision",
            "motion",
            "retrieval",
            "symbolic",
            "verify",
            "scenarios",
            "simulate",
            "export",
            "viewer",
            "experiments",
        ],
    ),
];

/// The workspace's crates without their prefix, each with those that it is built with.
fn arrows() -> BTreeMap<String, Vec<String>> {
    let output = Command::new(env!("CARGO"))
        .args(["metadata", "--no-deps", "--format-version", "1", "--offline"])
        .current_dir(env!("CARGO_MANIFEST_DIR"))
        .output()
        .expect("cargo runs");
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let metadata: Value = serde_json::from_slice(&output.stdout).expect("JSON");
    let room = |name: &Value| name.as_str().map(|n| n.trim_start_matches("clearway-").to_owned()).expect("a name");
    let list = |of: &Value, key: &str| of[key].as_array().cloned().expect("a list");
    let packages = list(&metadata, "packages");
    let rooms: Vec<String> = packages.iter().map(|p| room(&p["name"])).collect();
    packages
        .iter()
        .map(|package| {
            // Tests may look into any room; `kind` is null for what the crate itself uses.
            let used = list(package, "dependencies").into_iter().filter(|d| d["kind"] != "dev");
            let used = used.map(|d| room(&d["name"])).filter(|d| rooms.contains(d)).collect();
            (room(&package["name"]), used)
        })
        .collect()
}

#[test]
fn no_arrow_that_is_not_in_the_table() {
    let allowed: BTreeMap<&str, &[&str]> = MAY_USE.into_iter().collect();
    let mut wrong = Vec::new();
    for (room, used) in arrows() {
        match allowed.get(room.as_str()) {
            None => wrong.push(format!("{room} is not in the table")),
            Some(may) => {
                wrong.extend(used.iter().filter(|u| !may.contains(&u.as_str())).map(|u| format!("{room} uses {u}")))
            }
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

#[test]
fn the_table_is_of_the_house() {
    let rooms = arrows();
    for (room, _) in MAY_USE {
        assert!(rooms.contains_key(room), "there is no crate {room}");
    }
}
