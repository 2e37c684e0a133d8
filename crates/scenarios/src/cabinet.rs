//! One draw: upright cylinders in an open-fronted cabinet, the target at its back, a UR10 in front, a
//! tray at its side.

use crate::NoScene;
use clearway_plan::SceneFile;
use clearway_plan::scene_file::{Body, BoxKeys, CylinderKeys, FORMAT, PlaceArea, PoseKeys, RobotPlacement, Weights};
use rand::{Rng, RngExt};

pub const ROBOT: &str = "ur10_ag95";

/// Metres. The cabinet's front, its floor's top, its inner height and its walls' thickness.
pub(crate) const FRONT: f64 = 0.55;
pub(crate) const FLOOR: f64 = 0.60;
pub(crate) const HEIGHT: f64 = 0.50;
const WALL: f64 = 0.02;
/// Draws of one object's place before the whole draw starts over, and such starts.
const PLACES: usize = 2000;
const STARTS: usize = 40;

/// What a cabinet is filled with; metres.
pub struct Recipe {
    pub name: &'static str,
    /// Inner width (y) and depth (x).
    pub width: f64,
    pub depth: f64,
    /// Of the cylinders, from and to.
    pub radius: [f64; 2],
    pub height: [f64; 2],
    /// Objects keep this much from each other and from the walls.
    pub gap: f64,
    /// In front of the target is at least this part of the depth.
    pub behind: f64,
    /// Whether the target must be one that can be had with at most twice the removals asked for.
    pub solvable: bool,
}

/// The paper's shelf (section VI-B): radius 3.5 to 4.0 cm, height 24 to 29 cm, a cabinet of 0.9 × 0.6 × 0.5 m
/// (12 objects) to 1.2 × 0.7 × 0.5 m (20).
pub fn shelf(objects: usize) -> Recipe {
    let t = ((objects as f64 - 12.0) / 8.0).clamp(0.0, 1.0);
    Recipe {
        name: "shelf",
        width: 0.9 + 0.3 * t,
        depth: 0.6 + 0.1 * t,
        radius: [0.035, 0.040],
        height: [0.24, 0.29],
        gap: 0.002,
        behind: 0.5,
        solvable: false,
    }
}

/// A wider cabinet, with slender objects and a finger's room between them, so that 100 can be had at all
/// (section VI-F): of its own scene the paper says no more than their number.
pub fn large() -> Recipe {
    Recipe {
        name: "large",
        width: 1.6,
        depth: 0.7,
        radius: [0.022, 0.028],
        height: [0.16, 0.22],
        gap: 0.012,
        behind: 0.6,
        solvable: true,
    }
}

pub(crate) struct Disc {
    pub x: f64,
    pub y: f64,
    pub radius: f64,
    pub height: f64,
}

/// One scene; objects are uniformly placed without touching.
pub fn draw(recipe: &Recipe, objects: usize, random: &mut impl Rng) -> Result<SceneFile, NoScene> {
    let Recipe { width, depth, gap, .. } = *recipe;
    let mut fitted = 0;
    for _ in 0..STARTS {
        let mut discs: Vec<Disc> = Vec::with_capacity(objects);
        for i in 0..objects {
            let radius = uniform(random, recipe.radius);
            let height = uniform(random, recipe.height);
            let margin = radius + gap;
            // The target is drawn first, at the back.
            let front =
                if i == 0 { FRONT + (depth * recipe.behind).max(margin).min(depth - margin) } else { FRONT + margin };
            let free = (0..PLACES).find_map(|_| {
                let x = uniform(random, [front, FRONT + depth - margin]);
                let y = uniform(random, [-width / 2.0 + margin, width / 2.0 - margin]);
                let apart = |d: &Disc| (d.x - x).hypot(d.y - y) >= d.radius + radius + gap;
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

pub(crate) fn uniform(random: &mut impl Rng, [low, high]: [f64; 2]) -> f64 {
    low + (high - low) * random.random::<f64>()
}

/// To a tenth of a millimetre: scene files are read by people.
pub(crate) fn tidy(v: f64) -> f64 {
    (v * 1e4).round() / 1e4
}

pub(crate) fn bx(id: &str, size: [f64; 3], position: [f64; 3]) -> Body {
    Body {
        id: id.to_owned(),
        r#box: Some(BoxKeys { size: size.map(tidy) }),
        position: position.map(tidy),
        ..Body::default()
    }
}

/// Upright on a floor of this height.
pub(crate) fn cylinders(discs: &[Disc], floor: f64) -> Vec<Body> {
    let cylinder = |(i, d): (usize, &Disc)| {
        let height = tidy(d.height);
        Body {
            id: format!("o{}", i + 1),
            // Rounded down, so that rounding makes nothing touch.
            cylinder: Some(CylinderKeys { radius: (d.radius * 1e4).floor() / 1e4, height }),
            position: [tidy(d.x), tidy(d.y), floor + height / 2.0],
            ..Body::default()
        }
    };
    discs.iter().enumerate().map(cylinder).collect()
}

pub(crate) fn scene(discs: &[Disc], target: usize, width: f64, depth: f64) -> SceneFile {
    let middle = FRONT + depth / 2.0;
    let side = width / 2.0 + WALL / 2.0;
    let mid_height = FLOOR + HEIGHT / 2.0;
    let fixtures = vec![
        bx("shelf_floor", [depth, width + 2.0 * WALL, WALL], [middle, 0.0, FLOOR - WALL / 2.0]),
        bx("shelf_top", [depth, width + 2.0 * WALL, WALL], [middle, 0.0, FLOOR + HEIGHT + WALL / 2.0]),
        bx("shelf_left", [depth, WALL, HEIGHT], [middle, side, mid_height]),
        bx("shelf_right", [depth, WALL, HEIGHT], [middle, -side, mid_height]),
        bx(
            "shelf_back",
            [WALL, width + 2.0 * WALL, HEIGHT + 2.0 * WALL],
            [FRONT + depth + WALL / 2.0, 0.0, mid_height],
        ),
        bx("table", [0.54, 0.84, 0.03], [0.1, -0.82, 0.485]),
        bx("pedestal", [0.24, 0.24, 0.3], [0.0, 0.0, 0.15]),
    ];
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
        objects: cylinders(discs, FLOOR),
        target: format!("o{}", target + 1),
        place: vec![PlaceArea { id: "tray".to_owned(), size: [0.5, 0.8], position: [0.1, -0.82, 0.5] }],
        workspace: None,
        exit: None,
        camera: None,
        weights: Weights::default(),
        clearance: None,
        friction: None,
    }
}
