//! Whatever can be wrong with a scene file is told: file, line, column, what, and what to do.
#![allow(clippy::unwrap_used)]

use clearway_files::FileError;
use clearway_scene::Scene;
use std::fs;
use std::path::Path;

const GOOD: &str = "\
format: clearway-scene/1
name: shelf
robot:
  model: ur10_ag95
  base: {position: [0, 0, 0.3], rpy: [0, 0, 0]}
fixtures:
  - {id: floor, box: {size: [0.6, 0.9, 0.02]}, position: [0.95, 0, 0.59]}
  - {id: wall, box: {size: [0.02, 0.9, 0.5]}, position: [1.26, 0, 0.85]}
objects:
  - {id: o1, cylinder: {radius: 0.04, height: 0.26}, position: [0.75, 0.10, 0.73]}
  - {id: o2, cylinder: {radius: 0.04, height: 0.26}, position: [0.90, 0.10, 0.73]}
  - id: o3
    box:
      size: [0.06, 0.06, 0.2]
    position: [0.90, -0.10, 0.70]
target: o2
place:
  - {id: tray, size: [0.5, 0.8], position: [0.1, -0.8, 0.5]}
";

fn read(text: &str) -> Result<Scene, FileError> {
    Scene::from_text(Path::new("shelf.yaml"), text)
}

/// The good scene with one thing changed is refused at this place, in these words.
#[track_caller]
fn refused(from: &str, to: &str, place: (usize, usize), words: &[&str]) {
    assert_eq!(GOOD.matches(from).count(), 1, "{from}");
    let error = read(&GOOD.replace(from, to)).unwrap_err();
    let shown = error.to_string();
    assert_eq!(error.position(), Some(place), "{shown}");
    assert!(shown.starts_with(&format!("shelf.yaml:{}:{}: ", place.0, place.1)), "{shown}");
    for word in words {
        assert!(shown.contains(word), "{word:?} is not in: {shown}");
    }
}

#[test]
fn the_good_scene_is_good() {
    let scene = read(GOOD).unwrap();
    assert_eq!(scene.names, ["o1", "o2", "o3"]);
    assert_eq!((scene.target.index(), scene.file.frame.as_str()), (1, "world"));
}

#[test]
fn what_is_not_a_scene() {
    refused(
        "format: clearway-scene/1",
        "format: clearway-scene/2",
        (1, 9),
        &["found the format `clearway-scene/2`, expected `clearway-scene/1`"],
    );
    refused("format: clearway-scene/1\n", "", (16, 1), &["the key `format` is missing"]);
    assert!(read("this is no YAML mapping").is_err());
    assert!(read("{{{{").is_err());
    assert!(read("\u{0}").is_err());
    assert!(read("").unwrap_err().to_string().contains("an empty file"));
    refused("place:", "\tplace:", (16, 9), &["found a tab"]);
}

#[test]
fn unknown_keys() {
    refused(
        "o1, cylinder: {radius",
        "o1, cylinder: {raduis",
        (10, 25),
        &["unknown key `raduis`, expected one of `radius`, `height`", "help: did you mean `radius`?"],
    );
    refused("target:", "targte:", (16, 1), &["unknown key `targte`", "did you mean `target`?"]);
    refused("rpy: [0, 0, 0]", "rpi: [0, 0, 0]", (5, 33), &["unknown key `rpi`", "did you mean `rpy`?"]);
    refused("target: o2", "target: o2\ntarget: o1", (17, 1), &["the key `target` is given twice"]);
}

#[test]
fn sizes() {
    refused(
        "o1, cylinder: {radius: 0.04",
        "o1, cylinder: {radius: .nan",
        (10, 33),
        &["the radius of object `o1` is NaN, expected a positive, finite number of metres"],
    );
    refused("o1, cylinder: {radius: 0.04", "o1, cylinder: {radius: 0", (10, 33), &["is 0, expected a positive"]);
    refused(
        "o1, cylinder: {radius: 0.04, height: 0.26",
        "o1, cylinder: {radius: 0.04, height: -1",
        (10, 47),
        &["the height of object `o1` is -1"],
    );
    refused(
        "[0.6, 0.9, 0.02]",
        "[0.6, .inf, 0.02]",
        (7, 35),
        &["the size of fixture `floor` is inf, expected a positive, finite number of metres"],
    );
    refused(
        "[0.06, 0.06, 0.2]",
        "[60, 60, 2000]",
        (14, 22),
        &["is 2000, expected at most 1000 m", "lengths are in metres"],
    );
    refused(
        "o1, cylinder: {radius: 0.04, height: 0.26}",
        "o1, cylinder: {radius: 40, height: 260}",
        (10, 24),
        &["object `o1` measures 260 m, expected at most 10 m of what is moved", "lengths are in metres"],
    );
    refused("size: [0.5, 0.8]", "size: [0.5, 0]", (18, 28), &["a place's size is 0"]);
    refused("size: [0.5, 0.8]", "size: [0.5]", (18, 16), &["found 1 item"]);
    refused(
        "height: 0.26}, position: [0.75",
        "height: tall}, position: [0.75",
        (10, 47),
        &["found `tall`, expected a number"],
    );
}

#[test]
fn mass_friction_and_clearance() {
    refused(
        "target: o2",
        "friction: -0.4\ntarget: o2",
        (16, 11),
        &["the friction is -0.4, expected a number from 0.01 to 3", "leave the key out for 0.4"],
    );
    refused("target: o2", "friction: .nan\ntarget: o2", (16, 11), &["the friction is NaN"]);
    refused(
        "target: o2",
        "clearance: -0.001\ntarget: o2",
        (16, 12),
        &["the clearance is -0.001, expected a number from 0 to 0.2, metres"],
    );
    refused("target: o2", "clearance: 5\ntarget: o2", (16, 12), &["the clearance is 5"]);
    refused(
        "{id: o1, ",
        "{id: o1, mass: 0, ",
        (10, 20),
        &["the mass of object `o1` is 0, expected a number from 0.0001 to 1000, kilograms", "500 kg/m³"],
    );
    refused("{id: o1, ", "{id: o1, mass: 1e9, ", (10, 20), &["the mass of object `o1` is 1e9"]);
    refused("{id: o1, ", "{id: o1, friction: 50, ", (10, 24), &["the friction of object `o1` is 50"]);
    refused(
        "{id: floor, ",
        "{id: floor, friction: 0.3, ",
        (7, 27),
        &["`floor` has the key `friction`, expected no `friction`: only objects have one"],
    );
}

/// What is left out is filled in, and shown in the plan.
#[test]
fn defaults_of_mass_and_friction() {
    let scene = read(
        &GOOD
            .replace("target: o2", "friction: 0.3\ntarget: o2")
            .replace("{id: o1, ", "{id: o1, mass: 0.2, friction: 0.9, "),
    )
    .unwrap();
    let of = |i: usize| (scene.file.objects[i].mass.unwrap(), scene.file.objects[i].friction.unwrap());
    assert_eq!(of(0), (0.2, 0.9));
    // π · 0.04² · 0.26 m³ at 500 kg/m³.
    assert_eq!(of(1), (0.6535, 0.3));
    assert_eq!(of(2), (0.36, 0.3));
    assert_eq!((&scene.assumed.mass[..], &scene.assumed.friction[..]), (&["o2".into(), "o3".into()][..], &[][..]));
    assert_eq!(read(GOOD).unwrap().assumed.friction.len(), 3);
    assert_eq!((scene.file.clearance, read(GOOD).unwrap().file.friction), (Some(0.0), Some(0.4)));
}

#[test]
fn poses() {
    refused("[0.75, 0.10, 0.73]", "[0.75, .nan, 0.73]", (10, 71), &["position holds NaN, expected finite numbers"]);
    refused(
        "[0.75, 0.10, 0.73]",
        "[0.75, 1e300, 0.73]",
        (10, 71),
        &["position holds 1e300, expected coordinates within 10 km"],
    );
    refused("rpy: [0, 0, 0]", "rpy: [0, .inf, 0]", (5, 42), &["rpy holds inf"]);
    refused("rpy: [0, 0, 0]", "rpy: [0, 0, -90]", (5, 45), &["rpy holds -90, expected radians", "90° are 1.5708"]);
    refused(
        "rpy: [0, 0, 0]",
        "rpy: [0, 0, 0], quaternion: [0, 0, 0, 1]",
        (5, 61),
        &["both `rpy` and `quaternion` are given"],
    );
    refused(
        "rpy: [0, 0, 0]",
        "quaternion: [0, 0, 0, 0]",
        (5, 45),
        &["a quaternion of length 0, expected length 1", "the identity is [0, 0, 0, 1]"],
    );
}

#[test]
fn shapes() {
    refused(
        "o1, cylinder: {radius: 0.04, height: 0.26}",
        "o1",
        (10, 5),
        &["object `o1` has no shape, expected exactly one of `box`, `cylinder`"],
    );
    refused(
        "o1, cylinder",
        "o1, sphere: {radius: 0.1}, cylinder",
        (10, 22),
        &["object `o1` has 2 shapes: `cylinder`, `sphere`"],
    );
    refused(
        "o1, cylinder: {radius: 0.04, height: 0.26}",
        "o1, compound: []",
        (10, 24),
        &["the compound of object `o1` is empty"],
    );
    refused(
        "o1, cylinder: {radius: 0.04, height: 0.26}",
        "o1, compound: [{sphere: {radius: 0.1}}, {position: [0, 0, 0]}]",
        (10, 50),
        &["part 2 of object `o1` has no shape"],
    );
    refused(
        "o1, cylinder: {radius: 0.04, height: 0.26}",
        "o1, points: {file: a.xyz, radius: 0.1}",
        (10, 22),
        &["object `o1` is a point cloud", "only fixtures"],
    );
}

#[test]
fn names() {
    refused(
        "target: o2",
        "target: o9",
        (16, 9),
        &["the target `o9` is no object, expected one of `o1`, `o2`, `o3`", "did you mean `o1`?"],
    );
    refused("target: o2", "target: wall", (16, 9), &["it is a fixture"]);
    refused("id: o3", "id: o1", (12, 9), &["the id `o1` is taken by another object"]);
    refused("id: o3", "id: wall", (12, 9), &["the id `wall` is taken by another fixture"]);
    refused("id: o3", "id: ''", (12, 9), &["an object with an empty id"]);
    refused("id: o3", "id: \"a\\tb\"", (12, 9), &["control characters"]);
    refused("id: o3", &format!("id: {}", "x".repeat(65)), (12, 9), &["has 65 characters"]);
    refused("model: ur10_ag95", "model: ''", (4, 10), &["an empty robot model"]);
    let none = GOOD.split_once("objects:").unwrap().0.to_owned() + "objects: []\ntarget: o1\n";
    assert!(read(&none).unwrap_err().to_string().contains("shelf.yaml:9:10: no objects, expected at least one"));
    let many: String =
        (0..257).map(|i| format!("  - {{id: n{i}, sphere: {{radius: 0.01}}, position: [{i}, 0, 0]}}\n")).collect();
    let text = GOOD.replace("objects:\n", &format!("objects:\n{many}"));
    let error = read(&text).unwrap_err().to_string();
    assert!(error.contains("260 objects, expected at most 256"), "{error}");
}

#[test]
fn surroundings() {
    refused(
        "target: o2",
        "target: o2\ncamera: {position: [0, 0, 1], look_at: [1, 0, 1], fov: 60}",
        (17, 56),
        &["a field of view of 60", "radians"],
    );
    refused(
        "target: o2",
        "target: o2\ncamera: {position: [0, 0, 1], look_at: [0, 0, 1], fov: 1}",
        (17, 40),
        &["looks at the point where it stands"],
    );
    refused("target: o2", "target: o2\nworkspace: {min: [1, 0], max: [0, 1]}", (17, 19), &["min x is 1, max x is 0"]);
    refused("target: o2", "target: o2\nexit: [0, .nan]", (17, 11), &["exit holds NaN"]);
    refused(
        "model: ur10_ag95",
        "model: ur10_ag95\n  start: {elbow_joint: .nan}",
        (5, 24),
        &["the start of `elbow_joint` is NaN"],
    );
}

#[test]
fn overlaps() {
    refused(
        "[0.90, 0.10, 0.73]",
        "[0.82, 0.10, 0.73]",
        (11, 64),
        &[
            "object `o2` overlaps the object `o1` by 10.0 mm, expected at most 1 mm",
            "at [0.8300, 0.1000, 0.7300] it would be clear",
        ],
    );
    refused(
        "[0.90, 0.10, 0.73]",
        "[1.22, 0.10, 0.73]",
        (11, 64),
        &["object `o2` overlaps the fixture `wall` by 10.0 mm"],
    );
    refused("[0.90, 0.10, 0.73]", "[0.75, 0.10, 0.73]", (11, 64), &["object `o2` overlaps the object `o1` by 80.0 mm"]);
    // Up to a millimetre is noise.
    assert!(read(&GOOD.replace("[0.90, 0.10, 0.73]", "[0.8291, 0.10, 0.73]")).is_ok());
    refused("[0.90, 0.10, 0.73]", "[0.8288, 0.10, 0.73]", (11, 64), &["by 1.2 mm"]);
    assert!(read(&GOOD.replace("[0.90, 0.10, 0.73]", "[1.2109, 0.10, 0.73]")).is_ok());
}

#[test]
fn floating_and_sunk() {
    refused(
        "[0.90, -0.10, 0.70]",
        "[0.90, -0.10, 0.7012]",
        (15, 15),
        &["object `o3` floats 1.2 mm above the fixture `floor`", "at z = 0.7000 it would rest"],
    );
    refused(
        "[0.90, -0.10, 0.70]",
        "[0.90, -0.10, 0.6988]",
        (15, 15),
        &["object `o3` is sunk 1.2 mm into the fixture `floor`", "at z = 0.7000 it would rest"],
    );
    refused(
        "[0.90, -0.10, 0.70]",
        "[0.90, 0.10, 0.98]",
        (15, 15),
        &["object `o3` floats 20.0 mm above the object `o2`"],
    );
    refused(
        "[0.90, -0.10, 0.70]",
        "[0.90, 0.10, 0.955]",
        (15, 15),
        &["object `o3` is sunk 5.0 mm into the object `o2`"],
    );
    refused("[0.90, -0.10, 0.70]", "[0.90, -0.90, 0.70]", (15, 15), &["object `o3` floats: nothing is below it"]);
    assert!(read(&GOOD.replace("[0.90, -0.10, 0.70]", "[0.90, -0.10, 0.701]")).is_ok());
    assert!(read(&GOOD.replace("[0.90, -0.10, 0.70]", "[0.90, -0.10, 0.699]")).is_ok());
}

#[test]
fn falling() {
    refused(
        "[0.90, -0.10, 0.70]",
        "[0.90, -0.4623, 0.70]",
        (15, 15),
        &[
            "object `o3` is not stable: its centre of mass is 12.3 mm outside what carries it (`floor`)",
            "expected objects that stand by themselves, taken as solid and of one density",
            "help: at [0.9000, -0.4500, 0.7000] it would stand; or put something under it",
        ],
    );
    refused(
        "[0.90, -0.10, 0.70]",
        "[0.9600, 0.10, 0.96]",
        (15, 15),
        &["object `o3` is not stable: its centre of mass is 20.0 mm outside what carries it (`o2`)"],
    );
    // A board on the can, a weight on the board.
    let stack = |x: f64| {
        let board = "  - {id: o4, box: {size: [0.3, 0.1, 0.01]}, position: [0.90, 0.10, 0.865]}\n";
        let load = format!("  - {{id: o5, box: {{size: [0.05, 0.05, 0.1]}}, position: [{x}, 0.10, 0.92]}}\n");
        format!("{board}{load}target: o2\n")
    };
    refused(
        "target: o2\n",
        &stack(1.0),
        (16, 55),
        &[
            "object `o4` does not stand with `o5` on it",
            "help: together their centre of mass is 5.4 mm outside what carries them (`o1` and `o2`)",
        ],
    );
    assert!(read(&GOOD.replace("target: o2\n", &stack(0.95))).is_ok());
    // Half a millimetre over the edge is noise.
    assert!(read(&GOOD.replace("[0.90, -0.10, 0.70]", "[0.90, -0.4504, 0.70]")).is_ok());
    assert!(read(&GOOD.replace("[0.90, -0.10, 0.70]", "[0.90, -0.4506, 0.70]")).is_err());
    refused("[0.90, -0.10, 0.70]", "[0.90, -0.49, 0.70]", (15, 15), &["floats: nothing is below it"]);
}

#[test]
fn files_that_a_scene_names() {
    let dir = tempfile::tempdir().unwrap();
    let inside = dir.path().join("scene");
    fs::create_dir(&inside).unwrap();
    fs::write(dir.path().join("secret.stl"), "solid\nendsolid\n").unwrap();
    fs::write(inside.join("flat.obj"), "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n").unwrap();
    fs::write(inside.join("bad.obj"), "v 0 0 0\nf 1 2 3\n").unwrap();
    fs::write(inside.join("cube.obj"), CUBE).unwrap();
    fs::write(inside.join("cloud.xyz"), "0 0 0\n0.1 nan 0\n").unwrap();
    let read = |shape: &str| {
        let text = GOOD.replace("box: {size: [0.02, 0.9, 0.5]}", shape);
        Scene::from_text(&inside.join("shelf.yaml"), &text)
    };
    let refused = |shape: &str, column: usize, words: &str| {
        let error = read(shape).unwrap_err();
        assert_eq!(error.position(), Some((8, column)), "{error}");
        assert!(error.to_string().contains(words), "{words:?} is not in: {error}");
    };
    refused("mesh: {file: ../secret.stl}", 29, "../secret.stl: a path that leaves its directory");
    refused("mesh: {file: ../../../../../../../etc/passwd}", 29, "a path that leaves its directory");
    refused("mesh: {file: /etc/passwd}", 29, "an absolute path");
    refused("mesh: {file: none.stl}", 29, "no such file");
    refused("mesh: {file: .}", 29, "a mesh file without extension");
    refused("mesh: {file: flat.obj}", 29, "a mesh without volume");
    refused("mesh: {file: bad.obj}", 29, "bad.obj:2:1: a face names corner `2` of 1");
    refused("mesh: {file: cube.obj, scale: 0}", 46, "the scale of fixture `wall` is 0");
    refused("mesh: {file: cube.obj, scale: [1, -1, 1]}", 46, "the scale of fixture `wall` is -1");
    refused("mesh: {file: cube.obj, scale: big}", 39, "");
    refused("points: {file: cloud.xyz, radius: 0.01}", 31, "cloud.xyz:2:1: found `0.1 nan 0`");
    let scene = read("mesh: {file: cube.obj, scale: 0.01}").unwrap();
    assert_eq!((scene.meshes.len(), scene.meshes[0].uri.as_str(), scene.meshes[0].sha256.len()), (1, "cube.obj", 64));
    fs::write(inside.join("cloud.xyz"), "0 0 0\n0.1 0.2 0.3\n").unwrap();
    assert_eq!(read("points: {file: cloud.xyz, radius: 0.01}").unwrap().fixtures[1].solid.parts.len(), 2);
}

const CUBE: &str = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 1 1 0\nv 0 0 1\nv 1 0 1\nv 0 1 1\nv 1 1 1\n\
f 1 3 2\nf 2 3 4\nf 5 6 7\nf 6 8 7\nf 1 2 5\nf 2 6 5\nf 3 7 4\nf 4 7 8\nf 1 5 3\nf 3 5 7\nf 2 4 6\nf 4 8 6\n";

#[test]
fn files_that_are_no_scenes() {
    let dir = tempfile::tempdir().unwrap();
    let missing = dir.path().join("none.yaml");
    let error = Scene::load(&missing).unwrap_err().to_string();
    assert!(error.contains("none.yaml: no such file\n  help: check the spelling"), "{error}");
    assert!(Scene::load(dir.path()).unwrap_err().found().contains("is a directory"));
    let big = dir.path().join("big.yaml");
    fs::File::create(&big).unwrap().set_len(50 * 1024 * 1024).unwrap();
    assert!(Scene::load(&big).unwrap_err().to_string().contains("holds 50.0 MiB, expected at most 8 MiB"));
    let latin = dir.path().join("latin.yaml");
    fs::write(&latin, b"name: \xe9").unwrap();
    assert_eq!(Scene::load(&latin).unwrap_err().position(), Some((1, 7)));
}

#[test]
fn bombs() {
    for text in [
        "[".repeat(200_000),
        "{a: ".repeat(200_000),
        format!("{GOOD}extra: {}", "[".repeat(200_000)),
        "- ".repeat(200_000),
    ] {
        assert!(read(&text).unwrap_err().to_string().len() < 1000);
    }
    let mut bomb = String::from("a: &a [1,1,1,1,1,1,1,1,1,1]\n");
    for (from, to) in ["a", "b", "c", "d", "e", "f", "g", "h"].iter().zip(["b", "c", "d", "e", "f", "g", "h", "i"]) {
        bomb += &format!("{to}: &{to} [{}]\n", vec![format!("*{from}"); 10].join(","));
    }
    assert!(read(&bomb).is_err());
    assert!(read(&format!("objects: *x\n{GOOD}")).is_err());
    let anchored = GOOD.replace("position: [0.75, 0.10, 0.73]", "position: &p [0.75, 0.10, 0.73]");
    assert!(read(&anchored).is_ok());
}

#[test]
fn a_scene_that_was_no_file() {
    let mut file = read(GOOD).unwrap().file;
    assert!(Scene::from_file_struct(file.clone(), Path::new("/nowhere")).is_ok());
    file.objects[1].position[2] += 0.5;
    let error = Scene::from_file_struct(file, Path::new("/nowhere")).unwrap_err().to_string();
    assert!(
        error.starts_with("scene: objects.1.position: object `o2` floats 500.0 mm above the fixture `floor`"),
        "{error}"
    );
}
