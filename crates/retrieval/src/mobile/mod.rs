//! Mobile manipulation (section V-B): a base that drives on the floor, so that the target may leave on
//! any side.
//!
//! The arm works while the base stands; the base drives with the arm at rest, or with an object held
//! near. So each stop is a robot that does not drive, with its own ways to the objects
//! ([`crate::stand`]), and the search is over all of them at once: an object can be had when it can from
//! some stop.
//!
//! | module | |
//! |---|---|
//! | [`stops`] | where the base may stand, from the arm's inverse reachability |
//! | [`itinerary`] | which object from which stop, in what order |
//! | `bring` | what cannot be put down where it was taken |

pub(crate) mod bring;
pub mod itinerary;
mod stops;

use crate::carry::motions::AtEnds;
use crate::carry::{Attempt, Carrier, Situation, obstructed};
use crate::feasibility::Unfit;
use crate::grasps::Grasp;
use clearway_collision::lanes::Suspects;
use clearway_collision::{CollisionModel, Contact, Moment, Quick, Scratch, Standing, Touch, World};
use clearway_geometry::{Convex, Mat3, Pose, Solid, Vec3};
use clearway_motion::{Posture, Timed};
use clearway_plan::plan_file::SideWhy;
use clearway_plan::scene_file::{Rect, Weights};
use clearway_plan::{ObjectId, ObjectSet};
use clearway_robot::{Placement, Reachability, Robot, Root};
use clearway_scene::{Fixture, Scene};
use rand::Rng;
use std::f64::consts::{PI, TAU};
use std::sync::Arc;

pub(crate) use stops::{Served, Sides, choose};

/// What a mobile base does.
#[derive(Clone, Debug)]
pub struct Settings {
    /// Whether it drives at all; else it stays where it starts.
    pub drives: bool,
    /// Stops looked into at most, the start included.
    pub stops: usize,
    /// Room that the robot keeps from everything while it drives, where there is as much; metres.
    pub margin: f64,
}

impl Default for Settings {
    fn default() -> Self {
        Self { drives: true, stops: 7, margin: 0.02 }
    }
}

/// The base of one robot in one scene.
pub(crate) struct Base {
    pub settings: Settings,
    /// The whole robot, its base driving.
    pub model: Arc<CollisionModel>,
    /// The scene without what is below the robot wherever it drives, but with a curb round the region.
    scene: Scene,
    pub driving: World,
    /// What rides on the base and moves no other way, in the root frame at zero.
    body: Solid,
    /// Where the base's zero may be.
    bounds: Rect,
    pub start: Placement,
    pub weights: Weights,
    /// Whether the stops were chosen.
    pub chosen: bool,
    pub sides: Sides,
}

/// Beyond what it has to do with, a base without a region may drive so far: metres.
const AROUND: f64 = 2.5;
/// Height and width of the curb, metres.
const CURB: f64 = 0.05;
const NAME_OF_CURB: &str = "the edge of robot.region";

/// The root of the standing robot as it is when the base's joints have these values, in the root frame.
pub fn moved([x, y, yaw]: Placement) -> Pose {
    Pose::new(Mat3::from_rotation_z(yaw), Vec3::new(x, y, 0.0))
}

impl Base {
    /// The base in a scene, starting there; `robot` is the whole one.
    pub fn new(
        scene: &Scene,
        model: Arc<CollisionModel>,
        standing: &Standing,
        start: Placement,
        settings: Settings,
    ) -> Result<Self, Unfit> {
        const UPRIGHT: f64 = 1.0 - 1e-6;
        if scene.base.rotation.z_axis.z < UPRIGHT {
            return Err(Unfit::Drives("the robot's base leans, and it drives on the level".to_owned()));
        }
        let body = body(&standing.model);
        let bounds = match &scene.file.robot.region {
            Some(region) => {
                check_region(region, &body, &(scene.base * moved(start)))?;
                *region
            }
            None => surroundings(scene, &(scene.base * moved(start))),
        };
        let around = as_for_driving(scene, &body);
        let driving = World::new(model.clone(), &around);
        let weights = scene.file.weights;
        Ok(Self {
            settings,
            model,
            scene: around,
            driving,
            body,
            bounds,
            start,
            weights,
            chosen: false,
            sides: Sides::default(),
        })
    }

    /// Takes over a changed scene.
    pub fn set_scene(&mut self, scene: &Scene) {
        self.scene = as_for_driving(scene, &self.body);
        self.driving.set_scene(&self.scene);
        self.chosen = false;
    }

    /// What the robot touches at its start, or at another placement, its arm like this; `margin` in metres.
    pub fn contacts(&self, placement: &Placement, arm: &[f64], margin: f64) -> Vec<Contact> {
        let moment = Moment::new(self.scene.all(), self.robot().hand.open(), 0.0);
        self.driving.contacts(&self.scene, &whole(placement, arm), &moment, margin)
    }

    /// What was found on the sides of the target: where the robot could stand to reach it, and what is in its way.
    pub fn sides(&self, arm: &[f64], served: &Served, reachability: &Reachability) -> Vec<SideWhy> {
        /// Placements looked at for what blocks a side.
        const LOOKED_AT: usize = 24;
        let of_side = |(bearing, free, blocked): (f64, usize, &[Placement])| {
            let has_target = |p: &&Placement| served.has_target(reachability, &Root::of(&self.world_from_root(**p)));
            let blocked: Vec<&Placement> = blocked.iter().filter(has_target).collect();
            let mut met: Vec<(String, usize)> = Vec::new();
            for placement in blocked.iter().take(LOOKED_AT) {
                let mut names: Vec<String> = {
                    let met = self.contacts(placement, arm, self.settings.margin).into_iter();
                    met.filter(|c| !matches!(c, Contact::Links(..))).map(Contact::other).collect()
                };
                if !self.in_bounds(placement) {
                    names.push(NAME_OF_CURB.to_owned());
                }
                names.sort_unstable();
                names.dedup();
                for name in names {
                    match met.iter_mut().find(|(known, _)| *known == name) {
                        Some((_, count)) => *count += 1,
                        None => met.push((name, 1)),
                    }
                }
            }
            met.sort_by_key(|(_, count)| std::cmp::Reverse(*count));
            SideWhy {
                bearing,
                tried: free + blocked.len(),
                free,
                blocked_by: met.into_iter().map(|(name, _)| name).collect(),
            }
        };
        self.sides.each().map(of_side).collect()
    }

    fn in_bounds(&self, placement: &Placement) -> bool {
        let root = self.world_from_root(*placement).translation;
        let Rect { min, max } = self.bounds;
        root.x >= min[0] && root.y >= min[1] && root.x <= max[0] && root.y <= max[1]
    }

    pub fn robot(&self) -> &Arc<Robot> {
        &self.model.robot
    }

    /// The root of the standing robot at a placement, in the world.
    pub fn world_from_root(&self, placement: Placement) -> Pose {
        self.driving.world_from_root * moved(placement)
    }

    /// Seconds from one placement to another, at least.
    pub fn seconds(&self, from: &Placement, to: &Placement) -> f64 {
        let turn = (to[2] - from[2] + PI).rem_euclid(TAU) - PI;
        let (x, y) = (to[0] - from[0], to[1] - from[1]);
        let velocity = &self.robot().velocity;
        [x, y, turn].iter().zip(velocity).map(|(d, v)| d.abs() / v).fold(0.0, f64::max)
    }

    /// For asking where the robot may stand, its arm like this, among all objects.
    fn standing<'a>(&'a self, arm: &'a [f64]) -> StandsFree<'a> {
        let mut moment = Moment::new(self.scene.all(), self.robot().hand.open(), self.settings.margin);
        moment.held_margin = moment.margin;
        let quick = Quick::links(&self.driving, &moment);
        StandsFree { base: self, arm, moment, quick, suspects: Suspects::default(), scratch: Scratch::default() }
    }

    /// Drives to a placement, the arm as it is, with what the hand holds.
    pub fn drive<R: Rng>(
        &self,
        carrier: &mut Carrier<R>,
        before: &Situation,
        to: &Placement,
        arm: &[f64],
        held: Option<(ObjectId, &Grasp)>,
    ) -> Attempt<Timed> {
        const WHAT: &str = "driving to where it can be reached from";
        let from = carrier.base.clone();
        let mut goal = to.to_vec();
        goal[2] += TAU * ((from[2] - goal[2]) / TAU).round();
        let world = &self.driving;
        let root = |v: [f64; 2]| world.root_from_world.point(Vec3::new(v[0], v[1], 0.0)).truncate();
        let Rect { min, max } = self.bounds;
        let corners = [min, max, [min[0], max[1]], [max[0], min[1]]].map(root);
        let low = corners.iter().copied().reduce(|a, b| a.min(b)).unwrap_or_default();
        let high = corners.iter().copied().reduce(|a, b| a.max(b)).unwrap_or_default();
        let yaws = (from[2].min(goal[2]) - PI, from[2].max(goal[2]) + PI);
        let lower = whole(&[low.x, low.y, yaws.0], arm);
        let upper = whole(&[high.x, high.y, yaws.1], arm);
        let (start, goal) = (whole(&from, arm), whole(&goal, arm));
        let robot = &world.model.robot;
        let (standing, hand) = match held {
            Some((object, grasp)) => (before.standing.difference(ObjectSet::of(object)), grasp.closed),
            None => (before.standing, robot.hand.open()),
        };
        let mut moment = Moment::new(standing, hand, self.settings.margin);
        moment.placed = before.placed(world);
        if let Some((object, grasp)) = held {
            let mut held = world.in_hand(object, &grasp.object_from_tool);
            held.kernel = Some(world.model.holding(&held.solid()));
            moment.held = Some(held);
        }
        let settings = carrier.settings;
        let mut driver = Carrier { world, base: Vec::new(), within: Some((&lower, &upper)), ..carrier.same() };
        let mut failed = None;
        for margin in [self.settings.margin, settings.margin] {
            (moment.margin, moment.held_margin) = (margin, margin);
            match driver.free_motion(&moment, &start, std::slice::from_ref(&goal), WHAT)? {
                Ok(path) => {
                    (moment.margin, moment.held_margin) = (settings.final_margin, settings.final_margin);
                    return driver.timed(&moment, &path, AtEnds::Nothing, WHAT);
                }
                Err(obstruction) => failed = Some(obstruction),
            }
        }
        match failed {
            Some(obstruction) => Ok(Err(obstruction)),
            None => obstructed(WHAT, ObjectSet::EMPTY),
        }
    }
}

/// Asked where a robot may stand.
struct StandsFree<'a> {
    base: &'a Base,
    arm: &'a [f64],
    moment: Moment,
    quick: Quick,
    suspects: Suspects,
    scratch: Scratch,
}

impl StandsFree<'_> {
    /// For each of some placements, at most [`clearway_collision::lanes::LANES`].
    fn free(&mut self, placements: &[Placement]) -> Vec<bool> {
        let postures: Vec<Posture> = placements.iter().map(|p| whole(p, self.arm)).collect();
        self.quick.suspects(&postures, &mut self.suspects);
        let Self { base, moment, suspects, scratch, .. } = self;
        let free = |(lane, q): (usize, &Posture)| {
            base.driving.touched_among(q, moment, suspects, lane, scratch) == Touch::FREE
        };
        let free: Vec<bool> = postures.iter().enumerate().map(free).collect();
        placements.iter().zip(free).map(|(p, free)| free && base.in_bounds(p)).collect()
    }
}

/// The base's values, then the arm's.
pub fn whole(base: &[f64], arm: &[f64]) -> Posture {
    base.iter().chain(arm).copied().collect()
}

/// Without what is below the robot wherever it drives, but with a curb round the region.
fn as_for_driving(scene: &Scene, body: &Solid) -> Scene {
    /// Overlapping by no more than this is not touching, with room for rounding: metres.
    const RESTING: f64 = 5e-5;
    let (low, _) = body.aabb(scene.base);
    let mut around = scene.clone();
    around.fixtures.retain(|f| f.solid.aabb(f.pose).1.z > low.z + RESTING);
    around.fixtures.extend(scene.file.robot.region.iter().flat_map(|region| curb(region, low.z)));
    around
}

/// The links that no joint of the standing robot moves.
fn body(standing: &CollisionModel) -> Solid {
    let mut frames = Vec::new();
    standing.kinematics.frames(&standing.robot.home, standing.robot.hand.open(), &mut frames);
    let links = standing.robot.links.iter().zip(&frames).zip(&standing.links);
    let still = links.filter(|(_, body)| body.as_ref().is_some_and(|b| b.still));
    let parts = still.flat_map(|((link, frame), _)| {
        link.collision.parts.iter().map(|(pose, convex)| (*frame * *pose, convex.clone()))
    });
    Solid { parts: parts.collect() }
}

/// Four bars round the region, as high as the lowest part of the base.
fn curb(region: &Rect, ground: f64) -> Vec<Fixture> {
    let Rect { min, max } = region;
    let middle = [(min[0] + max[0]) / 2.0, (min[1] + max[1]) / 2.0];
    let half = [(max[0] - min[0]) / 2.0 + CURB, (max[1] - min[1]) / 2.0 + CURB];
    let bar = |x: f64, y: f64, along: f64, across: f64| Fixture {
        id: NAME_OF_CURB.to_owned(),
        solid: Arc::new(Solid::new(Convex::Box { half: Vec3::new(along, across, CURB / 2.0) })),
        pose: Pose::from_translation(Vec3::new(x, y, ground + CURB / 2.0)),
    };
    let half_bar = CURB / 2.0;
    vec![
        bar(min[0] - half_bar, middle[1], half_bar, half[1]),
        bar(max[0] + half_bar, middle[1], half_bar, half[1]),
        bar(middle[0], min[1] - half_bar, half[0], half_bar),
        bar(middle[0], max[1] + half_bar, half[0], half_bar),
    ]
}

fn check_region(region: &Rect, body: &Solid, world_from_root: &Pose) -> Result<(), Unfit> {
    let foot = foot(body);
    let (low, high) = foot.aabb(*world_from_root);
    let size = [region.max[0] - region.min[0], region.max[1] - region.min[1]];
    let wide = [high.x - low.x, high.y - low.y];
    if wide[0] > size[0] || wide[1] > size[1] {
        return Err(Unfit::Region(format!(
            "the region is {:.3} by {:.3} m, the robot's base as it stands {:.3} by {:.3} m",
            size[0], size[1], wide[0], wide[1]
        )));
    }
    let past = [region.min[0] - low.x, region.min[1] - low.y, high.x - region.max[0], high.y - region.max[1]];
    let most = past.into_iter().fold(f64::NEG_INFINITY, f64::max);
    if most > 1e-6 {
        return Err(Unfit::Region(format!("at the start the robot's base reaches {most:.3} m beyond the region")));
    }
    Ok(())
}

/// What of the body is as low as the curb.
fn foot(body: &Solid) -> Solid {
    let bottom = |(pose, convex): &(Pose, Convex)| convex.aabb(pose).0.z;
    let lowest = body.parts.iter().map(bottom).fold(f64::INFINITY, f64::min);
    Solid { parts: body.parts.iter().filter(|p| bottom(p) < lowest + CURB).cloned().collect() }
}

/// Everything that there is to do with, and room round it.
fn surroundings(scene: &Scene, start: &Pose) -> Rect {
    let at = start.translation.truncate();
    let (mut min, mut max) = (at, at);
    for object in &scene.objects {
        let p = object.pose.translation.truncate();
        (min, max) = (min.min(p), max.max(p));
    }
    for place in &scene.places {
        let (p, half) = (place.centre.truncate(), place.size / 2.0);
        (min, max) = (min.min(p - half), max.max(p + half));
    }
    Rect { min: (min - AROUND).to_array(), max: (max + AROUND).to_array() }
}
