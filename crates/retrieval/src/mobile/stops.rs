//! Where the base may stand: placements from which the arm gets to the objects and to the places
//! ([`Reachability`] tells which), and of these a few that together serve as much as can be.
//!
//! What counts as served are the declared grasps, those of the target more than others', and spots to put
//! it down. Placements are looked at on a grid, those on each side of the target that serve most first, until
//! enough are found at which the robot meets nothing. Then the placement that adds most is taken, again
//! and again.

use super::Base;
use crate::grasps::preset_grasps;
use crate::place::{self, Spot};
use clearway_collision::World;
use clearway_collision::lanes::LANES;
use clearway_geometry::{Pose, Vec2};
use clearway_plan::ObjectId;
use clearway_robot::{Aim, Placement, Reachability, Root};
use clearway_scene::Scene;
use std::f64::consts::{PI, TAU};

/// What was found at the placements that serve most, by side as seen from the target.
#[derive(Clone, Debug, Default)]
pub struct Sides {
    /// By side: placements at which the robot can stand and has the target in reach.
    free: [usize; Sides::COUNT],
    /// And those at which it cannot stand.
    blocked: [Vec<Placement>; Sides::COUNT],
}

impl Sides {
    /// The first is along the world's x, the next ones to the left of it.
    pub const COUNT: usize = 8;

    fn of(bearing: f64) -> usize {
        (bearing / TAU * Self::COUNT as f64).round().rem_euclid(Self::COUNT as f64) as usize % Self::COUNT
    }

    /// The direction from the target, radians; how many placements are free there; those that are not.
    pub fn each(&self) -> impl Iterator<Item = (f64, usize, &[Placement])> {
        (0..Self::COUNT).map(|s| (s as f64 * TAU / Self::COUNT as f64, self.free[s], self.blocked[s].as_slice()))
    }
}

/// Something to be reached with the hand.
struct Errand {
    aim: Aim,
    /// Errands of one group are served when one of them is.
    group: usize,
    weight: f64,
    is_target: bool,
}

/// How often the hand has to be met for a pose to count as well served.
const ENOUGH: f64 = 6.0;
/// Of the grid: metres, directions, and paces at most along a side.
const PACE: f64 = 0.1;
const YAWS: usize = 16;
const MOST_PACES: f64 = 80.0;
/// Placements tried on a side at most, and enough that are free.
const TRIED: usize = 640;
const FREE: usize = 48;
/// Grasps of other objects looked at, and spots of a place.
const GRASPS: usize = 12;
const SPOTS: usize = 8;
/// Every so many of the target's grasps and the spots' are enough to tell what a placement is worth.
const EVERY: usize = 5;
/// What a target's grasp and a place's spot count beside another object's grasp.
const TARGET: f64 = 4.0;
const SPOT: f64 = 6.0;
/// A stop adds at least this part of all there is.
const LEAST_GAIN: f64 = 0.015;

/// What can be served from somewhere.
pub struct Served {
    errands: Vec<Errand>,
    groups: usize,
    places: usize,
    /// Errands that tell what a placement is worth: every so many of the target's and of the places'.
    telling: Vec<usize>,
}

impl Served {
    pub fn of(scene: &Scene, world: &World, loosely: bool) -> Self {
        let mut errands = Vec::new();
        let mut groups = 0;
        for index in 0..scene.objects.len() {
            let object = ObjectId(index as u16);
            let is_target = object == scene.target;
            let grasps = preset_grasps(world, object, loosely).grasps;
            let step = if is_target { 1 } else { grasps.len().div_ceil(GRASPS).max(1) };
            let weight = if is_target { TARGET } else { 1.0 };
            for grasp in grasps.iter().step_by(step) {
                errands.push(Errand {
                    aim: Aim::of(&(scene.objects[index].pose * grasp.object_from_tool)),
                    group: groups,
                    weight,
                    is_target,
                });
                groups += 1;
            }
        }
        // Spots, spread over the places; the target stands for what is put down.
        let places = groups;
        let target = &scene.objects[scene.target.index()];
        let grasps = preset_grasps(world, scene.target, loosely).grasps;
        let step = grasps.len().div_ceil(GRASPS).max(1);
        for index in 0..scene.places.len() {
            let spots: Vec<Spot> = place::spots(&scene.places[index..=index], Vec2::ZERO);
            for spot in spots.iter().step_by(spots.len().div_ceil(SPOTS).max(1)) {
                let Some(pose) = place::standing_at(&target.solid, &target.pose, 0.0, spot, &scene.places[index])
                else {
                    continue;
                };
                for grasp in grasps.iter().step_by(step) {
                    errands.push(Errand {
                        aim: Aim::of(&(pose * grasp.object_from_tool)),
                        group: groups,
                        weight: SPOT,
                        is_target: false,
                    });
                }
                groups += 1;
            }
        }
        let telling = (0..errands.len()).filter(|&i| errands[i].weight > 1.0).step_by(EVERY).collect();
        Self { errands, groups, places, telling }
    }

    /// By group: how well it is served by a robot whose root is there, from 0 to 1.
    fn from(&self, reachability: &Reachability, root: &Root) -> Vec<f64> {
        let mut served = vec![0.0f64; self.groups];
        for errand in &self.errands {
            let met = reachability.met(root, &errand.aim) as f64;
            let group = &mut served[errand.group];
            *group = group.max((met / ENOUGH).min(1.0));
        }
        served
    }

    /// Whether the target is within reach from there.
    pub fn has_target(&self, reachability: &Reachability, root: &Root) -> bool {
        self.errands.iter().any(|e| e.is_target && reachability.met(root, &e.aim) > 0)
    }

    /// How many spots for what is put down are served from there.
    pub fn spots(&self, reachability: &Reachability, world_from_root: &Pose) -> f64 {
        self.from(reachability, &Root::of(world_from_root))[self.places..].iter().sum()
    }

    /// What is served of the target, by some of its grasps, and of the places; quickly told.
    fn worth(&self, reachability: &Reachability, root: &Root) -> f64 {
        let met = |e: &Errand| (reachability.met(root, &e.aim) as f64 / ENOUGH).min(1.0) * e.weight;
        self.telling.iter().map(|&i| met(&self.errands[i])).sum()
    }

    fn weights(&self) -> Vec<f64> {
        let mut weights = vec![0.0; self.groups];
        for errand in &self.errands {
            weights[errand.group] = errand.weight;
        }
        weights
    }
}

/// The stops after the start, the most useful first, and what was found on the sides of the target.
pub fn choose(
    base: &Base,
    scene: &Scene,
    served: &Served,
    reachability: &Reachability,
    arm: &[f64],
) -> (Vec<Placement>, Sides) {
    let target = scene.objects[scene.target.index()].pose.translation.truncate();
    let weights = served.weights();
    // By side: placements that serve something, and how much.
    let mut useful: Vec<Vec<(f64, Placement)>> = vec![Vec::new(); Sides::COUNT];
    for placement in grid(base, served, reachability) {
        let root = Root::of(&base.world_from_root(placement));
        let worth = served.worth(reachability, &root);
        if worth > 0.0 {
            let root = base.world_from_root(placement).translation.truncate();
            useful[Sides::of((root - target).to_angle())].push((worth, placement));
        }
    }
    let mut sides = Sides::default();
    let mut standing = base.standing(arm);
    let mut candidates: Vec<(Placement, Vec<f64>)> = Vec::new();
    for (side, mut useful) in useful.into_iter().enumerate() {
        useful.sort_by(|a, b| b.0.total_cmp(&a.0));
        let mut found = 0;
        for some in useful[..useful.len().min(TRIED)].chunks(LANES) {
            let placements: Vec<Placement> = some.iter().map(|(_, p)| *p).collect();
            for (placement, free) in placements.iter().zip(standing.free(&placements)) {
                if free {
                    let root = Root::of(&base.world_from_root(*placement));
                    found += 1;
                    sides.free[side] += usize::from(served.has_target(reachability, &root));
                    candidates.push((*placement, served.from(reachability, &root)));
                } else {
                    sides.blocked[side].push(*placement);
                }
            }
            if found >= FREE {
                break;
            }
        }
    }
    let mut best = served.from(reachability, &Root::of(&base.world_from_root(base.start)));
    let all: f64 = weights.iter().sum();
    let mut stops = Vec::new();
    while stops.len() + 1 < base.settings.stops {
        let gain = |served: &Vec<f64>| -> f64 {
            served.iter().zip(&best).zip(&weights).map(|((s, b), w)| (s - b).max(0.0) * w).sum()
        };
        let most = candidates.iter().map(|(_, s)| gain(s)).enumerate().max_by(|a, b| a.1.total_cmp(&b.1));
        let Some((index, gain)) = most else { break };
        if gain < LEAST_GAIN * all {
            break;
        }
        let (placement, served) = candidates.swap_remove(index);
        best.iter_mut().zip(&served).for_each(|(b, s)| *b = b.max(*s));
        stops.push(placement);
    }
    (stops, sides)
}

/// Placements all round what is to be reached.
fn grid(base: &Base, served: &Served, reachability: &Reachability) -> impl Iterator<Item = Placement> {
    let zero = base.driving.world_from_root;
    let at = |e: &Errand| zero.inverse_point(e.aim.at).truncate();
    let low = served.errands.iter().map(at).reduce(|a, b| a.min(b)).unwrap_or_default() - reachability.farthest();
    let high = served.errands.iter().map(at).reduce(|a, b| a.max(b)).unwrap_or_default() + reachability.farthest();
    let count = ((high - low) / PACE).ceil().min(Vec2::splat(MOST_PACES));
    let (nx, ny) = (count.x as usize + 1, count.y as usize + 1);
    (0..nx * ny * YAWS).map(move |i| {
        let (yaw, cell) = (i % YAWS, i / YAWS);
        let p = low + PACE * Vec2::new((cell % nx) as f64, (cell / nx) as f64);
        [p.x, p.y, yaw as f64 * TAU / YAWS as f64 - PI]
    })
}
