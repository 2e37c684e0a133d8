//! One draw of a table (Fig. 9): upright cylinders all over its middle, the target amid them, free strips
//! along its edges to put things down, and a PR2 at one of its sides.

use crate::NoScene;
use crate::cabinet::{Disc, bx, cylinders, tidy, uniform};
use clearway_plan::SceneFile;
use clearway_plan::scene_file::{FORMAT, PlaceArea, PoseKeys, Rect, RobotPlacement, Weights};
use rand::{Rng, RngExt};
use std::f64::consts::TAU;

pub const ROBOT: &str = "pr2_left";

/// Metres: the top's height and thickness, its sides; legs.
const TOP: f64 = 0.72;
const THICK: f64 = 0.03;
const LEG: f64 = 0.05;
/// Objects stand in a disc of this radius for 20 of them, and of as much room each for more or fewer.
const CLUTTER: f64 = 0.34;
/// Between the disc and the table's edge.
const STRIP: f64 = 0.19;
const RADIUS: [f64; 2] = [0.032, 0.038];
const HEIGHT: [f64; 2] = [0.18, 0.24];
/// Objects keep this much from each other.
const GAP: f64 = 0.004;
/// The target is no farther from the middle than this.
const AMID: f64 = 0.04;
/// The robot's zero is this far before the table's edge, and the floor is free so far round the table.
const BEFORE: f64 = 0.17;
/// And so far to the right of its middle: the left arm works before it.
const ASIDE: f64 = 0.12;
const AROUND: f64 = 1.6;
const PLACES: usize = 2000;
const STARTS: usize = 40;

pub(crate) fn draw(objects: usize, random: &mut impl Rng) -> Result<SceneFile, NoScene> {
    let clutter = CLUTTER * (objects as f64 / 20.0).sqrt().clamp(0.5, 1.25);
    let mut fitted = 0;
    for _ in 0..STARTS {
        let mut discs: Vec<Disc> = Vec::with_capacity(objects);
        for i in 0..objects {
            let (radius, height) = (uniform(random, RADIUS), uniform(random, HEIGHT));
            let within = if i == 0 { AMID } else { clutter };
            let free = (0..PLACES).find_map(|_| {
                // Evenly over the disc.
                let (out, bearing) = (within * random.random::<f64>().sqrt(), TAU * random.random::<f64>());
                let (x, y) = (out * bearing.cos(), out * bearing.sin());
                let apart = |d: &Disc| (d.x - x).hypot(d.y - y) >= d.radius + radius + GAP;
                discs.iter().all(apart).then_some((x, y))
            });
            let Some((x, y)) = free else { break };
            discs.push(Disc { x, y, radius, height });
        }
        if discs.len() == objects {
            let at = random.random_range(0..objects);
            discs.swap(0, at);
            return Ok(scene(&discs, at, clutter));
        }
        fitted = fitted.max(discs.len());
    }
    Err(NoScene::DoesNotFit { fitted })
}

fn scene(discs: &[Disc], target: usize, clutter: f64) -> SceneFile {
    let half = clutter + RADIUS[1] + STRIP;
    let under = TOP - THICK;
    let foot = half - LEG / 2.0;
    let mut fixtures = vec![bx("table_top", [2.0 * half, 2.0 * half, THICK], [0.0, 0.0, TOP - THICK / 2.0])];
    for (i, (x, y)) in [(-1.0, -1.0), (-1.0, 1.0), (1.0, -1.0), (1.0, 1.0)].into_iter().enumerate() {
        fixtures.push(bx(&format!("table_leg_{}", i + 1), [LEG, LEG, under], [x * foot, y * foot, under / 2.0]));
    }
    let along = 2.0 * half - 2.0 * STRIP;
    let middle = half - STRIP / 2.0;
    let place = |id: &str, size: [f64; 2], x: f64, y: f64| PlaceArea {
        id: id.to_owned(),
        size: size.map(tidy),
        position: [tidy(x), tidy(y), TOP],
    };
    let far = tidy(half + AROUND);
    SceneFile {
        format: FORMAT.to_owned(),
        name: String::new(),
        frame: "world".to_owned(),
        robot: RobotPlacement {
            model: ROBOT.to_owned(),
            base: PoseKeys { position: [tidy(-half - BEFORE), -ASIDE, 0.0], rpy: Some([0.0; 3]), quaternion: None },
            start: None,
            region: Some(Rect { min: [-far, -far], max: [far, far] }),
        },
        fixtures,
        objects: cylinders(discs, TOP),
        target: format!("o{}", target + 1),
        place: vec![
            place("near", [STRIP, along], -middle, 0.0),
            place("far", [STRIP, along], middle, 0.0),
            place("left", [along, STRIP], 0.0, middle),
            place("right", [along, STRIP], 0.0, -middle),
        ],
        workspace: None,
        exit: None,
        camera: None,
        weights: Weights::default(),
        clearance: None,
        friction: None,
    }
}
