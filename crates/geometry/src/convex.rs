//! Convex shapes, and solids made of them.

use crate::Pose;
use glam::DVec3;
use std::sync::Arc;

/// A convex shape in its own frame, which sits at its centre.
#[derive(Clone, Debug)]
pub enum Convex {
    Sphere {
        radius: f64,
    },
    /// `half` is half the height of the cylindrical part, the caps not counted; along z.
    Capsule {
        radius: f64,
        half: f64,
    },
    /// `half` is half the full height; along z.
    Cylinder {
        radius: f64,
        half: f64,
    },
    Box {
        half: DVec3,
    },
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
            Convex::Box { half } => {
                DVec3::new(half.x.copysign(direction.x), half.y.copysign(direction.y), half.z.copysign(direction.z))
            }
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

    /// The axis-aligned box `(min, max)` that holds the shape placed at `pose`.
    pub fn aabb(&self, pose: &Pose) -> (DVec3, DVec3) {
        let rotation = &pose.rotation;
        let reach = match self {
            Convex::Sphere { radius } => DVec3::splat(*radius),
            Convex::Capsule { radius, half } => *radius + *half * rotation.z_axis.abs(),
            Convex::Cylinder { radius, half } => {
                let along = rotation.z_axis;
                // Across an axis the disc reaches as far as the axis leans away from it.
                let disc = (DVec3::ONE - along * along).max(DVec3::ZERO);
                *half * along.abs() + *radius * DVec3::new(disc.x.sqrt(), disc.y.sqrt(), disc.z.sqrt())
            }
            Convex::Box { half } => {
                half.x * rotation.x_axis.abs() + half.y * rotation.y_axis.abs() + half.z * rotation.z_axis.abs()
            }
            Convex::Hull(hull) => {
                let points = hull.points.iter().map(|p| pose.point(*p));
                let none = (DVec3::splat(f64::INFINITY), DVec3::splat(f64::NEG_INFINITY));
                return points.fold(none, |(min, max), p| (min.min(p), max.max(p)));
            }
        };
        (pose.translation - reach, pose.translation + reach)
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
        self.parts
            .iter()
            .map(|(pose, convex)| -convex.point_distance(pose.inverse_point(p)))
            .fold(f64::NEG_INFINITY, f64::max)
    }

    /// The axis-aligned box `(min, max)` that holds the solid placed at `world_from_solid`.
    pub fn aabb(&self, world_from_solid: Pose) -> (DVec3, DVec3) {
        let boxes = self.parts.iter().map(|(pose, convex)| convex.aabb(&(world_from_solid * *pose)));
        let none = (DVec3::splat(f64::INFINITY), DVec3::splat(f64::NEG_INFINITY));
        boxes.fold(none, |a, b| (a.0.min(b.0), a.1.max(b.1)))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn boxes_reach_as_far_as_supports() {
        let corners = [[0.1, 0.0, 0.0], [-0.1, 0.05, 0.0], [0.0, -0.1, 0.02], [0.0, 0.0, 0.2], [0.03, 0.04, -0.1]];
        let hull = Hull { points: corners.map(DVec3::from_array).to_vec(), triangles: Vec::new(), planes: Vec::new() };
        let shapes = [
            Convex::Sphere { radius: 0.07 },
            Convex::Capsule { radius: 0.03, half: 0.1 },
            Convex::Cylinder { radius: 0.05, half: 0.02 },
            Convex::Box { half: DVec3::new(0.1, 0.2, 0.03) },
            Convex::Hull(Arc::new(hull)),
        ];
        for i in 0..60 {
            let t = f64::from(i);
            let pose = Pose::from_rpy([t, 1.7 * t, 0.3 * t], DVec3::new(t.sin(), 0.4, -t.cos()));
            let back = pose.rotation.transpose();
            for shape in &shapes {
                let (min, max) = shape.aabb(&pose);
                for axis in [DVec3::X, DVec3::Y, DVec3::Z] {
                    let far = |d: DVec3| pose.point(shape.support(back * d)).dot(d);
                    assert!(
                        (far(axis) - max.dot(axis)).abs() < 1e-9 && (far(-axis) + min.dot(axis)).abs() < 1e-9,
                        "{shape:?}"
                    );
                }
            }
        }
    }
}
