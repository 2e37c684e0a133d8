//! What a placed solid looks like from above: its smallest enclosing circle (the footprint of the
//! roadmap, Appendix B) and, for what stands still, its outline.

use crate::{Convex, Pose, Solid};
use glam::DVec2;
use std::f64::consts::TAU;

/// A circle in world x and y, metres.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Circle {
    pub centre: DVec2,
    pub radius: f64,
}

impl Circle {
    /// Whether a disc of `radius` that moves from `a` to `b` overlaps this circle.
    #[inline]
    pub fn meets_sweep(&self, a: DVec2, b: DVec2, radius: f64) -> bool {
        point_segment_distance_squared(self.centre, a, b) < (self.radius + radius).powi(2)
    }
}

/// The point of the segment from `a` to `b` that is nearest to `p`.
#[inline]
pub fn nearest_on_segment(p: DVec2, a: DVec2, b: DVec2) -> DVec2 {
    let ab = b - a;
    let length = ab.length_squared();
    let t = if length > 0.0 { ((p - a).dot(ab) / length).clamp(0.0, 1.0) } else { 0.0 };
    a + ab * t
}

/// The squared distance from `p` to the segment from `a` to `b`.
#[inline]
pub fn point_segment_distance_squared(p: DVec2, a: DVec2, b: DVec2) -> f64 {
    nearest_on_segment(p, a, b).distance_squared(p)
}

fn direction(i: usize, count: usize) -> DVec2 {
    DVec2::from_angle(TAU * i as f64 / count as f64)
}

fn support(solid: &Solid, world_from_solid: &Pose, d: DVec2) -> DVec2 {
    let inner = world_from_solid.rotation.transpose() * d.extend(0.0);
    world_from_solid.point(solid.support(inner)).truncate()
}

/// The smallest circle that encloses the solid seen from above. Exact for upright cylinders;
/// otherwise at most 0.1 ‰ of the radius too large.
pub fn enclosing_circle(solid: &Solid, world_from_solid: &Pose) -> Circle {
    const DIRECTIONS: usize = 256;
    if let [(pose, convex)] = solid.parts.as_slice() {
        let placed = *world_from_solid * *pose;
        let centre = placed.translation.truncate();
        match convex {
            Convex::Sphere { radius } => return Circle { centre, radius: *radius },
            Convex::Cylinder { radius, .. } | Convex::Capsule { radius, .. }
                if placed.rotation.z_axis.truncate().length() < 1e-9 =>
            {
                return Circle { centre, radius: *radius };
            }
            _ => {}
        }
    }
    let points: Vec<DVec2> =
        (0..DIRECTIONS).map(|i| support(solid, world_from_solid, direction(i, DIRECTIONS))).collect();
    let mut circle = smallest_circle(&points);
    // Every support line must be inside, not only the points that were found on it.
    circle.radius = (0..DIRECTIONS)
        .map(|i| {
            let d = direction(i, DIRECTIONS);
            points[i].dot(d) - circle.centre.dot(d)
        })
        .fold(circle.radius, f64::max);
    circle
}

/// Welzl's smallest enclosing circle, in its iterative form: O(n³) at worst, O(n) on the whole.
pub fn smallest_circle(points: &[DVec2]) -> Circle {
    let inside = |c: &Circle, p: DVec2| p.distance(c.centre) <= c.radius * (1.0 + 1e-12) + 1e-12;
    let through = |a: DVec2, b: DVec2| Circle { centre: (a + b) / 2.0, radius: a.distance(b) / 2.0 };
    let Some(&first) = points.first() else { return Circle { centre: DVec2::ZERO, radius: 0.0 } };
    let mut circle = Circle { centre: first, radius: 0.0 };
    for (i, &p) in points.iter().enumerate() {
        if inside(&circle, p) {
            continue;
        }
        circle = Circle { centre: p, radius: 0.0 };
        for (j, &q) in points[..i].iter().enumerate() {
            if inside(&circle, q) {
                continue;
            }
            circle = through(p, q);
            for &r in &points[..j] {
                if !inside(&circle, r) {
                    circle = circumcircle(p, q, r).unwrap_or(circle);
                }
            }
        }
    }
    circle
}

fn circumcircle(a: DVec2, b: DVec2, c: DVec2) -> Option<Circle> {
    let (b, c) = (b - a, c - a);
    let d = 2.0 * b.perp_dot(c);
    if d.abs() < 1e-15 {
        return None;
    }
    let centre = DVec2::new(
        c.y * b.length_squared() - b.y * c.length_squared(),
        b.x * c.length_squared() - c.x * b.length_squared(),
    ) / d;
    Some(Circle { centre: a + centre, radius: centre.length() })
}

/// A convex outline seen from above, counter-clockwise.
#[derive(Clone, Debug)]
pub struct Outline {
    pub corners: Vec<DVec2>,
    /// Of each side, the one from a corner to the next: its direction outwards, and how far along that
    /// it is.
    sides: Vec<(DVec2, f64)>,
    /// Round all corners.
    bound: Circle,
}

impl Outline {
    /// The outline of one convex part; round shapes become 64-gons round them.
    pub fn of(solid: &Solid, world_from_solid: &Pose) -> Outline {
        const DIRECTIONS: usize = 64;
        let mut corners: Vec<DVec2> = Vec::new();
        for i in 0..DIRECTIONS {
            // Half a step off the axes, so that a box gives its corners and not points of its sides.
            let d = DVec2::from_angle(TAU * (i as f64 + 0.5) / DIRECTIONS as f64);
            let p = support(solid, world_from_solid, d);
            if corners.last().is_none_or(|last| last.distance(p) > 1e-9) {
                corners.push(p);
            }
        }
        if corners.len() > 1 && corners[0].distance(corners[corners.len() - 1]) <= 1e-9 {
            corners.pop();
        }
        let side = |(&p, &q): (&DVec2, &DVec2)| {
            let outwards = (p - q).perp().normalize_or_zero();
            (outwards, outwards.dot(p))
        };
        let sides = corners.iter().zip(corners.iter().cycle().skip(1)).map(side).collect();
        let bound = smallest_circle(&corners);
        Outline { corners, sides, bound }
    }

    /// Whether the segment from `a` to `b` comes closer to the outline than `distance`.
    #[inline]
    pub fn closer_than(&self, a: DVec2, b: DVec2, distance: f64) -> bool {
        let beyond = |&(outwards, along): &(DVec2, f64)| outwards.dot(a).min(outwards.dot(b)) - along > distance + 1e-9;
        self.bound.meets_sweep(a, b, distance + 1e-9)
            && !self.sides.iter().any(beyond)
            && self.segment_distance(a, b) < distance
    }

    /// The distance from the outline to the segment from `a` to `b`; 0 when they meet.
    pub fn segment_distance(&self, a: DVec2, b: DVec2) -> f64 {
        if self.contains(a) || self.contains(b) {
            return 0.0;
        }
        let mut least = f64::INFINITY;
        for (i, &p) in self.corners.iter().enumerate() {
            let q = self.corners[(i + 1) % self.corners.len()];
            if segments_cross(a, b, p, q) {
                return 0.0;
            }
            least = least
                .min(point_segment_distance_squared(p, a, b))
                .min(point_segment_distance_squared(a, p, q))
                .min(point_segment_distance_squared(b, p, q));
        }
        least.sqrt()
    }

    fn contains(&self, p: DVec2) -> bool {
        self.corners.len() > 2
            && (0..self.corners.len()).all(|i| {
                let (a, b) = (self.corners[i], self.corners[(i + 1) % self.corners.len()]);
                (b - a).perp_dot(p - a) >= 0.0
            })
    }
}

fn segments_cross(a: DVec2, b: DVec2, p: DVec2, q: DVec2) -> bool {
    let side = |o: DVec2, d: DVec2, x: DVec2| (d - o).perp_dot(x - o);
    side(a, b, p) * side(a, b, q) < 0.0 && side(p, q, a) * side(p, q, b) < 0.0
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Vec3;

    #[test]
    fn circles_of_known_solids() {
        let pose = Pose::from_translation(Vec3::new(0.3, -0.2, 1.0));
        let cylinder = enclosing_circle(&Solid::new(Convex::Cylinder { radius: 0.04, half: 0.1 }), &pose);
        assert!((cylinder.radius - 0.04).abs() < 1e-12 && cylinder.centre.distance(DVec2::new(0.3, -0.2)) < 1e-12);
        // Within another one it takes the long way round.
        let parts = vec![Convex::Cylinder { radius: 0.04, half: 0.1 }, Convex::Sphere { radius: 0.01 }];
        let nested =
            enclosing_circle(&Solid { parts: parts.into_iter().map(|c| (Pose::IDENTITY, c)).collect() }, &pose);
        assert!((nested.radius - 0.04).abs() < 1e-5 && nested.centre.distance(cylinder.centre) < 1e-5);
        let turned = pose * Pose::from_rpy([0.0, 0.0, 0.4], Vec3::ZERO);
        let half = Vec3::new(0.03, 0.04, 0.2);
        let cuboid = enclosing_circle(&Solid::new(Convex::Box { half }), &turned);
        assert!((cuboid.radius - 0.05).abs() < 1e-5, "{cuboid:?}");
        assert!(cuboid.radius >= 0.05 - 1e-9);
    }

    #[test]
    fn smallest_circle_by_brute_force() {
        for seed in 0..40u64 {
            let points: Vec<DVec2> = (0..9)
                .map(|i| {
                    let t = (seed * 9 + i) as f64;
                    DVec2::new((t * 1.7).sin(), (t * 2.9).cos())
                })
                .collect();
            let found = smallest_circle(&points);
            assert!(points.iter().all(|p| p.distance(found.centre) <= found.radius + 1e-9));
            let mut best = f64::INFINITY;
            let holds = |c: &Circle| points.iter().all(|p| p.distance(c.centre) <= c.radius + 1e-9);
            for (i, &a) in points.iter().enumerate() {
                for (j, &b) in points.iter().enumerate().skip(i + 1) {
                    let two = Circle { centre: (a + b) / 2.0, radius: a.distance(b) / 2.0 };
                    if holds(&two) {
                        best = best.min(two.radius);
                    }
                    for &c in &points[j + 1..] {
                        if let Some(three) = circumcircle(a, b, c).filter(|c| holds(c)) {
                            best = best.min(three.radius);
                        }
                    }
                }
            }
            assert!((found.radius - best).abs() < 1e-9);
        }
    }

    #[test]
    fn outline_of_a_box() {
        let solid = Solid::new(Convex::Box { half: Vec3::new(0.5, 0.1, 0.2) });
        let outline = Outline::of(&solid, &Pose::IDENTITY);
        assert_eq!(outline.corners.len(), 4);
        let at = |x: f64, y: f64| DVec2::new(x, y);
        assert!((outline.segment_distance(at(-1.0, 0.4), at(1.0, 0.4)) - 0.3).abs() < 1e-12);
        assert_eq!(outline.segment_distance(at(-1.0, -1.0), at(1.0, 1.0)), 0.0);
        assert_eq!(outline.segment_distance(at(0.1, 0.0), at(0.2, 0.0)), 0.0);
        assert!((outline.segment_distance(at(0.8, 0.5), at(0.8, 0.5)) - (0.09f64 + 0.16).sqrt()).abs() < 1e-12);
    }
}
