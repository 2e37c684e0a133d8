//! Where the open hand meets an object that it pushes, and whether it stays before the hand.

use crate::grasps::hand;
use clearway_collision::World;
use clearway_geometry::distance::{between, closer_than, distance};
use clearway_geometry::{Convex, Pose, Solid, Vec3};

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

/// A part of the hand, seen from the tool.
type Part<'a> = (Pose, &'a Convex);

impl Contact {
    /// `None` where the hand does not meet the object, or where the object, off to one side by `aside`, would
    /// not be held back as soon: pushed by an edge it turns away.
    pub fn of(
        world: &World,
        solid: &Solid,
        tool_from_object: &Pose,
        direction: Vec3,
        up: Vec3,
        aside: f64,
    ) -> Option<Self> {
        let open = world.model.robot.hand.open();
        let parts: Vec<Part> = hand(world, open).collect();
        let gap = |part: &Part, moved: Vec3, most: f64| {
            let pose = Pose::new(part.0.rotation, part.0.translation + moved);
            solid.parts.iter().fold(most, |nearest, (p, convex)| {
                let there = *tool_from_object * *p;
                // Exact distances take longer.
                if closer_than(part.1, &pose, convex, &there, nearest) {
                    nearest.min(distance(part.1, &pose, convex, &there))
                } else {
                    nearest
                }
            })
        };
        // Two parts that keep a gap along a line meet no sooner than they come closer along that line: the sum of such
        // steps leads there.
        let travel = |shift: Vec3| {
            let mut along = 0.0;
            while along <= FARTHEST {
                let moved = direction * along - shift;
                let mut step = FARTHEST;
                for (pose, convex) in &parts {
                    let pose = Pose::new(pose.rotation, pose.translation + moved);
                    for (p, other) in &solid.parts {
                        let there = *tool_from_object * *p;
                        // Exact distances take longer.
                        if !closer_than(convex, &pose, other, &there, step + TOUCH) {
                            continue;
                        }
                        let Some(apart) = between(convex, &pose, other, &there) else { return Some(along) };
                        let gap = apart.length();
                        let closing = -apart.dot(direction) / gap;
                        if gap <= 1.02 * TOUCH && closing > 0.0 {
                            return Some(along);
                        }
                        if closing > 0.0 {
                            step = step.min((gap - TOUCH) / closing);
                        }
                    }
                }
                along += step;
            }
            None
        };
        let free = travel(Vec3::ZERO)?;
        let side = direction.cross(up).normalize_or_zero() * aside;
        let held_back = |shift| travel(shift).is_some_and(|t| t <= free + SLIPS);
        if !held_back(side) || !held_back(-side) {
            return None;
        }
        let touching = parts.iter().filter(|p| gap(p, direction * free, NEAR) < NEAR);
        let top = touching.map(|(pose, convex)| pose.point(convex.support(pose.rotation.transpose() * up)).dot(up));
        Some(Self { direction, free, top: top.fold(f64::NEG_INFINITY, f64::max) })
    }
}
