//! What is wrong with a YAML document is told with its place; nothing hangs.
#![allow(clippy::unwrap_used)]

use clearway_files::{FileError, Located, yaml};
use proptest::prelude::*;
use serde::Deserialize;
use std::path::Path;

#[derive(Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
struct Shelf {
    name: String,
    #[serde(default)]
    objects: Vec<Can>,
}

#[derive(Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
struct Can {
    radius: f64,
    #[serde(default)]
    position: [f64; 3],
}

fn read(text: &str) -> Result<Located<Shelf>, FileError> {
    yaml::from_str(Path::new("shelf.yaml"), text)
}

#[track_caller]
fn refused(text: &str, place: (usize, usize), words: &[&str]) {
    let error = read(text).unwrap_err();
    let shown = error.to_string();
    assert_eq!(error.position(), Some(place), "{shown}");
    for word in words {
        assert!(shown.contains(word), "{word:?} is not in: {shown}");
    }
}

#[test]
fn unknown_keys_come_with_a_suggestion() {
    refused(
        "name: a\nobjects:\n  - raduis: 1\n",
        (3, 5),
        &["shelf.yaml:3:5: unknown key `raduis`, expected one of `radius`, `position`", "help: did you mean `radius`?"],
    );
    refused("name: a\ncolour: red\n", (2, 1), &["unknown key `colour`, expected one of `name`, `objects`"]);
}

#[test]
fn wrong_values_are_shown() {
    refused("name: a\nobjects:\n  - radius: big # or not\n", (3, 13), &["found `big`, expected a number"]);
    refused(
        "name: a\nobjects:\n  - {radius: 1, position: [1, 2]}\n",
        (3, 17),
        &["found 2 items, expected an array of length 3"],
    );
    refused("name: a\nobjects: 7\n", (2, 10), &["found `7`, expected a list"]);
    refused("name: [a]\n", (1, 7), &["expected text"]);
    refused("name: a\nobjects:\n", (2, 8), &["found nothing, expected a list"]);
    refused("name:\n", (1, 5), &["found nothing, expected text"]);
    refused("just some words", (1, 1), &["found `just some words`, expected a mapping, `key: value`"]);
    refused("objects: []\n", (1, 1), &["the key `name` is missing"]);
    refused("name: a\nname: b\n", (2, 1), &["the key `name` is given twice", "keep one"]);
}

#[test]
fn what_is_not_yaml_is_told() {
    refused("name: a\nobjects: }", (2, 10), &["shelf.yaml:2:10"]);
    refused("", (1, 1), &["empty file"]);
    refused("name: a\n---\nname: b\n", (3, 1), &["second document"]);
    assert!(read("\u{0}\u{1}\u{2}").is_err());
    assert!(read("just some words").is_err());
}

#[test]
fn json_is_yaml() {
    let one_line = r#"{"name":"a","objects":[{"radius":0.5,"position":[1,2,3e-1]}]}"#;
    let read_back = read(one_line).unwrap();
    assert_eq!(read_back.value.objects[0], Can { radius: 0.5, position: [1.0, 2.0, 0.3] });
    assert_eq!(read_back.position(&["objects", "0", "position", "2"]), Some((1, 54)));
    let tabs = "{\n\t\"name\":\t\"a\",\n\t\"objects\": [\n\t\t{\n\t\t\t\"radius\": 1\n\t\t}\n\t]\n}\n";
    assert_eq!(read(tabs).unwrap().value.objects[0].radius, 1.0);
    // Longer than a YAML key may be, on one line.
    let many = format!(r#"{{"name":"a","objects":[{}{{"radius":1}}]}}"#, r#"{"radius":1.0},"#.repeat(500));
    assert_eq!(read(&many).unwrap().value.objects.len(), 501);
    let escaped = read(r#"{"name": "A\/\t\ud83d\ude00"}"#).unwrap();
    assert_eq!(escaped.value.name, "A/\t😀");
}

#[test]
fn places_are_found_in_either_style() {
    let text =
        "name: é\nobjects:\n- radius: 1\n- position: [0, 1, 2]\n  radius: 2\n- {radius: 3, position: [9,\n   8, 7]}\n";
    let shelf = read(text).unwrap();
    assert_eq!(shelf.position(&[]), Some((1, 1)));
    assert_eq!(shelf.position(&["name"]), Some((1, 7)));
    assert_eq!(shelf.position(&["objects", "0"]), Some((3, 3)));
    assert_eq!(shelf.position(&["objects", "1", "radius"]), Some((5, 11)));
    assert_eq!(shelf.position(&["objects", "2", "position", "1"]), Some((7, 4)));
    // What the text does not hold: the nearest thing round it.
    assert_eq!(shelf.position(&["objects", "0", "position", "1"]), Some((3, 3)));
    assert_eq!(shelf.position(&["objects", "7"]), Some((3, 3)));
    assert_eq!(shelf.error(&["objects", "0", "radius"], "too thin").to_string(), "shelf.yaml:3:11: too thin");
}

#[test]
fn places_stop_at_aliases() {
    let text = "name: &n a\nobjects:\n- &can {radius: 1}\n- *can\n";
    let shelf = read(text).unwrap();
    assert_eq!(shelf.value.objects.len(), 2);
    assert_eq!(shelf.position(&["objects", "1", "radius"]), Some((4, 3)));
}

#[test]
fn depth_is_bounded() {
    for text in
        ["[".repeat(200_000), "- ".repeat(200_000), "{a: ".repeat(200_000), "name: ".to_owned() + &"[".repeat(300)]
    {
        let error = read(&text).unwrap_err();
        assert!(error.to_string().len() < 1000);
    }
    let mut blocks = String::from("name: a\nobjects:\n");
    for depth in 1..3000 {
        blocks += &format!("{}a:\n", " ".repeat(depth));
    }
    assert!(read(&blocks).is_err());
    // Not even under a type that takes anything.
    let error = yaml::from_str::<serde_json::Value>(Path::new("deep.yaml"), &"[".repeat(200_000)).unwrap_err();
    assert!(error.to_string().starts_with("deep.yaml:1:"), "{error}");
}

#[test]
fn alias_bombs_do_not_go_off() {
    let mut bomb = String::from("a0: &a0 [x, x, x, x, x, x, x, x, x, x]\n");
    for i in 1..12 {
        let before = format!("*a{}, ", i - 1).repeat(10);
        bomb += &format!("a{i}: &a{i} [{}]\n", before.trim_end_matches(", "));
    }
    let error = yaml::from_str::<serde_json::Value>(Path::new("bomb.yaml"), &bomb).unwrap_err();
    assert!(error.position().is_some(), "{error}");
    assert!(error.to_string().contains("too large or too deep"), "{error}");
    assert!(yaml::from_str::<serde_json::Value>(Path::new("self.yaml"), "a: &a [*a]").is_err());
}

proptest! {
    #[test]
    fn no_text_panics(text in ".{0,300}") {
        let _ = read(&text).map(|shelf| shelf.position(&["objects", "0", "radius"]));
    }

    #[test]
    fn no_yamlish_text_panics(text in "[-:\\[\\]{},&*!|>'\"#%@a0 \n\t]{0,120}") {
        let _ = yaml::from_str::<serde_json::Value>(Path::new("x.yaml"), &text).map(|v| v.position(&["a", "0", "a"]));
    }
}
