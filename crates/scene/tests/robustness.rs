//! No text makes reading panic or hang, and what is accepted is a fixed point.
#![allow(clippy::unwrap_used)]

use clearway_scene::Scene;
use proptest::prelude::*;
use std::path::Path;

const SCENE: &str = r#"format: clearway-scene/1
robot: {model: ur10_ag95, base: {position: [0, 0, 0.3], rpy: [0, 0, 0]}, start: {a: 0.1}, region: {min: [-1, -1], max: [1, 1]}}
fixtures:
  - {id: floor, box: {size: [0.6, 0.9, 0.02]}, position: [0.95, 0, 0.59]}
  - {id: beam, capsule: {radius: 0.02, height: 0.5}, position: [0.95, 0.4, 1.2], quaternion: [0, 0, 0, 1]}
objects:
  - {id: o1, cylinder: {radius: 0.037, height: 0.26}, position: [0.75, 0.10, 0.73]}
  - {id: o2, compound: [{box: {size: [0.1, 0.1, 0.1]}}, {sphere: {radius: 0.05}, position: [0, 0, 0.05]}], position: [0.9, 0.1, 0.65]}
  - {id: o3, sphere: {radius: 0.03}, position: [0.75, 0.10, 0.89]}
target: o1
place: [{id: tray, size: [0.5, 0.8], position: [0.1, -0.8, 0.5]}]
workspace: {min: [0, 0], max: [1, 1]}
exit: [0.4, 0]
camera: {position: [0, 0, 1], look_at: [1, 0, 0.7], fov: 1.0}
"#;

fn read(text: &str) -> Result<Scene, clearway_files::FileError> {
    Scene::from_text(Path::new("shelf.yaml"), text)
}

fn is_fixed_point(scene: &Scene) -> bool {
    let again = Scene::from_text(Path::new("again.json"), &serde_json::to_string(&scene.file).unwrap()).unwrap();
    again.file == scene.file
        && again.objects.iter().zip(&scene.objects).all(|(a, b)| a.pose == b.pose && a.support == b.support)
}

proptest! {
    #[test]
    fn no_text_panics(text in ".{0,200}") {
        let _ = read(&text);
    }

    #[test]
    fn no_mutation_panics(at in 0_usize..SCENE.len(), cut in 0_usize..8, insert in "[-:\\[\\]{},&*!|>'\"#%@a0.enif \n\t]{0,6}") {
        let end = (at + cut).min(SCENE.len());
        let text = format!("{}{insert}{}", &SCENE[..at], &SCENE[end..]);
        if let Ok(scene) = read(&text) {
            prop_assert!(is_fixed_point(&scene), "{text}");
        }
    }

    #[test]
    fn no_number_panics(which in 0_usize..60, value in prop_oneof![
        Just(".nan".to_owned()), Just(".inf".to_owned()), Just("-.inf".to_owned()), Just("1e308".to_owned()),
        Just("1e-308".to_owned()), Just("-0.0".to_owned()), any::<f64>().prop_map(|x| format!("{x:e}")),
        (-2.0..2.0).prop_map(|x: f64| format!("{x}"))]) {
        let mut count = 0;
        let words: Vec<String> = SCENE.split_inclusive([' ', '[', ',', ']', '}']).map(|word| {
            let digits = word.trim_end_matches([' ', ',', ']', '}']);
            if digits.parse::<f64>().is_err() {
                return word.to_owned();
            }
            count += 1;
            if count - 1 == which { word.replace(digits, &value) } else { word.to_owned() }
        }).collect();
        if let Ok(scene) = read(&words.concat()) {
            prop_assert!(is_fixed_point(&scene), "{}", words.concat());
        }
    }

    /// Noise of up to a millimetre on everything, stacks included, is snapped in a way that stays.
    #[test]
    fn noise_is_snapped_for_good(noise in prop::collection::vec(-0.0009..0.0009, 12)) {
        let stack = |i: usize, x: f64| format!(
            "  - {{id: a{i}, cylinder: {{radius: 0.04, height: 0.1}}, position: [{x}, 0, {}]}}\n  - {{id: b{i}, box: {{size: [0.07, 0.05, 0.02]}}, rpy: [0, 0, {i}], position: [{x}, 0, {}]}}\n  - {{id: c{i}, sphere: {{radius: 0.02}}, position: [{x}, 0, {}]}}\n",
            0.65 + noise[3 * i], 0.71 + noise[3 * i] / 2.0 + noise[3 * i + 1] / 2.0, 0.74 + noise[3 * i + 1] / 2.0 + noise[3 * i + 2] / 2.0);
        let objects: String = (0..4).map(|i| stack(i, 0.0795 * i as f64)).collect();
        let text = format!("format: clearway-scene/1\nrobot: {{model: r}}\nfixtures: [{{id: f, box: {{size: [1, 1, 0.2]}}, position: [0, 0, 0.5]}}]\nobjects:\n{objects}target: a0\n");
        let scene = read(&text);
        prop_assert!(scene.is_ok(), "{scene:?}");
        prop_assert!(is_fixed_point(&scene.unwrap()), "{text}");
    }
}
