//! Where the flat ends of cylinders touch boxes and each other. The engine takes a round end for a square, of which one
//! corner is turned to where the other thing is: a corner that wanders rocks what stands there, and over the gap between
//! two others a cylinder has a base of a few millimetres. Here the points are those of the circle.

use parry3d_f64::math::{Pose, Vector};
use parry3d_f64::query::details::{NormalConstraints, ShapeCastOptions};
use parry3d_f64::query::{
    ClosestPoints, Contact, ContactManifold, ContactManifoldsWorkspace, NonlinearRigidMotion,
    PersistentQueryDispatcher, QueryDispatcher, ShapeCastHit, ShapeDistance, ShapeIntersection, TrackedContact,
    Unsupported,
};
use parry3d_f64::shape::{Cuboid, Cylinder, PackedFeatureId, Shape};

/// Ends that are farther from parallel than this (a cosine) touch at a point or along a line.
const PARALLEL: f64 = 0.98;
/// What is deeper than this in the other is not met at its end, metres.
const DEEPEST: f64 = 0.005;

/// Answers for ends of cylinders that lie flat alone: everything else is for whom it is chained to.
pub(crate) struct Caps;

impl<M: Default, C: Default + Copy> PersistentQueryDispatcher<M, C> for Caps {
    fn contact_manifolds(
        &self,
        pos12: &Pose,
        g1: &dyn Shape,
        g2: &dyn Shape,
        prediction: f64,
        manifolds: &mut Vec<ContactManifold<M, C>>,
        _: &mut Option<ContactManifoldsWorkspace>,
    ) -> Result<(), Unsupported> {
        let touch = match (g1.as_cylinder(), g2.as_cylinder()) {
            (Some(a), Some(b)) => touching(pos12, a, b),
            (Some(a), None) => g2.as_cuboid().and_then(|b| standing(pos12, a, b)),
            (None, Some(b)) => {
                g1.as_cuboid().and_then(|a| standing(&pos12.inverse(), b, a)).map(|seen| flipped(pos12, seen))
            }
            (None, None) => None,
        };
        let Some((normal, points)) = touch else { return Err(Unsupported) };
        if manifolds.is_empty() {
            manifolds.push(ContactManifold::with_data(0, 0, M::default()));
        }
        let manifold = &mut manifolds[0];
        let before = manifold.points.clone();
        manifold.clear();
        let inverse = pos12.inverse();
        (manifold.local_n1, manifold.local_n2) = (normal, inverse.rotation * -normal);
        for (i, (on_a, distance)) in points.into_iter().enumerate().filter(|(_, (_, distance))| *distance < prediction)
        {
            let on_b = inverse * (on_a + normal * distance);
            let id = PackedFeatureId::vertex(i as u32);
            manifold.points.push(TrackedContact::new(on_a, on_b, id, id, distance));
        }
        manifold.match_contacts(&before);
        Ok(())
    }

    fn contact_manifold_convex_convex(
        &self,
        _: &Pose,
        _: &dyn Shape,
        _: &dyn Shape,
        _: Option<&dyn NormalConstraints>,
        _: Option<&dyn NormalConstraints>,
        _: f64,
        _: &mut ContactManifold<M, C>,
    ) -> Result<(), Unsupported> {
        Err(Unsupported)
    }
}

/// Seen from *a*: the way out of it, and points on it with how far *b* is from there.
type Touch = (Vector, Vec<(Vector, f64)>);

/// Of two cylinders. `None` where they do not meet with their ends.
fn touching(a_from_b: &Pose, a: &Cylinder, b: &Cylinder) -> Option<Touch> {
    let normal = Vector::Y * a_from_b.translation.y.signum();
    let axis = a_from_b.rotation * Vector::Y;
    let facing = axis * -axis.dot(normal).signum();
    let end = a_from_b.translation + facing * b.half_height;
    let gap = |p: Vector| (end - p).dot(facing) / normal.dot(facing);
    let height = normal.y * a.half_height;
    let outline = overlap(a.radius, [end.x, end.z], b.radius)?;
    let points: Vec<(Vector, f64)> =
        outline.iter().map(|[x, z]| Vector::new(*x, height, *z)).map(|p| (p, gap(p))).collect();
    let met_at_ends = normal.dot(facing) < -PARALLEL && points.iter().all(|(_, gap)| *gap > -DEEPEST);
    met_at_ends.then_some((normal, points))
}

/// The same of a cylinder that stands on a box with all of its rim.
fn standing(a_from_b: &Pose, a: &Cylinder, b: &Cuboid) -> Option<Touch> {
    let b_from_a = a_from_b.inverse();
    let axis = b_from_a.rotation * Vector::Y;
    // Which of the box's faces, and which of the cylinder's ends.
    let along = (0..3).find(|i| axis[*i].abs() > PARALLEL)?;
    let side = b_from_a.translation[along].signum();
    let normal = Vector::Y * -(axis[along] * side).signum();
    let rim = overlap(a.radius, [0.0; 2], a.radius)?.map(|[x, z]| Vector::new(x, normal.y * a.half_height, z));
    let points = rim.map(|p| {
        let on_b = b_from_a * p;
        let inside = (0..3).all(|i| i == along || on_b[i].abs() <= b.half_extents[i]);
        let gap = on_b[along] * side - b.half_extents[along];
        (inside && gap > -DEEPEST).then_some((p, gap))
    });
    Some((normal, points.into_iter().collect::<Option<Vec<_>>>()?))
}

/// Seen from the other.
fn flipped(b_from_a: &Pose, (normal, points): Touch) -> Touch {
    (b_from_a.rotation * -normal, points.into_iter().map(|(p, gap)| (*b_from_a * (p + normal * gap), gap)).collect())
}

/// Points round what two discs have in common, the first about the origin; eight, always in the same order.
fn overlap(first: f64, centre: [f64; 2], second: f64) -> Option<[[f64; 2]; 8]> {
    let apart = centre[0].hypot(centre[1]);
    let on = |middle: [f64; 2], radius: f64, angle: f64| {
        [middle[0] + radius * angle.cos(), middle[1] + radius * angle.sin()]
    };
    if apart >= first + second {
        return None;
    }
    if apart <= (first - second).abs() {
        let (middle, radius) = if first < second { ([0.0; 2], first) } else { (centre, second) };
        return Some(std::array::from_fn(|i| on(middle, radius, std::f64::consts::FRAC_PI_4 * i as f64)));
    }
    // Each circle's arc within the other: from where they cross, by its half.
    let half = |own: f64, other: f64| {
        ((apart * apart + own * own - other * other) / (2.0 * apart * own)).clamp(-1.0, 1.0).acos()
    };
    let (there, half_first, half_second) = (centre[1].atan2(centre[0]), half(first, second), half(second, first));
    Some(std::array::from_fn(|i| match i {
        0..5 => on([0.0; 2], first, there + half_first * (i as f64 / 2.0 - 1.0)),
        _ => on(centre, second, there + std::f64::consts::PI + half_second * ((i - 5) as f64 / 2.0 - 0.5)),
    }))
}

impl QueryDispatcher for Caps {
    fn intersection_test(&self, _: &Pose, _: &dyn Shape, _: &dyn Shape) -> Result<ShapeIntersection, Unsupported> {
        Err(Unsupported)
    }

    fn distance(&self, _: &Pose, _: &dyn Shape, _: &dyn Shape) -> Result<ShapeDistance, Unsupported> {
        Err(Unsupported)
    }

    fn contact(&self, _: &Pose, _: &dyn Shape, _: &dyn Shape, _: f64) -> Result<Option<Contact>, Unsupported> {
        Err(Unsupported)
    }

    fn closest_points(&self, _: &Pose, _: &dyn Shape, _: &dyn Shape, _: f64) -> Result<ClosestPoints, Unsupported> {
        Err(Unsupported)
    }

    fn cast_shapes(
        &self,
        _: &Pose,
        _: Vector,
        _: &dyn Shape,
        _: &dyn Shape,
        _: ShapeCastOptions,
    ) -> Result<Option<ShapeCastHit>, Unsupported> {
        Err(Unsupported)
    }

    fn cast_shapes_nonlinear(
        &self,
        _: &NonlinearRigidMotion,
        _: &dyn Shape,
        _: &NonlinearRigidMotion,
        _: &dyn Shape,
        _: f64,
        _: f64,
        _: bool,
    ) -> Result<Option<ShapeCastHit>, Unsupported> {
        Err(Unsupported)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn points_are_of_both_discs_and_as_far_apart_as_what_they_have_in_common() {
        for (first, centre, second) in [
            (0.04, [0.03, 0.05], 0.035),
            (0.02, [0.001, 0.0], 0.05),
            (0.05, [-0.01, 0.02], 0.02),
            (0.037, [0.0, -0.058], 0.038),
        ] {
            let points = overlap(first, centre, second).expect("they overlap");
            let reach = |along: [f64; 2], points: &mut dyn Iterator<Item = [f64; 2]>| {
                points.map(|p| p[0] * along[0] + p[1] * along[1]).fold(f64::NEG_INFINITY, f64::max)
            };
            for p in points {
                assert!(p[0].hypot(p[1]) < first + 1e-9 && (p[0] - centre[0]).hypot(p[1] - centre[1]) < second + 1e-9);
            }
            // Against all points of a fine grid that are in both.
            let grid = || {
                let steps = -100..=100;
                let all = steps.clone().flat_map(move |i| steps.clone().map(move |j| [f64::from(i), f64::from(j)]));
                all.map(|[i, j]| [i * 0.0006, j * 0.0006])
                    .filter(|p| p[0].hypot(p[1]) <= first && (p[0] - centre[0]).hypot(p[1] - centre[1]) <= second)
            };
            for turn in 0..16 {
                let along = (f64::from(turn) * std::f64::consts::TAU / 16.0).sin_cos();
                let (found, all) =
                    (reach([along.0, along.1], &mut points.into_iter()), reach([along.0, along.1], &mut grid()));
                assert!(found > all - 0.006, "{first} {centre:?} {second}, {turn}: {found} of {all}");
            }
        }
        assert_eq!(overlap(0.03, [0.0, 0.07], 0.04), None);
    }

    #[test]
    fn only_ends_that_face_each_other_are_answered_for() {
        let (a, b) = (Cylinder::new(0.1, 0.04), Cylinder::new(0.05, 0.03));
        let at = |x: f64, y: f64| Pose::from_translation(Vector::new(x, y, 0.0));
        let (normal, points) = touching(&at(0.05, 0.1502), &a, &b).expect("one on the other");
        assert!(
            normal == Vector::Y
                && points.iter().all(|(p, gap)| (p.y - 0.1).abs() < 1e-12 && (gap - 2e-4).abs() < 1e-12)
        );
        let (normal, _) = touching(&at(0.05, -0.15), &a, &b).expect("one under the other");
        assert_eq!(normal, -Vector::Y);
        assert!(touching(&at(0.069, 0.12), &a, &b).is_none(), "side by side");
        let tilted = Pose::from_parts(Vector::new(0.0, 0.15, 0.0), parry3d_f64::math::Rotation::from_rotation_x(0.4));
        assert!(touching(&tilted, &a, &b).is_none(), "on its edge");
    }

    /// However the box is turned, and whichever of the two is asked about first.
    #[test]
    fn on_a_box_all_of_the_rim_counts() {
        let (cylinder, cube) = (Cylinder::new(0.1, 0.04), Cuboid::new(Vector::new(0.3, 0.2, 0.25)));
        for axis in [Vector::X, Vector::Y, Vector::Z] {
            for side in [1.0, -1.0] {
                let half = cube.half_extents.dot(axis);
                let turn = parry3d_f64::math::Rotation::from_rotation_arc(Vector::Y, axis * side);
                let at = |aside: f64| {
                    let off = turn * Vector::new(aside, 0.0, 0.0);
                    Pose::from_parts(axis * side * (half + 0.1 + 3e-4) + off, turn)
                };
                let (normal, points) = standing(&at(0.1).inverse(), &cylinder, &cube).expect("it stands there");
                assert!(normal == -Vector::Y && points.len() == 8);
                assert!(points.iter().all(|(p, gap)| (gap - 3e-4).abs() < 1e-9 && (p.y + 0.1).abs() < 1e-12));
                let (out, seen) = flipped(&at(0.1), (normal, points));
                assert!((out - axis * side).length() < 1e-9);
                assert!(seen.iter().all(|(p, _)| (p.dot(axis) * side - half).abs() < 1e-9), "{seen:?}");
                assert!(standing(&at(0.29).inverse(), &cylinder, &cube).is_none(), "over the edge");
            }
        }
    }
}
