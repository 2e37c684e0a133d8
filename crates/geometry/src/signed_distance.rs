//! How far a point is from a convex shape.

use crate::Convex;
use glam::{DVec2, DVec3};

impl Convex {
    /// The distance from `point` (in the shape's frame) to the shape, metres; negative inside.
    /// Exact outside spheres, capsules, cylinders and boxes; never above the true distance for a
    /// hull, where it is the greatest distance from a face's plane.
    #[inline]
    pub fn point_distance(&self, point: DVec3) -> f64 {
        match self {
            Convex::Sphere { radius } => point.length() - radius,
            Convex::Capsule { radius, half } => {
                DVec3::new(point.x, point.y, point.z - point.z.clamp(-half, *half)).length() - radius
            }
            Convex::Cylinder { radius, half } => {
                let d = DVec2::new(point.truncate().length() - radius, point.z.abs() - half);
                d.max(DVec2::ZERO).length() + d.max_element().min(0.0)
            }
            Convex::Box { half } => {
                let d = point.abs() - *half;
                d.max(DVec3::ZERO).length() + d.max_element().min(0.0)
            }
            Convex::Hull(hull) => hull.planes.iter().map(|(n, d)| n.dot(point) - d).fold(f64::NEG_INFINITY, f64::max),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Pose, distance::distance};

    #[test]
    fn agrees_with_gjk_outside() {
        let shapes = [
            Convex::Sphere { radius: 0.1 },
            Convex::Capsule { radius: 0.05, half: 0.2 },
            Convex::Cylinder { radius: 0.07, half: 0.12 },
            Convex::Box { half: DVec3::new(0.1, 0.2, 0.05) },
        ];
        let dot = Convex::Sphere { radius: 0.0 };
        for shape in shapes {
            for i in 0..500 {
                let t = i as f64;
                let p = DVec3::new((t * 0.37).sin(), (t * 0.73).cos(), (t * 1.31).sin()) * (0.02 + 0.001 * t);
                let gjk = distance(&shape, &Pose::IDENTITY, &dot, &Pose::from_translation(p));
                let ours = shape.point_distance(p);
                assert!((ours.max(0.0) - gjk).abs() < 1e-7, "{shape:?} at {p}: {ours} {gjk}");
            }
        }
    }
}
