//! Exact shapes: what the URDF and the scene say, as pieces that `parry3d-f64` can measure.
//!
//! A piece sits in the frame of its owner (a link, or a scene body). URDF and scene cylinders and
//! capsules lie along z; parry's lie along y: [`cylinder_along_z`] is the one place that knows.

use crate::error::CannotJudge;
use crate::gap::{Gap, gap};
use crate::meshes::{Meshes, Triangles};
use clearway_plan::scene_file::{Body, BoxKeys, CylinderKeys, MeshKeys, Part, PoseKeys, Scale, SphereKeys};
use parry3d_f64::math::{Pose, Rotation, Vector};
use parry3d_f64::shape::{Ball, Capsule, Compound, ConvexPolyhedron, Cuboid, Cylinder, Shape, SharedShape, TriMesh};
use std::f64::consts::FRAC_PI_2;

/// One exact shape, in its owner's frame.
#[derive(Clone)]
pub(crate) struct Piece {
    pub shape: SharedShape,
    pub pose: Pose,
    /// Centre and radius of a ball that holds the shape, in the owner's frame.
    pub center: Vector,
    pub radius: f64,
}

impl Piece {
    pub fn new(pose: Pose, shape: SharedShape) -> Self {
        let ball = shape.compute_local_bounding_sphere();
        Self { center: pose.transform_point(ball.center), radius: ball.radius, pose, shape }
    }

    /// Whether this is a closed mesh around a point of the other, which touches none of its triangles.
    pub fn encloses(&self, owner: &Pose, other: &Piece, other_owner: &Pose) -> bool {
        let Some(mesh) = self.shape.as_trimesh() else { return false };
        let place = *owner * self.pose;
        let point = place.inverse_transform_point(*other_owner * other.pose * a_point_of(&*other.shape));
        let bounds = mesh.local_aabb();
        if !bounds.contains_local_point(point) {
            return false;
        }
        // Three slanted rays: an odd number of crossings along each.
        [Vector::new(0.31, 0.52, 0.79), Vector::new(-0.67, 0.41, -0.62), Vector::new(0.12, -0.93, 0.34)]
            .iter()
            .all(|ray| mesh.triangles().filter(|t| crosses(point, *ray, t.a, t.b, t.c)).count() % 2 == 1)
    }
}

/// Some point on or in the shape, in its frame.
fn a_point_of(shape: &dyn Shape) -> Vector {
    match (shape.as_trimesh(), shape.as_compound()) {
        (Some(mesh), _) => mesh.vertices().first().copied().unwrap_or(Vector::ZERO),
        (_, Some(compound)) => compound.shapes().first().map_or(Vector::ZERO, |(pose, _)| pose.translation),
        _ => shape.compute_local_bounding_sphere().center,
    }
}

/// Möller and Trumbore's test of a ray against a triangle.
fn crosses(from: Vector, ray: Vector, a: Vector, b: Vector, c: Vector) -> bool {
    let (ab, ac) = (b - a, c - a);
    let p = ray.cross(ac);
    let det = ab.dot(p);
    if det == 0.0 {
        return false;
    }
    let to = from - a;
    let u = to.dot(p) / det;
    let q = to.cross(ab);
    let v = ray.dot(q) / det;
    u >= 0.0 && v >= 0.0 && u + v <= 1.0 && ac.dot(q) / det > 0.0
}

/// Signed distance between pieces of two owners at these world poses; the point is in the world.
/// `None`: farther apart than `reach`.
pub(crate) fn piece_gap(a: &Piece, world_from_a: &Pose, b: &Piece, world_from_b: &Pose, reach: f64) -> Option<Gap> {
    let apart = (world_from_a.transform_point(a.center) - world_from_b.transform_point(b.center)).length();
    if apart - a.radius - b.radius > reach {
        return None;
    }
    let (pose_a, pose_b) = (*world_from_a * a.pose, *world_from_b * b.pose);
    let found = gap(&pose_a.inv_mul(&pose_b), &*a.shape, &*b.shape, reach)?;
    Some(Gap { distance: found.distance, point: pose_a.transform_point(found.point) })
}

/// The least signed distance between two bodies. `None`: farther apart than `reach`.
pub(crate) fn body_gap(a: &[Piece], world_from_a: &Pose, b: &[Piece], world_from_b: &Pose, reach: f64) -> Option<Gap> {
    let pairs = a.iter().flat_map(|p| b.iter().map(move |q| (p, q)));
    pairs
        .filter_map(|(p, q)| piece_gap(p, world_from_a, q, world_from_b, reach))
        .min_by(|x, y| x.distance.total_cmp(&y.distance))
}

/// Smallest and largest world coordinates of a body: tight for every shape.
pub(crate) fn extent(pieces: &[Piece], world_from_body: &Pose) -> (Vector, Vector) {
    let empty = (Vector::INFINITY, Vector::NEG_INFINITY);
    pieces.iter().fold(empty, |(low, high), piece| {
        let bounds = piece.shape.compute_aabb(&(*world_from_body * piece.pose));
        (low.min(bounds.mins), high.max(bounds.maxs))
    })
}

/// URDF's fixed-axis roll, pitch, yaw.
pub(crate) fn rotation_from_rpy([roll, pitch, yaw]: [f64; 3]) -> Rotation {
    Rotation::from_rotation_z(yaw) * Rotation::from_rotation_y(pitch) * Rotation::from_rotation_x(roll)
}

/// `None` when the numbers are no pose: not finite, a zero quaternion, or both `rpy` and `quaternion`.
pub(crate) fn pose_from(position: [f64; 3], rpy: Option<[f64; 3]>, quaternion: Option<[f64; 4]>) -> Option<Pose> {
    let rotation = match (rpy, quaternion) {
        (None, None) => Rotation::IDENTITY,
        (Some(rpy), None) => rotation_from_rpy(rpy),
        (None, Some([x, y, z, w])) => {
            let q = Rotation::from_xyzw(x, y, z, w);
            let unit = (q.length() - 1.0).abs() < 1e-3;
            unit.then(|| q.normalize())?
        }
        (Some(_), Some(_)) => return None,
    };
    let pose = Pose::from_parts(Vector::from(position), rotation);
    pose.is_finite().then_some(pose)
}

pub(crate) fn pose_from_keys(keys: &PoseKeys) -> Option<Pose> {
    pose_from(keys.position, keys.rpy, keys.quaternion)
}

/// A cylinder of full `height` along z.
pub(crate) fn cylinder_along_z(radius: f64, height: f64) -> (Pose, SharedShape) {
    let z_from_y = Pose::from_rotation(Rotation::from_rotation_x(FRAC_PI_2));
    (z_from_y, SharedShape::new(Cylinder::new(height / 2.0, radius)))
}

/// A capsule along z whose cylindrical part is `height` long.
pub(crate) fn capsule_along_z(radius: f64, height: f64) -> SharedShape {
    SharedShape::new(Capsule::new(Vector::Z * (-height / 2.0), Vector::Z * (height / 2.0), radius))
}

pub(crate) fn cuboid(size: [f64; 3]) -> SharedShape {
    SharedShape::new(Cuboid::new(Vector::from(size) / 2.0))
}

pub(crate) fn sphere(radius: f64) -> SharedShape {
    SharedShape::new(Ball::new(radius))
}

/// The surface itself; `None` if the triangles are no mesh.
pub(crate) fn surface(triangles: &Triangles) -> Option<SharedShape> {
    TriMesh::new(triangles.vertices.clone(), triangles.faces.clone()).ok().map(SharedShape::new)
}

/// The hull of each connected part; a part too flat for a hull stays a surface.
pub(crate) fn convex_parts(triangles: &Triangles) -> Option<Vec<SharedShape>> {
    let hull_or_surface = |part: Triangles| {
        let hull = parry3d_f64::transformation::try_convex_hull(&part.vertices)
            .ok()
            .and_then(|(points, faces)| ConvexPolyhedron::from_convex_mesh(points, &faces));
        hull.map(SharedShape::new).or_else(|| surface(&part))
    };
    triangles.connected_parts().into_iter().map(hull_or_surface).collect()
}

/// A ball round each point, as one shape.
pub(crate) fn balls(points: &[Vector], radius: f64) -> SharedShape {
    let ball = sphere(radius);
    SharedShape::new(Compound::new(points.iter().map(|p| (Pose::from_translation(*p), ball.clone())).collect()))
}

/// The shape keys that bodies and parts have in common.
struct Keys<'a> {
    r#box: &'a Option<BoxKeys>,
    cylinder: &'a Option<CylinderKeys>,
    sphere: &'a Option<SphereKeys>,
    capsule: &'a Option<CylinderKeys>,
    mesh: &'a Option<MeshKeys>,
}

impl Keys<'_> {
    /// Adds what the keys say at `pose`, and returns how many keys there were.
    fn add(&self, pose: Pose, place: &str, meshes: &mut Meshes, pieces: &mut Vec<Piece>) -> Result<usize, CannotJudge> {
        let before = [
            self.r#box.is_some(),
            self.cylinder.is_some(),
            self.sphere.is_some(),
            self.capsule.is_some(),
            self.mesh.is_some(),
        ];
        if let Some(b) = self.r#box {
            lengths(place, &b.size)?;
            pieces.push(Piece::new(pose, cuboid(b.size)));
        }
        if let Some(c) = self.cylinder {
            lengths(place, &[c.radius, c.height])?;
            let (turn, shape) = cylinder_along_z(c.radius, c.height);
            pieces.push(Piece::new(pose * turn, shape));
        }
        if let Some(s) = self.sphere {
            lengths(place, &[s.radius])?;
            pieces.push(Piece::new(pose, sphere(s.radius)));
        }
        if let Some(c) = self.capsule {
            lengths(place, &[c.radius, c.height])?;
            pieces.push(Piece::new(pose, capsule_along_z(c.radius, c.height)));
        }
        if let Some(m) = self.mesh {
            let scale = match m.scale {
                None => Vector::ONE,
                Some(Scale::Uniform(s)) => Vector::splat(s),
                Some(Scale::PerAxis(s)) => Vector::from(s),
            };
            let triangles = meshes.triangles(&m.file, place)?.scaled(scale);
            let parts = convex_parts(&triangles)
                .ok_or_else(|| wrong(place, format!("mesh {:?} has no usable triangles", m.file)))?;
            pieces.extend(parts.into_iter().map(|shape| Piece::new(pose, shape)));
        }
        Ok(before.into_iter().filter(|given| *given).count())
    }
}

/// The exact pieces of a scene body, in the frame of its shape's centre.
pub(crate) fn body_pieces(body: &Body, place: &str, meshes: &mut Meshes) -> Result<Vec<Piece>, CannotJudge> {
    let mut pieces = Vec::new();
    let keys = Keys {
        r#box: &body.r#box,
        cylinder: &body.cylinder,
        sphere: &body.sphere,
        capsule: &body.capsule,
        mesh: &body.mesh,
    };
    let mut shapes = keys.add(Pose::IDENTITY, place, meshes, &mut pieces)?;
    if let Some(p) = &body.points {
        shapes += 1;
        lengths(place, &[p.radius])?;
        let points = meshes.points(&p.file, place)?;
        pieces.push(Piece::new(Pose::IDENTITY, balls(&points, p.radius)));
    }
    if let Some(parts) = &body.compound {
        shapes += 1;
        for (i, part) in parts.iter().enumerate() {
            part_pieces(part, &format!("{place}, compound part {i}"), meshes, &mut pieces)?;
        }
    }
    if shapes != 1 || pieces.is_empty() {
        return Err(wrong(
            place,
            format!("{shapes} shapes; expected one of box, cylinder, sphere, capsule, mesh, points, compound"),
        ));
    }
    Ok(pieces)
}

fn part_pieces(part: &Part, place: &str, meshes: &mut Meshes, pieces: &mut Vec<Piece>) -> Result<(), CannotJudge> {
    let pose =
        pose_from(part.position, part.rpy, part.quaternion).ok_or_else(|| wrong(place, "no valid pose".to_owned()))?;
    let keys = Keys {
        r#box: &part.r#box,
        cylinder: &part.cylinder,
        sphere: &part.sphere,
        capsule: &part.capsule,
        mesh: &part.mesh,
    };
    match keys.add(pose, place, meshes, pieces)? {
        1 => Ok(()),
        n => Err(wrong(place, format!("{n} shapes; expected one of box, cylinder, sphere, capsule, mesh"))),
    }
}

fn lengths(place: &str, values: &[f64]) -> Result<(), CannotJudge> {
    match values.iter().find(|v| !(v.is_finite() && **v > 0.0)) {
        Some(v) => Err(wrong(place, format!("a length of {v}; expected a positive number of metres"))),
        None => Ok(()),
    }
}

fn wrong(place: &str, what: String) -> CannotJudge {
    CannotJudge::Scene { place: place.to_owned(), what }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn octahedron(radius: f64) -> Piece {
        let vertices =
            [Vector::X, -Vector::X, Vector::Y, -Vector::Y, Vector::Z, -Vector::Z].map(|v| v * radius).to_vec();
        let faces = vec![[0, 2, 4], [2, 1, 4], [1, 3, 4], [3, 0, 4], [2, 0, 5], [1, 2, 5], [3, 1, 5], [0, 3, 5]];
        Piece::new(Pose::IDENTITY, surface(&Triangles { vertices, faces }).expect("a mesh"))
    }

    #[test]
    fn a_mesh_encloses_what_is_inside() {
        let (mesh, ball) = (octahedron(1.0), Piece::new(Pose::IDENTITY, sphere(0.1)));
        for (x, inside) in [(0.0, true), (0.5, true), (0.95, true), (1.05, false), (3.0, false)] {
            let at = Pose::translation(x, 0.0, 0.0);
            assert_eq!(mesh.encloses(&Pose::IDENTITY, &ball, &at), inside, "x {x}");
            assert!(!ball.encloses(&at, &mesh, &Pose::IDENTITY));
        }
    }

    #[test]
    fn extents_are_tight() {
        let (turn, shape) = cylinder_along_z(0.1, 0.6);
        let cylinder = [Piece::new(turn, shape)];
        let near = |found: (Vector, Vector), high: [f64; 3]| {
            let high = Vector::from(high);
            assert!((found.1 - high).length() < 1e-9 && (found.0 + high).length() < 1e-9, "{found:?}");
        };
        near(extent(&cylinder, &Pose::IDENTITY), [0.1, 0.1, 0.3]);
        near(extent(&cylinder, &Pose::from_rotation(Rotation::from_rotation_y(FRAC_PI_2))), [0.3, 0.1, 0.1]);
        let tilt: f64 = 0.4;
        let reach = 0.3 * tilt.cos() + 0.1 * tilt.sin();
        let found = extent(&cylinder, &Pose::from_rotation(Rotation::from_rotation_x(tilt)));
        assert!((found.1.z - reach).abs() < 1e-9);
        near(extent(&[Piece::new(Pose::IDENTITY, capsule_along_z(0.1, 0.4))], &Pose::IDENTITY), [0.1, 0.1, 0.3]);
        near(extent(&[octahedron(0.2)], &Pose::IDENTITY), [0.2, 0.2, 0.2]);
    }

    #[test]
    fn a_mesh_is_taken_as_the_hulls_of_its_parts() {
        let corner = |at: f64| {
            [
                Vector::splat(at),
                Vector::splat(at) + Vector::X,
                Vector::splat(at) + Vector::Y,
                Vector::splat(at) + Vector::Z,
            ]
        };
        let vertices = [corner(0.0), corner(5.0)].concat();
        let faces: Vec<[u32; 3]> = [0, 4]
            .iter()
            .flat_map(|n| [[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]].map(|f| f.map(|i| i + n)))
            .collect();
        let parts = convex_parts(&Triangles { vertices, faces }).expect("parts");
        assert_eq!(parts.len(), 2);
        assert!(parts.iter().all(|p| p.as_convex_polyhedron().is_some()));
        // A part may be flat, or no more than a point; it still is somewhere.
        for third in [Vector::Y, Vector::X * 2.0, Vector::ZERO] {
            let flat = Triangles { vertices: vec![Vector::ZERO, Vector::X, third], faces: vec![[0, 1, 2]] };
            let part = convex_parts(&flat).expect("a part").remove(0);
            let found = gap(&Pose::translation(0.0, 0.0, 0.3), &*part, &*sphere(0.1), 1.0).expect("near");
            assert!((found.distance - 0.2).abs() < 1e-9, "{third}: {found:?}");
        }
    }

    #[test]
    fn poses_that_are_none() {
        assert!(pose_from([0.0; 3], None, None).is_some());
        assert!(pose_from([f64::NAN, 0.0, 0.0], None, None).is_none());
        assert!(pose_from([0.0; 3], None, Some([0.0; 4])).is_none());
        assert!(pose_from([0.0; 3], None, Some([f64::NAN; 4])).is_none());
        assert!(pose_from([0.0; 3], Some([0.0, f64::INFINITY, 0.0]), None).is_none());
        assert!(pose_from([0.0; 3], Some([0.0; 3]), Some([0.0, 0.0, 0.0, 1.0])).is_none());
    }
}
