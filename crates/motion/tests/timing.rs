//! Timing against its own promises on any path, and against the closed form on straight ones.
#![allow(clippy::unwrap_used)]

use clearway_motion::{Corners, Curve, Limits, Posture, Timed, distance, slowdowns, time_curve};
use proptest::prelude::*;

fn timed(path: &[Posture], limits: &Limits, row: f64) -> Timed {
    let mut path = path.to_vec();
    path.dedup_by(|a, b| distance(a, b) < 1e-9);
    let corners = Corners::of(&path);
    time_curve(&Curve::through(&corners, &corners.widest()), limits, row)
}

fn check(timed: &Timed, path: &[Posture], limits: &Limits, row: f64) {
    let rows = &timed.positions;
    assert!(distance(&rows[0], &path[0]) < 1e-9 && distance(rows.last().unwrap(), path.last().unwrap()) < 1e-9);
    assert!(rows.iter().flatten().chain(&timed.times).all(|v| v.is_finite()));
    assert!(timed.times[0] == 0.0 && timed.times.windows(2).all(|t| t[1] > t[0] && t[1] - t[0] <= row * (1.0 + 1e-6)));
    let worst = slowdowns(&timed.times, &rows.concat(), limits).into_iter().fold(0.0, f64::max);
    assert!(worst <= 1.0 + 1e-6, "{worst}");
}

/// Duration of the seven-segment profile: jerk, acceleration, jerk, cruise and back (for instance
/// Biagiotti and Melchiorri 2008, section 3.4).
fn seven_segments(far: f64, v: f64, a: f64, j: f64) -> f64 {
    let rise = if v * j >= a * a { v / a + a / j } else { 2.0 * (v / j).sqrt() };
    if far >= v * rise {
        rise + far / v
    } else if far >= 2.0 * a.powi(3) / (j * j) {
        a / j + ((a / j).powi(2) + 4.0 * far / a).sqrt()
    } else {
        (32.0 * far / j).cbrt()
    }
}

#[test]
fn a_straight_line_takes_the_time_of_the_seven_segment_profile() {
    for far in [0.01, 0.05, 0.1, 0.3, 0.7, 1.0, 2.0, 4.0] {
        for (v, a, j) in [
            (2.0, 8.0, 80.0),
            (3.0, 8.0, 80.0),
            (1.0, 8.0, 40.0),
            (2.0, 15.0, 7500.0),
            (0.5, 2.0, 100.0),
            (50.0, 50.0, 60.0),
        ] {
            // Another joint that is slower by half but has half as far to go, and one that stands still.
            let limits = Limits { velocity: vec![v, v, 0.1], acceleration: vec![a, a, 0.1], jerk: vec![j, j, 0.1] };
            let path = [vec![0.3, -1.0, 0.5], vec![0.3 + far, -1.0 - far / 2.0, 0.5]];
            let found = timed(&path, &limits, 0.01);
            check(&found, &path, &limits, 0.01);
            let ratio = found.duration() / seven_segments(far, v, a, j);
            // Rows show means of a jerk: what lasts less than a row may be faster than it could be.
            assert!((0.96..1.02).contains(&ratio), "{far} {v} {a} {j}: {ratio}");
        }
    }
}

#[test]
fn dense_waypoints_of_an_arc_are_driven_without_slowing_down() {
    let arc = |count: usize| -> Vec<Posture> {
        (0..=count).map(|i| i as f64 * 1.2 / count as f64).map(|t| vec![t.sin(), t.cos()]).collect()
    };
    let limits = Limits { velocity: vec![2.0; 2], acceleration: vec![8.0; 2], jerk: vec![80.0; 2] };
    let straight = seven_segments(1.2, 2.0, 8.0, 80.0);
    for count in [30, 60, 240] {
        let found = timed(&arc(count), &limits, 0.016);
        check(&found, &arc(count), &limits, 0.016);
        assert!(found.duration() < 1.1 * straight, "{count}: {} {straight}", found.duration());
    }
}

#[test]
fn a_stop_is_a_rest() {
    let path = vec![vec![0.0, 0.0], vec![1.0, 0.0], vec![1.0, 1.0]];
    let limits = Limits { velocity: vec![2.0; 2], acceleration: vec![8.0; 2], jerk: vec![80.0; 2] };
    let found = time_curve(&Curve::through(&Corners::of(&path), &[0.0; 3]), &limits, 0.016);
    check(&found, &path, &limits, 0.016);
    assert!(found.positions.iter().any(|q| distance(q, &path[1]) < 1e-9));
    let expected = 2.0 * seven_segments(1.0, 2.0, 8.0, 80.0);
    assert!((found.duration() / expected - 1.0).abs() < 0.02, "{}", found.duration());
}

#[test]
fn no_length_gives_no_rows() {
    let limits = Limits { velocity: vec![1.0], acceleration: vec![1.0], jerk: vec![1.0] };
    assert!(timed(&[vec![1.0], vec![1.0]], &limits, 0.02).positions.is_empty());
    assert!(timed(&[], &limits, 0.02).positions.is_empty());
}

fn limits(joints: usize) -> impl Strategy<Value = Limits> {
    let of = |low: f64, high: f64| {
        prop::collection::vec((low..high, 0..12), joints)
            .prop_map(|all| all.into_iter().map(|(p, k)| if k == 0 { f64::INFINITY } else { 10f64.powf(p) }).collect())
    };
    (of(-1.0, 2.0), of(-1.0, 3.0), of(-1.0, 5.0)).prop_map(|(velocity, acceleration, jerk)| Limits {
        velocity,
        acceleration,
        jerk,
    })
}

/// A step from waypoint to waypoint: any, tiny, none, back, one joint only, or an arc of small ones.
fn steps(joints: usize) -> impl Strategy<Value = Vec<(u8, Posture)>> {
    prop::collection::vec((0u8..6, prop::collection::vec(-2.0..2.0f64, joints)), 1..7)
}

fn path_of(steps: &[(u8, Posture)]) -> Vec<Posture> {
    let mut path = vec![vec![0.1; steps[0].1.len()]];
    let mut last = steps[0].1.clone();
    for (kind, step) in steps {
        let moved = |from: &Posture, by: &dyn Fn(usize) -> f64| -> Posture {
            from.iter().enumerate().map(|(j, q)| q + by(j)).collect()
        };
        let here = path[path.len() - 1].clone();
        match kind {
            0 => path.push(moved(&here, &|j| step[j])),
            1 => path.push(moved(&here, &|j| 1e-6 * step[j])),
            2 => path.push(here),
            3 => path.push(moved(&here, &|j| -last[j])),
            4 => path.push(moved(&here, &|j| if j == 0 { step[0] } else { 0.0 })),
            _ => path.extend((1..40).map(|i| {
                let t = f64::from(i) * 0.03;
                moved(&here, &|j| step[j] * if j % 2 == 0 { t.sin() } else { 1.0 - t.cos() })
            })),
        }
        last.clone_from(step);
    }
    path
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 128, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn limits_hold_on_any_path(
        (limits, steps) in (1usize..8).prop_flat_map(|joints| (limits(joints), steps(joints))),
        row in 0.004..0.02f64,
    ) {
        let path = path_of(&steps);
        let found = timed(&path, &limits, row);
        if distance(&path[0], path.last().unwrap()) > 1e-9 {
            check(&found, &path, &limits, row);
        }
    }
}
