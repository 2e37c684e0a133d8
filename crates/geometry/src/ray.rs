//! Where a ray first meets a convex shape.

use crate::{Convex, Pose, Solid};
use glam::DVec3;

/// How far along the unit `direction` the shape begins, in its frame; 0 from inside, `None` if it is missed.
pub fn meets(convex: &Convex, origin: DVec3, direction: DVec3) -> Option<f64> {
    stretch(convex, origin, direction).filter(|(_, to)| *to >= 0.0).map(|(from, _)| from.max(0.0))
}

/// Where the whole line through `origin` is inside the shape: from, to.
pub fn stretch(convex: &Convex, origin: DVec3, direction: DVec3) -> Option<(f64, f64)> {
    match convex {
        Convex::Sphere { radius } => ball(DVec3::ZERO, *radius, origin, direction),
        Convex::Box { half } => {
            let slab = |i: usize| between(origin[i], direction[i], -half[i], half[i]);
            overlap(slab(0)?, overlap(slab(1)?, slab(2)?)?)
        }
        Convex::Cylinder { radius, half } => {
            overlap(round(*radius, origin, direction)?, between(origin.z, direction.z, -half, *half)?)
        }
        Convex::Capsule { radius, half } => {
            let middle = round(*radius, origin, direction).zip(between(origin.z, direction.z, -half, *half));
            let caps = [-half, *half].map(|z| ball(DVec3::new(0.0, 0.0, z), *radius, origin, direction));
            let parts = [middle.and_then(|(a, b)| overlap(a, b)), caps[0], caps[1]];
            parts.into_iter().flatten().reduce(|a, b| (a.0.min(b.0), a.1.max(b.1)))
        }
        Convex::Hull(hull) => hull.planes.iter().try_fold((f64::NEG_INFINITY, f64::INFINITY), |so_far, (n, d)| {
            overlap(so_far, between(n.dot(origin), n.dot(direction), f64::NEG_INFINITY, *d)?)
        }),
    }
}

/// The same for a placed solid.
pub fn meets_solid(solid: &Solid, pose: &Pose, origin: DVec3, direction: DVec3) -> Option<f64> {
    let part = |(part, convex): &(Pose, Convex)| {
        let at = *pose * *part;
        meets(convex, at.inverse_point(origin), at.rotation.transpose() * direction)
    };
    solid.parts.iter().filter_map(part).reduce(f64::min)
}

type Stretch = (f64, f64);

fn overlap(a: Stretch, b: Stretch) -> Option<Stretch> {
    let both = (a.0.max(b.0), a.1.min(b.1));
    (both.0 <= both.1).then_some(both)
}

/// Where `from + t · along` is from `low` to `high`.
fn between(from: f64, along: f64, low: f64, high: f64) -> Option<Stretch> {
    if along == 0.0 {
        return (low <= from && from <= high).then_some((f64::NEG_INFINITY, f64::INFINITY));
    }
    let (a, b) = ((low - from) / along, (high - from) / along);
    Some((a.min(b), a.max(b)))
}

/// Within the endless cylinder about z.
fn round(radius: f64, origin: DVec3, direction: DVec3) -> Option<Stretch> {
    let (o, d) = (origin.truncate(), direction.truncate());
    roots(d.length_squared(), o.dot(d), o.length_squared() - radius * radius)
}

fn ball(centre: DVec3, radius: f64, origin: DVec3, direction: DVec3) -> Option<Stretch> {
    let o = origin - centre;
    roots(direction.length_squared(), o.dot(direction), o.length_squared() - radius * radius)
}

/// Where a t² + 2 b t + c ≤ 0, for a ≥ 0.
fn roots(a: f64, b: f64, c: f64) -> Option<Stretch> {
    if a < 1e-18 {
        return (c <= 0.0).then_some((f64::NEG_INFINITY, f64::INFINITY));
    }
    let root = (b * b - a * c).sqrt();
    root.is_finite().then(|| ((-b - root) / a, (-b + root) / a))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::hull::convex_hull;
    use std::sync::Arc;

    /// Steps along the ray by the distance to the shape: nothing is passed over.
    fn by_steps(convex: &Convex, origin: DVec3, direction: DVec3) -> Option<f64> {
        let mut t = 0.0;
        for _ in 0..20_000 {
            let gap = convex.point_distance(origin + direction * t);
            if gap < 1e-9 {
                return Some(t);
            }
            t += gap;
            if t > 10.0 {
                return None;
            }
        }
        Some(t)
    }

    #[test]
    fn agrees_with_small_steps() {
        let corners: Vec<DVec3> =
            (0..8).map(|i| DVec3::new(f64::from(i & 1), f64::from(i >> 1 & 1), f64::from(i >> 2)) - 0.5).collect();
        let shapes = [
            Convex::Sphere { radius: 0.4 },
            Convex::Box { half: DVec3::new(0.3, 0.5, 0.2) },
            Convex::Cylinder { radius: 0.3, half: 0.5 },
            Convex::Capsule { radius: 0.2, half: 0.4 },
            Convex::Hull(Arc::new(convex_hull(&corners).expect("a hull"))),
        ];
        let mut t = 0.0f64;
        let mut some = || {
            t += 1.0;
            DVec3::new((t * 1.7).sin(), (t * 2.3).sin(), (t * 3.1).cos())
        };
        let (mut met, mut missed) = (0, 0);
        for _ in 0..4000 {
            let (origin, towards) = (some() * 1.5, some() * 0.6);
            let direction = (towards - origin).normalize();
            for shape in &shapes {
                let (found, stepped) = (meets(shape, origin, direction), by_steps(shape, origin, direction));
                match (found, stepped) {
                    (Some(a), Some(b)) => {
                        assert!((a - b).abs() < 1e-4, "{shape:?} {origin} {direction}: {a} {b}");
                        met += 1;
                    }
                    (None, None) => missed += 1,
                    // Along the surface.
                    _ => {
                        let nearest = (0..4000)
                            .map(|i| shape.point_distance(origin + direction * (f64::from(i) * 1e-3)))
                            .fold(f64::INFINITY, f64::min);
                        assert!(nearest.abs() < 2e-3, "{shape:?} {origin} {direction}: {found:?} {stepped:?}");
                    }
                }
            }
        }
        assert!(met > 5000 && missed > 2000, "{met} {missed}");
    }
}
