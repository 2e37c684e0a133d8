//! Where the base may stand: placements from which the arm gets to the objects and to the places, by
//! inverse reachability, and of these a few that together serve as much as can be.
//!
//! What counts as served are the declared grasps, those of the target more than others', and spots to put
//! it down. Placements are drawn round each of them as often as the hand was met there
//! ([`clearway_robot::Reachability`]); those where the robot meets something are left out. Then the
//! placement that adds most is taken, again and again.

use super::Base;
use crate::grasps::preset_grasps;
use crate::place::{self, Spot};
use clearway_collision::{Scratch, Touch, World};
use clearway_geometry::{Pose, Vec2, Vec3};
use clearway_plan::ObjectId;
use clearway_robot::{Placement, Reachability};
use clearway_scene::Scene;
use rand::{Rng, RngExt, SeedableRng};
use rand_xoshiro::Xoshiro256PlusPlus;
use std::f64::consts::TAU;

/// Where placements from which the target could be reached were drawn, as seen from the target.
#[derive(Clone, Debug, Default)]
pub struct Sides {
    /// By side: placements at which the robot can stand.
    free: [usize; Sides::COUNT],
    /// And those at which it cannot.
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
    world_from_tool: Pose,
    /// Errands of one group are served when one of them is.
    group: usize,
    weight: f64,
}

/// How often the hand has to be met for a pose to count as well served.
const ENOUGH: f64 = 6.0;
/// Placements drawn for a grasp of the target, and for other errands.
const FOR_TARGET: usize = 5;
const FOR_OTHERS: usize = 1;
/// Grasps of other objects looked at, and spots of a place.
const GRASPS: usize = 12;
const SPOTS: usize = 8;
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
}

impl Served {
    pub fn of(scene: &Scene, world: &World) -> Self {
        let mut errands = Vec::new();
        let mut groups = 0;
        for index in 0..scene.objects.len() {
            let object = ObjectId(index as u16);
            let is_target = object == scene.target;
            let (grasps, _) = preset_grasps(world, object);
            let step = if is_target { 1 } else { grasps.len().div_ceil(GRASPS).max(1) };
            let weight = if is_target { TARGET } else { 1.0 };
            for grasp in grasps.iter().step_by(step) {
                errands.push(Errand { world_from_tool: scene.objects[index].pose * grasp.object_from_tool, group: groups, weight });
                groups += 1;
            }
        }
        // Spots, spread over the places; the target stands for what is put down.
        let places = groups;
        let target = &scene.objects[scene.target.index()];
        let (grasps, _) = preset_grasps(world, scene.target);
        let step = grasps.len().div_ceil(GRASPS).max(1);
        for index in 0..scene.places.len() {
            let spots: Vec<Spot> = place::spots(&scene.places[index..=index], Vec2::ZERO);
            for spot in spots.iter().step_by(spots.len().div_ceil(SPOTS).max(1)) {
                let Some(pose) = place::standing_at(&target.solid, &target.pose, 0.0, spot, &scene.places[index]) else { continue };
                for grasp in grasps.iter().step_by(step) {
                    errands.push(Errand { world_from_tool: pose * grasp.object_from_tool, group: groups, weight: SPOT });
                }
                groups += 1;
            }
        }
        Self { errands, groups, places }
    }

    /// By group: how well it is served by a robot whose root is there, from 0 to 1.
    fn from(&self, reachability: &Reachability, root_from_world: &Pose) -> Vec<f64> {
        let mut served = vec![0.0f64; self.groups];
        for errand in &self.errands {
            let met = reachability.met(&(*root_from_world * errand.world_from_tool)) as f64;
            let group = &mut served[errand.group];
            *group = group.max((met / ENOUGH).min(1.0));
        }
        served
    }

    /// How many spots for what is put down are served from there.
    pub fn spots(&self, reachability: &Reachability, root_from_world: &Pose) -> f64 {
        self.from(reachability, root_from_world)[self.places..].iter().sum()
    }

    fn weights(&self) -> Vec<f64> {
        let mut weights = vec![0.0; self.groups];
        for errand in &self.errands {
            weights[errand.group] = errand.weight;
        }
        weights
    }
}

/// The stops after the start, the most useful first; and on which sides there is none, because of what.
pub fn choose(base: &Base, scene: &Scene, served: &Served, reachability: &Reachability, arm: &[f64]) -> (Vec<Placement>, Sides) {
    let mut random = Xoshiro256PlusPlus::seed_from_u64(0x5374_6f70);
    let mut scratch = Scratch::default();
    let weights = served.weights();
    let target = scene.objects[scene.target.index()].pose.translation.truncate();
    let mut sides = Sides::default();
    let mut candidates: Vec<(Placement, Vec<f64>)> = Vec::new();
    let mut drawn = Vec::new();
    for errand in &served.errands {
        let draws = if errand.weight == TARGET { FOR_TARGET } else { FOR_OTHERS };
        let height = base.driving.world_from_root.translation.z;
        drawn.clear();
        let mut total = 0.0;
        reachability.placements(&errand.world_from_tool, height, |placement, met| {
            total += met as f64;
            drawn.push((placement, total));
        });
        for _ in 0..draws.min(drawn.len()) {
            let at = random.random::<f64>() * total;
            let world = drawn[drawn.partition_point(|(_, sum)| *sum < at).min(drawn.len() - 1)].0;
            let placement = in_base(base, jittered(world, &mut random));
            let root = base.world_from_root(placement);
            let touch = base.stands_free(&placement, arm, &mut scratch);
            if errand.weight == TARGET {
                let bearing = (root.translation.truncate() - target).to_angle();
                match touch {
                    Touch::FREE => sides.free[Sides::of(bearing)] += 1,
                    _ => sides.blocked[Sides::of(bearing)].push(placement),
                }
            }
            if touch == Touch::FREE {
                candidates.push((placement, served.from(reachability, &root.inverse())));
            }
        }
    }
    let mut best = served.from(reachability, &base.world_from_root(base.start).inverse());
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

/// The cells of the map are wide: somewhere within.
fn jittered([x, y, yaw]: Placement, random: &mut impl Rng) -> Placement {
    let mut about = |width: f64| (random.random::<f64>() - 0.5) * width;
    [x + about(0.1), y + about(0.1), yaw + about(0.26)]
}

/// A placement of the root in the world as values of the base's joints.
fn in_base(base: &Base, [x, y, yaw]: Placement) -> Placement {
    let zero = base.driving.world_from_root;
    let at = zero.inverse_point(Vec3::new(x, y, zero.translation.z));
    let ahead = zero.rotation.x_axis;
    [at.x, at.y, yaw - ahead.y.atan2(ahead.x)]
}
