//! Distance between convex shapes by GJK (Gilbert, Johnson, Keerthi 1988), in `f64`.
//!
//! The search stops as soon as the question asked is settled: [`closer_than`] needs two or three
//! support points for most pairs. Penetration depth is not computed.

use crate::{Convex, Pose};
use glam::DVec3;

/// More steps than any pair of real shapes takes; past it the lower bound at hand is returned.
const MAX_STEPS: usize = 64;

/// The distance between two placed convex shapes, metres; 0 when they touch or overlap.
pub fn distance(a: &Convex, world_from_a: &Pose, b: &Convex, world_from_b: &Pose) -> f64 {
    nearest(a, world_from_a, b, world_from_b).map_or(0.0, |gjk| gjk.lower)
}

/// From *b*'s nearest point to *a*'s, in the world; nothing when they touch or overlap.
pub fn between(a: &Convex, world_from_a: &Pose, b: &Convex, world_from_b: &Pose) -> Option<DVec3> {
    nearest(a, world_from_a, b, world_from_b).map(|gjk| world_from_a.rotation * gjk.nearest)
}

/// The search at its end; nothing when the shapes touch or overlap.
fn nearest<'a>(a: &'a Convex, world_from_a: &Pose, b: &'a Convex, world_from_b: &Pose) -> Option<Gjk<'a>> {
    let a_from_b = world_from_a.inverse() * *world_from_b;
    let between = -a_from_b.translation;
    let guess = if between.length_squared() < 1e-24 { DVec3::X } else { between };
    let mut gjk = Gjk::starting(a, b, a_from_b, guess);
    for _ in 0..MAX_STEPS {
        match gjk.step() {
            Progress::Overlap => return None,
            Progress::Settled => break,
            Progress::Between => {}
        }
    }
    Some(gjk)
}

/// Whether two placed convex shapes are closer than `margin ≥ 0` (metres). When rounding leaves it
/// open, the answer is yes.
#[inline]
pub fn closer_than(a: &Convex, world_from_a: &Pose, b: &Convex, world_from_b: &Pose, margin: f64) -> bool {
    closer_than_along(a, world_from_a, b, world_from_b, margin, &mut { DVec3::ZERO })
}

/// The same, starting from a guess of the direction from *b* to *a*, in the frame of *a*; zero is
/// no guess. The direction found is left there: asked again about a pair that has moved a little,
/// one support point mostly settles that it is apart.
#[inline]
pub fn closer_than_along(
    a: &Convex,
    world_from_a: &Pose,
    b: &Convex,
    world_from_b: &Pose,
    margin: f64,
    direction: &mut DVec3,
) -> bool {
    let a_from_b = world_from_a.inverse() * *world_from_b;
    let mut guess = if *direction == DVec3::ZERO { -a_from_b.translation } else { *direction };
    if guess.length_squared() < 1e-24 {
        guess = DVec3::X;
    }
    let mut gjk = Gjk::starting(a, b, a_from_b, guess);
    if gjk.lower >= margin && gjk.lower > 0.0 {
        *direction = guess;
        return false;
    }
    let near = gjk.closer_than(margin);
    if gjk.nearest != DVec3::ZERO {
        *direction = gjk.nearest;
    }
    near
}

enum Progress {
    Overlap,
    Settled,
    Between,
}

/// GJK on the Minkowski difference *a − b*, in the frame of *a*.
struct Gjk<'a> {
    a: &'a Convex,
    b: &'a Convex,
    a_from_b: Pose,
    simplex: [DVec3; 4],
    size: usize,
    /// The point of the simplex nearest to the origin; its length is an upper bound.
    nearest: DVec3,
    /// A lower bound of the distance.
    lower: f64,
}

impl<'a> Gjk<'a> {
    /// With the support point along a guess of the direction from *b* to *a*, not zero.
    #[inline]
    fn starting(a: &'a Convex, b: &'a Convex, a_from_b: Pose, guess: DVec3) -> Self {
        let mut gjk = Gjk { a, b, a_from_b, simplex: [DVec3::ZERO; 4], size: 1, nearest: guess, lower: 0.0 };
        let point = gjk.support(-guess);
        gjk.simplex[0] = point;
        gjk.nearest = point;
        // Nothing of the difference lies before the plane through that point.
        gjk.lower = (point.dot(guess) / guess.length()).max(0.0);
        gjk
    }

    fn closer_than(&mut self, margin: f64) -> bool {
        for _ in 0..MAX_STEPS {
            match self.step() {
                Progress::Overlap => return true,
                Progress::Settled => break,
                Progress::Between if self.lower >= margin && self.lower > 0.0 => return false,
                Progress::Between if self.nearest.length() < margin => return true,
                Progress::Between => {}
            }
        }
        self.lower < margin
    }

    #[inline]
    fn support(&self, direction: DVec3) -> DVec3 {
        let there = self.a_from_b.rotation.transpose() * -direction;
        self.a.support(direction) - self.a_from_b.point(self.b.support(there))
    }

    #[inline]
    fn step(&mut self) -> Progress {
        let length = self.nearest.length();
        if length < 1e-10 {
            return Progress::Overlap;
        }
        let point = self.support(-self.nearest);
        let along = point.dot(self.nearest) / length;
        self.lower = self.lower.max(along);
        // The duality gap: no point of the difference is nearer than `along`.
        if length - along <= 1e-9 + 1e-9 * length || self.simplex[..self.size].contains(&point) {
            self.lower = self.lower.max(along.min(length));
            return Progress::Settled;
        }
        self.simplex[self.size] = point;
        self.size += 1;
        let before = length;
        if !self.reduce() {
            return Progress::Overlap;
        }
        if self.nearest.length() >= before {
            // Rounding has stopped the descent; what was found before is as good as it gets.
            return Progress::Settled;
        }
        Progress::Between
    }

    /// Reduces the simplex to the face nearest to the origin; false when it holds the origin.
    fn reduce(&mut self) -> bool {
        let s = self.simplex;
        let (kept, nearest) = match self.size {
            2 => nearest_on_segment(s[0], s[1]),
            3 => nearest_on_triangle(s[0], s[1], s[2]),
            4 => match nearest_on_tetrahedron(s) {
                Some(found) => found,
                None => return false,
            },
            _ => (Kept::points(&[s[0]]), s[0]),
        };
        self.simplex[..kept.size].copy_from_slice(&kept.points[..kept.size]);
        self.size = kept.size;
        self.nearest = nearest;
        true
    }
}

#[derive(Clone, Copy)]
struct Kept {
    points: [DVec3; 3],
    size: usize,
}

impl Kept {
    fn points(from: &[DVec3]) -> Self {
        let mut points = [DVec3::ZERO; 3];
        points[..from.len()].copy_from_slice(from);
        Self { points, size: from.len() }
    }
}

fn nearest_on_segment(a: DVec3, b: DVec3) -> (Kept, DVec3) {
    let ab = b - a;
    let t = -a.dot(ab);
    let length = ab.length_squared();
    if t <= 0.0 {
        (Kept::points(&[a]), a)
    } else if t >= length {
        (Kept::points(&[b]), b)
    } else {
        (Kept::points(&[a, b]), a + ab * (t / length))
    }
}

/// Ericson, Real-Time Collision Detection, 5.1.5, with the query point at the origin.
fn nearest_on_triangle(a: DVec3, b: DVec3, c: DVec3) -> (Kept, DVec3) {
    let (ab, ac) = (b - a, c - a);
    let (d1, d2) = (-ab.dot(a), -ac.dot(a));
    if d1 <= 0.0 && d2 <= 0.0 {
        return (Kept::points(&[a]), a);
    }
    let (d3, d4) = (-ab.dot(b), -ac.dot(b));
    if d3 >= 0.0 && d4 <= d3 {
        return (Kept::points(&[b]), b);
    }
    let vc = d1 * d4 - d3 * d2;
    if vc <= 0.0 && d1 >= 0.0 && d3 <= 0.0 {
        return (Kept::points(&[a, b]), a + ab * (d1 / (d1 - d3)));
    }
    let (d5, d6) = (-ab.dot(c), -ac.dot(c));
    if d6 >= 0.0 && d5 <= d6 {
        return (Kept::points(&[c]), c);
    }
    let vb = d5 * d2 - d1 * d6;
    if vb <= 0.0 && d2 >= 0.0 && d6 <= 0.0 {
        return (Kept::points(&[a, c]), a + ac * (d2 / (d2 - d6)));
    }
    let va = d3 * d6 - d5 * d4;
    if va <= 0.0 && d4 - d3 >= 0.0 && d5 - d6 >= 0.0 {
        let w = (d4 - d3) / ((d4 - d3) + (d5 - d6));
        return (Kept::points(&[b, c]), b + (c - b) * w);
    }
    let scale = va + vb + vc;
    if scale <= 0.0 {
        // Three points on a line: one of the sides is nearest.
        return [nearest_on_segment(a, b), nearest_on_segment(b, c), nearest_on_segment(a, c)]
            .into_iter()
            .min_by(|x, y| x.1.length_squared().total_cmp(&y.1.length_squared()))
            .unwrap_or((Kept::points(&[a]), a));
    }
    (Kept::points(&[a, b, c]), a + ab * (vb / scale) + ac * (vc / scale))
}

fn nearest_on_tetrahedron(s: [DVec3; 4]) -> Option<(Kept, DVec3)> {
    let volume = (s[1] - s[0]).cross(s[2] - s[0]).dot(s[3] - s[0]);
    let size = (s[1] - s[0]).length() * (s[2] - s[0]).length() * (s[3] - s[0]).length();
    let flat = volume.abs() <= 1e-14 * size;
    let mut best: Option<(Kept, DVec3)> = None;
    for [i, j, k, opposite] in [[0, 1, 2, 3], [0, 1, 3, 2], [0, 2, 3, 1], [1, 2, 3, 0]] {
        let normal = (s[j] - s[i]).cross(s[k] - s[i]);
        let outside = normal.dot(-s[i]) * normal.dot(s[opposite] - s[i]) < 0.0;
        if outside || flat {
            let found = nearest_on_triangle(s[i], s[j], s[k]);
            if best.is_none_or(|b| found.1.length_squared() < b.1.length_squared()) {
                best = Some(found);
            }
        }
    }
    best
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Vec3;

    /// A small linear congruential generator, so that the test needs no crate.
    struct Draw(u64);
    impl Draw {
        fn next(&mut self, low: f64, high: f64) -> f64 {
            self.0 = self.0.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
            low + (high - low) * ((self.0 >> 11) as f64 / (1u64 << 53) as f64)
        }
        fn pose(&mut self) -> Pose {
            let rpy = [self.next(-3.0, 3.0), self.next(-1.5, 1.5), self.next(-3.0, 3.0)];
            Pose::from_rpy(rpy, Vec3::new(self.next(-0.25, 0.25), self.next(-0.25, 0.25), self.next(-0.25, 0.25)))
        }
        fn shape(&mut self) -> Convex {
            let (r, h) = (self.next(0.02, 0.2), self.next(0.02, 0.3));
            match (self.next(0.0, 4.0)) as usize {
                0 => Convex::Sphere { radius: r },
                1 => Convex::Capsule { radius: r, half: h },
                2 => Convex::Cylinder { radius: r, half: h },
                _ => Convex::Box { half: Vec3::new(r, h, self.next(0.02, 0.2)) },
            }
        }
    }

    #[test]
    fn agrees_with_parry() {
        use parry3d_f64::{
            math::{Pose as Iso, Rotation, Vector},
            query, shape,
        };
        let mut draw = Draw(7);
        let (mut apart, mut overlapping) = (0, 0);
        for _ in 0..4000 {
            let (a, b, pa, pb) = (draw.shape(), draw.shape(), draw.pose(), draw.pose());
            let theirs = |c: &Convex, pose: &Pose| -> (Box<dyn shape::Shape>, Iso) {
                // parry's axis is y.
                let y_up = Pose::from_rpy([std::f64::consts::FRAC_PI_2, 0.0, 0.0], Vec3::ZERO);
                let (s, pose): (Box<dyn shape::Shape>, Pose) = match c {
                    Convex::Sphere { radius } => (Box::new(shape::Ball::new(*radius)), *pose),
                    Convex::Capsule { radius, half } => (Box::new(shape::Capsule::new_y(*half, *radius)), *pose * y_up),
                    Convex::Cylinder { radius, half } => (Box::new(shape::Cylinder::new(*half, *radius)), *pose * y_up),
                    Convex::Box { half } => (Box::new(shape::Cuboid::new(Vector::new(half.x, half.y, half.z))), *pose),
                    Convex::Hull(_) => unreachable!(),
                };
                let q = pose.quaternion();
                let t = pose.translation;
                (s, Iso::from_parts(Vector::new(t.x, t.y, t.z), Rotation::from_xyzw(q[0], q[1], q[2], q[3])))
            };
            let ((sa, ia), (sb, ib)) = (theirs(&a, &pa), theirs(&b, &pb));
            let expected = query::distance(&ia, &*sa, &ib, &*sb).unwrap().distance;
            let found = distance(&a, &pa, &b, &pb);
            // Theirs may be up to 20 µm too large, ours never above the true distance.
            assert!(found <= expected + 1e-7 && found >= expected - 5e-5, "{a:?} {b:?}: {found} against {expected}");
            for margin in [0.001, 0.05, 0.3] {
                if (found - margin).abs() > 1e-6 {
                    assert_eq!(closer_than(&a, &pa, &b, &pb, margin), found < margin, "{a:?} {b:?} {found} {margin}");
                }
            }
            if found > 0.0 { apart += 1 } else { overlapping += 1 }
        }
        assert!(apart > 500 && overlapping > 500);
    }

    #[test]
    fn closed_forms() {
        let cylinder = Convex::Cylinder { radius: 0.04, half: 0.13 };
        let at = |x: f64, y: f64, z: f64| Pose::from_translation(Vec3::new(x, y, z));
        assert!((distance(&cylinder, &at(0.0, 0.0, 0.0), &cylinder, &at(0.3, 0.4, 0.05)) - 0.42).abs() < 1e-8);
        assert!((distance(&cylinder, &at(0.0, 0.0, 0.0), &cylinder, &at(0.01, 0.0, 0.3)) - 0.04).abs() < 1e-8);
        let wall = Convex::Box { half: Vec3::new(0.01, 0.5, 0.5) };
        assert!((distance(&cylinder, &at(0.0, 0.0, 0.0), &wall, &at(0.0501, 0.0, 0.0)) - 0.0001).abs() < 1e-8);
        let turned = Pose::from_rpy([0.0, 0.0, 1.0], Vec3::ZERO);
        let way = between(&cylinder, &turned, &wall, &at(0.07, 0.0, 0.0)).unwrap();
        assert!((way - Vec3::new(-0.02, 0.0, 0.0)).length() < 1e-6, "{way}");
        assert_eq!(between(&cylinder, &turned, &wall, &at(0.0499, 0.0, 0.0)), None);
        assert_eq!(distance(&cylinder, &at(0.0, 0.0, 0.0), &wall, &at(0.0499, 0.0, 0.0)), 0.0);
    }
}
