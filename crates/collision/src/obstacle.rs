//! Something that stands still, placed in the robot's root frame.

use crate::directions::Directions;
use clearway_geometry::distance::{between, closer_than};
use clearway_geometry::{Convex, Pose, Solid, Vec3};
use clearway_robot::Sphere;

/// A convex part in place.
#[derive(Clone, Debug)]
pub struct PlacedPart {
    pub root_from_part: Pose,
    pub convex: Convex,
    /// Of the part, about its frame's origin.
    pub radius: f64,
    /// Names the part among all, for remembered directions.
    pub tag: usize,
}

impl PlacedPart {
    pub fn new(root_from_part: Pose, convex: Convex, tag: usize) -> Self {
        let radius = convex.bounding_radius();
        Self { root_from_part, convex, radius, tag }
    }

    /// Whether a ball comes closer than `margin`; may say yes for a hull when it does not.
    #[inline]
    pub fn near_ball(&self, centre: Vec3, radius: f64, margin: f64) -> bool {
        let reach = radius + margin;
        if let Convex::Hull(_) = self.convex {
            let apart = centre.distance_squared(self.root_from_part.translation);
            if apart > (reach + self.radius).powi(2) {
                return false;
            }
        }
        self.convex.point_distance(self.root_from_part.inverse_point(centre)) < reach
    }

    /// Whether another placed convex shape comes closer than `margin`.
    #[inline]
    pub fn near_convex(&self, convex: &Convex, root_from_convex: &Pose, margin: f64) -> bool {
        closer_than(&self.convex, &self.root_from_part, convex, root_from_convex, margin)
    }
}

/// A convex part that moves: in the frame of a link, or of what is held.
#[derive(Clone, Debug)]
pub struct MovingPart {
    pub pose: Pose,
    pub convex: Convex,
    /// About its frame's origin.
    pub radius: f64,
    pub tag: usize,
}

impl MovingPart {
    /// Whether the part, its body's frame being at `frame`, comes closer to `other` than `margin`.
    #[inline]
    pub fn near(&self, frame: &Pose, other: &PlacedPart, margin: f64, directions: &mut Directions) -> bool {
        other.near_ball(frame.point(self.pose.translation), self.radius, margin)
            && directions.closer_than(
                (&other.convex, &other.root_from_part, other.tag),
                (&self.convex, &(*frame * self.pose), self.tag),
                margin,
            )
    }
}

/// A solid in place.
#[derive(Clone, Debug)]
pub struct Obstacle {
    pub parts: Vec<PlacedPart>,
    /// Round everything.
    pub bound: Sphere,
    /// The box along the root frame's axes that holds it.
    pub aabb: (Vec3, Vec3),
}

impl Obstacle {
    /// `tag` is the first of as many as the solid has parts.
    pub fn new(solid: &Solid, root_from_solid: &Pose, tag: usize) -> Self {
        let parts: Vec<PlacedPart> = solid
            .parts
            .iter()
            .enumerate()
            .map(|(i, (pose, convex))| PlacedPart::new(*root_from_solid * *pose, convex.clone(), tag + i))
            .collect();
        let balls: Vec<Sphere> =
            parts.iter().map(|p| Sphere { centre: p.root_from_part.translation, radius: p.radius }).collect();
        Self { parts, bound: clearway_robot::bounding_sphere(&balls), aabb: solid.aabb(*root_from_solid) }
    }

    /// Its parts, in the root frame.
    pub fn solid(&self) -> Solid {
        Solid { parts: self.parts.iter().map(|p| (p.root_from_part, p.convex.clone())).collect() }
    }

    /// A quick no: whether what lies within a box along the root frame's axes may come closer than
    /// `margin` at all.
    #[inline]
    pub fn near_aabb(&self, (low, high): (Vec3, Vec3), margin: f64) -> bool {
        low.cmplt(self.aabb.1 + margin).all() && high.cmpgt(self.aabb.0 - margin).all()
    }

    /// A quick no: whether a ball may come closer than `margin` at all.
    #[inline]
    pub fn near_bound(&self, centre: Vec3, radius: f64, margin: f64) -> bool {
        centre.distance_squared(self.bound.centre) < (self.bound.radius + radius + margin).powi(2)
    }

    /// Whether another obstacle comes closer than `margin`.
    pub fn near(&self, other: &Obstacle, margin: f64) -> bool {
        other.near_bound(self.bound.centre, self.bound.radius, margin)
            && self
                .parts
                .iter()
                .any(|p| other.parts.iter().any(|o| o.near_convex(&p.convex, &p.root_from_part, margin)))
    }

    /// How far this can surely go along a unit direction before it touches another, `most` at most; 0 where the two
    /// touch already. Metres.
    pub fn way_to(&self, other: &Obstacle, direction: Vec3, most: f64) -> f64 {
        let swept =
            (self.aabb.0 + (direction * most).min(Vec3::ZERO), self.aabb.1 + (direction * most).max(Vec3::ZERO));
        if !other.near_aabb(swept, 0.0) {
            return most;
        }
        let pairs = self.parts.iter().flat_map(|p| other.parts.iter().map(move |o| (p, o)));
        pairs.fold(most, |way, (p, o)| match between(&p.convex, &p.root_from_part, &o.convex, &o.root_from_part) {
            None => 0.0,
            Some(apart) => {
                // The plane between them, across the shortest way from one to the other, is reached first.
                let nearing = -apart.dot(direction);
                if nearing * way > apart.length_squared() { apart.length_squared() / nearing } else { way }
            }
        })
    }
}
