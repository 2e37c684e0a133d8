//! Convex polygons seen from above, as their corners counter-clockwise. One corner is a point, two a line.

use crate::footprint::nearest_on_segment;
use glam::DVec2;
use std::f64::consts::TAU;

/// Corners closer than this (metres) are one.
const SAME: f64 = 1e-10;
/// Clipping keeps what is this far outside.
const HAIR: f64 = 1e-10;

/// The convex hull of some points: Andrew's monotone chain.
pub fn hull(mut points: Vec<DVec2>) -> Vec<DVec2> {
    points.sort_by(|a, b| a.x.total_cmp(&b.x).then(a.y.total_cmp(&b.y)));
    points.dedup_by(|a, b| a.distance_squared(*b) < SAME * SAME);
    if points.len() < 3 {
        return points;
    }
    let mut chain: Vec<DVec2> = Vec::with_capacity(points.len() + 1);
    let mut half = |points: &mut dyn Iterator<Item = DVec2>| {
        let start = chain.len();
        for p in points {
            while let [.., a, b] = chain[start..]
                && (b - a).perp_dot(p - a) <= 0.0
            {
                chain.pop();
            }
            chain.push(p);
        }
        // The other half begins with it.
        chain.pop();
    };
    half(&mut points.iter().copied());
    half(&mut points.iter().rev().copied());
    chain
}

/// What two polygons share; the second has at least three corners.
pub fn clip(subject: &[DVec2], by: &[DVec2]) -> Vec<DVec2> {
    let mut kept = subject.to_vec();
    for (&a, &b) in by.iter().zip(by.iter().cycle().skip(1)) {
        let inwards = (b - a).perp().normalize_or_zero();
        let depth = |p: DVec2| (p - a).dot(inwards) + HAIR;
        let mut next = Vec::with_capacity(kept.len() + 1);
        for (&p, &q) in kept.iter().zip(kept.iter().cycle().skip(1)) {
            let (at_p, at_q) = (depth(p), depth(q));
            if at_p >= 0.0 {
                next.push(p);
            }
            if at_p * at_q < 0.0 {
                next.push(p.lerp(q, at_p / (at_p - at_q)));
            }
        }
        kept = next;
        if kept.is_empty() {
            break;
        }
    }
    kept
}

/// The polygon's point nearest to `p`, which is `p` itself inside; nothing of no polygon.
pub fn nearest(polygon: &[DVec2], p: DVec2) -> Option<DVec2> {
    let sides = || polygon.iter().copied().zip(polygon.iter().copied().cycle().skip(1));
    if polygon.len() > 2 && sides().all(|(a, b)| (b - a).perp_dot(p - a) >= 0.0) {
        return Some(p);
    }
    let found = sides().map(|(a, b)| nearest_on_segment(p, a, b));
    found.min_by(|x, y| x.distance_squared(p).total_cmp(&y.distance_squared(p)))
}

/// The polygon with everything that is at most `by` outside of it, its corners cut to an eighth of a turn.
pub fn grown(polygon: &[DVec2], by: f64) -> Vec<DVec2> {
    // The sum of two convex polygons has the sides of both, in the order of their directions.
    let around: [DVec2; 8] = std::array::from_fn(|i| by * DVec2::from_angle(TAU * (i as f64 - 3.5) / 8.0));
    let first = |p: &[DVec2]| (0..p.len()).min_by(|i, j| p[*i].y.total_cmp(&p[*j].y).then(p[*i].x.total_cmp(&p[*j].x)));
    let (Some(a), Some(b)) = (first(polygon), first(&around)) else { return Vec::new() };
    let sides = |p: &[DVec2], start: usize| -> Vec<DVec2> {
        let at = |i: usize| p[(start + i) % p.len()];
        (0..p.len()).map(|i| at(i + 1) - at(i)).filter(|side| *side != DVec2::ZERO).collect()
    };
    let (ours, theirs) = (sides(polygon, a), sides(&around, b));
    // From the lowest corner: first the sides that rise, then those that fall.
    let falls = |side: DVec2| side.y < 0.0 || (side.y == 0.0 && side.x < 0.0);
    let before = |x: DVec2, y: DVec2| if falls(x) == falls(y) { x.perp_dot(y) > 0.0 } else { falls(y) };
    let (mut i, mut j) = (0, 0);
    let mut corner = polygon[a] + around[b];
    let mut corners = Vec::with_capacity(ours.len() + theirs.len());
    while i < ours.len() || j < theirs.len() {
        corners.push(corner);
        if i < ours.len() && theirs.get(j).is_none_or(|side| before(ours[i], *side)) {
            corner += ours[i];
            i += 1;
        } else {
            corner += theirs[j];
            j += 1;
        }
    }
    corners
}

#[cfg(test)]
mod tests {
    use super::*;

    fn square(x: f64, y: f64, half: f64) -> Vec<DVec2> {
        [(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)]
            .map(|(u, v)| DVec2::new(x + u * half, y + v * half))
            .to_vec()
    }

    fn area(polygon: &[DVec2]) -> f64 {
        polygon.iter().zip(polygon.iter().cycle().skip(1)).map(|(a, b)| a.perp_dot(*b)).sum::<f64>() / 2.0
    }

    #[test]
    fn hulls_leave_out_what_is_inside() {
        let mut points = square(0.0, 0.0, 1.0);
        points.extend(square(0.1, 0.0, 0.5));
        points.extend([DVec2::new(0.0, 1.0), DVec2::new(1.0, 1.0)]);
        let found = hull(points);
        assert_eq!(found.len(), 4);
        assert!((area(&found) - 4.0).abs() < 1e-12);
        assert!(hull(Vec::new()).is_empty());
        assert_eq!(hull(vec![DVec2::X; 3]), [DVec2::X]);
        assert_eq!(hull(vec![DVec2::X, DVec2::ZERO, DVec2::X * 0.5]), [DVec2::ZERO, DVec2::X]);
    }

    #[test]
    fn clips_are_what_both_have() {
        let both = clip(&square(0.0, 0.0, 1.0), &square(1.5, 0.5, 1.0));
        assert!((area(&both) - 0.5 * 1.5).abs() < 1e-9, "{both:?}");
        assert!(clip(&square(0.0, 0.0, 1.0), &square(3.0, 0.0, 1.0)).is_empty());
        let line = [DVec2::new(-3.0, 0.0), DVec2::new(3.0, 0.0)];
        let both = hull(clip(&line, &square(0.0, 0.0, 1.0)));
        assert!(both.len() == 2 && (both[0].distance(both[1]) - 2.0).abs() < 1e-9, "{both:?}");
    }

    #[test]
    fn the_nearest_point_and_what_lies_around() {
        let at = |x: f64, y: f64| DVec2::new(x, y);
        assert_eq!(nearest(&square(0.0, 0.0, 1.0), at(0.3, 0.2)), Some(at(0.3, 0.2)));
        assert!(nearest(&square(0.0, 0.0, 1.0), at(3.0, 0.2)).is_some_and(|p| p.distance(at(1.0, 0.2)) < 1e-12));
        assert_eq!(nearest(&[at(1.0, 1.0)], at(3.0, 0.2)), Some(at(1.0, 1.0)));
        assert_eq!(nearest(&[], at(3.0, 0.2)), None);
        let more = grown(&square(0.0, 0.0, 1.0), 0.1);
        assert!(nearest(&more, at(1.09, 0.0)) == Some(at(1.09, 0.0)) && more.len() >= 8);
        assert!(grown(&[], 0.1).is_empty());
        let line = [at(1.0, 1.0), at(1.5, 0.7)];
        let round: Vec<DVec2> = (0..40).map(|i| DVec2::from_angle(0.1 + TAU * f64::from(i) / 40.0)).collect();
        for polygon in [&line[..1], &line, &[line[1], line[0]], &square(0.3, 0.2, 0.4), &round] {
            // Around every corner an octagon, and the hull of those.
            let octagon = |p: &DVec2| {
                let p = *p;
                (0..8).map(move |i| p + 0.1 * DVec2::from_angle(TAU * (f64::from(i) - 3.5) / 8.0))
            };
            let expected = hull(polygon.iter().flat_map(octagon).collect());
            let found = grown(polygon, 0.1);
            assert!((area(&found) - area(&expected)).abs() < 1e-12, "{found:?}");
            assert!(expected.iter().all(|p| nearest(&found, *p).is_some_and(|q| q.distance(*p) < 1e-9)), "{found:?}");
        }
    }
}
