//! Horizontal cross-sections of convex shapes.

use crate::convex::Hull;
use crate::{Convex, Pose, polygon};
use glam::{DVec2, DVec3};
use std::f64::consts::{PI, TAU};

/// Polygons in place of round outlines are this much out of round, metres.
const ROUND: f64 = 2.5e-5;
/// An axis that rises less than this is horizontal.
const LEVEL: f64 = 1e-9;

impl Convex {
    /// The corners of the placed shape's cross-section at height `z`, counter-clockwise; none where it
    /// misses the shape. Round outlines become polygons, as much inside as outside of them.
    pub fn section(&self, pose: &Pose, z: f64) -> Vec<DVec2> {
        let mut points = Vec::new();
        match self {
            Convex::Sphere { radius } => disc(&mut points, pose.translation, *radius, z),
            Convex::Capsule { radius, half } => {
                for end in [-half, *half] {
                    disc(&mut points, pose.point(DVec3::new(0.0, 0.0, end)), *radius, z);
                }
                tube(&mut points, pose, *radius, *half, z);
            }
            Convex::Cylinder { radius, half } => tube(&mut points, pose, *radius, *half, z),
            Convex::Box { half } => {
                let corner = |i: usize| {
                    let sign = |axis: usize| if i >> axis & 1 == 1 { 1.0 } else { -1.0 };
                    pose.point(DVec3::new(sign(0), sign(1), sign(2)) * *half)
                };
                let corners: [DVec3; 8] = std::array::from_fn(corner);
                for i in 0..8 {
                    for axis in (0..3).filter(|axis| i >> axis & 1 == 0) {
                        cross(&mut points, corners[i], corners[i | 1 << axis], z);
                    }
                }
            }
            Convex::Hull(hull) => of_hull(&mut points, hull, pose, z),
        }
        polygon::hull(points)
    }
}

/// How many corners a circle gets.
fn corners(radius: f64) -> usize {
    ((PI * (radius / (4.0 * ROUND)).sqrt()).ceil() as usize).clamp(16, 512).next_multiple_of(4)
}

/// So much wider, a polygon is as far outside its circle as inside.
fn widened(radius: f64, corners: usize) -> f64 {
    2.0 * radius / (1.0 + (PI / corners as f64).cos())
}

/// Of a ball.
fn disc(points: &mut Vec<DVec2>, centre: DVec3, radius: f64, z: f64) {
    let square = radius * radius - (z - centre.z).powi(2);
    if square <= 0.0 {
        return;
    }
    let count = corners(square.sqrt());
    let radius = widened(square.sqrt(), count);
    points.extend((0..count).map(|i| centre.truncate() + radius * DVec2::from_angle(TAU * i as f64 / count as f64)));
}

/// Of a cylinder: where its side crosses the height, at the angle φ from the side's steepest line.
fn tube(points: &mut Vec<DVec2>, pose: &Pose, radius: f64, half: f64, z: f64) {
    let (centre, axis) = (pose.translation, pose.rotation.z_axis);
    let rise = axis.truncate().length();
    let (up, across) = match (DVec3::Z - axis.z * axis).try_normalize() {
        Some(up) if rise > LEVEL => (up, axis.cross(up)),
        _ => (pose.rotation.x_axis, pose.rotation.y_axis),
    };
    let height = z - centre.z;
    // The side is at this height where radius · rise · cos φ + along · axis.z is, for |along| ≤ half.
    let ends = if rise > LEVEL {
        let limit = |side: f64| (height + side * half * axis.z.abs()) / (radius * rise);
        let (low, high) = (limit(-1.0), limit(1.0));
        if low > 1.0 || high < -1.0 {
            return;
        }
        (high.min(1.0).acos(), low.max(-1.0).acos())
    } else if height.abs() <= half {
        (0.0, PI)
    } else {
        return;
    };
    let count = corners(radius) / 2;
    let whole = ends.1 - ends.0 > PI - 1e-9;
    let radius_shown = if whole { widened(radius, 2 * count) } else { radius };
    for i in 0..=count {
        let angle = ends.0 + (ends.1 - ends.0) * i as f64 / count as f64;
        let along = if axis.z.abs() > LEVEL {
            [((height - radius * rise * angle.cos()) / axis.z).clamp(-half, half); 2]
        } else {
            [-half, half]
        };
        for (side, along) in [-1.0, 1.0].into_iter().flat_map(|side| along.map(|a| (side, a))) {
            let p = centre + along * axis + radius_shown * (angle.cos() * up + side * angle.sin() * across);
            points.push(p.truncate());
        }
    }
}

fn of_hull(points: &mut Vec<DVec2>, hull: &Hull, pose: &Pose, z: f64) {
    let corners: Vec<DVec3> = hull.points.iter().map(|p| pose.point(*p)).collect();
    for [a, b, c] in hull.triangles.iter().map(|t| t.map(|i| corners[i as usize])) {
        for (p, q) in [(a, b), (b, c), (c, a)] {
            cross(points, p, q, z);
        }
    }
}

/// Where the edge from `p` to `q` crosses the height; both ends where it lies in it.
fn cross(points: &mut Vec<DVec2>, p: DVec3, q: DVec3, z: f64) {
    let (below, above) = (p.z - z, q.z - z);
    if below == 0.0 && above == 0.0 {
        points.extend([p.truncate(), q.truncate()]);
    } else if below * above <= 0.0 {
        points.push(p.lerp(q, below / (below - above)).truncate());
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::hull::convex_hull;
    use std::f64::consts::FRAC_PI_2;
    use std::sync::Arc;

    fn area(polygon: &[DVec2]) -> f64 {
        polygon.iter().zip(polygon.iter().cycle().skip(1)).map(|(a, b)| a.perp_dot(*b)).sum::<f64>() / 2.0
    }

    fn tilted(roll: f64, pitch: f64) -> Pose {
        Pose::from_rpy([roll, pitch, 0.4], DVec3::new(0.1, -0.2, 0.3))
    }

    #[test]
    fn standing_and_lying() {
        let can = Convex::Cylinder { radius: 0.04, half: 0.1 };
        let round = PI * 0.04 * 0.04;
        assert!((area(&can.section(&tilted(0.0, 0.0), 0.35)) / round - 1.0).abs() < 1e-3);
        assert!(can.section(&tilted(0.0, 0.0), 0.401).is_empty());
        // Lying, a millimetre above its lowest line: a strip.
        let strip = area(&can.section(&tilted(FRAC_PI_2, 0.0), 0.261));
        assert!((strip / (0.2 * 2.0 * (0.04f64.powi(2) - 0.039f64.powi(2)).sqrt()) - 1.0).abs() < 1e-6, "{strip}");
        let capsule = Convex::Capsule { radius: 0.04, half: 0.1 };
        let strip = area(&capsule.section(&tilted(FRAC_PI_2, 0.0), 0.3));
        assert!((strip / (0.2 * 0.08 + round) - 1.0).abs() < 1e-3, "{strip}");
        let ball = Convex::Sphere { radius: 0.05 };
        assert!((area(&ball.section(&tilted(0.0, 0.0), 0.33)) / (PI * 0.04 * 0.04) - 1.0).abs() < 1e-3);
    }

    /// All heights' sections make up the volume, whatever the tilt.
    #[test]
    fn sections_fill_the_shape() {
        let corners = [[0.1, 0.0, 0.0], [-0.1, 0.05, 0.0], [0.0, -0.1, 0.02], [0.0, 0.0, 0.2], [0.03, 0.04, -0.1]];
        let shapes = [
            Convex::Sphere { radius: 0.07 },
            Convex::Capsule { radius: 0.03, half: 0.1 },
            Convex::Cylinder { radius: 0.05, half: 0.02 },
            Convex::Cylinder { radius: 0.03, half: 0.1 },
            Convex::Box { half: DVec3::new(0.1, 0.2, 0.03) },
            Convex::Hull(Arc::new(convex_hull(&corners.map(DVec3::from_array)).unwrap())),
        ];
        for shape in &shapes {
            for pose in
                [tilted(0.0, 0.0), tilted(0.3, 0.7), tilted(FRAC_PI_2, 0.0), tilted(1e-7, 0.0), tilted(2.0, -0.2)]
            {
                let (min, max) = shape.aabb(&pose);
                let slices = 2000;
                let thick = (max.z - min.z) / f64::from(slices);
                let at = |i: i32| min.z + thick * (f64::from(i) + 0.5);
                let volume: f64 = (0..slices).map(|i| thick * area(&shape.section(&pose, at(i)))).sum();
                assert!((volume / shape.mass().volume - 1.0).abs() < 3e-3, "{shape:?} {pose:?}: {volume}");
            }
        }
    }
}
