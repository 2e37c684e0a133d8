//! Where the open hand meets an object that it pushes, and whether it stays before the hand.

use crate::grasps::hand;
use clearway_collision::World;
use clearway_geometry::distance::distance;
use clearway_geometry::{Pose, Solid, Vec3};

/// The hand moved along a direction from where it is round the object until it meets it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Contact {
    /// Unit, in the tool's frame: along its x (the way the fingers close) or its z (ahead).
    pub direction: Vec3,
    /// The hand's way to the object.
    pub free: f64,
    /// The highest point at which it pushes, above the tool's origin.
    pub top: f64,
}

/// The hand stops so far before it overlaps: rounding must not make it.
const TOUCH: f64 = 5e-5;
/// Of what is no farther than this some may push.
const NEAR: f64 = 1.5e-3;
/// An object off to the side is met so much later at most, else it would slip past.
const SLIPS: f64 = 2e-4;
/// The hand does not go farther to meet the object.
const FARTHEST: f64 = 0.08;

impl Contact {
    /// `None` where the hand does not meet the object, or where the object, off to one side by `aside`, would
    /// not be held back as soon: pushed by an edge it turns away.
    pub fn of(world: &World, solid: &Solid, tool_from_object: &Pose, direction: Vec3, up: Vec3, aside: f64) -> Option<Self> {
        let open = world.model.robot.hand.open();
        let parts: Vec<_> = hand(world, open)
            .into_iter()
            .flat_map(|(link, pose)| world.model.robot.links[link].collision.parts.iter().map(move |(part, convex)| (pose * *part, convex)))
            .collect();
        let gap = |part: &(Pose, &clearway_geometry::Convex), moved: Vec3| {
            let pose = Pose::new(part.0.rotation, part.0.translation + moved);
            let to = |(p, convex): &(Pose, clearway_geometry::Convex)| distance(part.1, &pose, convex, &(*tool_from_object * *p));
            solid.parts.iter().map(to).fold(f64::INFINITY, f64::min)
        };
        // The nearest it can be met is as far as the gap: the sum of gaps leads there.
        let travel = |shift: Vec3| {
            let mut along = 0.0;
            while along <= FARTHEST {
                let moved = direction * along - shift;
                let gap = parts.iter().map(|p| gap(p, moved)).fold(f64::INFINITY, f64::min);
                if gap <= 1.02 * TOUCH {
                    return Some(along);
                }
                along += gap - TOUCH;
            }
            None
        };
        let free = travel(Vec3::ZERO)?;
        let side = direction.cross(up).normalize_or_zero() * aside;
        let held_back = |shift| travel(shift).is_some_and(|t| t <= free + SLIPS);
        if !held_back(side) || !held_back(-side) {
            return None;
        }
        let touching = parts.iter().filter(|p| gap(p, direction * free) < NEAR);
        let top = touching.map(|(pose, convex)| pose.point(convex.support(pose.rotation.transpose() * up)).dot(up));
        Some(Self { direction, free, top: top.fold(f64::NEG_INFINITY, f64::max) })
    }
}
