//! One draw of a shelf in which things hide each other (Fig. 7): large objects in front, each of the others behind
//! another, the target at the back; a camera behind the robot; a suction cup, which grasps from the front.

use crate::NoScene;
use crate::cabinet::{self, Disc, FLOOR, FRONT, uniform};
use clearway_geometry::{Convex, Pose, Solid, Vec3};
use clearway_plan::SceneFile;
use clearway_plan::scene_file::{Camera, Rect};
use clearway_sight::seen::look_at;
use clearway_sight::{Standing, View};
use rand::{Rng, RngExt};

pub const ROBOT: &str = "ur10_suction";

/// Objects in a column, the large one in front included; at most so many columns.
const DEEP: usize = 4;
const COLUMNS: usize = 6;
/// Of the large ones, metres: a pace behind the front at most.
const LARGE_RADIUS: [f64; 2] = [0.050, 0.055];
const LARGE_HEIGHT: [f64; 2] = [0.30, 0.33];
const PACE: f64 = 0.04;
/// Room for a hand between things, metres.
const GAP: f64 = 0.01;
/// No more than this part of what is hidden is in view: less than is enough to be seen.
const HIDDEN: f64 = 0.15;
/// The target is farther back than this part of the depth.
const BEHIND: f64 = 0.5;
const PLACES: usize = 4000;
const STARTS: usize = 60;
/// The camera, metres: above the floor and behind the robot's base.
const EYE: [f64; 3] = [-0.15, 0.0, FLOOR + 0.40];
const FIELD_OF_VIEW: f64 = 1.5;

pub(crate) fn draw(objects: usize, random: &mut impl Rng) -> Result<SceneFile, NoScene> {
    let cabinet::Recipe { width, depth, radius, height, .. } = cabinet::shelf(objects);
    let columns = objects.div_ceil(DEEP).min(COLUMNS).min(objects.saturating_sub(1)).max(1);
    let camera = Camera {
        position: EYE,
        look_at: [FRONT + depth / 2.0, 0.0, FLOOR + 0.15],
        fov: FIELD_OF_VIEW,
        enter_unseen: false,
    };
    let view = View::new(&camera);
    let mut fitted = 0;
    for _ in 0..STARTS {
        let mut discs: Vec<Disc> = Vec::with_capacity(objects);
        for column in 0..columns {
            let r = uniform(random, LARGE_RADIUS);
            let pitch = width / columns as f64;
            let slack = (pitch / 2.0 - r - GAP).max(0.0);
            let y = pitch * (column as f64 + 0.5) - width / 2.0 + uniform(random, [-slack, slack]);
            let x = FRONT + r + uniform(random, [0.005, PACE]);
            discs.push(Disc { x, y, radius: r, height: uniform(random, LARGE_HEIGHT) });
        }
        while discs.len() < objects {
            let last = discs.len() + 1 == objects;
            let (r, h) = (uniform(random, radius), uniform(random, height));
            let front = if last { FRONT + depth * BEHIND } else { FRONT + r };
            let found = (0..PLACES).find_map(|_| {
                let x = uniform(random, [front, FRONT + depth - r - GAP]);
                let y = uniform(random, [r + GAP - width / 2.0, width / 2.0 - r - GAP]);
                let disc = Disc { x, y, radius: r, height: h };
                let apart = |d: &Disc| (d.x - x).hypot(d.y - y) >= d.radius + r + GAP;
                // The target is behind one that is hidden itself.
                (discs.iter().all(apart)
                    && part_seen(&view, &disc, &discs) < HIDDEN
                    && (!last || objects <= columns + 1 || part_seen(&view, &disc, &discs[columns..]) < HIDDEN))
                    .then_some(disc)
            });
            let Some(disc) = found else { break };
            discs.push(disc);
        }
        if discs.len() == objects {
            let at = random.random_range(0..objects);
            let target = objects - 1;
            discs.swap(target, at);
            let mut file = cabinet::scene(&discs, at, width, depth);
            file.robot.model = ROBOT.to_owned();
            file.camera = Some(camera);
            file.workspace = Some(Rect { min: [FRONT - 0.1, -width / 2.0], max: [FRONT + depth, width / 2.0] });
            return Ok(file);
        }
        fitted = fitted.max(discs.len());
    }
    Err(NoScene::DoesNotFit { fitted })
}

fn part_seen(view: &View, disc: &Disc, others: &[Disc]) -> f64 {
    let body = |d: &Disc| {
        let solid = Solid::new(Convex::Cylinder { radius: d.radius, half: d.height / 2.0 });
        (solid, Pose::from_translation(Vec3::new(d.x, d.y, FLOOR + d.height / 2.0)))
    };
    let (own, all) = (body(disc), others.iter().map(body).collect::<Vec<_>>());
    let standing = |(solid, pose)| Standing { solid, pose };
    let all: Vec<Standing> = all.iter().map(|(s, p)| standing((s, p))).collect();
    look_at(view, standing((&own.0, &own.1)), &all).part
}
