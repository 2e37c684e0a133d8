//! Convex shapes, and solids made of them.

use crate::Pose;
use glam::DVec3;
use std::sync::Arc;

/// A convex shape in its own frame, which sits at its centre.
#[derive(Clone, Debug)]
pub enum Convex {
    Sphere { radius: f64 },
    /// `half` is half the height of the cylindrical part, the caps not counted; along z.
    Capsule { radius: f64, half: f64 },
    /// `half` is half the full height; along z.
    Cylinder { radius: f64, half: f64 },
    Box { half: DVec3 },
    Hull(Arc<Hull>),
}

/// The convex hull of some points: its corners and its outward face planes.
#[derive(Clone, Debug)]
pub struct Hull {
    pub points: Vec<DVec3>,
    /// Triangles with outward winding, as indices into `points`.
    pub triangles: Vec<[u32; 3]>,
    /// Outward unit normal `n` and offset `d`, one per face: inside is `n·p ≤ d`.
    pub planes: Vec<(DVec3, f64)>,
}

impl Convex {
    /// The point of the shape farthest along `direction`, which need not be of unit length.
    #[inline]
    pub fn support(&self, direction: DVec3) -> DVec3 {
        match self {
            Convex::Sphere { radius } => *radius * direction.normalize_or_zero(),
            Convex::Capsule { radius, half } => {
                DVec3::new(0.0, 0.0, half.copysign(direction.z)) + *radius * direction.normalize_or_zero()
            }
            Convex::Cylinder { radius, half } => {
                let side = direction.truncate().normalize_or_zero() * *radius;
                DVec3::new(side.x, side.y, half.copysign(direction.z))
            }
            Convex::Box { half } => DVec3::new(
                half.x.copysign(direction.x),
                half.y.copysign(direction.y),
                half.z.copysign(direction.z),
            ),
            Convex::Hull(hull) => {
                let mut best = hull.points[0];
                let mut most = best.dot(direction);
                for &p in &hull.points[1..] {
                    let along = p.dot(direction);
                    if along > most {
                        most = along;
                        best = p;
                    }
                }
                best
            }
        }
    }

    /// A sphere about the own frame's origin that holds the shape: its radius.
    pub fn bounding_radius(&self) -> f64 {
        match self {
            Convex::Sphere { radius } => *radius,
            Convex::Capsule { radius, half } => radius + half,
            Convex::Cylinder { radius, half } => radius.hypot(*half),
            Convex::Box { half } => half.length(),
            Convex::Hull(hull) => hull.points.iter().map(|p| p.length()).fold(0.0, f64::max),
        }
    }
}

/// One or more convex parts, rigidly joined.
#[derive(Clone, Debug, Default)]
pub struct Solid {
    /// `(solid_from_part, part)`.
    pub parts: Vec<(Pose, Convex)>,
}

impl Solid {
    pub fn new(convex: Convex) -> Self {
        Self { parts: vec![(Pose::IDENTITY, convex)] }
    }

    /// The same solid seen from an outer frame.
    pub fn transformed(&self, outer_from_solid: Pose) -> Solid {
        Solid { parts: self.parts.iter().map(|(pose, c)| (outer_from_solid * *pose, c.clone())).collect() }
    }

    /// The point farthest along `direction`, in the solid's frame.
    pub fn support(&self, direction: DVec3) -> DVec3 {
        let mut best = DVec3::ZERO;
        let mut most = f64::NEG_INFINITY;
        for (pose, convex) in &self.parts {
            let p = pose.point(convex.support(pose.rotation.transpose() * direction));
            if p.dot(direction) > most {
                most = p.dot(direction);
                best = p;
            }
        }
        best
    }

    /// How deep a point lies inside one of the parts: a ball of this radius about it is part of the
    /// solid. Negative outside of all.
    pub fn depth(&self, p: DVec3) -> f64 {
        self.parts.iter().map(|(pose, convex)| -convex.point_distance(pose.inverse_point(p))).fold(f64::NEG_INFINITY, f64::max)
    }

    /// The axis-aligned box `(min, max)` that holds the solid placed at `world_from_solid`.
    pub fn aabb(&self, world_from_solid: Pose) -> (DVec3, DVec3) {
        let back = world_from_solid.rotation.transpose();
        let extent = |axis: DVec3| world_from_solid.point(self.support(back * axis)).dot(axis);
        let max = DVec3::new(extent(DVec3::X), extent(DVec3::Y), extent(DVec3::Z));
        let min = -DVec3::new(extent(-DVec3::X), extent(-DVec3::Y), extent(-DVec3::Z));
        (min, max)
    }
}
