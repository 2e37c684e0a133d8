//! Where the open hand meets an object that it pushes, and whether it stays before the hand.

use crate::grasps::hand;
use clearway_collision::World;
use clearway_geometry::distance::{between, closer_than};
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

/// A part of the hand or of the object, seen from the tool.
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
        let others: Vec<Part> = solid.parts.iter().map(|(pose, convex)| (*tool_from_object * *pose, convex)).collect();
        let at = |(pose, _): &Part, moved: Vec3| Pose::new(pose.rotation, pose.translation + moved);
        // Two parts that keep a gap along a line meet no sooner than they come closer along that line: the sum of such
        // steps leads there.
        let travel = |shift: Vec3| {
            let mut along = 0.0;
            while along <= FARTHEST {
                let moved = direction * along - shift;
                let mut step = FARTHEST;
                let pairs = parts.iter().flat_map(|part| others.iter().map(move |other| (part, other)));
                for (part, (there, other)) in pairs {
                    let here = at(part, moved);
                    // Exact distances take longer.
                    if !closer_than(part.1, &here, other, there, step + TOUCH) {
                        continue;
                    }
                    let Some(apart) = between(part.1, &here, other, there) else { return Some(along) };
                    let gap = apart.length();
                    let closing = -apart.dot(direction) / gap;
                    if closing > 0.0 {
                        if gap <= 1.02 * TOUCH {
                            return Some(along);
                        }
                        step = step.min((gap - TOUCH) / closing);
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
        let touches = |part: &&Part| {
            let here = at(part, direction * free);
            others.iter().any(|(there, other)| closer_than(part.1, &here, other, there, NEAR))
        };
        let touching = parts.iter().filter(touches);
        let top = touching.map(|(pose, convex)| pose.point(convex.support(pose.rotation.transpose() * up)).dot(up));
        Some(Self { direction, free, top: top.fold(f64::NEG_INFINITY, f64::max) })
    }
}
