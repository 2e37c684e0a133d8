//! How far an object can slide: clear of everything, and on what carries it.

use clearway_collision::{Obstacle, World};
use clearway_geometry::{Pose, Vec3};
use clearway_plan::{ObjectId, ObjectSet};
use clearway_scene::Scene;

/// Between places looked at where something is near, metres: from one to the next a cylinder as wide as a bottle sweeps
/// less than 0.1 mm beyond both.
const STEP: f64 = 0.005;
/// A way that surely is clear ends where two things touch; this much before, they do not.
const ROUNDING: f64 = 1e-6;
/// An object is looked at raised by this: what carries it does not count.
const RAISED: f64 = 0.003;
/// Between places at which it is made sure that it does not reach over an edge, metres.
const STANDS_STEP: f64 = 0.04;
/// So much of its foot is carried in the direction of the push: discs count as polygons.
const CARRIED: f64 = 0.97;

/// What is pushed, from where (root frame), and what else there is.
pub(crate) struct Course<'a> {
    pub world: &'a World,
    pub scene: &'a Scene,
    pub object: ObjectId,
    /// Others that stand where the scene has them.
    pub standing: ObjectSet,
    /// Others elsewhere.
    pub placed: &'a [(ObjectId, std::sync::Arc<Obstacle>)],
    /// Room kept all round.
    pub room: f64,
}

impl Course<'_> {
    pub fn pose(&self, direction: Vec3, distance: f64) -> Pose {
        let from = self.world.poses[self.object.index()];
        Pose::new(from.rotation, from.translation + direction * distance)
    }

    /// How far it can go before something is nearer than the room kept, up to `farthest`.
    pub fn clear(&self, direction: Vec3, farthest: f64) -> f64 {
        let Self { world, object, room, .. } = *self;
        let raise = world.up() * RAISED;
        let others = || {
            self.standing
                .iter()
                .map(|id| &world.objects[id.index()])
                .chain(&world.fixtures)
                .chain(self.placed.iter().map(|(_, o)| &**o))
        };
        let (mut clear, mut next) = (0.0, 0.0);
        while next <= farthest + 1e-9 {
            let at = self.pose(direction, next);
            let there = world.placed_with_room(object, &Pose::new(at.rotation, at.translation + raise), room);
            let least = |way: f64, other: &Obstacle| if way > 0.0 { there.way_to(other, direction, way) } else { way };
            let way = others().fold(farthest - next + STEP, least);
            if way <= 0.0 {
                break;
            }
            (clear, next) = (next + way, next + way.max(STEP));
        }
        (clear - ROUNDING).clamp(0.0, farthest)
    }

    /// Whether it stays on what carries it with all of its foot, `radius` wide, as far as it leads the way: up to the end
    /// and a margin further. Over an edge it would tip sooner.
    pub fn carried(&self, direction: Vec3, distance: f64, radius: f64) -> bool {
        let Self { world, scene, object, room, .. } = *self;
        let ahead = (world.world_from_root.rotation * direction).truncate();
        let (fixtures, _) = &world.carriers[object.index()];
        let steps = (distance / STANDS_STEP).ceil().max(1.0) as usize;
        let stops = (1..=steps).map(|i| distance * i as f64 / steps as f64).chain([distance + room]);
        stops.into_iter().all(|d| {
            let at = self.pose(direction, d);
            world.below(object, &at).0 == *fixtures
                && scene
                    .foothold(object, &(world.world_from_root * at), ahead)
                    .is_some_and(|reach| reach >= CARRIED * radius)
        })
    }
}
