//! What is let pass, and what is not, on either side of each tolerance; and reading.

mod gantry;

use clearway_plan::plan_file::{MeshFile, SegmentKind, Status};
use clearway_plan::scene_file::{Body, BoxKeys, MeshKeys, PointsKeys, Scale};
use clearway_plan::{Budget, PlanFile};
use clearway_verify::{CannotJudge, Rejected, Report, ViolationKind as Kind, accept, read_plan, verify, verify_file};
use rand::SeedableRng;
use rand_xoshiro::Xoshiro256PlusPlus;
use sha2::{Digest, Sha256};
use std::path::Path;
use std::time::Duration;

fn plan(seed: u64) -> PlanFile {
    gantry::plan(&mut Xoshiro256PlusPlus::seed_from_u64(seed))
}

fn judge(plan: &PlanFile) -> Report {
    verify(plan, Path::new(""), &Budget::unlimited()).expect("judged")
}

/// The highest that the gantry's bridge ever is: it slides along x with its top at 0.925 m.
fn lintel(plan: &mut PlanFile, overlap: f64) {
    // Wide enough to be met on the way to any object.
    plan.scene.fixtures.push(Body {
        id: "lintel".into(),
        r#box: Some(BoxKeys { size: [3.0, 3.0, 0.01] }),
        position: [0.0, 0.0, 0.925 + 0.005 - overlap],
        ..Body::default()
    });
}

#[test]
fn sliding_along_a_surface_is_not_touching_it() {
    for (overlap, touches) in
        [(0.0, false), (-1e-5, false), (5e-5, false), (9.9e-5, false), (1.2e-4, true), (5e-4, true)]
    {
        let mut plan = plan(1);
        // Below the rail, which is mounted: only the bridge can meet it.
        lintel(&mut plan, overlap);
        let report = judge(&plan);
        assert_eq!(report.has(Kind::Collision), touches, "overlap {overlap}: {report}");
    }
}

#[test]
fn what_rows_step_over_is_found() {
    // The palm gets a bead of 1 mm below it; specks of 1 mm lie on its way between two rows that are
    // several times as far apart.
    let mut base = plan(2);
    let bead = "<link name=\"palm\"><collision><origin xyz=\"0 0 -0.12\"/><geometry><sphere radius=\"0.001\"/></geometry></collision>";
    base.robot.urdf = base.robot.urdf.replace("<link name=\"palm\">", bead);
    assert!(judge(&base).is_valid());
    let (i, j, row) = fastest_transit(&base);
    let segment = &base.steps[i].segments[j];
    let (a, b) = (&segment.positions[row], &segment.positions[row + 1]);
    assert!((b[0] - a[0]).hypot(b[1] - a[1]) > 8e-3);
    for share in [0.25, 0.37, 0.5, 0.71] {
        let mut plan = base.clone();
        plan.scene.fixtures.push(Body {
            id: "speck".into(),
            r#box: Some(BoxKeys { size: [1e-3; 3] }),
            position: [a[0] + share * (b[0] - a[0]), a[1] + share * (b[1] - a[1]), 0.3],
            ..Body::default()
        });
        let report = judge(&plan);
        let found =
            report.violations.iter().find(|v| v.kind == Kind::Collision && (v.step, v.segment) == (Some(i), Some(j)));
        let found = found.unwrap_or_else(|| panic!("share {share}: {report}"));
        assert_eq!(found.row, Some(row), "{found}");
        assert!(found.what.starts_with("link palm is") && found.what.contains("inside fixture speck at"), "{found}");
    }
}

fn fastest_transit(plan: &PlanFile) -> (usize, usize, usize) {
    let mut best = (0.0, (0, 0, 0));
    for (i, step) in plan.steps.iter().enumerate() {
        for (j, segment) in step.segments.iter().enumerate().filter(|(_, s)| s.kind == SegmentKind::Transit) {
            for row in 0..segment.positions.len() - 1 {
                let (a, b) = (&segment.positions[row], &segment.positions[row + 1]);
                let travel = (b[0] - a[0]).hypot(b[1] - a[1]);
                if travel > best.0 {
                    best = (travel, (i, j, row));
                }
            }
        }
    }
    best.1
}

#[test]
fn gaps_and_overlaps_of_a_millimetre_with_the_support_are_noise() {
    for (down, kinds) in [
        (0.0, &[][..]),
        (0.9e-3, &[]),
        (-0.9e-3, &[]),
        (1.2e-3, &[Kind::Unsupported]),
        (-1.2e-3, &[Kind::Overlap, Kind::HeldCollision]),
    ] {
        let mut plan = plan(3);
        let table = plan.scene.fixtures.iter_mut().find(|f| f.id == "table").expect("the table");
        table.position[2] -= down;
        let report = judge(&plan);
        assert_eq!(report.is_valid(), kinds.is_empty(), "{down}: {report}");
        assert!(kinds.iter().all(|k| report.has(*k)), "{down}: {report}");
    }
}

#[test]
fn settling_by_a_millimetre_is_allowed() {
    for (down, valid) in [(0.9e-3, true), (2.5e-3, false)] {
        let mut plan = plan(4);
        for step in &mut plan.steps {
            step.placed.position[2] -= down;
        }
        for place in &mut plan.scene.place {
            place.position[2] -= down;
        }
        let tray = plan.scene.fixtures.iter_mut().find(|f| f.id == "tray").expect("the tray");
        tray.position[2] -= down;
        let report = judge(&plan);
        assert_eq!(report.is_valid(), valid, "{down}: {report}");
    }
}

#[test]
fn mesh_fixtures_and_point_clouds() {
    let folder = tempfile::tempdir().expect("a folder");
    // Two tetrahedra apart from each other, 20 cm over the table's corner: convex parts, with air between.
    let tetrahedron = |x: f64| format!("v {x} 0 0\nv {} 0 0\nv {x} 0.1 0\nv {x} 0 0.1\n", x + 0.1);
    let faces = |n: usize| {
        format!(
            "f {} {} {}\nf {} {} {}\nf {} {} {}\nf {} {} {}\n",
            n,
            n + 2,
            n + 1,
            n,
            n + 1,
            n + 3,
            n,
            n + 3,
            n + 2,
            n + 1,
            n + 2,
            n + 3
        )
    };
    let obj = tetrahedron(-1.2) + &tetrahedron(1.2) + &faces(1) + &faces(5);
    let cloud = "0.65 0.0 0.1\n0.65 0.1 0.1\n# a comment\n\n0.65 0.2 0.1\n";
    std::fs::write(folder.path().join("two.obj"), &obj).expect("written");
    std::fs::write(folder.path().join("cloud.xyz"), cloud).expect("written");
    let sha = |bytes: &str| Sha256::digest(bytes.as_bytes()).iter().map(|b| format!("{b:02x}")).collect::<String>();
    let mut plan = plan(5);
    plan.robot.meshes = vec![
        MeshFile { uri: "meshes/two.obj".into(), file: "two.obj".into(), sha256: sha(&obj) },
        MeshFile { uri: "cloud".into(), file: "cloud.xyz".into(), sha256: sha(cloud) },
    ];
    plan.scene.fixtures.push(Body {
        id: "two".into(),
        mesh: Some(MeshKeys { file: "meshes/two.obj".into(), scale: Some(Scale::Uniform(1.0)) }),
        position: [0.0, 0.0, 0.5],
        ..Body::default()
    });
    plan.scene.fixtures.push(Body {
        id: "cloud".into(),
        points: Some(PointsKeys { file: "cloud".into(), radius: 0.005 }),
        ..Body::default()
    });
    let judge = |plan: &PlanFile| verify(plan, folder.path(), &Budget::unlimited());
    let report = judge(&plan).expect("judged");
    assert!(report.is_valid(), "{report}");
    // Narrower, the parts close in on the column's way, but do not fill what is between.
    let mut closer = plan.clone();
    closer.scene.fixtures[6].mesh =
        Some(MeshKeys { file: "meshes/two.obj".into(), scale: Some(Scale::PerAxis([0.02, 1.0, 1.0])) });
    assert!(judge(&closer).expect("judged").has(Kind::Collision));
    // One point more, in the hand's home.
    let mut hit = plan.clone();
    hit.scene.fixtures[7].position = [-0.65, 0.0, 0.3];
    assert!(judge(&hit).expect("judged").has(Kind::Collision));
    // The palm with the same mesh, clear of the column, and around it.
    for (scale, touches) in [(0.05, false), (0.02, true)] {
        let mut with_mesh = plan.clone();
        let mesh = format!(
            "<link name=\"palm\"><collision><origin xyz=\"0 0 0.1\"/><geometry><mesh filename=\"meshes/two.obj\" scale=\"{scale} 1 1\"/></geometry></collision>"
        );
        with_mesh.robot.urdf = with_mesh.robot.urdf.replace("<link name=\"palm\">", &mesh);
        with_mesh.robot.unchecked_pairs.retain(|p| *p != ["column", "palm"]);
        assert_eq!(judge(&with_mesh).expect("judged").has(Kind::SelfCollision), touches, "scale {scale}");
    }
    let mut changed = plan.clone();
    changed.robot.meshes[0].sha256 = sha("other");
    assert!(matches!(judge(&changed), Err(CannotJudge::MeshChanged { .. })));
    let mut missing = plan.clone();
    missing.robot.meshes[0].file = "three.obj".into();
    assert!(matches!(judge(&missing), Err(CannotJudge::File(_))));
    let mut unlisted = plan;
    unlisted.robot.meshes.clear();
    assert!(matches!(judge(&unlisted), Err(CannotJudge::MeshNotListed { .. })));
}

#[test]
fn links_that_always_touch_may_go_unchecked() {
    // A block hangs from the bridge, two joints above the column, which is in it in every posture.
    let mut plan = plan(6);
    let collar = "<link name=\"bridge\"><collision><origin xyz=\"0 0 -0.5\"/><geometry><box size=\"4 4 0.6\"/></geometry></collision>";
    plan.robot.urdf = plan.robot.urdf.replace("<link name=\"bridge\">", collar);
    plan.robot.unchecked_pairs.push(["bridge".into(), "column".into()]);
    let report = judge(&plan);
    assert!(!report.has(Kind::UncheckedPair), "{report}");
    plan.robot.unchecked_pairs.push(["rail".into(), "column".into()]);
    assert!(judge(&plan).has(Kind::UncheckedPair));
}

#[test]
fn files_are_read_leniently() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("plan.json");
    let mut document = serde_json::to_value(plan(8)).expect("JSON");
    document["new"] = 1.into();
    document["scene"]["new"] = 1.into();
    document["scene"]["robot"]["new"] = 1.into();
    document["scene"]["robot"]["base"]["new"] = 1.into();
    document["scene"]["objects"][0]["new"] = 1.into();
    document["scene"]["objects"][1]["mass"] = 1.into();
    document["scene"]["fixtures"][0]["box"]["new"] = 1.into();
    document["scene"]["place"][0]["new"] = 1.into();
    document["steps"][0]["segments"][0]["new"] = 1.into();
    std::fs::write(&path, document.to_string()).expect("written");
    let report = verify_file(&path, &Budget::unlimited()).expect("judged");
    assert!(report.is_valid(), "{report}");
    let text = document.to_string();
    for broken in
        [&text[..text.len() / 2], "", "[]", "{}", &text.replace("\"seed\":0", "\"seed\":1e999"), &"[".repeat(100_000)]
    {
        std::fs::write(&path, broken).expect("written");
        assert!(matches!(verify_file(&path, &Budget::unlimited()), Err(CannotJudge::File(_))));
    }
    assert!(verify_file(folder.path(), &Budget::unlimited()).is_err());
}

#[test]
fn nothing_that_is_known_is_lost() {
    let shapes = serde_json::json!([
        {"id": "a", "box": {"size": [1.0, 2.0, 3.0]}, "position": [1.0, 0.0, 0.0], "rpy": [0.5, 0.0, 0.0]},
        {"id": "b", "cylinder": {"radius": 1.0, "height": 2.0}, "quaternion": [0.0, 0.0, 0.0, 1.0]},
        {"id": "c", "sphere": {"radius": 1.0}},
        {"id": "d", "capsule": {"radius": 1.0, "height": 2.0}},
        {"id": "e", "mesh": {"file": "m.stl", "scale": 2.0}},
        {"id": "f", "points": {"file": "p.xyz", "radius": 0.5}},
        {"id": "g", "compound": [
            {"box": {"size": [1.0, 2.0, 3.0]}, "position": [1.0, 0.0, 0.0], "rpy": [0.5, 0.0, 0.0]},
            {"cylinder": {"radius": 1.0, "height": 2.0}, "quaternion": [0.0, 0.0, 0.0, 1.0]},
            {"sphere": {"radius": 1.0}},
            {"capsule": {"radius": 1.0, "height": 2.0}},
            {"mesh": {"file": "m.stl", "scale": [1.0, 2.0, 3.0]}}]}
    ]);
    let rect = serde_json::json!({"min": [0.0, 0.0], "max": [1.0, 1.0]});
    let scene = serde_json::json!({
        "format": "clearway-scene/1", "name": "n", "frame": "f",
        "robot": {"model": "m", "base": {"position": [1.0, 0.0, 0.0], "rpy": [0.5, 0.0, 0.0]}, "start": {"j": 1.0}, "region": rect},
        "fixtures": shapes, "objects": shapes, "target": "a",
        "place": [{"id": "p", "size": [1.0, 1.0], "position": [0.0, 0.0, 0.0]}],
        "workspace": rect, "exit": [0.0, 1.0],
        "camera": {"position": [0.0, 0.0, 1.0], "look_at": [0.0, 0.0, 0.0], "fov": 1.0}
    });
    let mut document = serde_json::to_value(plan(8)).expect("JSON");
    document["scene"] = scene.clone();
    let file = tempfile::NamedTempFile::new().expect("a file");
    std::fs::write(file.path(), document.to_string()).expect("written");
    let read = read_plan(file.path()).expect("read").scene;
    assert_eq!(read, serde_json::from_value(scene).expect("a scene"));
}

#[test]
fn only_valid_plans_are_accepted() {
    let accepted = accept(plan(9), Path::new(""), &Budget::unlimited()).expect("valid");
    assert!(accepted.report().is_valid());
    assert_eq!(accepted.plan().removed, plan(9).removed);
    let mut unsolved = plan(9);
    unsolved.status = Status::OutOfBudget;
    match accept(unsolved, Path::new(""), &Budget::unlimited()) {
        Err(Rejected::Violations { report, .. }) => assert!(report.is_unsolved()),
        other => panic!("{other:?}"),
    }
    let mut senseless = plan(9);
    senseless.robot.urdf.clear();
    assert!(matches!(
        accept(senseless, Path::new(""), &Budget::unlimited()),
        Err(Rejected::Unjudged(CannotJudge::Urdf(_)))
    ));
    let spent = Budget::unlimited().with_time(Duration::ZERO);
    assert!(matches!(accept(plan(9), Path::new(""), &spent), Err(Rejected::Unjudged(CannotJudge::Stopped(_)))));
}

#[test]
fn jerk_is_judged_where_limits_of_it_are_given() {
    for (limits, valid) in [(Some(1000.0), true), (Some(1.0), false), (Some(f64::NAN), false), (None, true)] {
        let mut plan = plan(7);
        plan.robot.limits.jerk = limits.map(|limit| plan.robot.joints.iter().map(|j| (j.clone(), limit)).collect());
        let report = judge(&plan);
        assert_eq!(report.is_valid(), valid, "{limits:?}: {report}");
        assert_eq!(report.has(Kind::JerkLimit), limits == Some(1.0), "{limits:?}: {report}");
    }
}
