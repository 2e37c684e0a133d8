//! One draw of the paper's shelf: upright cylinders of radius 3.5 to 4.0 cm and height 24 to 29 cm
//! in an open-fronted cabinet of 0.9 × 0.6 × 0.5 m (12 objects) to 1.2 × 0.7 × 0.5 m (20), the
//! target in the back half, a UR10 in front, a tray at its side.

use crate::NoScene;
use clearway_plan::SceneFile;
use clearway_plan::scene_file::{Body, BoxKeys, CylinderKeys, FORMAT, PlaceArea, PoseKeys, RobotPlacement};
use rand::{Rng, RngExt};

pub const ROBOT: &str = "ur10_ag95";

/// Metres. The cabinet's front, its floor's top, its inner height and its walls' thickness.
const FRONT: f64 = 0.55;
const FLOOR: f64 = 0.60;
const HEIGHT: f64 = 0.50;
const WALL: f64 = 0.02;
/// Objects keep this much from each other and from the walls.
const GAP: f64 = 0.002;
/// Draws of one object's place before the whole draw starts over, and such starts.
const PLACES: usize = 2000;
const STARTS: usize = 40;

/// Inner width (y) and depth (x) of the cabinet for so many objects.
fn cabinet(objects: usize) -> (f64, f64) {
    let t = ((objects as f64 - 12.0) / 8.0).clamp(0.0, 1.0);
    (0.9 + 0.3 * t, 0.6 + 0.1 * t)
}

struct Disc {
    x: f64,
    y: f64,
    radius: f64,
    height: f64,
}

/// One scene; objects are uniformly placed without touching.
pub fn draw(objects: usize, random: &mut impl Rng) -> Result<SceneFile, NoScene> {
    let (width, depth) = cabinet(objects);
    let mut fitted = 0;
    for _ in 0..STARTS {
        let mut discs: Vec<Disc> = Vec::with_capacity(objects);
        for i in 0..objects {
            let radius = uniform(random, 0.035, 0.040);
            let height = uniform(random, 0.24, 0.29);
            let margin = radius + GAP;
            // The target is drawn first, in the back half.
            let front = if i == 0 { FRONT + (depth / 2.0).max(margin) } else { FRONT + margin };
            let free = (0..PLACES).find_map(|_| {
                let x = uniform(random, front, FRONT + depth - margin);
                let y = uniform(random, -width / 2.0 + margin, width / 2.0 - margin);
                let apart = |d: &Disc| (d.x - x).hypot(d.y - y) >= d.radius + radius + GAP;
                discs.iter().all(apart).then_some((x, y))
            });
            let Some((x, y)) = free else { break };
            discs.push(Disc { x, y, radius, height });
        }
        if discs.len() == objects {
            // The target's number says nothing: it goes to a random place in the list.
            let at = random.random_range(0..objects);
            discs.swap(0, at);
            return Ok(scene(&discs, at, width, depth));
        }
        fitted = fitted.max(discs.len());
    }
    Err(NoScene::DoesNotFit { fitted })
}

fn uniform(random: &mut impl Rng, low: f64, high: f64) -> f64 {
    low + (high - low) * random.random::<f64>()
}

/// To a tenth of a millimetre: scene files are read by people.
fn tidy(v: f64) -> f64 {
    (v * 1e4).round() / 1e4
}

fn scene(discs: &[Disc], target: usize, width: f64, depth: f64) -> SceneFile {
    let middle = FRONT + depth / 2.0;
    let side = width / 2.0 + WALL / 2.0;
    let mid_height = FLOOR + HEIGHT / 2.0;
    let bx = |id: &str, size: [f64; 3], position: [f64; 3]| Body {
        id: id.to_owned(),
        r#box: Some(BoxKeys { size: size.map(tidy) }),
        position: position.map(tidy),
        ..Body::default()
    };
    let fixtures = vec![
        bx("shelf_floor", [depth, width + 2.0 * WALL, WALL], [middle, 0.0, FLOOR - WALL / 2.0]),
        bx("shelf_top", [depth, width + 2.0 * WALL, WALL], [middle, 0.0, FLOOR + HEIGHT + WALL / 2.0]),
        bx("shelf_left", [depth, WALL, HEIGHT], [middle, side, mid_height]),
        bx("shelf_right", [depth, WALL, HEIGHT], [middle, -side, mid_height]),
        bx("shelf_back", [WALL, width + 2.0 * WALL, HEIGHT + 2.0 * WALL], [FRONT + depth + WALL / 2.0, 0.0, mid_height]),
        bx("table", [0.54, 0.84, 0.03], [0.1, -0.82, 0.485]),
        bx("pedestal", [0.24, 0.24, 0.3], [0.0, 0.0, 0.15]),
    ];
    let objects = discs
        .iter()
        .enumerate()
        .map(|(i, d)| {
            let height = tidy(d.height);
            Body {
                id: format!("o{}", i + 1),
                // Rounded down, so that rounding makes nothing touch.
                cylinder: Some(CylinderKeys { radius: (d.radius * 1e4).floor() / 1e4, height }),
                position: [tidy(d.x), tidy(d.y), FLOOR + height / 2.0],
                ..Body::default()
            }
        })
        .collect();
    SceneFile {
        format: FORMAT.to_owned(),
        name: String::new(),
        frame: "world".to_owned(),
        robot: RobotPlacement {
            model: ROBOT.to_owned(),
            base: PoseKeys { position: [0.0, 0.0, 0.3], rpy: Some([0.0; 3]), quaternion: None },
            start: None,
            region: None,
        },
        fixtures,
        objects,
        target: format!("o{}", target + 1),
        place: vec![PlaceArea { id: "tray".to_owned(), size: [0.5, 0.8], position: [0.1, -0.82, 0.5] }],
        workspace: None,
        exit: None,
        camera: None,
    }
}
