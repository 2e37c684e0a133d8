//! What stands and what tips: scenes with a closed form, beside a valid plan; and what is taken and
//! put down in it.

mod gantry;

use clearway_plan::scene_file::{Body, BoxKeys, CylinderKeys, Part, SphereKeys};
use clearway_plan::{Budget, PlanFile};
use clearway_verify::{Report, Violation, ViolationKind as Kind, verify};
use rand::{RngExt, SeedableRng};
use rand_xoshiro::Xoshiro256PlusPlus;
use std::f64::consts::{FRAC_PI_2, FRAC_PI_4};
use std::path::Path;

/// Far from the gantry, a bench: its top is at 0, its edge at x = 0.
const Y: f64 = 5.0;
/// Less beyond an edge is let pass, more is not, metres.
const LET_PASS: f64 = 5.5e-4;

fn plan(seed: u64) -> PlanFile {
    gantry::plan(&mut Xoshiro256PlusPlus::seed_from_u64(seed))
}

fn judge(plan: &PlanFile) -> Report {
    verify(plan, Path::new(""), &Budget::unlimited()).expect("judged")
}

fn boxed(id: &str, size: [f64; 3], position: [f64; 3]) -> Body {
    Body { id: id.into(), r#box: Some(BoxKeys { size }), position, ..Body::default() }
}

fn cylinder(id: &str, radius: f64, height: f64, position: [f64; 3]) -> Body {
    Body { id: id.into(), cylinder: Some(CylinderKeys { radius, height }), position, ..Body::default() }
}

fn ball(id: &str, radius: f64, position: [f64; 3]) -> Body {
    Body { id: id.into(), sphere: Some(SphereKeys { radius }), position, ..Body::default() }
}

/// A block from x to x, its bottom at z.
fn block(id: &str, x: (f64, f64), z: f64, height: f64) -> Body {
    boxed(id, [x.1 - x.0, 0.1, height], [f64::midpoint(x.0, x.1), Y, z + height / 2.0])
}

fn on_bench(objects: Vec<Body>) -> Report {
    let mut plan = plan(1);
    plan.scene.fixtures.push(boxed("bench", [1.0, 1.0, 0.1], [-0.5, Y, -0.05]));
    plan.scene.objects.extend(objects);
    judge(&plan)
}

/// Nothing is wrong, or one thing is unstable: what is told.
fn told(report: &Report) -> Option<&str> {
    match &report.violations[..] {
        [] => None,
        [one] if one.kind == Kind::Unstable => Some(&one.what),
        _ => panic!("{report}"),
    }
}

fn stands(objects: Vec<Body>, expected: bool) {
    let report = on_bench(objects);
    assert_eq!(told(&report).is_none(), expected, "{report}");
}

#[test]
fn a_box_tips_when_its_centre_passes_the_edge() {
    for over in [-0.04, -1e-3, 0.0, 3e-4] {
        stands(vec![block("box", (over - 0.05, over + 0.05), 0.0, 0.2)], true);
    }
    for (over, away) in [(1e-3, "1.0"), (2e-3, "2.0"), (0.03, "30.0")] {
        let report = on_bench(vec![block("box", (over - 0.05, over + 0.05), 0.0, 0.2)]);
        let what =
            format!("at the start box is not stable: its centre of mass is {away} mm outside what carries it (bench)");
        assert_eq!(told(&report), Some(what.as_str()));
    }
    // A gap, or an overlap, of nearly 1 mm is noise; turned by 30° the same holds.
    for (z, turn) in [(9e-4, 0.0), (-9e-4, 0.0), (0.0, 0.5)] {
        for (over, expected) in [(0.0, true), (2e-3, false)] {
            let mut body = block("box", (over - 0.05, over + 0.05), z, 0.2);
            body.rpy = Some([0.0, 0.0, turn]);
            stands(vec![body], expected);
        }
    }
}

#[test]
fn two_things_carry_a_board() {
    for (over, expected) in [(0.0, true), (0.09, true), (0.1, true), (0.102, false), (-0.102, false)] {
        let pillars = [block("left", (-0.4, -0.38), 0.0, 0.1), block("right", (-0.22, -0.2), 0.0, 0.1)];
        let board = block("board", (over - 0.5, over - 0.1), 0.1, 0.01);
        stands(pillars.into_iter().chain([board]).collect(), expected);
    }
    // Not quite of one height.
    let pillars = [block("left", (-0.4, -0.38), 0.0, 0.1), block("right", (-0.22, -0.2), 0.0, 0.0995)];
    stands(pillars.into_iter().chain([block("board", (-0.5, -0.1), 0.1, 0.01)]).collect(), true);
}

#[test]
fn who_tips_is_told() {
    // The board bears on that side of the right block that is over the edge.
    let right = || block("right", (-0.055, 0.045), 0.0, 0.05);
    let left = || [block("left", (-0.6, -0.5), 0.0, 0.07), block("step", (0.035, 0.045), 0.05, 0.02)];
    stands(left().into_iter().chain([right()]).collect(), true);
    let board = block("board", (-0.6, 0.045), 0.07, 0.05);
    let report = on_bench(left().into_iter().chain([right(), board]).collect());
    let what = "at the start right does not stand with step on it, on what carries it (bench)";
    assert_eq!(told(&report), Some(what));
}

#[test]
fn a_counterweight_holds_a_board() {
    // 1 kg, say, 20 mm beyond the edge; a load is 80 mm inside, and holds it from a quarter on.
    let board = || block("board", (-0.1, 0.14), 0.0, 0.02);
    let load = |share: f64, x: f64| block("load", (x - 0.02, x + 0.02), 0.02, 0.02 * share * 0.24 / 0.04);
    stands(vec![board(), load(0.26, -0.08)], true);
    stands(vec![board(), load(0.22, -0.08)], false);
    stands(vec![board(), load(1.0, 0.05)], false);
    let report = on_bench(vec![board(), load(0.22, -0.08)]);
    let what = "at the start board is not stable: its centre of mass is 20.0 mm outside what carries it (bench)";
    assert_eq!(told(&report), Some(what));
    // A load beyond the edge tips a board that would stand alone.
    let board = || block("board", (-0.14, 0.1), 0.0, 0.02);
    stands(vec![board()], true);
    stands(vec![board(), load(0.24, 0.08)], true);
    let report = on_bench(vec![board(), load(0.27, 0.08)]);
    let what = "at the start board does not stand with load on it, on what carries it (bench)";
    assert_eq!(told(&report), Some(what));
}

/// Harmonic: the k-th block from the top may hang over by half of its length divided by k.
#[test]
fn overhanging_blocks() {
    for count in 1..6_u32 {
        for (more, expected) in [(-5e-4, true), (0.0, true), (2e-3, false)] {
            let mut edge = 0.0;
            let blocks = (0..count).map(|i| {
                // The lowest hangs over farther, or less far.
                edge += 0.1 / f64::from(count - i) + if i == 0 { more } else { 0.0 };
                block(&format!("b{i}"), (edge - 0.2, edge), 0.02 * f64::from(i), 0.02)
            });
            stands(blocks.collect(), expected);
        }
    }
}

#[test]
fn what_is_round() {
    // Cylinder on cylinder: its axis is above the other's top, or not.
    for (aside, expected) in [(0.0, true), (0.02, true), (0.0298, true), (0.032, false)] {
        let lower = cylinder("lower", 0.03, 0.1, [-0.2, Y, 0.05]);
        stands(vec![lower, cylinder("upper", 0.04, 0.1, [aside - 0.2, Y, 0.15])], expected);
    }
    // Ball on bench, on ball, on the edge, between two blocks.
    stands(vec![ball("ball", 0.05, [-0.2, Y, 0.05])], true);
    for (aside, expected) in [(0.0, true), (3e-3, false)] {
        let up = f64::sqrt(0.08 * 0.08 - aside * aside);
        stands(vec![ball("lower", 0.05, [-0.2, Y, 0.05]), ball("upper", 0.03, [aside - 0.2, Y, 0.05 + up])], expected);
    }
    let sunk = f64::sqrt(0.05 * 0.05 - 0.03 * 0.03);
    stands(vec![ball("ball", 0.05, [0.03, Y, sunk])], false);
    let blocks = [block("left", (-0.3, -0.2), 0.0, 0.1), block("right", (-0.14, -0.04), 0.0, 0.1)];
    stands(blocks.into_iter().chain([ball("ball", 0.05, [-0.17, Y, 0.1 + sunk])]).collect(), true);
    // A log across the edge, and a board on a log: its middle is above, or not.
    for (over, expected) in [(0.0, true), (2e-3, false)] {
        let mut log = cylinder("log", 0.03, 0.2, [over, Y, 0.03]);
        log.rpy = Some([0.0, FRAC_PI_2, 0.0]);
        stands(vec![log], expected);
        let mut log = cylinder("log", 0.03, 0.2, [-0.2, Y, 0.03]);
        log.rpy = Some([FRAC_PI_2, 0.0, 0.0]);
        stands(vec![log, block("board", (over - 0.3, over - 0.1), 0.06, 0.01)], expected);
    }
    // A cube on its edge, and one that leans a little.
    for (lean, up, expected) in
        [(FRAC_PI_4, 0.05 * 2f64.sqrt(), true), (FRAC_PI_4 - 0.05, 0.0, false), (0.009, 0.0, true)]
    {
        let z = if up > 0.0 { up } else { 0.05 * (lean.sin() + lean.cos()) };
        let cube = Body { rpy: Some([0.0, lean, 0.0]), ..boxed("cube", [0.1; 3], [-0.2, Y, z]) };
        stands(vec![cube], expected);
    }
}

#[test]
fn three_legs() {
    let leg = |x: f64, y: f64| Part {
        cylinder: Some(CylinderKeys { radius: 5e-3, height: 0.1 }),
        position: [x, y, -0.05],
        ..Part::default()
    };
    let stool = |x: f64, seat: f64| {
        let top =
            Part { r#box: Some(BoxKeys { size: [0.2, 0.2, 0.02] }), position: [seat, 0.0, 0.01], ..Part::default() };
        let parts = vec![top, leg(0.08, 0.08), leg(0.08, -0.08), leg(-0.08, 0.0)];
        Body { id: "stool".into(), compound: Some(parts), position: [x, Y, 0.1], ..Body::default() }
    };
    stands(vec![stool(-0.3, 0.0)], true);
    // The seat is 8e-4 m³; the legs, 2.4e-5 m³, are 27 mm on the other side.
    stands(vec![stool(-0.3, 0.08)], true);
    stands(vec![stool(-0.3, 0.092)], false);
    // None over the edge, two, and one.
    stands(vec![stool(-0.09, 0.0)], true);
    stands(vec![stool(-0.05, 0.0)], false);
    stands(vec![Body { rpy: Some([0.0, 0.0, FRAC_PI_2]), ..stool(-0.05, 0.0) }], false);
}

/// Random towers: each stands if, at every level, all that is above has its centre within the patch.
#[test]
fn towers_as_in_the_closed_form() {
    let mut random = Xoshiro256PlusPlus::seed_from_u64(5);
    let (mut all, mut standing) = (0, 0);
    while all < 150 {
        let count = random.random_range(2..7);
        let mut centre = [-0.5, Y];
        let mut z = 0.0;
        let blocks: Vec<([f64; 3], [f64; 3])> = (0..count)
            .map(|_| {
                let size = [(); 3].map(|()| random.random_range(0.02..0.2));
                centre = centre.map(|c| c + random.random_range(-0.05..0.05));
                z += size[2];
                (size, [centre[0], centre[1], z - size[2] / 2.0])
            })
            .collect();
        // How far, at worst, the centre of all from the i-th on is outside of where that meets the one below.
        let over = |i: usize| {
            let weight: f64 = blocks[i..].iter().map(|(size, _)| size.iter().product::<f64>()).sum();
            let beyond = [0, 1].map(|axis| {
                let moment: f64 = blocks[i..].iter().map(|(size, at)| size.iter().product::<f64>() * at[axis]).sum();
                let ends =
                    |(size, at): &([f64; 3], [f64; 3])| (at[axis] - size[axis] / 2.0, at[axis] + size[axis] / 2.0);
                let ((a, b), (c, d)) = (ends(&blocks[i - 1]), ends(&blocks[i]));
                f64::max(a.max(c) - moment / weight, moment / weight - b.min(d))
            });
            beyond[0].max(beyond[1])
        };
        let meets = (1..count).all(|i| {
            [0, 1].iter().all(|&a| {
                let ((size, at), (below, below_at)) = (&blocks[i], &blocks[i - 1]);
                (at[a] - below_at[a]).abs() < (size[a] + below[a]) / 2.0 - 1e-3
            })
        });
        let worst = (1..count).map(over).fold(f64::NEG_INFINITY, f64::max);
        if !meets || (0.0..LET_PASS).contains(&worst) {
            continue;
        }
        let bodies = blocks.iter().enumerate().map(|(i, (size, at))| boxed(&format!("b{i}"), *size, *at));
        stands(bodies.collect(), worst < 0.0);
        all += 1;
        standing += usize::from(worst < 0.0);
    }
    assert!((30..120).contains(&standing), "{standing} of {all}");
}

#[test]
fn what_nothing_carries_is_told_once() {
    let report = on_bench(vec![block("floats", (-0.3, -0.2), 0.05, 0.1), block("on", (-0.24, -0.18), 0.15, 0.1)]);
    assert!(matches!(&report.violations[..], [one] if one.kind == Kind::Unsupported), "{report}");
    // What is not stable on it is.
    let report = on_bench(vec![block("floats", (-0.3, -0.2), 0.05, 0.1), block("on", (-0.21, -0.15), 0.15, 0.1)]);
    assert!(report.has(Kind::Unstable), "{report}");
}

fn unstable(report: &Report, step: usize) -> Vec<&Violation> {
    report.violations.iter().filter(|v| v.kind == Kind::Unstable && v.step == Some(step)).collect()
}

#[test]
fn a_counterweight_that_is_taken() {
    for seed in 0..10 {
        let mut plan = plan(seed);
        let id = plan.steps[0].object.clone();
        // The table is 20 mm lower; whatever stood on it stands on pads.
        let table = plan.scene.fixtures.iter_mut().find(|f| f.id == "table").expect("the table");
        table.position[2] -= 0.02;
        let on_table: Vec<(String, [f64; 3])> = plan.scene.objects.iter().map(|o| (o.id.clone(), o.position)).collect();
        for (object, [x, y, _]) in on_table {
            if object == id {
                plan.scene.fixtures.push(boxed("pad", [0.04, 0.04, 0.01], [x, y, -0.015]));
                plan.scene.objects.push(boxed("board", [0.12, 0.02, 0.01], [x + 0.045, y, -0.005]));
            } else {
                plan.scene.fixtures.push(boxed("pad", [0.08, 0.08, 0.02], [x, y, -0.01]));
            }
        }
        let report = judge(&plan);
        let what = format!(
            "with {id} taken, board is not stable: its centre of mass is 25.0 mm outside what carries it (pad)"
        );
        assert_eq!(told(&report), Some(what.as_str()));
        let found = &report.violations[0];
        assert_eq!(serde_json::to_value(found).expect("JSON")["kind"], "unstable");
        let first = plan.steps[0].segments.iter().position(|s| s.attached.is_some());
        assert_eq!((found.step, found.segment, found.row), (Some(0), first, Some(0)));
    }
}

#[test]
fn put_down_over_an_edge() {
    for seed in 0..10 {
        for (over, expected) in [(-5e-3, false), (3e-4, false), (2.5e-3, true), (8e-3, true)] {
            let mut plan = plan(seed);
            let (id, [x, ..]) = (plan.steps[0].object.clone(), plan.steps[0].placed.position);
            // The tray ends so far before what is put down has its centre.
            let tray = plan.scene.fixtures.iter_mut().find(|f| f.id == "tray").expect("the tray");
            tray.position[0] = x + over + 0.3;
            let report = judge(&plan);
            match &unstable(&report, 0)[..] {
                [] => assert!(!expected, "{over}: {report}"),
                [one] => {
                    assert!(expected, "{one}");
                    let start = format!("put down, {id} is not stable: its centre of mass is {:.1} mm", over * 1e3);
                    assert!(one.what.starts_with(&start) && one.what.ends_with("(tray)"), "{one}");
                    assert!(one.segment.is_none() && one.time > 1.0);
                }
                _ => panic!("{report}"),
            }
        }
    }
}

#[test]
fn put_down_on_what_then_tips() {
    for seed in 0..10 {
        for (aside, expected) in [(0.06, true), (0.01, false)] {
            let mut plan = plan(seed);
            let (id, [x, y, _]) = (plan.steps[0].object.clone(), plan.steps[0].placed.position);
            let tray = plan.scene.fixtures.iter_mut().find(|f| f.id == "tray").expect("the tray");
            tray.id = "rail".into();
            tray.r#box = Some(BoxKeys { size: [0.04, 0.04, 0.04] });
            tray.position = [x + aside, y, 0.02];
            plan.scene.objects.push(boxed("board", [0.16, 0.04, 0.01], [x + aside, y, 0.045]));
            let report = judge(&plan);
            let found: Vec<&str> = unstable(&report, 0).iter().map(|v| v.what.as_str()).collect();
            let what = format!("with {id} put down, board does not stand with {id} on it, on what carries it (rail)");
            assert_eq!(found, if expected { vec![what.as_str()] } else { vec![] }, "{report}");
            assert!(!report.violations.iter().any(|v| v.kind == Kind::Unstable && v.step.is_none()), "{report}");
        }
    }
}
