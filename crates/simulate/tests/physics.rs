//! The physics against what can be worked out by hand.

mod gantry;

use clearway_simulate::Settings;
use gantry::{HEIGHT, RADIUS, TABLE, cylinder, plan, played, watch};
use serde_json::json;

const GRAVITY: f64 = 9.81;

#[test]
fn what_was_pushed_slides_as_far_as_friction_says() {
    for (speed, friction) in [(0.6, 0.4), (1.0, 0.4), (1.0, 0.25)] {
        let mut object = cylinder("o", 0.0);
        object["friction"] = json!(friction);
        // The palm, 0.1 m above the frame, meets the object at its middle, and stops at once.
        let height = TABLE + HEIGHT / 2.0 - 0.1;
        let steady =
            |to: f64, seconds: f64| gantry::Way { kind: "push", to: [to, height], seconds, steady: true, close: 0.0 };
        let ways = [steady(0.5, 1.0 / speed), steady(0.5, 1.0)];
        let slides = speed * speed / (2.0 * friction * GRAVITY);
        let ends = 0.5 + 0.02 + RADIUS + slides;
        let plan = plan("push", vec![object], Vec::new(), [-0.5, height], &ways, [ends, 0.0, TABLE + HEIGHT / 2.0]);
        // Without lag the hand lets it go where the rows stop.
        let found = played(&plan, &Settings { lag: 0.0, ..Settings::default() }).ends[0].found;
        let slid = found[0] - (0.5 + 0.02 + RADIUS);
        assert!((slid / slides - 1.0).abs() < 0.05, "{slid} m; expected {slides} m at {speed} m/s with {friction}");
        assert!(found[1].abs() < 2e-3, "{found:?}");
    }
}

#[test]
fn what_nothing_carries_falls() {
    let drop = 0.5;
    let ball = json!({"id": "b", "sphere": {"radius": 0.03}, "position": [1.0, 0, TABLE + 0.03 + drop]});
    let settings = Settings { settle: [0.0, 0.5], ..Settings::default() };
    let outcome = played(&watch(vec![ball], 1.0), &settings);
    let lands = outcome.touches.iter().find(|t| t.second.id == "b").expect("it lands").time;
    let expected = (2.0_f64 * drop / GRAVITY).sqrt();
    assert!((lands - expected).abs() < 3e-3, "{lands} s; expected {expected} s");
    assert!(outcome.end("b").is_some_and(|e| e.fallen));
}

#[test]
fn tilted_past_its_balance_a_cylinder_falls() {
    let balance = (2.0 * RADIUS / HEIGHT).atan();
    for (by, falls) in [(-0.07_f64, false), (0.07, true)] {
        let tilt = balance + by;
        let height = TABLE + HEIGHT / 2.0 * tilt.cos() + RADIUS * tilt.sin();
        let mut object = cylinder("c", 1.0);
        object["position"] = json!([1.0, 0, height]);
        object["rpy"] = json!([0, tilt, 0]);
        let outcome = played(&watch(vec![object], 2.0), &Settings::default());
        let lies = outcome.end("c").expect("an object").found[2] < TABLE + HEIGHT / 2.0 - 0.01;
        assert_eq!(lies, falls, "tilted by {:.1}°", tilt.to_degrees());
    }
}

#[test]
fn what_stands_stays() {
    let outcome = played(&watch(vec![cylinder("c", 1.0)], 2.0), &Settings::default());
    let end = outcome.end("c").expect("an object");
    assert!(end.distance < 2e-4 && end.tilt < 0.1, "{end:?}");
    assert!(outcome.as_planned && outcome.touches.is_empty(), "{outcome}");
}

/// Over the gap between two others, on what little of its rim is on them: taken for squares, the ends of cylinders
/// let it rock, and fall in the end.
#[test]
fn what_stands_on_two_stays() {
    let thing = |id: String, radius: f64, height: f64, [x, y, z]: [f64; 3]| {
        let mass = (500.0 * std::f64::consts::PI * radius * radius * height * 1e4).round() / 1e4;
        let cylinder = json!({"radius": radius, "height": height});
        json!({"id": id, "cylinder": cylinder, "position": [x, y, TABLE + z + height / 2.0], "mass": mass, "friction": 0.4})
    };
    let mut objects = Vec::new();
    for i in 0..20 {
        let (x, height) = (0.7758 + f64::from(i) * 0.1413, 0.1451 + f64::from(i) * 1e-3);
        objects.extend([
            thing(format!("above{i}"), 0.0368, height, [x, 0.0418, 0.2183]),
            thing(format!("left{i}"), 0.0378, 0.2183, [x, -0.0165, 0.0]),
            thing(format!("right{i}"), 0.0394, 0.2183, [x, 0.1017, 0.0]),
        ]);
    }
    let outcome = played(&watch(objects, 10.0), &Settings::default());
    let above: Vec<_> = outcome.ends.iter().filter(|end| end.object.starts_with("above")).collect();
    assert_eq!(above.len(), 20);
    for end in above {
        assert!(end.distance < 3e-4 && end.tilt < 0.05, "{end:?}");
    }
}
