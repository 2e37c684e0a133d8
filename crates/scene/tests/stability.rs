//! What stands and what falls, against closed forms.
#![allow(clippy::unwrap_used)]

use clearway_scene::{EDGE, Scene};
use proptest::prelude::*;
use std::f64::consts::{FRAC_PI_2, PI};
use std::path::Path;

/// On a table 1 m wide about the origin, its top at 0.
fn read(objects: &[String]) -> Result<Scene, String> {
    let list: String = objects.iter().enumerate().map(|(i, o)| format!("  - {{id: o{i}, {o}}}\n")).collect();
    let text = format!(
        "format: clearway-scene/1\nrobot: {{model: ur10_ag95}}\nfixtures:\n  - {{id: table, box: {{size: [1, 1, 0.02]}}, position: [0, 0, -0.01]}}\nobjects:\n{list}target: o0\n"
    );
    Scene::from_text(Path::new("stack.yaml"), &text).map_err(|e| e.to_string())
}

fn cuboid(size: [f64; 3], position: [f64; 3]) -> String {
    format!("box: {{size: {size:?}}}, position: {position:?}")
}

#[track_caller]
fn stands(objects: &[String]) {
    if let Err(error) = read(objects) {
        panic!("{error}");
    }
}

#[track_caller]
fn falls(objects: &[String], words: &[&str]) {
    let error = read(objects).unwrap_err();
    for word in words.iter().chain(&["expected objects that stand by themselves, taken as solid and of one density"]) {
        assert!(error.contains(word), "{word:?} is not in: {error}");
    }
}

/// A little on this side of what is forgiven, and on the other.
const STILL: f64 = EDGE - 1e-4;
const BEYOND: f64 = EDGE + 1e-4;

#[test]
fn a_box_over_the_edge_falls_when_its_centre_is_past_it() {
    let at = |x: f64| [cuboid([0.2, 0.1, 0.1], [x, 0.3, 0.05])];
    stands(&at(0.42));
    stands(&at(0.5 + STILL));
    falls(
        &at(0.5 + BEYOND),
        &["object `o0` is not stable: its centre of mass is 0.6 mm outside what carries it (`table`)"],
    );
    falls(
        &at(0.5123),
        &["12.3 mm outside", "help: at [0.5000, 0.3000, 0.0500] it would stand; or put something under it"],
    );
    let corner = |by: f64| [cuboid([0.2, 0.2, 0.1], [0.5 + by * 0.6, -0.5 - by * 0.8, 0.05])];
    stands(&corner(STILL));
    falls(&corner(BEYOND), &["0.6 mm outside"]);
}

#[test]
fn round_things_at_an_edge() {
    for shape in [
        "cylinder: {radius: 0.05, height: 0.1}",
        "sphere: {radius: 0.05}",
        "capsule: {radius: 0.05, height: 0.1}, rpy: [1.5707963, 0, 0]",
    ] {
        let at = |x: f64| [format!("{shape}, position: [{x}, 0.0, 0.05]")];
        stands(&at(0.3));
        stands(&at(0.5 + STILL));
        assert!(read(&at(0.502)).is_err(), "{shape}");
    }
}

#[test]
fn two_posts_carry_a_board() {
    let posts = |second: f64| {
        vec![
            cuboid([0.04, 0.04, 0.2], [-0.1, 0.0, 0.1]),
            cuboid([0.04, 0.04, 0.2], [second, 0.0, 0.1]),
            cuboid([0.4, 0.1, 0.02], [0.0, 0.0, 0.21]),
        ]
    };
    stands(&posts(0.1));
    // The middle over the second post's outer side, and past it.
    stands(&posts(-0.02 - STILL));
    falls(&posts(-0.02 - BEYOND), &["object `o2` is not stable", "0.6 mm outside what carries it (`o0` and `o1`)"]);
    falls(
        &posts(0.1)[1..2].iter().chain(&posts(0.1)[2..]).cloned().collect::<Vec<_>>(),
        &["`o1` is not stable", "80.0 mm outside"],
    );
}

#[test]
fn a_load_on_a_board_between_posts_may_lift_it() {
    // The board weighs 1, its load l; it turns about the post's outer side at 0.12.
    let with = |load: f64, x: f64| {
        vec![
            cuboid([0.04, 0.1, 0.2], [-0.1, 0.0, 0.1]),
            cuboid([0.04, 0.1, 0.2], [0.1, 0.0, 0.1]),
            cuboid([0.4, 0.1, 0.02], [0.0, 0.0, 0.21]),
            cuboid([0.02, 0.1, 0.4 * load], [x, 0.0, 0.22 + 0.2 * load]),
        ]
    };
    stands(&with(2.0, 0.1));
    let edge = |load: f64, by: f64| 0.12 + by + (0.12 + by) / load;
    stands(&with(2.0, edge(2.0, STILL)));
    falls(&with(2.0, edge(2.0, BEYOND)), &["object `o2` does not stand with `o3` on it", "put something under"]);
}

#[test]
fn a_cantilever_needs_its_counterweight() {
    let beam = |weight: f64| {
        vec![
            cuboid([0.1, 0.1, 0.1], [0.0, 0.0, 0.05]),
            cuboid([0.4, 0.1, 0.02], [0.1, 0.0, 0.11]),
            cuboid([0.1, 0.1, weight], [-0.05, 0.0, 0.12 + weight / 2.0]),
        ]
    };
    falls(
        &beam(0.02)[..2],
        &["object `o1` is not stable: its centre of mass is 50.0 mm outside what carries it (`o0`)"],
    );
    // 4 · 0.05 on one side of the edge, 0.1 · w / 0.02 on the other.
    stands(&beam(0.0402));
    falls(&beam(0.039), &["object `o1` is not stable"]);
}

/// Blocks overhang by 1/2, 1/4, 1/6, ... of their length, from above.
#[test]
fn harmonic_overhang() {
    for count in 1..9_usize {
        let stack = |by: f64| -> Vec<String> {
            // The end of what is below; the table's is at 0.5.
            let mut edge = 0.5 + by;
            let block = |k: usize| {
                edge += 0.1 / (count - k) as f64;
                cuboid([0.2, 0.1, 0.02], [edge - 0.1, 0.0, 0.01 + 0.02 * k as f64])
            };
            (0..count).map(block).collect()
        };
        stands(&stack(0.0));
        stands(&stack(STILL));
        let told = if count == 1 { "object `o0` is not stable" } else { "object `o0` does not stand with `o1` on it" };
        falls(&stack(BEYOND), &[told, "0.6 mm outside what carries"]);
    }
}

#[test]
fn a_cylinder_off_the_centre_of_another() {
    let can =
        |radius: f64, x: f64, z: f64| format!("cylinder: {{radius: {radius}, height: 0.1}}, position: [{x}, 0.0, {z}]");
    stands(&[can(0.04, 0.0, 0.05), can(0.06, 0.04 + STILL, 0.15)]);
    falls(
        &[can(0.04, 0.0, 0.05), can(0.06, 0.04 + BEYOND, 0.15)],
        &["`o1` is not stable", "0.6 mm outside what carries it (`o0`)"],
    );
    // Where the upper one ends does not matter, its centre does.
    stands(&[can(0.06, 0.0, 0.05), can(0.04, 0.059, 0.15)]);
    // Lying along another one, on top and beside.
    let lying = |x: f64, z: f64| {
        format!("cylinder: {{radius: 0.04, height: 0.2}}, rpy: [{FRAC_PI_2}, 0, 0], position: [{x}, 0.0, {z}]")
    };
    stands(&[lying(0.0, 0.04), lying(0.0, 0.12)]);
    falls(&[lying(0.0, 0.04), lying(0.01, 0.04 + (0.08_f64.powi(2) - 1e-4).sqrt())], &["`o1` is not stable", "5.0 mm"]);
    // Between the edges of two boxes; in the groove between two that would roll.
    let block = |x: f64| cuboid([0.1, 0.2, 0.1], [x, 0.0, 0.05]);
    stands(&[block(-0.08), block(0.08), lying(0.0, 0.1 + (0.04_f64.powi(2) - 0.03_f64.powi(2)).sqrt())]);
    let groove = 0.04 + (0.08_f64.powi(2) - 0.041_f64.powi(2)).sqrt();
    falls(&[lying(-0.041, 0.04), lying(0.041, 0.04), lying(0.0, groove)], &["does not stand with `o2` on it"]);
    // A ball and a capsule exactly on top of what is round.
    let ball = |z: f64| format!("sphere: {{radius: 0.03}}, position: [0.0, 0.0, {z}]");
    stands(&[ball(0.03), ball(0.09), ball(0.15)]);
    stands(&[
        lying(0.0, 0.04),
        format!("capsule: {{radius: 0.03, height: 0.1}}, rpy: [0, {FRAC_PI_2}, 0], position: [0.0, 0.0, 0.11]"),
    ]);
}

#[test]
fn three_feet() {
    // A plate on three legs at 0.1 from its middle, at 90°, 210° and 330°; something heavy hangs out at one side.
    let stool = |x: f64, y: f64| {
        let leg = |turn: f64| {
            let (s, c) = (PI * (0.5 + turn * 2.0 / 3.0)).sin_cos();
            format!("{{cylinder: {{radius: 0.01, height: 0.1}}, position: [{}, {}, -0.055]}}", 0.1 * c, 0.1 * s)
        };
        let legs = [0.0, 1.0, 2.0].map(leg).join(", ");
        vec![
            format!("compound: [{{cylinder: {{radius: 0.12, height: 0.01}}}}, {legs}], position: [0.0, 0.0, 0.105]"),
            format!("cylinder: {{radius: 0.02, height: 1.0}}, position: [{x}, {y}, 0.61]"),
        ]
    };
    stands(&stool(0.0, 0.0)[..1]);
    // The line of two legs is 0.05 from the middle, and they end 0.01 beyond.
    let load = 1.0 * 4e-4 / (0.01 * 0.12 * 0.12 + 3.0 * 0.1 * 1e-4);
    let edge = |by: f64| -(0.06 + by) * (1.0 + load) / load;
    stands(&stool(0.0, edge(STILL)));
    falls(
        &stool(0.0, edge(BEYOND)),
        &["object `o0` does not stand with `o1` on it", "0.6 mm outside what carries them (`table`)"],
    );
    stands(&stool(0.0, 0.09));
}

#[test]
fn posts_that_tip_together_under_what_they_share() {
    // Each foot's pillar stands at its outer end; half of the board is more than either bears.
    let arch = |span: f64, thick: f64| {
        let side = |s: f64| {
            format!(
                "compound: [{{box: {{size: [0.1, 0.1, 0.02]}}}}, {{box: {{size: [0.02, 0.1, 0.1]}}, position: [{}, 0, 0.06]}}, {{box: {{size: [0.1, 0.1, 0.02]}}, position: [{}, 0, 0.12]}}], position: [{}, 0, 0.01]",
                -s * 0.04,
                -s * 0.08,
                s * (span / 2.0 + 0.18)
            )
        };
        vec![side(1.0), side(-1.0), cuboid([span + 0.12, 0.1, thick], [0.0, 0.0, 0.14 + thick / 2.0])]
    };
    stands(&arch(0.1, 0.002));
    falls(&arch(0.1, 0.2), &["does not stand with `o2` on it", "help: move `o2`, or put something under `o"]);
}

/// Bricks in a pyramid, the lowest row's first: each but those rests on two.
fn pyramid(rows: usize) -> Vec<String> {
    let row =
        |r: usize| (0..rows - r).map(move |k| [0.1 * (k as f64 + 0.5 * r as f64) - 0.4, 0.0, 0.025 + 0.05 * r as f64]);
    (0..rows).flat_map(row).map(|at| cuboid([0.098, 0.05, 0.05], at)).collect()
}

#[test]
fn a_pyramid_of_bricks() {
    let mut bricks = pyramid(9);
    stands(&bricks);
    bricks.reverse();
    stands(&bricks);
    // Without a brick of the lowest row the others bridge it. The one above the first is held by its load alone.
    let without = |k: usize| [&pyramid(9)[..k], &pyramid(9)[k + 1..]].concat();
    stands(&without(4));
    stands(&without(0));
    falls(
        &pyramid(9)[1..17],
        &["object `o8` is not stable: its centre of mass is 1.0 mm outside what carries it (`o0`)"],
    );
}

#[test]
fn what_leans_a_little_by_measurement_stands() {
    stands(&["box: {size: [0.1, 0.1, 0.1]}, rpy: [0.005, -0.004, 1], position: [0, 0, 0.0503]".to_owned()]);
    falls(
        &["box: {size: [0.1, 0.1, 0.1]}, rpy: [0.05, 0, 0], position: [0, 0, 0.0524]".to_owned()],
        &["lay it on a face"],
    );
}

#[test]
fn what_parts_share_weighs_once() {
    // A thick bar through a head: if what they share counted twice, it would balance 3 mm nearer to the head.
    let (head, bar) = (0.1_f64.powi(3), 0.06_f64.powi(3));
    let hammer = |by: f64| {
        let x = 0.5 + by - 0.08 * bar / (head + bar);
        format!(
            "compound: [{{box: {{size: [0.1, 0.1, 0.1]}}}}, {{box: {{size: [0.16, 0.06, 0.06]}}, position: [0.03, 0, 0]}}], position: [{x}, 0, 0.05]"
        )
    };
    stands(&[hammer(STILL)]);
    falls(&[hammer(BEYOND)], &["0.6 mm outside"]);
}

/// A tower: of each body its half-width, whether it is round, its height, and how far it is aside from the one below.
#[derive(Clone, Debug)]
struct Level {
    half: f64,
    round: bool,
    height: f64,
    x: f64,
    y: f64,
}

/// How far a point is outside of what two upright things share, looked for by brute force.
fn outside(p: [f64; 2], a: &Level, b: &Level) -> f64 {
    let shape = |l: &Level, x: f64, y: f64| {
        let (dx, dy) = (x - l.x, y - l.y);
        if l.round { dx.hypot(dy) - l.half } else { dx.abs().max(dy.abs()) - l.half }
    };
    let both = |x: f64, y: f64| shape(a, x, y).max(shape(b, x, y));
    if both(p[0], p[1]) <= 0.0 {
        return both(p[0], p[1]);
    }
    let mut least = f64::INFINITY;
    for i in 0..720 {
        let (s, c) = (f64::from(i) * PI / 360.0).sin_cos();
        for j in 1..40 {
            let r = f64::from(j) * 1e-4;
            if both(p[0] + r * c, p[1] + r * s) <= 0.0 {
                least = least.min(r);
            }
        }
    }
    least
}

fn levels() -> impl Strategy<Value = Vec<Level>> {
    let level = (0.02..0.06, any::<bool>(), 0.01..0.2, -0.035..0.035, -0.035..0.035);
    prop::collection::vec(level.prop_map(|(half, round, height, x, y)| Level { half, round, height, x, y }), 2..6)
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(400))]

    /// A tower stands if at every level the centre of all above it is within what touches there.
    #[test]
    fn towers(mut tower in levels()) {
        let mut objects = Vec::new();
        let (mut x, mut y, mut z) = (0.0, 0.0, 0.0);
        for level in &mut tower {
            x += level.x;
            y += level.y;
            (level.x, level.y) = (x, y);
            let position = [x, y, z + level.height / 2.0];
            z += level.height;
            let (w, h) = (level.half, level.height);
            objects.push(if level.round {
                format!("cylinder: {{radius: {w:?}, height: {h:?}}}, position: {position:?}")
            } else {
                cuboid([2.0 * w, 2.0 * w, h], position)
            });
        }
        let mass = |l: &Level| l.height * l.half * l.half * if l.round { PI } else { 4.0 };
        let mut worst = f64::NEG_INFINITY;
        for k in 1..tower.len() {
            let above = &tower[k..];
            let sum: f64 = above.iter().map(mass).sum();
            let centre = |of: fn(&Level) -> f64| above.iter().map(|l| mass(l) * of(l)).sum::<f64>() / sum;
            worst = worst.max(outside([centre(|l| l.x), centre(|l| l.y)], &tower[k - 1], &tower[k]));
        }
        prop_assume!((worst - EDGE).abs() > 2e-4);
        prop_assert_eq!(read(&objects).is_ok(), worst < EDGE, "{}: {:?}", worst, read(&objects).err());
    }
}

#[test]
fn the_examples_stand() {
    let directory = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../examples");
    for name in ["fridge", "pr2_table", "shelf", "table"] {
        Scene::load(&directory.join(name).with_extension("yaml")).unwrap();
    }
}
