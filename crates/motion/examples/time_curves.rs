//! Times rounded paths and prints them, for comparison with other programs.
//!
//! Reads from standard input, as JSON, a list of `{"path": [[…], …], "velocity": […],
//! "acceleration": […], "jerk": […]}`; prints a list of `{"knots", "pieces", "stops", "times",
//! "rows"}`. A piece is the position and its first three derivatives where it begins.
#![allow(clippy::unwrap_used)]

use clearway_motion::{Corners, Curve, Limits, Posture, time_curve};
use serde_json::{Value, json};

fn main() {
    let cases: Vec<Value> = serde_json::from_reader(std::io::stdin()).unwrap();
    let numbers =
        |value: &Value| -> Posture { value.as_array().unwrap().iter().map(|v| v.as_f64().unwrap()).collect() };
    let timed = cases.iter().map(|case| {
        let path: Vec<Posture> = case["path"].as_array().unwrap().iter().map(numbers).collect();
        let limits = Limits {
            velocity: numbers(&case["velocity"]),
            acceleration: numbers(&case["acceleration"]),
            jerk: numbers(&case["jerk"]),
        };
        let corners = Corners::of(&path);
        let curve = Curve::through(&corners, &corners.widest());
        let timed = time_curve(&curve, &limits, 0.016);
        let parts = curve.parts();
        let pieces: Vec<Vec<&[f64]>> =
            (0..curve.knots().len() - 1).map(|i| curve.piece(i).chunks(curve.joints()).collect()).collect();
        json!({
            "knots": curve.knots(),
            "pieces": pieces,
            "stops": parts.iter().skip(1).map(|p| p.start).collect::<Vec<_>>(),
            "times": timed.times,
            "rows": timed.positions,
        })
    });
    println!("{}", serde_json::to_string(&timed.collect::<Vec<_>>()).unwrap());
}
