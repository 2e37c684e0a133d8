//! Convex polygons, seen from above: counter-clockwise corners. A point and a line are polygons of
//! one and two corners; no corners are nothing.

use parry3d_f64::math::Vector2;

pub(super) type Point = Vector2;

/// Polygons that are so close have a point in common, metres.
const CLOSE: f64 = 1e-5;
/// Shorter sides have no direction.
const NO_SIDE: f64 = 1e-9;

/// The convex hull.
pub(super) fn hull(mut points: Vec<Point>) -> Vec<Point> {
    points.retain(|p| p.is_finite());
    points.sort_by(|a, b| a.x.total_cmp(&b.x).then(a.y.total_cmp(&b.y)));
    points.dedup();
    if points.len() < 3 {
        return points;
    }
    let mut corners: Vec<Point> = Vec::with_capacity(points.len() + 1);
    chain(&mut corners, points.iter());
    corners.pop();
    chain(&mut corners, points.iter().rev());
    corners.pop();
    corners
}

/// Adds the points that turn left all along.
fn chain<'a>(corners: &mut Vec<Point>, points: impl Iterator<Item = &'a Point>) {
    let first = corners.len();
    for &p in points {
        while let [.., a, b] = corners[first..]
            && (b - a).perp_dot(p - b) <= 0.0
        {
            corners.pop();
        }
        corners.push(p);
    }
}

/// What two polygons have in common.
pub(super) fn intersection(a: &[Point], b: &[Point]) -> Vec<Point> {
    let (mut cut, by) = match (a.len(), b.len()) {
        (0, _) | (_, 0) => return Vec::new(),
        (_, 3..) => (a.to_vec(), b.to_vec()),
        (3.., _) => (b.to_vec(), a.to_vec()),
        _ => (a.to_vec(), widened(b, CLOSE)),
    };
    for (from, to) in sides(&by) {
        let along = to - from;
        if along.length() < NO_SIDE {
            continue;
        }
        let inward = along.perp() / along.length();
        let inside = |p: Point| (p - from).dot(inward) + CLOSE;
        let mut kept = Vec::with_capacity(cut.len() + 1);
        for (p, q) in sides(&cut) {
            let (at_p, at_q) = (inside(p), inside(q));
            if at_p >= 0.0 {
                kept.push(p);
            }
            if (at_p < 0.0) != (at_q < 0.0) {
                kept.push(p + (q - p) * (at_p / (at_p - at_q)));
            }
        }
        cut = kept;
    }
    hull(cut)
}

/// Every point of the polygon may be off by this along x and along y.
pub(super) fn widened(polygon: &[Point], by: f64) -> Vec<Point> {
    let corners = [(-by, -by), (by, -by), (by, by), (-by, by)];
    hull(polygon.iter().flat_map(|p| corners.map(|(x, y)| *p + Point::new(x, y))).collect())
}

/// How far a point is outside; 0 inside.
pub(super) fn outside(polygon: &[Point], p: Point) -> f64 {
    let left_of = |(from, to): (Point, Point)| (to - from).perp_dot(p - from) >= 0.0;
    if polygon.len() > 2 && sides(polygon).all(left_of) {
        return 0.0;
    }
    let to_side = |(from, to): (Point, Point)| {
        let along = to - from;
        let share = ((p - from).dot(along) / along.length_squared()).clamp(0.0, 1.0);
        // A side without length is its end.
        if share.is_finite() { (p - from - along * share).length() } else { (p - from).length() }
    };
    sides(polygon).map(to_side).fold(f64::INFINITY, f64::min)
}

fn sides(polygon: &[Point]) -> impl Iterator<Item = (Point, Point)> {
    polygon.iter().copied().zip(polygon.iter().copied().cycle().skip(1))
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand::{RngExt, SeedableRng};
    use rand_xoshiro::Xoshiro256PlusPlus;
    use std::f64::consts::TAU;

    fn points(list: &[(f64, f64)]) -> Vec<Point> {
        list.iter().map(|(x, y)| Point::new(*x, *y)).collect()
    }

    fn rectangle(x: (f64, f64), y: (f64, f64)) -> Vec<Point> {
        points(&[(x.0, y.0), (x.1, y.0), (x.1, y.1), (x.0, y.1)])
    }

    fn disc(x: f64, radius: f64) -> Vec<Point> {
        (0..720).map(|i| Point::new(x, 0.0) + Point::from_angle(f64::from(i) * TAU / 720.0) * radius).collect()
    }

    fn area(polygon: &[Point]) -> f64 {
        sides(polygon).map(|(a, b)| a.perp_dot(b)).sum::<f64>() / 2.0
    }

    #[test]
    fn hulls() {
        let square = rectangle((0.0, 1.0), (0.0, 1.0));
        let mut more = square.clone();
        more.extend(points(&[(0.5, 0.5), (0.5, 0.0), (1.0, 0.5), (0.0, 0.0), (f64::NAN, 0.0)]));
        assert_eq!(hull(more), square);
        assert_eq!(hull(points(&[(0.0, 0.0), (2.0, 2.0), (1.0, 1.0)])), points(&[(0.0, 0.0), (2.0, 2.0)]));
        assert_eq!(hull(points(&[(3.0, 1.0); 4])), points(&[(3.0, 1.0)]));
        assert!(hull(Vec::new()).is_empty());
    }

    #[test]
    fn rectangles_and_discs_in_common() {
        let common = intersection(&rectangle((0.0, 0.3), (0.0, 0.2)), &rectangle((0.1, 0.5), (-0.1, 0.1)));
        assert!((area(&common) - 0.02).abs() < 1e-5);
        // A lens: two circular segments.
        let (radius, apart) = (0.05, 0.06);
        let half_angle: f64 = f64::acos(apart / 2.0 / radius);
        let lens = radius * radius * (2.0 * half_angle - (2.0 * half_angle).sin());
        let common = intersection(&disc(0.0, radius), &disc(apart, radius));
        assert!((area(&common) - lens).abs() < 3e-6, "{} and {lens}", area(&common));
        assert!(intersection(&disc(0.0, radius), &disc(0.2, radius)).is_empty());
        assert!(intersection(&disc(0.0, radius), &[]).is_empty());
    }

    #[test]
    fn points_and_lines_in_common() {
        let square = rectangle((0.0, 1.0), (0.0, 1.0));
        let (point, line) = (points(&[(0.5, 0.5)]), points(&[(-1.0, 0.5), (0.5, 0.5)]));
        for (a, b, ends) in [
            (&square, &point, points(&[(0.5, 0.5)])),
            (&square, &line, points(&[(0.0, 0.5), (0.5, 0.5)])),
            (&line, &points(&[(0.0, 0.0), (0.0, 2.0)]), points(&[(0.0, 0.5)])),
            (&line, &points(&[(0.0, 0.5), (2.0, 0.5)]), points(&[(0.0, 0.5), (0.5, 0.5)])),
            (&line, &points(&[(-1.0, 0.5)]), points(&[(-1.0, 0.5)])),
        ] {
            for common in [intersection(a, b), intersection(b, a)] {
                assert!(ends.iter().all(|e| outside(&common, *e) < 1e-4), "{common:?}");
                assert!(common.iter().all(|c| outside(&ends, *c) < 1e-4), "{common:?}");
            }
        }
        assert!(intersection(&point, &points(&[(0.5, 0.6)])).is_empty());
        assert!(intersection(&line, &points(&[(0.6, 0.0), (0.6, 1.0)])).is_empty());
    }

    #[test]
    fn distances_outside() {
        let square = rectangle((0.0, 1.0), (0.0, 1.0));
        for (p, expected) in
            [((0.5, 0.5), 0.0), ((0.0, 1.0), 0.0), ((1.5, 0.5), 0.5), ((4.0, 5.0), 5.0), ((-0.1, -0.1), 0.02f64.sqrt())]
        {
            assert!((outside(&square, Point::new(p.0, p.1)) - expected).abs() < 1e-12);
        }
        assert_eq!(outside(&square[..1], Point::new(3.0, 4.0)), 5.0);
        assert_eq!(outside(&square[..2], Point::new(0.5, 0.0)), 0.0);
        assert_eq!(outside(&[], Point::ZERO), f64::INFINITY);
    }

    #[test]
    fn intersections_hold_what_both_hold() {
        let mut random = Xoshiro256PlusPlus::seed_from_u64(1);
        let mut point = |size: f64| Point::new(random.random_range(-size..size), random.random_range(-size..size));
        for count in [1, 2, 3, 5, 9, 40] {
            for _ in 0..200 {
                let (a, b) =
                    (hull((0..count).map(|_| point(1.0)).collect()), hull((0..7).map(|_| point(1.0)).collect()));
                let common = intersection(&a, &b);
                assert!(common.iter().all(|c| outside(&a, *c) < 1e-4 && outside(&b, *c) < 1e-4));
                let p = point(1.0);
                let both = outside(&a, p) == 0.0 && outside(&b, p) == 0.0;
                assert!(!both || outside(&common, p) < 1e-12, "{p} of {a:?} and {b:?}");
                let wide = widened(&a, 0.1);
                assert!(outside(&wide, p) == 0.0 || outside(&a, p) > 0.1 - 1e-12);
                assert!(outside(&wide, p) > 0.0 || outside(&a, p) < 0.1 * 2f64.sqrt() + 1e-12);
            }
        }
    }
}
