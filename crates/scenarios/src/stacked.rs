//! One draw of Fig. 10: two objects before the target with a third on top of them both, in the cabinet of the
//! other shelves; whatever more there is stands in compartments beside.

use crate::NoScene;
use crate::cabinet::{self, Disc, FLOOR, FRONT, bx, cylinders, tidy, uniform};
use clearway_plan::SceneFile;
use clearway_plan::scene_file::Body;
use rand::seq::SliceRandom;
use rand::{Rng, RngExt};

/// Metres.
const RADIUS: [f64; 2] = [0.035, 0.040];
const HEIGHT: [f64; 2] = [0.20, 0.26];
/// Of the one on top.
const TOP_HEIGHT: [f64; 2] = [0.12, 0.16];
/// The target's distance from the front, and how far before it the two are.
const TARGET: [f64; 2] = [0.36, 0.44];
const BEFORE: [f64; 2] = [0.12, 0.17];
/// And from the middle.
const ASIDE: f64 = 0.03;
/// Between the two: the one on top still rests well on both.
const BETWEEN: [f64; 2] = [0.030, 0.045];
/// The rest keeps this much from each other and from the walls.
const GAP: f64 = 0.002;
/// The middle of the two is this far to one side of the target: with the nearer one gone the hand gets past the other.
const OFF: [f64; 2] = [0.02, 0.045];
/// The figure's objects, and its compartment.
const FIGURE: usize = 4;
const MIDDLE: f64 = 0.40;
/// The compartments beside it: as wide as this for each object and once more, but no wider than that; and what parts
/// them.
const SIDE_OF_ONE: f64 = 0.09;
const WIDEST: f64 = 0.40;
const DIVIDER: f64 = 0.02;
const PLACES: usize = 2000;
const STARTS: usize = 40;

/// A draw, with the figure's three objects: the one on top, then those below it.
pub(crate) struct Figure {
    pub file: SceneFile,
    pub top: Option<String>,
    pub below: Vec<String>,
}

pub(crate) fn draw(objects: usize, random: &mut impl Rng) -> Result<Figure, NoScene> {
    // The figure's compartment in the middle; those beside it take the rest.
    let depth = cabinet::shelf(objects).depth;
    let beside = objects.saturating_sub(FIGURE).div_ceil(2);
    let side = if beside == 0 { 0.0 } else { (SIDE_OF_ONE * (1.0 + beside as f64)).min(WIDEST) };
    let walls = if beside == 0 { 0.0 } else { DIVIDER };
    let width = MIDDLE + 2.0 * (side + walls);
    let mut fitted = 0;
    for _ in 0..STARTS {
        let mut disc = |x: f64, y: f64, height: f64| Disc { x, y, radius: uniform(random, RADIUS), height };
        let mut discs = vec![disc(0.0, 0.0, 0.0), disc(0.0, 0.0, 0.0), disc(0.0, 0.0, 0.0), disc(0.0, 0.0, 0.0)];
        let [target, left, right, top] = &mut discs[..] else { continue };
        let at = uniform(random, TARGET);
        let y = uniform(random, [-ASIDE, ASIDE]);
        (target.x, target.y, target.height) = (FRONT + at, y, uniform(random, HEIGHT));
        let (x, height, between) =
            (FRONT + at - uniform(random, BEFORE), uniform(random, HEIGHT), uniform(random, BETWEEN) / 2.0);
        let off = uniform(random, OFF) * if random.random::<bool>() { 1.0 } else { -1.0 };
        (left.x, left.y, left.height) = (x, y + off + left.radius + between, height);
        (right.x, right.y, right.height) = (x, y + off - right.radius - between, height);
        (top.x, top.y, top.height) = (x, y + off, uniform(random, TOP_HEIGHT));
        let figure = objects.min(FIGURE);
        // Of three, one below; the fourth is on top.
        if objects == 3 {
            discs.swap_remove(2);
            (discs[2].x, discs[2].y) = (discs[1].x, discs[1].y);
        }
        discs.truncate(figure);
        while discs.len() < objects {
            let (radius, height) = (uniform(random, RADIUS), uniform(random, HEIGHT));
            let margin = radius + GAP;
            let free = (0..PLACES).find_map(|_| {
                let x = uniform(random, [FRONT + margin, FRONT + depth - margin]);
                let aside = MIDDLE / 2.0 + walls + uniform(random, [margin, side - margin]);
                let y = if discs.len() % 2 == 0 { aside } else { -aside };
                discs.iter().all(|d| (d.x - x).hypot(d.y - y) >= d.radius + radius + GAP).then_some((x, y))
            });
            let Some((x, y)) = free else { break };
            discs.push(Disc { x, y, radius, height });
        }
        if discs.len() == objects {
            let mut drawn = scene(&discs, figure, width, depth, random);
            for (id, y) in [("divider_left", 1.0), ("divider_right", -1.0)].into_iter().filter(|_| beside > 0) {
                let middle = [FRONT + depth / 2.0, y * (MIDDLE + DIVIDER) / 2.0, FLOOR + cabinet::HEIGHT / 2.0];
                drawn.file.fixtures.push(bx(id, [depth, DIVIDER, cabinet::HEIGHT], middle));
            }
            return Ok(drawn);
        }
        fitted = fitted.max(discs.len());
    }
    Err(NoScene::DoesNotFit { fitted })
}

/// The first is the target, the last of the figure on top if there are three.
fn scene(discs: &[Disc], figure: usize, width: f64, depth: f64, random: &mut impl Rng) -> Figure {
    let mut file = cabinet::scene(discs, 0, width, depth);
    let mut bodies: Vec<Body> = cylinders(discs, FLOOR);
    let stacked = figure >= 3;
    if stacked {
        let (height, own) = (tidy(discs[1].height), tidy(discs[figure - 1].height));
        bodies[figure - 1].position[2] = FLOOR + height + own / 2.0;
    }
    // Numbers say nothing: names are given in another order.
    let mut order: Vec<usize> = (0..bodies.len()).collect();
    order.shuffle(random);
    let name = |i: usize| format!("o{}", order.iter().position(|o| *o == i).unwrap_or(0) + 1);
    let (target, top) = (name(0), stacked.then(|| name(figure - 1)));
    let below = if stacked { (1..figure - 1).map(name).collect() } else { Vec::new() };
    file.objects =
        order.iter().enumerate().map(|(i, o)| Body { id: format!("o{}", i + 1), ..bodies[*o].clone() }).collect();
    file.target = target;
    Figure { file, top, below }
}
