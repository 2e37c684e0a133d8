//! Where one body bears on another, seen from above.
//!
//! Of two convex shapes that touch, it is what their faces towards each other have in common; a face
//! may be an edge or a point. Most faces look straight down and up. Where those do not meet, as of a
//! ball on an edge, the upper shape is moved until it just touches, and the faces are those along
//! the normal there. Heights may be off by 1 mm and faces may lean by 0.01 rad, as in valid plans.

use super::polygon::{Point, hull, intersection};
use crate::case::Thing;
use crate::gap::gap;
use crate::rest::SHIFT;
use crate::shapes::Piece;
use parry3d_f64::bounding_volume::{Aabb, BoundingVolume};
use parry3d_f64::math::{Pose, Vector};
use parry3d_f64::query;
use parry3d_f64::shape::{Cylinder, Shape};
use std::f64::consts::TAU;

/// What leans less is level: what is put down may, and rounding, radians.
const LEVEL: f64 = 0.0101;
/// Faces whose corners differ less in height are flat, metres.
const FLAT: f64 = 5e-5;
/// A disc's polygon is within it by less than this, metres.
pub(super) const ROUND: f64 = 1e-4;
/// As `rest` has it: overlapping by less is not overlapping.
const APART: f64 = 1e-6;
/// How well the height at which shapes just touch is found, and how far above the normal is taken.
const CLOSE: f64 = 2e-6;
const ABOVE: f64 = 2e-5;

/// A convex shape in the world.
struct Solid<'a> {
    shape: &'a dyn Shape,
    pose: Pose,
}

/// The hull of all places where a body bears on another that carries it. Empty: none was found.
pub(super) fn patch(upper: &Thing, at: &Pose, lower: &Thing, lower_at: &Pose) -> Vec<Point> {
    let mut points = Vec::new();
    for above in &upper.pieces {
        let near = above.shape.compute_aabb(&(*at * above.pose)).loosened(2.0 * SHIFT);
        for below in &lower.pieces {
            for_solids(below, lower_at, &near, &mut |below| {
                let near = below.bounds().loosened(2.0 * SHIFT);
                for_solids(above, at, &near, &mut |above| points.extend(touching(&above, &below)));
            });
        }
    }
    hull(points)
}

/// The convex shapes of a piece that are near.
fn for_solids<'a>(piece: &'a Piece, owner: &Pose, near: &Aabb, each: &mut dyn FnMut(Solid<'a>)) {
    let pose = *owner * piece.pose;
    if let Some(compound) = piece.shape.as_compound() {
        for part in compound.bvh().intersect_aabb(&near.transform_by(&pose.inverse())) {
            if let Some((turn, shape)) = compound.shapes().get(part as usize) {
                each(Solid { shape: &**shape, pose: pose * *turn });
            }
        }
    } else {
        let solid = Solid { shape: &*piece.shape, pose };
        if solid.bounds().intersects(near) {
            each(solid);
        }
    }
}

/// Where two shapes bear on each other; nothing if they do not.
fn touching(upper: &Solid, lower: &Solid) -> Vec<Point> {
    let (down, up) = (upper.face(-Vector::Z), lower.face(Vector::Z));
    let heights = |face: &[Vector]| {
        face.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), p| (low.min(p.z), high.max(p.z)))
    };
    let (bottom, top) = (heights(&down), heights(&up));
    let lean = bottom.1 - bottom.0 + top.1 - top.0;
    if (bottom.0 - top.1).abs() <= SHIFT + lean && (lean <= FLAT || upper.overlap(-SHIFT, lower).is_some()) {
        let common = intersection(&seen(&down), &seen(&up));
        if !common.is_empty() {
            return common;
        }
    }
    slanted(upper, lower)
}

/// The same where the faces that touch do not look straight down and up.
fn slanted(upper: &Solid, lower: &Solid) -> Vec<Point> {
    let Some(mut point) = upper.overlap(-SHIFT, lower) else { return Vec::new() };
    let (mut low, mut high) = (-SHIFT, SHIFT);
    while high - low > CLOSE {
        let middle = (low + high) / 2.0;
        match upper.overlap(middle, lower) {
            Some(found) => (low, point) = (middle, found),
            None => high = middle,
        }
    }
    let raised = upper.moved(high + ABOVE);
    let contact = query::contact(&raised.pose, raised.shape, &lower.pose, lower.shape, SHIFT);
    let common = contact
        .ok()
        .flatten()
        .and_then(|c| c.normal1.try_normalize())
        .map(|normal| intersection(&seen(&raised.face(normal)), &seen(&lower.face(-normal))));
    common.filter(|c| !c.is_empty()).unwrap_or_else(|| vec![point.truncate()])
}

fn seen(face: &[Vector]) -> Vec<Point> {
    hull(face.iter().map(|p| p.truncate()).collect())
}

impl Solid<'_> {
    fn bounds(&self) -> Aabb {
        self.shape.compute_aabb(&self.pose)
    }

    fn moved(&self, up: f64) -> Self {
        Self { shape: self.shape, pose: Pose::from_parts(self.pose.translation + Vector::Z * up, self.pose.rotation) }
    }

    /// Where it is deepest in the other, if it is, when moved up by so much.
    fn overlap(&self, up: f64, other: &Solid) -> Option<Vector> {
        let moved = self.moved(up);
        let found = gap(&moved.pose.inv_mul(&other.pose), self.shape, other.shape, 0.0)?;
        (found.distance < -APART).then(|| moved.pose.transform_point(found.point))
    }

    /// The corners of the face that looks along `n`; of an edge, or a point, if no face does.
    fn face(&self, n: Vector) -> Vec<Vector> {
        let (centre, axis) = (self.pose.translation, self.pose.rotation * Vector::Y);
        if let Some(ball) = self.shape.as_ball() {
            vec![centre + n * ball.radius]
        } else if let Some(cuboid) = self.shape.as_cuboid() {
            let half = cuboid.half_extents;
            let axes = [Vector::X * half.x, Vector::Y * half.y, Vector::Z * half.z].map(|a| self.pose.rotation * a);
            axes.into_iter().fold(vec![centre], |corners, a| spread(&corners, a, n))
        } else if let Some(cylinder) = self.shape.as_cylinder() {
            cylinder_face(centre, axis, cylinder, n)
        } else if let Some(capsule) = self.shape.as_capsule() {
            let (a, b) = (capsule.segment.a, capsule.segment.b);
            let middle = self.pose.transform_point((a + b) / 2.0);
            spread(&[middle + n * capsule.radius], self.pose.rotation * ((b - a) / 2.0), n)
        } else if let Some(hull) = self.shape.as_convex_polyhedron() {
            foremost(hull.points().iter().map(|p| self.pose.transform_point(*p)).collect(), n)
        } else if let Some(mesh) = self.shape.as_trimesh() {
            foremost(mesh.vertices().iter().map(|p| self.pose.transform_point(*p)).collect(), n)
        } else {
            Vec::new()
        }
    }
}

/// Both ends of a bar about each point if it is level to `n`; else the end that is foremost.
fn spread(points: &[Vector], half: Vector, n: Vector) -> Vec<Vector> {
    let ahead = half.dot(n);
    let ends: &[f64] = if ahead.abs() <= LEVEL * half.length() { &[-1.0, 1.0] } else { &[ahead.signum()] };
    points.iter().flat_map(|p| ends.iter().map(move |end| *p + half * *end)).collect()
}

fn cylinder_face(centre: Vector, axis: Vector, cylinder: &Cylinder, n: Vector) -> Vec<Vector> {
    let (radius, half) = (cylinder.radius, axis * cylinder.half_height);
    let across = n - axis * n.dot(axis);
    if across.length() > LEVEL {
        // Lying, or on its rim.
        return spread(&[centre + across.normalize() * radius], half, n);
    }
    let cap = centre + half * half.dot(n).signum();
    let (u, v) = axis.any_orthonormal_pair();
    let turn = f64::acos((1.0 - ROUND / radius).clamp(-1.0, 1.0));
    let corners = (TAU / 2.0 / turn).ceil().clamp(32.0, 256.0) as u32;
    let angle = |i: u32| TAU * f64::from(i) / f64::from(corners);
    (0..corners).map(|i| cap + (u * angle(i).cos() + v * angle(i).sin()) * radius).collect()
}

/// The foremost point, and those that are level with it.
fn foremost(mut points: Vec<Vector>, n: Vector) -> Vec<Vector> {
    let Some(&first) = points.iter().max_by(|a, b| a.dot(n).total_cmp(&b.dot(n))) else { return points };
    points.retain(|p| {
        let (back, away) = ((first - *p).dot(n), (first - *p).length());
        back <= LEVEL * away + APART
    });
    points
}

#[cfg(test)]
mod tests;
