//! How heavy a body is and where its centre of mass is, if it is the same material throughout.
//! Pieces that overlap count twice where they do.

use crate::shapes::Piece;
use parry3d_f64::math::Vector;
use parry3d_f64::shape::Shape;
use std::f64::consts::PI;

/// What has no volume, a flat mesh, weighs as much as this, m³.
const LEAST: f64 = 1e-9;

#[derive(Clone, Copy, Debug)]
pub(super) struct Mass {
    /// The weight, since scenes do not say what things are made of, m³.
    pub volume: f64,
    /// In the body's frame.
    pub centre: Vector,
}

impl Mass {
    pub fn of(pieces: &[Piece]) -> Self {
        let parts = pieces.iter().map(|piece| {
            let part = of_shape(&*piece.shape);
            Mass { volume: part.volume, centre: piece.pose.transform_point(part.centre) }
        });
        let whole = sum(parts);
        if whole.volume > LEAST && whole.volume.is_finite() && whole.centre.is_finite() {
            return whole;
        }
        let centre = pieces.iter().map(|p| p.center).sum::<Vector>() / pieces.len().max(1) as f64;
        Mass { volume: LEAST, centre }
    }
}

fn sum(parts: impl Iterator<Item = Mass>) -> Mass {
    let (volume, moment) = parts
        .fold((0.0, Vector::ZERO), |(volume, moment), part| (volume + part.volume, moment + part.centre * part.volume));
    Mass { volume, centre: if volume > 0.0 { moment / volume } else { Vector::ZERO } }
}

fn of_shape(shape: &dyn Shape) -> Mass {
    let centred = |volume: f64| Mass { volume, centre: Vector::ZERO };
    if let Some(ball) = shape.as_ball() {
        centred(4.0 / 3.0 * PI * ball.radius.powi(3))
    } else if let Some(cuboid) = shape.as_cuboid() {
        centred(8.0 * cuboid.half_extents.element_product())
    } else if let Some(cylinder) = shape.as_cylinder() {
        centred(2.0 * PI * cylinder.radius.powi(2) * cylinder.half_height)
    } else if let Some(capsule) = shape.as_capsule() {
        let round = 4.0 / 3.0 * capsule.radius + (capsule.segment.b - capsule.segment.a).length();
        Mass { volume: PI * capsule.radius.powi(2) * round, centre: (capsule.segment.a + capsule.segment.b) / 2.0 }
    } else if let Some(hull) = shape.as_convex_polyhedron() {
        let (points, faces) = hull.to_trimesh();
        // From a point of the hull, so that rounding stays small far from the origin.
        let from = points.first().copied().unwrap_or(Vector::ZERO);
        let cone = |face: [u32; 3]| {
            let [a, b, c] = face.map(|i| points[i as usize] - from);
            Mass { volume: (a.cross(b).dot(c) / 6.0).abs(), centre: from + (a + b + c) / 4.0 }
        };
        sum(faces.into_iter().map(cone))
    } else if let Some(compound) = shape.as_compound() {
        sum(compound.shapes().iter().map(|(pose, part)| {
            let part = of_shape(&**part);
            Mass { volume: part.volume, centre: pose.transform_point(part.centre) }
        }))
    } else {
        // A surface.
        centred(0.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::meshes::Triangles;
    use crate::shapes::{balls, capsule_along_z, convex_parts, cuboid, cylinder_along_z, sphere, surface};
    use parry3d_f64::math::{Pose, Rotation};
    use parry3d_f64::shape::{ConvexPolyhedron, SharedShape};

    /// Beside parry's, which are as exact.
    fn agree(shape: &SharedShape, pose: Pose) {
        let found = Mass::of(&[Piece::new(pose, shape.clone())]);
        let parry = shape.mass_properties(1e6);
        assert!((found.volume - parry.mass() / 1e6).abs() < 1e-9 * found.volume, "{found:?}");
        assert!((found.centre - pose.transform_point(parry.local_com)).length() < 1e-9, "{found:?}");
    }

    #[test]
    fn as_parry_says() {
        let pose = Pose::from_parts(Vector::new(3.0, -2.0, 1.0), Rotation::from_rotation_x(0.7));
        let points: Vec<Vector> = [[0.0, 0.0, 0.0], [0.1, 0.0, 0.0], [0.0, 0.2, 0.0], [0.0, 0.0, 0.3], [0.1, 0.2, 0.3]]
            .map(|p| Vector::from(p) + Vector::splat(0.2))
            .to_vec();
        let hull = SharedShape::new(ConvexPolyhedron::from_convex_hull(&points).expect("a hull"));
        let (turn, cylinder) = cylinder_along_z(0.03, 0.2);
        for (shape, turn) in [
            (sphere(0.04), Pose::IDENTITY),
            (cuboid([0.1, 0.2, 0.3]), Pose::IDENTITY),
            (cylinder, turn),
            (capsule_along_z(0.02, 0.1), Pose::IDENTITY),
            (hull, Pose::IDENTITY),
            (balls(&points, 0.01), Pose::IDENTITY),
        ] {
            agree(&shape, pose * turn);
        }
    }

    #[test]
    fn pieces_weigh_what_they_fill() {
        let boxed = |x: f64, size: [f64; 3]| Piece::new(Pose::translation(x, 0.0, 0.0), cuboid(size));
        let found = Mass::of(&[boxed(0.0, [0.1; 3]), boxed(0.4, [0.1, 0.1, 0.3])]);
        assert!((found.volume - 4e-3).abs() < 1e-12 && (found.centre - Vector::X * 0.3).length() < 1e-12);
    }

    #[test]
    fn what_is_flat_has_some_weight_too() {
        let corners = [Vector::ZERO, Vector::X, Vector::Y].to_vec();
        let flat = Triangles { vertices: corners, faces: vec![[0, 1, 2]] };
        let parts = convex_parts(&flat).expect("a part");
        for shape in [parts[0].clone(), surface(&flat).expect("a surface")] {
            let found = Mass::of(&[Piece::new(Pose::IDENTITY, shape)]);
            assert!(found.volume > 0.0 && found.centre.is_finite(), "{found:?}");
        }
        assert!(Mass::of(&[]).centre.is_finite());
    }
}
