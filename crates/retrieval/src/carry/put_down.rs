//! Putting down: a spot that the hand can reach with what it holds, and leave without it.

use super::{Attempt, Carrier, obstructed, too_slow};
use crate::grasps::Grasp;
use crate::place::{self, Spot};
use clearway_collision::{Held, Moment, Obstacle, Touch};
use clearway_geometry::Pose;
use clearway_motion::{Path, Posture, Space, distance};
use clearway_plan::{ObjectId, ObjectSet};
use rand::Rng;
use std::sync::Arc;

/// Metres more than has to be kept from what stands where an object is put down: it is lowered beside that, and let go
/// of with fingers that open.
const SPARE: f64 = 0.004;

/// Where an object goes, and how the hand gets there and away.
pub(crate) struct Placement {
    /// root_from_object
    pub pose: Pose,
    /// From above the spot down to it.
    pub lower: Path,
    /// From the spot back, the hand open.
    pub back: Path,
    pub held: Held,
    /// Free motion from the end of the way to above the spot.
    pub transfer: Path,
}

impl<R: Rng> Carrier<'_, R> {
    /// Finds a spot that the hand can reach with the object, along a way out, and leave without it. Given up
    /// where the first one surely takes `left` seconds.
    pub(crate) fn place(
        &mut self,
        object: ObjectId,
        grasp: &Grasp,
        out: &[Posture],
        carrying: &Moment,
        left: f64,
    ) -> Attempt<Placement> {
        const ACROSS: &str = "the motion to the place with the object in hand";
        let (Some(entry), Some(start)) = (out.last(), out.first()) else {
            return obstructed("the way is empty", ObjectSet::EMPTY);
        };
        let world = self.world;
        let scene_pose = world.world_from_root * world.poses[object.index()];
        let base = world.world_from_root.translation.truncate();
        let forward = (scene_pose * grasp.object_from_tool).rotation.z_axis.truncate();
        let mut held = world.in_hand(object, &grasp.object_from_tool);
        held.kernel = Some(world.model.holding(&held.solid()));
        let mut tries = 0;
        let mut blamed = ObjectSet::EMPTY;
        let only_on = self.settings.only_on.get(&object);
        let may_use = |spot: &Spot| only_on.is_none_or(|places| places.contains(&spot.place));
        let spots: Vec<Spot> = place::spots(&self.scene.places, base).into_iter().filter(may_use).collect();
        // Where there is room to spare, if there is such a spot.
        for (spare, spot) in [true, false].into_iter().flat_map(|spare| spots.iter().map(move |spot| (spare, spot))) {
            self.budget.check()?;
            for yaw in place::yaws(forward, spot.at.truncate() - base) {
                let place = &self.scene.places[spot.place];
                let Some(world_from_object) =
                    place::standing_at(&world.solids[object.index()], &scene_pose, yaw, spot, place)
                else {
                    continue;
                };
                let pose = world.root_from_world * world_from_object;
                let placed = world.placed(object, &pose);
                let keeps = |room: f64| {
                    !carrying.placed.iter().any(|(_, other)| placed.near(other, room))
                        && !carrying.standing.iter().any(|id| placed.near(&world.objects[id.index()], room))
                };
                // What has no room to spare waits for its turn.
                if keeps(self.settings.margin + SPARE) != spare || !spare && !keeps(self.settings.margin) {
                    continue;
                }
                let Some(placement) = self.put_down(&held, grasp, entry, carrying, pose, placed) else { continue };
                let (down, clear) = (&placement.back[0], &placement.back[placement.back.len() - 1]);
                if self.least_time(start, down) + self.least_time(down, clear) >= left {
                    return too_slow();
                }
                let mut moment = carrying.clone();
                moment.held = Some(placement.held.clone());
                tries += 1;
                let above = placement.lower[0].clone();
                match self.level_motion(&moment, entry, &above, ACROSS)? {
                    Ok(transfer) => return Ok(Ok(Placement { transfer, ..placement })),
                    Err(obstruction) => blamed = blamed.union(obstruction.blamed),
                }
                if tries >= self.settings.spots {
                    return obstructed(ACROSS, blamed);
                }
                break;
            }
        }
        if tries > 0 {
            return obstructed(ACROSS, blamed);
        }
        obstructed("no spot is left on the places that the hand can reach with the object", ObjectSet::EMPTY)
    }

    /// A motion from rest to rest takes as long at least, by the limits of each joint alone.
    fn least_time(&self, from: &Posture, to: &Posture) -> f64 {
        let robot = &self.world.model.robot;
        let joint = |i: usize| {
            let (way, velocity, acceleration) = ((from[i] - to[i]).abs(), robot.velocity[i], robot.acceleration[i]);
            match way * acceleration < velocity * velocity {
                true => 2.0 * (way / acceleration).sqrt(),
                false => way / velocity + velocity / acceleration,
            }
        };
        (0..from.len()).map(joint).fold(0.0, f64::max)
    }

    /// Whether the object can be lowered onto a spot and let go of there, `placed` among others that it does not touch.
    pub(crate) fn put_down(
        &mut self,
        held: &Held,
        grasp: &Grasp,
        entry: &Posture,
        carrying: &Moment,
        pose: Pose,
        placed: Arc<Obstacle>,
    ) -> Option<Placement> {
        const BACK_STEP: f64 = 0.025;
        let world = self.world;
        let object = held.object;
        // It comes down from above, clear of all but what will carry it.
        let above =
            world.placed(object, &Pose::new(pose.rotation, pose.translation + world.up() * self.settings.lower_step));
        if world.fixtures.iter().any(|f| above.near(f, self.settings.margin)) {
            return None;
        }
        let at = pose * grasp.object_from_tool;
        let mut branches = self.inverse.solve(&at, entry);
        branches.sort_by(|a, b| distance(a, entry).total_cmp(&distance(b, entry)));
        if branches.is_empty() {
            return None;
        }
        let (fixtures_below, objects_below) = world.below(object, &pose);
        let held = Held { fixtures_below, objects_below, ..held.clone() };
        let mut resting = carrying.clone();
        resting.held = Some(held.clone());
        resting.resting = true;
        let mut lowering = resting.clone();
        lowering.resting = false;
        let mut leaving = Moment::new(carrying.standing, world.model.robot.hand.open(), self.settings.margin);
        leaving.placed = carrying.placed.clone();
        leaving.placed.push((object, placed));
        leaving.gripping = Some(object);
        let standoff = world.model.robot.grasps.standoff;
        let mut resting = Space::quick(world, &resting, self.settings.step);
        let mut lowering = Space::quick(world, &lowering, self.settings.step);
        let mut leaving = Space::quick(world, &leaving, self.settings.step);
        'branch: for down in branches {
            if !resting.free(&down) {
                continue;
            }
            let mut lower = vec![down.clone()];
            let mut height = 0.0;
            while height < self.settings.lower_from - 1e-9 {
                height += self.settings.lower_step;
                let target = Pose::new(at.rotation, at.translation + world.up() * height);
                let Some(q) = self.inverse.follow(&target, &lower, 0.5) else { continue 'branch };
                if !lowering.free(&q) {
                    continue 'branch;
                }
                lower.push(q);
            }
            lower.reverse();
            // Opening, the fingers need room between what stands there already.
            if !leaving.free(&down) || self.hand_turning(&down, leaving.moment, grasp.closed) != Touch::FREE {
                continue;
            }
            let mut back = vec![down];
            let mut out = 0.0;
            while out < standoff - 1e-9 {
                out += BACK_STEP;
                let target = Pose::new(at.rotation, at.translation - at.rotation.z_axis * out);
                let Some(q) = self.inverse.follow(&target, &back, 0.5) else { continue 'branch };
                if !leaving.free(&q) {
                    continue 'branch;
                }
                back.push(q);
            }
            return Some(Placement { pose, lower, back, held, transfer: Path::new() });
        }
        None
    }
}
